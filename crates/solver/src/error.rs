//! Why a simulation could not be set up or went wrong.

use jstsph_material::{MaterialError, ParameterError};
use jstsph_sph::SphError;

/// Errors of the solver. A run that fails leaves the simulation in its last complete state.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SolverError {
    /// The neighbours of a particle or bond do not determine gradients.
    #[error("body \"{body}\": {source}")]
    Operator {
        /// Body.
        body: String,
        /// Cause.
        source: SphError,
    },
    /// A material parameter is outside its range.
    #[error("material of body \"{body}\": {source}")]
    Material {
        /// Body.
        body: String,
        /// Cause.
        source: ParameterError,
    },
    /// Bond quadrature needs lattice bonds.
    #[error(
        "body \"{body}\" has no lattice bonds, which quadrature = \"bonds\" needs; use a cubic lattice or quadrature = \"particles\""
    )]
    NoBonds {
        /// Body.
        body: String,
    },
    /// The model is inconsistent in itself.
    #[error("{what}")]
    Inconsistent {
        /// What does not fit.
        what: String,
    },
    /// A material point left the range of the constitutive model.
    #[error(
        "{what} {index} of body \"{body}\" at ({:.6e}, {:.6e}, {:.6e}) m failed at t = {time:.6e} s (step {step}): {source}; \
         reduce time.cfl (now {cfl}), or add stabilisation",
        position[0], position[1], position[2]
    )]
    Constitutive {
        /// `particle` or `bond`.
        what: &'static str,
        /// Its index in the body.
        index: usize,
        /// Body.
        body: String,
        /// Current position, m.
        position: [f64; 3],
        /// Time, s.
        time: f64,
        /// Step.
        step: u64,
        /// CFL number in use.
        cfl: f64,
        /// Cause.
        source: MaterialError,
    },
    /// A quantity is no longer a number.
    #[error(
        "{quantity} of {what} {index} of body \"{body}\" at ({:.6e}, {:.6e}, {:.6e}) m is not finite at t = {time:.6e} s (step {step}); \
         reduce time.cfl (now {cfl}), or add stabilisation",
        position[0], position[1], position[2]
    )]
    NotFinite {
        /// Quantity.
        quantity: &'static str,
        /// `particle` or `bond`.
        what: &'static str,
        /// Its index in the body.
        index: usize,
        /// Body.
        body: String,
        /// Reference position where the current one is lost, m.
        position: [f64; 3],
        /// Time, s.
        time: f64,
        /// Step.
        step: u64,
        /// CFL number in use.
        cfl: f64,
    },
    /// The stable time step has become too small to go on.
    #[error(
        "the time step fell to {time_step:.3e} s, below {limit:.3e} s (time.smallest_step), at t = {time:.6e} s (step {step}): \
         {what} {index} of body \"{body}\" at ({:.6e}, {:.6e}, {:.6e}) m is compressed to a stretch of {stretch:.2e}; \
         refine the lattice there or lower time.smallest_step",
        position[0], position[1], position[2]
    )]
    TimeStepTooSmall {
        /// Stable time step, s.
        time_step: f64,
        /// Floor, s.
        limit: f64,
        /// Time, s.
        time: f64,
        /// Step.
        step: u64,
        /// `particle` or `bond`.
        what: &'static str,
        /// Its index in the body.
        index: usize,
        /// Body.
        body: String,
        /// Position, m.
        position: [f64; 3],
        /// Smallest principal stretch there.
        stretch: f64,
    },
    /// A saved state does not belong to this model.
    #[error("the saved state does not fit this case: {what}")]
    ForeignState {
        /// What does not fit.
        what: String,
    },
}
