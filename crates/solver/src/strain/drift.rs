//! F, H and the change of volume of points over one step with constant G: point by point, and the
//! same for many points at once.

use jstsph_tensor::lanes::{
    LaneTensor, PlaneLanes, Simd, TILE, TensorLanes, TensorTile, WithSimd, vectorised,
};
use jstsph_tensor::{Mat3, double_dot, tensor_cross};

/// A step of the leapfrog.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drift {
    /// Whether the change of volume is that of ln J, which bonds have, or that of J.
    pub(super) bonds: bool,
    /// Whether nothing happens out of the plane.
    pub(super) plane: bool,
    /// s.
    pub(super) dt: f64,
}

impl Drift {
    /// Advances the points, tile by tile and the rest one by one.
    pub(super) fn advance(&self, g: &[Mat3], f: &mut [Mat3], h: &mut [Mat3], change: &mut [f64]) {
        let tiled = g.len() - g.len() % TILE;
        vectorised(Tiles {
            step: *self,
            g: &g[..tiled],
            f: &mut f[..tiled],
            h: &mut h[..tiled],
            change: &mut change[..tiled],
        });
        for q in tiled..g.len() {
            change[q] = self.advance_point(&g[q], &mut f[q], &mut h[q]);
        }
    }

    /// Advances F and H of one point and returns its change of volume.
    fn advance_point(&self, g: &Mat3, f: &mut Mat3, h: &mut Mat3) -> f64 {
        let dt = self.dt;
        let start = *h;
        let quarter = *f + g * (0.25 * dt);
        let half = *f + g * (0.5 * dt);
        let middle = start + tensor_cross(&quarter, g) * (0.5 * dt);
        let end = start + tensor_cross(&half, g) * dt;
        *f += g * dt;
        *h = end;
        if self.bonds {
            // tr(G F⁻¹) = H : G / det F with det F = ⅓ H : F.
            3.0 * dt * double_dot(&middle, g) / double_dot(&middle, &half)
        } else {
            let simpson = start + middle * 4.0 + end;
            dt / 6.0 * double_dot(&simpson, g)
        }
    }
}

/// Whole tiles of points.
struct Tiles<'a> {
    step: Drift,
    g: &'a [Mat3],
    f: &'a mut [Mat3],
    h: &'a mut [Mat3],
    change: &'a mut [f64],
}

impl WithSimd for Tiles<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if self.step.plane {
            self.advance::<S, PlaneLanes<S>>(simd);
        } else {
            self.advance::<S, TensorLanes<S>>(simd);
        }
    }
}

impl Tiles<'_> {
    /// The formulas of `advance_point`, in the same order.
    #[inline(always)]
    fn advance<S: Simd, T: LaneTensor<S>>(self, simd: S) {
        let Drift { bonds, dt, .. } = self.step;
        let (mut g, mut f, mut h) = (TensorTile::ZERO, TensorTile::ZERO, TensorTile::ZERO);
        let mut change = [0.0; TILE];
        for start in (0..self.g.len()).step_by(TILE) {
            let range = start..start + TILE;
            T::read(&mut g, &self.g[range.clone()]);
            T::read(&mut f, &self.f[range.clone()]);
            T::read(&mut h, &self.h[range.clone()]);
            for pack in 0..TILE / S::F64_LANES {
                let rate = T::load(simd, &g, pack);
                let begin = T::load(simd, &f, pack);
                let start = T::load(simd, &h, pack);
                let quarter = begin.plus(&rate, 0.25 * dt);
                let half = begin.plus(&rate, 0.5 * dt);
                let middle = start.plus(&quarter.cross(&rate), 0.5 * dt);
                let end = start.plus(&half.cross(&rate), dt);
                begin.plus(&rate, dt).store(&mut f, pack);
                end.store(&mut h, pack);
                let grown = if bonds {
                    (middle.double_dot(&rate) * (3.0 * dt)).over(middle.double_dot(&half))
                } else {
                    let simpson = start.plus(&middle, 4.0).plus(&end, 1.0);
                    simpson.double_dot(&rate) * (dt / 6.0)
                };
                grown.store(&mut change, pack);
            }
            T::write(&f, &mut self.f[range.clone()]);
            T::write(&h, &mut self.h[range.clone()]);
            self.change[range].copy_from_slice(&change);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    #[test]
    fn many_points_at_once_have_the_bits_of_single_points() {
        let mut random = Random(11);
        let count = 3 * TILE + 5;
        let mut tensors = |size: f64, mean: Mat3, plane: bool| -> Vec<Mat3> {
            let kept = |t: Mat3| {
                Mat3::from_fn(|r, c| {
                    if plane && (r == 2) != (c == 2) {
                        0.0
                    } else {
                        t[(r, c)]
                    }
                })
            };
            (0..count)
                .map(|_| kept(mean + random.tensor() * size))
                .collect()
        };
        for (bonds, plane) in [(true, false), (false, false), (true, true), (false, true)] {
            let g = tensors(1e4, Mat3::zeros(), plane);
            let f = tensors(0.3, Mat3::identity(), plane);
            let h = tensors(0.3, Mat3::identity(), plane);
            let step = Drift {
                bonds,
                plane,
                dt: 1e-5,
            };
            let (mut many_f, mut many_h, mut change) = (f.clone(), h.clone(), vec![0.0; count]);
            step.advance(&g, &mut many_f, &mut many_h, &mut change);
            for q in 0..count {
                let (mut one_f, mut one_h) = (f[q], h[q]);
                let grown = step.advance_point(&g[q], &mut one_f, &mut one_h);
                assert_eq!((many_f[q], many_h[q]), (one_f, one_h), "point {q}");
                assert_eq!(change[q], grown, "point {q}");
            }
        }
    }
}
