//! Tensor algebra on vectors of points, in the order of the readable functions. With `PLANE` the
//! components 13, 23, 31 and 32 are zero and left out: the values are the same, a zero may differ in its sign.

use crate::logarithmic_strain::SHORT_SERIES_LIMIT;
use jstsph_tensor::lanes::{Lanes, Simd, TILE, TensorTile};

/// Symmetric tensors as 11, 22, 33, 12, 13, 23.
pub(super) type Symmetric<S> = [Lanes<S>; 6];
/// Tensors as 11, 21, 31, 12, 22, 32, 13, 23, 33.
pub(super) type Full<S> = [Lanes<S>; 9];

/// Components of a symmetric tensor that are not zero.
const fn components(plane: bool) -> usize {
    if plane { 4 } else { 6 }
}

#[inline(always)]
pub(super) fn load<S: Simd, const PLANE: bool>(simd: S, tile: &TensorTile, pack: usize) -> Full<S> {
    let mut tensor = [Lanes::splat(simd, 0.0); 9];
    for (k, component) in tensor.iter_mut().enumerate() {
        if !PLANE || [0, 1, 3, 4, 8].contains(&k) {
            *component = Lanes::load(simd, &tile.0[k], pack);
        }
    }
    tensor
}

#[inline(always)]
pub(super) fn load_symmetric<S: Simd, const PLANE: bool>(
    simd: S,
    tile: &[[f64; TILE]; 6],
    pack: usize,
) -> Symmetric<S> {
    let mut tensor = [Lanes::splat(simd, 0.0); 6];
    for k in 0..components(PLANE) {
        tensor[k] = Lanes::load(simd, &tile[k], pack);
    }
    tensor
}

#[inline(always)]
pub(super) fn store_symmetric<S: Simd, const PLANE: bool>(
    tensor: &Symmetric<S>,
    tile: &mut [[f64; TILE]; 6],
    pack: usize,
) {
    for k in 0..components(PLANE) {
        tensor[k].store(&mut tile[k], pack);
    }
}

#[inline(always)]
pub(super) fn scaled<S: Simd, const PLANE: bool>(
    tensor: &Symmetric<S>,
    factor: Lanes<S>,
) -> Symmetric<S> {
    let mut scaled = *tensor;
    for k in 0..components(PLANE) {
        scaled[k] = tensor[k] * factor;
    }
    scaled
}

#[inline(always)]
pub(super) fn full<S: Simd>(&[m11, m22, m33, m12, m13, m23]: &Symmetric<S>) -> Full<S> {
    [m11, m12, m13, m12, m22, m23, m13, m23, m33]
}

#[inline(always)]
pub(super) fn determinant<S: Simd, const PLANE: bool>(
    &[m11, m21, m31, m12, m22, m32, m13, m23, m33]: &Full<S>,
) -> Lanes<S> {
    if PLANE {
        return m11 * (m22 * m33) - m12 * (m21 * m33);
    }
    m11 * (m22 * m33 - m32 * m23) - m12 * (m21 * m33 - m31 * m23) + m13 * (m21 * m32 - m31 * m22)
}

/// (cof F)ᵀ s, the columns of (cof F)ᵀ being the rows of the cofactor.
#[inline(always)]
pub(super) fn cofactor_transposed<S: Simd, const PLANE: bool>(
    &[m11, m21, m31, m12, m22, m32, m13, m23, m33]: &Full<S>,
    factor: Lanes<S>,
) -> Full<S> {
    if PLANE {
        let zero = factor.zero();
        return [
            m22 * m33 * factor,
            -(m21 * m33) * factor,
            zero,
            -(m33 * m12) * factor,
            m33 * m11 * factor,
            zero,
            zero,
            zero,
            (m11 * m22 - m12 * m21) * factor,
        ];
    }
    let mut cofactor = [
        m22 * m33 - m23 * m32,
        m23 * m31 - m21 * m33,
        m21 * m32 - m22 * m31,
        m32 * m13 - m33 * m12,
        m33 * m11 - m31 * m13,
        m31 * m12 - m32 * m11,
        m12 * m23 - m13 * m22,
        m13 * m21 - m11 * m23,
        m11 * m22 - m12 * m21,
    ];
    for entry in &mut cofactor {
        *entry = *entry * factor;
    }
    cofactor
}

#[inline(always)]
pub(super) fn product<S: Simd, const PLANE: bool>(a: &Full<S>, b: &Full<S>) -> Full<S> {
    let mut product = *a;
    if PLANE {
        for k in [0, 1, 3, 4] {
            let (i, j) = (k % 3, 3 * (k / 3));
            product[k] = a[i] * b[j] + a[i + 3] * b[j + 1];
        }
        product[8] = a[8] * b[8];
        return product;
    }
    for (k, entry) in product.iter_mut().enumerate() {
        let (i, j) = (k % 3, 3 * (k / 3));
        *entry = a[i] * b[j] + a[i + 3] * b[j + 1] + a[i + 6] * b[j + 2];
    }
    product
}

/// Σ_k A_ik F_jk.
#[inline(always)]
fn entry<S: Simd>(a: &Full<S>, f: &Full<S>, i: usize, j: usize) -> Lanes<S> {
    a[i] * f[j] + a[i + 3] * f[j + 3] + a[i + 6] * f[j + 6]
}

/// The same in the plane.
#[inline(always)]
fn plane_entry<S: Simd>(a: &Full<S>, f: &Full<S>, i: usize, j: usize) -> Lanes<S> {
    a[i] * f[j] + a[i + 3] * f[j + 3]
}

/// F A Fᵀ of a symmetric A.
#[inline(always)]
pub(super) fn congruence<S: Simd, const PLANE: bool>(f: &Full<S>, a: &Full<S>) -> Symmetric<S> {
    let fa = product::<S, PLANE>(f, a);
    if PLANE {
        let zero = fa[0].zero();
        return [
            plane_entry(&fa, f, 0, 0),
            plane_entry(&fa, f, 1, 1),
            fa[8] * f[8],
            plane_entry(&fa, f, 0, 1),
            zero,
            zero,
        ];
    }
    [
        entry(&fa, f, 0, 0),
        entry(&fa, f, 1, 1),
        entry(&fa, f, 2, 2),
        entry(&fa, f, 0, 1),
        entry(&fa, f, 0, 2),
        entry(&fa, f, 1, 2),
    ]
}

#[inline(always)]
pub(super) fn norm_squared<S: Simd, const PLANE: bool>(
    &[m11, m22, m33, m12, m13, m23]: &Symmetric<S>,
) -> Lanes<S> {
    if PLANE {
        return (m11 * m11 + m12 * m12) + (m12 * m12 + m22 * m22) + m33 * m33;
    }
    (m11 * m11 + m12 * m12 + m13 * m13)
        + (m12 * m12 + m22 * m22 + m23 * m23)
        + (m13 * m13 + m23 * m23 + m33 * m33)
}

/// A² and det A.
#[inline(always)]
pub(super) fn square_and_determinant<S: Simd, const PLANE: bool>(
    &[m11, m22, m33, m12, m13, m23]: &Symmetric<S>,
) -> (Symmetric<S>, Lanes<S>) {
    if PLANE {
        let square = [
            m11 * m11 + m12 * m12,
            m12 * m12 + m22 * m22,
            m33 * m33,
            m12 * (m11 + m22),
            m13,
            m23,
        ];
        return (square, m11 * (m22 * m33) - m12 * (m12 * m33));
    }
    let square = [
        m11 * m11 + m12 * m12 + m13 * m13,
        m12 * m12 + m22 * m22 + m23 * m23,
        m13 * m13 + m23 * m23 + m33 * m33,
        m12 * (m11 + m22) + m13 * m23,
        m13 * (m11 + m33) + m12 * m23,
        m23 * (m22 + m33) + m12 * m13,
    ];
    let determinant = m11 * (m22 * m33 - m23 * m23) - m12 * (m12 * m33 - m13 * m23)
        + m13 * (m12 * m23 - m13 * m22);
    (square, determinant)
}

/// c₀ 1 + c₁ A + c₂ B.
#[inline(always)]
pub(super) fn combination<S: Simd, const PLANE: bool>(
    c0: Lanes<S>,
    [c1, c2]: [Lanes<S>; 2],
    [a, b]: [&Symmetric<S>; 2],
) -> Symmetric<S> {
    let mut sum = *a;
    for k in 0..components(PLANE) {
        sum[k] = if k < 3 {
            c0 + c1 * a[k] + c2 * b[k]
        } else {
            c1 * a[k] + c2 * b[k]
        };
    }
    sum
}

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

