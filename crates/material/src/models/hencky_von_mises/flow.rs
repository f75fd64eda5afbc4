//! Radial return of many points: yield, plastic increment and what follows from it for the stress.

use super::HenckyVonMises;
use super::tile::Trial;
use crate::hardening::FlowState;
use crate::logarithmic_strain::SERIES_LIMIT;
use crate::return_map::{RadialReturn, TileProblem, TileSolution};
use crate::{KinematicsTile, PlasticHistory};
use jstsph_tensor::lanes::{Lanes, Simd, TILE, WithSimd, vectorised};

/// Plastic increment up to which exp(−2 Δε_p ν) is inside the range of its series: |2 Δε_p ν|² = 6 Δε_p².
const LARGEST_INCREMENT: f64 = 0.04;

/// What radial return makes of the trial.
pub(super) struct Flow {
    pub(super) plastic: bool,
    pub(super) increment: [f64; TILE],
    pub(super) plastic_work: [f64; TILE],
    /// τ_eq, Pa.
    pub(super) equivalent_stress: [f64; TILE],
    /// −3 Δε_p/τ_eq,trial: the change of the elastic strain over the trial stress, twice.
    pub(super) direction: [f64; TILE],
    /// τ_eq/τ_eq,trial.
    pub(super) ratio: [f64; TILE],
}

impl Flow {
    const NONE: Self = Self {
        plastic: false,
        increment: [0.0; TILE],
        plastic_work: [0.0; TILE],
        equivalent_stress: [0.0; TILE],
        direction: [0.0; TILE],
        ratio: [1.0; TILE],
    };

    /// `None` for a point that is not sound, or outside the range of the series.
    #[inline(always)]
    pub(super) fn of(
        model: &HenckyVonMises,
        shear_modulus: &[f64; TILE],
        now: &KinematicsTile,
        old: &[PlasticHistory],
        trial: &Trial,
    ) -> Option<Self> {
        let sound = vectorised(Soundness {
            trial,
            jacobian: &now.jacobian,
        });
        if !sound {
            return None;
        }
        let mut plastic_strain = [0.0; TILE];
        for (strain, old) in plastic_strain.iter_mut().zip(old) {
            *strain = old.equivalent_plastic_strain;
        }
        let problem = TileProblem {
            trial_stress: &trial.equivalent_stress,
            jacobian: &now.jacobian,
            plastic_strain,
            shear_modulus,
            temperature: &now.temperature,
            dt: now.dt,
        };
        let mut flow = Self::NONE;
        let mut solution = TileSolution::ALL_PENDING;
        model.hardening.solve_tile(&problem, &mut solution);
        vectorised(Consequences {
            problem: &problem,
            increment: &solution.increment,
            flow: &mut flow,
        });
        flow.increment = solution.increment;
        for (i, pending) in solution.pending.iter().enumerate() {
            if *pending > 0.0 {
                flow.set(i, &problem, model)?;
            }
        }
        let largest = flow.increment.iter().copied().fold(0.0, f64::max);
        flow.plastic = largest > 0.0;
        (largest <= LARGEST_INCREMENT).then_some(flow)
    }

    /// One point as `respond` does it; `None` if that would fail.
    fn set(&mut self, i: usize, problem: &TileProblem, model: &HenckyVonMises) -> Option<()> {
        let (trial_stress, jacobian) = (problem.trial_stress[i], problem.jacobian[i]);
        let (plastic_strain, temperature) = (problem.plastic_strain[i], problem.temperature[i]);
        let start = model.hardening.flow_stress(&FlowState {
            plastic_strain,
            rate: 0.0,
            temperature,
        });
        let flow = RadialReturn {
            trial_stress,
            shear_modulus: problem.shear_modulus[i],
            jacobian,
            plastic_strain,
            dt: problem.dt,
            temperature,
        }
        .flow(&model.hardening, start)
        .ok()?;
        self.increment[i] = flow.increment;
        self.plastic_work[i] = flow.work;
        self.equivalent_stress[i] = flow.stress;
        self.direction[i] = -3.0 * flow.increment / trial_stress;
        self.ratio[i] = flow.stress / trial_stress;
        Some(())
    }
}

/// Whether all points have a positive finite J and det F, a distortion inside the range of the series
/// and a stress that is a number.
struct Soundness<'a> {
    trial: &'a Trial,
    jacobian: &'a [f64; TILE],
}

impl WithSimd for Soundness<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let mut unsound = zero;
        for pack in 0..TILE / S::F64_LANES {
            let determinant = Lanes::load(simd, &self.trial.determinant, pack);
            let jacobian = Lanes::load(simd, self.jacobian, pack);
            let distortion = Lanes::load(simd, &self.trial.distortion, pack);
            let stress = Lanes::load(simd, &self.trial.equivalent_stress, pack);
            let mut bad = distortion.if_less(SERIES_LIMIT, zero, one);
            for positive in [determinant, jacobian] {
                bad = zero.if_below(positive, bad, one);
                bad = positive.if_less(f64::INFINITY, bad, one);
            }
            unsound = unsound + stress.if_less(f64::INFINITY, bad, one);
        }
        unsound.largest() <= 0.0
    }
}

/// Stress, work and direction after the increments, as `Flow::set` does them.
struct Consequences<'a, 'b> {
    problem: &'a TileProblem<'b>,
    increment: &'a [f64; TILE],
    flow: &'a mut Flow,
}

impl WithSimd for Consequences<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        for pack in 0..TILE / S::F64_LANES {
            let trial_stress = Lanes::load(simd, self.problem.trial_stress, pack);
            let increment = Lanes::load(simd, self.increment, pack);
            let shear_modulus = Lanes::load(simd, self.problem.shear_modulus, pack);
            let stiffness = shear_modulus * RadialReturn::STIFFNESS;
            let stress = trial_stress - stiffness * increment;
            let direction = (increment * -3.0).over(trial_stress);
            // Of an elastic point, whose trial stress may be zero, nothing changes.
            let ratio = zero.if_below(increment, stress.over(trial_stress), one);
            let direction = zero.if_below(increment, direction, zero);
            stress.store(&mut self.flow.equivalent_stress, pack);
            (stress * increment).store(&mut self.flow.plastic_work, pack);
            direction.store(&mut self.flow.direction, pack);
            ratio.store(&mut self.flow.ratio, pack);
        }
    }
}
