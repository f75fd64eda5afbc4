//! Bodies carved out of a lattice: volumes, faces, bonds and boundaries.

use std::f64::consts::PI;

use jstsph_geometry::{
    Axis, Body, Dimension, GeometryError, Lattice, Polygon, Selection, Shape, Spacing, build_body,
    face_areas, inverted_cells, select,
};
use jstsph_tensor::Vec3;

/// Sums of at most 10⁵ positive terms.
const ROUND_OFF: f64 = 1e-12;

fn block(min: [f64; 3], max: [f64; 3]) -> Shape {
    Shape::Box {
        min: Vec3::from(min),
        max: Vec3::from(max),
    }
}

/// The L-shaped block of the literature: 6 m × 10 m × 3 m, legs 3 m wide.
fn ell() -> Shape {
    Shape::Union(vec![
        block([0.0; 3], [6.0, 3.0, 3.0]),
        block([0.0; 3], [3.0, 10.0, 3.0]),
    ])
}

fn build(shape: Shape, spacing: Spacing, dimension: Dimension) -> Body {
    build_body(shape, Lattice::Cubic { spacing }, dimension).unwrap()
}

fn total(values: &[f64]) -> f64 {
    values.iter().sum()
}

fn area(body: &Body, face: &str) -> f64 {
    face_areas(body, face).unwrap().iter().map(|a| a.area).sum()
}

#[test]
fn a_box_cut_into_two_is_the_same_body() {
    // The cut lies between two lattice planes.
    let halves = Shape::Union(vec![
        block([0.0; 3], [0.33, 2.0, 3.0]),
        block([0.33, 0.0, 0.0], [1.0, 2.0, 3.0]),
    ]);
    let spacing = Spacing::Counts([5, 7, 9]);
    let carved = build(halves, spacing, Dimension::Solid);
    let whole = build(block([0.0; 3], [1.0, 2.0, 3.0]), spacing, Dimension::Solid);
    assert_eq!(carved.positions, whole.positions);
    assert_eq!(carved.cells, whole.cells);
    assert_eq!(carved.boundary, whole.boundary);
    let (ours, theirs) = (&carved.bonds, &whole.bonds);
    assert_eq!(ours.ends, theirs.ends);
    for (a, b) in ours.volumes.iter().zip(theirs.volumes.iter()) {
        assert!((a / b - 1.0).abs() < ROUND_OFF, "{a} {b}");
    }
    for face in ["left", "right", "front", "back", "bottom", "top"] {
        let plane = face_areas(&whole, face).unwrap();
        for name in [face.to_owned(), format!("facing_{face}")] {
            let parts = face_areas(&carved, &name).unwrap();
            assert_eq!(parts.len(), plane.len(), "{name}");
            for (a, b) in parts.iter().zip(&plane) {
                assert_eq!((a.node, a.normal), (b.node, b.normal), "{name}");
                assert!((a.area / b.area - 1.0).abs() < ROUND_OFF, "{name}");
            }
        }
    }
}

#[test]
fn the_l_shaped_block_is_exact() {
    for shape in [
        ell(),
        Shape::Difference(vec![
            block([0.0; 3], [6.0, 10.0, 3.0]),
            block([3.0, 3.0, -1.0], [7.0, 11.0, 4.0]),
        ]),
        Shape::Polygon(
            Polygon::new(
                vec![
                    [0.0, 0.0],
                    [6.0, 0.0],
                    [6.0, 3.0],
                    [3.0, 3.0],
                    [3.0, 10.0],
                    [0.0, 10.0],
                ],
                Some([0.0, 3.0]),
            )
            .unwrap(),
        ),
    ] {
        let body = build(shape, Spacing::Length(1.0), Dimension::Solid);
        assert_eq!(body.positions.len(), (7 * 4 + 4 * 7) * 4);
        assert_eq!(body.cells.len(), (6 * 3 + 3 * 7) * 3);
        assert_eq!(inverted_cells(&body.cells, &body.positions).not_convex, 0);
        assert!((total(&body.volumes) / 117.0 - 1.0).abs() < ROUND_OFF);
        let node = |x: [f64; 3]| {
            let found = body.positions.iter().position(|y| *y == Vec3::from(x));
            found.unwrap()
        };
        // Of the eight cells around it a node of the re-entrant edge has six.
        assert!((body.volumes[node([3.0, 3.0, 1.0])] - 0.75).abs() < 1e-12);
        assert!(body.boundary[node([3.0, 3.0, 1.0])]);
        assert!(!body.boundary[node([2.0, 3.0, 1.0])]);
        for (face, expected) in [
            ("right", 9.0),
            ("back", 9.0),
            ("left", 30.0),
            ("top", 39.0),
            ("facing_right", 9.0 + 21.0),
            ("facing_back", 9.0 + 9.0),
            ("facing_left", 30.0),
            ("facing_bottom", 39.0),
        ] {
            assert!((area(&body, face) - expected).abs() < 1e-11, "{face}");
        }
        let end = select(&body, &Selection::Face("right".into())).unwrap();
        assert_eq!(end.len(), 16);
    }
}

#[test]
fn loaded_ends_have_their_area_when_the_lattice_does_not_fit() {
    // 13 intervals along y: the face y = 3 m lies between two lattice planes.
    let body = build(ell(), Spacing::Length(0.75), Dimension::Solid);
    assert!((total(&body.volumes) / 117.0 - 1.0).abs() < ROUND_OFF);
    for (face, expected) in [("right", 9.0), ("back", 9.0), ("left", 30.0), ("top", 39.0)] {
        assert!((area(&body, face) / expected - 1.0).abs() < 1e-10, "{face}");
    }
}

#[test]
fn a_drilled_plate_has_its_volume_and_an_open_hole() {
    let drilled = Shape::Difference(vec![
        block([-1.0, -1.0, 0.0], [1.0, 1.0, 0.5]),
        Shape::Cylinder {
            base: Vec3::new(0.0, 0.0, -1.0),
            axis: Axis::Z,
            radius: 0.5,
            height: 2.0,
        },
    ]);
    let exact = (4.0 - PI * 0.25) * 0.5;
    let body = build(drilled, Spacing::Length(0.1), Dimension::Solid);
    // The total is that of the shape's own quadrature.
    assert!((total(&body.volumes) / exact - 1.0).abs() < 2e-5);
    assert!(body.volumes.iter().all(|&volume| volume > 0.0));
    assert!(body.positions.iter().all(|x| x.xy().norm() > 0.5 - 1e-4));
    // The plate is symmetric, and so must be the volumes: no first moment in the plane. Lines run
    // along x only, so that x and y are sampled in different ways.
    let moment: Vec3 = body
        .positions
        .iter()
        .zip(&body.volumes)
        .map(|(x, volume)| *volume * x)
        .sum();
    assert!(moment.xy().norm() < 1e-10, "{moment}");
    // The second moments along x and y agree to what the sampling of the hole's rim leaves.
    let second = |axis: usize| -> f64 {
        let terms = body.positions.iter().zip(&body.volumes);
        terms.map(|(x, volume)| volume * x[axis] * x[axis]).sum()
    };
    assert!((second(0) / second(1) - 1.0).abs() < 1e-4);
    assert!((area(&body, "top") / (exact / 0.5) - 1.0).abs() < 5e-6);
    assert!((area(&body, "left") - 1.0).abs() < 1e-11);
}

#[test]
fn a_slot_of_one_spacing_has_no_bonds_across() {
    // Nodes on both faces of the slot are lattice neighbours.
    let slotted = Shape::Difference(vec![
        block([0.0; 3], [5.0, 4.0, 0.0]),
        block([2.0, 2.0, 0.0], [3.0, 5.0, 0.0]),
    ]);
    let body = build(slotted, Spacing::Length(1.0), Dimension::PlaneStrain);
    assert_eq!(body.positions.len(), 6 * 5);
    assert_eq!(body.cells.len(), 5 * 4 - 2);
    assert_eq!(body.shape.volume(body.dimension), 18.0);
    let bonds = &body.bonds;
    let midpoints = bonds.midpoints(&body.positions);
    let crosses = midpoints.iter().any(|x| x.x == 2.5 && x.y > 2.0);
    assert!(!crosses);
    assert!((area(&body, "facing_right") - (4.0 + 2.0)).abs() < 1e-12);
    assert!((area(&body, "right") - 4.0).abs() < 1e-12);
}

#[test]
fn a_sphere_keeps_volume_and_symmetry() {
    let ball = Shape::Sphere {
        centre: Vec3::new(1.0, 2.0, 3.0),
        radius: 1.0,
    };
    let body = build(ball, Spacing::Counts([11; 3]), Dimension::Solid);
    let exact = 4.0 / 3.0 * PI;
    assert!((total(&body.volumes) / exact - 1.0).abs() < ROUND_OFF);
    let mut second = [0.0; 3];
    for (x, volume) in body.positions.iter().zip(&body.volumes) {
        let offset = x - Vec3::new(1.0, 2.0, 3.0);
        for axis in 0..3 {
            second[axis] += volume * offset[axis].powi(2);
        }
    }
    // Nodes lie inside of the surface: the moment is low by about a spacing at most, but the same
    // along all axes to what the sampling (exact along x) makes of it.
    let expected = 4.0 / 15.0 * PI;
    assert!(
        second.iter().all(|m| (m / expected - 1.0).abs() < 0.08),
        "{second:?}"
    );
    assert!((second[0] / second[1] - 1.0).abs() < 1e-3);
    assert!((second[1] / second[2] - 1.0).abs() < 1e-9);
}

#[test]
fn what_the_lattice_cannot_resolve_is_refused() {
    // A sheet of a tenth of a spacing between two blocks.
    let thin = Shape::Union(vec![
        block([0.0; 3], [2.0, 2.0, 0.0]),
        block([2.0, 0.45, 0.0], [8.0, 0.55, 0.0]),
        block([8.0, 0.0, 0.0], [10.0, 2.0, 0.0]),
    ]);
    let spacing = Spacing::Length(1.0);
    let lattice = Lattice::Cubic { spacing };
    let error = build_body(thin, lattice, Dimension::PlaneStrain).unwrap_err();
    assert!(matches!(error, GeometryError::Unresolved { .. }), "{error}");
    let radial = Spacing::Radial {
        per_radius: 3,
        layers: 2,
    };
    let error = build_body(ell(), Lattice::Cubic { spacing: radial }, Dimension::Solid);
    assert!(matches!(
        error,
        Err(GeometryError::LatticeMismatch { shape: "union", .. })
    ));
    let apart = Shape::Intersection(vec![block([0.0; 3], [1.0; 3]), block([2.0; 3], [3.0; 3])]);
    assert!(apart.validate(Dimension::Solid).is_err());
    assert!(
        Shape::Union(vec![ell()])
            .validate(Dimension::Solid)
            .is_err()
    );
}
