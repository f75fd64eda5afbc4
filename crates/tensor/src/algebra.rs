//! Products, invariants and inverses of 3 × 3 tensors.

use crate::Mat3;

/// Cofactor H of F: the tensor that maps reference area vectors to deformed ones, H = J F⁻ᵀ,
/// defined for singular F too.
///
/// Greto & Kulasegaram 2019, Sect. 2 (H is one of the mixed unknowns).
#[inline]
#[must_use]
pub fn cofactor(f: &Mat3) -> Mat3 {
    Mat3::new(
        f.m22 * f.m33 - f.m23 * f.m32,
        f.m23 * f.m31 - f.m21 * f.m33,
        f.m21 * f.m32 - f.m22 * f.m31,
        f.m32 * f.m13 - f.m33 * f.m12,
        f.m33 * f.m11 - f.m31 * f.m13,
        f.m31 * f.m12 - f.m32 * f.m11,
        f.m12 * f.m23 - f.m13 * f.m22,
        f.m13 * f.m21 - f.m11 * f.m23,
        f.m11 * f.m22 - f.m12 * f.m21,
    )
}

/// Tensor cross product (A × B)_iI = e_ijk e_IJK A_jJ B_kK: symmetric and bilinear, so that
/// cof F = ½ F × F and d(cof F)/dt = F × dF/dt.
///
/// Bonet, Gil & Ortigosa 2016, used in Greto & Kulasegaram 2019, (2.3a).
#[inline]
#[must_use]
pub fn tensor_cross(a: &Mat3, b: &Mat3) -> Mat3 {
    Mat3::new(
        a.m22 * b.m33 - a.m23 * b.m32 + a.m33 * b.m22 - a.m32 * b.m23,
        a.m23 * b.m31 - a.m21 * b.m33 + a.m31 * b.m23 - a.m33 * b.m21,
        a.m21 * b.m32 - a.m22 * b.m31 + a.m32 * b.m21 - a.m31 * b.m22,
        a.m13 * b.m32 - a.m12 * b.m33 + a.m32 * b.m13 - a.m33 * b.m12,
        a.m33 * b.m11 - a.m31 * b.m13 + a.m11 * b.m33 - a.m13 * b.m31,
        a.m31 * b.m12 - a.m32 * b.m11 + a.m12 * b.m31 - a.m11 * b.m32,
        a.m12 * b.m23 - a.m13 * b.m22 + a.m23 * b.m12 - a.m22 * b.m13,
        a.m13 * b.m21 - a.m11 * b.m23 + a.m21 * b.m13 - a.m23 * b.m11,
        a.m11 * b.m22 - a.m12 * b.m21 + a.m22 * b.m11 - a.m21 * b.m12,
    )
}

/// A : B = Σ A_ij B_ij.
#[inline(always)]
#[must_use]
pub fn double_dot(a: &Mat3, b: &Mat3) -> f64 {
    (a.m11 * b.m11 + a.m21 * b.m21 + a.m31 * b.m31)
        + (a.m12 * b.m12 + a.m22 * b.m22 + a.m32 * b.m32)
        + (a.m13 * b.m13 + a.m23 * b.m23 + a.m33 * b.m33)
}

/// A : A, the squared Frobenius norm.
#[inline]
#[must_use]
pub fn norm_squared(a: &Mat3) -> f64 {
    double_dot(a, a)
}

/// One third of the trace.
#[inline]
#[must_use]
pub fn mean_trace(a: &Mat3) -> f64 {
    (a.m11 + a.m22 + a.m33) / 3.0
}

/// A − ⅓ tr A 1.
#[inline]
#[must_use]
pub fn deviator(a: &Mat3) -> Mat3 {
    let mean = mean_trace(a);
    let mut deviator = *a;
    deviator.m11 -= mean;
    deviator.m22 -= mean;
    deviator.m33 -= mean;
    deviator
}

/// ½ (A + Aᵀ).
#[inline]
#[must_use]
pub fn symmetric_part(a: &Mat3) -> Mat3 {
    let (m12, m13, m23) = (
        0.5 * (a.m12 + a.m21),
        0.5 * (a.m13 + a.m31),
        0.5 * (a.m23 + a.m32),
    );
    Mat3::new(a.m11, m12, m13, m12, a.m22, m23, m13, m23, a.m33)
}

/// Equivalent von Mises stress √(3/2) |dev σ| of a symmetric stress tensor, in its unit.
#[inline]
#[must_use]
pub fn von_mises(stress: &Mat3) -> f64 {
    (1.5 * norm_squared(&deviator(stress))).sqrt()
}

/// F⁻ᵀ and det F; F⁻ᵀ is not finite when F is singular.
#[inline]
#[must_use]
pub fn inverse_transpose(f: &Mat3) -> (Mat3, f64) {
    let h = cofactor(f);
    let determinant = f.m11 * h.m11 + f.m12 * h.m12 + f.m13 * h.m13;
    (h * (1.0 / determinant), determinant)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> (Mat3, Mat3) {
        (
            Mat3::new(1.1, -0.3, 0.2, 0.4, 0.8, -0.1, 0.05, 0.6, 1.3),
            Mat3::new(-0.7, 0.2, 0.9, 0.3, 1.4, -0.6, 0.8, -0.25, 0.5),
        )
    }

    #[test]
    fn cofactor_is_determinant_times_inverse_transpose() {
        let (f, _) = sample();
        let expected = f.try_inverse().unwrap().transpose() * f.determinant();
        assert!((cofactor(&f) - expected).norm() < 1e-14);
        let (inverse_transposed, determinant) = inverse_transpose(&f);
        assert!((inverse_transposed * determinant - expected).norm() < 1e-14);
    }

    #[test]
    fn tensor_cross_agrees_with_its_definition_by_permutation_symbols() {
        let (a, b) = sample();
        let permutation = |i: usize, j: usize, k: usize| -> f64 {
            match (i, j, k) {
                (0, 1, 2) | (1, 2, 0) | (2, 0, 1) => 1.0,
                (0, 2, 1) | (2, 1, 0) | (1, 0, 2) => -1.0,
                _ => 0.0,
            }
        };
        let mut expected = Mat3::zeros();
        for i in 0..3 {
            for capital_i in 0..3 {
                for j in 0..3 {
                    for k in 0..3 {
                        for capital_j in 0..3 {
                            for capital_k in 0..3 {
                                expected[(i, capital_i)] += permutation(i, j, k)
                                    * permutation(capital_i, capital_j, capital_k)
                                    * a[(j, capital_j)]
                                    * b[(k, capital_k)];
                            }
                        }
                    }
                }
            }
        }
        assert!((tensor_cross(&a, &b) - expected).norm() < 1e-14);
    }

    #[test]
    fn half_the_cross_product_with_itself_is_the_cofactor() {
        let (f, _) = sample();
        assert!((tensor_cross(&f, &f) * 0.5 - cofactor(&f)).norm() < 1e-15);
    }

    #[test]
    fn uniaxial_tension_has_its_own_von_mises_stress() {
        let stress = Mat3::from_diagonal(&crate::Vec3::new(250.0, 0.0, 0.0));
        assert!((von_mises(&stress) - 250.0).abs() < 1e-12);
        let shear = Mat3::new(0.0, 100.0, 0.0, 100.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        assert!((von_mises(&shear) - 100.0 * 3.0f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn deviator_has_no_trace_and_symmetric_part_is_symmetric() {
        let (a, _) = sample();
        assert!(deviator(&a).trace().abs() < 1e-15);
        let s = symmetric_part(&a);
        assert!((s - s.transpose()).norm() == 0.0);
        assert!((s - (a + a.transpose()) * 0.5).norm() < 1e-16);
    }
}
