//! The mixed total Lagrangian SPH scheme {p, F, H, J}: time integration, stabilisation, energies.
