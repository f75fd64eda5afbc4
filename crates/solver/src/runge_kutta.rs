//! Explicit Runge-Kutta methods: two-stage TVD (3.16), the paper's integrator, and methods of higher
//! order.

use std::ops::{Add, Mul, Sub};

use jstsph_tensor::Mat3;

use crate::books::{Impulse, Ledger};
use crate::constraint::Stage;
use crate::model::Formulation;
use crate::parallel::{self, CHUNK};
use crate::profile::Phase;
use crate::simulation::Simulation;
use crate::state::{State, or_zero};
use crate::strain::constrain;
use crate::{SolverError, strain};

use table::Combination;
pub(crate) use table::Method;

mod table;

/// States that a Runge-Kutta step remembers.
#[derive(Clone, Debug)]
pub(crate) struct Registers {
    /// uⁿ.
    pub(crate) start: State,
    /// The state before a stage and the increment, for methods that have one.
    increment: Option<(State, State)>,
}

impl Registers {
    /// Those of a method, as long as `state`.
    pub(crate) fn new(method: &Method, state: &State) -> Self {
        Self {
            start: state.clone(),
            increment: method
                .has_increment()
                .then(|| (state.clone(), state.clone())),
        }
    }
}

/// One step. For the paper's method, to be read beside its algorithm box:
///
/// ```text
///   u*   = uⁿ + Δt R(uⁿ)                                          (3.16a)
///   u**  = u* + Δt R(u*)                                          (3.16b)
///   uⁿ⁺¹ = (uⁿ + u**)/2      for u = p, F, H, J, x together       (3.16c)
/// ```
///
/// Plastic history moves once, at uⁿ⁺¹; the stresses of the stages are trial evaluations from the
/// history at tⁿ. Torques are removed about xⁿ in stage 1 and about xⁿ⁺¹ = ½ (xⁿ + x* + Δt p*/ρ) in
/// stage 2, which makes the discrete angular momentum exact; other methods remove them about the
/// positions of the stage. docs/theory.md.
pub(crate) fn step(
    simulation: &mut Simulation,
    method: &Method,
    end: f64,
) -> Result<(), SolverError> {
    simulation.renew_acoustic_limit();
    let dt = simulation.next_time_step(end)?;
    simulation.finished(Phase::TimeStep);
    let time = simulation.time;
    simulation.dt = dt;
    simulation.open_books();
    simulation.save_start();
    let last = method.stages.len() - 1;
    let mut begin = 0.0;
    for (i, rule) in method.stages.iter().enumerate() {
        if simulation.scheme.formulation != Formulation::Displacement
            || simulation.keeps_velocity_gradient()
        {
            simulation.velocity_gradient();
        }
        simulation.finished(Phase::Gradient);
        simulation.time = time + begin * dt;
        if i == last && method.lever_at_end {
            simulation.forces_about_end(dt);
        } else {
            simulation.forces(|state, a| state.position[a]);
        }
        simulation.time = time;
        simulation.remember();
        simulation.stage(dt, method.weight(i));
        simulation.finished(Phase::Strain);
        simulation.move_obstacles(time + begin * dt, (rule.end - begin) * dt);
        let target = time + rule.end * dt;
        let remaining = method.remaining(i);
        let first = i == 0;
        match rule.combination {
            Combination::WithStart { share } => {
                let factor = remaining * (1.0 - share);
                simulation.constrain(target, dt, Stage::Within { factor, first });
                if share != 0.0 {
                    simulation.average_with_start(share);
                }
                if i == last {
                    simulation.constrain(target, dt, Stage::End);
                } else if share != 0.0 {
                    let factor = remaining;
                    simulation.constrain(target, dt, Stage::Within { factor, first });
                }
            }
            Combination::Increment { memory, share } => {
                simulation.add_increment(memory, share);
                let stage = if i == last {
                    Stage::End
                } else {
                    let factor = remaining;
                    Stage::Within { factor, first }
                };
                simulation.constrain(target, dt, stage);
            }
        }
        begin = rule.end;
        if i == last {
            simulation.advance_clock(dt, end);
        }
        simulation.finished(Phase::Constraint);
        simulation.evaluate_stress(rule.end * dt)?;
        simulation.finished(Phase::Stress);
    }
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
        if let Some(registers) = &mut self.registers {
            registers.start.copy_from(&self.state);
        }
        if let Some(heat) = &mut self.heat {
            heat.open(&self.state);
        }
    }

    /// Keeps the state before a stage, for methods with an increment.
    fn remember(&mut self) {
        if let Some(registers) = &mut self.registers
            && let Some((before, _)) = &mut registers.increment
        {
            before.copy_from(&self.state);
        }
    }

    /// u += Δt R(u), with the rates evaluated last (3.16a, b); `weight` is their part in the step.
    pub(crate) fn stage(&mut self, dt: f64, weight: f64) {
        self.book_jacobian_dissipation(weight * dt);
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
                let dissipation = or_zero(&work.dissipation, a);
                let external = or_zero(&work.external_force, a);
                impulse.numerical += dissipation * (weight * dt);
                impulse.external += external * (weight * dt);
                *p += (dissipation + external - work.internal_force[a]) * dt;
            },
        );
        if from_positions {
            strain::from_positions(strains, reference, &mut self.state, &mut self.work);
        }
    }

    /// Forces of the paper's stage 2, with the lever arms xⁿ⁺¹ = ½ (xⁿ + x* + Δt p*/ρ).
    fn forces_about_end(&mut self, dt: f64) {
        let registers = self.registers.take();
        let density = std::mem::take(&mut self.reference.density);
        if let Some(registers) = &registers {
            let start = &registers.start;
            self.forces(|state, a| {
                (start.position[a] + state.position[a] + state.momentum[a] * (dt / density[a]))
                    * 0.5
            });
        }
        self.reference.density = density;
        self.registers = registers;
    }

    /// u = share uⁿ + (1 − share) u, as in (3.16c), then the strains that are not integrated.
    pub(crate) fn average_with_start(&mut self, share: f64) {
        let Self {
            state, registers, ..
        } = self;
        let Some(registers) = registers else { return };
        let start = &registers.start;
        let rest = 1.0 - share;
        parallel::for_each_triple(
            &mut state.position,
            &mut state.momentum,
            &mut state.jacobian,
            |a, x, p, j| {
                *x = start.position[a] * share + *x * rest;
                *p = start.momentum[a] * share + *p * rest;
                *j = start.jacobian[a] * share + *j * rest;
            },
        );
        let average = |tensors: &mut [Mat3], start: &[Mat3]| {
            parallel::for_each(tensors, |q, tensor| {
                *tensor = start[q] * share + *tensor * rest
            });
        };
        average(&mut state.deformation_gradient, &start.deformation_gradient);
        average(&mut state.cofactor, &start.cofactor);
        self.evaluate_dependent_strains();
    }

    /// d = memory d + Δt R, u = before + share d, with Δt R the difference of the Euler step that has
    /// just been made; then the strains that are not integrated.
    fn add_increment(&mut self, memory: f64, share: f64) {
        let Self {
            state, registers, ..
        } = self;
        let Some((before, increment)) = registers
            .as_mut()
            .and_then(|registers| registers.increment.as_mut())
        else {
            return;
        };
        let rule = (memory, share);
        combine(
            &mut state.position,
            &before.position,
            &mut increment.position,
            rule,
        );
        combine(
            &mut state.momentum,
            &before.momentum,
            &mut increment.momentum,
            rule,
        );
        combine(
            &mut state.jacobian,
            &before.jacobian,
            &mut increment.jacobian,
            rule,
        );
        combine(
            &mut state.deformation_gradient,
            &before.deformation_gradient,
            &mut increment.deformation_gradient,
            rule,
        );
        combine(
            &mut state.cofactor,
            &before.cofactor,
            &mut increment.cofactor,
            rule,
        );
        self.evaluate_dependent_strains();
    }

    fn evaluate_dependent_strains(&mut self) {
        let strains = self.strains();
        if strains.formulation == Formulation::Displacement {
            strain::from_positions(strains, &self.reference, &mut self.state, &mut self.work);
        } else {
            constrain(strains, &self.reference, &mut self.state);
        }
    }

    /// Work of the impulses of a Runge-Kutta step, with the mean velocity of the step: their sum
    /// is the change of kinetic energy exactly.
    pub(crate) fn close_books(&mut self) {
        let Self {
            reference,
            state,
            registers,
            ledger,
            ..
        } = self;
        let Some(registers) = registers else { return };
        let start = &registers.start;
        let Ledger {
            impulse,
            momentum_before,
            pages,
            ..
        } = ledger;
        let arrays = (
            &mut impulse[..],
            &mut state.momentum[..],
            &mut momentum_before[..],
        );
        let all = 0..reference.position.len();
        parallel::for_each_page(all, arrays, pages, |first, impulse, momentum, _, page| {
            if !page.has_accounts() {
                return;
            }
            for (k, (impulse, p)) in impulse.iter().zip(momentum).enumerate() {
                let a = first + k;
                let mean = (start.momentum[a] + *p) * (0.5 / reference.density[a]);
                page.book_step(a % CHUNK, impulse, &mean);
            }
        });
    }
}

/// d = memory d + (u − before), u = before + share d.
fn combine<T>(u: &mut [T], before: &[T], increment: &mut [T], (memory, share): (f64, f64))
where
    T: Copy + Send + Sync + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
{
    // The first increment of a step has no memory, whatever the register holds.
    let forget = memory == 0.0;
    parallel::for_each_pair(u, increment, |i, u, d| {
        let change = *u - before[i];
        *d = if forget { change } else { *d * memory + change };
        *u = before[i] + *d * share;
    });
}
