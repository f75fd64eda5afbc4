//! Obstacles whose surface is made of triangles.

use jstsph_geometry::TriangleMesh;
use jstsph_tensor::Vec3;

use crate::Gap;

/// Turn of the surface from which on an edge is drawn, rad (20°).
const DRAWN_TURN: f64 = std::f64::consts::PI / 9.0;

/// Distance to a closed surface, free outside or inside of it.
pub(crate) fn gap(mesh: &TriangleMesh, inside: bool, x: &Vec3) -> Gap {
    let point = mesh.nearest(x);
    let side = if inside { -1.0 } else { 1.0 };
    Gap {
        distance: side * point.distance,
        normal: side * point.normal,
    }
}

/// The sharp edges.
pub(crate) fn outline(mesh: &TriangleMesh) -> Vec<Vec<Vec3>> {
    let edges = mesh.edges(DRAWN_TURN);
    edges.into_iter().map(|edge| edge.to_vec()).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::Surface;

    #[test]
    fn a_tetrahedron_is_solid_outside_or_inside() {
        let points = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()];
        let triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let mesh = Arc::new(TriangleMesh::new(&points, &triangles).unwrap());
        let surface = |inside| Surface::Mesh {
            mesh: mesh.clone(),
            inside,
        };
        let below = Vec3::new(0.2, 0.2, -0.1);
        let expected = Gap {
            distance: 0.1,
            normal: -Vec3::z(),
        };
        let found = surface(false).gap(&below);
        assert!((found.distance - expected.distance).abs() < 1e-15);
        assert!((found.normal - expected.normal).norm() < 1e-15);
        assert!((surface(true).gap(&below).distance + 0.1).abs() < 1e-15);
        assert_eq!(surface(true).outline(&[Vec3::zeros(); 2]).len(), 6);
    }
}
