use jstsph_geometry::{Body, face_areas};

use super::*;
use crate::testing::{Random, inside_jittered_box, support_of, unit_box};
use crate::{Kernel, Support};

/// A body whose nodes lie on its boundary, with its surface and the operator of its particles.
fn particles(body: &Body, ratio: f64) -> (GradientOperator, Vec<Vec3>) {
    let support = support_of(body, ratio);
    let operator = GradientOperator::at_particles(&body.positions, &body.weights, &support);
    let mut surface = vec![Vec3::zeros(); body.positions.len()];
    for face in body.shape.faces(body.dimension) {
        for part in face_areas(body, face).unwrap() {
            surface[part.node as usize] += part.normal * part.area;
        }
    }
    (operator.unwrap(), surface)
}

fn largest_defect(operator: &GradientOperator, body: &Body, surface: &[Vec3]) -> f64 {
    operator
        .boundary_vectors(&body.volumes)
        .iter()
        .zip(surface)
        .fold(0.0, |largest, (found, wanted)| {
            largest.max((found - wanted).norm())
        })
}

#[test]
fn irregular_bodies_sum_by_parts_afterwards() {
    for (nodes, d) in [(13, 2), (8, 3)] {
        let body = inside_jittered_box(nodes, d);
        let face = body.spacing.powi(d as i32 - 1);
        let (operator, surface) = particles(&body, 1.2);
        let before = largest_defect(&operator, &body, &surface);
        assert!(before > 0.05 * face, "nothing to correct: {before:e}");
        let (corrected, report) =
            operator.summing_by_parts(&body.positions, &body.volumes, &surface, 1e-6 * face);
        let after = largest_defect(&corrected, &body, &surface);
        // The conjugate gradients reduce the norm over all particles by 1e-4.
        assert!(after < 1e-3 * before, "d = {d}: {before:e} to {after:e}");
        assert!(report.iterations < 1000, "{report:?}");
        // A correction, not another operator: entries of B are of size one over h.
        assert!(report.change < 0.3, "{report:?}");
    }
}

#[test]
fn constants_and_linears_stay_exact() {
    let mut random = Random(9);
    for (nodes, d) in [(13, 2), (8, 3)] {
        let body = inside_jittered_box(nodes, d);
        let (operator, surface) = particles(&body, 1.2);
        let (corrected, _) =
            operator.summing_by_parts(&body.positions, &body.volumes, &surface, 1e-9);
        let plane = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, if d == 2 { 0.0 } else { 1.0 }));
        let slope = plane * random.tensor() * plane;
        let constant = random.vector_in(d) * 5.0;
        let field: Vec<Vec3> = body
            .positions
            .iter()
            .map(|x| slope * x + constant)
            .collect();
        for q in 0..corrected.points() {
            let error = (corrected.gradient_at(q, &field) - slope).norm();
            // Entries of B are of size 1/Δx ≈ 10 and the field of size 5: round-off is 1e-14.
            assert!(error < 1e-12, "d = {d}, point {q}: {error:e}");
        }
    }
}

#[test]
fn an_operator_without_defects_stays_as_it_is() {
    let body = unit_box(9, 2);
    let (operator, surface) = particles(&body, 0.75);
    let (same, report) = operator.summing_by_parts(
        &body.positions,
        &body.volumes,
        &surface,
        1e-5 * body.spacing,
    );
    assert_eq!(report.points, 0);
    for q in 0..operator.points() {
        assert_eq!(operator.row(q), same.row(q));
    }
}

#[test]
fn the_correction_is_the_smallest_one() {
    // Any other correction that keeps constants, linears and the sums differs from this one by an
    // element of the null space of the constraints, and δ is orthogonal to that: Σ_q V_q δ_q : ε_q = 0.
    let body = inside_jittered_box(7, 2);
    let (operator, surface) = particles(&body, 1.2);
    let (corrected, _) = operator.summing_by_parts(&body.positions, &body.volumes, &surface, 1e-9);
    let delta = |q: usize| -> Vec<Vec3> {
        let pairs = corrected.row(q).weights.iter().zip(operator.row(q).weights);
        pairs
            .map(|(a, b)| Vec3::from(*a) - Vec3::from(*b))
            .collect()
    };
    // An element of that null space: the change from another surface-preserving correction, obtained
    // from an operator that starts elsewhere and ends with the same sums.
    let support = Support {
        kernel: Kernel::WendlandC2,
        ..support_of(&body, 1.2)
    };
    let other_kernel =
        GradientOperator::at_particles(&body.positions, &body.weights, &support).unwrap();
    let (other, _) = other_kernel.summing_by_parts(&body.positions, &body.volumes, &surface, 1e-9);
    let (mut product, mut size) = (0.0, 0.0);
    for q in 0..operator.points() {
        let (first, second) = (corrected.row(q), other.row(q));
        assert!(
            first.indices().eq(second.indices()),
            "the supports must reach the same particles"
        );
        for ((a, b), d) in second.weights.iter().zip(first.weights).zip(delta(q)) {
            let difference = Vec3::from(*a) - Vec3::from(*b);
            product += body.volumes[q] * d.dot(&difference);
            size += body.volumes[q] * d.norm() * difference.norm();
        }
    }
    assert!(
        // Two solutions that are good to 1e-4 each.
        size > 0.0 && product.abs() < 1e-5 * size,
        "{product:e} of {size:e}"
    );
}
