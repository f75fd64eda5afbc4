//! Counts, volumes, symmetry and faces of finished bodies.

use std::collections::HashMap;
use std::f64::consts::PI;

use jstsph_geometry::{
    Axis, Body, CellDefects, Cells, Dimension, GeometryError, Lattice, Shape, Spacing, build_body,
    face_areas, face_nodes, inverted_cells,
};
use jstsph_tensor::Vec3;

/// Sums of at most 10⁵ positive terms: round-off stays below 10⁵ ε ≈ 2e-11, in practice far below.
const ROUND_OFF: f64 = 1e-12;

fn rectangle(width: f64, height: f64, spacing: Spacing) -> Body {
    let shape = Shape::Box {
        min: Vec3::new(-0.3, 0.2, 5.0),
        max: Vec3::new(width - 0.3, height + 0.2, -1.0),
    };
    build_body(shape, Lattice::Cubic { spacing }, Dimension::PlaneStrain).unwrap()
}

fn cuboid(counts: [usize; 3]) -> Body {
    let shape = Shape::Box {
        min: Vec3::zeros(),
        max: Vec3::new(1.0, 2.0, 3.0),
    };
    let spacing = Spacing::Counts(counts);
    build_body(shape, Lattice::Cubic { spacing }, Dimension::Solid).unwrap()
}

fn disc(lattice: Lattice) -> Body {
    let shape = Shape::Disc {
        centre: Vec3::zeros(),
        radius: 3.2e-3,
    };
    build_body(shape, lattice, Dimension::PlaneStrain).unwrap()
}

fn cylinder(axis: Axis, lattice: Lattice) -> Body {
    let shape = Shape::Cylinder {
        base: Vec3::zeros(),
        axis,
        radius: 3.2e-3,
        height: 32e-3,
    };
    build_body(shape, lattice, Dimension::Solid).unwrap()
}

fn clipped(per_radius: usize, layers: usize) -> Lattice {
    let spacing = Spacing::Radial { per_radius, layers };
    Lattice::Cubic { spacing }
}

fn rings(layers: usize) -> Lattice {
    Lattice::Rings {
        rings: 4,
        per_ring: 8,
        layers,
    }
}

/// Whether the nodes lie on rings: their section is no square lattice.
fn is_wound(body: &Body) -> bool {
    let bonds = &body.bonds;
    let mut arms = bonds
        .ends
        .iter()
        .map(|&[a, b]| body.positions[b as usize] - body.positions[a as usize]);
    arms.any(|arm| arm.iter().filter(|x| x.abs() > 1e-9 * arm.norm()).count() > 1)
}

/// One of each kind.
fn every_kind() -> Vec<Body> {
    vec![
        rectangle(1.0, 0.5, Spacing::Length(0.05)),
        cuboid([5, 7, 9]),
        disc(clipped(5, 1)),
        disc(rings(1)),
        cylinder(Axis::X, clipped(5, 51)),
        cylinder(Axis::Y, clipped(9, 4)),
        cylinder(Axis::Z, clipped(1, 2)),
        cylinder(Axis::Z, rings(41)),
        cylinder(
            Axis::X,
            Lattice::Rings {
                rings: 4,
                per_ring: 6,
                layers: 41,
            },
        ),
        cylinder(
            Axis::Y,
            Lattice::Rings {
                rings: 4,
                per_ring: 5,
                layers: 41,
            },
        ),
    ]
}

fn sum(values: &[f64]) -> f64 {
    values.iter().sum()
}

fn assert_close(value: f64, expected: f64, what: &str) {
    let error = (value - expected).abs();
    assert!(
        error <= ROUND_OFF * expected.abs(),
        "{what}: {value} instead of {expected}"
    );
}

#[test]
fn node_counts_are_those_of_the_paper() {
    let plate = rectangle(1.0, 0.5, Spacing::Length(0.05));
    assert_eq!(plate.positions.len(), 231);
    for (counts, expected) in [
        ([4, 22], 88),
        ([6, 36], 216),
        ([8, 50], 400),
        ([10, 64], 640),
    ] {
        let spacing = Spacing::Counts([counts[0], counts[1], 0]);
        assert_eq!(rectangle(8e-3, 56e-3, spacing).positions.len(), expected);
    }
    let nodes = |lattice| cylinder(Axis::Z, lattice).positions.len();
    assert_eq!(nodes(clipped(5, 51)), 4131);
    assert_eq!(nodes(clipped(9, 21)), 5313);
    assert_eq!(nodes(rings(51)), 4131);
    assert_eq!(disc(clipped(9, 1)).positions.len(), 253);
    // A spacing of a fifth of the radius is the same body.
    let spacing = Spacing::Length(0.64e-3);
    assert_eq!(nodes(Lattice::Cubic { spacing }), 4131);
}

#[test]
fn volumes_add_up_to_the_shape_and_are_positive() {
    for body in every_kind() {
        let name = format!("{:?}", body.shape);
        let expected = body.shape.volume(body.dimension);
        assert_close(sum(&body.volumes), expected, &name);
        assert!(body.volumes.iter().all(|&volume| volume > 0.0), "{name}");
        assert_close(sum(&body.bonds.volumes), expected, &name);
        assert!(body.bonds.volumes.iter().all(|&v| v > 0.0), "{name}");
    }
}

#[test]
fn nodes_lie_in_the_shape_and_boxes_have_some_on_each_face() {
    for body in every_kind() {
        let (low, high) = body.shape.bounds();
        let tolerance = 1e-12 * (high - low).norm();
        for x in body.positions.iter() {
            assert!(
                body.shape.signed_distance(x) <= tolerance,
                "{:?} {x}",
                body.shape
            );
        }
        for axis in 0..body.dimension.count() {
            let coordinates = body.positions.iter().map(|x| x[axis]);
            assert_eq!(coordinates.clone().fold(f64::INFINITY, f64::min), low[axis]);
            let largest = coordinates.fold(f64::NEG_INFINITY, f64::max);
            assert!((largest - high[axis]).abs() <= tolerance);
        }
    }
}

#[test]
fn inner_nodes_have_the_volume_of_their_weight() {
    for body in every_kind() {
        for (node, &weight) in body.weights.iter().enumerate() {
            if body.boundary[node] {
                // Fewer corners than a full cell, or, in a clipped body, a share of the rest.
                assert!(body.volumes[node] < 1.5 * weight, "{:?} {node}", body.shape);
            } else if is_wound(&body) || !near_rim(&body, node) {
                assert_close(body.volumes[node], weight, "inner node");
            }
        }
    }
}

/// Nodes of clipped bodies within two spacings of the rim share in cells that the circle cuts.
fn near_rim(body: &Body, node: usize) -> bool {
    let step = match body.shape {
        Shape::Box { .. } => return false,
        Shape::Disc { .. } | Shape::Cylinder { .. } => body.weights[node].sqrt().max(body.spacing),
        _ => unreachable!("not in every_kind"),
    };
    body.shape.signed_distance(&body.positions[node]) > -3.0 * step
}

#[test]
fn tributary_volumes_of_boxes_are_halves_quarters_and_eighths() {
    let body = cuboid([3, 4, 5]);
    let cell = 6.0 / (2.0 * 3.0 * 4.0);
    let mut found = HashMap::new();
    for volume in &body.volumes {
        *found
            .entry((8.0 * volume / cell).round() as u32)
            .or_insert(0) += 1;
        let eighths = 8.0 * volume / cell;
        assert!((eighths - eighths.round()).abs() < 1e-12);
    }
    // Corners, edges, faces and inside of a 3 × 4 × 5 lattice.
    let expected = HashMap::from([(1, 8), (2, 4 * (1 + 2 + 3)), (4, 2 * (2 + 3 + 6)), (8, 6)]);
    assert_eq!(found, expected);
}

#[test]
fn inner_bonds_have_a_half_or_a_third_of_a_cell_and_nodes_half_their_bonds() {
    for body in every_kind().into_iter().filter(|body| !is_wound(body)) {
        let bonds = &body.bonds;
        let parts = body.dimension.count() as f64;
        let mut halves = vec![0.0; body.positions.len()];
        let mut inner = 0;
        for (bond, &[a, b]) in bonds.ends.iter().enumerate() {
            let [a, b] = [a as usize, b as usize];
            let along = body.positions[b] - body.positions[a];
            let axis = bonds.directions[bond] as usize;
            assert_eq!(along.iamax(), axis);
            assert!(along[axis] > 0.0);
            if ![a, b]
                .iter()
                .any(|&end| body.boundary[end] || near_rim(&body, end))
            {
                assert_close(bonds.volumes[bond], body.weights[a] / parts, "inner bond");
                inner += 1;
            }
            halves[a] += 0.5 * bonds.volumes[bond];
            halves[b] += 0.5 * bonds.volumes[bond];
        }
        for (half, volume) in halves.iter().zip(&body.volumes) {
            assert_close(*half, *volume, "node volume from bonds");
        }
        let boxed = matches!(body.shape, Shape::Box { .. });
        assert!(inner > 0 || !boxed, "no inner bond in {:?}", body.shape);
    }
}

/// Constants and linears of the axis are integrated exactly by the bonds, those of the section by symmetry.
#[test]
fn bonds_of_rings_have_the_volume_and_the_middle_of_the_body() {
    let wound: Vec<Body> = every_kind().into_iter().filter(is_wound).collect();
    assert_eq!(wound.len(), 4);
    for body in wound {
        let bonds = &body.bonds;
        let volume = body.shape.volume(body.dimension);
        assert_close(sum(&bonds.volumes), volume, "volume of the bonds");
        assert!(bonds.volumes.iter().all(|v| *v > 0.0));
        let moment: Vec3 = bonds
            .midpoints(&body.positions)
            .iter()
            .zip(bonds.volumes.iter())
            .map(|(x, v)| x * *v)
            .sum();
        let (low, high) = body.shape.bounds();
        let error = (moment / volume - (low + high) * 0.5).norm();
        assert!(error < 1e-14, "{error:e}");
        // Neighbours only: nothing longer than two sides of a cell.
        let longest = bonds
            .ends
            .iter()
            .map(|&[a, b]| (body.positions[b as usize] - body.positions[a as usize]).norm())
            .fold(0.0, f64::max);
        assert!(longest < 2.0 * body.support_spacing, "{longest}");
    }
}

/// Volumes by position in units of a hundredth of the spacing, for comparing mirror images.
fn by_place(body: &Body, map: impl Fn(&Vec3) -> Vec3) -> HashMap<[i64; 3], f64> {
    let places = body.positions.iter().map(|x| {
        let x = map(x) * (100.0 / body.spacing);
        [x.x.round() as i64, x.y.round() as i64, x.z.round() as i64]
    });
    places.zip(body.volumes.iter().copied()).collect()
}

#[test]
fn volumes_have_the_mirror_symmetries_of_the_lattice() {
    let bodies = [
        (disc(clipped(5, 1)), 0.0),
        (disc(rings(1)), 0.0),
        (cylinder(Axis::Z, clipped(9, 21)), 32e-3),
        (cylinder(Axis::Z, rings(21)), 32e-3),
    ];
    for (body, height) in bodies {
        let original = by_place(&body, |x| *x);
        let mirrors: [fn(&Vec3, f64) -> Vec3; 4] = [
            |x, _| Vec3::new(-x.x, x.y, x.z),
            |x, _| Vec3::new(x.x, -x.y, x.z),
            |x, _| Vec3::new(x.y, x.x, x.z),
            |x, height| Vec3::new(x.x, x.y, height - x.z),
        ];
        for mirror in mirrors {
            let image = by_place(&body, |x| mirror(x, height));
            assert_eq!(image.len(), original.len());
            for (place, volume) in &image {
                assert_close(*volume, original[place], "mirror image");
            }
        }
    }
}

#[test]
fn bond_volumes_are_mirror_symmetric_too() {
    let body = cylinder(Axis::Z, clipped(5, 6));
    let bonds = &body.bonds;
    let place =
        |x: f64, y: f64, z: f64| [x, y, z].map(|c| (c * 100.0 / body.spacing).round() as i64);
    let midpoints = bonds.midpoints(&body.positions);
    let volumes: HashMap<_, _> = midpoints
        .iter()
        .map(|x| place(x.x, x.y, x.z))
        .zip(bonds.volumes.iter().copied())
        .collect();
    for (x, volume) in midpoints.iter().zip(bonds.volumes.iter()) {
        for image in [
            place(-x.x, x.y, x.z),
            place(x.y, x.x, x.z),
            place(x.x, x.y, 32e-3 - x.z),
        ] {
            assert_close(*volume, volumes[&image], "mirror image of a bond");
        }
    }
}

#[test]
fn boundary_nodes_of_a_clipped_disc_lack_a_neighbour() {
    // Inside are those of the 81 with (|i| + 1)² + j² ≤ 25 and i² + (|j| + 1)² ≤ 25.
    let body = disc(clipped(5, 1));
    let inner = body.boundary.iter().filter(|&&boundary| !boundary).count();
    let expected = (-5..=5_i32)
        .flat_map(|i| (-5..=5_i32).map(move |j| (i.abs(), j.abs())))
        .filter(|(i, j)| (i + 1) * (i + 1) + j * j <= 25 && i * i + (j + 1) * (j + 1) <= 25)
        .count();
    assert_eq!(inner, expected);
}

#[test]
fn spacing_is_the_smallest_distance() {
    for body in every_kind() {
        if body.positions.len() > 1000 {
            continue;
        }
        let mut nearest = f64::INFINITY;
        for (a, x) in body.positions.iter().enumerate() {
            for y in &body.positions[..a] {
                nearest = nearest.min((x - y).norm());
            }
        }
        assert!(
            (nearest / body.spacing - 1.0).abs() < 1e-12,
            "{:?}",
            body.shape
        );
    }
}

#[test]
fn undeformed_cells_are_upright_and_fill_boxes() {
    for body in every_kind() {
        let defects = inverted_cells(&body.cells, &body.positions);
        assert_eq!(defects, CellDefects::default(), "{:?}", body.shape);
    }
    assert_eq!(cuboid([5, 7, 9]).cells.len(), 4 * 6 * 8);
    assert!(matches!(
        rectangle(1.0, 0.5, Spacing::Length(0.05)).cells,
        Cells::Quads(cells) if cells.len() == 20 * 10
    ));
}

#[test]
fn face_areas_add_up_and_point_outwards() {
    for body in every_kind() {
        let mut resultant = Vec3::zeros();
        let mut total = 0.0;
        for face in body.shape.faces(body.dimension) {
            let areas = match face_areas(&body, face) {
                Ok(areas) => areas,
                Err(GeometryError::FaceWithoutArea { .. }) => continue,
                Err(error) => panic!("{error}"),
            };
            let nodes: Vec<u32> = areas.iter().map(|part| part.node).collect();
            assert_eq!(nodes, face_nodes(&body, face).unwrap());
            assert!(nodes.is_sorted());
            for part in &areas {
                assert!(part.area > 0.0 && body.boundary[part.node as usize]);
                assert!((part.normal.norm() - 1.0).abs() < 1e-14);
                let outside = body.positions[part.node as usize] + part.normal * body.spacing;
                // A staircase node may lie up to a diagonal inside of the circle.
                assert!(body.shape.signed_distance(&outside) > -0.5 * body.spacing);
                resultant += part.normal * part.area;
                total += part.area;
            }
        }
        let (low, high) = body.shape.bounds();
        let size = high - low;
        let expected = match (&body.shape, body.dimension) {
            (Shape::Box { .. }, Dimension::PlaneStrain) => 2.0 * (size.x + size.y),
            (Shape::Box { .. }, Dimension::Solid) => {
                2.0 * (size.x * size.y + size.y * size.z + size.z * size.x)
            }
            (Shape::Disc { radius, .. }, _) => 2.0 * PI * radius,
            (Shape::Cylinder { radius, height, .. }, _) => 2.0 * PI * radius * (radius + height),
            _ => unreachable!("not in every_kind"),
        };
        assert_close(total, expected, "surface");
        // A closed surface under constant pressure is in equilibrium.
        assert!(
            resultant.norm() < 1e-12 * total,
            "{:?}: {resultant}",
            body.shape
        );
    }
}

#[test]
fn the_base_of_the_taylor_bar_is_one_layer() {
    // On the circle lie (±5, 0), (0, ±5), (±4, ±3), (±3, ±4); and the outer ring of 32.
    for (lattice, on_rim) in [(clipped(5, 51), 12), (rings(51), 32)] {
        let body = cylinder(Axis::Z, lattice);
        let base = face_areas(&body, "base").unwrap();
        assert_eq!(base.len(), 81);
        assert_close(
            base.iter().map(|part| part.area).sum(),
            PI * 3.2e-3_f64.powi(2),
            "base",
        );
        assert!(
            base.iter()
                .all(|part| part.normal == Vec3::new(0.0, 0.0, -1.0))
        );
        let rim = face_nodes(&body, "rim_base").unwrap();
        assert_eq!(rim.len(), on_rim);
        for node in rim {
            let x = body.positions[node as usize];
            assert_eq!(x.z, 0.0);
            assert_close(x.xy().norm(), 3.2e-3, "radius of the rim");
        }
        assert_eq!(
            face_areas(&body, "rim_base").unwrap_err().to_string(),
            "\"rim_base\" is an edge without area; give tractions on \"side\""
        );
    }
}

#[test]
fn faces_of_boxes_are_where_their_names_say() {
    let body = cuboid([3, 4, 5]);
    let expected = [
        ("left", 0, 0.0, 20),
        ("right", 0, 1.0, 20),
        ("front", 1, 0.0, 15),
        ("back", 1, 2.0, 15),
        ("bottom", 2, 0.0, 12),
        ("top", 2, 3.0, 12),
    ];
    for (face, axis, level, count) in expected {
        let nodes = face_nodes(&body, face).unwrap();
        assert_eq!(nodes.len(), count, "{face}");
        assert!(
            nodes
                .iter()
                .all(|&node| body.positions[node as usize][axis] == level)
        );
    }
    let top = face_nodes(&rectangle(1.0, 0.5, Spacing::Length(0.05)), "top").unwrap();
    assert_eq!(top.len(), 21);
}

#[test]
fn a_million_nodes_keep_exact_volumes() {
    let body = cylinder(Axis::Z, clipped(31, 331));
    assert_eq!(body.positions.len(), 3001 * 331);
    let volume = body.shape.volume(Dimension::Solid);
    assert!((sum(&body.volumes) / volume - 1.0).abs() < 1e-10);
}

#[test]
fn shapes_and_lattices_that_do_not_fit_are_refused() {
    let ball = Shape::Disc {
        centre: Vec3::zeros(),
        radius: 1.0,
    };
    assert!(matches!(
        build_body(ball, clipped(5, 1), Dimension::Solid),
        Err(GeometryError::WrongDimension { .. })
    ));
    let square = Shape::Box {
        min: Vec3::zeros(),
        max: Vec3::repeat(1.0),
    };
    assert_eq!(
        build_body(square, rings(1), Dimension::PlaneStrain)
            .unwrap_err()
            .to_string(),
        "a lattice given by rings cannot fill a box; give a spacing or counts along the axes"
    );
}
