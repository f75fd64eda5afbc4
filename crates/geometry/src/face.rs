//! Faces of a body: their nodes and tributary areas.

use jstsph_tensor::Vec3;

use crate::{Body, GeometryError};

/// Part of a face that belongs to one node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceArea {
    /// The node.
    pub node: u32,
    /// Its tributary area in the undeformed body, m² (of 1 m thickness in plane strain).
    pub area: f64,
    /// Outward unit normal; on a curved face the one in the middle of the tributary area.
    pub normal: Vec3,
    /// Point of the face where it acts, m: the node itself where that lies on the face; on the side
    /// of a round body cut out of a cubic lattice the middle of the tributary arc at its height.
    pub point: Vec3,
}

/// A named face or edge, filled in when the body is built.
#[derive(Clone, Debug)]
pub(crate) struct Face {
    pub(crate) name: &'static str,
    pub(crate) kind: FaceKind,
}

/// What a face has besides its nodes; nodes ascend in both.
#[derive(Clone, Debug)]
pub(crate) enum FaceKind {
    Surface(Vec<FaceArea>),
    Edge {
        nodes: Vec<u32>,
        /// A surface that ends in this edge.
        instead: &'static str,
    },
}

/// Nodes on a face or edge, ascending. [`Shape::faces`](crate::Shape::faces) lists the names.
///
/// In a round body cut out of a cubic lattice, the side (or rim of a disc) has all nodes of the
/// staircase, i.e. those that lack a neighbour in the section; some lie almost a spacing inside
/// of the circle. The edges rim_base and rim_top have only the nodes on the circle itself (at
/// least four), so that they measure the radius.
///
/// # Errors
/// [`GeometryError::UnknownFace`].
pub fn face_nodes(body: &Body, face: &str) -> Result<Vec<u32>, GeometryError> {
    Ok(match find(body, face)? {
        FaceKind::Surface(areas) => areas.iter().map(|part| part.node).collect(),
        FaceKind::Edge { nodes, .. } => nodes.clone(),
    })
}

/// Tributary areas and outward normals of the nodes on a face, nodes ascending.
///
/// The areas add up to the exact area of the face (πr² for the end of a cylinder, not that of its
/// staircase).
///
/// # Errors
/// [`GeometryError::UnknownFace`], or [`GeometryError::FaceWithoutArea`] for an edge.
pub fn face_areas(body: &Body, face: &str) -> Result<Vec<FaceArea>, GeometryError> {
    match find(body, face)? {
        FaceKind::Surface(areas) => Ok(areas.clone()),
        FaceKind::Edge { instead, .. } => Err(GeometryError::FaceWithoutArea {
            face: face.to_owned(),
            instead,
        }),
    }
}

fn find<'a>(body: &'a Body, face: &str) -> Result<&'a FaceKind, GeometryError> {
    match body.faces.iter().find(|known| known.name == face) {
        Some(found) => Ok(&found.kind),
        None => Err(GeometryError::UnknownFace {
            face: face.to_owned(),
            shape: body.shape.name(),
            available: body.shape.faces(body.dimension),
        }),
    }
}
