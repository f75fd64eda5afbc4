//! Logarithm and exponential of symmetric tensors.
//!
//! Elastic strains of metals are small (flow stress over modulus: below a few per cent), so both
//! functions have a series that needs no spectral decomposition; they fall back on it elsewhere.

use crate::{Mat3, norm_squared, symmetric_eigen};

/// Bound on |B − 1|² below which the logarithm is taken by series: the truncation error
/// 2 |Z|¹³/13 with |Z| ≈ |B − 1|/2 stays below 1e-18 relative to |Z|.
const LOG_SERIES_LIMIT: f64 = 0.06 * 0.06;

/// Bound on |A|² below which the exponential is taken by series (|A|⁹/9! below 1e-17).
const EXP_SERIES_LIMIT: f64 = 0.06 * 0.06;

/// Product of two symmetric tensors that commute: symmetric, six entries.
#[inline]
fn commuting_product(a: &Mat3, b: &Mat3) -> Mat3 {
    let m11 = a.m11 * b.m11 + a.m12 * b.m12 + a.m13 * b.m13;
    let m12 = a.m11 * b.m12 + a.m12 * b.m22 + a.m13 * b.m23;
    let m13 = a.m11 * b.m13 + a.m12 * b.m23 + a.m13 * b.m33;
    let m22 = a.m12 * b.m12 + a.m22 * b.m22 + a.m23 * b.m23;
    let m23 = a.m12 * b.m13 + a.m22 * b.m23 + a.m23 * b.m33;
    let m33 = a.m13 * b.m13 + a.m23 * b.m23 + a.m33 * b.m33;
    Mat3::new(m11, m12, m13, m12, m22, m23, m13, m23, m33)
}

/// Logarithm of a symmetric positive definite tensor.
///
/// Near the identity by 2 artanh Z, Z = (B − 1)(B + 1)⁻¹, else by principal values; a value that is
/// not positive gives NaN.
#[inline]
#[must_use]
pub fn log_symmetric(b: &Mat3) -> Mat3 {
    let a = b - Mat3::identity();
    if norm_squared(&a) < LOG_SERIES_LIMIT {
        let h = crate::cofactor(&(b + Mat3::identity()));
        let determinant = (b.m11 + 1.0) * h.m11 + b.m12 * h.m12 + b.m13 * h.m13;
        let z = commuting_product(&a, &h) * (1.0 / determinant);
        let z2 = commuting_product(&z, &z);
        let mut series = z2 * (1.0 / 11.0);
        for coefficient in [1.0 / 9.0, 1.0 / 7.0, 1.0 / 5.0, 1.0 / 3.0] {
            series.m11 += coefficient;
            series.m22 += coefficient;
            series.m33 += coefficient;
            series = commuting_product(&series, &z2);
        }
        series.m11 += 1.0;
        series.m22 += 1.0;
        series.m33 += 1.0;
        commuting_product(&series, &z) * 2.0
    } else {
        let spectral = symmetric_eigen(b);
        spectral.compose(&spectral.values.map(f64::ln))
    }
}

/// Exponential of a symmetric tensor: by series near zero, else by principal values.
#[inline]
#[must_use]
pub fn exp_symmetric(a: &Mat3) -> Mat3 {
    if norm_squared(a) < EXP_SERIES_LIMIT {
        let mut series = Mat3::identity();
        for divisor in [8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0] {
            series = commuting_product(&series, a) * (1.0 / divisor);
            series.m11 += 1.0;
            series.m22 += 1.0;
            series.m33 += 1.0;
        }
        series
    } else {
        let spectral = symmetric_eigen(a);
        spectral.compose(&spectral.values.map(f64::exp))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn logarithm_and_exponential_are_inverse(
            v in prop::array::uniform6(-1.0f64..1.0), size in -9i32..1,
        ) {
            let a = Mat3::new(v[0], v[1], v[2], v[1], v[3], v[4], v[2], v[4], v[5])
                * 10f64.powi(size);
            let back = log_symmetric(&exp_symmetric(&a));
            // exp(a) carries round-off of size one whatever |a| is.
            prop_assert!((back - a).norm() < 2e-14 * exp_symmetric(&(-a)).norm());
        }

        #[test]
        fn series_and_spectral_forms_agree_at_their_border(
            v in prop::array::uniform6(-1.0f64..1.0), size in 0.5f64..1.0,
        ) {
            let a = Mat3::new(v[0], v[1], v[2], v[1], v[3], v[4], v[2], v[4], v[5]);
            prop_assume!(a.norm() > 1e-3);
            let a = a * (size * 0.06 / a.norm());
            let spectral = symmetric_eigen(&a);
            prop_assert!((exp_symmetric(&a) - spectral.compose(&spectral.values.map(f64::exp))).norm() < 4e-15);
            let b = Mat3::identity() + a;
            let spectral = symmetric_eigen(&b);
            prop_assert!((log_symmetric(&b) - spectral.compose(&spectral.values.map(f64::ln))).norm() < 4e-15);
        }
    }

    #[test]
    fn logarithm_of_a_diagonal_is_the_logarithm_of_its_entries() {
        let b = Mat3::from_diagonal(&crate::Vec3::new(4.0, 0.25, 1.0));
        let log = log_symmetric(&b);
        assert!((log.m11 - 4f64.ln()).abs() < 1e-15);
        assert!((log.m22 + 4f64.ln()).abs() < 1e-15);
        assert_eq!(log.m33, 0.0);
    }
}
