//! Classical SPH for solids, with neighbours and kernels in the current configuration: here for
//! comparison with the total Lagrangian formulations (Ba & Gakwaya 2018, Table 2).

use jstsph_sph::Support;
use jstsph_tensor::{Mat3, Vec3};

use crate::model::{Model, Stabilisation};
use crate::parallel;
use crate::reference::{BodyReference, Reference};
use crate::state::{State, Workspace};
use crate::viscosity::PairViscosity;

mod cells;

use cells::CellList;

/// Condition number of the moment matrix beyond which a particle's gradient stays uncorrected: it has
/// too few neighbours left, or all of them in a plane.
const CONDITION_LIMIT: f64 = 1e3;

/// Neighbours and kernel gradients of all bodies at the present positions.
///
/// ```text
///   l_a = Σ_b V_b J_b (v_b − v_a) ⊗ C_a grad W_ab ,   dF_a/dt = l_a F_a ,   ρ_a = ρ/J_a     [eq:eulerian-gradient]
///   a_a = Σ_b m_b (σ_a/ρ_a² + σ_b/ρ_b² − Π_ab) grad W_ab                                  [eq:eulerian-force]
/// ```
///
/// Linear momentum is exact, angular momentum is not. Particles that drift apart lose each other as
/// neighbours: a body in tension breaks where its material does not.
#[derive(Clone, Debug)]
pub(crate) struct CurrentKernels {
    bodies: Vec<BodyKernels>,
    stabilisation: Stabilisation,
}

#[derive(Clone, Debug)]
struct BodyKernels {
    support: Support,
    cells: CellList,
    /// Kernel gradients grad_a W_ab beside the neighbours of the cell list.
    gradients: Vec<Vec3>,
    /// σ J² of the particles, Pa.
    stress: Vec<Mat3>,
}

impl CurrentKernels {
    pub(crate) fn new(model: &Model, reference: &Reference) -> Self {
        Self {
            bodies: reference
                .bodies
                .iter()
                .map(|body| BodyKernels {
                    support: body.support,
                    cells: CellList::new(body.support.radius(), model.dimension.count()),
                    gradients: Vec::new(),
                    stress: vec![Mat3::zeros(); body.particles.len()],
                })
                .collect(),
            stabilisation: model.scheme.stabilisation,
        }
    }

    /// Finds the neighbours at the present positions and writes l F, the material velocity gradient.
    pub(crate) fn velocity_gradient(
        &mut self,
        reference: &Reference,
        state: &State,
        work: &mut Workspace,
    ) {
        for (kernels, body) in self.bodies.iter_mut().zip(&reference.bodies) {
            let range = body.particles.clone();
            let position = &state.position[range.clone()];
            kernels.find_neighbours(position);
            let kernels = &*kernels;
            let (momentum, jacobian) = (
                &state.momentum[range.clone()],
                &state.jacobian[range.clone()],
            );
            let volume = &reference.volume[range];
            let gradients = &state.deformation_gradient[body.points.clone()];
            let inverse_density = 1.0 / body.density;
            parallel::fill(&mut work.velocity_gradient[body.points.clone()], |a| {
                let (mut moment, mut gradient) = (Mat3::zeros(), Mat3::zeros());
                for (b, kernel) in kernels.row(a) {
                    let weighted = kernel * (volume[b] * jacobian[b]);
                    moment += (position[b] - position[a]) * weighted.transpose();
                    gradient += (momentum[b] - momentum[a]) * weighted.transpose();
                }
                let correction = correction(moment, kernels.support.dimension);
                gradient * correction * gradients[a] * inverse_density
            });
        }
    }

    /// Internal force and viscosity from the stress at the present positions.
    pub(crate) fn forces(&mut self, reference: &Reference, state: &State, work: &mut Workspace) {
        for (kernels, body) in self.bodies.iter_mut().zip(&reference.bodies) {
            let range = body.particles.clone();
            let volume = &reference.volume[range.clone()];
            let scaled = &work.scaled_stress[body.points.clone()];
            let gradients = &state.deformation_gradient[body.points.clone()];
            // σ J² = P Fᵀ J.
            parallel::fill(&mut kernels.stress, |a| {
                let f = &gradients[a];
                scaled[a] * f.transpose() * (f.determinant() / volume[a])
            });
            let kernels = &*kernels;
            let stress = &kernels.stress;
            parallel::fill(&mut work.internal_force[range.clone()], |a| {
                kernels.row(a).fold(Vec3::zeros(), |sum, (b, kernel)| {
                    sum - (stress[a] + stress[b]) * kernel * volume[b]
                })
            });
            kernels.add_viscosity(&self.stabilisation, body, reference, state, work);
        }
    }
}

impl BodyKernels {
    fn find_neighbours(&mut self, position: &[Vec3]) {
        self.cells.rebuild(position);
        self.gradients.clear();
        for a in 0..position.len() {
            for &b in self.cells.row(a).1 {
                let offset = position[a] - position[b as usize];
                let slope = self.support.derivative_over_radius(offset.norm());
                self.gradients.push(offset * slope);
            }
        }
    }

    /// Neighbours of a particle and grad_a W_ab.
    fn row(&self, particle: usize) -> impl Iterator<Item = (usize, &Vec3)> {
        let (first, neighbours) = self.cells.row(particle);
        let gradients = &self.gradients[first..first + neighbours.len()];
        neighbours.iter().map(|b| *b as usize).zip(gradients)
    }

    fn add_viscosity(
        &self,
        stabilisation: &Stabilisation,
        body: &BodyReference,
        reference: &Reference,
        state: &State,
        work: &mut Workspace,
    ) {
        let Some(viscosity) = stabilisation.viscosity else {
            return;
        };
        let law = PairViscosity {
            viscosity,
            wave_speed: body.wave_speed,
            smoothing_length: self.support.smoothing_length,
        };
        let range = body.particles.clone();
        let (momentum, position, jacobian) = (
            &state.momentum[range.clone()],
            &state.position[range.clone()],
            &state.jacobian[range.clone()],
        );
        let volume = &reference.volume[range.clone()];
        let inverse_density = 1.0 / body.density;
        parallel::for_each_pair(
            &mut work.dissipation[range.clone()],
            &mut work.viscous_heating[range],
            |a, dissipation, heating| {
                let (mut force, mut power) = (Vec3::zeros(), 0.0);
                for (b, kernel) in self.row(a) {
                    let offset = position[a] - position[b];
                    let velocity = (momentum[a] - momentum[b]) * inverse_density;
                    let approach = velocity.dot(&offset);
                    if approach < 0.0 {
                        let dilation = 0.5 * (jacobian[a] + jacobian[b]);
                        let scale = law.pressure(approach, &offset) * volume[b] * dilation;
                        force -= kernel * scale;
                        power += 0.5 * scale * kernel.dot(&velocity);
                    }
                }
                *dissipation = force * body.density;
                *heating = power * body.density;
            },
        );
    }
}

/// Inverse of the moment matrix, or the identity for a particle whose neighbours do not span space.
fn correction(mut moment: Mat3, dimension: usize) -> Mat3 {
    if dimension == 2 {
        moment.m33 = 1.0;
    }
    // Of unit size with all neighbours present, so that norms measure the condition.
    match moment.try_inverse() {
        Some(inverse) if inverse.norm() * moment.norm() < CONDITION_LIMIT => inverse,
        _ => Mat3::identity(),
    }
}

#[cfg(test)]
mod tests;
