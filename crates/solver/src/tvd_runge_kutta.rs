//! Two-stage TVD Runge-Kutta (3.16), the paper's integrator.

use crate::SolverError;
use crate::simulation::Simulation;

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
    let time = simulation.time;
    simulation.dt = dt;
    simulation.open_books();
    simulation.save_start();

    simulation.velocity_gradient();
    simulation.forces(|state, a| state.position[a]);
    simulation.stage(dt);
    simulation.move_obstacles(time, dt);
    simulation.constrain(time + dt, dt, 0.5);
    simulation.evaluate_stress(dt)?;

    simulation.velocity_gradient();
    simulation.stage_two_forces(dt);
    simulation.stage(dt);
    simulation.constrain(time + dt, dt, 0.5);

    simulation.average_with_start();
    simulation.constrain(time + dt, dt, 1.0);
    simulation.advance_clock(dt, end);
    simulation.evaluate_stress(dt)?;
    simulation.commit_history();
    simulation.close_books();
    Ok(())
}
