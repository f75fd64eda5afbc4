//! Staggered leapfrog: momentum at half steps, everything else at whole steps.

use std::ops::Range;

use jstsph_tensor::Vec3;

use crate::constraint::Stage;
use crate::model::Formulation;
use crate::profile::Phase;
use crate::reference::Reference;
use crate::simulation::{Simulation, work_of};
use crate::state::{Impulse, Ledger, State, Work, or_zero};
use crate::{SolverError, parallel, strain};

/// Which part of a step a kick spans, which decides how its work is booked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kick {
    /// From the whole step to the half step that follows.
    Opening,
    /// From half step to half step.
    Full,
    /// From the half step to the whole step that ends the run.
    Closing,
}

/// One step of the leapfrog, `[eq:leapfrog]`:
///
/// ```text
///   xⁿ⁺¹ = xⁿ + Δt pⁿ⁺½/ρ ,  F, H, J to n+1 with G(pⁿ⁺½)
///   stress at n+1; commit history
///   pⁿ⁺³⁄² = pⁿ⁺½ + ½ (Δtⁿ + Δtⁿ⁺¹) R(xⁿ⁺¹, Fⁿ⁺¹, ...)
///   prescribed velocities, contact
/// ```
///
/// The discrete angular momentum Σ V xⁿ × pⁿ⁺½ is exact when the torque about xⁿ is removed from R,
/// because x moves parallel to p. docs/theory.md.
pub(crate) fn step(simulation: &mut Simulation, end: f64) -> Result<(), SolverError> {
    if simulation.synchronised {
        simulation.dt = simulation.next_time_step(end)?;
        simulation.finished(Phase::TimeStep);
        simulation.keep_velocity_gradient();
        simulation.finished(Phase::Gradient);
        simulation.forces(|state, a| state.position[a]);
        simulation.kick(Kick::Opening, 0.5 * simulation.dt, simulation.dt);
        simulation.synchronised = false;
        simulation.finished(Phase::Constraint);
    }
    // Shorter than the travel that was planned only if `end` was moved back since.
    let dt = simulation.dt.min(end - simulation.time);
    simulation.move_particles(dt);
    simulation.finished(Phase::Strain);
    simulation.keep_velocity_gradient();
    simulation.finished(Phase::Gradient);
    simulation.drift_strains(dt);
    simulation.finished(Phase::Strain);
    simulation.advance_time(dt, end);
    simulation.evaluate_stress(dt)?;
    simulation.commit_history();
    simulation.finished(Phase::Stress);
    simulation.advance_heat(dt)?;
    simulation.finished(Phase::Heat);

    simulation.forces(|state, a| state.position[a]);
    if simulation.time >= end {
        simulation.kick(Kick::Closing, 0.5 * dt, 0.0);
        simulation.synchronised = true;
    } else {
        let next = simulation.next_time_step(end)?;
        simulation.finished(Phase::TimeStep);
        simulation.kick(Kick::Full, 0.5 * (dt + next), next);
        simulation.dt = next;
    }
    simulation.finished(Phase::Constraint);
    Ok(())
}

impl Simulation {
    /// x, and the padded momenta.
    pub(crate) fn move_particles(&mut self, dt: f64) {
        let Self {
            reference,
            state,
            work,
            ..
        } = self;
        let State {
            position, momentum, ..
        } = state;
        let padded = &mut work.padded_momentum;
        parallel::for_each_pair(position, padded, |a, x, padded| {
            *x += momentum[a] * (dt / reference.density[a]);
            *padded = strain::padded(&momentum[a]);
        });
    }

    pub(crate) fn drift_strains(&mut self, dt: f64) {
        self.book_jacobian_dissipation(dt);
        let strains = self.strains();
        let kept = self.keeps_velocity_gradient();
        let (reference, state, work) = (&self.reference, &mut self.state, &mut self.work);
        if let Some(heat) = &mut self.heat {
            heat.open(state);
        }
        if strains.formulation == Formulation::Displacement {
            strain::from_positions(strains, reference, state, work);
        } else {
            strain::drift(strains, reference, state, work, (dt, kept));
        }
    }

    pub(crate) fn advance_time(&mut self, dt: f64, end: f64) {
        self.move_obstacles(self.time, dt);
        self.advance_clock(dt, end);
    }

    /// p += Δt R over `duration`, then the constraints for the travel over `travel` that follows,
    /// and the books of the kick.
    pub(crate) fn kick(&mut self, kick: Kick, duration: f64, travel: f64) {
        let Self {
            state,
            work,
            ledger,
            ..
        } = self;
        parallel::for_each_triple(
            &mut state.momentum,
            &mut ledger.momentum_before,
            &mut ledger.impulse,
            |a, p, before, impulse| {
                *before = *p;
                *impulse = Impulse {
                    numerical: or_zero(&work.dissipation, a) * duration,
                    external: or_zero(&work.external_force, a) * duration,
                    ..Impulse::default()
                };
                *p += impulse.numerical + impulse.external - work.internal_force[a] * duration;
            },
        );
        let time = self.time;
        let Self {
            reference,
            state,
            ledger,
            ..
        } = self;
        self.prescribed.apply(
            reference,
            time + 0.5 * travel,
            1.0,
            &mut state.momentum,
            ledger,
        );
        self.obstacles
            .apply(reference, time, travel, Stage::Whole, state, ledger);

        let all = 0..reference.position.len();
        book(kick, reference, &state.momentum, ledger, all);
    }
}

/// Books the work of a kick of a run of particles.
pub(crate) fn book(
    kick: Kick,
    reference: &Reference,
    momentum: &[Vec3],
    ledger: &mut Ledger,
    run: Range<usize>,
) {
    let first = run.start;
    let Ledger {
        momentum_before,
        impulse,
        work,
        last_work,
        friction_heat,
        ..
    } = ledger;
    let (work, last_work) = (&mut work[run.clone()], &mut last_work[run.clone()]);
    parallel::for_each_triple(
        work,
        last_work,
        &mut friction_heat[run],
        |k, total, last, heat| {
            let a = first + k;
            let mean = (momentum_before[a] + momentum[a]) * (0.5 / reference.density[a]);
            let done = work_of(&impulse[a], &mean);
            *heat = done.friction;
            match kick {
                // Half of twice the work is booked with the next kick: all of it by then.
                Kick::Opening => *last = done.plus(done, 1.0),
                Kick::Full => {
                    *total = total.plus(*last, 0.5).plus(done, 0.5);
                    *last = done;
                }
                Kick::Closing => {
                    *total = total.plus(*last, 0.5).plus(done, 1.0);
                    *last = Work::default();
                }
            }
        },
    );
}
