//! The stable time step (3.17), `[eq:time-step]`.

use std::ops::Range;

use jstsph_tensor::lanes::TILE;
use jstsph_tensor::{Mat3, cofactor, double_dot, largest_eigenvalue};

use crate::local_steps::{Groups, Levels};
use crate::parallel;
use crate::reference::{BodyReference, Reference};
use crate::state::{Deformation, State, StretchBounds};

pub(crate) mod bound;
mod choice;

pub(crate) use choice::AcousticLimit;

/// Candidates whose upper bound is below the present maximum by this factor are skipped; it is far
/// above the round-off of either number, so that skipping never changes the maximum.
const BOUND_MARGIN: f64 = 1.0 + 1e-9;

/// Largest 1/λ² over a set of points and where it occurs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steepest {
    pub(crate) inverse_stretch_squared: f64,
    pub(crate) point: usize,
}

/// The stable step and the point that limits it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StableStep {
    /// min over bodies of Δx λ_min / c, s, before the CFL number; NaN when a strain is not finite.
    pub(crate) time: f64,
    /// Limiting point, index in the simulation.
    pub(crate) point: usize,
    /// Smallest principal stretch there.
    pub(crate) stretch: f64,
}

/// (F⁻¹ F⁻ᵀ), whose largest principal value is one over the smallest squared principal stretch.
#[inline]
fn inverse_cauchy_green(deformation_gradient: &Mat3, cofactor: &Mat3) -> Mat3 {
    // Not the first row alone: H is cof F only to second order in TVD-RK2, and the step must not
    // depend on the axes.
    let determinant = double_dot(deformation_gradient, cofactor) / 3.0;
    cofactor.transpose() * cofactor * (1.0 / (determinant * determinant))
}

/// The largest 1/λ² of a range of at most [`parallel::LEAF`] points, the first of them where several
/// have it; not a number, at the first such point, where a strain is not finite.
fn steepest_of(plane: bool, range: Range<usize>, deformation: Deformation<'_>) -> Steepest {
    let start = range.start;
    let mut buffer = [0.0; parallel::LEAF];
    let bounds = &mut buffer[..range.len()];
    bound::evaluate(plane, deformation.of(range), bounds);
    let mut largest = 0;
    for (k, bound) in bounds.iter().enumerate() {
        if !bound.is_finite() {
            return Steepest {
                inverse_stretch_squared: f64::NAN,
                point: start + k,
            };
        }
        if *bound > bounds[largest] {
            largest = k;
        }
    }
    // The point with the largest bound first: few others then need their value.
    let value = |k: usize| {
        let (f, h) = (
            &deformation.gradient[start + k],
            deformation.cofactor(start + k),
        );
        largest_eigenvalue(&inverse_cauchy_green(f, &h))
    };
    let (mut best, mut at) = (value(largest), largest);
    for (k, bound) in bounds.iter().enumerate() {
        if k == largest || bound * BOUND_MARGIN < best {
            continue;
        }
        let value = value(k);
        if value > best || (value == best && k < at) {
            (best, at) = (value, k);
        }
    }
    Steepest {
        inverse_stretch_squared: best,
        point: start + at,
    }
}

/// The steeper of two sets of points; the first that is not a number wins.
fn steeper(a: Steepest, b: Steepest) -> Steepest {
    if a.inverse_stretch_squared.is_nan() || a.inverse_stretch_squared >= b.inverse_stretch_squared
    {
        a
    } else {
        b
    }
}

/// The largest 1/λ² of those tiles of a body that are `wanted`, by the bounds of all of them.
fn steepest_by_bounds(
    plane: bool,
    deformation: Deformation<'_>,
    bounds: &[f64],
    wanted: impl Fn(usize) -> bool,
) -> Option<Steepest> {
    let of_tile = |tile: usize| {
        let end = deformation.gradient.len().min((tile + 1) * TILE);
        steepest_of(plane, tile * TILE..end, deformation)
    };
    // The first of the largest, or the first that is not finite.
    let mut largest: Option<usize> = None;
    for (tile, bound) in bounds.iter().enumerate() {
        if !wanted(tile) {
            continue;
        }
        if bound.is_nan() {
            return Some(of_tile(tile));
        }
        if largest.is_none_or(|largest| *bound > bounds[largest]) {
            largest = Some(tile);
        }
    }
    let largest = largest?;
    let mut best = of_tile(largest);
    for (tile, bound) in bounds.iter().enumerate() {
        if tile == largest || bound * BOUND_MARGIN < best.inverse_stretch_squared || !wanted(tile) {
            continue;
        }
        let here = of_tile(tile);
        best = if tile < largest {
            steeper(here, best)
        } else {
            steeper(best, here)
        };
    }
    Some(best)
}

/// Δt / CFL = min Δx λ_min / c_p over all points: compression makes waves faster in the reference
/// configuration by one over the smallest principal stretch (3.17; the algorithm box's formula
/// is garbled, docs/theory.md). Fresh `bounds` make it fast and change nothing.
pub(crate) fn stable_step(
    reference: &Reference,
    state: &State,
    bounds: &StretchBounds,
) -> StableStep {
    let plane = reference.is_plane();
    smallest(reference, |index, body| {
        let deformation = state.deformation(body.points.clone());
        let by_bounds = bounds
            .of(index)
            .and_then(|bounds| steepest_by_bounds(plane, deformation, bounds, |_| true));
        by_bounds.unwrap_or_else(|| {
            parallel::reduce(
                body.points.len(),
                &|range| steepest_of(plane, range, deformation),
                &steeper,
            )
        })
    })
}

/// [`stable_step`] of a part of the points; infinite when it has none.
pub(crate) fn stable_step_of_part(
    reference: &Reference,
    (state, bounds): (&State, &StretchBounds),
    (groups, level): (&[Groups], u8),
) -> StableStep {
    let plane = reference.is_plane();
    let none = Steepest {
        inverse_stretch_squared: 0.0,
        point: 0,
    };
    smallest(reference, |index, body| {
        let deformation = state.deformation(body.points.clone());
        let count = body.points.len();
        let tiles = &groups[index].points;
        if let Some(bounds) = bounds.of(index) {
            let wanted = |tile: usize| tiles.level(tile * TILE) == level;
            return steepest_by_bounds(plane, deformation, bounds, wanted).unwrap_or(none);
        }
        parallel::reduce(
            count.div_ceil(TILE),
            &|range| {
                let points = range.start * TILE..(range.end * TILE).min(count);
                let mut steepest = none;
                for run in tiles.runs(points, Levels::only(level)) {
                    for first in run.clone().step_by(parallel::LEAF) {
                        let piece = first..run.end.min(first + parallel::LEAF);
                        steepest = steeper(steepest, steepest_of(plane, piece, deformation));
                    }
                }
                steepest
            },
            &steeper,
        )
    })
}

/// The smallest of the times of the bodies, each by its steepest point.
fn smallest(
    reference: &Reference,
    steepest: impl Fn(usize, &BodyReference) -> Steepest,
) -> StableStep {
    let mut result = StableStep {
        time: f64::INFINITY,
        point: 0,
        stretch: 1.0,
    };
    for (index, body) in reference.bodies.iter().enumerate() {
        let steepest = steepest(index, body);
        let stretch = 1.0 / steepest.inverse_stretch_squared.sqrt();
        let time = body.spacing * stretch / body.wave_speed;
        let step = StableStep {
            time,
            point: body.points.start + steepest.point,
            stretch,
        };
        if time.is_nan() {
            return step;
        }
        if time < result.time {
            result = step;
        }
    }
    result
}

/// Δx λ_min / c of one point.
pub(crate) fn point_time(body: &BodyReference, deformation_gradient: &Mat3) -> f64 {
    body.spacing * smallest_stretch(deformation_gradient) / body.wave_speed
}

/// Smallest principal stretch of a point.
pub(crate) fn smallest_stretch(deformation_gradient: &Mat3) -> f64 {
    let cofactor = cofactor(deformation_gradient);
    1.0 / largest_eigenvalue(&inverse_cauchy_green(deformation_gradient, &cofactor)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Integrator, Quadrature};
    use crate::testing::{Random, body, copper, elastic, in_pool, model, scheme};

    /// Two bodies of different material and more points than one leaf of the reduction has.
    fn two_bodies() -> (Reference, State) {
        let scheme = scheme(Quadrature::Bonds, Integrator::Leapfrog);
        let mut model = model([10, 10, 6], elastic(), scheme);
        model.bodies.push(body("second", [12, 9, 13], copper()));
        let reference = Reference::new(&model).unwrap();
        let momentum = vec![jstsph_tensor::Vec3::zeros(); reference.position.len()];
        let state = State::undeformed(&reference, &scheme, momentum);
        (reference, state)
    }

    fn deform(state: &mut State, q: usize, f: Mat3) {
        state.deformation_gradient[q] = f;
    }

    /// The step and its point with the largest eigenvalue of every point computed.
    fn brute_force(reference: &Reference, state: &State) -> (f64, usize) {
        let mut best = (f64::INFINITY, 0);
        for body in &reference.bodies {
            let mut largest = (0.0, 0);
            for q in body.points.clone() {
                let f = &state.deformation_gradient[q];
                let inverse = inverse_cauchy_green(f, &cofactor(f));
                let value = largest_eigenvalue(&inverse);
                if value > largest.0 {
                    largest = (value, q);
                }
            }
            let time = body.spacing * (1.0 / largest.0.sqrt()) / body.wave_speed;
            if time < best.0 {
                best = (time, largest.1);
            }
        }
        best
    }

    #[test]
    fn skipping_candidates_never_changes_the_step() {
        let (reference, mut state) = two_bodies();
        let mut random = Random(53);
        let stale = StretchBounds::default();
        for trial in 0..60 {
            // From nearly rigid (all points almost equal) to wildly different stretches.
            let amplitude: f64 = [0.0, 1e-15, 1e-9, 1e-3, 0.3, 0.6][trial % 6];
            // Where one stretch dominates, the bound that is skipped by is nearly sharp.
            let squeeze = if trial % 12 < 6 { 1.0 } else { 0.05 };
            for q in 0..reference.point_volume.len() {
                let stretch = squeeze * (1.0 + 0.1 * amplitude.min(0.3) * random.number());
                let along = Mat3::from_diagonal(&jstsph_tensor::Vec3::new(1.0, stretch, 1.0));
                deform(
                    &mut state,
                    q,
                    along * (Mat3::identity() + random.tensor() * amplitude),
                );
            }
            let expected = brute_force(&reference, &state);
            for threads in [1, 3] {
                let found = in_pool(threads, || stable_step(&reference, &state, &stale));
                assert_eq!(
                    found.time.to_bits(),
                    expected.0.to_bits(),
                    "amplitude {amplitude}"
                );
                assert_eq!(found.point, expected.1, "amplitude {amplitude}");
            }
        }
    }

    #[test]
    fn the_body_with_the_shorter_step_decides() {
        let (reference, mut state) = two_bodies();
        let second = &reference.bodies[1];
        let undeformed = stable_step(&reference, &state, &StretchBounds::default());
        assert!(
            (undeformed.time - 1e-3 / second.wave_speed).abs() < 1e-15 * undeformed.time.max(1.0)
        );
        assert_eq!(
            (undeformed.point, undeformed.stretch),
            (second.points.start, 1.0)
        );
        deform(
            &mut state,
            77,
            Mat3::from_diagonal(&jstsph_tensor::Vec3::new(1.0, 0.1, 1.0)),
        );
        let found = stable_step(&reference, &state, &StretchBounds::default());
        assert_eq!(found.point, 77);
        assert!((found.stretch - 0.1).abs() < 1e-15);
        let expected = 0.1 * 1e-3 / reference.bodies[0].wave_speed;
        assert!((found.time / expected - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_first_point_that_is_not_finite_is_found() {
        let (reference, start) = two_bodies();
        let points = reference.point_volume.len();
        let stale = StretchBounds::default();
        for places in [vec![0], vec![points - 1], vec![900, 2000, 700], vec![1111]] {
            for value in [f64::NAN, f64::INFINITY] {
                let mut state = start.clone();
                let mut f = Mat3::identity();
                f.m21 = value;
                places.iter().for_each(|q| deform(&mut state, *q, f));
                // A tiny stretch elsewhere must not hide it.
                deform(&mut state, 5, Mat3::identity() * 1e-3);
                for threads in [1, 3] {
                    let found = in_pool(threads, || stable_step(&reference, &state, &stale));
                    assert!(found.time.is_nan(), "{places:?}");
                    assert_eq!(found.point, *places.iter().min().unwrap());
                }
            }
        }
    }

    #[test]
    fn smallest_stretch_of_a_diagonal_is_its_smallest_entry() {
        let f = Mat3::from_diagonal(&jstsph_tensor::Vec3::new(1.4, 0.25, 0.8));
        assert!((smallest_stretch(&f) - 0.25).abs() < 1e-15);
        let rotation = Mat3::new(0.6, -0.8, 0.0, 0.8, 0.6, 0.0, 0.0, 0.0, 1.0);
        assert!((smallest_stretch(&(rotation * f)) - 0.25).abs() < 1e-14);
    }
}
