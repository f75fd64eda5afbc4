//! The mixed total Lagrangian SPH scheme {p, F, H, J}: time integration, stabilisation, energies.
//!
//! Start at [`Simulation::advance_step`], then the two integrators, `leapfrog.rs` and
//! `tvd_runge_kutta.rs`: each line of them is one function. Particles carry x, p and J; evaluation
//! points (the particles themselves, or the midpoints of lattice bonds) carry F, H, the plastic
//! history and the stress. The solver reads and writes no files and knows no units but SI.

mod consistency;
mod constraint;
mod dissipation;
mod energy;
mod error;
mod fields;
mod force;
mod leapfrog;
mod model;
mod parallel;
mod probe;
mod projection;
mod reference;
mod save;
mod simulation;
mod state;
mod strain;
mod stress;
#[cfg(test)]
mod testing;
mod time_step;
mod tvd_runge_kutta;

pub use energy::{Energies, Momenta, PaperEnergies};
pub use error::{Place, SolverError};
pub use fields::ParticleFields;
pub use model::{
    Biharmonic, Condition, ConditionKind, Formulation, Integrator, Jst, Laplacian, Model,
    ModelBody, ModelObstacle, Quadrature, Scheme, Signal, SignalFunction, SmoothingReference,
    Stabilisation, Weights,
};
pub use probe::{Field, Probe, ProbeKind, Statistic};
pub use reference::{BodyReference, Reference, Shares};
pub use save::Saved;
pub use simulation::Simulation;
pub use state::State;
