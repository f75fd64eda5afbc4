//! The passes of the parts of a step.

use jstsph_tensor::{Mat3, Vec3};

use super::{Groups, LocalSteps, Part};
use crate::books::Impulse;
use crate::constraint::Stage;
use crate::leapfrog::{Kick, Push};
use crate::profile::Phase;
use crate::reference::{BodyReference, Reference};
use crate::simulation::Simulation;
use crate::state::{Deformation, State};
use crate::{SolverError, parallel, strain, stress};

impl LocalSteps {
    /// The sub-steps of a step of `dt`.
    pub(super) fn make_sub_steps(
        &mut self,
        simulation: &mut Simulation,
        dt: f64,
    ) -> Result<(), SolverError> {
        let ratio = self.choice.ratio();
        let sub_step = dt / f64::from(ratio);
        self.clear(simulation);
        for k in 0..ratio {
            let time = simulation.time + f64::from(k) * sub_step;
            if ratio > 1 {
                if k > 0 {
                    self.fine_force(simulation);
                    simulation.finished(Phase::Force);
                    self.kick_between(simulation, time, sub_step);
                    simulation.finished(Phase::Constraint);
                }
                self.move_fine(simulation, sub_step, 1.0 / f64::from(ratio));
                simulation.finished(Phase::Gradient);
                self.drift_fine(simulation, sub_step);
                simulation.finished(Phase::Strain);
                self.evaluate_fine_stress(simulation, sub_step)?;
                if k + 1 < ratio {
                    self.commit_fine(simulation);
                }
                simulation.finished(Phase::Stress);
            }
            simulation.move_obstacles(time, sub_step);
        }
        Ok(())
    }
}

// Sub-steps.
impl LocalSteps {
    fn clear(&mut self, simulation: &Simulation) {
        for (body, groups) in simulation.reference.bodies.iter().zip(&self.groups) {
            let travel = &mut self.mean_momentum[body.particles.clone()];
            let zero = |_, run: &mut [Vec3]| run.fill(Vec3::zeros());
            groups.moving.for_each_run(true, travel, zero);
            let change = &mut self.volume_change[body.points.clone()];
            groups
                .fine
                .for_each_run(true, change, |_, run| run.fill(0.0));
        }
    }

    /// T of the fine stress, of the particles it acts on.
    pub(super) fn fine_force(&mut self, simulation: &Simulation) {
        let reference = &simulation.reference;
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let stress = &self.fine_stress[body.points.clone()];
            let volume = &reference.volume[body.particles.clone()];
            let force = &mut self.fine_force[body.particles.clone()];
            groups.moving.for_each_run(true, force, |first, force| {
                body.gradient.divergences(first, stress, force);
                for (force, volume) in force.iter_mut().zip(&volume[first..]) {
                    *force /= *volume;
                }
            });
        }
    }

    /// The kick between two sub-steps, at `time`.
    fn kick_between(&self, simulation: &mut Simulation, time: f64, sub_step: f64) {
        let Simulation {
            reference,
            state,
            ledger,
            prescribed,
            obstacles,
            ..
        } = simulation;
        let push = Push {
            kick: Kick::Full,
            reference,
            prescribed,
            middle: time + 0.5 * sub_step,
            obstacles,
            travel: &obstacles.travel(time, sub_step, Stage::Whole),
        };
        self.push(true, push, state, ledger, |a, p| {
            *p -= self.fine_force[a] * sub_step;
            Impulse::default()
        });
    }

    /// x of the moving particles, and their padded momenta; `share` is one over the sub-steps.
    fn move_fine(&mut self, simulation: &mut Simulation, sub_step: f64, share: f64) {
        let Simulation {
            reference,
            state,
            work,
            ..
        } = simulation;
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let range = body.particles.clone();
            let momentum = &state.momentum[range.clone()];
            let per_momentum = sub_step / body.density;
            let out = (
                &mut state.position[range.clone()],
                &mut work.padded_momentum[range.clone()],
                &mut self.mean_momentum[range.clone()],
            );
            groups
                .moving
                .for_each_chunk(true, out, |first, position, padded, mean| {
                    let momentum = &momentum[first..first + mean.len()];
                    for (k, p) in momentum.iter().enumerate() {
                        position[k] += p * per_momentum;
                        padded[k] = strain::padded(p);
                        mean[k] += p * share;
                    }
                });
        }
    }

    /// F of the fine points, J of the particles whose J is fine.
    fn drift_fine(&mut self, simulation: &mut Simulation, sub_step: f64) {
        let Simulation {
            reference,
            state,
            work,
            ..
        } = simulation;
        let fine = (&self.groups[..], true);
        strain::drift_part(reference, fine, state, work, sub_step);
        strain::grow_part(reference, fine, &mut state.jacobian, &work.volume_change);
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let change = &work.volume_change[body.points.clone()];
            let total = &mut self.volume_change[body.points.clone()];
            groups.fine.for_each_run(true, total, |first, total| {
                for (total, change) in total.iter_mut().zip(&change[first..]) {
                    *total += change;
                }
            });
        }
    }

    fn evaluate_fine_stress(
        &mut self,
        simulation: &mut Simulation,
        sub_step: f64,
    ) -> Result<(), SolverError> {
        stress::evaluate_part(
            (simulation.strains(), sub_step),
            (&simulation.reference, &simulation.state),
            (&self.groups, true),
            &mut simulation.materials,
            (&mut self.fine_pressure, &mut self.fine_stress),
            &mut simulation.work.plastic_work,
        )
        .map_err(|failure| simulation.constitutive(failure))
    }

    /// The line where the history of a sub-step moves.
    fn commit_fine(&self, simulation: &mut Simulation) {
        let Simulation {
            reference,
            materials,
            work,
            ledger,
            ..
        } = simulation;
        let bodies = reference.bodies.iter().zip(materials).zip(&self.groups);
        for ((body, material), groups) in bodies {
            let points = body.points.clone();
            for run in groups.fine.runs(0..points.len(), true) {
                material.commit_points(run);
            }
            let plastic_work = &work.plastic_work[points.clone()];
            let total = &mut ledger.plastic_dissipation[points];
            groups.fine.for_each_run(true, total, |first, total| {
                for (total, work) in total.iter_mut().zip(&plastic_work[first..]) {
                    *total += work;
                }
            });
        }
    }
}

// The rest.
impl LocalSteps {
    /// Everything that is not fine over a step of `dt`, and the stresses of all points at its end.
    pub(super) fn advance_rest(
        &mut self,
        simulation: &mut Simulation,
        dt: f64,
    ) -> Result<(), SolverError> {
        self.move_rest(simulation, dt);
        simulation.finished(Phase::Gradient);
        let Simulation {
            reference,
            state,
            work,
            ..
        } = &mut *simulation;
        let rest = (&self.groups[..], false);
        strain::drift_part(reference, rest, state, work, dt);
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let total = &self.volume_change[body.points.clone()];
            let change = &mut work.volume_change[body.points.clone()];
            groups.fine.for_each_run(true, change, |first, change| {
                change.copy_from_slice(&total[first..first + change.len()]);
            });
        }
        strain::grow_part(reference, rest, &mut state.jacobian, &work.volume_change);
        simulation.finished(Phase::Strain);
        let strains = simulation.strains();
        let work = &mut simulation.work;
        stress::evaluate_part(
            (strains, dt),
            (&simulation.reference, &simulation.state),
            rest,
            &mut simulation.materials,
            (&mut work.volumetric_stress, &mut work.scaled_stress),
            &mut work.plastic_work,
        )
        .map_err(|failure| simulation.constitutive(failure))?;
        self.join_stress(simulation);
        simulation.work.stretch_bounds.are_fresh = true;
        Ok(())
    }

    /// x of the other particles; padded momenta, those of the moving particles by their means over the step.
    fn move_rest(&mut self, simulation: &mut Simulation, dt: f64) {
        let Simulation {
            reference,
            state,
            work,
            ..
        } = simulation;
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let range = body.particles.clone();
            let momentum = &state.momentum[range.clone()];
            let per_momentum = dt / body.density;
            let position = &mut state.position[range.clone()];
            groups
                .moving
                .for_each_run(false, position, |first, position| {
                    for (x, p) in position.iter_mut().zip(&momentum[first..]) {
                        *x += p * per_momentum;
                    }
                });
            let mean = &self.mean_momentum[range.clone()];
            for (inside, momentum) in [(true, mean), (false, momentum)] {
                let padded = &mut work.padded_momentum[range.clone()];
                groups.moving.for_each_run(inside, padded, |first, padded| {
                    for (padded, p) in padded.iter_mut().zip(&momentum[first..]) {
                        *padded = strain::padded(p);
                    }
                });
            }
        }
    }

    /// τ_vol of the particles and V P of the fine points, their slow part included.
    fn join_stress(&self, simulation: &mut Simulation) {
        let Simulation {
            reference,
            state,
            work,
            ..
        } = simulation;
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let pressure = &mut work.volumetric_stress[body.particles.clone()];
            let fine_pressure = &self.fine_pressure[body.particles.clone()];
            let part = Part { groups, fine: true };
            part.for_each_jacobian(pressure, |a, pressure| *pressure = fine_pressure[a]);
            let slow = SlowStress::new(reference, state, (body, groups), pressure);
            let fine_stress = &self.fine_stress[body.points.clone()];
            let stress = &mut work.scaled_stress[body.points.clone()];
            groups.fine.for_each_run(true, stress, |first, stress| {
                for (k, stress) in stress.iter_mut().enumerate() {
                    *stress = fine_stress[first + k];
                    if let Some(slow) = slow.of(first + k) {
                        *stress += slow;
                    }
                }
            });
        }
    }

    /// The fine parts of the present pressures and stresses, after the groups have changed.
    pub(super) fn split_stress(&mut self, simulation: &Simulation) {
        let Simulation {
            reference,
            state,
            work,
            ..
        } = simulation;
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let pressure = &work.volumetric_stress[body.particles.clone()];
            let fine_pressure = &mut self.fine_pressure[body.particles.clone()];
            parallel::fill(fine_pressure, |a| {
                if groups.fine_jacobian[a] {
                    pressure[a]
                } else {
                    0.0
                }
            });
            let slow = SlowStress::new(reference, state, (body, groups), pressure);
            let stress = &work.scaled_stress[body.points.clone()];
            parallel::fill(&mut self.fine_stress[body.points.clone()], |q| {
                if groups.fine.contains(q) {
                    slow.of(q).map_or(stress[q], |slow| stress[q] - slow)
                } else {
                    Mat3::zeros()
                }
            });
        }
    }
}

/// The part of V P of fine points that acts in whole steps: the pressure of those ends whose J makes
/// whole steps.
struct SlowStress<'a> {
    body: &'a BodyReference,
    groups: &'a Groups,
    pressure: &'a [f64],
    volume: &'a [f64],
    deformation: Deformation<'a>,
}

impl<'a> SlowStress<'a> {
    fn new(
        reference: &'a Reference,
        state: &'a State,
        (body, groups): (&'a BodyReference, &'a Groups),
        pressure: &'a [f64],
    ) -> Self {
        Self {
            body,
            groups,
            pressure,
            volume: &reference.point_volume[body.points.clone()],
            deformation: state.deformation(body.points.clone()),
        }
    }

    /// V ½ Σ τ_vol H / det F over the slow ends of a point, if it has some.
    fn of(&self, point: usize) -> Option<Mat3> {
        let ends = self.body.ends[point].map(|end| end as usize);
        if ends.iter().all(|a| self.groups.fine_jacobian[*a]) {
            return None;
        }
        let pressures = ends.map(|a| {
            if self.groups.fine_jacobian[a] {
                0.0
            } else {
                self.pressure[a]
            }
        });
        let (cofactor, determinant) = self.deformation.cofactor_and_determinant(point);
        let stress = 0.5 * (pressures[0] + pressures[1]);
        Some(cofactor * (stress * self.volume[point] / determinant))
    }
}
