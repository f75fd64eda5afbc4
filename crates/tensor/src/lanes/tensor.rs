//! Tensors of neighbouring points, one per lane: general ones, and those of plane strain.

use super::{
    LaneSymmetric, Lanes, PlaneSymmetricLanes, Simd, SymmetricLanes, TensorTile, load_all,
    store_all, times,
};
use crate::Mat3;

/// One tensor for each of some neighbouring points. Formulas written with it work for general tensors
/// and, in half the operations, for those of plane strain; the values are the same, a zero may differ in
/// its sign.
pub trait LaneTensor<S: Simd>: Copy {
    /// The symmetric ones.
    type Symmetric: LaneSymmetric<S>;

    /// Reads a tile of tensors.
    fn read(tile: &mut TensorTile, tensors: &[Mat3]);

    /// Writes a tile of tensors.
    fn write(tile: &TensorTile, tensors: &mut [Mat3]);

    /// The `pack`-th vectors of the components.
    #[must_use]
    fn load(simd: S, tile: &TensorTile, pack: usize) -> Self;

    /// Writes the `pack`-th vectors of the components.
    fn store(&self, tile: &mut TensorTile, pack: usize);

    /// A + B s.
    #[must_use]
    fn plus(&self, other: &Self, factor: f64) -> Self;

    /// A : B, in the order of [`double_dot`](crate::double_dot).
    #[must_use]
    fn double_dot(&self, other: &Self) -> Lanes<S>;

    /// A × B, in the order of [`tensor_cross`](crate::tensor_cross).
    #[must_use]
    fn cross(&self, other: &Self) -> Self;

    /// cof A, in the order of [`cofactor`](crate::cofactor).
    #[must_use]
    fn cofactor(&self) -> Self;

    /// A symmetric tensor with all its components.
    #[must_use]
    fn of_symmetric(symmetric: &Self::Symmetric) -> Self;

    /// det A.
    #[must_use]
    fn determinant(&self) -> Lanes<S>;

    /// Aᵀ s.
    #[must_use]
    fn transposed(&self, factor: Lanes<S>) -> Self;

    /// A B.
    #[must_use]
    fn product(&self, other: &Self) -> Self;

    /// A B Aᵀ of a symmetric B, of which only one half is worked out.
    #[must_use]
    fn congruence(&self, symmetric: &Self) -> Self::Symmetric;

    /// Aᵀ A as 11, 22, 33, 12, 13, 23.
    #[must_use]
    fn gram(&self) -> [Lanes<S>; 6];

    /// The product of a symmetric tensor, as 11, 22, 33, 12, 13, 23, with this one, times a number.
    #[must_use]
    fn times_symmetric(&self, symmetric: &[Lanes<S>; 6], factor: Lanes<S>) -> Self;
}

/// General tensors; components in the order 11, 21, 31, 12, 22, 32, 13, 23, 33.
#[derive(Clone, Copy, Debug)]
pub struct TensorLanes<S: Simd>(pub [Lanes<S>; 9]);

impl<S: Simd> LaneTensor<S> for TensorLanes<S> {
    type Symmetric = SymmetricLanes<S>;

    #[inline(always)]
    fn read(tile: &mut TensorTile, tensors: &[Mat3]) {
        tile.read(tensors);
    }

    #[inline(always)]
    fn write(tile: &TensorTile, tensors: &mut [Mat3]) {
        tile.write(tensors);
    }

    #[inline(always)]
    fn load(simd: S, tile: &TensorTile, pack: usize) -> Self {
        Self(load_all(simd, &tile.0, pack))
    }

    #[inline(always)]
    fn store(&self, tile: &mut TensorTile, pack: usize) {
        store_all(&self.0, &mut tile.0, pack);
    }

    #[inline(always)]
    fn plus(&self, other: &Self, factor: f64) -> Self {
        let mut sum = *self;
        for k in 0..9 {
            sum.0[k] = self.0[k] + other.0[k] * factor;
        }
        sum
    }

    #[inline(always)]
    fn double_dot(&self, other: &Self) -> Lanes<S> {
        let [a11, a21, a31, a12, a22, a32, a13, a23, a33] = self.0;
        let [b11, b21, b31, b12, b22, b32, b13, b23, b33] = other.0;
        (a11 * b11 + a21 * b21 + a31 * b31)
            + (a12 * b12 + a22 * b22 + a32 * b32)
            + (a13 * b13 + a23 * b23 + a33 * b33)
    }

    #[inline(always)]
    fn cross(&self, other: &Self) -> Self {
        let [a11, a21, a31, a12, a22, a32, a13, a23, a33] = self.0;
        let [b11, b21, b31, b12, b22, b32, b13, b23, b33] = other.0;
        Self([
            a22 * b33 - a23 * b32 + a33 * b22 - a32 * b23,
            a13 * b32 - a12 * b33 + a32 * b13 - a33 * b12,
            a12 * b23 - a13 * b22 + a23 * b12 - a22 * b13,
            a23 * b31 - a21 * b33 + a31 * b23 - a33 * b21,
            a33 * b11 - a31 * b13 + a11 * b33 - a13 * b31,
            a13 * b21 - a11 * b23 + a21 * b13 - a23 * b11,
            a21 * b32 - a22 * b31 + a32 * b21 - a31 * b22,
            a31 * b12 - a32 * b11 + a12 * b31 - a11 * b32,
            a11 * b22 - a12 * b21 + a22 * b11 - a21 * b12,
        ])
    }

    #[inline(always)]
    fn cofactor(&self) -> Self {
        let [a11, a21, a31, a12, a22, a32, a13, a23, a33] = self.0;
        Self([
            a22 * a33 - a23 * a32,
            a32 * a13 - a33 * a12,
            a12 * a23 - a13 * a22,
            a23 * a31 - a21 * a33,
            a33 * a11 - a31 * a13,
            a13 * a21 - a11 * a23,
            a21 * a32 - a22 * a31,
            a31 * a12 - a32 * a11,
            a11 * a22 - a12 * a21,
        ])
    }

    #[inline(always)]
    fn of_symmetric(symmetric: &SymmetricLanes<S>) -> Self {
        let [m11, m22, m33, m12, m13, m23] = symmetric.0;
        Self([m11, m12, m13, m12, m22, m23, m13, m23, m33])
    }

    #[inline(always)]
    fn determinant(&self) -> Lanes<S> {
        let [m11, m21, m31, m12, m22, m32, m13, m23, m33] = self.0;
        m11 * (m22 * m33 - m32 * m23) - m12 * (m21 * m33 - m31 * m23)
            + m13 * (m21 * m32 - m31 * m22)
    }

    #[inline(always)]
    fn transposed(&self, factor: Lanes<S>) -> Self {
        let mut transposed = *self;
        for k in 0..9 {
            transposed.0[k] = self.0[k / 3 + 3 * (k % 3)] * factor;
        }
        transposed
    }

    #[inline(always)]
    fn product(&self, other: &Self) -> Self {
        let (a, b) = (&self.0, &other.0);
        let mut product = *self;
        for k in 0..9 {
            let (i, j) = (k % 3, k - k % 3);
            product.0[k] = a[i] * b[j] + a[i + 3] * b[j + 1] + a[i + 6] * b[j + 2];
        }
        product
    }

    #[inline(always)]
    fn congruence(&self, symmetric: &Self) -> SymmetricLanes<S> {
        let (a, f) = (self.product(symmetric).0, &self.0);
        let mut result = SymmetricLanes([a[0]; 6]);
        for (k, (i, j)) in HALF.into_iter().enumerate() {
            result.0[k] = a[i] * f[j] + a[i + 3] * f[j + 3] + a[i + 6] * f[j + 6];
        }
        result
    }

    #[inline(always)]
    fn gram(&self) -> [Lanes<S>; 6] {
        let [h11, h21, h31, h12, h22, h32, h13, h23, h33] = self.0;
        [
            h11 * h11 + h21 * h21 + h31 * h31,
            h12 * h12 + h22 * h22 + h32 * h32,
            h13 * h13 + h23 * h23 + h33 * h33,
            h11 * h12 + h21 * h22 + h31 * h32,
            h11 * h13 + h21 * h23 + h31 * h33,
            h12 * h13 + h22 * h23 + h32 * h33,
        ]
    }

    #[inline(always)]
    fn times_symmetric(
        &self,
        &[t11, t22, t33, t12, t13, t23]: &[Lanes<S>; 6],
        factor: Lanes<S>,
    ) -> Self {
        let rows = [[t11, t12, t13], [t12, t22, t23], [t13, t23, t33]];
        let mut product = *self;
        for k in 0..9 {
            let [a, b, c] = rows[k % 3];
            let column = k - k % 3;
            let h = &self.0[column..column + 3];
            product.0[k] = (a * h[0] + b * h[1] + c * h[2]) * factor;
        }
        product
    }
}

/// Rows and columns of the components of a symmetric tensor.
const HALF: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// Tensors of plane strain; components in the order 11, 21, 12, 22, 33.
#[derive(Clone, Copy, Debug)]
pub struct PlaneLanes<S: Simd>(pub [Lanes<S>; 5]);

/// Where they are in a tile.
const PLANE: [usize; 5] = [0, 1, 3, 4, 8];

impl<S: Simd> LaneTensor<S> for PlaneLanes<S> {
    type Symmetric = PlaneSymmetricLanes<S>;

    #[inline(always)]
    fn read(tile: &mut TensorTile, tensors: &[Mat3]) {
        tile.read_plane(tensors);
    }

    #[inline(always)]
    fn write(tile: &TensorTile, tensors: &mut [Mat3]) {
        tile.write_plane(tensors);
    }

    #[inline(always)]
    fn load(simd: S, tile: &TensorTile, pack: usize) -> Self {
        let mut lanes = [Lanes::splat(simd, 0.0); 5];
        for (k, place) in PLANE.into_iter().enumerate() {
            lanes[k] = Lanes::load(simd, &tile.0[place], pack);
        }
        Self(lanes)
    }

    #[inline(always)]
    fn store(&self, tile: &mut TensorTile, pack: usize) {
        for (k, place) in PLANE.into_iter().enumerate() {
            self.0[k].store(&mut tile.0[place], pack);
        }
    }

    #[inline(always)]
    fn plus(&self, other: &Self, factor: f64) -> Self {
        let mut sum = *self;
        for k in 0..5 {
            sum.0[k] = self.0[k] + other.0[k] * factor;
        }
        sum
    }

    #[inline(always)]
    fn double_dot(&self, other: &Self) -> Lanes<S> {
        let [a11, a21, a12, a22, a33] = self.0;
        let [b11, b21, b12, b22, b33] = other.0;
        (a11 * b11 + a21 * b21) + (a12 * b12 + a22 * b22) + a33 * b33
    }

    #[inline(always)]
    fn cross(&self, other: &Self) -> Self {
        let [a11, a21, a12, a22, a33] = self.0;
        let [b11, b21, b12, b22, b33] = other.0;
        Self([
            a22 * b33 + a33 * b22,
            -(a12 * b33) - a33 * b12,
            -(a21 * b33) - a33 * b21,
            a33 * b11 + a11 * b33,
            a11 * b22 - a12 * b21 + a22 * b11 - a21 * b12,
        ])
    }

    #[inline(always)]
    fn cofactor(&self) -> Self {
        let [a11, a21, a12, a22, a33] = self.0;
        Self([
            a22 * a33,
            -(a33 * a12),
            -(a21 * a33),
            a33 * a11,
            a11 * a22 - a12 * a21,
        ])
    }

    #[inline(always)]
    fn of_symmetric(symmetric: &PlaneSymmetricLanes<S>) -> Self {
        let [m11, m22, m33, m12] = symmetric.0;
        Self([m11, m12, m12, m22, m33])
    }

    #[inline(always)]
    fn determinant(&self) -> Lanes<S> {
        let [m11, m21, m12, m22, m33] = self.0;
        m11 * (m22 * m33) - m12 * (m21 * m33)
    }

    #[inline(always)]
    fn transposed(&self, factor: Lanes<S>) -> Self {
        let [m11, m21, m12, m22, m33] = self.0;
        Self(times(&[m11, m12, m21, m22, m33], factor))
    }

    #[inline(always)]
    fn product(&self, other: &Self) -> Self {
        let [a11, a21, a12, a22, a33] = self.0;
        let [b11, b21, b12, b22, b33] = other.0;
        Self([
            a11 * b11 + a12 * b21,
            a21 * b11 + a22 * b21,
            a11 * b12 + a12 * b22,
            a21 * b12 + a22 * b22,
            a33 * b33,
        ])
    }

    #[inline(always)]
    fn congruence(&self, symmetric: &Self) -> PlaneSymmetricLanes<S> {
        let [f11, f21, f12, f22, f33] = self.0;
        let [a11, a21, a12, a22, a33] = self.product(symmetric).0;
        PlaneSymmetricLanes([
            a11 * f11 + a12 * f12,
            a21 * f21 + a22 * f22,
            a33 * f33,
            a11 * f21 + a12 * f22,
        ])
    }

    #[inline(always)]
    fn gram(&self) -> [Lanes<S>; 6] {
        let [h11, h21, h12, h22, h33] = self.0;
        let zero = h11.zero();
        [
            h11 * h11 + h21 * h21,
            h12 * h12 + h22 * h22,
            h33 * h33,
            h11 * h12 + h21 * h22,
            zero,
            zero,
        ]
    }

    #[inline(always)]
    fn times_symmetric(
        &self,
        &[t11, t22, t33, t12, _, _]: &[Lanes<S>; 6],
        factor: Lanes<S>,
    ) -> Self {
        let [h11, h21, h12, h22, h33] = self.0;
        Self([
            (t11 * h11 + t12 * h21) * factor,
            (t12 * h11 + t22 * h21) * factor,
            (t11 * h12 + t12 * h22) * factor,
            (t12 * h12 + t22 * h22) * factor,
            t33 * h33 * factor,
        ])
    }
}
