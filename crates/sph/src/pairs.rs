//! Symmetric pair weights of the Laplacian and the pair sums built on them.

use jstsph_tensor::Vec3;

use jstsph_geometry::NeighbourSearch;

use crate::gradient::Support;
use crate::rows::{Row, Rows};
use crate::{GradientOperator, SphError};

/// Bounds of the clamped quadratic scaling: outside (0, 2) it is set to one, because it is
/// singular at corners.
const SCALING_BOUND: f64 = 2.0;

/// Weighted differences between particles, Σ_b ℓ_ab (f_b − f_a): `[eq:laplacian]`.
///
/// The symmetric (Brookshaw) form has ℓ_ab = V_b w_ab with w_ab = −2 W'(r)/r ≥ 0, so that
/// Σ_a V_a ℓ_ab (f_b − f_a) vanishes pair by pair and the operator is negative semi-definite.
#[derive(Clone, Debug)]
pub struct PairOperator {
    rows: Rows<f64>,
}

impl PairOperator {
    /// The symmetric Laplacian ℓ_ab = V_b w_ab.
    ///
    /// # Errors
    /// [`SphError::TooManyEntries`] when the entries do not fit 32-bit offsets.
    pub fn symmetric(
        positions: &[Vec3],
        volumes: &[f64],
        support: &Support,
    ) -> Result<Self, SphError> {
        let search = NeighbourSearch::new(positions, support.radius());
        let mut found = Vec::new();
        let scale = laplacian_scale(support);
        Self::checked(Rows::build(positions.len(), scale, |a, entries| {
            search.around(a, &mut found);
            for &b in &found {
                let r = (positions[b as usize] - positions[a]).norm();
                let weight = -2.0 * volumes[b as usize] * support.derivative_over_radius(r);
                if weight > 0.0 {
                    entries.push((b, weight));
                }
            }
        }))
    }

    /// The Laplacian with the linear correction and the clamped quadratic scaling,
    ///
    /// ```text
    ///   ℓ_ab = s_a (V_b w_ab − m_a · B_ab) ,  m_a = Σ_b V_b w_ab (X_b − X_a)
    /// ```
    ///
    /// which vanishes on linear fields up to the boundary. s_a makes it exact for |X − X_a|²
    /// wherever that scaling lies between 0 and 2, and is one elsewhere (it is singular at
    /// corners). Not symmetric: energy is not removed pair by pair.
    ///
    /// # Errors
    /// As for [`GradientOperator::at_particles`].
    pub fn corrected(
        positions: &[Vec3],
        volumes: &[f64],
        gradient: &GradientOperator,
        support: &Support,
    ) -> Result<Self, SphError> {
        let symmetric = Self::symmetric(positions, volumes, support)?;
        let scale = laplacian_scale(support);
        Self::checked(Rows::build(positions.len(), scale, |a, entries| {
            let row = symmetric.rows.row(a);
            let offset = |b: usize| positions[b] - positions[a];
            let first: Vec3 = row.entries().map(|(b, w)| offset(b) * *w).sum();
            let mut plain = row.entries().peekable();
            let mut quadratic = 0.0;
            for (b, correction) in gradient.row(a).entries() {
                if b == a {
                    continue;
                }
                while plain.next_if(|(other, _)| *other < b).is_some() {}
                let plain = plain.next_if(|(other, _)| *other == b);
                let plain = plain.map_or(0.0, |(_, weight)| *weight);
                let weight = plain - first.dot(&Vec3::from(*correction));
                quadratic += weight * offset(b).norm_squared();
                entries.push((b as u32, weight));
            }
            // Laplacian of |X − X_a|² is 2 d.
            let scaling = 2.0 * support.dimension as f64 / quadratic;
            if scaling > 0.0 && scaling < SCALING_BOUND {
                for (_, weight) in entries.iter_mut() {
                    *weight *= scaling;
                }
            }
        }))
    }

    fn checked(rows: Rows<f64>) -> Result<Self, SphError> {
        let (entries, limit) = (rows.entry_count(), u32::MAX as usize);
        if entries > limit {
            return Err(SphError::TooManyEntries { entries, limit });
        }
        Ok(Self { rows })
    }

    /// Number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.rows.len()
    }

    /// Entries over all particles (each pair counts twice).
    #[must_use]
    pub fn entry_count(&self) -> usize {
        self.rows.entry_count()
    }

    /// Neighbours b and weights ℓ_ab of a particle.
    #[inline]
    #[must_use]
    pub fn row(&self, particle: usize) -> Row<'_, f64> {
        self.rows.row(particle)
    }

    /// Σ_b ℓ_ab (f_b − f_a) of a vector field.
    #[inline]
    #[must_use]
    pub fn difference_at(&self, particle: usize, field: &[Vec3]) -> Vec3 {
        let own = &field[particle];
        let row = self.rows.row(particle);
        row.entries()
            .fold(Vec3::zeros(), |sum, (b, w)| sum + (field[b] - own) * *w)
    }

    /// Σ_b ℓ_ab (f_b − f_a) of a scalar field.
    #[inline]
    #[must_use]
    pub fn scalar_difference_at(&self, particle: usize, field: &[f64]) -> f64 {
        let own = field[particle];
        let row = self.rows.row(particle);
        row.entries()
            .fold(0.0, |sum, (b, w)| sum + (field[b] - own) * w)
    }

    /// Upper bound (Gershgorin) of the spectral radius, 1/m²: twice the largest row sum.
    #[must_use]
    pub fn spectral_bound(&self) -> f64 {
        (0..self.particles())
            .map(|a| {
                2.0 * self
                    .rows
                    .row(a)
                    .weights
                    .iter()
                    .map(|w| w.abs())
                    .sum::<f64>()
            })
            .fold(0.0, f64::max)
    }
}

/// Size of Laplacian weights, 1/h².
fn laplacian_scale(support: &Support) -> f64 {
    1.0 / (support.smoothing_length * support.smoothing_length)
}

#[cfg(test)]
mod tests;
