//! Several points at once: the same formulas on vectors of numbers, one lane per point.
//!
//! The instruction set is chosen while the program runs (AVX-512, AVX2 with FMA, else plain scalars),
//! so that a portable binary uses what the machine has. Every lane rounds as the scalar formula
//! does: no operation is contracted, and the width of the machine does not change a bit.
//!
//! ```
//! use jstsph_tensor::lanes::{Lanes, Simd, TILE, WithSimd, vectorised};
//!
//! struct Square<'a>(&'a mut [f64; TILE]);
//! impl WithSimd for Square<'_> {
//!     type Output = ();
//!     #[inline(always)]
//!     fn with_simd<S: Simd>(self, simd: S) {
//!         for pack in 0..TILE / S::F64_LANES {
//!             let x = Lanes::load(simd, self.0, pack);
//!             (x * x).store(self.0, pack);
//!         }
//!     }
//! }
//! let mut tile = [3.0; TILE];
//! vectorised(Square(&mut tile));
//! assert_eq!(tile, [9.0; TILE]);
//! ```

use std::ops::{Add, Mul, Neg, Sub};

use crate::Mat3;

mod symmetric;
mod tensor;

pub use pulp::{Scalar, Simd, WithSimd};
pub use symmetric::{LaneSymmetric, PlaneSymmetricLanes, SymmetricLanes, SymmetricTile};
pub use tensor::{LaneTensor, PlaneLanes, TensorLanes};

/// Points that are worked on together. Enough that what is written number by number has left the
/// store buffer when it is read as vectors, few enough that a dozen tiles stay in the first cache.
pub const TILE: usize = 32;

/// Runs an operation with the widest instruction set of the machine.
#[inline]
pub fn vectorised<Op: WithSimd>(operation: Op) -> Op::Output {
    pulp::Arch::new().dispatch(operation)
}

/// One number for each of some neighbouring points.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Simd> {
    simd: S,
    values: S::f64s,
}

impl<S: Simd> Lanes<S> {
    /// The same number in every lane.
    #[inline(always)]
    #[must_use]
    pub fn splat(simd: S, value: f64) -> Self {
        Self {
            simd,
            values: simd.splat_f64s(value),
        }
    }

    /// The `pack`-th vector of a tile.
    #[inline(always)]
    #[must_use]
    pub fn load(simd: S, tile: &[f64; TILE], pack: usize) -> Self {
        Self {
            simd,
            values: S::as_simd_f64s(tile).0[pack],
        }
    }

    /// Writes the `pack`-th vector of a tile.
    #[inline(always)]
    pub fn store(self, tile: &mut [f64; TILE], pack: usize) {
        S::as_mut_simd_f64s(tile).0[pack] = self.values;
    }

    /// Zero in every lane.
    #[inline(always)]
    #[must_use]
    pub fn zero(self) -> Self {
        Self::splat(self.simd, 0.0)
    }

    /// As many neighbouring numbers as there are lanes, from the first of `numbers` on.
    ///
    /// # Panics
    /// If there are not as many: a bug in the caller.
    #[inline(always)]
    #[must_use]
    pub fn from_slice(simd: S, numbers: &[f64]) -> Self {
        Self {
            simd,
            values: S::as_simd_f64s(&numbers[..S::F64_LANES]).0[0],
        }
    }

    /// Writes the lanes to the first of `numbers`.
    ///
    /// # Panics
    /// If there are not as many: a bug in the caller.
    #[inline(always)]
    pub fn to_slice(self, numbers: &mut [f64]) {
        S::as_mut_simd_f64s(&mut numbers[..S::F64_LANES]).0[0] = self.values;
    }

    /// One in every lane.
    #[inline(always)]
    #[must_use]
    pub fn one(self) -> Self {
        Self::splat(self.simd, 1.0)
    }

    /// 1/x.
    #[inline(always)]
    #[must_use]
    pub fn inverse(self) -> Self {
        Self {
            values: self.simd.div_f64s(self.simd.splat_f64s(1.0), self.values),
            ..self
        }
    }

    /// x/y.
    #[inline(always)]
    #[must_use]
    pub fn over(self, divisor: Self) -> Self {
        Self {
            values: self.simd.div_f64s(self.values, divisor.values),
            ..self
        }
    }

    /// √x.
    #[inline(always)]
    #[must_use]
    pub fn sqrt(self) -> Self {
        Self {
            values: self.simd.sqrt_f64s(self.values),
            ..self
        }
    }

    /// The largest of the lanes; any number if one of them is none.
    #[inline(always)]
    #[must_use]
    pub fn largest(self) -> f64 {
        self.simd.reduce_max_f64s(self.values)
    }

    /// The sum of the lanes, in an order that depends on the machine: for what is exact, as zeros are.
    #[inline(always)]
    #[must_use]
    pub fn sum(self) -> f64 {
        self.simd.reduce_sum_f64s(self.values)
    }

    /// |x|.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        Self {
            values: self.simd.abs_f64s(self.values),
            ..self
        }
    }

    /// Lane by lane `if self < limit { yes } else { no }`; not a number is not less.
    #[inline(always)]
    #[must_use]
    pub fn if_less(self, limit: f64, yes: Self, no: Self) -> Self {
        self.if_below(Self::splat(self.simd, limit), yes, no)
    }

    /// Lane by lane `if self < limit { yes } else { no }`; not a number is not less.
    #[inline(always)]
    #[must_use]
    pub fn if_below(self, limit: Self, yes: Self, no: Self) -> Self {
        let mask = self.simd.less_than_f64s(self.values, limit.values);
        Self {
            values: self.simd.select_f64s(mask, yes.values, no.values),
            ..self
        }
    }

    /// Lane by lane `if self <= limit { yes } else { no }`; not a number is not at most anything.
    #[inline(always)]
    #[must_use]
    pub fn if_at_most(self, limit: Self, yes: Self, no: Self) -> Self {
        let mask = self.simd.less_than_or_equal_f64s(self.values, limit.values);
        Self {
            values: self.simd.select_f64s(mask, yes.values, no.values),
            ..self
        }
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            values: self.simd.add_f64s(self.values, other.values),
            ..self
        }
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            values: self.simd.sub_f64s(self.values, other.values),
            ..self
        }
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            values: self.simd.mul_f64s(self.values, other.values),
            ..self
        }
    }
}

impl<S: Simd> Mul<f64> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        self * Self::splat(self.simd, other)
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            values: self.simd.neg_f64s(self.values),
            ..self
        }
    }
}

/// The `pack`-th vectors of several tiles.
// Here and below loops instead of closures: a closure that is compiled on its own has not the
// instruction set of the function around it.
#[inline(always)]
#[must_use]
pub fn load_all<S: Simd, const N: usize>(
    simd: S,
    tiles: &[[f64; TILE]; N],
    pack: usize,
) -> [Lanes<S>; N] {
    let mut lanes = [Lanes::splat(simd, 0.0); N];
    for k in 0..N {
        lanes[k] = Lanes::load(simd, &tiles[k], pack);
    }
    lanes
}

/// Writes the `pack`-th vectors of several tiles.
#[inline(always)]
pub fn store_all<S: Simd, const N: usize>(
    lanes: &[Lanes<S>; N],
    tiles: &mut [[f64; TILE]; N],
    pack: usize,
) {
    for k in 0..N {
        lanes[k].store(&mut tiles[k], pack);
    }
}

/// Every lane vector of a list times the same one.
#[inline(always)]
#[must_use]
pub fn times<S: Simd, const N: usize>(list: &[Lanes<S>; N], factor: Lanes<S>) -> [Lanes<S>; N] {
    let mut scaled = *list;
    for value in &mut scaled {
        *value = *value * factor;
    }
    scaled
}

/// A tile of tensors, component by component in the order 11, 21, 31, 12, 22, 32, 13, 23, 33.
#[derive(Clone, Debug)]
pub struct TensorTile(pub [[f64; TILE]; 9]);

impl TensorTile {
    /// All zero.
    pub const ZERO: Self = Self([[0.0; TILE]; 9]);

    /// Reads [`TILE`] tensors.
    ///
    /// # Panics
    /// If there are fewer: a bug in the caller.
    // Not inlined: with a wide instruction set the compiler would gather and scatter, which takes
    // several times as long as moving number by number.
    #[inline(never)]
    pub fn read(&mut self, tensors: &[Mat3]) {
        let tensors = &tensors[..TILE];
        for (i, tensor) in tensors.iter().enumerate() {
            let columns: &[[f64; 3]; 3] = tensor.as_ref();
            for (k, component) in columns.as_flattened().iter().enumerate() {
                self.0[k][i] = *component;
            }
        }
    }

    /// Writes [`TILE`] tensors.
    ///
    /// # Panics
    /// If there are fewer: a bug in the caller.
    #[inline(never)]
    pub fn write(&self, tensors: &mut [Mat3]) {
        let tensors = &mut tensors[..TILE];
        for (i, tensor) in tensors.iter_mut().enumerate() {
            let columns: &mut [[f64; 3]; 3] = tensor.as_mut();
            for (k, component) in columns.as_flattened_mut().iter_mut().enumerate() {
                *component = self.0[k][i];
            }
        }
    }

    /// Reads [`TILE`] tensors of plane strain: only the components 11, 21, 12, 22 and 33, the others of
    /// the tile stay.
    ///
    /// # Panics
    /// If there are fewer: a bug in the caller.
    #[inline(never)]
    pub fn read_plane(&mut self, tensors: &[Mat3]) {
        let tensors = &tensors[..TILE];
        for (i, tensor) in tensors.iter().enumerate() {
            // Written so that something that is not a number passes: it is found by its other components.
            debug_assert!(
                ![tensor.m13, tensor.m23, tensor.m31, tensor.m32]
                    .iter()
                    .any(|component| component.abs() > 0.0),
                "not plane: {tensor}"
            );
            self.0[0][i] = tensor.m11;
            self.0[1][i] = tensor.m21;
            self.0[3][i] = tensor.m12;
            self.0[4][i] = tensor.m22;
            self.0[8][i] = tensor.m33;
        }
    }

    /// Writes the components of plane strain of [`TILE`] tensors; their others stay.
    ///
    /// # Panics
    /// If there are fewer: a bug in the caller.
    #[inline(never)]
    pub fn write_plane(&self, tensors: &mut [Mat3]) {
        let tensors = &mut tensors[..TILE];
        for (i, tensor) in tensors.iter_mut().enumerate() {
            tensor.m11 = self.0[0][i];
            tensor.m21 = self.0[1][i];
            tensor.m12 = self.0[3][i];
            tensor.m22 = self.0[4][i];
            tensor.m33 = self.0[8][i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{cofactor, double_dot, tensor_cross};

    struct Products<'a> {
        a: &'a TensorTile,
        b: &'a TensorTile,
        cross: &'a mut TensorTile,
        cofactors: &'a mut TensorTile,
        dot: &'a mut [f64; TILE],
        plane: bool,
    }

    impl WithSimd for Products<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(mut self, simd: S) {
            for pack in 0..TILE / S::F64_LANES {
                if self.plane {
                    self.products::<S, PlaneLanes<S>>(simd, pack);
                } else {
                    self.products::<S, TensorLanes<S>>(simd, pack);
                }
            }
        }
    }

    impl Products<'_> {
        #[inline(always)]
        fn products<S: Simd, T: LaneTensor<S>>(&mut self, simd: S, pack: usize) {
            let (a, b) = (T::load(simd, self.a, pack), T::load(simd, self.b, pack));
            a.cross(&b).store(self.cross, pack);
            a.cofactor().store(self.cofactors, pack);
            a.double_dot(&b).store(self.dot, pack);
        }
    }

    fn assert_bits_of_scalar_formulas(plane: bool) {
        let sample = |i: usize, phase: f64| {
            Mat3::from_fn(|r, c| {
                let entry = (1.7 * i as f64 + 0.9 * (r + 3 * c) as f64 + phase).sin();
                if plane && (r == 2) != (c == 2) {
                    0.0
                } else {
                    entry
                }
            })
        };
        let a: Vec<_> = (0..TILE).map(|i| sample(i, 0.1)).collect();
        let b: Vec<_> = (0..TILE).map(|i| sample(i, 2.3)).collect();
        let (mut at, mut bt) = (TensorTile::ZERO, TensorTile::ZERO);
        let (mut cross, mut cofactors) = (TensorTile::ZERO, TensorTile::ZERO);
        for (tile, tensors) in [(&mut at, &a), (&mut bt, &b)] {
            if plane {
                tile.read_plane(tensors);
            } else {
                tile.read(tensors);
            }
        }
        let mut dot = [0.0; TILE];
        let products = Products {
            a: &at,
            b: &bt,
            cross: &mut cross,
            cofactors: &mut cofactors,
            dot: &mut dot,
            plane,
        };
        vectorised(products);
        let [crossed, cofactors] = [cross, cofactors].map(|tile| {
            let mut tensors = vec![Mat3::zeros(); TILE];
            if plane {
                tile.write_plane(&mut tensors);
            } else {
                tile.write(&mut tensors);
            }
            tensors
        });
        for i in 0..TILE {
            assert_eq!(crossed[i], tensor_cross(&a[i], &b[i]));
            assert_eq!(cofactors[i], cofactor(&a[i]));
            assert_eq!(dot[i], double_dot(&a[i], &b[i]));
        }
    }

    #[test]
    fn lanes_have_the_bits_of_the_scalar_formulas() {
        assert_bits_of_scalar_formulas(false);
    }

    #[test]
    fn lanes_of_plane_strain_have_the_bits_of_the_scalar_formulas() {
        assert_bits_of_scalar_formulas(true);
    }

    #[test]
    fn a_number_that_is_none_is_not_less() {
        struct Choose<'a>(&'a mut [f64; TILE]);
        impl WithSimd for Choose<'_> {
            type Output = ();
            #[inline(always)]
            fn with_simd<S: Simd>(self, simd: S) {
                let (yes, no) = (Lanes::splat(simd, 1.0), Lanes::splat(simd, -1.0));
                for pack in 0..TILE / S::F64_LANES {
                    let x = Lanes::load(simd, self.0, pack);
                    x.if_less(5.0, yes, no).store(self.0, pack);
                }
            }
        }
        let mut tile: [f64; TILE] = std::array::from_fn(|i| i as f64);
        tile[1] = f64::NAN;
        vectorised(Choose(&mut tile));
        let expected: [f64; TILE] =
            std::array::from_fn(|i| if i < 5 && i != 1 { 1.0 } else { -1.0 });
        assert_eq!(tile, expected);
    }
}
