//! The scalar equations of radial return of many points at once, in the order of `plastic_increment`.

use super::{RadialReturn, TOLERANCE};
use crate::hardening::{FlowLanes, HardeningLaw};
use jstsph_tensor::lanes::{Lanes, Simd, TILE, WithSimd};

/// Evaluations of the flow stress after the first: what takes longer is left to single points.
const ITERATIONS: usize = 4;

/// The equations of a tile of points that all have the same shear modulus.
pub(crate) struct TileProblem<'a> {
    /// τ_eq,trial, Pa.
    pub(crate) trial_stress: &'a [f64; TILE],
    /// J, positive.
    pub(crate) jacobian: &'a [f64; TILE],
    /// ε_p of the committed history.
    pub(crate) plastic_strain: [f64; TILE],
    /// μ, Pa.
    pub(crate) shear_modulus: f64,
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

/// Newton's iteration of all points, bit by bit that of [`RadialReturn::plastic_increment`].
pub(crate) struct TileReturn<'a, 'b, Law> {
    pub(crate) law: &'a Law,
    pub(crate) problem: &'a TileProblem<'b>,
    pub(crate) solution: &'a mut TileSolution,
}

impl<Law: HardeningLaw> WithSimd for TileReturn<'_, '_, Law> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (problem, solution) = (self.problem, self.solution);
        let (mut value, mut slope) = ([0.0; TILE], [0.0; TILE]);
        let start = [&mut value, &mut slope];
        self.law
            .flow_stress_tile(simd, &problem.plastic_strain, start);

        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let stiffness = Lanes::splat(simd, RadialReturn::stiffness(problem.shear_modulus));
        for pack in 0..TILE / S::F64_LANES {
            let trial_stress = Lanes::load(simd, problem.trial_stress, pack);
            let jacobian = Lanes::load(simd, problem.jacobian, pack);
            let from = Lanes::load(simd, &problem.plastic_strain, pack);
            let start = FlowLanes {
                value: Lanes::load(simd, &value, pack),
                slope: Lanes::load(simd, &slope, pack),
            };
            let tolerance = trial_stress * TOLERANCE;
            let yield_stress = jacobian * start.value;

            let (mut low, mut high) = (zero, trial_stress.over(stiffness));
            let residual = trial_stress - yield_stress;
            let first = residual.over(stiffness + jacobian * start.slope);
            let mut increment = trial_stress.if_at_most(yield_stress, zero, first);
            let mut pending = trial_stress.if_at_most(yield_stress, zero, one);
            // A lane outside its bracket, and one without strength, stays pending to the end.
            let inside = zero.if_below(start.value, zero.if_below(increment, one, zero), zero);
            let mut lost = pending - pending * increment.if_below(high, inside, zero);

            for _ in 0..ITERATIONS {
                let open = pending - lost;
                if open.largest() <= 0.0 {
                    break;
                }
                let flow = self
                    .law
                    .flow_stress_lanes(simd, &start, from, from + increment);
                let residual = trial_stress - stiffness * increment - jacobian * flow.value;
                let next = increment + residual.over(stiffness + jacobian * flow.slope);
                low = zero.if_below(residual, increment, low);
                high = zero.if_below(residual, high, increment);
                let inside = low.if_below(next, next.if_below(high, one, zero), zero);

                let met = residual.abs().if_at_most(tolerance, one, zero);
                // Of the open lanes: those that are met keep their increment, those inside their bracket
                // move on, the others are lost.
                let moves = open * (one - met) * inside;
                lost = lost + open * (one - met) * (one - inside);
                pending = pending - open * met;
                increment = zero.if_below(moves, next, increment);
            }
            increment.store(&mut solution.increment, pack);
            pending.store(&mut solution.pending, pack);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hardening::{FlowState, Hardening};

    fn laws_on_lanes() -> Vec<Hardening> {
        let (trial_stress, jacobian) = ([1.0; TILE], [1.0; TILE]);
        let problem = TileProblem {
            trial_stress: &trial_stress,
            jacobian: &jacobian,
            plastic_strain: [0.0; TILE],
            shear_modulus: 40e9,
        };
        let mut laws = Hardening::examples();
        laws.retain(|law| {
            let mut solution = TileSolution::ALL_PENDING;
            law.solve_tile(&problem, &mut solution)
        });
        laws
    }

    /// σ_Y of every point at rate zero.
    fn flow_stress(law: &Hardening, plastic_strain: f64) -> crate::hardening::FlowStress {
        law.flow_stress(&FlowState {
            plastic_strain,
            rate: 0.0,
            temperature: crate::ROOM_TEMPERATURE,
        })
    }

    #[test]
    fn lanes_find_the_increments_of_single_points_bit_by_bit() {
        let laws = laws_on_lanes();
        assert!(laws.len() >= 3, "{laws:?}");
        for law in &laws {
            for overstress in [1e-9, 1e-6, 1e-3, 1e-2] {
                let plastic_strain = std::array::from_fn(|i| 0.02 * i as f64);
                let jacobian = std::array::from_fn(|i| 1.0 + 1e-3 * (i as f64 - 9.0));
                // Every fourth point stays elastic.
                let trial_stress: [f64; TILE] = std::array::from_fn(|i| {
                    let factor = if i % 4 == 3 {
                        0.9
                    } else {
                        1.0 + overstress * (1 + i) as f64 / 16.0
                    };
                    jacobian[i] * flow_stress(law, plastic_strain[i]).value * factor
                });
                let problem = TileProblem {
                    trial_stress: &trial_stress,
                    jacobian: &jacobian,
                    plastic_strain,
                    shear_modulus: 40e9,
                };
                let mut solution = TileSolution::ALL_PENDING;
                assert!(law.solve_tile(&problem, &mut solution));
                assert_eq!(solution.pending, [0.0; TILE], "{law:?} {overstress}");
                for i in 0..TILE {
                    let start = flow_stress(law, plastic_strain[i]);
                    let expected = if i % 4 == 3 {
                        0.0
                    } else {
                        RadialReturn {
                            trial_stress: trial_stress[i],
                            shear_modulus: 40e9,
                            jacobian: jacobian[i],
                            plastic_strain: plastic_strain[i],
                            dt: 1e-7,
                            temperature: crate::ROOM_TEMPERATURE,
                        }
                        .plastic_increment(start, |at| {
                            law.flow_stress_near(&start, plastic_strain[i], at)
                        })
                        .unwrap()
                    };
                    assert_eq!(solution.increment[i], expected, "{law:?} {overstress} {i}");
                }
            }
        }
    }

    #[test]
    fn points_out_of_reach_of_the_lanes_are_left_pending() {
        let law = laws_on_lanes()
            .into_iter()
            .find(|law| law.name() == "swift")
            .unwrap();
        // An increment far outside the range of the series.
        let (trial_stress, jacobian) = ([9e9; TILE], [1.0; TILE]);
        let problem = TileProblem {
            trial_stress: &trial_stress,
            jacobian: &jacobian,
            plastic_strain: [0.0; TILE],
            shear_modulus: 40e9,
        };
        let mut solution = TileSolution::ALL_PENDING;
        assert!(law.solve_tile(&problem, &mut solution));
        assert_eq!(solution.pending, [1.0; TILE]);
    }
}
