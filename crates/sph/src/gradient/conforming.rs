//! The smallest change of the gradient operator that makes it sum by parts: docs/theory.md,
//! "Summation by parts near the boundary".

use jstsph_tensor::{Mat3, Vec3};

use super::{Entry, GradientOperator};
use crate::rows::{Row, Rows};

mod normal;
mod solvable;

use normal::NormalEquations;
use solvable::make_solvable;

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

/// A row that is changed: the mean position of its particles, and the inverse of the moment matrix of
/// their offsets from it, for linear fits over the row.
struct Fit<'a> {
    volume: f64,
    point: usize,
    row: Row<'a, [f64; 3]>,
    positions: &'a [Vec3],
    mean: Vec3,
    inverse: Mat3,
}

impl<'a> Fit<'a> {
    /// None where the particles do not determine a linear fit.
    fn new(
        operator: &'a GradientOperator,
        point: usize,
        volume: f64,
        positions: &'a [Vec3],
    ) -> Option<Self> {
        let row = operator.row(point);
        let mean = row.indices().map(|c| positions[c]).sum::<Vec3>() / row.len() as f64;
        let mut moment = row
            .indices()
            .map(|c| positions[c] - mean)
            .fold(Mat3::zeros(), |sum, o| sum + o * o.transpose());
        if operator.plane {
            moment.m33 = moment.norm();
        }
        Some(Self {
            volume,
            point,
            row,
            positions,
            mean,
            inverse: moment.try_inverse()?,
        })
    }

    /// Of a particle from the mean. Not kept: that would be most of what a large body takes while it is
    /// set up.
    #[inline]
    fn offset(&self, particle: usize) -> Vec3 {
        self.positions[particle] - self.mean
    }

    /// Values of a field at the particles of the row, less their linear fit.
    fn residual(&self, field: &[Vec3], out: &mut Vec<Vec3>) {
        out.clear();
        out.extend(self.row.indices().map(|c| field[c]));
        let mean = out.iter().sum::<Vec3>() / out.len() as f64;
        let offsets = || self.row.indices().map(|c| self.offset(c));
        let slope = out
            .iter()
            .zip(offsets())
            .fold(Mat3::zeros(), |sum, (value, offset)| {
                sum + value * offset.transpose()
            })
            * self.inverse;
        for (value, offset) in out.iter_mut().zip(offsets()) {
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
    /// Σ_q V_q Σ_c |δ_qc|². λ solves a symmetric system by conjugate gradients. Variationally
    /// consistent integration (Chen, Hillman & Rüter 2013) solves the same condition on the test side.
    ///
    /// Only rows near a particle whose defect exceeds `tolerance` change. A solution exists when
    /// Σ_c (N_c − Σ_q V_q B_qc) and its first moments vanish over every connected group of these rows,
    /// which holds when N has the moments of the body's surface; where it has them only nearly, N
    /// changes by as much as they are off, in proportion to its size.
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
        let rows: Vec<Fit<'_>> = (0..self.points())
            .filter(|&q| self.row(q).indices().any(|c| is_large[c]))
            .filter_map(|q| Fit::new(self, q, point_volumes[q], positions))
            .collect();
        // Rows that stay cannot serve particles that only they reach.
        let mut reached = vec![false; self.particles()];
        for c in rows.iter().flat_map(|fit| fit.row.indices()) {
            reached[c] = true;
        }
        for (value, reached) in defect.iter_mut().zip(reached) {
            if !reached {
                *value = Vec3::zeros();
            }
        }
        let sizes: Vec<f64> = area_vectors.iter().map(Vec3::norm).collect();
        make_solvable(&mut defect, &sizes, &rows, positions, self.plane);
        let (multiplier, iterations) = NormalEquations::new(&rows, self.particles()).solve(&defect);

        let mut change = 0.0f64;
        let mut changed = rows.iter().peekable();
        let mut residual = Vec::new();
        let corrected = Rows::build(self.points(), self.scale, |q, entries: &mut Vec<Entry>| {
            let row = self.row(q);
            entries.extend(row.entries().map(|(c, weight)| (c as u32, *weight)));
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

#[cfg(test)]
mod tests;
