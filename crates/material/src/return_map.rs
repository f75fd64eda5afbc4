//! The scalar equation of radial return.

use crate::MaterialError;
use crate::hardening::FlowStress;

/// Accepted residual, relative to the trial stress: a few thousand units of round-off.
const TOLERANCE: f64 = 1e-12;

/// Newton converges in two to six iterations for smooth laws; laws with an infinite slope at zero
/// strain need up to a few dozen to find the scale of a tiny root.
const MAX_ITERATIONS: usize = 100;

/// Δε_p of radial return: the root D of
///
/// ```text
///   g(D) = τ_eq,trial − 3 μ D − J σ_Y(ε_p + D)
/// ```
///
/// Newton's iteration inside a bracket. For a law that does not soften g falls strictly from
/// g(0) > 0 to g(τ_eq/3μ) < 0, so the root exists and is unique. For linear hardening the first
/// iterate is exact, D = (τ_eq,trial − J σ_Y) / (3 μ + J H): Greto & Kulasegaram 2019, (A.15), with the
/// factors J it lacks.
///
/// # Arguments
/// * `trial_stress`: τ_eq,trial, Pa, above J σ_Y(ε_p).
/// * `start`: σ_Y and its slope at ε_p, which the caller has from testing for yield.
/// * `flow_stress`: the same at any ε_p; the slope may be infinite.
///
/// # Errors
/// [`MaterialError::ReturnMap`] if the residual stays above 1e-12 of the trial stress.
#[inline]
pub(crate) fn plastic_increment(
    trial_stress: f64,
    shear_modulus: f64,
    jacobian: f64,
    plastic_strain: f64,
    start: FlowStress,
    flow_stress: impl Fn(f64) -> FlowStress,
) -> Result<f64, MaterialError> {
    let stiffness = 3.0 * shear_modulus;
    let tolerance = TOLERANCE * trial_stress;
    let (mut low, mut high) = (0.0, trial_stress / stiffness);
    let mut increment = 0.0;
    let mut residual = f64::NAN;
    for iteration in 0..MAX_ITERATIONS {
        let flow = if iteration == 0 {
            start
        } else {
            flow_stress(plastic_strain + increment)
        };
        residual = trial_stress - stiffness * increment - jacobian * flow.value;
        // The start is no solution however close the trial stress is to yield: it has no increment.
        if residual.abs() <= tolerance && iteration > 0 {
            return Ok(increment);
        }
        if residual > 0.0 {
            low = increment;
        } else {
            high = increment;
        }
        increment += residual / (stiffness + jacobian * flow.slope);
        // An infinite or undefined slope leaves the bracket or does not move; so does an overshoot.
        if !(low < increment && increment < high) {
            increment = if low > 0.0 {
                (low * high).sqrt()
            } else {
                1e-3 * high
            };
        }
    }
    Err(MaterialError::ReturnMap {
        residual,
        tolerance,
        iterations: MAX_ITERATIONS,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hardening::{HardeningLaw, Ludwik};

    #[test]
    fn linear_hardening_has_its_closed_form() {
        let (trial, mu, jacobian, yield_stress, modulus) = (0.9e9, 43e9, 0.97, 0.4e9, 0.1e9);
        let law = |strain| FlowStress {
            value: yield_stress + modulus * strain,
            slope: modulus,
        };
        let increment = plastic_increment(trial, mu, jacobian, 0.25, law(0.25), law).unwrap();
        // Greto & Kulasegaram 2019, (A.15), for Kirchhoff stresses.
        let expected =
            (trial - jacobian * (yield_stress + modulus * 0.25)) / (3.0 * mu + jacobian * modulus);
        assert!((increment / expected - 1.0).abs() < 1e-13);
    }

    #[test]
    fn infinite_initial_slope_is_solved_from_the_largest_to_the_smallest_overstress() {
        for exponent in [0.05, 0.2, 0.5, 0.9, 1.0] {
            let law = Ludwik {
                initial_yield_stress: 0.3e9,
                coefficient: 0.5e9,
                exponent,
            };
            for overstress in [10.0, 1.0, 1e-2, 1e-5, 1e-8, 1e-10] {
                let trial = 0.3e9 * (1.0 + overstress);
                let flow_stress = |strain| law.flow_stress(strain);
                let increment =
                    plastic_increment(trial, 40e9, 1.0, 0.0, flow_stress(0.0), flow_stress)
                        .unwrap();
                let met = trial - 3.0 * 40e9 * increment - law.flow_stress(increment).value;
                assert!(
                    increment > 0.0 && met.abs() <= 1e-12 * trial,
                    "{exponent} {overstress}"
                );
            }
        }
    }

    #[test]
    fn a_law_that_never_meets_the_stress_is_reported_with_its_residual() {
        let broken = |_| FlowStress {
            value: f64::NAN,
            slope: 0.0,
        };
        let error = plastic_increment(1e9, 40e9, 1.0, 0.0, broken(0.0), broken).unwrap_err();
        assert!(
            matches!(error, MaterialError::ReturnMap { residual, iterations: 100, .. } if residual.is_nan())
        );
    }
}
