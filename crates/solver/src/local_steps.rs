//! The leapfrog with local time steps: the most compressed parts of the bodies make several steps
//! within one step of the rest.

use jstsph_tensor::{Mat3, Vec3};

use crate::books::{Impulse, Ledger};
use crate::constraint::Stage;
use crate::leapfrog::{Kick, Push};
use crate::model::Scheme;
use crate::profile::Phase;
use crate::reference::Reference;
use crate::simulation::Simulation;
use crate::state::{State, or_zero};
use crate::{SolverError, force};

use choice::{Choice, stretch_limits};
use passes::{Span, share};

mod choice;
mod groups;
mod passes;
mod split;
#[cfg(test)]
mod tests;

pub(crate) use groups::{Groups, LARGEST_LEVEL, Levels, Part, Tiles};

/// Groups and buffers; allocated once.
#[derive(Clone, Debug)]
pub(crate) struct LocalSteps {
    /// Groups of every body.
    groups: Vec<Groups>,
    choice: Choice,
    /// V P of the points that make sub-steps as it acts in them, zero at the others: between steps of a
    /// level what acts there, at the end of the whole step what has acted before.
    fine_stress: Vec<Mat3>,
    /// For every level from 1 on: τ_vol of the particles whose J has it, zero for the others.
    fine_pressure: Vec<Vec<f64>>,
    /// T of `fine_stress`, of the particles that move in sub-steps.
    fine_force: Vec<Vec3>,
    /// For every level: what finer ones have done in its present step.
    sums: Vec<Sums>,
    /// Momenta of an earlier kick, for the books.
    momentum_before: Vec<Vec3>,
}

/// What the finer levels have done in a step of a level.
#[derive(Clone, Debug)]
struct Sums {
    /// Mean momenta of the particles that move with finer levels.
    momentum: Vec<Vec3>,
    /// Changes of volume of the finer points.
    volume_change: Vec<f64>,
}

impl LocalSteps {
    /// For schemes that ask for it.
    pub(crate) fn new(scheme: &Scheme, reference: &Reference) -> Option<Box<Self>> {
        let (particles, points) = (reference.position.len(), reference.point_volume.len());
        (scheme.substeps > 1).then(|| {
            let levels = scheme.substeps.ilog2() as usize;
            let sums = Sums {
                momentum: vec![Vec3::zeros(); particles],
                volume_change: vec![0.0; points],
            };
            Box::new(Self {
                groups: reference.bodies.iter().map(Groups::new).collect(),
                choice: Choice::new(scheme, reference),
                fine_stress: vec![Mat3::zeros(); points],
                fine_pressure: vec![vec![0.0; particles]; levels],
                fine_force: vec![Vec3::zeros(); particles],
                sums: vec![sums; levels + 1],
                momentum_before: vec![Vec3::zeros(); particles],
            })
        })
    }

    /// Chooses the groups anew at the present state.
    fn regroup(&mut self, simulation: &Simulation) {
        self.choice.renew(simulation, &mut self.groups);
        self.split_stress(simulation);
    }

    /// The step that follows a choice of groups.
    fn next_time_step(
        &mut self,
        simulation: &mut Simulation,
        end: f64,
    ) -> Result<f64, SolverError> {
        let now = stretch_limits(simulation, &self.groups);
        self.choice.next_time_step(simulation, &now, end)
    }
}

/// One step, `[eq:local-step]`: a step Δ of level 0, where a step of level k is
///
/// ```text
///   two steps of level k + 1; between them, of the levels > k: commit history,
///       p += δ R of their stresses, each with the δ of its level; prescribed velocities, contact
///   x, F, H, J of what is of level k, with the mean of the momenta over the step; stress
/// ```
///
/// After it history is committed, and all stresses act, each with the δ of its level.
pub(crate) fn step(
    simulation: &mut Simulation,
    local: &mut LocalSteps,
    end: f64,
) -> Result<(), SolverError> {
    if simulation.synchronised {
        local.regroup(simulation);
        simulation.dt = local.next_time_step(simulation, end)?;
        simulation.finished(Phase::TimeStep);
        local.forces(simulation);
        let dt = simulation.dt;
        local.kick(simulation, Kick::Opening, 0.5 * dt, dt);
        simulation.synchronised = false;
    }
    // Shorter than the travel that was planned only if `end` was moved back since.
    let dt = simulation.dt.min(end - simulation.time);
    let start = simulation.time;
    local.advance(simulation, 0, Span { start, length: dt })?;
    local.join_stress(simulation);
    simulation.work.stretch_bounds.are_fresh = true;
    simulation.advance_clock(dt, end);
    simulation.commit_history();
    simulation.finished(Phase::Stress);

    local.forces(simulation);
    if simulation.time >= end {
        local.kick(simulation, Kick::Closing, 0.5 * dt, 0.0);
        simulation.synchronised = true;
        return Ok(());
    }
    let now = stretch_limits(simulation, &local.groups);
    if local.choice.is_due(simulation.step, &now) {
        simulation.finished(Phase::TimeStep);
        local.kick(simulation, Kick::Closing, 0.5 * dt, 0.0);
        local
            .momentum_before
            .copy_from_slice(&simulation.ledger.momentum_before);
        local.regroup(simulation);
        let next = local.next_time_step(simulation, end)?;
        simulation.finished(Phase::TimeStep);
        local.fine_force(simulation, 1);
        local.kick(simulation, Kick::Opening, 0.5 * next, next);
        // Energies are those of the mean of the momenta before and after the kicks of this time.
        simulation
            .ledger
            .momentum_before
            .copy_from_slice(&local.momentum_before);
        simulation.dt = next;
    } else {
        let next = local.choice.next_time_step(simulation, &now, end)?;
        simulation.finished(Phase::TimeStep);
        local.kick(simulation, Kick::Full, 0.5 * (dt + next), next);
        simulation.dt = next;
    }
    Ok(())
}

impl LocalSteps {
    /// Forces of all stresses and of the fine ones.
    fn forces(&mut self, simulation: &mut Simulation) {
        force::internal(&simulation.reference, &mut simulation.work);
        self.fine_force(simulation, 1);
        simulation.loads.evaluate(
            &simulation.reference,
            simulation.time,
            &mut simulation.work.external_force,
        );
        simulation.finished(Phase::Force);
    }

    /// The kick between two steps over `duration`, and the constraints for the travel that follows: over
    /// `travel`, or over a sub-step.
    fn kick(&self, simulation: &mut Simulation, kick: Kick, duration: f64, travel: f64) {
        let Simulation {
            reference,
            state,
            work,
            ledger,
            prescribed,
            obstacles,
            time,
            ..
        } = simulation;
        for level in 0..=self.choice.finest() {
            let travel = travel * share(level);
            let push = Push {
                kick,
                reference,
                prescribed,
                middle: *time + 0.5 * travel,
                obstacles,
                travel: &obstacles.travel(*time, travel, Stage::Whole),
            };
            let force = |a: usize, p: &mut Vec3| {
                let impulse = Impulse {
                    external: or_zero(&work.external_force, a) * duration,
                    ..Impulse::default()
                };
                *p += impulse.external - work.internal_force[a] * duration;
                if level > 0 {
                    *p += self.fine_force[a] * duration;
                }
                impulse
            };
            self.push(level, push, state, ledger, force);
        }
        simulation.finished(Phase::Constraint);
    }
}

impl LocalSteps {
    /// Applies a push to the particles that move with a level.
    fn push(
        &self,
        level: u8,
        push: Push<'_>,
        state: &mut State,
        ledger: &mut Ledger,
        force: impl Fn(usize, &mut Vec3) -> Impulse + Sync,
    ) {
        let reference = push.reference;
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let first = body.particles.start;
            let particles = 0..body.particles.len();
            for run in groups.moving.runs(particles, Levels::only(level)) {
                let run = first + run.start..first + run.end;
                push.apply(run, state, ledger, &force);
            }
        }
        ledger.add_up_conditions(reference, |a| {
            let (body, a) = reference.owner_of_particle(a);
            self.groups[body].moving.level(a) == level
        });
    }
}

impl Simulation {
    /// Whether some points make sub-steps within the present step.
    #[must_use]
    pub fn has_substeps(&self) -> bool {
        self.local
            .as_ref()
            .is_some_and(|local| local.choice.finest() > 0)
    }
}

// Restart.

impl LocalSteps {
    /// What a restart needs.
    pub(crate) fn saved(&self) -> Vec<f64> {
        let mut saved = self.choice.saved().to_vec();
        saved.extend(self.groups.iter().flat_map(Groups::saved));
        saved
    }

    /// Length of [`saved`](Self::saved).
    pub(crate) fn saved_length(&self) -> usize {
        let tiles: usize = self.groups.iter().map(Groups::tiles).sum();
        self.choice.saved().len() + tiles
    }

    pub(crate) fn restore(&mut self, reference: &Reference, saved: &[f64]) {
        let (choice, mut tiles) = saved.split_at(self.choice.saved().len());
        self.choice.restore(choice);
        for (body, groups) in reference.bodies.iter().zip(&mut self.groups) {
            let (own, others) = tiles.split_at(groups.tiles());
            groups.restore(body, own);
            tiles = others;
        }
        // Sub-steps rewrite what is fine, and nothing else may be left over.
        self.fine_stress.fill(Mat3::zeros());
        self.fine_pressure.iter_mut().for_each(|own| own.fill(0.0));
    }
}
