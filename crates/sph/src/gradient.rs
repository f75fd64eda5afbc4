//! The corrected gradient operator B and its transpose.

use jstsph_geometry::NeighbourSearch;
use jstsph_tensor::{Mat3, Vec3};

use crate::rows::{Row, Rows};
use crate::{Kernel, SphError};

mod conforming;
pub(crate) mod passes;

pub use conforming::Correction;

/// Largest accepted condition number of a moment matrix. Corners of lattices have about 3; above
/// this the correction would amplify round-off and noise instead of restoring consistency.
const CONDITION_LIMIT: f64 = 1e6;

/// The kernel with its extent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    /// Kernel function.
    pub kernel: Kernel,
    /// Smoothing length h, m; the support radius is 2h.
    pub smoothing_length: f64,
    /// d = 2 (plane strain) or 3.
    pub dimension: usize,
}

impl Support {
    /// Support radius 2h, m.
    #[must_use]
    pub fn radius(&self) -> f64 {
        2.0 * self.smoothing_length
    }

    /// W(r).
    #[must_use]
    pub fn value(&self, r: f64) -> f64 {
        self.kernel.value(r, self.smoothing_length, self.dimension)
    }

    /// W'(r)/r.
    #[must_use]
    pub fn derivative_over_radius(&self, r: f64) -> f64 {
        self.kernel
            .derivative_over_radius(r, self.smoothing_length, self.dimension)
    }
}

/// The sparse matrix B between particles c and evaluation points q, with vector entries, so that
///
/// ```text
///   grad f_q = Σ_c f_c ⊗ B_qc ,       V_c T_c = Σ_q V_q P_q B_qc
/// ```
///
/// Exact for constant and linear fields; Σ_c B_qc = 0 makes the force momentum-exact.
/// Both the rows (per point) and the columns (per particle) are stored, each gathered in ascending
/// order, so that results do not depend on the number of threads.
#[derive(Clone, Debug)]
pub struct GradientOperator {
    pub(crate) rows: Rows<[f64; 3]>,
    pub(crate) columns: Rows<[f64; 3]>,
    /// Size of the entries, one over the smoothing length.
    pub(crate) scale: f64,
    pub(crate) plane: bool,
}

/// One entry of a row while it is built.
type Entry = (u32, [f64; 3]);

impl GradientOperator {
    /// The operator of the paper's scheme: evaluation points are the particles,
    ///
    /// ```text
    ///   B_ab = w_b L_a ∇W_ab ,  B_aa = −Σ_b B_ab ,  L_a = (Σ_b w_b ∇W_ab ⊗ (X_b − X_a))⁻¹
    /// ```
    ///
    /// `[eq:gradient]`: Greto & Kulasegaram 2019, (3.6) and (3.10), with interpolation weights w in place of the
    /// volumes V: a full cell for every particle of a lattice makes the scheme second order;
    /// passing the tributary volumes gives the paper's first-order form. docs/theory.md.
    ///
    /// # Errors
    /// [`SphError::TooFewNeighbours`] where the neighbours do not span the space.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn at_particles(
        positions: &[Vec3],
        weights: &[f64],
        support: &Support,
    ) -> Result<Self, SphError> {
        assert_eq!(positions.len(), weights.len(), "one weight per particle");
        let search = NeighbourSearch::new(positions, support.radius());
        let mut found = Vec::new();
        Self::build(positions.len(), positions.len(), support, |a, entries| {
            let mut moment = Mat3::zeros();
            search.around(a, &mut found);
            for &b in &found {
                let offset = positions[b as usize] - positions[a];
                // ∇W_ab with respect to X_a points from a towards b times −W'/r.
                let gradient =
                    offset * (-support.derivative_over_radius(offset.norm()) * weights[b as usize]);
                if gradient == Vec3::zeros() {
                    continue;
                }
                moment += gradient * offset.transpose();
                entries.push((b, gradient.into()));
            }
            let correction =
                invert_moment(moment, support, "particle", a, &positions[a], entries.len())?;
            let mut own = Vec3::zeros();
            for (_, weight) in entries.iter_mut() {
                let corrected = correction * Vec3::from(*weight);
                own -= corrected;
                *weight = corrected.into();
            }
            let place = entries.partition_point(|(b, _)| (*b as usize) < a);
            entries.insert(place, (a as u32, own.into()));
            Ok(())
        })
    }

    /// The operator of bond quadrature: evaluation points anywhere in the body,
    ///
    /// ```text
    ///   B_qc = L_q (∇W_qc − W_qc s_q) ,   s_q = Σ_c ∇W_qc / Σ_c W_qc ,
    ///   L_q = (Σ_c (∇W_qc − W_qc s_q) ⊗ (X_c − X_q))⁻¹
    /// ```
    ///
    /// with uniform weights; exact for constants (by s) and linears (by L). docs/theory.md, `[eq:bond-operator]`.
    ///
    /// # Errors
    /// [`SphError::TooFewNeighbours`] where the neighbours do not span the space.
    pub fn at_points(
        points: &[Vec3],
        positions: &[Vec3],
        support: &Support,
    ) -> Result<Self, SphError> {
        let search = NeighbourSearch::new(positions, support.radius());
        let mut found = Vec::new();
        Self::build(points.len(), positions.len(), support, |q, entries| {
            let (mut value_sum, mut gradient_sum) = (0.0, Vec3::zeros());
            let mut value_offset = Vec3::zeros();
            let mut moment = Mat3::zeros();
            search.near(&points[q], &mut found);
            for &c in &found {
                let offset = positions[c as usize] - points[q];
                let r = offset.norm();
                let value = support.value(r);
                if value == 0.0 {
                    continue;
                }
                let gradient = offset * -support.derivative_over_radius(r);
                value_sum += value;
                gradient_sum += gradient;
                value_offset += offset * value;
                moment += gradient * offset.transpose();
                // The value travels in the weight until the mean gradient s is known.
                entries.push((c, gradient.into()));
            }
            let mean = gradient_sum / value_sum;
            moment -= mean * value_offset.transpose();
            let correction = invert_moment(
                moment,
                support,
                "evaluation point",
                q,
                &points[q],
                entries.len(),
            )?;
            for (c, weight) in entries.iter_mut() {
                let value = support.value((positions[*c as usize] - points[q]).norm());
                *weight = (correction * (Vec3::from(*weight) - mean * value)).into();
            }
            Ok(())
        })
    }

    fn build(
        points: usize,
        particles: usize,
        support: &Support,
        mut row: impl FnMut(usize, &mut Vec<Entry>) -> Result<(), SphError>,
    ) -> Result<Self, SphError> {
        let mut failure = None;
        // Entries of B have the size of one over the smoothing length.
        let scale = 1.0 / support.smoothing_length;
        let rows = Rows::build(points, scale, |q, entries| {
            if failure.is_none()
                && let Err(error) = row(q, entries)
            {
                failure = Some(error);
            }
        });
        if let Some(error) = failure {
            return Err(error);
        }
        let limit = u32::MAX as usize;
        if rows.entry_count() > limit {
            return Err(SphError::TooManyEntries {
                entries: rows.entry_count(),
                limit,
            });
        }
        let columns = rows.transposed(particles, scale);
        Ok(Self {
            rows,
            columns,
            scale,
            plane: support.dimension == 2,
        })
    }

    /// Number of evaluation points.
    #[must_use]
    pub fn points(&self) -> usize {
        self.rows.len()
    }

    /// Number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.columns.len()
    }

    /// Entries of B over all points.
    #[must_use]
    pub fn entry_count(&self) -> usize {
        self.rows.entry_count()
    }

    /// Weights actually stored, rows and columns together: equal stencils are stored once.
    #[must_use]
    pub fn stored_weights(&self) -> usize {
        self.rows.stored_weights() + self.columns.stored_weights()
    }

    /// Bytes of memory it holds.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.rows.bytes() + self.columns.bytes()
    }

    /// Particles and weights B_qc of one evaluation point.
    #[must_use]
    pub fn row(&self, point: usize) -> Row<'_, [f64; 3]> {
        self.rows.row(point)
    }

    /// Points and weights B_qc of one particle.
    #[must_use]
    pub fn column(&self, particle: usize) -> Row<'_, [f64; 3]> {
        self.columns.row(particle)
    }

    /// Σ_c f_c ⊗ B_qc: gradient of a vector field of the particles at one point (3.6).
    /// In plane strain the third row and column are zero.
    #[inline]
    #[must_use]
    pub fn gradient_at(&self, point: usize, field: &[Vec3]) -> Mat3 {
        let row = self.rows.row(point);
        if self.plane {
            let (mut g11, mut g21, mut g12, mut g22) = (0.0, 0.0, 0.0, 0.0);
            for (c, w) in row.entries() {
                let f = &field[c];
                g11 += f.x * w[0];
                g21 += f.y * w[0];
                g12 += f.x * w[1];
                g22 += f.y * w[1];
            }
            return Mat3::new(g11, g12, 0.0, g21, g22, 0.0, 0.0, 0.0, 0.0);
        }
        let mut g = [0.0; 9];
        for (c, w) in row.entries() {
            let f = &field[c];
            for j in 0..3 {
                g[3 * j] += f.x * w[j];
                g[3 * j + 1] += f.y * w[j];
                g[3 * j + 2] += f.z * w[j];
            }
        }
        Mat3::from_column_slice(&g)
    }

    /// Σ_q S_q B_qc: with S = V P the force V_c T_c of one particle (3.10).
    #[inline]
    #[must_use]
    pub fn divergence_at(&self, particle: usize, tensors: &[Mat3]) -> Vec3 {
        let column = self.columns.row(particle);
        let (mut x, mut y, mut z) = (0.0, 0.0, 0.0);
        if self.plane {
            for (q, w) in column.entries() {
                let s = &tensors[q];
                x += s.m11 * w[0] + s.m12 * w[1];
                y += s.m21 * w[0] + s.m22 * w[1];
            }
        } else {
            for (q, w) in column.entries() {
                let s = &tensors[q];
                x += s.m11 * w[0] + s.m12 * w[1] + s.m13 * w[2];
                y += s.m21 * w[0] + s.m22 * w[1] + s.m23 * w[2];
                z += s.m31 * w[0] + s.m32 * w[1] + s.m33 * w[2];
            }
        }
        Vec3::new(x, y, z)
    }

    /// Σ_c f_c B_qc: gradient of a scalar field of the particles at one point.
    #[inline]
    #[must_use]
    pub fn scalar_gradient_at(&self, point: usize, field: &[f64]) -> Vec3 {
        let row = self.rows.row(point);
        row.entries()
            .fold(Vec3::zeros(), |sum, (c, w)| sum + Vec3::from(*w) * field[c])
    }

    /// Σ_q v_q · B_qc: with v = V q, a flux times the volume of its point, minus the weak divergence
    /// at one particle. The sum over all particles vanishes to round-off, because Σ_c B_qc = 0.
    #[inline]
    #[must_use]
    pub fn scalar_divergence_at(&self, particle: usize, vectors: &[Vec3]) -> f64 {
        let column = self.columns.row(particle);
        column
            .entries()
            .fold(0.0, |sum, (q, w)| sum + vectors[q].dot(&Vec3::from(*w)))
    }

    /// Σ_q V_q B_qc for every particle: zero for inner nodes and the outward area vector for
    /// boundary nodes when summation by parts holds, so that a constant stress gives no inner
    /// force. Its inner values, over a face area, measure how far a body is from that.
    #[must_use]
    pub fn boundary_vectors(&self, point_volumes: &[f64]) -> Vec<Vec3> {
        (0..self.particles())
            .map(|c| {
                let column = self.columns.row(c);
                column.entries().fold(Vec3::zeros(), |sum, (q, w)| {
                    sum + Vec3::from(*w) * point_volumes[q]
                })
            })
            .collect()
    }
}

/// L = M⁻¹, with the out-of-plane entry set to one in plane strain.
fn invert_moment(
    mut moment: Mat3,
    support: &Support,
    what: &'static str,
    index: usize,
    position: &Vec3,
    neighbours: usize,
) -> Result<Mat3, SphError> {
    if support.dimension == 2 {
        moment.m33 = moment.fixed_view::<2, 2>(0, 0).norm();
    }
    let singular = moment.singular_values();
    let condition = if singular.max().is_finite() {
        singular.max() / singular.min()
    } else {
        f64::INFINITY
    };
    let inverse = moment.try_inverse();
    match inverse {
        Some(inverse) if condition < CONDITION_LIMIT => Ok(inverse),
        _ => Err(SphError::TooFewNeighbours {
            what,
            index,
            position: [position.x, position.y, position.z],
            neighbours,
            radius: support.radius(),
            condition,
            limit: CONDITION_LIMIT,
        }),
    }
}

#[cfg(test)]
mod summation_by_parts;
#[cfg(test)]
mod tests;
