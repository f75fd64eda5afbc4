//! Symmetric tensors of neighbouring points, one per lane: general ones, and those of plane strain.

use super::{Lanes, Simd, TILE};

/// A tile of symmetric tensors, component by component in the order 11, 22, 33, 12, 13, 23.
pub type SymmetricTile = [[f64; TILE]; 6];

/// One symmetric tensor for each of some neighbouring points; see [`LaneTensor`](super::LaneTensor).
pub trait LaneSymmetric<S: Simd>: Copy {
    /// The `pack`-th vectors of the components.
    #[must_use]
    fn load(simd: S, tile: &SymmetricTile, pack: usize) -> Self;

    /// Writes the `pack`-th vectors of the components; those that are zero in plane strain stay.
    fn store(&self, tile: &mut SymmetricTile, pack: usize);

    /// tr A.
    #[must_use]
    fn trace(&self) -> Lanes<S>;

    /// A s.
    #[must_use]
    fn scaled(&self, factor: Lanes<S>) -> Self;

    /// A + B.
    #[must_use]
    fn plus(&self, other: &Self) -> Self;

    /// A + s 1.
    #[must_use]
    fn plus_identity(&self, factor: Lanes<S>) -> Self;

    /// A : A, in the order of [`norm_squared`](crate::norm_squared).
    #[must_use]
    fn norm_squared(&self) -> Lanes<S>;

    /// A² and det A.
    #[must_use]
    fn square_and_determinant(&self) -> (Self, Lanes<S>);

    /// c₀ 1 + c₁ A + c₂ B.
    #[must_use]
    fn combination(&self, other: &Self, coefficients: [Lanes<S>; 3]) -> Self;
}

/// General symmetric tensors; components in the order 11, 22, 33, 12, 13, 23.
#[derive(Clone, Copy, Debug)]
pub struct SymmetricLanes<S: Simd>(pub [Lanes<S>; 6]);

/// Symmetric tensors of plane strain; components in the order 11, 22, 33, 12.
#[derive(Clone, Copy, Debug)]
pub struct PlaneSymmetricLanes<S: Simd>(pub [Lanes<S>; 4]);

/// What only goes component by component.
macro_rules! componentwise {
    ($count:literal) => {
        #[inline(always)]
        fn load(simd: S, tile: &SymmetricTile, pack: usize) -> Self {
            let mut tensor = [Lanes::splat(simd, 0.0); $count];
            for (lanes, tile) in tensor.iter_mut().zip(tile) {
                *lanes = Lanes::load(simd, tile, pack);
            }
            Self(tensor)
        }

        #[inline(always)]
        fn store(&self, tile: &mut SymmetricTile, pack: usize) {
            for (lanes, tile) in self.0.iter().zip(tile) {
                lanes.store(tile, pack);
            }
        }

        #[inline(always)]
        fn trace(&self) -> Lanes<S> {
            self.0[0] + self.0[1] + self.0[2]
        }

        #[inline(always)]
        fn scaled(&self, factor: Lanes<S>) -> Self {
            let mut scaled = *self;
            for component in &mut scaled.0 {
                *component = *component * factor;
            }
            scaled
        }

        #[inline(always)]
        fn plus(&self, other: &Self) -> Self {
            let mut sum = *self;
            for k in 0..$count {
                sum.0[k] = self.0[k] + other.0[k];
            }
            sum
        }

        #[inline(always)]
        fn plus_identity(&self, factor: Lanes<S>) -> Self {
            let mut sum = *self;
            for diagonal in &mut sum.0[..3] {
                *diagonal = *diagonal + factor;
            }
            sum
        }

        #[inline(always)]
        fn combination(&self, other: &Self, [c0, c1, c2]: [Lanes<S>; 3]) -> Self {
            let (a, b) = (&self.0, &other.0);
            let mut sum = *self;
            for k in 0..$count {
                sum.0[k] = if k < 3 {
                    c0 + c1 * a[k] + c2 * b[k]
                } else {
                    c1 * a[k] + c2 * b[k]
                };
            }
            sum
        }
    };
}

impl<S: Simd> LaneSymmetric<S> for SymmetricLanes<S> {
    componentwise!(6);

    #[inline(always)]
    fn norm_squared(&self) -> Lanes<S> {
        let [m11, m22, m33, m12, m13, m23] = self.0;
        (m11 * m11 + m12 * m12 + m13 * m13)
            + (m12 * m12 + m22 * m22 + m23 * m23)
            + (m13 * m13 + m23 * m23 + m33 * m33)
    }

    #[inline(always)]
    fn square_and_determinant(&self) -> (Self, Lanes<S>) {
        let [m11, m22, m33, m12, m13, m23] = self.0;
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
        (Self(square), determinant)
    }
}

impl<S: Simd> LaneSymmetric<S> for PlaneSymmetricLanes<S> {
    componentwise!(4);

    #[inline(always)]
    fn norm_squared(&self) -> Lanes<S> {
        let [m11, m22, m33, m12] = self.0;
        (m11 * m11 + m12 * m12) + (m12 * m12 + m22 * m22) + m33 * m33
    }

    #[inline(always)]
    fn square_and_determinant(&self) -> (Self, Lanes<S>) {
        let [m11, m22, m33, m12] = self.0;
        let square = [
            m11 * m11 + m12 * m12,
            m12 * m12 + m22 * m22,
            m33 * m33,
            m12 * (m11 + m22),
        ];
        (Self(square), m11 * (m22 * m33) - m12 * (m12 * m33))
    }
}
