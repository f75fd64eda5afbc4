//! Kernels and corrected total Lagrangian SPH operators between particles and evaluation points.
