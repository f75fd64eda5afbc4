//! Upper bounds of 1/λ², for many points at once.

use jstsph_tensor::Mat3;
use jstsph_tensor::lanes::{
    LaneTensor, Lanes, PlaneLanes, Simd, TILE, TensorLanes, TensorTile, WithSimd, times, vectorised,
};

use super::inverse_cauchy_green;

/// Writes, for every point, a bound of the largest principal value of A = F⁻¹ F⁻ᵀ,
///
/// ```text
///   λ_max(A) ≤ ⅓ tr A + √(2/3) |dev A|
/// ```
///
/// sharp where two of the values are equal and the third is larger. Not finite where A is not.
///
/// With `plane`, nothing is out of the plane but the components 33.
pub(super) fn evaluate(plane: bool, gradients: &[Mat3], cofactors: &[Mat3], bounds: &mut [f64]) {
    let tiled = gradients.len() - gradients.len() % TILE;
    vectorised(Tiles {
        plane,
        gradients: &gradients[..tiled],
        cofactors: &cofactors[..tiled],
        bounds: &mut bounds[..tiled],
    });
    for q in tiled..gradients.len() {
        let a = inverse_cauchy_green(&gradients[q], &cofactors[q]);
        let mean = jstsph_tensor::mean_trace(&a);
        let deviator = jstsph_tensor::deviator(&a);
        bounds[q] = mean + (jstsph_tensor::norm_squared(&deviator) * (2.0 / 3.0)).sqrt();
    }
}

/// Whole tiles of points.
struct Tiles<'a> {
    plane: bool,
    gradients: &'a [Mat3],
    cofactors: &'a [Mat3],
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
        for start in (0..self.gradients.len()).step_by(TILE) {
            let range = start..start + TILE;
            T::read(&mut gradient, &self.gradients[range.clone()]);
            T::read(&mut cofactor, &self.cofactors[range.clone()]);
            for pack in 0..TILE / S::F64_LANES {
                let h = T::load(simd, &cofactor, pack);
                let f = T::load(simd, &gradient, pack);
                let determinant = h.double_dot(&f) * (1.0 / 3.0);
                let scale = (determinant * determinant).inverse();
                let [a11, a22, a33, a12, a13, a23] = times(&h.gram(), scale);
                let mean = (a11 + a22 + a33) * (1.0 / 3.0);
                let (d1, d2, d3) = (a11 - mean, a22 - mean, a33 - mean);
                let off: Lanes<S> = a12 * a12 + a13 * a13 + a23 * a23;
                let deviator = d1 * d1 + d2 * d2 + d3 * d3 + off * 2.0;
                (mean + (deviator * (2.0 / 3.0)).sqrt()).store(&mut bound, pack);
            }
            self.bounds[range].copy_from_slice(&bound);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;
    use jstsph_tensor::{cofactor, largest_eigenvalue};

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
        let mut bounds = vec![0.0; gradients.len()];
        evaluate(false, &gradients, &cofactors, &mut bounds);
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
        let cofactors: Vec<Mat3> = gradients.iter().map(cofactor).collect();
        let (mut plane, mut general) = ([0.0; TILE], [0.0; TILE]);
        evaluate(true, &gradients, &cofactors, &mut plane);
        evaluate(false, &gradients, &cofactors, &mut general);
        assert_eq!(plane, general);
    }
}
