//! Rigid surfaces and the signed distance to them.

use std::sync::Arc;

use jstsph_geometry::TriangleMesh;
use jstsph_tensor::Vec3;

use crate::{ContactError, Profile, mesh, outline, solid};

/// How far a point is from a wall, and where the way out is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Signed distance, m: positive on the free side, negative in the wall.
    pub distance: f64,
    /// Unit normal towards the free side, the gradient of the distance. The nearest point of the
    /// surface is x − distance · normal.
    pub normal: Vec3,
}

/// A rigid surface with a free side, in its own frame. Lengths in m.
///
/// Build planes and cylinders with [`Surface::plane`] and [`Surface::cylinder`], which normalise;
/// check anything else with [`Surface::validate`] before use.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    /// Walls of a plane-strain problem.
    Profile(Profile),
    /// A plane without end.
    Plane {
        /// A point on it.
        point: Vec3,
        /// Unit normal towards the free side.
        normal: Vec3,
    },
    /// A sphere.
    Sphere {
        /// Its centre.
        centre: Vec3,
        /// Its radius.
        radius: f64,
        /// Particles are inside it; otherwise outside.
        inside: bool,
    },
    /// A circular cylinder.
    Cylinder {
        /// A point on the axis; the middle of a capped cylinder.
        point: Vec3,
        /// Unit vector along the axis.
        axis: Vec3,
        /// Its radius.
        radius: f64,
        /// Half the length of a cylinder with flat caps; `None` for one without end.
        half_length: Option<f64>,
        /// Particles are inside it; otherwise outside.
        inside: bool,
    },
    /// A box with faces normal to the axes.
    Box {
        /// Lowest corner.
        min: Vec3,
        /// Highest corner.
        max: Vec3,
        /// Particles are inside it; otherwise outside.
        inside: bool,
    },
    /// A closed surface of triangles. In a concave edge a particle touches one side at a time.
    Mesh {
        /// The triangles.
        mesh: Arc<TriangleMesh>,
        /// Particles are inside it; otherwise outside.
        inside: bool,
    },
}

/// How far a direction may be from unit length: far below what would show in a distance, far above
/// the rounding of a normalisation.
const UNIT_TOLERANCE: f64 = 1e-9;

impl Surface {
    /// A plane through a point, free on the side to which `normal` (any length) points.
    ///
    /// # Errors
    /// If the normal is zero or a number is not finite.
    pub fn plane(point: Vec3, normal: Vec3) -> Result<Self, ContactError> {
        let normal = unit("the normal of a plane", &normal)?;
        let plane = Self::Plane { point, normal };
        plane.validate()?;
        Ok(plane)
    }

    /// A cylinder along `axis` (any length); see [`Surface::Cylinder`].
    ///
    /// # Errors
    /// If the axis is zero, a length is not positive, or a number is not finite.
    pub fn cylinder(
        point: Vec3,
        axis: Vec3,
        radius: f64,
        half_length: Option<f64>,
        inside: bool,
    ) -> Result<Self, ContactError> {
        let axis = unit("the axis of a cylinder", &axis)?;
        let cylinder = Self::Cylinder {
            point,
            axis,
            radius,
            half_length,
            inside,
        };
        cylinder.validate()?;
        Ok(cylinder)
    }

    /// Checks the numbers of a surface.
    ///
    /// # Errors
    /// Numbers that are not finite, lengths that are not positive, directions that are not unit
    /// vectors, an empty box. Profiles and triangles were checked when they
    /// were built.
    pub fn validate(&self) -> Result<(), ContactError> {
        match self {
            Self::Profile(_) | Self::Mesh { .. } => Ok(()),
            Self::Plane { point, normal } => {
                finite("the point of a plane", point)?;
                is_unit("the normal of a plane", normal)
            }
            Self::Sphere { centre, radius, .. } => {
                finite("the centre of a sphere", centre)?;
                positive("the radius of a sphere", *radius)
            }
            Self::Cylinder {
                point,
                axis,
                radius,
                half_length,
                ..
            } => {
                finite("the point of a cylinder", point)?;
                is_unit("the axis of a cylinder", axis)?;
                positive("the radius of a cylinder", *radius)?;
                half_length.map_or(Ok(()), |half| {
                    positive("the half length of a cylinder", half)
                })
            }
            Self::Box { min, max, .. } => {
                finite("the lowest corner of a box", min)?;
                finite("the highest corner of a box", max)?;
                for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate() {
                    let (min, max) = (min[axis], max[axis]);
                    if min >= max {
                        return Err(ContactError::EmptyBox {
                            axis: name,
                            min,
                            max,
                        });
                    }
                }
                Ok(())
            }
        }
    }

    /// Number of parts, each of which a particle may touch on its own: the chains of a profile,
    /// the six faces of a box seen from inside, wall and two caps of a cylinder seen from inside,
    /// otherwise one.
    #[must_use]
    pub fn parts(&self) -> usize {
        match self {
            Self::Profile(profile) => profile.chains().len(),
            Self::Cylinder {
                half_length: Some(_),
                inside: true,
                ..
            } => 3,
            Self::Box { inside: true, .. } => 6,
            _ => 1,
        }
    }

    /// Gap to one part. 1-Lipschitz: |gap(x) − gap(y)| ≤ |x − y|.
    ///
    /// Where the normal is not unique (the centre of a sphere, the axis of a cylinder, the middle
    /// of a box, two walls at the same distance) it is that of one of the nearest points.
    ///
    /// # Panics
    /// If `part` is not below [`Surface::parts`]: a bug in the caller.
    #[inline]
    #[must_use]
    pub fn gap_of(&self, part: usize, x: &Vec3) -> Gap {
        assert!(
            part < self.parts(),
            "part {part} of a surface with {} parts",
            self.parts()
        );
        match self {
            Self::Profile(profile) => profile.chains()[part].gap(x),
            Self::Plane { point, normal } => solid::plane(point, normal, x),
            Self::Sphere {
                centre,
                radius,
                inside,
            } => solid::sphere(centre, *radius, *inside, x),
            Self::Cylinder {
                point,
                axis,
                radius,
                half_length,
                inside,
            } => {
                match (half_length, inside) {
                    (Some(half), true) if part > 0 => {
                        // The caps are planes that face each other.
                        let outward = if part == 1 { *axis } else { -axis };
                        solid::plane(&(point + *half * outward), &-outward, x)
                    }
                    (Some(half), false) => solid::capped_cylinder(point, axis, *radius, *half, x),
                    _ => solid::cylinder(point, axis, *radius, *inside, x),
                }
            }
            Self::Box {
                min,
                max,
                inside: true,
            } => solid::box_face(min, max, part, x),
            Self::Box {
                min,
                max,
                inside: false,
            } => solid::outside_box(min, max, x),
            Self::Mesh { mesh, inside } => mesh::gap(mesh, *inside, x),
        }
    }

    /// Gap to the part that is nearest, or most deeply penetrated.
    ///
    /// # Limits
    /// Exact on the free side. In the wall behind an edge where two parts meet it is the larger of
    /// the two penetrations, not the distance to the edge.
    #[must_use]
    pub fn gap(&self, x: &Vec3) -> Gap {
        let mut least = self.gap_of(0, x);
        for part in 1..self.parts() {
            let gap = self.gap_of(part, x);
            if gap.distance < least.distance {
                least = gap;
            }
        }
        least
    }

    /// Polylines for drawing. A profile lies in the plane z = 0, its arcs cut into pieces of 5°;
    /// solids are coarse wire frames. What has no end (planes, infinite cylinders, the extension
    /// of open chains) stops at the box between the two corners `bounds`, m; the rest is not
    /// clipped.
    #[must_use]
    pub fn outline(&self, bounds: &[Vec3; 2]) -> Vec<Vec<Vec3>> {
        match self {
            Self::Profile(profile) => profile
                .chains()
                .iter()
                .map(|chain| outline::chain(chain, bounds))
                .collect(),
            Self::Plane { point, normal } => outline::plane(point, normal, bounds),
            Self::Sphere { centre, radius, .. } => outline::sphere(centre, *radius),
            Self::Cylinder {
                point,
                axis,
                radius,
                half_length,
                ..
            } => outline::cylinder(point, axis, *radius, *half_length, bounds),
            Self::Box { min, max, .. } => outline::cuboid(min, max),
            Self::Mesh { mesh, .. } => mesh::outline(mesh),
        }
    }
}

fn finite(what: &'static str, vector: &Vec3) -> Result<(), ContactError> {
    match vector.iter().find(|value| !value.is_finite()) {
        Some(&value) => Err(ContactError::NotFinite { what, value }),
        None => Ok(()),
    }
}

fn positive(what: &'static str, value: f64) -> Result<(), ContactError> {
    if !value.is_finite() {
        return Err(ContactError::NotFinite { what, value });
    }
    if value <= 0.0 {
        return Err(ContactError::NotPositive { what, value });
    }
    Ok(())
}

fn is_unit(what: &'static str, direction: &Vec3) -> Result<(), ContactError> {
    finite(what, direction)?;
    let length = direction.norm();
    if (length - 1.0).abs() > UNIT_TOLERANCE {
        return Err(ContactError::NotUnit { what, length });
    }
    Ok(())
}

fn unit(what: &'static str, direction: &Vec3) -> Result<Vec3, ContactError> {
    finite(what, direction)?;
    // Scaled first, so that very short and very long vectors keep their direction.
    let largest = direction.amax();
    if largest == 0.0 {
        return Err(ContactError::NotUnit { what, length: 0.0 });
    }
    Ok((direction / largest).normalize())
}

#[cfg(test)]
mod tests;
