//! The solids that a body can be cut from.

use std::f64::consts::PI;
use std::sync::Arc;

use jstsph_tensor::Vec3;

use crate::chords;
use crate::{Axis, Dimension, GeometryError, Polygon, TriangleMesh};

/// A solid in its undeformed position; all lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Axis-parallel box; a rectangle in plane strain, where the z components are ignored.
    Box {
        /// Smallest coordinates.
        min: Vec3,
        /// Largest coordinates.
        max: Vec3,
    },
    /// Circular disc in the plane z = 0; plane strain only.
    Disc {
        /// Centre; its z component is ignored.
        centre: Vec3,
        /// Radius.
        radius: f64,
    },
    /// Right circular cylinder; three dimensions only.
    Cylinder {
        /// Centre of the bottom face.
        base: Vec3,
        /// Direction from the bottom to the top face.
        axis: Axis,
        /// Radius.
        radius: f64,
        /// Distance of the end faces.
        height: f64,
    },
    /// Sphere; three dimensions only.
    Sphere {
        /// Centre.
        centre: Vec3,
        /// Radius.
        radius: f64,
    },
    /// Polygon (plane strain) or the prism over one (three dimensions).
    Polygon(Polygon),
    /// What a closed surface of triangles encloses; three dimensions only.
    Mesh(Arc<TriangleMesh>),
    /// What lies in any of the parts.
    Union(Vec<Shape>),
    /// What lies in every part.
    Intersection(Vec<Shape>),
    /// What lies in the first part and in none of the others.
    Difference(Vec<Shape>),
}

/// Faces of shapes without faces of their own: those on the bounding box, and everything on the
/// surface that faces one way.
const PLANE_FACES: [&[&str]; 2] = [
    &[
        "left",
        "right",
        "bottom",
        "top",
        "facing_left",
        "facing_right",
        "facing_bottom",
        "facing_top",
    ],
    &[
        "left",
        "right",
        "front",
        "back",
        "bottom",
        "top",
        "facing_left",
        "facing_right",
        "facing_front",
        "facing_back",
        "facing_bottom",
        "facing_top",
    ],
];

/// Names of the axes as they stand in messages.
const SIZES: [&str; 3] = ["size along x", "size along y", "size along z"];

impl Shape {
    /// The word for this shape in case files and messages.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Box { .. } => "box",
            Self::Disc { .. } => "disc",
            Self::Cylinder { .. } => "cylinder",
            Self::Sphere { .. } => "sphere",
            Self::Polygon(_) => "polygon",
            Self::Mesh(_) => "triangle mesh",
            Self::Union(_) => "union",
            Self::Intersection(_) => "intersection",
            Self::Difference(_) => "difference",
        }
    }

    /// Names of the faces (and of the edges that can be selected).
    ///
    /// * box, plane strain: left −x, right +x, bottom −y, top +y;
    /// * box, 3D: left −x, right +x, front −y, back +y, bottom −z, top +z;
    /// * disc: rim;
    /// * cylinder: base, top, side, and the edges rim_base and rim_top, which have no area;
    /// * all others: the names of the box for what lies on that side of the bounding box, and
    ///   facing_left, facing_right ... for all of the surface that faces this way.
    #[must_use]
    pub const fn faces(&self, dimension: Dimension) -> &'static [&'static str] {
        match (self, dimension) {
            (Self::Box { .. }, Dimension::PlaneStrain) => &["left", "right", "bottom", "top"],
            (Self::Box { .. }, Dimension::Solid) => {
                &["left", "right", "front", "back", "bottom", "top"]
            }
            (Self::Disc { .. }, _) => &["rim"],
            (Self::Cylinder { .. }, _) => &["base", "top", "side", "rim_base", "rim_top"],
            (_, Dimension::PlaneStrain) => PLANE_FACES[0],
            (_, Dimension::Solid) => PLANE_FACES[1],
        }
    }

    /// Volume, m³ (of 1 m thickness in plane strain).
    ///
    /// Exact to round-off but for unions, intersections and differences with round parts, which are
    /// integrated numerically to a few 1e-6.
    #[must_use]
    pub fn volume(&self, dimension: Dimension) -> f64 {
        match self {
            Self::Box { min, max } => {
                let size = max - min;
                match dimension {
                    Dimension::PlaneStrain => size.x * size.y,
                    Dimension::Solid => size.x * size.y * size.z,
                }
            }
            Self::Disc { radius, .. } => PI * radius * radius,
            Self::Cylinder { radius, height, .. } => PI * radius * radius * height,
            Self::Sphere { radius, .. } => 4.0 / 3.0 * PI * radius.powi(3),
            Self::Polygon(polygon) => {
                let height = polygon.extrusion().map_or(1.0, |[low, high]| high - low);
                polygon.area() * height
            }
            Self::Mesh(mesh) => mesh.volume(),
            Self::Union(_) | Self::Intersection(_) | Self::Difference(_) => {
                chords::volume(self, dimension)
            }
        }
    }

    /// Corners of an axis-parallel box around the shape, m: the smallest one for all but
    /// intersections (the common part of the boxes) and differences (the box of the first part).
    #[must_use]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        match self {
            Self::Box { min, max } => (*min, *max),
            Self::Disc { centre, radius } => {
                let extent = Vec3::new(*radius, *radius, 0.0);
                (centre - extent, centre + extent)
            }
            Self::Cylinder {
                base,
                axis,
                radius,
                height,
            } => {
                let (mut low, mut high) = (base.add_scalar(-radius), base.add_scalar(*radius));
                low[axis.index()] = base[axis.index()];
                high[axis.index()] = base[axis.index()] + height;
                (low, high)
            }
            Self::Sphere { centre, radius } => {
                (centre.add_scalar(-radius), centre.add_scalar(*radius))
            }
            Self::Polygon(polygon) => polygon.bounds(),
            Self::Mesh(mesh) => mesh.bounds(),
            Self::Union(parts) => join(parts, |(low, high), (other_low, other_high)| {
                (low.inf(&other_low), high.sup(&other_high))
            }),
            Self::Intersection(parts) => join(parts, |(low, high), (other_low, other_high)| {
                (low.sup(&other_low), high.inf(&other_high))
            }),
            Self::Difference(parts) => join(&parts[..parts.len().min(1)], |bounds, _| bounds),
        }
    }

    /// Distance of `x` from the surface, m; negative inside.
    ///
    /// Discs, polygons without an extrusion, and boxes without extent along z are unbounded along
    /// z. The sign is right for all shapes; for unions, intersections and differences the size is a
    /// lower bound of the Euclidean distance.
    #[must_use]
    pub fn signed_distance(&self, x: &Vec3) -> f64 {
        match self {
            Self::Box { min, max } => {
                let beyond = (x - (min + max) * 0.5).abs() - (max - min) * 0.5;
                if max.z > min.z {
                    outside_distance(&[beyond.x, beyond.y, beyond.z])
                } else {
                    outside_distance(&[beyond.x, beyond.y])
                }
            }
            Self::Disc { centre, radius } => (x - centre).xy().norm() - radius,
            Self::Cylinder {
                base,
                axis,
                radius,
                height,
            } => {
                let offset = x - base;
                let [a, b] = axis.across();
                let along = (offset[axis.index()] - 0.5 * height).abs() - 0.5 * height;
                outside_distance(&[offset[a].hypot(offset[b]) - radius, along])
            }
            Self::Sphere { centre, radius } => (x - centre).norm() - radius,
            Self::Polygon(polygon) => {
                let planar = polygon.planar_distance(x);
                match polygon.extrusion() {
                    None => planar,
                    Some([low, high]) => outside_distance(&[
                        planar,
                        (x.z - 0.5 * (low + high)).abs() - 0.5 * (high - low),
                    ]),
                }
            }
            Self::Mesh(mesh) => mesh.nearest(x).distance,
            Self::Union(parts) => parts
                .iter()
                .map(|part| part.signed_distance(x))
                .fold(f64::INFINITY, f64::min),
            Self::Intersection(parts) => parts
                .iter()
                .map(|part| part.signed_distance(x))
                .fold(f64::NEG_INFINITY, f64::max),
            Self::Difference(parts) => parts
                .iter()
                .enumerate()
                .map(|(number, part)| {
                    let distance = part.signed_distance(x);
                    if number == 0 { distance } else { -distance }
                })
                .fold(f64::NEG_INFINITY, f64::max),
        }
    }

    /// Checks that the shape exists in this dimension and has a finite, positive extent.
    ///
    /// # Errors
    /// [`GeometryError::WrongDimension`], [`GeometryError::NotFinite`],
    /// [`GeometryError::NotPositive`] or [`GeometryError::TooFew`] parts of a combination.
    pub fn validate(&self, dimension: Dimension) -> Result<(), GeometryError> {
        let item = self.name();
        let wrong = |remedy| {
            Err(GeometryError::WrongDimension {
                shape: item,
                dimension,
                remedy,
            })
        };
        match (self, dimension) {
            (Self::Disc { .. }, Dimension::Solid) => return wrong("a cylinder"),
            (Self::Cylinder { .. }, Dimension::PlaneStrain) => return wrong("a disc or a box"),
            (Self::Sphere { .. }, Dimension::PlaneStrain) => return wrong("a disc"),
            (Self::Mesh(_), Dimension::PlaneStrain) => return wrong("a polygon"),
            (Self::Polygon(polygon), Dimension::Solid) if polygon.extrusion().is_none() => {
                return wrong("a polygon with an extrusion along z");
            }
            (Self::Polygon(polygon), Dimension::PlaneStrain) if polygon.extrusion().is_some() => {
                return wrong("a polygon without an extrusion");
            }
            _ => {}
        }
        let coordinates = |quantity, point: &Vec3| {
            point
                .iter()
                .take(dimension.count())
                .try_for_each(|&value| finite(item, quantity, value))
        };
        match self {
            Self::Box { min, max } => {
                coordinates("min", min)?;
                coordinates("max", max)?;
                (0..dimension.count()).try_for_each(|i| positive(item, SIZES[i], max[i] - min[i]))
            }
            Self::Disc { centre, radius } => {
                coordinates("centre", centre)?;
                positive(item, "radius", *radius)
            }
            Self::Cylinder {
                base,
                radius,
                height,
                ..
            } => {
                coordinates("base", base)?;
                positive(item, "radius", *radius)?;
                positive(item, "height", *height)
            }
            Self::Sphere { centre, radius } => {
                coordinates("centre", centre)?;
                positive(item, "radius", *radius)
            }
            // Checked when it was built.
            Self::Polygon(_) | Self::Mesh(_) => Ok(()),
            Self::Union(parts) | Self::Intersection(parts) | Self::Difference(parts) => {
                if parts.len() < 2 {
                    return Err(GeometryError::TooFew {
                        quantity: "number of shapes to combine",
                        value: parts.len(),
                        minimum: 2,
                    });
                }
                parts.iter().try_for_each(|part| part.validate(dimension))?;
                let (low, high) = self.bounds();
                (0..dimension.count()).try_for_each(|i| positive(item, SIZES[i], high[i] - low[i]))
            }
        }
    }

    /// The same shape with the components that plane strain ignores set to zero.
    pub(crate) fn flattened(&self, dimension: Dimension) -> Self {
        let mut shape = self.clone();
        if dimension == Dimension::PlaneStrain {
            match &mut shape {
                Self::Box { min, max } => (min.z, max.z) = (0.0, 0.0),
                Self::Disc { centre, .. } => centre.z = 0.0,
                Self::Union(parts) | Self::Intersection(parts) | Self::Difference(parts) => {
                    for part in parts {
                        *part = part.flattened(dimension);
                    }
                }
                Self::Cylinder { .. } | Self::Sphere { .. } | Self::Polygon(_) | Self::Mesh(_) => {}
            }
        }
        shape
    }
}

/// Bounds of the parts joined one after the other.
fn join(
    parts: &[Shape],
    joined: impl Fn((Vec3, Vec3), (Vec3, Vec3)) -> (Vec3, Vec3),
) -> (Vec3, Vec3) {
    let bounds = parts.iter().map(Shape::bounds).reduce(joined);
    bounds.unwrap_or((Vec3::zeros(), Vec3::zeros()))
}

/// Signed distance of a product of intervals from the amounts by which each is exceeded.
fn outside_distance(beyond: &[f64]) -> f64 {
    let outside = beyond.iter().map(|d| d.max(0.0).powi(2)).sum::<f64>();
    let inside = beyond.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    outside.sqrt() + inside.min(0.0)
}

fn finite(item: &'static str, quantity: &'static str, value: f64) -> Result<(), GeometryError> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(GeometryError::NotFinite {
            item,
            quantity,
            value,
        })
    }
}

/// Refuses lengths that are not finite and positive.
pub(crate) fn positive(
    item: &'static str,
    quantity: &'static str,
    value: f64,
) -> Result<(), GeometryError> {
    finite(item, quantity, value)?;
    if value > 0.0 {
        Ok(())
    } else {
        Err(GeometryError::NotPositive {
            item,
            quantity,
            value,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cylinder() -> Shape {
        Shape::Cylinder {
            base: Vec3::new(1.0, 0.0, 0.0),
            axis: Axis::X,
            radius: 2.0,
            height: 10.0,
        }
    }

    #[test]
    fn signed_distance_is_negative_inside_and_euclidean_outside() {
        let cube = Shape::Box {
            min: Vec3::zeros(),
            max: Vec3::new(2.0, 4.0, 6.0),
        };
        assert_eq!(cube.signed_distance(&Vec3::new(1.0, 2.0, 2.5)), -1.0);
        assert_eq!(cube.signed_distance(&Vec3::new(5.0, 8.0, 3.0)), 5.0);
        // Inside in the plane, deepest along y: a rectangle ignores z.
        let rectangle = cube.flattened(Dimension::PlaneStrain);
        assert_eq!(rectangle.signed_distance(&Vec3::new(1.0, 0.5, 9.0)), -0.5);

        let bar = cylinder();
        assert_eq!(bar.signed_distance(&Vec3::new(6.0, 0.0, 0.0)), -2.0);
        assert_eq!(bar.signed_distance(&Vec3::new(1.5, 0.0, 1.0)), -0.5);
        // Beyond the end by 3 and outside the radius (5 from the axis) by 3.
        let corner = bar.signed_distance(&Vec3::new(14.0, 3.0, 4.0));
        assert!((corner - 18.0_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn bounds_touch_the_surface() {
        let (low, high) = cylinder().bounds();
        assert_eq!(low, Vec3::new(1.0, -2.0, -2.0));
        assert_eq!(high, Vec3::new(11.0, 2.0, 2.0));
    }

    #[test]
    fn bad_shapes_are_refused_with_their_value() {
        let flat = Shape::Box {
            min: Vec3::zeros(),
            max: Vec3::new(1.0, 0.0, 0.0),
        };
        assert_eq!(
            flat.validate(Dimension::PlaneStrain)
                .unwrap_err()
                .to_string(),
            "size along y of the box is 0 m; it must be positive"
        );
        let disc = Shape::Disc {
            centre: Vec3::zeros(),
            radius: f64::NAN,
        };
        assert!(matches!(
            disc.validate(Dimension::PlaneStrain),
            Err(GeometryError::NotFinite {
                quantity: "radius",
                ..
            })
        ));
        assert!(matches!(
            disc.validate(Dimension::Solid),
            Err(GeometryError::WrongDimension { .. })
        ));
        assert!(cylinder().validate(Dimension::PlaneStrain).is_err());
        assert!(cylinder().validate(Dimension::Solid).is_ok());
    }
}
