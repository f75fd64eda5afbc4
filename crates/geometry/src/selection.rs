//! Choosing nodes of a body.

use jstsph_tensor::Vec3;

use crate::{Body, Dimension, GeometryError, face_nodes};

/// Widening of half-spaces and boxes, in spacings: a node on their boundary belongs to them
/// whatever its round-off.
const TOLERANCE: f64 = 1e-6;

/// A set of nodes, by place in the undeformed body.
#[derive(Clone, Debug, PartialEq)]
pub enum Selection {
    /// All nodes.
    All,
    /// Nodes of a face or edge, by name ([`Shape::faces`](crate::Shape::faces)).
    Face(String),
    /// Nodes on the boundary ([`Body::boundary`]).
    Boundary,
    /// Nodes on the side of a plane that the normal points to, and on the plane.
    HalfSpace {
        /// A point of the plane, m.
        point: Vec3,
        /// Direction into the half-space, of any length.
        normal: Vec3,
    },
    /// Nodes in an axis-parallel box or on its surface; z is ignored in plane strain.
    Box {
        /// Smallest coordinates, m.
        min: Vec3,
        /// Largest coordinates, m.
        max: Vec3,
    },
    /// Nodes in every one of the selections; all nodes if there are none.
    And(Vec<Selection>),
    /// Nodes in any of the selections.
    Or(Vec<Selection>),
    /// Nodes that are not in the selection.
    Not(Box<Selection>),
}

/// The selected nodes, ascending. An empty result is no error here.
///
/// Half-spaces and boxes reach 1e-6 spacings further than stated.
///
/// # Errors
/// [`GeometryError::UnknownFace`], [`GeometryError::NoDirection`].
pub fn select(body: &Body, selection: &Selection) -> Result<Vec<u32>, GeometryError> {
    let chosen = mask(body, selection)?;
    Ok((0..chosen.len() as u32)
        .filter(|&node| chosen[node as usize])
        .collect())
}

fn mask(body: &Body, selection: &Selection) -> Result<Vec<bool>, GeometryError> {
    let tolerance = TOLERANCE * body.spacing;
    let nodes = body.positions.len();
    let by_position = |test: &dyn Fn(&Vec3) -> bool| Ok(body.positions.iter().map(test).collect());
    match selection {
        Selection::All => Ok(vec![true; nodes]),
        Selection::Boundary => Ok(body.boundary.clone()),
        Selection::Face(face) => {
            let mut chosen = vec![false; nodes];
            for node in face_nodes(body, face)? {
                chosen[node as usize] = true;
            }
            Ok(chosen)
        }
        Selection::HalfSpace { point, normal } => {
            let length = normal.norm();
            if !(length > 0.0 && length.is_finite()) {
                return Err(GeometryError::NoDirection {
                    x: normal.x,
                    y: normal.y,
                    z: normal.z,
                });
            }
            let normal = normal / length;
            by_position(&|x| (x - point).dot(&normal) >= -tolerance)
        }
        Selection::Box { min, max } => {
            let axes = match body.dimension {
                Dimension::PlaneStrain => 0..2,
                Dimension::Solid => 0..3,
            };
            by_position(&|x| {
                axes.clone()
                    .all(|i| x[i] >= min[i] - tolerance && x[i] <= max[i] + tolerance)
            })
        }
        Selection::And(parts) => combine(body, parts, true, |a, b| a && b),
        Selection::Or(parts) => combine(body, parts, false, |a, b| a || b),
        Selection::Not(part) => Ok(mask(body, part)?
            .into_iter()
            .map(|chosen| !chosen)
            .collect()),
    }
}

fn combine(
    body: &Body,
    parts: &[Selection],
    start: bool,
    join: fn(bool, bool) -> bool,
) -> Result<Vec<bool>, GeometryError> {
    let mut chosen = vec![start; body.positions.len()];
    for part in parts {
        for (node, other) in mask(body, part)?.into_iter().enumerate() {
            chosen[node] = join(chosen[node], other);
        }
    }
    Ok(chosen)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Lattice, Shape, Spacing, build_body};

    fn plate() -> Body {
        let shape = Shape::Box {
            min: Vec3::zeros(),
            max: Vec3::new(1.0, 0.5, 0.0),
        };
        let spacing = Spacing::Counts([21, 11, 1]);
        build_body(shape, Lattice::Cubic { spacing }, Dimension::PlaneStrain).unwrap()
    }

    fn count(selection: &Selection) -> usize {
        select(&plate(), selection).unwrap().len()
    }

    #[test]
    fn half_of_the_top_includes_its_middle() {
        let right = Selection::HalfSpace {
            point: Vec3::new(0.5, 0.0, 0.0),
            normal: Vec3::new(3.0, 0.0, 0.0),
        };
        assert_eq!(count(&right), 11 * 11);
        let top = Selection::Face("top".into());
        assert_eq!(count(&Selection::And(vec![right, top])), 11);
    }

    #[test]
    fn combinations_follow_set_algebra() {
        let face = |name: &str| Selection::Face(name.into());
        let sides = ["left", "right", "bottom", "top"].map(face).to_vec();
        assert_eq!(count(&Selection::Boundary), 2 * (21 + 11) - 4);
        assert_eq!(
            select(&plate(), &Selection::Or(sides)).unwrap(),
            select(&plate(), &Selection::Boundary).unwrap()
        );
        let inner = Selection::Not(Box::new(Selection::Boundary));
        assert_eq!(count(&inner), 19 * 9);
        assert_eq!(count(&Selection::And(vec![])), 231);
        assert_eq!(count(&Selection::Or(vec![])), 0);
    }

    #[test]
    fn box_surfaces_belong_to_the_box() {
        let corner = Selection::Box {
            min: Vec3::new(0.8, 0.4, 7.0),
            max: Vec3::new(2.0, 0.45, 7.0),
        };
        assert_eq!(count(&corner), 5 * 2);
    }

    #[test]
    fn mistakes_are_named() {
        let error = select(&plate(), &Selection::Face("lid".into())).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a box has no face \"lid\"; its faces are left, right, bottom, top"
        );
        let flat = Selection::HalfSpace {
            point: Vec3::zeros(),
            normal: Vec3::zeros(),
        };
        assert!(matches!(
            select(&plate(), &flat),
            Err(GeometryError::NoDirection { .. })
        ));
    }
}
