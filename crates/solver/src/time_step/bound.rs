//! Upper bounds of 1/λ², for many points at once.

use jstsph_tensor::lanes::{
    LaneTensor, Lanes, PlaneLanes, Simd, TILE, TensorLanes, TensorTile, WithSimd, times, vectorised,
};

use super::inverse_cauchy_green;
use crate::state::Deformation;

/// Writes, for every point, a bound of the largest principal value of A = F⁻¹ F⁻ᵀ,
///
/// ```text
///   λ_max(A) ≤ ⅓ tr A + √(2/3) |dev A|
/// ```
///
/// sharp where two of the values are equal and the third is larger. Not finite where A is not.
///
/// With `plane`, nothing is out of the plane but the components 33.
pub(crate) fn evaluate(plane: bool, deformation: Deformation<'_>, bounds: &mut [f64]) {
    let count = bounds.len();
    let tiled = count - count % TILE;
    vectorised(Tiles {
        plane,
        deformation: deformation.of(0..tiled),
        bounds: &mut bounds[..tiled],
    });
    for (q, bound) in bounds.iter_mut().enumerate().skip(tiled) {
        let a = inverse_cauchy_green(&deformation.gradient[q], &deformation.cofactor(q));
        let mean = jstsph_tensor::mean_trace(&a);
        let deviator = jstsph_tensor::deviator(&a);
        *bound = mean + (jstsph_tensor::norm_squared(&deviator) * (2.0 / 3.0)).sqrt();
    }
}

/// The bounds of some points, by F and H.
#[inline(always)]
pub(crate) fn of<S: Simd, T: LaneTensor<S>>(f: &T, h: &T) -> Lanes<S> {
    let determinant = h.double_dot(f) * (1.0 / 3.0);
    let scale = (determinant * determinant).inverse();
    let [a11, a22, a33, a12, a13, a23] = times(&h.gram(), scale);
    let mean = (a11 + a22 + a33) * (1.0 / 3.0);
    let (d1, d2, d3) = (a11 - mean, a22 - mean, a33 - mean);
    let off = a12 * a12 + a13 * a13 + a23 * a23;
    let deviator = d1 * d1 + d2 * d2 + d3 * d3 + off * 2.0;
    mean + (deviator * (2.0 / 3.0)).sqrt()
}

/// The largest of some bounds; not a number where one of them is not finite.
pub(crate) fn largest(bounds: &[f64]) -> f64 {
    bounds.iter().fold(0.0, |largest: f64, bound| {
        if bound.is_finite() && largest.is_finite() {
            largest.max(*bound)
        } else {
            f64::NAN
        }
    })
}

/// [`largest`] of a tile.
#[inline(always)]
pub(crate) fn largest_of_tile<S: Simd>(simd: S, bounds: &[f64; TILE]) -> f64 {
    let mut largest = Lanes::load(simd, bounds, 0);
    // Zero as long as everything is finite.
    let mut check = largest.zero();
    for pack in 0..TILE / S::F64_LANES {
        let bound = Lanes::load(simd, bounds, pack);
        largest = largest.if_below(bound, bound, largest);
        check = check + bound * 0.0;
    }
    largest.largest() + check.sum()
}

/// Whole tiles of points.
struct Tiles<'a> {
    plane: bool,
    deformation: Deformation<'a>,
    bounds: &'a mut [f64],
}

impl WithSimd for Tiles<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if self.plane {
            self.evaluate::<S, PlaneLanes<S>>(simd);
        } else {
            self.evaluate::<S, TensorLanes<S>>(simd);
        }
    }
}

impl Tiles<'_> {
    #[inline(always)]
    fn evaluate<S: Simd, T: LaneTensor<S>>(self, simd: S) {
        let (mut gradient, mut cofactor) = (TensorTile::ZERO, TensorTile::ZERO);
        let mut bound = [0.0; TILE];
        for start in (0..self.bounds.len()).step_by(TILE) {
            let range = start..start + TILE;
            let deformation = self.deformation.of(range.clone());
            T::read(&mut gradient, deformation.gradient);
            let integrated = !deformation.cofactor.is_empty();
            if integrated {
                T::read(&mut cofactor, deformation.cofactor);
            }
            for pack in 0..TILE / S::F64_LANES {
                let f = T::load(simd, &gradient, pack);
                let h = if integrated {
                    T::load(simd, &cofactor, pack)
                } else {
                    f.cofactor()
                };
                of(&f, &h).store(&mut bound, pack);
            }
            self.bounds[range].copy_from_slice(&bound);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;
    use jstsph_tensor::{Mat3, cofactor, largest_eigenvalue};

    #[test]
    fn the_bound_is_above_the_value_and_near_it_for_one_compressed_direction() {
        let mut random = Random(29);
        let mut gradients: Vec<Mat3> = (0..TILE + 9)
            .map(|_| Mat3::identity() + random.tensor() * 0.3)
            .collect();
        let squeezed = Mat3::from_diagonal(&jstsph_tensor::Vec3::new(1.0, 0.5, 1.0));
        gradients[3] = squeezed;
        gradients[TILE + 3] = squeezed;
        let cofactors: Vec<Mat3> = gradients.iter().map(cofactor).collect();
        let deformation = Deformation {
            gradient: &gradients,
            cofactor: &[],
        };
        let with_cofactors = Deformation {
            cofactor: &cofactors,
            ..deformation
        };
        let mut bounds = vec![0.0; gradients.len()];
        evaluate(false, with_cofactors, &mut bounds);
        let mut without = bounds.clone();
        evaluate(false, deformation, &mut without);
        assert_eq!(bounds, without);
        for q in 0..gradients.len() {
            let value = largest_eigenvalue(&inverse_cauchy_green(&gradients[q], &cofactors[q]));
            assert!(bounds[q] * (1.0 + 1e-9) >= value && bounds[q] < 2.0 * value);
        }
        assert!((bounds[3] / 4.0 - 1.0).abs() < 1e-14);
        assert!((bounds[TILE + 3] / 4.0 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn plane_strain_has_the_bits_of_general_strain() {
        let mut random = Random(31);
        let gradients: Vec<Mat3> = (0..TILE)
            .map(|_| {
                let f = Mat3::identity() + random.tensor() * 0.3;
                Mat3::new(f.m11, f.m12, 0.0, f.m21, f.m22, 0.0, 0.0, 0.0, 1.0)
            })
            .collect();
        let deformation = Deformation {
            gradient: &gradients,
            cofactor: &[],
        };
        let (mut plane, mut general) = ([0.0; TILE], [0.0; TILE]);
        evaluate(true, deformation, &mut plane);
        evaluate(false, deformation, &mut general);
        assert_eq!(plane, general);
    }
}
