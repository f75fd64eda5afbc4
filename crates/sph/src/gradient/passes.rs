//! B and its transpose for runs of points and particles, with the vector instructions of the machine.

use jstsph_tensor::lanes::{Simd, WithSimd, vectorised};
use jstsph_tensor::{Mat3, Vec3};

use super::GradientOperator;

impl GradientOperator {
    /// [`gradient_at`](Self::gradient_at) times `factor` for the points from `first` on, as many as
    /// there are in `gradients`, with the same bits. The field has a fourth number that is not used.
    ///
    /// # Panics
    /// If there are not as many points, or fewer values than particles: a bug in the caller.
    pub fn scaled_gradients(
        &self,
        first: usize,
        field: &[[f64; 4]],
        factor: f64,
        gradients: &mut [Mat3],
    ) {
        vectorised(Gradients {
            operator: self,
            first,
            field,
            factor,
            gradients,
        });
    }

    /// [`divergence_at`](Self::divergence_at) for the particles from `first` on, as many as there are
    /// in `forces`; in 3D the sum runs in another order, so that it differs by round-off.
    ///
    /// # Panics
    /// If there are not as many particles, or fewer tensors than points: a bug in the caller.
    pub fn divergences(&self, first: usize, tensors: &[Mat3], forces: &mut [Vec3]) {
        vectorised(Divergences {
            operator: self,
            first,
            tensors,
            forces,
        });
    }
}

/// a += x s.
#[inline(always)]
fn accumulate(a: &mut [f64; 4], x: &[f64; 4], s: f64) {
    for i in 0..4 {
        a[i] += x[i] * s;
    }
}

/// Adds a tensor times a vector to three columns of sums. Each column with one number of its
/// neighbour, which is not used: four numbers in a row that can be loaded at once. The last column
/// comes second in its four.
#[inline(always)]
pub(crate) fn add_product(tensor: &Mat3, w: &[f64; 3], sums: &mut [[f64; 4]; 3]) {
    let s: &[[f64; 3]; 3] = tensor.as_ref();
    let [[s0, s1, s2], [s3, s4, s5], [s6, s7, s8]] = *s;
    accumulate(&mut sums[0], &[s0, s1, s2, s3], w[0]);
    accumulate(&mut sums[1], &[s3, s4, s5, s6], w[1]);
    accumulate(&mut sums[2], &[s5, s6, s7, s8], w[2]);
}

/// What [`add_product`] has added up.
#[inline(always)]
pub(crate) fn sum_of_columns([first, second, third]: &[[f64; 4]; 3]) -> Vec3 {
    Vec3::new(
        first[0] + second[0] + third[1],
        first[1] + second[1] + third[2],
        first[2] + second[2] + third[3],
    )
}

struct Gradients<'a> {
    operator: &'a GradientOperator,
    first: usize,
    field: &'a [[f64; 4]],
    factor: f64,
    gradients: &'a mut [Mat3],
}

impl WithSimd for Gradients<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let (rows, factor) = (&self.operator.rows, self.factor);
        if self.operator.plane {
            for (q, gradient) in self.gradients.iter_mut().enumerate() {
                let row = rows.row(self.first + q);
                let field = &self.field[row.first..];
                let mut g = [[0.0; 2]; 2];
                for (&c, w) in row.steps.iter().zip(row.weights) {
                    let f = &field[c as usize];
                    for i in 0..2 {
                        g[0][i] += f[i] * w[0];
                        g[1][i] += f[i] * w[1];
                    }
                }
                let [[g11, g21], [g12, g22]] = g;
                *gradient = Mat3::new(
                    g11 * factor,
                    g12 * factor,
                    0.0,
                    g21 * factor,
                    g22 * factor,
                    0.0,
                    0.0,
                    0.0,
                    0.0,
                );
            }
            return;
        }
        for (q, gradient) in self.gradients.iter_mut().enumerate() {
            let row = rows.row(self.first + q);
            let field = &self.field[row.first..];
            let mut columns = [[0.0; 4]; 3];
            for (&c, w) in row.steps.iter().zip(row.weights) {
                let f = &field[c as usize];
                accumulate(&mut columns[0], f, w[0]);
                accumulate(&mut columns[1], f, w[1]);
                accumulate(&mut columns[2], f, w[2]);
            }
            let out: &mut [[f64; 3]; 3] = gradient.as_mut();
            for (out, column) in out.iter_mut().zip(&columns) {
                *out = [column[0] * factor, column[1] * factor, column[2] * factor];
            }
        }
    }
}

struct Divergences<'a> {
    operator: &'a GradientOperator,
    first: usize,
    tensors: &'a [Mat3],
    forces: &'a mut [Vec3],
}

impl WithSimd for Divergences<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let columns = &self.operator.columns;
        if self.operator.plane {
            for (c, force) in self.forces.iter_mut().enumerate() {
                let column = columns.row(self.first + c);
                let tensors = &self.tensors[column.first..];
                let (mut x, mut y) = (0.0, 0.0);
                for (&q, w) in column.steps.iter().zip(column.weights) {
                    let s = &tensors[q as usize];
                    x += s.m11 * w[0] + s.m12 * w[1];
                    y += s.m21 * w[0] + s.m22 * w[1];
                }
                *force = Vec3::new(x, y, 0.0);
            }
            return;
        }
        for (c, force) in self.forces.iter_mut().enumerate() {
            let column = columns.row(self.first + c);
            let tensors = &self.tensors[column.first..];
            let mut sums = [[0.0; 4]; 3];
            for (&q, w) in column.steps.iter().zip(column.weights) {
                add_product(&tensors[q as usize], w, &mut sums);
            }
            *force = sum_of_columns(&sums);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Kernel, Support};

    #[test]
    fn runs_agree_with_single_points_and_particles() {
        for dimension in [2, 3] {
            let layers = if dimension == 2 { 1 } else { 5 };
            let positions: Vec<Vec3> = (0..6 * 7 * layers)
                .map(|i| Vec3::new((i % 6) as f64, (i / 6 % 7) as f64, (i / 42) as f64) * 1e-3)
                .collect();
            let points: Vec<Vec3> = positions
                .iter()
                .filter(|x| x.x < 4.5e-3)
                .map(|x| x + Vec3::new(0.5e-3, 0.0, 0.0))
                .collect();
            let support = Support {
                kernel: Kernel::QuinticSpline,
                smoothing_length: 0.9e-3,
                dimension,
            };
            let operator = GradientOperator::at_points(&points, &positions, &support).unwrap();
            let wave = |i: usize, k: usize| (0.7 * i as f64 + 1.9 * k as f64).sin();
            let out_of_plane = if dimension == 2 { 0.0 } else { 1.0 };
            let field: Vec<Vec3> = (0..positions.len())
                .map(|i| Vec3::new(wave(i, 0), wave(i, 1), out_of_plane * wave(i, 2)))
                .collect();
            let padded: Vec<_> = field.iter().map(|f| [f.x, f.y, f.z, 7.0]).collect();
            let first = 3;
            let mut gradients = vec![Mat3::zeros(); points.len() - first];
            operator.scaled_gradients(first, &padded, 0.3, &mut gradients);
            for (q, gradient) in gradients.iter().enumerate() {
                assert_eq!(*gradient, operator.gradient_at(first + q, &field) * 0.3);
            }
            let tensors: Vec<Mat3> = (0..points.len())
                .map(|q| Mat3::from_fn(|r, c| wave(q, 3 * r + c + 5)))
                .collect();
            let mut forces = vec![Vec3::zeros(); positions.len() - first];
            operator.divergences(first, &tensors, &mut forces);
            for (c, force) in forces.iter().enumerate() {
                let expected = operator.divergence_at(first + c, &tensors);
                // Some fifty terms of size 1/h that may cancel.
                assert!((force - expected).norm() < 1e-14 / support.smoothing_length);
            }
        }
    }
}
