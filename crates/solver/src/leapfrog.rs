//! Staggered leapfrog: momentum at half steps, everything else at whole steps.

use std::ops::Range;

use jstsph_tensor::Vec3;

use crate::books::{Impulse, Ledger};
use crate::constraint::{Obstacles, Prescribed, Stage, Travel};
use crate::model::Formulation;
use crate::parallel::{self, CHUNK};
use crate::profile::Phase;
use crate::reference::Reference;
use crate::simulation::Simulation;
use crate::state::{State, or_zero};
use crate::{SolverError, strain};

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
        if simulation.keeps_velocity_gradient() {
            simulation.velocity_gradient();
        }
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
    if simulation.keeps_velocity_gradient() {
        simulation.gradient_of_padded_momenta();
    }
    simulation.finished(Phase::Gradient);
    simulation.drift_strains(dt);
    simulation.finished(Phase::Strain);
    simulation.renew_acoustic_limit();
    simulation.finished(Phase::TimeStep);
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
            reference,
            state,
            work,
            ledger,
            prescribed,
            obstacles,
            time,
            ..
        } = self;
        let all = 0..reference.position.len();
        Push {
            kick,
            reference,
            prescribed,
            middle: *time + 0.5 * travel,
            obstacles,
            travel: &obstacles.travel(*time, travel, Stage::Whole),
        }
        .apply(all, state, ledger, |a, p| {
            let impulse = Impulse {
                numerical: or_zero(&work.dissipation, a) * duration,
                external: or_zero(&work.external_force, a) * duration,
                ..Impulse::default()
            };
            *p += impulse.numerical + impulse.external - work.internal_force[a] * duration;
            impulse
        });
        ledger.add_up_conditions(reference, |_| true);
    }
}

/// A kick of particles: forces, prescribed velocities, contact and the books in one loop.
pub(crate) struct Push<'a> {
    pub(crate) kick: Kick,
    pub(crate) reference: &'a Reference,
    pub(crate) prescribed: &'a Prescribed,
    /// Time of the prescribed velocities, s.
    pub(crate) middle: f64,
    pub(crate) obstacles: &'a Obstacles,
    /// The travel that follows.
    pub(crate) travel: &'a Travel,
}

impl Push<'_> {
    /// Applies it to a run of the particles of the simulation; `force(a, p)` changes the momentum of a
    /// particle and tells what for.
    pub(crate) fn apply(
        &self,
        run: Range<usize>,
        state: &mut State,
        ledger: &mut Ledger,
        force: impl Fn(usize, &mut Vec3) -> Impulse + Sync,
    ) {
        let reference = self.reference;
        let Ledger {
            momentum_before,
            pages,
            ..
        } = ledger;
        for body in &reference.bodies {
            let near = self.obstacles.near(self.travel, body);
            let has_walls = self.obstacles.slots() > 0;
            let particles = &body.particles;
            let range = run.start.max(particles.start)..run.end.min(particles.end);
            if range.is_empty() {
                continue;
            }
            let arrays = (
                &mut state.position[..],
                &mut state.momentum[..],
                &mut momentum_before[..],
            );
            parallel::for_each_page(range, arrays, pages, |first, x, p, before, page| {
                let begin = (first % CHUNK) as u32;
                let mut next = page.held.partition_point(|held| held.place < begin);
                for (k, ((x, p), before)) in x.iter_mut().zip(p).zip(before).enumerate() {
                    let (a, place) = (first + k, (first + k) % CHUNK);
                    *before = *p;
                    let mut impulse = force(a, p);
                    while let Some(held) = page.held.get_mut(next)
                        && held.place as usize == place
                    {
                        let at = (body.density, &reference.position[a]);
                        let condition = held.condition as usize;
                        held.change = self.prescribed.hold(condition, at, self.middle, p);
                        impulse.external += held.change;
                        next += 1;
                    }
                    if has_walls {
                        let particle = (x, &mut *p, &mut impulse);
                        near.meet(page, place, reference.volume[a], particle);
                    }
                    if page.has_accounts() {
                        let velocity = (*before + *p) * (0.5 / reference.density[a]);
                        page.book(self.kick, place, &impulse, &velocity);
                    }
                }
            });
        }
    }
}
