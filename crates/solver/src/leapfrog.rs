//! Staggered leapfrog: momentum at half steps, everything else at whole steps.

use crate::SolverError;
use crate::simulation::Simulation;

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

/// One step of the leapfrog:
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
        simulation.velocity_gradient();
        simulation.forces(|state, a| state.position[a]);
        simulation.kick(Kick::Opening, 0.5 * simulation.dt, simulation.dt);
        simulation.synchronised = false;
    }
    // Shorter than the travel that was planned only if `end` was moved back since.
    let dt = simulation.dt.min(end - simulation.time);
    simulation.move_particles(dt);
    simulation.velocity_gradient();
    simulation.drift_strains(dt);
    simulation.advance_time(dt, end);
    simulation.evaluate_stress(dt)?;
    simulation.commit_history();

    simulation.forces(|state, a| state.position[a]);
    if simulation.time >= end {
        simulation.kick(Kick::Closing, 0.5 * dt, 0.0);
        simulation.synchronised = true;
    } else {
        let next = simulation.next_time_step(end)?;
        simulation.kick(Kick::Full, 0.5 * (dt + next), next);
        simulation.dt = next;
    }
    Ok(())
}
