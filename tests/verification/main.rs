//! Does the scheme solve the equations? Observed orders of convergence against exact solutions.

mod axisymmetric;
mod breathing_disc;
mod conduction;
mod constitutive;
mod longitudinal_wave;
mod operators;
mod patch;
mod sliding_block;
mod swinging_cube;
mod swinging_plate;
mod time_order;
mod triangle_surfaces;
mod upsetting;
