//! Elastic energy.

use std::ops::Range;

use jstsph_material::{Block, BlockReader, KinematicsTile, Material, MaterialBlock};
use jstsph_tensor::lanes::TILE;

use super::tile::read;
use super::{Points, points_of};
use crate::parallel;
use crate::reference::Reference;
use crate::state::State;
use crate::strain::Strains;

/// Elastic energy of one body: Σ V_q Ψ' at its points and Σ V_a U(J) at its particles, J.
struct ElasticEnergy<'a> {
    points: Points<'a>,
    particle_volume: &'a [f64],
}

impl BlockReader for ElasticEnergy<'_> {
    type Output = f64;
    fn visit<M: Material>(&mut self, block: &Block<M>) -> f64 {
        let points = self.points;
        let count = points.volume.len();
        let at_points = parallel::sum(count.div_ceil(TILE), 0.0, |tile| {
            let range = tile * TILE..count.min((tile + 1) * TILE);
            points.energy(&block.model, range, &block.committed)
        });
        if points.without_jacobian() {
            return at_points;
        }
        at_points
            + parallel::sum(self.particle_volume.len(), 0.0, |a| {
                self.particle_volume[a]
                    * block
                        .model
                        .volumetric_energy(points.jacobian[a], points.temperature[a])
            })
    }
}

impl Points<'_> {
    /// Σ V_q Ψ' of a tile of points, with U where J is det F.
    fn energy<M: Material>(&self, model: &M, range: Range<usize>, committed: &[M::History]) -> f64 {
        let mut energies = [0.0; TILE];
        if !self.tile_energies(model, range.clone(), committed, &mut energies) {
            for (energy, q) in energies.iter_mut().zip(range.clone()) {
                *energy = model.point_energy(&self.kinematics(q), &committed[q]);
            }
        }
        if self.without_jacobian() {
            for (energy, q) in energies.iter_mut().zip(range.clone()) {
                *energy += model.volumetric_energy(self.jacobian(q), self.temperature(q));
            }
        }
        let scaled = self.volume[range].iter().zip(energies);
        scaled.map(|(volume, energy)| volume * energy).sum()
    }

    /// Ψ' of the points of a whole tile at once; false if there are fewer or the model declines.
    fn tile_energies<M: Material>(
        &self,
        model: &M,
        range: Range<usize>,
        committed: &[M::History],
        energies: &mut [f64; TILE],
    ) -> bool {
        if range.len() < TILE {
            return false;
        }
        let mut now = KinematicsTile {
            plane: self.plane,
            ..KinematicsTile::new(self.dt)
        };
        let gradients = &self.deformation.gradient[range.clone()];
        read(&mut now.deformation_gradient, gradients, self.plane);
        for (temperature, q) in now.temperature.iter_mut().zip(range.clone()) {
            *temperature = self.temperature(q);
        }
        model.point_energies_tile(&now, &committed[range], energies)
    }
}

/// Elastic energy of all bodies with the committed history, J; with bonds `[eq:bond-energy]`.
pub(crate) fn elastic_energy(
    strains: Strains,
    reference: &Reference,
    state: &State,
    materials: &[MaterialBlock],
) -> f64 {
    reference
        .bodies
        .iter()
        .zip(materials)
        .map(|(body, material)| {
            material.visit_ref(&mut ElasticEnergy {
                points: points_of(strains, reference, body, state, 0.0),
                particle_volume: &reference.volume[body.particles.clone()],
            })
        })
        .sum()
}
