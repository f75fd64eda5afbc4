//! Spectral decomposition of symmetric 3 × 3 tensors.

use crate::{Mat3, Vec3};

/// Principal values and directions of a symmetric tensor.
#[derive(Clone, Copy, Debug)]
pub struct Spectral {
    /// Principal values, in no particular order.
    pub values: Vec3,
    /// Orthonormal principal directions, one per column, in the order of `values`.
    pub directions: Mat3,
}

impl Spectral {
    /// Σ f(λ_a) n_a ⊗ n_a for the given f(λ_a).
    #[inline]
    #[must_use]
    pub fn compose(&self, values: &Vec3) -> Mat3 {
        let n = &self.directions;
        let entry = |i: usize, j: usize| {
            values.x * n[(i, 0)] * n[(j, 0)]
                + values.y * n[(i, 1)] * n[(j, 1)]
                + values.z * n[(i, 2)] * n[(j, 2)]
        };
        let (m12, m13, m23) = (entry(0, 1), entry(0, 2), entry(1, 2));
        Mat3::new(
            entry(0, 0),
            m12,
            m13,
            m12,
            entry(1, 1),
            m23,
            m13,
            m23,
            entry(2, 2),
        )
    }
}

/// Sweeps after which the cyclic Jacobi iteration stops; it converges quadratically and needs four
/// to six for any matrix, the cap only guards against non-finite input.
const MAX_SWEEPS: usize = 12;

/// Spectral decomposition of a symmetric tensor (only the upper triangle is read).
///
/// Closed form for the block form of plane strain (no 13 and 23 component), cyclic Jacobi
/// otherwise: accurate to a few units of round-off for equal and nearly equal values, and it
/// terminates for any input (a non-finite one gives non-finite values).
#[inline]
#[must_use]
pub fn symmetric_eigen(a: &Mat3) -> Spectral {
    if a.m13 == 0.0 && a.m23 == 0.0 {
        plane_eigen(a)
    } else {
        jacobi_eigen(a)
    }
}

/// One Jacobi rotation that annihilates the off-diagonal entry of a 2 × 2 block:
/// returns (cosine, sine, tangent).
#[inline]
fn rotation(app: f64, aqq: f64, apq: f64) -> (f64, f64, f64) {
    let difference = aqq - app;
    // tan θ as the smaller root of t² + 2 t (aqq−app)/(2 apq) − 1 = 0, without dividing by apq.
    let root = (difference * difference + 4.0 * apq * apq).sqrt();
    let t = 2.0 * apq / (difference + root.copysign(difference));
    let c = 1.0 / (1.0 + t * t).sqrt();
    (c, t * c, t)
}

#[inline]
fn plane_eigen(a: &Mat3) -> Spectral {
    if a.m12 == 0.0 {
        return Spectral {
            values: Vec3::new(a.m11, a.m22, a.m33),
            directions: Mat3::identity(),
        };
    }
    let (c, s, t) = rotation(a.m11, a.m22, a.m12);
    Spectral {
        values: Vec3::new(a.m11 - t * a.m12, a.m22 + t * a.m12, a.m33),
        directions: Mat3::new(c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0),
    }
}

fn jacobi_eigen(input: &Mat3) -> Spectral {
    let mut a = *input;
    a.m21 = a.m12;
    a.m31 = a.m13;
    a.m32 = a.m23;
    let mut n = Mat3::identity();
    let scale = a.m11 * a.m11 + a.m22 * a.m22 + a.m33 * a.m33;
    for _ in 0..MAX_SWEEPS {
        let off = a.m12 * a.m12 + a.m13 * a.m13 + a.m23 * a.m23;
        // Squared: off-diagonals below round-off of the diagonal change no principal value.
        if off <= 1e-34 * (scale + off) {
            break;
        }
        for (p, q, r) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
            let apq = a[(p, q)];
            if apq == 0.0 {
                continue;
            }
            let (c, s, t) = rotation(a[(p, p)], a[(q, q)], apq);
            a[(p, p)] -= t * apq;
            a[(q, q)] += t * apq;
            a[(p, q)] = 0.0;
            a[(q, p)] = 0.0;
            let (arp, arq) = (a[(r, p)], a[(r, q)]);
            let (rp, rq) = (c * arp - s * arq, s * arp + c * arq);
            a[(r, p)] = rp;
            a[(p, r)] = rp;
            a[(r, q)] = rq;
            a[(q, r)] = rq;
            for k in 0..3 {
                let (nkp, nkq) = (n[(k, p)], n[(k, q)]);
                n[(k, p)] = c * nkp - s * nkq;
                n[(k, q)] = s * nkp + c * nkq;
            }
        }
    }
    Spectral {
        values: Vec3::new(a.m11, a.m22, a.m33),
        directions: n,
    }
}

/// Largest principal value of a symmetric tensor, without directions.
///
/// Closed form (trigonometric in 3D); relative error below 1e-14 of the largest magnitude.
#[inline]
#[must_use]
pub fn largest_eigenvalue(a: &Mat3) -> f64 {
    if a.m13 == 0.0 && a.m23 == 0.0 {
        let half = 0.5 * (a.m11 - a.m22);
        let in_plane = 0.5 * (a.m11 + a.m22) + (half * half + a.m12 * a.m12).sqrt();
        return in_plane.max(a.m33);
    }
    let mean = (a.m11 + a.m22 + a.m33) / 3.0;
    let (d1, d2, d3) = (a.m11 - mean, a.m22 - mean, a.m33 - mean);
    let off = a.m12 * a.m12 + a.m13 * a.m13 + a.m23 * a.m23;
    let radius = ((d1 * d1 + d2 * d2 + d3 * d3 + 2.0 * off) / 6.0).sqrt();
    if radius == 0.0 {
        return mean;
    }
    let determinant = d1 * (d2 * d3 - a.m23 * a.m23) - a.m12 * (a.m12 * d3 - a.m23 * a.m13)
        + a.m13 * (a.m12 * a.m23 - d2 * a.m13);
    let cosine = (0.5 * determinant / (radius * radius * radius)).clamp(-1.0, 1.0);
    mean + 2.0 * radius * (cosine.acos() / 3.0).cos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn check(a: &Mat3) {
        let spectral = symmetric_eigen(a);
        let scale = a.norm().max(f64::MIN_POSITIVE);
        let back = spectral.compose(&spectral.values);
        assert!((back - a).norm() <= 2e-15 * 4.0 * scale, "{a} {back}");
        let n = spectral.directions;
        assert!((n.transpose() * n - Mat3::identity()).norm() < 1e-14);
        let largest = spectral.values.max();
        assert!((largest_eigenvalue(a) - largest).abs() <= 1e-13 * scale);
    }

    #[test]
    fn equal_values_and_diagonals_are_handled() {
        check(&Mat3::identity());
        check(&Mat3::zeros());
        check(&Mat3::from_diagonal(&Vec3::new(3.0, -1.0, 3.0)));
        let tiny = Mat3::new(1.0, 1e-17, 1e-16, 1e-17, 1.0, 1e-15, 1e-16, 1e-15, 1.0);
        check(&tiny);
    }

    #[test]
    fn plane_strain_block_agrees_with_the_general_routine() {
        let a = Mat3::new(2.0, 0.7, 0.0, 0.7, -0.4, 0.0, 0.0, 0.0, 1.1);
        check(&a);
        let general = jacobi_eigen(&a);
        let mut left: Vec<f64> = general.values.iter().copied().collect();
        let mut right: Vec<f64> = symmetric_eigen(&a).values.iter().copied().collect();
        left.sort_by(f64::total_cmp);
        right.sort_by(f64::total_cmp);
        for (l, r) in left.iter().zip(&right) {
            assert!((l - r).abs() < 1e-15 * 4.0);
        }
    }

    #[test]
    fn non_finite_input_terminates() {
        let a = Mat3::new(f64::NAN, 1.0, 2.0, 1.0, 0.0, 3.0, 2.0, 3.0, f64::INFINITY);
        assert!(symmetric_eigen(&a).values.iter().any(|v| !v.is_finite()));
    }

    proptest! {
        #[test]
        fn any_symmetric_tensor_is_recomposed(
            v in prop::array::uniform6(-1.0f64..1.0), gap in -16i32..1, scale in -6i32..12,
        ) {
            let gap = 10f64.powi(gap);
            let noise = Mat3::new(v[0], v[1], v[2], v[1], v[3], v[4], v[2], v[4], v[5]);
            check(&((Mat3::identity() + noise * gap) * 10f64.powi(scale)));
            check(&(noise * 10f64.powi(scale)));
        }
    }
}
