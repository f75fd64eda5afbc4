//! Shared helpers of the verification, property and validation tests.
//!
//! [`setup`] builds models in code, [`exact`] compares a run with an exact solution, [`saved`]
//! reads what only a saved state shows, [`study`] turns errors over resolutions into observed
//! orders and asserts them. [`axisymmetric`] is an independent finite-element program.

pub mod axisymmetric;
pub mod exact;
pub mod saved;
pub mod setup;
pub mod study;

pub use study::{Study, observed_order};
