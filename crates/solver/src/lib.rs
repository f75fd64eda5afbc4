//! The mixed total Lagrangian SPH scheme {p, F, H, J}: time integration, stabilisation, energies.
//!
//! Start at [`Simulation::advance_step`], then the two integrators, `leapfrog.rs` and
//! `runge_kutta.rs`: each line of them is one function. Particles carry x, p and J; evaluation
//! points (the particles themselves, or the midpoints of lattice bonds) carry F, H, the plastic
//! history and the stress. The solver reads and writes no files and knows no units but SI.
//!
//! ```
//! use jstsph_geometry::{Dimension, Lattice, Shape, Spacing, build_body};
//! use jstsph_material::library;
//! use jstsph_solver::{
//!     Formulation, Integrator, Model, ModelBody, Quadrature, Scheme, Simulation,
//!     SmoothingReference, Stabilisation, StepLimit, Weights,
//! };
//! use jstsph_tensor::Vec3;
//!
//! // A free copper plate of 10 mm x 5 mm that is stretched at 100 1/s.
//! let shape = Shape::Box { min: Vec3::zeros(), max: Vec3::new(10e-3, 5e-3, 0.0) };
//! let lattice = Lattice::Cubic { spacing: Spacing::Length(1e-3) };
//! let body = build_body(shape, lattice, Dimension::PlaneStrain)?;
//! let copper = library().iter().find(|m| m.name == "copper_taylor").ok_or("no copper")?;
//! let model = Model {
//!     dimension: Dimension::PlaneStrain,
//!     bodies: vec![ModelBody {
//!         name: "plate".into(),
//!         initial_temperature: vec![293.15; body.positions.len()],
//!         initial_velocity: body.positions.iter().map(|x| Vec3::new(100.0 * x.x, 0.0, 0.0)).collect(),
//!         body: body.into(),
//!         material: copper.spec.clone(),
//!         body_force: None,
//!     }],
//!     conditions: vec![],
//!     obstacles: vec![],
//!     heat: None,
//!     scheme: Scheme {
//!         quadrature: Quadrature::Bonds,
//!         kernel: jstsph_sph::Kernel::QuinticSpline,
//!         smoothing_ratio: 0.8,
//!         smoothing_reference: SmoothingReference::Spacing,
//!         weights: Weights::Interpolation,
//!         boundary_correction: false,
//!         formulation: Formulation::MomentumGradientCofactorJacobian,
//!         integrator: Integrator::Leapfrog,
//!         cfl: 0.5,
//!         step_limit: StepLimit::Stretch,
//!         stabilisation: Stabilisation::default(),
//!         projection: false,
//!         inertia_scale: 1.0,
//!         smallest_time_step: 1e-6,
//!         substeps: 1,
//!     },
//! };
//! let mut simulation = Simulation::new(model)?;
//! let before = simulation.momenta().linear;
//! while simulation.time() < 10e-6 {
//!     simulation.advance_step(10e-6)?;
//! }
//! let energies = simulation.energies();
//! assert!(energies.elastic > 0.0);
//! assert!(energies.balance().abs() < 1e-2, "{energies:?}"); // a few dozen steps: falls with their square
//! assert!((simulation.momenta().linear - before).norm() < 1e-12 * before.norm());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod acoustic;
mod books;
mod boundary;
mod consistency;
mod constraint;
mod dissipation;
mod energy;
mod error;
mod eulerian;
mod fields;
mod force;
mod heat;
mod leapfrog;
mod lines;
mod local_steps;
mod model;
mod parallel;
mod probe;
mod profile;
mod projection;
mod reference;
mod runge_kutta;
mod save;
mod simulation;
mod state;
mod strain;
mod stress;
#[cfg(test)]
mod testing;
mod time_step;
mod viscosity;

pub use energy::{Energies, Momenta, PaperEnergies};
pub use error::{Place, SolverError};
pub use fields::{Particle, ParticleFields};
pub use model::{
    Biharmonic, Condition, ConditionKind, Formulation, Heat, Integrator, Jst, Laplacian, Model,
    ModelBody, ModelObstacle, ObstacleHeat, Quadrature, Scheme, Signal, SignalFunction,
    SmoothingReference, Stabilisation, StepLimit, Viscosity, Weights,
};
pub use probe::{EdgePart, Field, Probe, ProbeKind, Statistic};
pub use profile::{Phase, PhaseObserver};
pub use reference::{BodyReference, Reference, Shares};
pub use save::{Saved, SavedArray};
pub use simulation::Simulation;
pub use state::State;
