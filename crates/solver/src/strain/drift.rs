//! F and the change of volume of points over one step with constant G: point by point, and the same for
//! many points at once.

use jstsph_sph::GradientOperator;
use jstsph_tensor::lanes::{
    LaneTensor, PlaneLanes, Simd, TILE, TensorLanes, TensorTile, WithSimd, vectorised,
};
use jstsph_tensor::{Mat3, cofactor, double_dot};

use crate::lines::LineFields;
use crate::reference::BodyReference;
use crate::state::Deformation;
use crate::time_step::bound;

/// The gradient of a field over the particles of a body, times a factor.
#[derive(Clone, Copy)]
pub(super) struct GradientOf<'a> {
    operator: &'a GradientOperator,
    /// With the fourth numbers that vector loads want.
    field: &'a [[f64; 4]],
    factor: f64,
}

impl<'a> GradientOf<'a> {
    pub(super) fn new(body: &'a BodyReference, field: &'a [[f64; 4]], factor: f64) -> Self {
        Self {
            operator: &body.gradient,
            field,
            factor,
        }
    }

    /// G by the padded momenta of all particles.
    pub(super) fn velocity(body: &'a BodyReference, padded_momentum: &'a [[f64; 4]]) -> Self {
        let field = &padded_momentum[body.particles.clone()];
        Self::new(body, field, 1.0 / body.density)
    }

    /// At the points from `first` on, as many as there is room for.
    pub(super) fn read(&self, first: usize, out: &mut [Mat3]) {
        self.operator
            .scaled_gradients(first, self.field, self.factor, out);
    }

    /// At one point.
    pub(super) fn at(&self, point: usize) -> Mat3 {
        let mut gradient = [Mat3::zeros()];
        self.read(point, &mut gradient);
        gradient[0]
    }
}

/// The velocity gradients of the points of a body.
#[derive(Clone, Copy)]
pub(super) enum Rates<'a> {
    /// They have been evaluated before.
    Kept(&'a [Mat3]),
    /// They are worked out row by row.
    Rows(GradientOf<'a>),
    /// They have been evaluated in the order of the lines of the body, but for a few.
    Lines {
        slots: &'a [u32],
        gradients: &'a LineFields,
        others: GradientOf<'a>,
    },
}

impl<'a> Rates<'a> {
    /// G of all points of a body by the padded momenta of all particles.
    pub(super) fn of(
        body: &'a BodyReference,
        padded_momentum: &'a [[f64; 4]],
        fields: &'a mut LineFields,
    ) -> Self {
        let others = GradientOf::velocity(body, padded_momentum);
        let Some(lines) = &body.lines else {
            return Self::Rows(others);
        };
        fields.gradients(lines, others.field, others.factor);
        Self::Lines {
            slots: lines.points().slots(),
            gradients: fields,
            others,
        }
    }

    /// The tile of those from `first` on; `buffer` may be used.
    fn read_tile(&self, (first, plane): (usize, bool), buffer: &mut [Mat3], tile: &mut TensorTile) {
        if let Self::Lines {
            slots,
            gradients,
            others,
        } = *self
        {
            let slots = &slots[first..first + TILE];
            gradients.read_tile(slots, tile, |i| others.at(first + i));
            return;
        }
        self.read(first, buffer);
        if plane {
            tile.read_plane(buffer);
        } else {
            tile.read(buffer);
        }
    }

    /// Those from `first` on, as many as there is room for.
    fn read(&self, first: usize, out: &mut [Mat3]) {
        match *self {
            Self::Kept(gradients) => out.copy_from_slice(&gradients[first..first + out.len()]),
            Self::Rows(rows) => rows.read(first, out),
            Self::Lines {
                slots,
                gradients,
                others,
            } => {
                for (i, out) in out.iter_mut().enumerate() {
                    let q = first + i;
                    *out = gradients.tensor(slots[q], || others.at(q));
                }
            }
        }
    }
}

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
    /// Advances F of the points of a body from `first` on, tile by tile, with their changes of volume
    /// and, for every tile, a bound of its 1/λ².
    pub(super) fn advance(
        &self,
        rates: &Rates<'_>,
        first: usize,
        f: &mut [Mat3],
        change: &mut [f64],
        bounds: &mut [f64],
    ) {
        let mut buffer = [Mat3::zeros(); TILE];
        let mut tensors = Tensors {
            g: TensorTile::ZERO,
            f: TensorTile::ZERO,
        };
        let tiles = f.chunks_mut(TILE).zip(change.chunks_mut(TILE)).zip(bounds);
        for (tile, ((f, change), bound)) in tiles.enumerate() {
            let first = first + tile * TILE;
            *bound = if f.len() < TILE {
                let g = &mut buffer[..f.len()];
                rates.read(first, g);
                self.advance_points(g, f, change)
            } else {
                rates.read_tile((first, self.plane), &mut buffer, &mut tensors.g);
                vectorised(Tile {
                    step: *self,
                    tensors: &mut tensors,
                    f,
                    change,
                })
            };
        }
    }

    /// Less than a tile.
    fn advance_points(&self, g: &[Mat3], f: &mut [Mat3], change: &mut [f64]) -> f64 {
        for ((g, f), change) in g.iter().zip(&mut *f).zip(change) {
            *change = self.advance_point(g, f);
        }
        let deformation = Deformation {
            gradient: f,
            cofactor: &[],
        };
        let mut bounds = [0.0; TILE];
        let bounds = &mut bounds[..f.len()];
        bound::evaluate(self.plane, deformation, bounds);
        bound::largest(bounds)
    }

    /// Advances F of one point and returns its change of volume.
    fn advance_point(&self, g: &Mat3, f: &mut Mat3) -> f64 {
        let dt = self.dt;
        let begin = *f;
        *f += g * dt;
        if self.bonds {
            // tr(G F⁻¹) = H : G / det F with det F = ⅓ H : F.
            let half = begin + g * (0.5 * dt);
            let middle = cofactor(&half);
            3.0 * dt * double_dot(&middle, g) / double_dot(&middle, &half)
        } else {
            (double_dot(&cofactor(f), f) - double_dot(&cofactor(&begin), &begin)) * (1.0 / 3.0)
        }
    }
}

struct Tensors {
    g: TensorTile,
    f: TensorTile,
}

/// A whole tile of points, whose G have been read.
struct Tile<'a> {
    step: Drift,
    tensors: &'a mut Tensors,
    f: &'a mut [Mat3],
    change: &'a mut [f64],
}

impl WithSimd for Tile<'_> {
    /// The bound of 1/λ².
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        if self.step.plane {
            self.advance::<S, PlaneLanes<S>>(simd)
        } else {
            self.advance::<S, TensorLanes<S>>(simd)
        }
    }
}

impl Tile<'_> {
    /// The formulas of `advance_point`, in the same order.
    #[inline(always)]
    fn advance<S: Simd, T: LaneTensor<S>>(self, simd: S) -> f64 {
        let Drift { bonds, dt, .. } = self.step;
        let Tensors { g, f } = self.tensors;
        let (mut change, mut bounds) = ([0.0; TILE], [0.0; TILE]);
        T::read(f, self.f);
        for pack in 0..TILE / S::F64_LANES {
            let rate = T::load(simd, g, pack);
            let begin = T::load(simd, f, pack);
            let end = begin.plus(&rate, dt);
            end.store(f, pack);
            let cofactor = end.cofactor();
            let grown = if bonds {
                let half = begin.plus(&rate, 0.5 * dt);
                let middle = half.cofactor();
                (middle.double_dot(&rate) * (3.0 * dt)).over(middle.double_dot(&half))
            } else {
                let start = begin.cofactor();
                (cofactor.double_dot(&end) - start.double_dot(&begin)) * (1.0 / 3.0)
            };
            grown.store(&mut change, pack);
            bound::of(&end, &cofactor).store(&mut bounds, pack);
        }
        T::write(f, self.f);
        self.change.copy_from_slice(&change);
        bound::largest_of_tile(simd, &bounds)
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
            let step = Drift {
                bonds,
                plane,
                dt: 1e-5,
            };
            let (mut many, mut change, mut bounds) = (f.clone(), vec![0.0; count], [0.0; 4]);
            step.advance(&Rates::Kept(&g), 0, &mut many, &mut change, &mut bounds);
            for q in 0..count {
                let mut one = f[q];
                let grown = step.advance_point(&g[q], &mut one);
                assert_eq!((many[q], change[q]), (one, grown), "point {q}");
            }
            for (tile, bound) in bounds.iter().enumerate() {
                let first = tile * TILE;
                let deformation = Deformation {
                    gradient: &many[first..count.min(first + TILE)],
                    cofactor: &[],
                };
                let mut single = vec![0.0; deformation.gradient.len()];
                bound::evaluate(plane, deformation, &mut single);
                assert_eq!(single.iter().copied().fold(0.0, f64::max), *bound);
            }
        }
    }
}
