//! Shapes, particle lattices with exact volumes, selections and neighbour search for particle
//! methods.
//!
//! [`build_body`] fills a [`Shape`] with nodes that lie on its boundary and gives each its
//! tributary volume, its interpolation weight and, on cubic lattices, the bonds and cells between
//! nodes. [`select`] and [`face_areas`] find the nodes that boundary conditions and loads act on;
//! [`neighbours`], [`neighbours_of`] and [`NeighbourSearch`] find what lies within the support of a kernel.
//!
//! ```
//! use jstsph_geometry::{
//!     Axis, Dimension, Lattice, Selection, Shape, Spacing, build_body, neighbours, select,
//! };
//! use jstsph_tensor::Vec3;
//!
//! // The copper bar of the Taylor test: 81 nodes in each of 51 layers.
//! let bar = Shape::Cylinder { base: Vec3::zeros(), axis: Axis::Z, radius: 3.2e-3, height: 32e-3 };
//! let spacing = Spacing::Radial { per_radius: 5, layers: 51 };
//! let body = build_body(bar, Lattice::Cubic { spacing }, Dimension::Solid)?;
//! assert_eq!(body.positions.len(), 4131);
//!
//! // Volumes are exact although the lattice has a staircase for a rim.
//! let volume = body.shape.volume(body.dimension);
//! assert!((body.volumes.iter().sum::<f64>() / volume - 1.0).abs() < 1e-12);
//!
//! let bottom = select(&body, &Selection::Face("base".into()))?;
//! assert_eq!(bottom.len(), 81);
//!
//! // A node inside has 26 neighbours within two spacings of its 3 × 3 × 3 cube, and six beyond.
//! let lists = neighbours(&body.positions, 2.0 * body.spacing);
//! let middle = body.positions.iter().position(|x| (x - Vec3::new(0.0, 0.0, 16e-3)).norm() < 1e-6);
//! assert_eq!(lists.row(middle.unwrap()).len(), 26 + 6);
//! # Ok::<(), jstsph_geometry::GeometryError>(())
//! ```
//!
//! Coordinates are in metres and three-dimensional throughout; plane strain is a body in the plane
//! z = 0 whose volumes and areas are those of 1 m thickness.

mod body;
mod carved;
mod cells;
mod chords;
mod clipped;
mod contour;
mod cuboid;
mod dimension;
mod drawing;
mod error;
mod exposed;
mod face;
mod grid;
mod lattice;
mod mesh;
mod neighbours;
mod polygon;
mod rings;
mod section;
mod selection;
mod shape;
mod surface;

pub use body::{Body, Bonds, build_body};
pub use cells::{CellDefects, Cells, inverted_cells};
pub use contour::{Contour, point_of_arc};
pub use dimension::{Axis, Dimension};
pub use drawing::{DrawingFormat, DrawingOptions, read_drawing};
pub use error::GeometryError;
pub use face::{FaceArea, face_areas, face_nodes};
pub use lattice::{Lattice, Spacing};
pub use mesh::{SelfIntersection, SurfacePoint, TriangleMesh};
pub use neighbours::{Csr, NeighbourSearch, neighbours, neighbours_of};
pub use polygon::Polygon;
pub use selection::{Selection, select};
pub use shape::Shape;
pub use surface::surface_parts;

/// The example of the README, run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
