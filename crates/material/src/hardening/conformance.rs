//! What every registered hardening law is held to, on each of its examples.

use super::{FlowState, FlowStateTile, FlowStress, FlowStressTile, HardeningLaw};
use crate::ROOM_TEMPERATURE;
use jstsph_tensor::lanes::{Simd, TILE, WithSimd, vectorised};

/// Central difference of `value` at `x`, and what it may miss a `slope` by: truncation (h × rate)²/6
/// of the slope, round-off 2e-16/h of the value.
fn assert_slope(value: impl Fn(f64) -> f64, x: f64, slope: f64, what: &str) {
    let h = 1e-5 * x;
    let difference = (value(x + h) - value(x - h)) / (2.0 * h);
    let tolerance = 1e-7 * slope + 1e-15 * value(x) / h;
    assert!(
        (slope - difference).abs() <= tolerance,
        "{what} at {x}: slope {slope} is not {difference}"
    );
}

pub(super) fn check<L: HardeningLaw>() {
    let examples = L::examples();
    assert!(!examples.is_empty());
    for law in examples {
        law.validate().expect("an example is valid");
        check_tiles(&law);
        for temperature in [200.0, ROOM_TEMPERATURE, 700.0] {
            // No reference rate of 1/s, where laws have corners.
            for rate in [0.0, 0.02, 30.0, 1e5] {
                check_at(&law, rate, temperature);
            }
        }
    }
}

fn check_at<L: HardeningLaw>(law: &L, rate: f64, temperature: f64) {
    let flow = |plastic_strain: f64, rate: f64| {
        law.flow_stress(&FlowState {
            plastic_strain,
            rate,
            temperature,
        })
    };
    let initial = flow(0.0, rate).value;
    assert!(initial > 0.0, "{law:?} yields at {initial} Pa");

    // Points of no special place, so that no kink of a table lies inside the difference.
    for strain in [1e-4, 0.013, 0.0777, 0.33, 0.91, 4.7] {
        let here = flow(strain, rate);
        assert!(
            here.value >= initial && here.slope >= 0.0,
            "{law:?} softens at {strain}"
        );
        assert!(
            here.value >= flow(strain, 0.0).value && here.rate_slope >= 0.0,
            "{law:?} softens with the rate at {rate}/s"
        );
        assert_slope(
            |strain| flow(strain, rate).value,
            strain,
            here.slope,
            &format!("{law:?}, strain"),
        );
        if rate > 0.0 {
            assert_slope(
                |rate| flow(strain, rate).value,
                rate,
                here.rate_slope,
                &format!("{law:?}, rate"),
            );
        }
    }
}

/// Start and flow stresses of a tile.
struct Tiles<'a, L> {
    law: &'a L,
    from: &'a FlowStateTile,
    at: &'a FlowStateTile,
}

impl<L: HardeningLaw> WithSimd for Tiles<'_, L> {
    type Output = [FlowStressTile; 3];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [FlowStressTile; 3] {
        let Self { law, from, at } = self;
        let [mut start, mut direct, mut near] = [const { FlowStressTile::ZERO }; 3];
        law.flow_stress_tile(simd, from, &mut start);
        law.flow_stress_tile(simd, at, &mut direct);
        law.flow_stress_near_tile(simd, &start, &from.plastic_strain, at, &mut near);
        [start, direct, near]
    }
}

fn assert_bits(tile: &FlowStressTile, i: usize, single: FlowStress, what: &str) {
    let found = [tile.value[i], tile.slope[i], tile.rate_slope[i]];
    let expected = [single.value, single.slope, single.rate_slope];
    assert_eq!(found, expected, "{what}");
}

/// Tiles have the bits of single points, and what is near the start is what is found without it.
fn check_tiles<L: HardeningLaw>(law: &L) {
    // Growth of ε_p in one step: inside the range of all series, some outside, some points unchanged.
    for (growth, unchanged) in [(1e-9, false), (5e-4, true), (0.01, false), (0.3, true)] {
        for rates in [[0.0; 2], [1e-3, 1e5], [1.0, 0.5], [1e-310, 1e12]] {
            let strain = |i: usize| 1e-3 * 1.35f64.powi(i as i32);
            let from = FlowStateTile {
                plastic_strain: std::array::from_fn(strain),
                rate: [0.0; TILE],
                temperature: std::array::from_fn(|i| 150.0 + 37.0 * i as f64),
            };
            let grown = |i: usize| {
                let factor = if unchanged && i.is_multiple_of(3) {
                    1.0
                } else {
                    1.0 + growth
                };
                strain(i) * factor
            };
            let at = FlowStateTile {
                plastic_strain: std::array::from_fn(grown),
                rate: std::array::from_fn(|i| rates[i % 2]),
                ..from.clone()
            };
            let [start, direct, near] = vectorised(Tiles {
                law,
                from: &from,
                at: &at,
            });
            for i in 0..TILE {
                let what = format!("{law:?}, point {i}, {growth}, {rates:?}");
                let first = law.flow_stress(&from.at(i));
                assert_bits(&start, i, first, &format!("start: {what}"));
                let single = law.flow_stress(&at.at(i));
                assert_bits(&direct, i, single, &format!("direct: {what}"));
                let single_near = law.flow_stress_near(&first, from.plastic_strain[i], &at.at(i));
                assert_bits(&near, i, single_near, &format!("near: {what}"));
                assert_near(&single_near, &single, &what);
                assert!(L::RATE_DEPENDENT || single.rate_slope == 0.0, "{what}");
            }
        }
    }
}

/// To round-off: a few units of the value, near the melting point of the small number that is left.
fn assert_near(near: &FlowStress, direct: &FlowStress, what: &str) {
    let pairs = [
        (near.value, direct.value),
        (near.slope, direct.slope),
        (near.rate_slope, direct.rate_slope),
    ];
    for (near, direct) in pairs {
        assert!(
            near == direct || (near / direct - 1.0).abs() < 3e-15,
            "{what}: {near} is not {direct}"
        );
    }
}
