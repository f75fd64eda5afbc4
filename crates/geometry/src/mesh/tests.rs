use std::f64::consts::{PI, TAU};

use super::*;

/// A box of twelve triangles.
fn cuboid(size: Vec3) -> (Vec<Vec3>, Vec<[usize; 3]>) {
    let points = (0..8)
        .map(|i| {
            let at = |bit: usize| ((i >> bit) & 1) as f64;
            Vec3::new(at(0) * size.x, at(1) * size.y, at(2) * size.z)
        })
        .collect();
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = quads
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    (points, triangles.collect())
}

/// A unit sphere of latitudes and longitudes.
fn sphere(rings: usize) -> TriangleMesh {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    let at = |i: usize, j: usize| {
        let (theta, phi) = (
            PI * i as f64 / rings as f64,
            TAU * (j % (2 * rings)) as f64 / (2 * rings) as f64,
        );
        let radius = if i == 0 || i == rings {
            0.0
        } else {
            theta.sin()
        };
        Vec3::new(radius * phi.cos(), radius * phi.sin(), theta.cos())
    };
    for (i, j) in (0..rings).flat_map(|i| (0..2 * rings).map(move |j| (i, j))) {
        let first = points.len();
        points.extend([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    TriangleMesh::new(&points, &triangles).unwrap()
}

/// Random numbers between -1 and 1.
fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
    (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

#[test]
fn a_box_has_the_distance_of_the_primitive() {
    let size = Vec3::new(1.0, 2.0, 3.0);
    let (points, triangles) = cuboid(size);
    let mesh = TriangleMesh::new(&points, &triangles).unwrap();
    assert!((mesh.volume() - 6.0).abs() < 1e-14);
    assert_eq!(mesh.bounds(), (Vec3::zeros(), size));
    assert_eq!(mesh.edges(0.5).len(), 12);
    let exact = crate::Shape::Box {
        min: Vec3::zeros(),
        max: size,
    };
    let mut seed = 7;
    for _ in 0..2000 {
        let x = Vec3::from_fn(|i, _| (0.5 + random(&mut seed)) * size[i]);
        let found = mesh.nearest(&x);
        let expected = exact.signed_distance(&x);
        assert!((found.distance - expected).abs() < 1e-14, "{x}");
        assert!((found.normal.norm() - 1.0).abs() < 1e-12);
        // One step against the gradient leads to the surface.
        let foot = mesh.nearest(&(x - found.distance * found.normal));
        assert!(foot.distance.abs() < 1e-12);
    }
    // On faces, edges and corners the normal is outward and not made of rounding.
    for x in [[1.0, 1.0, 1.0], [1.0, 2.0, 1.0], [1.0, 2.0, 3.0]] {
        let found = mesh.nearest(&Vec3::from(x));
        assert_eq!(found.distance, 0.0);
        assert!(found.normal.x > 0.4, "{}", found.normal);
    }
}

#[test]
fn the_tree_finds_what_going_through_all_triangles_finds() {
    let mesh = sphere(12);
    // Two volumes of the inscribed polyhedron: 4π/3 less what the facets cut off.
    assert!((mesh.volume() / (4.0 / 3.0 * PI) - 1.0).abs() < 0.03);
    assert_eq!(mesh.degenerate(), 48);
    let mut seed = 1;
    for _ in 0..500 {
        let x = Vec3::from_fn(|_, _| 1.5 * random(&mut seed));
        let all = mesh.triangles.iter().map(|corners| {
            let corners = corners.map(|corner| mesh.points[corner as usize]);
            (x - nearest::on_triangle(&x, corners).0).norm()
        });
        let distance = mesh.nearest(&x).distance;
        assert_eq!(distance.abs(), all.fold(f64::INFINITY, f64::min));
        // The facets lie at most 1 - cos(π/12) inside of the sphere.
        assert!((distance - (x.norm() - 1.0)).abs() < 0.04, "{x}");
    }
}

#[test]
fn lines_enter_as_often_as_they_leave_even_through_corners() {
    let mesh = sphere(8);
    for j in -12..=12 {
        for k in -12..=12 {
            // Hits the poles, the equator and many edges exactly.
            let (y, z) = (f64::from(j) / 10.0, f64::from(k) / 10.0);
            assert_eq!(mesh.crossings(y, z).len() % 2, 0, "{y} {z}");
        }
    }
    let (points, triangles) = cuboid(Vec3::new(1.0, 1.0, 1.0));
    let cube = TriangleMesh::new(&points, &triangles).unwrap();
    // The diagonal of two faces.
    assert_eq!(cube.crossings(0.5, 0.5), [0.0, 1.0]);
}

#[test]
fn inward_triangles_are_turned_and_open_or_mixed_ones_refused() {
    let (points, mut triangles) = cuboid(Vec3::repeat(1.0));
    for corners in &mut triangles {
        corners.swap(0, 1);
    }
    let mesh = TriangleMesh::new(&points, &triangles).unwrap();
    assert!(mesh.is_flipped() && mesh.nearest(&Vec3::repeat(0.5)).distance < 0.0);

    triangles[3].swap(0, 1);
    let error = TriangleMesh::new(&points, &triangles).unwrap_err();
    assert!(
        matches!(error, GeometryError::InconsistentMesh { count: 3, .. }),
        "{error}"
    );
    triangles.remove(3);
    let error = TriangleMesh::new(&points, &triangles).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("the surface is not closed: 3 edges"),
        "{error}"
    );
    assert_eq!(
        TriangleMesh::new(&points, &[]),
        Err(GeometryError::EmptyMesh)
    );
}

/// Two boxes in one mesh, the second moved and turned about z.
fn two_boxes(shift: Vec3, angle: f64) -> Option<SelfIntersection> {
    let (mut points, mut triangles) = cuboid(Vec3::new(1.0, 2.0, 3.0));
    let (sin, cos) = angle.sin_cos();
    let second: Vec<Vec3> = points
        .iter()
        .map(|x| shift + Vec3::new(cos * x.x - sin * x.y, sin * x.x + cos * x.y, x.z))
        .collect();
    let more: Vec<[usize; 3]> = triangles
        .iter()
        .map(|t| t.map(|corner| corner + 8))
        .collect();
    points.extend(second);
    triangles.extend(more);
    TriangleMesh::new(&points, &triangles)
        .unwrap()
        .self_intersection()
}

#[test]
fn a_surface_that_cuts_or_lies_on_itself_is_found_and_a_solid_is_not() {
    assert_eq!(sphere(24).self_intersection(), None);
    // Apart, and one in the other.
    assert_eq!(two_boxes(Vec3::new(5.0, 0.0, 0.0), 0.3), None);
    // A corner of the second stands in the first.
    let found = two_boxes(Vec3::new(0.9, 1.9, 2.9), 0.0).unwrap();
    let expected = [
        Vec3::new(1.0, 1.9, 2.9),
        Vec3::new(0.9, 2.0, 2.9),
        Vec3::new(0.9, 1.9, 3.0),
    ];
    assert!(
        expected.iter().any(|x| (x - found.at).norm() < 0.11),
        "{found:?}"
    );
    assert!(two_boxes(Vec3::new(0.3, 0.5, 0.4), 0.5).is_some());
    // Half a box along an axis: no edge passes through a face, but faces lie on each other. So do
    // those of boxes that stand side by side.
    assert!(two_boxes(Vec3::new(0.5, 0.0, 0.0), 0.0).is_some());
    assert!(two_boxes(Vec3::new(1.0, 0.5, 0.0), 0.0).is_some());
    // A hair's breadth apart.
    assert_eq!(two_boxes(Vec3::new(1.0 + 1e-4, 0.5, 0.0), 0.0), None);
}

#[test]
fn ten_thousands_of_triangles_are_searched_at_once() {
    // All pairs would be three thousand million tests.
    let mesh = sphere(140);
    assert!(mesh.triangles().len() > 70_000);
    let start = std::time::Instant::now();
    assert_eq!(mesh.self_intersection(), None);
    assert!(start.elapsed().as_secs() < 5);
}

#[test]
fn text_and_binary_files_give_the_same_surface() {
    let (points, triangles) = cuboid(Vec3::new(1.0, 2.0, 3.0));
    let mut text = String::from("solid part\n");
    let mut binary = b"solid that is no text".to_vec();
    binary.resize(80, b' ');
    binary.extend((triangles.len() as u32).to_le_bytes());
    for corners in &triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        binary.extend([0; 12]);
        for &corner in corners {
            let x = points[corner];
            text += &format!("vertex {} {} {}\n", x.x, x.y, x.z);
            for value in x.iter() {
                binary.extend((*value as f32).to_le_bytes());
            }
        }
        text += "endloop\nendfacet\n";
        binary.extend([0; 2]);
    }
    text += "endsolid part\n";
    let shift = Vec3::new(0.0, 0.0, 1.0);
    let from_text = TriangleMesh::from_stl(text.as_bytes(), 1e-3, &shift).unwrap();
    let from_binary = TriangleMesh::from_stl(&binary, 1e-3, &shift).unwrap();
    assert_eq!(from_text, from_binary);
    assert!((from_text.volume() / 6e-9 - 1.0).abs() < 1e-9);
    let error = TriangleMesh::from_stl(b"PK\x03\x04 no surface", 1.0, &shift).unwrap_err();
    assert!(matches!(error, GeometryError::UnreadableMesh { .. }));
}
