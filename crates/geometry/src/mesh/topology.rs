//! How triangles hang together.

use std::collections::HashMap;

use jstsph_tensor::Vec3;

use crate::GeometryError;

/// Joined points and the triangles between them.
pub(super) struct Topology {
    pub(super) points: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Triangles left out.
    pub(super) degenerate: usize,
}

impl Topology {
    pub(super) fn new(points: &[Vec3], triangles: &[[usize; 3]]) -> Self {
        let mut known: HashMap<[u64; 3], u32> = HashMap::new();
        let mut joined: Vec<Vec3> = Vec::new();
        let places: Vec<u32> = points
            .iter()
            .map(|point| {
                // Adding zero makes one of the two zeros.
                let key = [point.x, point.y, point.z].map(|value| (value + 0.0).to_bits());
                *known.entry(key).or_insert_with(|| {
                    joined.push(*point);
                    joined.len() as u32 - 1
                })
            })
            .collect();
        let kept: Vec<[u32; 3]> = triangles
            .iter()
            .map(|corners| corners.map(|corner| places[corner]))
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        Self {
            points: joined,
            degenerate: triangles.len() - kept.len(),
            triangles: kept,
        }
    }

    /// Every edge must be passed equally often in both directions.
    pub(super) fn check(&self) -> Result<(), GeometryError> {
        let mut passed: HashMap<[u32; 2], [u32; 2]> = HashMap::new();
        for [a, b] in self.edges() {
            passed.entry([a.min(b), a.max(b)]).or_default()[usize::from(a > b)] += 1;
        }
        let mut open: Vec<[u32; 2]> = Vec::new();
        let mut inconsistent: Vec<[u32; 2]> = Vec::new();
        for (edge, [forth, back]) in passed {
            match (forth + back) % 2 {
                1 => open.push(edge),
                _ if forth != back => inconsistent.push(edge),
                _ => {}
            }
        }
        // The map has no order; the messages must have one.
        let middle = |edges: &[[u32; 2]]| {
            let first = edges.iter().min()?;
            let [a, b] = first.map(|point| self.points[point as usize]);
            Some(0.5 * (a + b))
        };
        if let Some(x) = middle(&open) {
            return Err(GeometryError::OpenMesh {
                count: open.len(),
                x: x.x,
                y: x.y,
                z: x.z,
            });
        }
        if let Some(x) = middle(&inconsistent) {
            return Err(GeometryError::InconsistentMesh {
                count: inconsistent.len(),
                x: x.x,
                y: x.y,
                z: x.z,
            });
        }
        Ok(())
    }

    fn edges(&self) -> impl Iterator<Item = [u32; 2]> {
        self.triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
    }

    fn corners(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        triangle.map(|corner| self.points[corner as usize])
    }

    /// Signed volume: positive if the triangles face outwards.
    pub(super) fn volume(&self) -> f64 {
        // Relative to a point of the surface, so that round-off scales with its size.
        let origin = self.points[self.triangles[0][0] as usize];
        let sum: f64 = self
            .triangles
            .iter()
            .map(|&triangle| {
                let [a, b, c] = self.corners(triangle).map(|corner| corner - origin);
                a.dot(&b.cross(&c))
            })
            .sum();
        sum / 6.0
    }

    pub(super) fn flip(&mut self) {
        for triangle in &mut self.triangles {
            triangle.swap(1, 2);
        }
    }

    /// Unit normals; zero where the corners lie on one line.
    pub(super) fn face_normals(&self) -> Vec<Vec3> {
        let normal = |&triangle: &[u32; 3]| {
            let [a, b, c] = self.corners(triangle);
            let normal = (b - a).cross(&(c - a));
            let longest = (b - a).norm().max((c - a).norm()).max((c - b).norm());
            // The height over the longest side is below the rounding of single precision.
            if normal.norm() <= 1e-7 * longest * longest {
                Vec3::zeros()
            } else {
                normal.normalize()
            }
        };
        self.triangles.iter().map(normal).collect()
    }

    pub(super) fn edge_normals(&self, face_normals: &[Vec3]) -> Vec<[Vec3; 3]> {
        let key = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
        let mut sums: HashMap<[u32; 2], Vec3> = HashMap::new();
        for (number, edge) in self.edges().enumerate() {
            *sums.entry(key(edge)).or_insert_with(Vec3::zeros) += face_normals[number / 3];
        }
        let of = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]].map(|edge| sums[&key(edge)]);
        self.triangles.iter().map(of).collect()
    }

    pub(super) fn point_normals(&self, face_normals: &[Vec3]) -> Vec<Vec3> {
        let mut sums = vec![Vec3::zeros(); self.points.len()];
        for (triangle, normal) in self.triangles.iter().zip(face_normals) {
            let corners = self.corners(*triangle);
            for corner in 0..3 {
                let next = corners[(corner + 1) % 3] - corners[corner];
                let previous = corners[(corner + 2) % 3] - corners[corner];
                sums[triangle[corner] as usize] += next.angle(&previous) * normal;
            }
        }
        sums
    }
}
