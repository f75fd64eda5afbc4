//! A body: a shape filled with particles.

use std::sync::Arc;

use jstsph_tensor::Vec3;

use crate::face::{Face, FaceArea};
use crate::{
    Cells, Dimension, GeometryError, Lattice, Shape, carved, clipped, cuboid, lattice, rings,
};

/// Particles of an undeformed body, with the volumes that belong to them.
///
/// Nodes lie on the boundary: a 1 m × 0.5 m plate with 0.05 m spacing has 21 × 11 = 231.
#[derive(Clone, Debug)]
pub struct Body {
    /// Plane strain or 3D.
    pub dimension: Dimension,
    /// The shape; in plane strain with z components set to zero.
    pub shape: Shape,
    /// Positions of the nodes, m; shared with a simulation.
    pub positions: Arc<Vec<Vec3>>,
    /// Tributary volumes, m³ (of 1 m thickness in plane strain): half a cell on a face, quarter on
    /// an edge, eighth at a corner; on rings equal parts of an annulus. They add up to the volume of the shape
    /// to round-off.
    pub volumes: Vec<f64>,
    /// Interpolation weights, m³: the volume that would belong to the node if the body went on
    /// beyond its boundary, so that the weights of a kernel sum stay those of the interior.
    /// The full cell on a cubic lattice; on rings the tributary volume, with the missing half of
    /// the outer annulus and of the end layers added. Equal to `volumes` inside.
    pub weights: Vec<f64>,
    /// Smallest distance of two nodes, m.
    pub spacing: f64,
    /// Length that smoothing lengths are measured in, m: the spacing on a lattice, the distance of the rings
    /// (or of the layers, if that is smaller) on rings.
    pub support_spacing: f64,
    /// Pairs of neighbours.
    pub bonds: Bonds,
    /// Full lattice cells, in the order of their lowest corner; between rings pairs of triangles, strip by
    /// strip outwards and layer by layer, none if the first ring has an odd number of nodes or fewer than six.
    pub cells: Cells,
    /// Whether the node lies on the boundary: it lacks a lattice neighbour (or lies on the outer
    /// ring or an end layer).
    pub boundary: Vec<bool>,
    pub(crate) faces: Vec<Face>,
    /// The surface where the faces are not all of it: bodies carved out of a lattice.
    pub(crate) surface: Option<Vec<FaceArea>>,
}

/// Bonds of a body: pairs of nearest lattice neighbours along the axes, in the order of their
/// lower node, then of the axes; on rings the sides of the triangles between them and the lines along the
/// axis. All vectors have one entry per bond; those that a simulation needs, too, are shared with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Bonds {
    /// The two nodes; the first has the smaller coordinate, on rings the smaller radius or height.
    pub ends: Arc<Vec<[u32; 2]>>,
    /// Axis along which the bond lies: 0, 1 or 2; on rings 0 outwards, 1 along a ring, 2 along the axis.
    pub directions: Vec<u8>,
    /// Volume of the part of the body that is nearest to the midpoint, m³: a quarter (plane
    /// strain) or a twelfth (3D) of every full cell at the bond, and what lies inside the shape of
    /// the cells that it clips; on rings a third of every triangle or a ninth of every prism at the bond.
    /// They add up to the volume of the shape to round-off, and on a lattice a node's tributary volume is half
    /// the sum over its bonds.
    pub volumes: Arc<Vec<f64>>,
}

impl Bonds {
    /// Midpoints, m, between the positions of the body's nodes.
    #[must_use]
    pub fn midpoints(&self, positions: &[Vec3]) -> Vec<Vec3> {
        let position = |end: u32| positions[end as usize];
        let middle = |[a, b]: [u32; 2]| (position(a) + position(b)) * 0.5;
        self.ends.iter().map(|ends| middle(*ends)).collect()
    }
}

/// Fills a shape with particles.
///
/// Node order: on a cubic lattice line by line, the axis with the fewest points fastest and the
/// one with the most slowest; on rings layer by layer, from the centre outwards, counter-clockwise.
///
/// Shapes other than boxes, discs and cylinders are carved out of the lattice of their bounding
/// box ([`Shape::bounds`]): nodes are the lattice points in the shape, so that flat faces between
/// two lattice planes have no nodes of their own; the volumes of the bonds there contain what lies
/// beyond the outermost nodes.
///
/// # Errors
/// The shape's own ([`Shape::validate`]); [`GeometryError::LatticeMismatch`],
/// [`GeometryError::SpacingDeviates`], [`GeometryError::TooFew`],
/// [`GeometryError::TooManyNodes`] or [`GeometryError::Unresolved`] when the lattice does not fit
/// the shape.
pub fn build_body(
    shape: Shape,
    lattice: Lattice,
    dimension: Dimension,
) -> Result<Body, GeometryError> {
    shape.validate(dimension)?;
    let shape = shape.flattened(dimension);
    let round = match shape {
        Shape::Box { .. }
        | Shape::Sphere { .. }
        | Shape::Polygon(_)
        | Shape::Mesh(_)
        | Shape::Union(_)
        | Shape::Intersection(_)
        | Shape::Difference(_) => None,
        Shape::Disc { centre, radius } => Some(Round::disc(centre, radius)),
        Shape::Cylinder {
            base,
            axis,
            radius,
            height,
        } => {
            let [a, b] = axis.across();
            Some(Round {
                axes: [a, b, axis.index()],
                origin: base,
                radius,
                height: Some(height),
            })
        }
    };
    match (round, lattice) {
        (None, Lattice::Cubic { spacing }) => {
            let counts = lattice::box_counts(spacing, &shape, dimension)?;
            if matches!(shape, Shape::Box { .. }) {
                Ok(cuboid::build(shape, counts, dimension))
            } else {
                carved::build(shape, counts, dimension)
            }
        }
        (None, Lattice::Rings { .. }) => Err(GeometryError::LatticeMismatch {
            lattice: "rings",
            shape: shape.name(),
            remedy: "a spacing or counts along the axes",
        }),
        (Some(round), Lattice::Cubic { spacing }) => {
            let (per_radius, layers) =
                lattice::radial_counts(spacing, &shape, round.radius, round.height)?;
            Ok(clipped::build(shape, &round, per_radius, layers))
        }
        (
            Some(round),
            Lattice::Rings {
                rings,
                per_ring,
                layers,
            },
        ) => {
            lattice::check_rings(rings, per_ring, layers, round.height)?;
            Ok(rings::build(shape, &round, rings, per_ring, layers))
        }
    }
}

/// A circle swept along an axis: what discs and cylinders have in common.
pub(crate) struct Round {
    /// Components of the two directions in the section and of the axis.
    pub(crate) axes: [usize; 3],
    /// Centre of the disc or of the bottom face.
    pub(crate) origin: Vec3,
    pub(crate) radius: f64,
    /// Length along the axis; none for a disc, whose volumes are of 1 m thickness.
    pub(crate) height: Option<f64>,
}

impl Round {
    fn disc(centre: Vec3, radius: f64) -> Self {
        Self {
            axes: [0, 1, 2],
            origin: centre,
            radius,
            height: None,
        }
    }

    pub(crate) fn dimension(&self) -> Dimension {
        match self.height {
            Some(_) => Dimension::Solid,
            None => Dimension::PlaneStrain,
        }
    }

    /// Distance of two layers, m; the 1 m thickness of a disc.
    pub(crate) fn layer_spacing(&self, layers: usize) -> f64 {
        self.height
            .map_or(1.0, |height| height / (layers - 1) as f64)
    }

    /// A vector from its components in the section and along the axis.
    pub(crate) fn vector(&self, first: f64, second: f64, along: f64) -> Vec3 {
        let mut vector = Vec3::zeros();
        vector[self.axes[0]] = first;
        vector[self.axes[1]] = second;
        vector[self.axes[2]] = along;
        vector
    }
}
