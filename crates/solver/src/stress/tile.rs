//! V P of many points at once, where the model can answer for them together.

use jstsph_material::{KinematicsTile, Material, ResponseTile};
use jstsph_tensor::Mat3;
use jstsph_tensor::lanes::{
    LaneTensor, Lanes, PlaneLanes, Simd, TILE, TensorLanes, TensorTile, WithSimd, load_all,
    vectorised,
};

use super::PointPass;

/// Where the results of a run of points go.
pub(super) struct Output<'a, H> {
    pub(super) scaled_stress: &'a mut [Mat3],
    pub(super) plastic_work: &'a mut [f64],
    pub(super) candidate: &'a mut [H],
}

/// Buffers of one tile.
struct Buffers {
    now: KinematicsTile,
    response: ResponseTile,
    /// H where it is integrated.
    cofactor: TensorTile,
    pressure: [f64; TILE],
    volume: [f64; TILE],
    stress: TensorTile,
}

impl<M: Material> PointPass<'_, M> {
    /// The points from `offset` on, as many as there is room for: tile by tile, and one by one those
    /// that are left over or that the model wants to see alone.
    pub(super) fn evaluate(
        &self,
        offset: usize,
        committed: &[M::History],
        out: Output<'_, M::History>,
    ) {
        let count = out.scaled_stress.len();
        let mut buffers = Buffers {
            now: KinematicsTile {
                plane: self.points.plane,
                ..KinematicsTile::new(self.points.dt)
            },
            response: ResponseTile::ZERO,
            cofactor: TensorTile::ZERO,
            pressure: [0.0; TILE],
            volume: [0.0; TILE],
            stress: TensorTile::ZERO,
        };
        let mut start = 0;
        while start < count {
            let end = (start + TILE).min(count);
            let first = offset + start;
            let candidate = &mut out.candidate[start..end];
            let history = &committed[first..offset + end];
            if end - start == TILE && self.tile(first, history, candidate, &mut buffers) {
                let stress = &mut out.scaled_stress[start..end];
                if self.points.plane {
                    buffers.stress.write_plane(stress);
                } else {
                    buffers.stress.write(stress);
                }
                out.plastic_work[start..end].copy_from_slice(&buffers.response.plastic_work);
            } else {
                for k in 0..end - start {
                    self.evaluate_point(
                        first + k,
                        &history[k],
                        &mut out.scaled_stress[start + k],
                        &mut out.plastic_work[start + k],
                        &mut candidate[k],
                    );
                }
            }
            start = end;
        }
    }

    /// The same formulas as `evaluate_point`, in the same order; false if the model declines.
    fn tile(
        &self,
        first: usize,
        committed: &[M::History],
        candidate: &mut [M::History],
        buffers: &mut Buffers,
    ) -> bool {
        let points = &self.points;
        let range = first..first + TILE;
        let Buffers {
            now,
            response,
            cofactor,
            pressure,
            volume,
            stress,
        } = buffers;
        let deformation = points.deformation.of(range.clone());
        read(
            &mut now.deformation_gradient,
            deformation.gradient,
            points.plane,
        );
        let integrated = !deformation.cofactor.is_empty();
        if integrated {
            read(cofactor, deformation.cofactor, points.plane);
        }
        for i in 0..TILE {
            now.jacobian[i] = points.jacobian(first + i);
            now.temperature[i] = points.temperature(first + i);
        }
        if !self.model.respond_tile(now, committed, candidate, response) {
            return false;
        }
        for i in 0..TILE {
            let (jacobian, temperature) = (now.jacobian[i], now.temperature[i]);
            pressure[i] = self.pressure(first + i, jacobian, temperature, &candidate[i]);
        }
        volume.copy_from_slice(&points.volume[range]);
        vectorised(Piola {
            now,
            response,
            cofactor: integrated.then_some(&*cofactor),
            pressure,
            volume,
            at_particles: points.at_particles(),
            stress,
        });
        true
    }
}

pub(super) fn read(tile: &mut TensorTile, tensors: &[Mat3], plane: bool) {
    if plane {
        tile.read_plane(tensors);
    } else {
        tile.read(tensors);
    }
}

/// V P = (τ' + τ_vol 1) H V/J, `[eq:piola]`.
struct Piola<'a> {
    now: &'a KinematicsTile,
    response: &'a ResponseTile,
    /// H, if it is not cof F.
    cofactor: Option<&'a TensorTile>,
    pressure: &'a [f64; TILE],
    volume: &'a [f64; TILE],
    at_particles: bool,
    stress: &'a mut TensorTile,
}

impl WithSimd for Piola<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if self.now.plane {
            self.evaluate::<S, PlaneLanes<S>>(simd);
        } else {
            self.evaluate::<S, TensorLanes<S>>(simd);
        }
    }
}

impl Piola<'_> {
    #[inline(always)]
    fn evaluate<S: Simd, T: LaneTensor<S>>(self, simd: S) {
        for pack in 0..TILE / S::F64_LANES {
            let f = T::load(simd, &self.now.deformation_gradient, pack);
            let h = match self.cofactor {
                Some(cofactor) => T::load(simd, cofactor, pack),
                None => f.cofactor(),
            };
            let jacobian = if self.at_particles {
                Lanes::load(simd, &self.now.jacobian, pack)
            } else {
                h.double_dot(&f).over(Lanes::splat(simd, 3.0))
            };
            let factor = Lanes::load(simd, self.volume, pack).over(jacobian);
            let pressure = Lanes::load(simd, self.pressure, pack);
            let mut stress = load_all(simd, &self.response.kirchhoff_stress, pack);
            for diagonal in &mut stress[..3] {
                *diagonal = *diagonal + pressure;
            }
            h.times_symmetric(&stress, factor).store(self.stress, pack);
        }
    }
}
