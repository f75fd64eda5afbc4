//! The scalar equation of radial return, `[eq:return]`, with rate `[eq:return-rate]`.

use crate::MaterialError;
use crate::hardening::{FlowState, FlowStress, Hardening};
use jstsph_tensor::lanes::{Lanes, Scalar, Simd};

mod tile;

pub(crate) use tile::{TileProblem, TileReturn, TileSolution};

/// Accepted residual, relative to the trial stress: a few thousand units of round-off.
const TOLERANCE: f64 = 1e-12;

/// Newton converges in two to six iterations for smooth laws; laws with an infinite slope at zero
/// strain or rate need up to a few dozen to find the scale of a tiny root.
const MAX_ITERATIONS: usize = 100;

/// The next increment after `increment`, from Newton's step and from the share of the rate in the slope that it
/// was found with.
///
/// In place of a linear function of D this solves A (D/D₀ − 1) + B ln(D/D₀) = g, with the slopes A + B at D₀: strength
/// grows with the logarithm of the rate, and Newton's step, which does not know it, is several times too long from
/// the rate-independent solution. The fourth-order step of F. N. Fritsch, R. E. Shafer & W. P. Crowley, Communications
/// of the ACM 16 (1973), 123-124, with x = g/(A + B) and the share p = B/(A + B):
///
/// ```text
///   D = D₀ (1 + x (1 + ⅔ x − ½ p x)/(1 + ⅔ x − p x)),   |x| < 1            [eq:return-step]
/// ```
///
/// Longer steps are Newton's upwards, in D, and hardly less than those in ln D downwards: neither passes the root.
#[inline(always)]
fn step_in_rate<S: Simd>(increment: Lanes<S>, step: Lanes<S>, share: Lanes<S>) -> Lanes<S> {
    let one = increment.one();
    let x = step.over(increment);
    let scale = one + x * (2.0 / 3.0);
    let correction = share * x;
    let near = step * (scale - correction * 0.5).over(scale - correction);
    // exp(−x) from below: a sixteenth of it, to the second order.
    let part = x * (-1.0 / 16.0);
    let mut down = one + part * (one + part * 0.5);
    for _ in 0..4 {
        down = down * down;
    }
    let far = increment.over(down);
    let next = increment + x.if_less(1.0, near, step);
    (-one).if_below(x, next, far)
}

#[inline(always)]
fn scalar(x: f64) -> Lanes<Scalar> {
    Lanes::splat(Scalar, x)
}

/// The scalar problem of one point.
pub(crate) struct RadialReturn {
    /// τ_eq,trial, Pa, above J σ_Y at rate zero.
    pub(crate) trial_stress: f64,
    /// μ, Pa.
    pub(crate) shear_modulus: f64,
    /// J.
    pub(crate) jacobian: f64,
    /// ε_p of the committed history.
    pub(crate) plastic_strain: f64,
    /// Δt, s; in a step of no time the rate is zero.
    pub(crate) dt: f64,
    /// T, K.
    pub(crate) temperature: f64,
}

impl RadialReturn {
    /// What the equivalent stress loses per plastic strain, over μ.
    pub(crate) const STIFFNESS: f64 = 3.0;

    /// 1/Δt; zero in a step of no time, whose rates are zero.
    #[inline(always)]
    fn per_time(dt: f64) -> f64 {
        if dt > 0.0 { 1.0 / dt } else { 0.0 }
    }

    /// Δε_p of radial return: the root D of
    ///
    /// ```text
    ///   g(D) = τ_eq,trial − 3 μ D − J σ_Y(ε_p + D, D/Δt, T)                    [eq:return-rate]
    /// ```
    ///
    /// Newton's iteration inside a bracket, with the logarithm of the rate in mind (`step_in_rate`). For a law that does not soften g falls strictly from
    /// g(0) > 0 to g(τ_eq/3μ) ≤ 0, so the root exists and is unique. For linear hardening the first
    /// iterate is exact, D = (τ_eq,trial − J σ_Y) / (3 μ + J H): Greto & Kulasegaram 2019, (A.15), with
    /// the factors J it lacks. Without strength all of the trial stress goes, D = τ_eq,trial/3μ.
    ///
    /// # Arguments
    /// * `start`: σ_Y and its slopes at ε_p and rate zero, which the caller has from testing for yield.
    /// * `flow_stress`: the same at any state; the slopes may be infinite.
    ///
    /// # Errors
    /// [`MaterialError::ReturnMap`] if the residual stays above 1e-12 of the trial stress.
    #[inline]
    pub(crate) fn plastic_increment(
        &self,
        start: FlowStress,
        flow_stress: impl Fn(&FlowState) -> FlowStress,
    ) -> Result<f64, MaterialError> {
        let &Self {
            trial_stress,
            jacobian,
            ..
        } = self;
        let stiffness = Self::STIFFNESS * self.shear_modulus;
        let tolerance = TOLERANCE * trial_stress;
        let per_time = Self::per_time(self.dt);
        let (mut low, mut high) = (0.0, trial_stress / stiffness);
        if start.value == 0.0 {
            return Ok(high);
        }
        let mut increment = 0.0;
        let mut residual = f64::NAN;
        for iteration in 0..MAX_ITERATIONS {
            let flow = if iteration == 0 {
                start
            } else {
                flow_stress(&FlowState {
                    plastic_strain: self.plastic_strain + increment,
                    rate: increment * per_time,
                    temperature: self.temperature,
                })
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
            let rate_stiffness = flow.rate_slope * per_time;
            let total = stiffness + jacobian * (flow.slope + rate_stiffness);
            let step = residual / total;
            increment = if iteration > 0 && flow.rate_slope > 0.0 {
                let share = jacobian * rate_stiffness / total;
                let [increment, step, share] = [increment, step, share].map(scalar);
                step_in_rate(increment, step, share).largest()
            } else {
                increment + step
            };
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

    /// The increment of a law, the equivalent stress that it leaves, and its work per volume. Without strength
    /// nothing of the stress is left.
    #[inline]
    pub(crate) fn flow(
        &self,
        hardening: &Hardening,
        start: FlowStress,
    ) -> Result<PlasticFlow, MaterialError> {
        let increment = self.plastic_increment(start, |at| {
            hardening.flow_stress_near(&start, self.plastic_strain, at)
        })?;
        let (stress, work) = if start.value > 0.0 {
            let stress = self.trial_stress - Self::STIFFNESS * self.shear_modulus * increment;
            (stress, stress * increment)
        } else {
            (0.0, 0.5 * self.trial_stress * increment)
        };
        Ok(PlasticFlow {
            increment,
            stress,
            work,
        })
    }
}

/// What radial return makes of one point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlasticFlow {
    /// Δε_p.
    pub(crate) increment: f64,
    /// τ_eq, Pa.
    pub(crate) stress: f64,
    /// Plastic work, J per m³ of reference volume.
    pub(crate) work: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hardening::{Hardening, HardeningLaw, JohnsonCook, Ludwik, ZerilliArmstrong};

    fn problem(trial_stress: f64, dt: f64, temperature: f64) -> RadialReturn {
        RadialReturn {
            trial_stress,
            shear_modulus: 40e9,
            jacobian: 1.0,
            plastic_strain: 0.0,
            dt,
            temperature,
        }
    }

    #[test]
    fn linear_hardening_has_its_closed_form() {
        let (trial, mu, jacobian, yield_stress, modulus) = (0.9e9, 43e9, 0.97, 0.4e9, 0.1e9);
        let law = |at: &FlowState| {
            FlowStress::rate_independent(yield_stress + modulus * at.plastic_strain, modulus)
        };
        let start = FlowStress::rate_independent(yield_stress + modulus * 0.25, modulus);
        let increment = RadialReturn {
            shear_modulus: mu,
            jacobian,
            plastic_strain: 0.25,
            ..problem(trial, 1e-6, 300.0)
        }
        .plastic_increment(start, law)
        .unwrap();
        // Greto & Kulasegaram 2019, (A.15), for Kirchhoff stresses.
        let expected =
            (trial - jacobian * (yield_stress + modulus * 0.25)) / (3.0 * mu + jacobian * modulus);
        assert!((increment / expected - 1.0).abs() < 1e-13);
    }

    /// Solves for a law from undeformed material and asserts that the equation is met.
    fn assert_solved(law: &Hardening, overstress: f64, dt: f64, temperature: f64) {
        let at = |increment: f64| FlowState {
            plastic_strain: increment,
            rate: increment / dt,
            temperature,
        };
        let start = law.flow_stress(&at(0.0));
        let trial = start.value * (1.0 + overstress);
        let increment = problem(trial, dt, temperature)
            .plastic_increment(start, |at| law.flow_stress(at))
            .unwrap();
        let met = trial - 3.0 * 40e9 * increment - law.flow_stress(&at(increment)).value;
        // The rate is here a quotient, there a product with 1/Δt: a rounding apart.
        assert!(
            increment > 0.0 && met.abs() <= 2e-12 * trial,
            "{law:?} {overstress} {dt}: {increment} misses by {met}"
        );
    }

    const OVERSTRESSES: [f64; 6] = [10.0, 1.0, 1e-2, 1e-5, 1e-8, 1e-10];

    #[test]
    fn infinite_initial_slope_is_solved_from_the_largest_to_the_smallest_overstress() {
        for exponent in [0.05, 0.2, 0.5, 0.9, 1.0] {
            let law = Hardening::Ludwik(Ludwik {
                initial_yield_stress: 0.3e9,
                coefficient: 0.5e9,
                exponent,
            });
            for overstress in OVERSTRESSES {
                assert_solved(&law, overstress, 1e-6, 300.0);
            }
        }
    }

    #[test]
    fn rate_dependence_is_solved_for_steps_of_any_length() {
        let laws = JohnsonCook::examples()
            .into_iter()
            .map(Hardening::JohnsonCook)
            .chain(
                ZerilliArmstrong::examples()
                    .into_iter()
                    .map(Hardening::ZerilliArmstrong),
            );
        for law in laws {
            for overstress in OVERSTRESSES {
                for dt in [1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3] {
                    for temperature in [293.15, 900.0] {
                        assert_solved(&law, overstress, dt, temperature);
                    }
                }
            }
        }
    }

    #[test]
    fn molten_metal_keeps_no_stress() {
        let law = &JohnsonCook::examples()[0];
        let start = law.flow_stress(&FlowState {
            plastic_strain: 0.0,
            rate: 0.0,
            temperature: 1400.0,
        });
        let increment = problem(1e6, 1e-6, 1400.0)
            .plastic_increment(start, |at| law.flow_stress(at))
            .unwrap();
        assert_eq!(increment, 1e6 / (3.0 * 40e9));
    }

    #[test]
    fn a_law_that_never_meets_the_stress_is_reported_with_its_residual() {
        let broken = |_: &FlowState| FlowStress::rate_independent(f64::NAN, 0.0);
        let start = FlowStress::rate_independent(f64::NAN, 0.0);
        let error = problem(1e9, 1e-6, 300.0)
            .plastic_increment(start, broken)
            .unwrap_err();
        assert!(
            matches!(error, MaterialError::ReturnMap { residual, iterations: 100, .. } if residual.is_nan())
        );
    }
}
