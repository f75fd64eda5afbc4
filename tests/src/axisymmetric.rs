//! Finite elements for a body of revolution: an answer to the Taylor bar that shares no code with the solver.
//!
//! [`Mesh`] is the section of a cylinder, [`Metal`] the material, [`Body`] the elements, [`Impact`] the
//! motion, [`Shape`] what is measured, [`TaylorBar`] the two bars of the shipped cases. Nothing here uses a crate of the workspace: the return map, the
//! quadrature, the wall and the books of energy are written a second time on purpose.

mod body;
mod impact;
mod lanes;
mod material;
mod mesh;
mod shape;
mod taylor;

pub use body::{Body, Inverted, Stored};
pub use impact::{Base, Energies, Impact};
pub use lanes::Lanes;
pub use material::{Metal, Response, Symmetric};
pub use mesh::Mesh;
pub use shape::{Shape, outline_radius};
pub use taylor::{TaylorBar, TaylorRow};
