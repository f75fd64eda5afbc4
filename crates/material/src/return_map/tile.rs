//! The scalar equations of radial return of many points at once, in the order of `plastic_increment`.

use super::{RadialReturn, TOLERANCE, step_in_rate};
use crate::hardening::{FlowStateTile, FlowStressTile, HardeningLaw};
use jstsph_tensor::lanes::{Lanes, Simd, TILE, WithSimd};

/// Evaluations of the flow stress after the first: what takes longer is left to single points.
const ITERATIONS: usize = 12;

/// The equations of a tile of points.
pub(crate) struct TileProblem<'a> {
    /// τ_eq,trial, Pa.
    pub(crate) trial_stress: &'a [f64; TILE],
    /// J, positive.
    pub(crate) jacobian: &'a [f64; TILE],
    /// ε_p of the committed history.
    pub(crate) plastic_strain: [f64; TILE],
    /// μ, Pa.
    pub(crate) shear_modulus: &'a [f64; TILE],
    /// T, K.
    pub(crate) temperature: &'a [f64; TILE],
    /// Δt, s.
    pub(crate) dt: f64,
}

/// Their solutions.
pub(crate) struct TileSolution {
    /// Δε_p; zero where the point stays elastic.
    pub(crate) increment: [f64; TILE],
    /// 0 where that is the answer, 1 where it is left to [`RadialReturn`].
    pub(crate) pending: [f64; TILE],
}

impl TileSolution {
    pub(crate) const ALL_PENDING: Self = Self {
        increment: [0.0; TILE],
        pending: [1.0; TILE],
    };
}

/// The iteration of all points, bit by bit that of [`RadialReturn::plastic_increment`].
pub(crate) struct TileReturn<'a, 'b, Law> {
    pub(crate) law: &'a Law,
    pub(crate) problem: &'a TileProblem<'b>,
    pub(crate) solution: &'a mut TileSolution,
}

impl<Law: HardeningLaw> WithSimd for TileReturn<'_, '_, Law> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (law, problem) = (self.law, self.problem);
        let mut at = FlowStateTile {
            plastic_strain: problem.plastic_strain,
            rate: [0.0; TILE],
            temperature: *problem.temperature,
        };
        let mut start = FlowStressTile::ZERO;
        law.flow_stress_tile(simd, &at, &mut start);
        let mut search = Search {
            problem,
            solution: self.solution,
            low: [0.0; TILE],
            high: [0.0; TILE],
            open: [0.0; TILE],
        };
        let mut open = search.begin::<S, Law>(simd, &start);
        let mut flow = start.clone();
        for _ in 0..ITERATIONS {
            if !open {
                break;
            }
            search.state::<S, Law>(simd, &mut at);
            law.flow_stress_near_tile(simd, &start, &problem.plastic_strain, &at, &mut flow);
            open = search.step::<S, Law>(simd, &flow);
        }
    }
}

/// The brackets of all points.
struct Search<'a, 'b> {
    problem: &'a TileProblem<'b>,
    solution: &'a mut TileSolution,
    low: [f64; TILE],
    high: [f64; TILE],
    /// 1 where the increment is looked for, else 0.
    open: [f64; TILE],
}

impl Search<'_, '_> {
    /// Which points flow, and their first increment; whether there are any.
    #[inline(always)]
    fn begin<S: Simd, Law: HardeningLaw>(&mut self, simd: S, start: &FlowStressTile) -> bool {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let mut any = zero;
        for pack in 0..TILE / S::F64_LANES {
            let trial_stress = Lanes::load(simd, self.problem.trial_stress, pack);
            let jacobian = Lanes::load(simd, self.problem.jacobian, pack);
            let stiffness = self.stiffness(simd, pack);
            let strength = Lanes::load(simd, &start.value, pack);
            let yield_stress = jacobian * strength;
            let pending = trial_stress.if_at_most(yield_stress, zero, one);
            // A point without strength is left pending.
            let open = zero.if_below(strength, pending, zero);
            let high = trial_stress.over(stiffness);
            let total = stiffness + jacobian * self.slope::<S, Law>(simd, start, pack)[0];
            let next = (trial_stress - yield_stress).over(total);
            let first = inside([zero, high], next);
            zero.if_below(open, first, zero)
                .store(&mut self.solution.increment, pack);
            pending.store(&mut self.solution.pending, pack);
            zero.store(&mut self.low, pack);
            high.store(&mut self.high, pack);
            open.store(&mut self.open, pack);
            any = any + open;
        }
        any.largest() > 0.0
    }

    /// Where the flow stress is asked for.
    #[inline(always)]
    fn state<S: Simd, Law: HardeningLaw>(&self, simd: S, at: &mut FlowStateTile) {
        let per_time = self.per_time();
        for pack in 0..TILE / S::F64_LANES {
            let increment = Lanes::load(simd, &self.solution.increment, pack);
            let from = Lanes::load(simd, &self.problem.plastic_strain, pack);
            (from + increment).store(&mut at.plastic_strain, pack);
            if Law::RATE_DEPENDENT {
                (increment * per_time).store(&mut at.rate, pack);
            }
        }
    }

    /// One iteration; whether any point needs another.
    #[inline(always)]
    fn step<S: Simd, Law: HardeningLaw>(&mut self, simd: S, flow: &FlowStressTile) -> bool {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let mut any = zero;
        for pack in 0..TILE / S::F64_LANES {
            let trial_stress = Lanes::load(simd, self.problem.trial_stress, pack);
            let jacobian = Lanes::load(simd, self.problem.jacobian, pack);
            let stiffness = self.stiffness(simd, pack);
            let increment = Lanes::load(simd, &self.solution.increment, pack);
            let value = Lanes::load(simd, &flow.value, pack);
            let residual = trial_stress - stiffness * increment - jacobian * value;
            let met = residual
                .abs()
                .if_at_most(trial_stress * TOLERANCE, one, zero);
            let open = Lanes::load(simd, &self.open, pack);
            let still = open * (one - met);
            still.store(&mut self.open, pack);
            any = any + still;
            let pending = Lanes::load(simd, &self.solution.pending, pack);
            (pending - open * met).store(&mut self.solution.pending, pack);

            let low = Lanes::load(simd, &self.low, pack);
            let high = Lanes::load(simd, &self.high, pack);
            let low = zero.if_below(residual, increment, low);
            let high = zero.if_below(residual, high, increment);
            low.store(&mut self.low, pack);
            high.store(&mut self.high, pack);

            let [slope, rate_stiffness] = self.slope::<S, Law>(simd, flow, pack);
            let total = stiffness + jacobian * slope;
            let newton = residual.over(total);
            let mut next = increment + newton;
            if Law::RATE_DEPENDENT {
                let share = (jacobian * rate_stiffness).over(total);
                let rate_slope = Lanes::load(simd, &flow.rate_slope, pack);
                next = zero.if_below(rate_slope, step_in_rate(increment, newton, share), next);
            }
            let next = inside([low, high], next);
            zero.if_below(still, next, increment)
                .store(&mut self.solution.increment, pack);
        }
        any.largest() > 0.0
    }

    /// ∂σ_Y/∂Δε_p, and the part of the rate in it.
    #[inline(always)]
    fn slope<S: Simd, Law: HardeningLaw>(
        &self,
        simd: S,
        flow: &FlowStressTile,
        pack: usize,
    ) -> [Lanes<S>; 2] {
        let slope = Lanes::load(simd, &flow.slope, pack);
        if !Law::RATE_DEPENDENT {
            return [slope, slope.zero()];
        }
        let of_rate = Lanes::load(simd, &flow.rate_slope, pack) * self.per_time();
        [slope + of_rate, of_rate]
    }

    #[inline(always)]
    fn stiffness<S: Simd>(&self, simd: S, pack: usize) -> Lanes<S> {
        Lanes::load(simd, self.problem.shear_modulus, pack) * RadialReturn::STIFFNESS
    }

    #[inline(always)]
    fn per_time(&self) -> f64 {
        RadialReturn::per_time(self.problem.dt)
    }
}

/// The next increment, or another one where it is not inside its bracket.
#[inline(always)]
fn inside<S: Simd>([low, high]: [Lanes<S>; 2], next: Lanes<S>) -> Lanes<S> {
    let zero = low.zero();
    let middle = zero.if_below(low, (low * high).sqrt(), high * 1e-3);
    low.if_below(next, next.if_below(high, next, middle), middle)
}

#[cfg(test)]
mod tests;
