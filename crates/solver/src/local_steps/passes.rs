//! The passes of the parts of a step.

use jstsph_tensor::{Mat3, Vec3};

use super::split::SlowStress;
use super::{Levels, LocalSteps, Part};
use crate::books::Impulse;
use crate::constraint::Stage;
use crate::leapfrog::{Kick, Push};
use crate::profile::Phase;
use crate::simulation::Simulation;
use crate::{SolverError, force, parallel, strain, stress};

/// One over the steps of a level within one of level 0.
pub(super) fn share(level: u8) -> f64 {
    1.0 / f64::from(1u32 << level)
}

/// A stretch of time, s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) start: f64,
    pub(super) length: f64,
}

impl Span {
    fn halves(self) -> [Self; 2] {
        let length = 0.5 * self.length;
        let middle = self.start + length;
        [self.start, middle].map(|start| Self { start, length })
    }
}

impl LocalSteps {
    /// Everything from a level on over a step of that level: two steps of the next level, then what is
    /// of this one. Stresses are those of the end.
    pub(super) fn advance(
        &mut self,
        simulation: &mut Simulation,
        level: u8,
        span: Span,
    ) -> Result<(), SolverError> {
        if level < self.choice.finest() {
            self.clear(simulation, level);
            let [first, second] = span.halves();
            self.advance(simulation, level + 1, first)?;
            self.act(simulation, level + 1, second);
            self.advance(simulation, level + 1, second)?;
        } else {
            simulation.move_obstacles(span.start, span.length);
        }
        self.move_particles(simulation, level, span.length);
        simulation.finished(Phase::Gradient);
        self.drift(simulation, level, span.length);
        simulation.finished(Phase::Strain);
        self.evaluate_stress(simulation, level, span.length)?;
        simulation.finished(Phase::Stress);
        Ok(())
    }

    /// Between two steps of a level: history, forces and kick from that level on.
    fn act(&mut self, simulation: &mut Simulation, level: u8, next: Span) {
        self.commit(simulation, level);
        self.weigh_stress(simulation, level);
        simulation.finished(Phase::Stress);
        self.fine_force(simulation, level);
        simulation.finished(Phase::Force);
        self.kick_between(simulation, level, next);
        simulation.finished(Phase::Constraint);
    }

    /// Before the steps of finer levels: their sums over this step, and the stress of this level, which
    /// does not act between them.
    fn clear(&mut self, simulation: &Simulation, level: u8) {
        let (own, finer) = (Levels::only(level), Levels::from(level + 1));
        let sums = &mut self.sums[usize::from(level)];
        for (body, groups) in simulation.reference.bodies.iter().zip(&self.groups) {
            let momentum = &mut sums.momentum[body.particles.clone()];
            let zero = |_, run: &mut [Vec3]| run.fill(Vec3::zeros());
            groups.moving.for_each_run(finer, momentum, zero);
            let change = &mut sums.volume_change[body.points.clone()];
            let zero = |_, run: &mut [f64]| run.fill(0.0);
            groups.points.for_each_run(finer, change, zero);
            if level > 0 {
                let stress = &mut self.fine_stress[body.points.clone()];
                let zero = |_, run: &mut [Mat3]| run.fill(Mat3::zeros());
                groups.points.for_each_run(own, stress, zero);
            }
        }
    }

    /// T of the weighted stress, of the particles that move with a level or a finer one.
    pub(super) fn fine_force(&mut self, simulation: &Simulation, level: u8) {
        let reference = &simulation.reference;
        let levels = Levels::from(level);
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let stress = &self.fine_stress[body.points.clone()];
            let volume = &reference.volume[body.particles.clone()];
            let force = &mut self.fine_force[body.particles.clone()];
            groups.moving.for_each_run(levels, force, |first, force| {
                force::divergences_of_run(body, first, stress, &|a| volume[a], force);
            });
        }
    }

    /// The kick between two steps of a level, of which `next` is the second.
    fn kick_between(&self, simulation: &mut Simulation, level: u8, next: Span) {
        let Simulation {
            reference,
            state,
            ledger,
            prescribed,
            obstacles,
            ..
        } = simulation;
        // Weights of the stress are those of level 0.
        let duration = next.length / share(level);
        for own in level..=self.choice.finest() {
            let travel = duration * share(own);
            let push = Push {
                kick: Kick::Full,
                reference,
                prescribed,
                middle: next.start + 0.5 * travel,
                obstacles,
                travel: &obstacles.travel(next.start, travel, Stage::Whole),
            };
            self.push(own, push, state, ledger, |a, p| {
                *p -= self.fine_force[a] * duration;
                Impulse::default()
            });
        }
    }

    /// x of the particles that move with a level, and the padded momenta: means over its step.
    fn move_particles(&mut self, simulation: &mut Simulation, level: u8, dt: f64) {
        let Simulation {
            reference,
            state,
            work,
            ..
        } = simulation;
        let (own, finer) = (Levels::only(level), Levels::from(level + 1));
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let range = body.particles.clone();
            let momentum = &state.momentum[range.clone()];
            let per_momentum = dt / body.density;
            let position = &mut state.position[range.clone()];
            groups
                .moving
                .for_each_run(own, position, |first, position| {
                    for (x, p) in position.iter_mut().zip(&momentum[first..]) {
                        *x += p * per_momentum;
                    }
                });
            for (coarser, sums) in (0..level).zip(&mut self.sums) {
                let weight = share(level - coarser);
                let mean = &mut sums.momentum[range.clone()];
                groups.moving.for_each_run(own, mean, |first, mean| {
                    for (mean, p) in mean.iter_mut().zip(&momentum[first..]) {
                        *mean += p * weight;
                    }
                });
            }
            let mean = &self.sums[usize::from(level)].momentum[range.clone()];
            for (levels, momentum) in [(own, momentum), (finer, mean)] {
                let padded = &mut work.padded_momentum[range.clone()];
                groups.moving.for_each_run(levels, padded, |first, padded| {
                    for (padded, p) in padded.iter_mut().zip(&momentum[first..]) {
                        *padded = strain::padded(p);
                    }
                });
            }
        }
    }

    /// F, H of the points of a level and J of its particles.
    fn drift(&mut self, simulation: &mut Simulation, level: u8, dt: f64) {
        let Simulation {
            reference,
            state,
            work,
            ..
        } = simulation;
        let part = (&self.groups[..], level);
        strain::drift_part(reference, part, state, work, dt);
        let (own, finer) = (Levels::only(level), Levels::from(level + 1));
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let points = body.points.clone();
            let change = &mut work.volume_change[points.clone()];
            for sums in &mut self.sums[..usize::from(level)] {
                let total = &mut sums.volume_change[points.clone()];
                groups.points.for_each_run(own, total, |first, total| {
                    for (total, change) in total.iter_mut().zip(&change[first..]) {
                        *total += change;
                    }
                });
            }
            let total = &self.sums[usize::from(level)].volume_change[points];
            groups.points.for_each_run(finer, change, |first, change| {
                change.copy_from_slice(&total[first..first + change.len()]);
            });
        }
        strain::grow_part(reference, part, &mut state.jacobian, &work.volume_change);
    }

    /// τ_vol of the particles of a level and V P of its points, without the pressures of coarser ones.
    fn evaluate_stress(
        &mut self,
        simulation: &mut Simulation,
        level: u8,
        dt: f64,
    ) -> Result<(), SolverError> {
        let strains = simulation.strains();
        let work = &mut simulation.work;
        let out = if level == 0 {
            (&mut work.volumetric_stress[..], &mut work.scaled_stress[..])
        } else {
            let pressure = &mut self.fine_pressure[usize::from(level) - 1];
            (&mut pressure[..], &mut self.fine_stress[..])
        };
        stress::evaluate_part(
            (strains, dt),
            (&simulation.reference, &simulation.state),
            (&self.groups, level),
            &mut simulation.materials,
            out,
            &mut work.plastic_work,
        )
        .map_err(|failure| simulation.constitutive(failure))
    }

    /// The line where the history from a level on moves between two of its steps.
    fn commit(&self, simulation: &mut Simulation, level: u8) {
        let Simulation {
            reference,
            materials,
            work,
            ledger,
            ..
        } = simulation;
        let levels = Levels::from(level);
        let bodies = reference.bodies.iter().zip(materials).zip(&self.groups);
        for ((body, material), groups) in bodies {
            let points = body.points.clone();
            for run in groups.points.runs(0..points.len(), levels) {
                material.commit_points(run);
            }
            let plastic_work = &work.plastic_work[points.clone()];
            let total = &mut ledger.plastic_dissipation[points];
            groups.points.for_each_run(levels, total, |first, total| {
                for (total, work) in total.iter_mut().zip(&plastic_work[first..]) {
                    *total += work;
                }
            });
        }
    }
}

// Which parts of the stress act when.
impl LocalSteps {
    /// The stresses of the points from a level on that act at the end of a step of that level, with
    /// weights as if they acted over a step of level 0.
    fn weigh_stress(&mut self, simulation: &Simulation, level: u8) {
        let (reference, state) = (&simulation.reference, &simulation.state);
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let pressure = |a: usize| match groups.jacobian[a] {
                own if own < level => 0.0,
                own => {
                    let pressure = &self.fine_pressure[usize::from(own) - 1];
                    pressure[body.particles.start + a] * share(own)
                }
            };
            let slow = SlowStress::new(reference, state, (body, groups));
            let stress = &mut self.fine_stress[body.points.clone()];
            let levels = Levels::from(level);
            groups.points.for_each_run(levels, stress, |first, stress| {
                for (k, stress) in stress.iter_mut().enumerate() {
                    let q = first + k;
                    *stress *= share(groups.points.level(q));
                    if let Some(slow) = slow.of(q, pressure) {
                        *stress += slow;
                    }
                }
            });
        }
    }

    /// At the end of a step: τ_vol of the particles and V P of the fine points, and what of the latter
    /// acts in finer steps.
    pub(super) fn join_stress(&mut self, simulation: &mut Simulation) {
        let Simulation {
            reference,
            state,
            work,
            ..
        } = simulation;
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let particles = body.particles.clone();
            let pressure = &mut work.volumetric_stress[particles.clone()];
            for (level, own) in (1..=self.choice.finest()).zip(&self.fine_pressure) {
                let own = &own[particles.clone()];
                let part = Part { groups, level };
                part.for_each_jacobian(pressure, |a, pressure| *pressure = own[a]);
            }
            let pressure = |a: usize| pressure[a];
            let weighted = |a: usize| pressure(a) * (1.0 - share(groups.jacobian[a]));
            let slow = SlowStress::new(reference, state, (body, groups));
            let fine_stress = &mut self.fine_stress[body.points.clone()];
            let stress = &mut work.scaled_stress[body.points.clone()];
            let fine = Levels::from(1);
            groups.points.for_each_run(fine, stress, |first, stress| {
                for (k, stress) in stress.iter_mut().enumerate() {
                    *stress = fine_stress[first + k];
                    if let Some(slow) = slow.of(first + k, pressure) {
                        *stress += slow;
                    }
                }
            });
            groups
                .points
                .for_each_run(fine, fine_stress, |first, stress| {
                    for (k, stress) in stress.iter_mut().enumerate() {
                        let q = first + k;
                        *stress *= 1.0 - share(groups.points.level(q));
                        if let Some(slow) = slow.of(q, weighted) {
                            *stress += slow;
                        }
                    }
                });
        }
    }

    /// What [`join_stress`](Self::join_stress) leaves, from the present pressures and stresses after the
    /// levels have changed.
    pub(super) fn split_stress(&mut self, simulation: &Simulation) {
        let Simulation {
            reference,
            state,
            work,
            ..
        } = simulation;
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let particles = body.particles.clone();
            let pressure = &work.volumetric_stress[particles.clone()];
            for (level, own) in (1u8..).zip(&mut self.fine_pressure) {
                parallel::fill(&mut own[particles.clone()], |a| {
                    if groups.jacobian[a] == level {
                        pressure[a]
                    } else {
                        0.0
                    }
                });
            }
            let slow = SlowStress::new(reference, state, (body, groups));
            let stress = &work.scaled_stress[body.points.clone()];
            parallel::fill(&mut self.fine_stress[body.points.clone()], |q| {
                let level = groups.points.level(q);
                let own = 1.0 - share(level);
                // What acts less often than the rest of the point.
                let less = |a: usize| pressure[a] * (own - (1.0 - share(groups.jacobian[a])));
                let weighted = stress[q] * own;
                slow.of(q, less).map_or(weighted, |slow| weighted - slow)
            });
        }
    }
}
