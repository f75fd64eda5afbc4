//! Closed surfaces of triangles: signed distance, nearest point, volume.

mod crossing;
mod nearest;
mod stl;
mod topology;
mod tree;

use jstsph_tensor::Vec3;

use crate::GeometryError;
pub use crossing::SelfIntersection;
use topology::Topology;
use tree::Tree;

/// A closed, consistently oriented surface of triangles, with a tree for fast queries.
///
/// Made once; queries allocate nothing (but for lines through it, which are for set-up only).
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Unit normals of the triangles, outwards.
    face_normals: Vec<Vec3>,
    /// Sums of the normals of the triangles at the edges a–b, b–c and c–a of each triangle.
    edge_normals: Vec<[Vec3; 3]>,
    /// Sums of the normals of the triangles at each point, weighted with their angles.
    point_normals: Vec<Vec3>,
    tree: Tree,
    volume: f64,
    is_flipped: bool,
    degenerate: usize,
}

/// Surfaces are equal if points and triangles are; all else follows.
impl PartialEq for TriangleMesh {
    fn eq(&self, other: &Self) -> bool {
        self.points == other.points && self.triangles == other.triangles
    }
}

/// A point of the surface as seen from another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Distance from the surface, m; negative inside.
    pub distance: f64,
    /// Unit vector away from the body: the gradient of the distance.
    pub normal: Vec3,
}

impl TriangleMesh {
    /// A surface from its points (m) and triangles. Points with the same coordinates are joined,
    /// triangles that join to a line or point are left out, and if all of it is turned inside out it
    /// is turned back.
    ///
    /// # Errors
    /// [`GeometryError::EmptyMesh`], [`GeometryError::NotFinite`],
    /// [`GeometryError::OpenMesh`] where an edge has triangles on one side only,
    /// [`GeometryError::InconsistentMesh`] where two triangles at an edge face different sides,
    /// [`GeometryError::NotPositive`] without a volume.
    ///
    /// # Panics
    /// If a triangle names a point that is not there: a bug in the caller.
    pub fn new(points: &[Vec3], triangles: &[[usize; 3]]) -> Result<Self, GeometryError> {
        let numbers = points.iter().flat_map(|point| point.iter());
        if let Some(&value) = numbers.into_iter().find(|value| !value.is_finite()) {
            return Err(GeometryError::NotFinite {
                item: "triangle mesh",
                quantity: "a coordinate",
                value,
            });
        }
        let mut topology = Topology::new(points, triangles);
        if topology.triangles.is_empty() {
            return Err(GeometryError::EmptyMesh);
        }
        topology.check()?;
        let volume = topology.volume();
        let is_flipped = volume < 0.0;
        if is_flipped {
            topology.flip();
        }
        crate::shape::positive("triangle mesh", "volume", volume.abs())?;
        let face_normals = topology.face_normals();
        let is_solid = |&triangle: &u32| face_normals[triangle as usize] != Vec3::zeros();
        let all: Vec<u32> = (0..topology.triangles.len() as u32)
            .filter(is_solid)
            .collect();
        Ok(Self {
            edge_normals: topology.edge_normals(&face_normals),
            point_normals: topology.point_normals(&face_normals),
            tree: Tree::new(&topology.points, &topology.triangles, all),
            face_normals,
            volume: volume.abs(),
            is_flipped,
            degenerate: topology.degenerate,
            points: topology.points,
            triangles: topology.triangles,
        })
    }

    /// A surface from the bytes of an STL file, text or binary. Coordinates are multiplied by
    /// `scale` and then moved by `translation` (m).
    ///
    /// # Errors
    /// [`GeometryError::UnreadableMesh`], [`GeometryError::SelfIntersectingMesh`], and those of
    /// [`Self::new`].
    pub fn from_stl(bytes: &[u8], scale: f64, translation: &Vec3) -> Result<Self, GeometryError> {
        let (points, triangles) = stl::read(bytes)?;
        let points: Vec<Vec3> = points.iter().map(|x| scale * x + translation).collect();
        let mesh = Self::new(&points, &triangles)?;
        match mesh.self_intersection() {
            None => Ok(mesh),
            Some(found) => Err(GeometryError::SelfIntersectingMesh {
                count: found.count,
                x: found.at.x,
                y: found.at.y,
                z: found.at.z,
            }),
        }
    }

    /// Where triangles cut through each other, or lie on each other in one plane; none for the
    /// surface of a solid. Deviations below a millionth of its diagonal are rounding.
    ///
    /// # Cost
    /// About n log n for n triangles; nothing is kept.
    ///
    /// # Limits
    /// Surfaces that meet exactly in edges or corners, without passing through each other, are not
    /// found.
    #[must_use]
    pub fn self_intersection(&self) -> Option<SelfIntersection> {
        crossing::find(&self.points, &self.triangles, &self.tree)
    }

    /// Points, m.
    #[must_use]
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// Triangles, counter-clockwise seen from outside.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Enclosed volume, m³, by the divergence theorem: exact for the triangles.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// Whether the triangles faced inwards and were turned.
    #[must_use]
    pub fn is_flipped(&self) -> bool {
        self.is_flipped
    }

    /// Triangles that were left out because two of their corners are the same.
    #[must_use]
    pub fn degenerate(&self) -> usize {
        self.degenerate
    }

    /// Corners of the smallest axis-parallel box around it, m.
    #[must_use]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        self.tree.bounds()
    }

    /// Edges where the surface turns by more than `angle` (rad), for drawing, m.
    #[must_use]
    pub fn edges(&self, angle: f64) -> Vec<[Vec3; 2]> {
        let mut edges = Vec::new();
        for (triangle, corners) in self.triangles.iter().enumerate() {
            for side in 0..3 {
                let (a, b) = (corners[side], corners[(side + 1) % 3]);
                // The sum of two unit normals at an angle is 2 cos(angle / 2) long.
                let sum = self.edge_normals[triangle][side].norm();
                if a < b && sum < 2.0 * (0.5 * angle).cos() {
                    edges.push([self.points[a as usize], self.points[b as usize]]);
                }
            }
        }
        edges
    }

    /// Distance, signed by the pseudonormal of the nearest face, edge or corner.
    ///
    /// Source: J. A. Bærentzen, H. Aanæs, Signed distance computation using the angle weighted
    /// pseudonormal, IEEE Trans. Vis. Comput. Graph. 11 (2005) 243–253.
    #[must_use]
    pub fn nearest(&self, x: &Vec3) -> SurfacePoint {
        let found = self.tree.nearest(&self.points, &self.triangles, x);
        let corners = self.triangles[found.triangle as usize];
        let normal = match found.feature {
            nearest::Feature::Face => self.face_normals[found.triangle as usize],
            nearest::Feature::Edge(side) => self.edge_normals[found.triangle as usize][side],
            nearest::Feature::Corner(corner) => self.point_normals[corners[corner] as usize],
        };
        let away = x - found.point;
        let distance = away.norm();
        let is_outside = away.dot(&normal) >= 0.0;
        // So near to the surface the offset is rounding and has no direction.
        let normal = if distance <= 1e-13 * x.amax().max(found.point.amax()) {
            normal.normalize()
        } else if is_outside {
            away / distance
        } else {
            -away / distance
        };
        SurfacePoint {
            distance: if is_outside { distance } else { -distance },
            normal,
        }
    }

    /// Where the line along x through (·, y, z) crosses the surface, ascending.
    pub(crate) fn crossings(&self, y: f64, z: f64) -> Vec<f64> {
        let mut found = Vec::new();
        self.tree.visit_line(y, z, &mut |triangle| {
            let corners = self.triangles[triangle as usize];
            if let Some(x) = nearest::crossing(&self.points, corners, y, z) {
                found.push(x);
            }
        });
        found.sort_by(f64::total_cmp);
        found
    }
}

#[cfg(test)]
mod tests;
