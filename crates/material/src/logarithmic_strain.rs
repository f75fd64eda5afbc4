//! Logarithm and exponential of trace-free symmetric tensors, by their invariants.
//!
//! A trace-free A satisfies A³ = J₂ A + J₃ 1 with J₂ = ½ A : A, J₃ = det A (Cayley-Hamilton), so a
//! power series of A is c₀ 1 + c₁ A + c₂ A² with three scalars: no spectral decomposition, no
//! division by differences of principal values, and a tenth of the work of a matrix series. Elastic
//! strains of metals, and plastic increments of one explicit step, are far inside its range.

use jstsph_tensor::{Mat3, exp_symmetric, mean_trace, norm_squared, symmetric_eigen};

/// Bound on |A|² below which the long series are used, beyond it principal values. A trace-free A of
/// norm 0.1 has principal values up to 0.082; the first term left out, relative to the first kept, is
/// 0.082¹⁴/15 < 1e-16 for the logarithm and 0.082¹⁰/11! < 1e-18 for the exponential.
pub(crate) const SERIES_LIMIT: f64 = 0.1 * 0.1;
pub(crate) const LONG_LOGARITHM: [f64; 15] = logarithm();
pub(crate) const LONG_EXPONENTIAL: [f64; 11] = exponential_less_one();

/// Bound on |A|² below which the short series are used: the elastic strains of most metals. By the
/// same measure 0.0082⁸/9 < 1e-17 and 0.0082⁶/7! < 1e-16.
pub(crate) const SHORT_SERIES_LIMIT: f64 = 0.01 * 0.01;
pub(crate) const SHORT_LOGARITHM: [f64; 9] = logarithm();
pub(crate) const SHORT_EXPONENTIAL: [f64; 7] = exponential_less_one();

/// Coefficients of log(1 + x), from x⁰ on.
const fn logarithm<const N: usize>() -> [f64; N] {
    let mut coefficients = [0.0; N];
    let mut k = 1;
    while k < N {
        coefficients[k] = if k % 2 == 1 { 1.0 } else { -1.0 } / k as f64;
        k += 1;
    }
    coefficients
}

/// Coefficients of exp(x) − 1, from x⁰ on.
const fn exponential_less_one<const N: usize>() -> [f64; N] {
    let mut coefficients = [0.0; N];
    let mut factorial = 1.0;
    let mut k = 1;
    while k < N {
        factorial *= k as f64;
        coefficients[k] = 1.0 / factorial;
        k += 1;
    }
    coefficients
}

/// c₀, c₁, c₂ of Σ s_k A^k = c₀ 1 + c₁ A + c₂ A² for a trace-free A: Horner's scheme with A³
/// replaced as soon as it appears.
#[inline]
fn reduced_series<const N: usize>(coefficients: &[f64; N], j2: f64, j3: f64) -> [f64; 3] {
    let [mut c0, mut c1, mut c2] = [0.0; 3];
    for coefficient in coefficients.iter().rev() {
        (c0, c1, c2) = (coefficient + c2 * j3, c0 + c2 * j2, c1);
    }
    [c0, c1, c2]
}

/// A² and det A of a symmetric A.
#[inline]
fn square_and_determinant(a: &Mat3) -> (Mat3, f64) {
    let m11 = a.m11 * a.m11 + a.m12 * a.m12 + a.m13 * a.m13;
    let m22 = a.m12 * a.m12 + a.m22 * a.m22 + a.m23 * a.m23;
    let m33 = a.m13 * a.m13 + a.m23 * a.m23 + a.m33 * a.m33;
    let m12 = a.m12 * (a.m11 + a.m22) + a.m13 * a.m23;
    let m13 = a.m13 * (a.m11 + a.m33) + a.m12 * a.m23;
    let m23 = a.m23 * (a.m22 + a.m33) + a.m12 * a.m13;
    let determinant = a.m11 * (a.m22 * a.m33 - a.m23 * a.m23)
        - a.m12 * (a.m12 * a.m33 - a.m13 * a.m23)
        + a.m13 * (a.m12 * a.m23 - a.m13 * a.m22);
    (
        Mat3::new(m11, m12, m13, m12, m22, m23, m13, m23, m33),
        determinant,
    )
}

/// c₀ 1 + c₁ A + c₂ B, entry by entry of a symmetric tensor.
#[inline]
fn combination(c0: f64, c1: f64, a: &Mat3, c2: f64, b: &Mat3) -> Mat3 {
    let m12 = c1 * a.m12 + c2 * b.m12;
    let m13 = c1 * a.m13 + c2 * b.m13;
    let m23 = c1 * a.m23 + c2 * b.m23;
    Mat3::new(
        c0 + c1 * a.m11 + c2 * b.m11,
        m12,
        m13,
        m12,
        c0 + c1 * a.m22 + c2 * b.m22,
        m23,
        m13,
        m23,
        c0 + c1 * a.m33 + c2 * b.m33,
    )
}

/// ½ dev log b, the deviatoric Hencky strain of a left Cauchy-Green tensor b (symmetric positive
/// definite; anything else gives NaN).
///
/// The series runs in a = 3 b/tr b − 1, which is trace-free and as small as the distortion, however
/// large the change of volume: dev log b = dev log (1 + a).
#[inline]
pub(crate) fn deviatoric_hencky_strain(b: &Mat3) -> Mat3 {
    let scale = 1.0 / mean_trace(b);
    let (m12, m13, m23) = (b.m12 * scale, b.m13 * scale, b.m23 * scale);
    let a = Mat3::new(
        b.m11 * scale - 1.0,
        m12,
        m13,
        m12,
        b.m22 * scale - 1.0,
        m23,
        m13,
        m23,
        b.m33 * scale - 1.0,
    );
    let j2 = 0.5 * norm_squared(&a);
    if 2.0 * j2 < SERIES_LIMIT && scale > 0.0 {
        let (square, j3) = square_and_determinant(&a);
        let [_, c1, c2] = if 2.0 * j2 < SHORT_SERIES_LIMIT {
            reduced_series(&SHORT_LOGARITHM, j2, j3)
        } else {
            reduced_series(&LONG_LOGARITHM, j2, j3)
        };
        // The trace of A² is 2 J₂: c₀ is what makes the sum trace-free.
        combination(-c2 * j2 / 3.0, 0.5 * c1, &a, 0.5 * c2, &square)
    } else {
        let spectral = symmetric_eigen(b);
        let strain = spectral.values.map(|value| 0.5 * value.ln());
        spectral.compose(&strain.add_scalar(-strain.mean()))
    }
}

/// exp(A) − 1 of a trace-free symmetric A, accurate relative to A however small it is.
#[inline]
pub(crate) fn isochoric_exponential_less_one(a: &Mat3) -> Mat3 {
    let j2 = 0.5 * norm_squared(a);
    if 2.0 * j2 < SERIES_LIMIT {
        let (square, j3) = square_and_determinant(a);
        let [c0, c1, c2] = if 2.0 * j2 < SHORT_SERIES_LIMIT {
            reduced_series(&SHORT_EXPONENTIAL, j2, j3)
        } else {
            reduced_series(&LONG_EXPONENTIAL, j2, j3)
        };
        combination(c0, c1, a, c2, &square)
    } else {
        exp_symmetric(a) - Mat3::identity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jstsph_tensor::deviator;
    use proptest::prelude::*;

    fn symmetric(v: [f64; 6]) -> Mat3 {
        Mat3::new(v[0], v[1], v[2], v[1], v[3], v[4], v[2], v[4], v[5])
    }

    proptest! {
        #[test]
        fn deviatoric_strain_is_half_the_deviator_of_the_logarithm(
            v in prop::array::uniform6(-1.0f64..1.0), size in -8i32..1, volume in -3.0f64..3.0,
        ) {
            let log = symmetric(v) * 10f64.powi(size) + Mat3::identity() * volume;
            let strain = deviatoric_hencky_strain(&exp_symmetric(&log));
            // b carries round-off relative to its largest entry: at the far end of the range its
            // smallest principal value is exp(2 |A|) smaller.
            let round_off = 4e-15 * (2.0 * symmetric(v).norm() * 10f64.powi(size)).exp();
            prop_assert!((strain - deviator(&log) * 0.5).norm() < round_off);
        }

        #[test]
        fn series_and_spectral_forms_agree_at_the_borders(
            v in prop::array::uniform6(-1.0f64..1.0), border in prop::sample::select(vec![0.00999, 0.0999]),
        ) {
            let direction = deviator(&symmetric(v));
            prop_assume!(direction.norm() > 1e-3);
            let a = direction * (border / direction.norm());
            let spectral = symmetric_eigen(&a);
            let log = spectral.compose(&spectral.values.map(f64::ln_1p));
            let strain = deviatoric_hencky_strain(&(Mat3::identity() + a));
            // Round-off of 1 + a, and of the spectral form relative to a.
            prop_assert!((strain - deviator(&log) * 0.5).norm() < 4e-16);
            let expected = spectral.compose(&spectral.values.map(f64::exp_m1));
            prop_assert!((isochoric_exponential_less_one(&a) - expected).norm() < 4e-15 * border);
        }

        #[test]
        fn small_exponentials_keep_their_relative_accuracy(
            v in prop::array::uniform6(-1.0f64..1.0), size in -12i32..-1,
        ) {
            let a = deviator(&symmetric(v)) * 10f64.powi(size);
            let spectral = symmetric_eigen(&a);
            let expected = spectral.compose(&spectral.values.map(f64::exp_m1));
            prop_assert!((isochoric_exponential_less_one(&a) - expected).norm() <= 2e-15 * a.norm());
        }
    }

    #[test]
    fn plane_strain_stays_plane_strain_bit_for_bit() {
        let b = Mat3::new(1.02, 0.013, 0.0, 0.013, 0.97, 0.0, 0.0, 0.0, 1.0);
        let strain = deviatoric_hencky_strain(&b);
        assert_eq!((strain.m13, strain.m23), (0.0, 0.0));
    }
}
