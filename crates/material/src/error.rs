//! What can be wrong with a parameter set and with one evaluation.

use crate::Range;

/// A material parameter that no computation could use.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// A number outside the range its key allows, or not finite.
    #[error("{key} = {value} is out of range: it must be {range}")]
    OutOfRange {
        /// Dotted path of the key inside the model's table, e.g. `hardening.swift.exponent`.
        key: String,
        /// The value found, in the key's SI unit.
        value: f64,
        /// What the key allows.
        range: Range,
    },
    /// Two columns of a table that must have one entry per row each.
    #[error(
        "{key} has {found} entries and {other} has {expected}: give one of each per point, at least {least}"
    )]
    Length {
        /// Dotted path of the column.
        key: String,
        /// Its number of entries.
        found: usize,
        /// The column it is compared with.
        other: &'static str,
        /// Number of entries of the other column.
        expected: usize,
        /// Fewest entries that make sense.
        least: usize,
    },
    /// A value too small beside another parameter, or beside the entry before it in a list.
    #[error("{key} = {value} must be {relation} {bound}: {reason}")]
    Order {
        /// Dotted path of the key.
        key: String,
        /// The value found, in the key's SI unit.
        value: f64,
        /// `greater than` or `at least`.
        relation: &'static str,
        /// The value it is compared with, in the same unit.
        bound: f64,
        /// Why, or what the bound is.
        reason: &'static str,
    },
    /// A key that makes no sense without another, or with what another says.
    #[error("{key} needs {what}")]
    Needs {
        /// Dotted path of the key.
        key: String,
        /// What it needs.
        what: &'static str,
    },
}

impl ParameterError {
    /// Dotted path of the offending key inside the model's table.
    #[must_use]
    pub fn key(&self) -> &str {
        match self {
            Self::OutOfRange { key, .. }
            | Self::Length { key, .. }
            | Self::Order { key, .. }
            | Self::Needs { key, .. } => key,
        }
    }

    /// The same error with the key placed inside the table `prefix`.
    #[must_use]
    pub(crate) fn within(mut self, prefix: &str) -> Self {
        let (Self::OutOfRange { key, .. }
        | Self::Length { key, .. }
        | Self::Order { key, .. }
        | Self::Needs { key, .. }) = &mut self;
        *key = format!("{prefix}.{key}");
        self
    }
}

/// A point whose stress cannot be evaluated. The caller adds which point, where and when.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MaterialError {
    /// The deformation maps a volume to nothing or turns it inside out.
    #[error(
        "inverted: J = {jacobian}, det F = {determinant}, both must be positive; reduce the time step"
    )]
    Inverted {
        /// The independent Jacobian J.
        jacobian: f64,
        /// det F.
        determinant: f64,
    },
    /// A kinematic quantity, or the stress that follows from it, is infinite or not a number.
    #[error("not finite: J = {jacobian}, det F = {determinant}; reduce the time step")]
    NotFinite {
        /// The independent Jacobian J.
        jacobian: f64,
        /// det F.
        determinant: f64,
    },
    /// Compression beyond what the equation of state describes.
    #[error(
        "compressed to J = {jacobian}, below {limit}, the end of the equation of state; reduce the time step"
    )]
    Compressed {
        /// The independent Jacobian J.
        jacobian: f64,
        /// Smallest J of the equation of state.
        limit: f64,
    },
    /// The plastic return did not reach the yield surface.
    #[error(
        "plastic return failed: residual {residual} Pa after {iterations} iterations, allowed {tolerance} Pa; \
         reduce the time step"
    )]
    ReturnMap {
        /// τ_eq − 3 μ Δε_p − J σ_Y at the last iterate, Pa.
        residual: f64,
        /// The largest residual that would have been accepted, Pa.
        tolerance: f64,
        /// Iterations made.
        iterations: usize,
    },
}
