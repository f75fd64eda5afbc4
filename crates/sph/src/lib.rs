//! Kernels and corrected total Lagrangian SPH operators between particles and evaluation points.
//!
//! Everything here is determined by the reference configuration and computed once: no physics, no
//! field names. A [`GradientOperator`] is the rectangular sparse matrix B that maps values at
//! particles to gradients at evaluation points; with [`GradientOperator::at_particles`] the points
//! are the particles (the paper's scheme), with [`GradientOperator::at_points`] they are the
//! midpoints of lattice bonds. A [`PairOperator`] holds the symmetric pair weights of the
//! Laplacian, on which dissipation and hourglass control are built.
//!
//! ```
//! use jstsph_sph::{GradientOperator, Kernel, Support};
//! use jstsph_tensor::{Mat3, Vec3};
//!
//! // A linear field on a small plane lattice: its gradient is exact up to the boundary.
//! let positions: Vec<Vec3> =
//!     (0..25).map(|i| Vec3::new((i % 5) as f64 * 0.1, (i / 5) as f64 * 0.1, 0.0)).collect();
//! let support = Support { kernel: Kernel::QuinticSpline, smoothing_length: 0.12, dimension: 2 };
//! let operator = GradientOperator::at_particles(&positions, &vec![0.01; 25], &support)?;
//! let field: Vec<Vec3> = positions.iter().map(|x| Vec3::new(2.0 * x.x - x.y, 3.0 * x.y, 0.0)).collect();
//! let expected = Mat3::new(2.0, -1.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0);
//! assert!((operator.gradient_at(0, &field) - expected).norm() < 1e-12);
//! # Ok::<(), jstsph_sph::SphError>(())
//! ```

mod gradient;
mod interpolation;
mod jumps;
mod kernel;
mod lines;
mod pairs;
mod rows;
#[cfg(test)]
mod testing;

pub use gradient::{Correction, GradientOperator, Support};
pub use interpolation::interpolate;
pub use jumps::JumpOperator;
pub use kernel::Kernel;
pub use lines::{LaneRow, LineOperator, Lines};
pub use pairs::PairOperator;
pub use rows::Row;

/// Why an operator could not be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SphError {
    /// The neighbours of a point do not span the space, so that no linear field is reproduced.
    #[error(
        "{what} {index} at ({:.6e}, {:.6e}, {:.6e}) m has {neighbours} particles within its support radius {radius:.4e} m, \
         which do not determine a gradient (condition number {condition:.1e}, limit {limit:.1e}); increase the smoothing ratio",
        position[0], position[1], position[2]
    )]
    TooFewNeighbours {
        /// `particle` or `evaluation point`.
        what: &'static str,
        /// Its index.
        index: usize,
        /// Its reference position, m.
        position: [f64; 3],
        /// Particles found.
        neighbours: usize,
        /// Support radius 2h, m.
        radius: f64,
        /// Condition number of the moment matrix; infinite when singular.
        condition: f64,
        /// Largest accepted condition number.
        limit: f64,
    },
    /// Offsets are 32-bit.
    #[error(
        "{entries} neighbour entries exceed the limit of {limit}; use fewer particles or a smaller smoothing ratio"
    )]
    TooManyEntries {
        /// Entries needed.
        entries: usize,
        /// Entries possible.
        limit: usize,
    },
}
