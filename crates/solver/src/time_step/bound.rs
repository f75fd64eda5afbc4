//! Upper bounds of 1/λ², for many points at once.

use jstsph_tensor::Mat3;
use jstsph_tensor::lanes::{Lanes, Simd, TILE, TensorTile, WithSimd, vectorised};

use super::inverse_cauchy_green;

/// Writes, for every point, a bound of the largest principal value of A = F⁻¹ F⁻ᵀ,
///
/// ```text
///   λ_max(A) ≤ ⅓ tr A + √(2/3) |dev A|
/// ```
///
/// sharp where two of the values are equal and the third is larger. Not finite where A is not.
pub(super) fn evaluate(gradients: &[Mat3], cofactors: &[Mat3], bounds: &mut [f64]) {
    let tiled = gradients.len() - gradients.len() % TILE;
    let (mut f, mut h) = (TensorTile::ZERO, TensorTile::ZERO);
    for start in (0..tiled).step_by(TILE) {
        let range = start..start + TILE;
        f.read(&gradients[range.clone()]);
        h.read(&cofactors[range.clone()]);
        let mut tile = [0.0; TILE];
        vectorised(Tile {
            gradient: &f,
            cofactor: &h,
            bound: &mut tile,
        });
        bounds[range].copy_from_slice(&tile);
    }
    for q in tiled..gradients.len() {
        let a = inverse_cauchy_green(&gradients[q], &cofactors[q]);
        let mean = jstsph_tensor::mean_trace(&a);
        let deviator = jstsph_tensor::deviator(&a);
        bounds[q] = mean + (jstsph_tensor::norm_squared(&deviator) * (2.0 / 3.0)).sqrt();
    }
}

struct Tile<'a> {
    gradient: &'a TensorTile,
    cofactor: &'a TensorTile,
    bound: &'a mut [f64; TILE],
}

impl WithSimd for Tile<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for pack in 0..TILE / S::F64_LANES {
            let h = self.cofactor.load(simd, pack);
            let f = self.gradient.load(simd, pack);
            let determinant = h.double_dot(&f) * (1.0 / 3.0);
            let scale = (determinant * determinant).inverse();
            let [h11, h21, h31, h12, h22, h32, h13, h23, h33] = h.0;
            let a11 = (h11 * h11 + h21 * h21 + h31 * h31) * scale;
            let a22 = (h12 * h12 + h22 * h22 + h32 * h32) * scale;
            let a33 = (h13 * h13 + h23 * h23 + h33 * h33) * scale;
            let a12 = (h11 * h12 + h21 * h22 + h31 * h32) * scale;
            let a13 = (h11 * h13 + h21 * h23 + h31 * h33) * scale;
            let a23 = (h12 * h13 + h22 * h23 + h32 * h33) * scale;
            let mean = (a11 + a22 + a33) * (1.0 / 3.0);
            let (d1, d2, d3) = (a11 - mean, a22 - mean, a33 - mean);
            let off: Lanes<S> = a12 * a12 + a13 * a13 + a23 * a23;
            let deviator = d1 * d1 + d2 * d2 + d3 * d3 + off * 2.0;
            (mean + (deviator * (2.0 / 3.0)).sqrt()).store(self.bound, pack);
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
        evaluate(&gradients, &cofactors, &mut bounds);
        for q in 0..gradients.len() {
            let value = largest_eigenvalue(&inverse_cauchy_green(&gradients[q], &cofactors[q]));
            assert!(bounds[q] * (1.0 + 1e-9) >= value && bounds[q] < 2.0 * value);
        }
        assert!((bounds[3] / 4.0 - 1.0).abs() < 1e-14);
        assert!((bounds[TILE + 3] / 4.0 - 1.0).abs() < 1e-14);
    }
}
