//! What every registered hardening law is held to, on each of its examples.

use super::{FlowState, HardeningLaw};
use crate::ROOM_TEMPERATURE;

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
