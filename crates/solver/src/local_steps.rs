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

mod choice;
mod groups;
mod passes;
#[cfg(test)]
mod tests;

pub(crate) use groups::{Groups, Part};

/// Groups and buffers; allocated once.
#[derive(Clone, Debug)]
pub(crate) struct LocalSteps {
    /// Groups of every body.
    groups: Vec<Groups>,
    choice: Choice,
    /// The part of V P that acts in sub-steps; zero at points that are not fine.
    fine_stress: Vec<Mat3>,
    /// τ_vol of the particles whose J is fine, zero for the others.
    fine_pressure: Vec<f64>,
    /// T of `fine_stress`, of the particles that move in sub-steps.
    fine_force: Vec<Vec3>,
    /// Mean momenta of the moving particles over the step.
    mean_momentum: Vec<Vec3>,
    /// Changes of volume of the fine points so far in this step.
    volume_change: Vec<f64>,
    /// Momenta of an earlier kick, for the books.
    momentum_before: Vec<Vec3>,
}

/// Durations of a kick: of the impulses of the whole step and of those of a sub-step.
#[derive(Clone, Copy, Debug)]
struct Durations {
    coarse: f64,
    fine: f64,
}

impl LocalSteps {
    /// For schemes that ask for it.
    pub(crate) fn new(scheme: &Scheme, reference: &Reference) -> Option<Box<Self>> {
        let (particles, points) = (reference.position.len(), reference.point_volume.len());
        (scheme.substeps > 1).then(|| {
            Box::new(Self {
                groups: reference.bodies.iter().map(Groups::new).collect(),
                choice: Choice::new(scheme, reference),
                fine_stress: vec![Mat3::zeros(); points],
                fine_pressure: vec![0.0; particles],
                fine_force: vec![Vec3::zeros(); particles],
                mean_momentum: vec![Vec3::zeros(); particles],
                volume_change: vec![0.0; points],
                momentum_before: vec![Vec3::zeros(); particles],
            })
        })
    }

    /// Sub-steps of a step.
    fn ratio(&self) -> f64 {
        f64::from(self.choice.ratio())
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

    /// A duration for what acts once a step, and its share for what acts in every sub-step.
    fn durations(&self, duration: f64) -> Durations {
        Durations {
            coarse: duration,
            fine: duration / self.ratio(),
        }
    }
}

/// One step, `[eq:local-step]`: with Δ = mδ
///
/// ```text
///   m times:  x, F, H, J of the fine parts by δ with pⁿ⁺⁽²ʲ⁺¹⁾ᐟ²ᵐ; their stress; commit history
///             p += δ R of the fine stress (between the sub-steps)
///   x, F, H, J of the rest by Δ with the mean of the momenta; stress; commit history
///   p += Δ R + δ R of the fine stress
///   prescribed velocities, contact: of the particles that move in sub-steps after each of their kicks
/// ```
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
        local.kick(simulation, Kick::Opening, local.durations(0.5 * dt), dt);
        simulation.synchronised = false;
    }
    // Shorter than the travel that was planned only if `end` was moved back since.
    let dt = simulation.dt.min(end - simulation.time);
    local.make_sub_steps(simulation, dt)?;
    local.advance_rest(simulation, dt)?;
    simulation.advance_clock(dt, end);
    simulation.commit_history();
    simulation.finished(Phase::Stress);

    local.forces(simulation);
    if simulation.time >= end {
        local.kick(simulation, Kick::Closing, local.durations(0.5 * dt), 0.0);
        simulation.synchronised = true;
        return Ok(());
    }
    let now = stretch_limits(simulation, &local.groups);
    if local.choice.is_due(simulation.step, &now) {
        simulation.finished(Phase::TimeStep);
        local.kick(simulation, Kick::Closing, local.durations(0.5 * dt), 0.0);
        local
            .momentum_before
            .copy_from_slice(&simulation.ledger.momentum_before);
        local.regroup(simulation);
        let next = local.next_time_step(simulation, end)?;
        simulation.finished(Phase::TimeStep);
        local.fine_force(simulation);
        local.kick(simulation, Kick::Opening, local.durations(0.5 * next), next);
        // Energies are those of the mean of the momenta before and after the kicks of this time.
        simulation
            .ledger
            .momentum_before
            .copy_from_slice(&local.momentum_before);
        simulation.dt = next;
    } else {
        let next = local.choice.next_time_step(simulation, &now, end)?;
        simulation.finished(Phase::TimeStep);
        let durations = local.durations(0.5 * (dt + next));
        local.kick(simulation, Kick::Full, durations, next);
        simulation.dt = next;
    }
    Ok(())
}

impl LocalSteps {
    /// Forces of all stresses and of the fine ones.
    fn forces(&mut self, simulation: &mut Simulation) {
        force::internal(&simulation.reference, &mut simulation.work);
        self.fine_force(simulation);
        simulation.loads.evaluate(
            &simulation.reference,
            simulation.time,
            &mut simulation.work.external_force,
        );
        simulation.finished(Phase::Force);
    }

    /// The kick between two steps, and the constraints for the travel that follows: over `travel`, or
    /// over a sub-step.
    fn kick(&self, simulation: &mut Simulation, kick: Kick, duration: Durations, travel: f64) {
        let sub_step = travel / self.ratio();
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
        let difference = duration.coarse - duration.fine;
        for (moving, travel) in [(false, travel), (true, sub_step)] {
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
                    external: or_zero(&work.external_force, a) * duration.coarse,
                    ..Impulse::default()
                };
                *p += impulse.external - work.internal_force[a] * duration.coarse;
                if moving {
                    *p += self.fine_force[a] * difference;
                }
                impulse
            };
            self.push(moving, push, state, ledger, force);
        }
        simulation.finished(Phase::Constraint);
    }
}

impl LocalSteps {
    /// Applies a push to the particles that move in sub-steps, or to the others.
    fn push(
        &self,
        moving: bool,
        push: Push<'_>,
        state: &mut State,
        ledger: &mut Ledger,
        force: impl Fn(usize, &mut Vec3) -> Impulse + Sync,
    ) {
        let reference = push.reference;
        for (body, groups) in reference.bodies.iter().zip(&self.groups) {
            let first = body.particles.start;
            for run in groups.moving.runs(0..body.particles.len(), moving) {
                let run = first + run.start..first + run.end;
                push.apply(run, state, ledger, &force);
            }
        }
        ledger.add_up_conditions(reference, |a| {
            let (body, a) = reference.owner_of_particle(a);
            self.groups[body].moving.contains(a) == moving
        });
    }
}

impl Simulation {
    /// Whether some points make sub-steps within the present step.
    #[must_use]
    pub fn has_substeps(&self) -> bool {
        self.local
            .as_ref()
            .is_some_and(|local| local.choice.ratio() > 1)
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
        self.fine_pressure.fill(0.0);
    }
}
