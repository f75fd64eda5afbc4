use jstsph_geometry::{Body, Dimension, Lattice, Shape, Spacing, build_body};
use jstsph_tensor::Mat3;

use super::*;
use crate::testing::{Random, jittered_box, support_of};

const DIMENSIONS: [Dimension; 2] = [Dimension::PlaneStrain, Dimension::Solid];

/// A bar along the last axis of its dimension.
fn bar(dimension: Dimension) -> Body {
    let (counts, spacing) = match dimension {
        Dimension::Solid => ([5, 4, 37], 0.1),
        Dimension::PlaneStrain => ([6, 51, 1], 0.1),
    };
    let shape = Shape::Box {
        min: Vec3::zeros(),
        max: Vec3::from_fn(|i, _| spacing * (counts[i] - 1) as f64),
    };
    let spacing = Spacing::Counts(counts);
    build_body(shape, Lattice::Cubic { spacing }, dimension).unwrap()
}

/// Operators at particles and at bonds, each with its points.
fn operators(body: &Body) -> [(GradientOperator, Vec<Vec3>); 2] {
    let midpoints = body.bonds.midpoints(&body.positions);
    let nodal =
        GradientOperator::at_particles(&body.positions, &body.weights, &support_of(body, 1.2));
    let bonds = GradientOperator::at_points(&midpoints, &body.positions, &support_of(body, 0.8));
    [
        (nodal.unwrap(), body.positions.to_vec()),
        (bonds.unwrap(), midpoints),
    ]
}

fn lines_of(
    body: &Body,
    (operator, points): &(GradientOperator, Vec<Vec3>),
) -> Option<LineOperator> {
    LineOperator::new(operator, &body.positions, points, body.spacing)
}

/// A field in its lines, not a number where nothing may be read.
fn arranged<const N: usize>(
    lines: Lines<'_>,
    value: impl Fn(usize) -> [f64; N],
) -> Vec<LaneRow<N>> {
    let mut field = vec![LaneRow([[f64::NAN; WIDTH]; N]); lines.rows()];
    for (piece, rows) in field.chunks_mut(lines.rows_of_piece()).enumerate() {
        lines.arrange(piece, &value, rows);
    }
    field
}

/// What `pass(piece, rows)` writes, by items.
fn summed<const N: usize>(
    lines: Lines<'_>,
    pass: impl Fn(usize, &mut [LaneRow<N>]),
) -> Vec<Option<[f64; N]>> {
    let mut field = vec![LaneRow::ZERO; lines.rows()];
    for (piece, rows) in field.chunks_mut(lines.rows_of_piece()).enumerate() {
        pass(piece, rows);
    }
    let at = |&slot: &u32| (slot != LineOperator::ALONE).then(|| LaneRow::at(&field, slot));
    lines.slots().iter().map(at).collect()
}

/// The number of items that have a sum; each must have the expected one.
fn compare<const N: usize>(
    found: &[Option<[f64; N]>],
    expected: impl Fn(usize) -> [f64; N],
) -> usize {
    let there = found
        .iter()
        .enumerate()
        .filter_map(|(i, sum)| Some((i, (*sum)?)));
    there
        .map(|(i, sum)| assert_eq!(sum, expected(i), "item {i}"))
        .count()
}

#[test]
fn sums_in_space_have_the_bits_of_single_rows() {
    let body = bar(Dimension::Solid);
    for operator in operators(&body) {
        let lines = lines_of(&body, &operator).unwrap();
        let operator = operator.0;
        let mut random = Random(5);
        let field: Vec<[f64; 4]> = (0..operator.particles())
            .map(|_| std::array::from_fn(|_| random.number()))
            .collect();
        let mut gradients = vec![Mat3::zeros(); operator.points()];
        operator.scaled_gradients(0, &field, 0.7, &mut gradients);
        let field = arranged(lines.particles(), |a| {
            [field[a][0], field[a][1], field[a][2]]
        });
        let found = summed(lines.points(), |piece, out| {
            lines.gradients(piece, &field, 0.7, out);
        });
        let expected = |q: usize| *gradients[q].as_slice().as_array().unwrap();
        let compared = compare::<9>(&found, expected);
        assert!(compared > operator.points() / 2);

        let tensors: Vec<Mat3> = (0..operator.points()).map(|_| random.tensor()).collect();
        let mut forces = vec![Vec3::zeros(); operator.particles()];
        operator.divergences(0, &tensors, &mut forces);
        let tensors = arranged::<9>(lines.points(), |q| {
            *tensors[q].as_slice().as_array().unwrap()
        });
        let found = summed(lines.particles(), |piece, out| {
            lines.divergences(piece, &tensors, out);
        });
        let compared = compare::<3>(&found, |a| forces[a].into());
        assert!(compared > operator.particles() / 2);
    }
}

#[test]
fn sums_in_the_plane_have_the_bits_of_single_rows() {
    let body = bar(Dimension::PlaneStrain);
    for operator in operators(&body) {
        let lines = lines_of(&body, &operator).unwrap();
        let operator = operator.0;
        let mut random = Random(7);
        let field: Vec<[f64; 4]> = (0..operator.particles())
            .map(|_| [random.number(), random.number(), 0.0, 0.0])
            .collect();
        let mut gradients = vec![Mat3::zeros(); operator.points()];
        operator.scaled_gradients(0, &field, 0.7, &mut gradients);
        let field = arranged(lines.particles(), |a| [field[a][0], field[a][1]]);
        let found = summed(lines.points(), |piece, out| {
            lines.gradients(piece, &field, 0.7, out);
        });
        let expected = |q: usize| {
            let g = &gradients[q];
            [g.m11, g.m21, g.m12, g.m22]
        };
        assert!(compare::<4>(&found, expected) > operator.points() / 2);

        let tensors: Vec<Mat3> = (0..operator.points()).map(|_| random.tensor()).collect();
        let mut forces = vec![Vec3::zeros(); operator.particles()];
        operator.divergences(0, &tensors, &mut forces);
        let tensors = arranged::<4>(lines.points(), |q| {
            let s = &tensors[q];
            [s.m11, s.m21, s.m12, s.m22]
        });
        let found = summed(lines.particles(), |piece, out| {
            lines.divergences(piece, &tensors, out);
        });
        let compared = compare::<2>(&found, |a| [forces[a].x, forces[a].y]);
        assert!(compared > operator.particles() / 2);
    }
}

/// Fraction of the items that have their sum in the lines.
fn share(lines: Lines<'_>) -> f64 {
    let slots = lines.slots();
    let there = slots.iter().filter(|slot| **slot != LineOperator::ALONE);
    there.count() as f64 / slots.len() as f64
}

#[test]
fn most_items_of_long_lines_are_in_them_and_irregular_bodies_have_none() {
    for body in DIMENSIONS.map(bar) {
        let [_, bonds] = operators(&body);
        let lines = lines_of(&body, &bonds).unwrap();
        let (points, particles) = (share(lines.points()), share(lines.particles()));
        assert!(points > 0.85 && particles > 0.75, "{points}, {particles}");
    }
    for body in [jittered_box(17, 2), jittered_box(7, 3)] {
        for operator in operators(&body) {
            assert!(lines_of(&body, &operator).is_none());
        }
    }
}
