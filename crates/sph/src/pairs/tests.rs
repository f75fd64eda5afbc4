use jstsph_geometry::Body;
use nalgebra::{DMatrix, DVector};

use super::*;
use crate::testing::{Random, jittered_box, support_of, unit_box};

fn symmetric(body: &Body) -> PairOperator {
    PairOperator::symmetric(&body.positions, &body.volumes, &support_of(body, 1.2)).unwrap()
}

fn corrected(body: &Body) -> PairOperator {
    let support = support_of(body, 1.2);
    let gradient =
        GradientOperator::at_particles(&body.positions, &body.weights, &support).unwrap();
    PairOperator::corrected(&body.positions, &body.volumes, &gradient, &support).unwrap()
}

/// The operator as a matrix: ℓ_ab off the diagonal, −Σ_b ℓ_ab on it.
fn matrix(operator: &PairOperator) -> DMatrix<f64> {
    let n = operator.particles();
    let mut matrix = DMatrix::zeros(n, n);
    for a in 0..n {
        for (b, weight) in operator.row(a).entries() {
            matrix[(a, b)] += weight;
            matrix[(a, a)] -= weight;
        }
    }
    matrix
}

fn bodies() -> [Body; 4] {
    [
        unit_box(9, 2),
        jittered_box(9, 2),
        unit_box(5, 3),
        jittered_box(5, 3),
    ]
}

#[test]
fn symmetric_weights_are_symmetric_and_positive() {
    for body in bodies() {
        let operator = symmetric(&body);
        let mut pairs = 0;
        for a in 0..operator.particles() {
            let row = operator.row(a);
            assert!(row.indices().is_sorted_by(|one, next| one < next));
            for (b, weight) in row.entries() {
                let other = operator.row(b);
                let (place, back) = (other.indices().position(|c| c == a), other.weights);
                let place = place.expect("pairs are mutual");
                let (one, other) = (body.volumes[a] * weight, body.volumes[b] * back[place]);
                assert!(*weight > 0.0);
                // Weights are shared between particles of a lattice within 1e-11 of the largest.
                assert!(
                    (one - other).abs() < 1e-11 * one.abs(),
                    "{a}, {b}: {one} {other}"
                );
                pairs += 1;
            }
        }
        assert_eq!(pairs, operator.entry_count());
    }
}

#[test]
fn symmetric_laplacian_conserves_and_removes_energy() {
    let mut random = Random(5);
    for body in bodies() {
        let operator = symmetric(&body);
        for _ in 0..5 {
            let field: Vec<Vec3> = body.positions.iter().map(|_| random.vector()).collect();
            let (mut sum, mut size, mut energy) = (Vec3::zeros(), 0.0, 0.0);
            let mut differences = 0.0;
            for (a, volume) in body.volumes.iter().enumerate() {
                let laplacian = operator.difference_at(a, &field) * *volume;
                sum += laplacian;
                size += laplacian.norm();
                energy += field[a].dot(&laplacian);
                for (b, weight) in operator.row(a).entries() {
                    let difference = field[b] - field[a];
                    differences -= 0.5 * volume * weight * difference.norm_squared();
                }
                let components = [0, 1, 2].map(|i| {
                    let scalar: Vec<f64> = field.iter().map(|f| f[i]).collect();
                    operator.scalar_difference_at(a, &scalar) * volume
                });
                assert!((laplacian - Vec3::from(components)).norm() <= 1e-14 * laplacian.norm());
            }
            assert!(sum.norm() < 1e-13 * size, "{:e} of {size:e}", sum.norm());
            assert!(energy < 0.0);
            assert!(
                (energy / differences - 1.0).abs() < 1e-12,
                "{energy} {differences}"
            );
        }
    }
}

#[test]
fn eigenvalues_of_the_symmetric_laplacian_lie_between_its_bound_and_zero() {
    for body in bodies() {
        let operator = symmetric(&body);
        let matrix = matrix(&operator);
        // V^½ A V^−½ is symmetric and has the same eigenvalues.
        let root =
            DVector::from_iterator(body.volumes.len(), body.volumes.iter().map(|v| v.sqrt()));
        let similar =
            DMatrix::from_diagonal(&root) * matrix * DMatrix::from_diagonal(&root.map(|r| 1.0 / r));
        let mut values: Vec<f64> = similar.symmetric_eigenvalues().iter().copied().collect();
        values.sort_by(f64::total_cmp);
        let (bound, n) = (operator.spectral_bound(), values.len());
        assert!(
            -values[0] <= bound * (1.0 + 1e-12),
            "{} of {bound}",
            values[0]
        );
        // Gershgorin's bound is of use to a time step: not more than a factor of two off.
        assert!(-values[0] > 0.5 * bound, "{} of {bound}", values[0]);
        // Only constants belong to zero; the next is −π² on a fine lattice of the unit square or cube.
        assert!(values[n - 1].abs() < 1e-12 * bound, "{}", values[n - 1]);
        assert!(
            values[n - 2] < -0.25 * std::f64::consts::PI.powi(2),
            "{}",
            values[n - 2]
        );
    }
}

#[test]
fn corrected_laplacian_vanishes_on_linear_fields_up_to_the_boundary() {
    let mut random = Random(19);
    for body in bodies() {
        let (operator, plain) = (corrected(&body), symmetric(&body));
        let d = body.dimension.count();
        let slope = random.tensor();
        let field: Vec<Vec3> = body.positions.iter().map(|x| slope * x).collect();
        let size = body.spacing * slope.norm() * operator.spectral_bound();
        let largest = |operator: &PairOperator| {
            (0..field.len())
                .map(|a| operator.difference_at(a, &field).norm())
                .fold(0.0, f64::max)
        };
        assert!(
            largest(&operator) < 1e-12 * size,
            "d = {d}: {:e}",
            largest(&operator) / size
        );
        // Without the correction boundary particles see a slope as a source.
        assert!(
            largest(&plain) > 0.01 * size,
            "d = {d}: {:e}",
            largest(&plain) / size
        );
    }
}

#[test]
fn corrected_laplacian_of_a_paraboloid_is_exact_inside() {
    for (body, inner) in [
        (unit_box(13, 2), 0.3),
        (jittered_box(13, 2), 0.3),
        (unit_box(9, 3), 0.35),
    ] {
        let operator = corrected(&body);
        let d = body.dimension.count();
        let field: Vec<f64> = body.positions.iter().map(Vec3::norm_squared).collect();
        let mut inside = 0;
        for (a, x) in body.positions.iter().enumerate() {
            if x.iter().take(d).all(|c| (c - 0.5).abs() < inner) {
                let laplacian = operator.scalar_difference_at(a, &field);
                assert!(
                    (laplacian / (2.0 * d as f64) - 1.0).abs() < 1e-11,
                    "{a}: {laplacian}"
                );
                inside += 1;
            }
        }
        assert!(inside >= 27);
    }
}

#[test]
fn corrected_laplacian_diffuses_stably_up_to_its_bound() {
    // Heat flow by explicit steps of nearly 2 over the bound: the fastest decaying field is at its
    // limit, and a positive eigenvalue would have grown beyond every limit.
    let mut random = Random(23);
    for body in bodies() {
        let operator = corrected(&body);
        let dt = 1.99 / operator.spectral_bound();
        let mut field: Vec<f64> = body.positions.iter().map(|_| random.number()).collect();
        for _ in 0..5000 {
            let rate: Vec<f64> = (0..field.len())
                .map(|a| operator.scalar_difference_at(a, &field))
                .collect();
            field
                .iter_mut()
                .zip(&rate)
                .for_each(|(f, rate)| *f += dt * rate);
        }
        let largest = field
            .iter()
            .fold(0.0, |largest: f64, f| largest.max(f.abs()));
        assert!(largest < 10.0, "{largest}");
    }
}

#[test]
fn weights_of_a_lattice_are_found_from_neighbours_alone() {
    // In one direction of a square lattice with 2h < 2 Δx, by hand: the four (or five) neighbours.
    let body = unit_box(5, 2);
    let support = support_of(&body, 0.6);
    let operator = PairOperator::symmetric(&body.positions, &body.volumes, &support).unwrap();
    let expected = -2.0 * body.volumes[12] * support.derivative_over_radius(body.spacing);
    let row = operator.row(12);
    assert!(row.indices().eq([7, 11, 13, 17]));
    for weight in row.weights {
        assert!((weight / expected - 1.0).abs() < 1e-12);
    }
    assert!((operator.spectral_bound() / (8.0 * expected) - 1.0).abs() < 1e-12);
}
