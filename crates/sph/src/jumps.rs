//! What a field jumps between particles beyond its linear prediction, for runs of particles with the
//! vector instructions of the machine.

use std::sync::Arc;

use jstsph_tensor::lanes::{Simd, WithSimd, vectorised};
use jstsph_tensor::{Mat3, Vec3};

use crate::gradient::passes::{add_product, sum_of_columns};
use crate::rows::Rows;
use crate::{PairOperator, Support};

/// Σ_b ℓ_ab [f_b − f_a − ½ (G_a + G_b)(X_b − X_a)] for the weights of a [`PairOperator`]: zero for a
/// linear field with its gradient G.
#[derive(Clone, Debug)]
pub struct JumpOperator {
    pairs: Arc<PairOperator>,
    /// ℓ_ab (X_b − X_a), shared as the weights are.
    moments: Rows<[f64; 3]>,
    /// Σ_b ℓ_ab (X_b − X_a).
    first_moments: Vec<Vec3>,
}

impl JumpOperator {
    /// Adds the moments of the pairs of some particles.
    ///
    /// # Panics
    /// If there is not one position per particle.
    #[must_use]
    pub fn new(pairs: Arc<PairOperator>, positions: &[Vec3], support: &Support) -> Self {
        assert_eq!(
            positions.len(),
            pairs.particles(),
            "one position per particle"
        );
        // Weights have the size 1/h².
        let scale = 1.0 / support.smoothing_length;
        let moments = Rows::build(positions.len(), scale, |a, entries| {
            entries.extend(pairs.row(a).entries().map(|(b, weight)| {
                let moment: [f64; 3] = ((positions[b] - positions[a]) * *weight).into();
                (b as u32, moment)
            }));
        });
        let first_moments = (0..positions.len())
            .map(|a| moments.row(a).weights.iter().map(|m| Vec3::from(*m)).sum())
            .collect();
        Self {
            pairs,
            moments,
            first_moments,
        }
    }

    /// The weights ℓ_ab.
    #[must_use]
    pub fn pairs(&self) -> &PairOperator {
        &self.pairs
    }

    /// The jumps at one particle; readable, and what [`add_jumps`](Self::add_jumps) is compared with.
    #[must_use]
    pub fn jumps_at(
        &self,
        particle: usize,
        positions: &[Vec3],
        field: &[Vec3],
        gradients: &[Mat3],
    ) -> Vec3 {
        let a = particle;
        self.pairs
            .row(a)
            .entries()
            .fold(Vec3::zeros(), |sum, (b, weight)| {
                let offset = positions[b] - positions[a];
                let predicted = (gradients[a] + gradients[b]) * offset * 0.5;
                sum + (field[b] - field[a] - predicted) * *weight
            })
    }

    /// Adds `factors[0]` times the jumps to `out`, for the particles from `first` on, as many as there
    /// are in it, with `factors[1]` times `gradients` as G. The field has a fourth number that is not
    /// used. Another order of sums than in [`jumps_at`](Self::jumps_at): they differ by round-off.
    ///
    /// # Panics
    /// If there are not as many particles, or fewer values than particles: a bug in the caller.
    pub fn add_jumps(
        &self,
        first: usize,
        field: &[[f64; 4]],
        gradients: &[Mat3],
        factors: [f64; 2],
        out: &mut [Vec3],
    ) {
        vectorised(Jumps {
            operator: self,
            first,
            field,
            gradients,
            factors,
            out,
        });
    }
}

struct Jumps<'a> {
    operator: &'a JumpOperator,
    first: usize,
    field: &'a [[f64; 4]],
    gradients: &'a [Mat3],
    factors: [f64; 2],
    out: &'a mut [Vec3],
}

impl WithSimd for Jumps<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let [factor, scale] = self.factors;
        for (k, out) in self.out.iter_mut().enumerate() {
            let a = self.first + k;
            let row = self.operator.pairs.row(a);
            let moments = self.operator.moments.row(a).weights;
            let (field, gradients) = (&self.field[row.first..], &self.gradients[row.first..]);
            let own = self.field[a];
            let mut jumps = [0.0; 4];
            let mut columns = [[0.0; 4]; 3];
            for ((&b, weight), moment) in row.steps.iter().zip(row.weights).zip(moments) {
                let other = &field[b as usize];
                for i in 0..4 {
                    jumps[i] += (other[i] - own[i]) * weight;
                }
                add_product(&gradients[b as usize], moment, &mut columns);
            }
            // Σ_b ℓ_ab (G_a + G_b)(X_b − X_a): the part with G_a is one product.
            let own = self.operator.first_moments[a];
            add_product(&self.gradients[a], &own.into(), &mut columns);
            let predicted = sum_of_columns(&columns) * (0.5 * scale);
            *out += (Vec3::new(jumps[0], jumps[1], jumps[2]) - predicted) * factor;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, jittered_box, support_of, unit_box};

    #[test]
    fn runs_agree_with_single_particles_and_linear_fields_do_not_jump() {
        let mut random = Random(3);
        for body in [unit_box(9, 2), unit_box(5, 3), jittered_box(5, 3)] {
            let support = support_of(&body, 1.2);
            let pairs = PairOperator::symmetric(&body.positions, &body.volumes, &support).unwrap();
            let operator = JumpOperator::new(pairs.into(), &body.positions, &support);
            let count = body.positions.len();
            let field: Vec<Vec3> = (0..count).map(|_| random.vector()).collect();
            let gradients: Vec<Mat3> = (0..count).map(|_| random.tensor()).collect();
            let slope = random.tensor();
            let linear: Vec<Vec3> = body.positions.iter().map(|x| slope * x).collect();
            let pad = |field: &[Vec3]| -> Vec<[f64; 4]> {
                field.iter().map(|f| [f.x, f.y, f.z, 7.0]).collect()
            };
            // Sums of some fifty terms of the size of ℓ.
            let size = operator.pairs().spectral_bound();
            let first = 3;
            let mut out = vec![Vec3::x(); count - first];
            operator.add_jumps(first, &pad(&field), &gradients, [2.0, 3.0], &mut out);
            for (k, found) in out.iter().enumerate() {
                let scaled: Vec<Mat3> = gradients.iter().map(|g| g * 3.0).collect();
                let jumps = operator.jumps_at(first + k, &body.positions, &field, &scaled);
                let expected = Vec3::x() + jumps * 2.0;
                assert!(
                    (found - expected).norm() < 1e-13 * size,
                    "{k}: {found} {expected}"
                );
            }
            let mut out = vec![Vec3::zeros(); count];
            operator.add_jumps(0, &pad(&linear), &vec![slope; count], [1.0; 2], &mut out);
            for jump in out {
                // Weights are shared within 1e-11 of the largest.
                assert!(jump.norm() < 1e-10 * size, "{jump}");
            }
        }
    }
}
