//! Isotropic functions of tensors of many points: the reduced series of `logarithmic_strain`, in its order.

use crate::logarithmic_strain::SHORT_SERIES_LIMIT;
use jstsph_tensor::lanes::{Lanes, Simd};

/// The reduced series, short or long for every lane by its squared norm; the long one is only worked
/// out where some lane needs it.
#[inline(always)]
pub(super) fn series<S: Simd, const SHORT: usize, const LONG: usize>(
    simd: S,
    short: &[f64; SHORT],
    long: &[f64; LONG],
    size: Lanes<S>,
    j2: Lanes<S>,
    j3: Lanes<S>,
) -> [Lanes<S>; 3] {
    let of_short = reduced_series(simd, short, j2, j3);
    if size.largest() < SHORT_SERIES_LIMIT {
        return of_short;
    }
    let of_long = reduced_series(simd, long, j2, j3);
    [
        size.if_less(SHORT_SERIES_LIMIT, of_short[0], of_long[0]),
        size.if_less(SHORT_SERIES_LIMIT, of_short[1], of_long[1]),
        size.if_less(SHORT_SERIES_LIMIT, of_short[2], of_long[2]),
    ]
}

/// Horner's scheme with A³ replaced as soon as it appears; the first three steps need no arithmetic.
#[inline(always)]
fn reduced_series<S: Simd, const N: usize>(
    simd: S,
    coefficients: &[f64; N],
    j2: Lanes<S>,
    j3: Lanes<S>,
) -> [Lanes<S>; 3] {
    let mut c0 = Lanes::splat(simd, coefficients[N - 3]);
    let mut c1 = Lanes::splat(simd, coefficients[N - 2]);
    let mut c2 = Lanes::splat(simd, coefficients[N - 1]);
    let mut k = N - 3;
    while k > 0 {
        k -= 1;
        let next = Lanes::splat(simd, coefficients[k]);
        (c0, c1, c2) = (next + c2 * j3, c0 + c2 * j2, c1);
    }
    [c0, c1, c2]
}

