//! The jstsph command: run, check and inspect total Lagrangian SPH simulations of metals.
