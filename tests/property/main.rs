//! What must hold whatever the resolution: conservation, symmetry, invariance, determinism.

mod conservation;
mod determinism;
mod displacement;
mod energy_balance;
mod heat;
mod invariance;
mod orientation;
mod tumbling;
