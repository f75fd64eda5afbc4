//! The tree's neighbour lists against a cell list, which shares nothing with it.

use std::collections::HashMap;

use jstsph_geometry::{
    Csr, Dimension, Lattice, Shape, Spacing, build_body, neighbours, neighbours_of,
};
use jstsph_tensor::Vec3;
use proptest::prelude::*;

/// All positions within the radius of each query by sorting positions into cubes of that size.
fn cell_list(queries: &[Vec3], positions: &[Vec3], radius: f64) -> Vec<Vec<u32>> {
    let cell = |x: &Vec3| [x.x, x.y, x.z].map(|c| (c / (1.001 * radius)).floor() as i64);
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for (i, x) in positions.iter().enumerate() {
        cells.entry(cell(x)).or_default().push(i as u32);
    }
    let limit = radius * radius * (1.0 + 1e-9);
    queries
        .iter()
        .map(|x| {
            let [i, j, k] = cell(x);
            let mut row = Vec::new();
            for offset in 0..27 {
                let near = [
                    i + offset % 3 - 1,
                    j + offset / 3 % 3 - 1,
                    k + offset / 9 - 1,
                ];
                let candidates = cells.get(&near).map_or(&[][..], Vec::as_slice);
                row.extend(
                    candidates
                        .iter()
                        .filter(|&&c| (positions[c as usize] - x).norm_squared() <= limit),
                );
            }
            row.sort_unstable();
            row
        })
        .collect()
}

fn assert_same(lists: &Csr, expected: &[Vec<u32>], what: &str) {
    assert_eq!(lists.rows(), expected.len());
    for (row, expected) in expected.iter().enumerate() {
        assert_eq!(lists.row(row), expected, "{what}, row {row}");
    }
}

fn agree(positions: &[Vec3], radius: f64, what: &str) {
    let mut expected = cell_list(positions, positions, radius);
    assert_same(
        &neighbours_of(positions, positions, radius),
        &expected,
        what,
    );
    for (i, row) in expected.iter_mut().enumerate() {
        row.retain(|&other| other as usize != i);
    }
    let lists = neighbours(positions, radius);
    assert_same(&lists, &expected, what);
    assert_eq!(
        lists.transposed(positions.len()),
        lists,
        "{what} is not symmetric"
    );
}

fn box_body(counts: [usize; 3], dimension: Dimension) -> jstsph_geometry::Body {
    let shape = Shape::Box {
        min: Vec3::zeros(),
        max: Vec3::from_fn(|i, _| 0.1 * (counts[i].max(2) - 1) as f64),
    };
    let spacing = Spacing::Counts(counts);
    build_body(shape, Lattice::Cubic { spacing }, dimension).unwrap()
}

#[test]
fn lattices_agree_at_radii_that_neighbours_lie_on() {
    for counts in [[9, 8, 7], [40, 3, 2], [2, 2, 2]] {
        let body = box_body(counts, Dimension::Solid);
        for radius in [0.1, 0.1 * 2.0_f64.sqrt(), 0.2, 0.3, 0.24] {
            agree(&body.positions, radius, &format!("{counts:?} at {radius}"));
        }
    }
    // Hundreds of equal coordinates along z and along lines.
    let plate = box_body([64, 41, 1], Dimension::PlaneStrain);
    agree(&plate.positions, 0.2, "plate");
    agree(
        &box_body([2000, 2, 1], Dimension::PlaneStrain).positions,
        0.5,
        "strip",
    );
}

#[test]
fn whole_number_coordinates_agree() {
    let positions: Vec<Vec3> = (0..1000)
        .map(|i| {
            Vec3::new(
                f64::from(i % 10),
                f64::from(i / 10 % 10),
                f64::from(i / 100),
            )
        })
        .collect();
    for radius in [1.0, 2.0, 3.0] {
        agree(&positions, radius, "whole numbers");
    }
}

#[test]
fn bond_midpoints_find_the_nodes_around_them() {
    let body = box_body([9, 8, 7], Dimension::Solid);
    let midpoints = &body.bonds.midpoints(&body.positions);
    for radius in [0.16, 0.05, 0.05 * 5.0_f64.sqrt()] {
        let expected = cell_list(midpoints, &body.positions, radius);
        assert_same(
            &neighbours_of(midpoints, &body.positions, radius),
            &expected,
            "bonds",
        );
    }
}

#[test]
fn duplicates_are_neighbours_of_each_other() {
    // More coincident points than a leaf of the tree holds.
    let mut positions = vec![Vec3::new(0.5, 0.5, 0.5); 100];
    positions.extend((0..100).map(|i| Vec3::new(0.01 * f64::from(i), 0.5, 0.5)));
    agree(&positions, 0.1, "duplicates");
    assert_eq!(neighbours(&positions[..100], 0.0).row(7).len(), 99);
}

#[test]
fn a_lattice_of_a_hundred_thousand_agrees() {
    let body = box_body([50, 50, 40], Dimension::Solid);
    assert_eq!(body.positions.len(), 100_000);
    agree(&body.positions, 0.2, "1e5");
    // 1 + 6 + 12 + 8 + 6 nodes within two spacings, for those far enough from the faces.
    let lists = neighbours(&body.positions, 0.2);
    let full = (0..lists.rows())
        .filter(|&i| lists.row(i).len() == 32)
        .count();
    assert_eq!(full, 46 * 46 * 36);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn random_sets_agree(
        points in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 1..400),
        radius in 0.05..1.0_f64,
    ) {
        let positions: Vec<Vec3> = points.into_iter().map(Vec3::from).collect();
        agree(&positions, radius, "random");
    }
}
