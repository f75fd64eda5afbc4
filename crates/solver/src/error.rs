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
    /// The model is inconsistent in itself.
    #[error("{what}")]
    Inconsistent {
        /// What does not fit.
        what: String,
    },
    /// A material point left the range of the constitutive model.
    #[error("{place} failed: {source}; reduce time.cfl (now {cfl}), or add stabilisation")]
    Constitutive {
        /// Where and when.
        place: Box<Place>,
        /// CFL number in use.
        cfl: f64,
        /// Cause.
        source: MaterialError,
    },
    /// A quantity is no longer a number; the position is the reference one, the current one is lost.
    #[error(
        "{place}: the {quantity} is not finite; reduce time.cfl (now {cfl}), or add stabilisation"
    )]
    NotFinite {
        /// Quantity.
        quantity: &'static str,
        /// Where and when.
        place: Box<Place>,
        /// CFL number in use.
        cfl: f64,
    },
    /// The stable time step has become too small to go on.
    #[error(
        "the time step fell to {time_step:.3e} s, below {limit:.3e} s (time.smallest_step): {place} is compressed to a \
         stretch of {stretch:.2e}; refine the lattice there or lower time.smallest_step"
    )]
    TimeStepTooSmall {
        /// Where and when.
        place: Box<Place>,
        /// Stable time step, s.
        time_step: f64,
        /// Floor, s.
        limit: f64,
        /// Smallest principal stretch there.
        stretch: f64,
    },
    /// A temperature at which a property of the material is not defined.
    #[error(
        "{place}: the temperature is {temperature:.6} K, but the {property} of its material is given from {low} K to {high:.6e} K"
    )]
    Temperature {
        /// Where and when.
        place: Box<Place>,
        /// Temperature, K.
        temperature: f64,
        /// Property.
        property: &'static str,
        /// Lowest temperature of the property, K.
        low: f64,
        /// Highest temperature of the property, K.
        high: f64,
    },
    /// A saved state does not belong to this model.
    #[error("the saved state does not fit this case: {what}")]
    ForeignState {
        /// What does not fit.
        what: String,
    },
}

/// Where and when a run went wrong.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// `particle` or `bond`.
    pub what: &'static str,
    /// Its index in the body.
    pub index: usize,
    /// Body.
    pub body: String,
    /// Position, m.
    pub position: [f64; 3],
    /// Time, s.
    pub time: f64,
    /// Step.
    pub step: u64,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y, z] = self.position;
        write!(
            f,
            "{} {} of body \"{}\" at ({x:.6e}, {y:.6e}, {z:.6e}) m, t = {:.6e} s (step {})",
            self.what, self.index, self.body, self.time, self.step
        )
    }
}
