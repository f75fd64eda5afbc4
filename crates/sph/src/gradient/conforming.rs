//! The smallest change of the gradient operator that makes it sum by parts: docs/theory.md,
//! "Summation by parts near the boundary".

use jstsph_tensor::{Mat3, Vec3};

use super::{Entry, GradientOperator};
use crate::rows::Rows;

/// The conjugate gradients end when they have reduced the defect by this factor.
const REDUCTION: f64 = 1e-10;

/// Ten times what the largest body of the tests needs.
const ITERATION_LIMIT: usize = 10_000;

/// Added to the diagonal of the normal equations, over the mean volume. A linear multiplier changes
/// no row, so the equations are singular; this keeps its size bounded and changes the rest by less
/// than [`REDUCTION`] asks for.
const DAMPING: f64 = 1e-9;

/// What [`GradientOperator::summing_by_parts`] did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// Evaluation points whose row was changed.
    pub points: usize,
    /// Iterations of the conjugate gradients.
    pub iterations: usize,
    /// Largest change of an entry of B, times the smoothing length.
    pub change: f64,
}

/// A row that is changed: offsets of its particles from their mean position, and the inverse of
/// their moment matrix, for linear fits over the row.
struct Row<'a> {
    volume: f64,
    point: usize,
    particles: &'a [u32],
    offsets: Vec<Vec3>,
    inverse: Mat3,
}

impl<'a> Row<'a> {
    /// None where the particles do not determine a linear fit.
    fn new(
        operator: &'a GradientOperator,
        point: usize,
        volume: f64,
        positions: &[Vec3],
    ) -> Option<Self> {
        let (particles, _) = operator.row(point);
        let places = || particles.iter().map(|&c| positions[c as usize]);
        let mean = places().sum::<Vec3>() / particles.len() as f64;
        let offsets: Vec<Vec3> = places().map(|x| x - mean).collect();
        let mut moment = offsets
            .iter()
            .fold(Mat3::zeros(), |sum, o| sum + o * o.transpose());
        if operator.plane {
            moment.m33 = moment.norm();
        }
        Some(Self {
            volume,
            point,
            particles,
            offsets,
            inverse: moment.try_inverse()?,
        })
    }

    /// Values of a field at the particles of the row, less their linear fit.
    fn residual(&self, field: &[Vec3], out: &mut Vec<Vec3>) {
        out.clear();
        out.extend(self.particles.iter().map(|&c| field[c as usize]));
        let mean = out.iter().sum::<Vec3>() / out.len() as f64;
        let slope = out
            .iter()
            .zip(&self.offsets)
            .fold(Mat3::zeros(), |sum, (value, offset)| {
                sum + value * offset.transpose()
            })
            * self.inverse;
        for (value, offset) in out.iter_mut().zip(&self.offsets) {
            *value -= mean + slope * offset;
        }
    }
}

impl GradientOperator {
    /// The operator nearest to this one that sums by parts,
    ///
    /// ```text
    ///   Σ_q V_q B_qc = N_c   for every particle c ,
    ///   B_qc + δ_qc ,  δ_qc = λ_c − (linear fit of λ over row q)(X_c) ,
    ///   Σ_q V_q δ_qc = N_c − Σ_q V_q B_qc
    /// ```
    ///
    /// [eq:boundary-correction]. The δ of a row is orthogonal to constants and linears, so that both
    /// stay exact and momentum stays conserved; among all such changes it is the one of smallest
    /// Σ_q V_q Σ_c |δ_qc|². λ solves a symmetric, matrix-free system by conjugate gradients. Variationally
    /// consistent integration (Chen, Hillman & Rüter 2013) solves the same condition on the test side.
    ///
    /// Only rows near a particle whose defect exceeds `tolerance` change. What can be met is met: a
    /// solution exists when Σ_c (N_c − Σ_q V_q B_qc) and its first moments vanish over every
    /// connected group of these rows, which holds when N has the moments of the body's surface.
    ///
    /// # Arguments
    /// * `positions`: particles, m.
    /// * `point_volumes`: V_q, m³ (of 1 m thickness in plane strain).
    /// * `area_vectors`: N_c, one per particle, m²: zero away from the boundary.
    /// * `tolerance`: defect that is left alone, m².
    ///
    /// # Panics
    /// If the slices do not have one entry per particle and per point.
    ///
    /// # Cost
    /// Set-up only: some hundred passes over the changed rows, and these no longer share weights.
    #[must_use]
    pub fn summing_by_parts(
        &self,
        positions: &[Vec3],
        point_volumes: &[f64],
        area_vectors: &[Vec3],
        tolerance: f64,
    ) -> (Self, Correction) {
        assert_eq!(
            positions.len(),
            self.particles(),
            "one position per particle"
        );
        assert_eq!(point_volumes.len(), self.points(), "one volume per point");
        assert_eq!(
            area_vectors.len(),
            self.particles(),
            "one vector per particle"
        );
        let mut defect: Vec<Vec3> = self
            .boundary_vectors(point_volumes)
            .iter()
            .zip(area_vectors)
            .map(|(found, wanted)| wanted - found)
            .collect();
        let is_large: Vec<bool> = defect.iter().map(|d| d.norm() > tolerance).collect();
        let rows: Vec<Row<'_>> = (0..self.points())
            .filter(|&q| self.row(q).0.iter().any(|&c| is_large[c as usize]))
            .filter_map(|q| Row::new(self, q, point_volumes[q], positions))
            .collect();
        // Rows that stay cannot serve particles that only they reach.
        let mut reached = vec![false; self.particles()];
        for &c in rows.iter().flat_map(|row| row.particles) {
            reached[c as usize] = true;
        }
        for (value, reached) in defect.iter_mut().zip(reached) {
            if !reached {
                *value = Vec3::zeros();
            }
        }
        let (multiplier, iterations) = multiplier(&rows, &defect);

        let mut change = 0.0f64;
        let mut changed = rows.iter().peekable();
        let mut residual = Vec::new();
        let corrected = Rows::build(self.points(), self.scale, |q, entries: &mut Vec<Entry>| {
            let (indices, weights) = self.row(q);
            entries.extend(indices.iter().copied().zip(weights.iter().copied()));
            if let Some(row) = changed.next_if(|row| row.point == q) {
                row.residual(&multiplier, &mut residual);
                for ((_, weight), value) in entries.iter_mut().zip(&residual) {
                    change = change.max(value.norm() / self.scale);
                    *weight = (Vec3::from(*weight) + value).into();
                }
            }
        });
        let correction = Correction {
            points: rows.len(),
            iterations,
            change,
        };
        let columns = corrected.transposed(self.particles(), self.scale);
        let operator = Self {
            rows: corrected,
            columns,
            ..*self
        };
        (operator, correction)
    }
}

/// λ with Σ_q V_q (λ_c − fit_q λ (X_c)) = `defect`_c, and the number of iterations.
fn multiplier(rows: &[Row<'_>], defect: &[Vec3]) -> (Vec<Vec3>, usize) {
    let mean_volume = rows.iter().map(|row| row.volume).sum::<f64>() / rows.len().max(1) as f64;
    let squared = |field: &[Vec3]| field.iter().map(Vec3::norm_squared).sum::<f64>();
    let mut solution = vec![Vec3::zeros(); defect.len()];
    let mut residual = defect.to_vec();
    let mut direction = residual.clone();
    let mut image = vec![Vec3::zeros(); defect.len()];
    let mut scratch = Vec::new();
    let mut size = squared(&residual);
    let target = size * REDUCTION * REDUCTION;
    for iteration in 0..ITERATION_LIMIT {
        if size <= target {
            return (solution, iteration);
        }
        for (image, direction) in image.iter_mut().zip(&direction) {
            *image = direction * (DAMPING * mean_volume);
        }
        for row in rows {
            row.residual(&direction, &mut scratch);
            for (&c, value) in row.particles.iter().zip(&scratch) {
                image[c as usize] += value * row.volume;
            }
        }
        let curvature: f64 = direction.iter().zip(&image).map(|(d, i)| d.dot(i)).sum();
        let length = size / curvature;
        for (c, image) in image.iter().enumerate() {
            solution[c] += direction[c] * length;
            residual[c] -= image * length;
        }
        let ratio = squared(&residual) / size;
        size *= ratio;
        for (direction, residual) in direction.iter_mut().zip(&residual) {
            *direction = residual + *direction * ratio;
        }
    }
    (solution, ITERATION_LIMIT)
}

#[cfg(test)]
mod tests;
