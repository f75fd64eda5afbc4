//! Two-stage TVD Runge-Kutta (3.16), `[eq:tvd-rk2]`, the paper's integrator.

use crate::constraint::Stage;
use crate::model::Formulation;
use crate::profile::Phase;
use crate::simulation::{Simulation, work_of};
use crate::state::{Impulse, Ledger, State};
use crate::strain::constrain;
use crate::{SolverError, parallel, strain};

/// One step, to be read beside the paper's algorithm box:
///
/// ```text
///   u*   = uⁿ + Δt R(uⁿ)                                          (3.16a)
///   u**  = u* + Δt R(u*)                                          (3.16b)
///   uⁿ⁺¹ = (uⁿ + u**)/2      for u = p, F, H, J, x together       (3.16c)
/// ```
///
/// Plastic history moves once, at uⁿ⁺¹; the stress at u* is a trial evaluation from the history at
/// tⁿ. Torques are removed about xⁿ in stage 1 and about xⁿ⁺¹ = ½ (xⁿ + x* + Δt p*/ρ) in stage 2,
/// which makes the discrete angular momentum exact. docs/theory.md.
pub(crate) fn step(simulation: &mut Simulation, end: f64) -> Result<(), SolverError> {
    let dt = simulation.next_time_step(end)?;
    simulation.finished(Phase::TimeStep);
    let time = simulation.time;
    simulation.dt = dt;
    simulation.open_books();
    simulation.save_start();

    simulation.velocity_gradient();
    simulation.finished(Phase::Gradient);
    simulation.forces(|state, a| state.position[a]);
    simulation.stage(dt);
    simulation.finished(Phase::Strain);
    simulation.move_obstacles(time, dt);
    simulation.constrain(time + dt, dt, Stage::First);
    simulation.finished(Phase::Constraint);
    simulation.evaluate_stress(dt)?;
    simulation.finished(Phase::Stress);

    simulation.velocity_gradient();
    simulation.finished(Phase::Gradient);
    simulation.stage_two_forces(dt);
    simulation.stage(dt);
    simulation.finished(Phase::Strain);
    simulation.constrain(time + dt, dt, Stage::Second);

    simulation.average_with_start();
    simulation.constrain(time + dt, dt, Stage::Average);
    simulation.advance_clock(dt, end);
    simulation.finished(Phase::Constraint);
    simulation.evaluate_stress(dt)?;
    simulation.commit_history();
    simulation.finished(Phase::Stress);
    simulation.close_books();
    simulation.finished(Phase::Constraint);
    simulation.advance_heat(dt)?;
    simulation.finished(Phase::Heat);
    Ok(())
}

impl Simulation {
    pub(crate) fn open_books(&mut self) {
        self.ledger.impulse.fill(Impulse::default());
    }

    pub(crate) fn save_start(&mut self) {
        if let Some(start) = &mut self.start {
            start.copy_from(&self.state);
        }
        if let Some(heat) = &mut self.heat {
            heat.open(&self.state);
        }
    }

    /// u += Δt R(u), with the rates evaluated last (3.16a, b).
    pub(crate) fn stage(&mut self, dt: f64) {
        self.book_jacobian_dissipation(0.5 * dt);
        let strains = self.strains();
        let Self {
            reference,
            state,
            work,
            ledger,
            ..
        } = self;
        let from_positions = strains.formulation == Formulation::Displacement;
        if !from_positions {
            strain::euler(strains, reference, state, work, dt);
        }
        let State {
            position, momentum, ..
        } = state;
        parallel::for_each_triple(
            position,
            momentum,
            &mut ledger.impulse,
            |a, x, p, impulse| {
                *x += *p * (dt / reference.density[a]);
                impulse.numerical += work.dissipation[a] * (0.5 * dt);
                impulse.external += work.external_force[a] * (0.5 * dt);
                *p += (work.dissipation[a] + work.external_force[a] - work.internal_force[a]) * dt;
            },
        );
        if from_positions {
            strain::from_positions(strains, reference, &mut self.state, &mut self.work);
        }
    }

    /// Forces of stage 2, with the lever arms xⁿ⁺¹ = ½ (xⁿ + x* + Δt p*/ρ).
    pub(crate) fn stage_two_forces(&mut self, dt: f64) {
        let start = self.start.take();
        let density = std::mem::take(&mut self.reference.density);
        let time = self.time;
        self.time += dt;
        if let Some(start) = &start {
            self.forces(|state, a| {
                (start.position[a] + state.position[a] + state.momentum[a] * (dt / density[a]))
                    * 0.5
            });
        }
        self.time = time;
        self.reference.density = density;
        self.start = start;
    }

    /// uⁿ⁺¹ = (uⁿ + u**)/2 (3.16c), then the strains that are not integrated.
    pub(crate) fn average_with_start(&mut self) {
        let strains = self.strains();
        let Self {
            reference,
            state,
            start,
            ..
        } = self;
        let Some(start) = start else { return };
        parallel::for_each_triple(
            &mut state.position,
            &mut state.momentum,
            &mut state.jacobian,
            |a, x, p, j| {
                *x = (start.position[a] + *x) * 0.5;
                *p = (start.momentum[a] + *p) * 0.5;
                *j = (start.jacobian[a] + *j) * 0.5;
            },
        );
        parallel::for_each_pair(
            &mut state.deformation_gradient,
            &mut state.cofactor,
            |q, f, h| {
                *f = (start.deformation_gradient[q] + *f) * 0.5;
                *h = (start.cofactor[q] + *h) * 0.5;
            },
        );
        if strains.formulation == Formulation::Displacement {
            strain::from_positions(strains, reference, state, &mut self.work);
        } else {
            constrain(strains, reference, state);
        }
    }

    /// Work of the impulses of a Runge-Kutta step, with the mean velocity of the step: their sum
    /// is the change of kinetic energy exactly.
    pub(crate) fn close_books(&mut self) {
        let Self {
            reference,
            state,
            start,
            ledger,
            ..
        } = self;
        let Some(start) = start else { return };
        let Ledger {
            impulse,
            work,
            friction_heat,
            ..
        } = ledger;
        parallel::for_each_pair(work, friction_heat, |a, total, heat| {
            let mean = (start.momentum[a] + state.momentum[a]) * (0.5 / reference.density[a]);
            let done = work_of(&impulse[a], &mean);
            *total = total.plus(done, 1.0);
            *heat = done.friction;
        });
    }
}
