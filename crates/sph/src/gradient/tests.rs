use jstsph_geometry::Body;
use jstsph_tensor::double_dot;

use super::*;
use crate::testing::{Random, assert_order, jittered_box, support_of, unit_box};

/// Both operators of a body, each with its evaluation points.
fn operators(body: &Body) -> [(GradientOperator, Vec<Vec3>); 2] {
    let midpoints = body.bonds.midpoints(&body.positions);
    let nodal =
        GradientOperator::at_particles(&body.positions, &body.weights, &support_of(body, 1.2));
    let bonds = GradientOperator::at_points(&midpoints, &body.positions, &support_of(body, 0.9));
    [
        (nodal.unwrap(), body.positions.to_vec()),
        (bonds.unwrap(), midpoints),
    ]
}

/// Bodies on which operators must do well without the help of symmetry.
fn irregular_bodies() -> [Body; 2] {
    [jittered_box(13, 2), jittered_box(7, 3)]
}

/// Largest error of the gradient of `field` over the points that `chosen` selects.
fn gradient_error(
    (operator, points): &(GradientOperator, Vec<Vec3>),
    body: &Body,
    field: impl Fn(&Vec3) -> Vec3,
    exact: impl Fn(&Vec3) -> Mat3,
    chosen: impl Fn(&Vec3) -> bool,
) -> f64 {
    let values: Vec<Vec3> = body.positions.iter().map(field).collect();
    let mut selected = 0;
    let error = (0..points.len())
        .filter(|q| chosen(&points[*q]))
        .inspect(|_| selected += 1)
        .map(|q| (operator.gradient_at(q, &values) - exact(&points[q])).norm())
        .fold(0.0, f64::max);
    assert!(selected > 0, "no point was chosen");
    error
}

/// Whether the support of a point lies inside the unit square or cube.
fn is_interior(x: &Vec3, dimension: usize, radius: f64) -> bool {
    x.iter()
        .take(dimension)
        .all(|c| *c > radius && *c < 1.0 - radius)
}

#[test]
fn linear_fields_have_exact_gradients_on_irregular_particles() {
    for body in irregular_bodies() {
        let d = body.dimension.count();
        let plane = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, if d == 2 { 0.0 } else { 1.0 }));
        let slope = plane * Random(3).tensor() * plane;
        let constant = Vec3::new(4.0, -2.0, if d == 2 { 0.0 } else { 1.5 });
        for operator in operators(&body) {
            let error = gradient_error(
                &operator,
                &body,
                |x| slope * x + constant,
                |_| slope,
                |_| true,
            );
            // Entries of B are of size 1/Δx ≈ 10 and the field of size 5: round-off is 1e-14.
            assert!(error < 1e-12, "d = {d}: {error:e}");
        }
    }
}

#[test]
fn rows_sum_to_zero() {
    for body in irregular_bodies() {
        for (operator, points) in operators(&body) {
            for q in 0..points.len() {
                let weights = operator.row(q).weights;
                let sum: Vec3 = weights.iter().map(|w| Vec3::from(*w)).sum();
                let size: f64 = weights.iter().map(|w| Vec3::from(*w).norm()).sum();
                assert!(
                    sum.norm() < 1e-13 * size,
                    "point {q}: {:e} of {size:e}",
                    sum.norm()
                );
            }
        }
    }
}

#[test]
fn quadratic_fields_have_exact_gradients_inside_a_lattice() {
    // Stencils inside are symmetric about their point, so that even terms cancel.
    for (nodes, d) in [(13, 2), (9, 3)] {
        let body = unit_box(nodes, d);
        let out_of_plane = if d == 2 { 0.0 } else { 1.0 };
        let field = |x: &Vec3| {
            Vec3::new(
                x.x * x.y + x.y * x.y,
                x.x * x.x - x.y * x.z,
                out_of_plane * x.z * x.x,
            )
        };
        let exact = |x: &Vec3| {
            let (a, b) = (out_of_plane * -x.y, out_of_plane * x.z);
            let c = out_of_plane * x.x;
            Mat3::new(
                x.y,
                x.x + 2.0 * x.y,
                0.0,
                2.0 * x.x,
                -out_of_plane * x.z,
                a,
                b,
                0.0,
                c,
            )
        };
        for operator in operators(&body) {
            let radius = 2.4 * body.spacing;
            let error = gradient_error(&operator, &body, field, exact, |x| {
                is_interior(x, d, radius)
            });
            assert!(error < 1e-12, "d = {d}: {error:e}");
        }
    }
}

#[test]
fn gradients_are_second_order_inside_and_first_order_at_the_boundary() {
    for (d, sizes) in [(2, &[17, 33, 65][..]), (3, &[11, 21][..])] {
        let phase = |x: &Vec3| 2.0 * x.x + 1.5 * x.y + x.z;
        let field = |x: &Vec3| Vec3::new(phase(x).sin(), phase(x).cos(), 0.0);
        let exact = |x: &Vec3| {
            let along = Vec3::new(2.0, 1.5, if d == 2 { 0.0 } else { 1.0 });
            Vec3::new(phase(x).cos(), -phase(x).sin(), 0.0) * along.transpose()
        };
        // The same region on every lattice, clear of the coarsest one's boundary.
        let margin = 2.4 / (sizes[0] - 1) as f64;
        let mut errors = [[Vec::new(), Vec::new()], [Vec::new(), Vec::new()]];
        for nodes in sizes {
            let body = unit_box(*nodes, d);
            for (operator, [inside, everywhere]) in operators(&body).iter().zip(&mut errors) {
                let error = |chosen: &dyn Fn(&Vec3) -> bool| {
                    gradient_error(operator, &body, field, exact, chosen)
                };
                inside.push(error(&|x| is_interior(x, d, margin)));
                everywhere.push(error(&|_| true));
            }
        }
        for [inside, everywhere] in errors {
            assert_order(&inside, 2.0, 0.1);
            assert_order(&everywhere, 1.0, 0.2);
        }
    }
}

#[test]
fn forces_of_any_stress_have_no_resultant() {
    let mut random = Random(11);
    for body in irregular_bodies() {
        for (operator, points) in operators(&body) {
            let stresses: Vec<Mat3> = points.iter().map(|_| random.tensor() * 1e9).collect();
            let forces: Vec<Vec3> = (0..operator.particles())
                .map(|c| operator.divergence_at(c, &stresses))
                .collect();
            let resultant: Vec3 = forces.iter().sum();
            let total: f64 = forces.iter().map(Vec3::norm).sum();
            assert!(
                resultant.norm() < 1e-13 * total,
                "{:e} of {total:e}",
                resultant.norm()
            );
        }
    }
}

#[test]
fn force_and_gradient_are_dual() {
    // Σ_c v_c · Σ_q S_q B_qc = Σ_q S_q : Σ_c v_c ⊗ B_qc: internal power is the same on both sides.
    let mut random = Random(13);
    for body in irregular_bodies() {
        let d = body.dimension.count();
        for (operator, points) in operators(&body) {
            let stresses: Vec<Mat3> = points.iter().map(|_| random.tensor()).collect();
            let velocities: Vec<Vec3> =
                body.positions.iter().map(|_| random.vector_in(d)).collect();
            let (mut of_forces, mut of_stresses, mut size) = (0.0, 0.0, 0.0);
            for (c, velocity) in velocities.iter().enumerate() {
                let power = velocity.dot(&operator.divergence_at(c, &stresses));
                of_forces += power;
                size += power.abs();
            }
            for (q, stress) in stresses.iter().enumerate() {
                of_stresses += double_dot(stress, &operator.gradient_at(q, &velocities));
            }
            let defect = (of_forces - of_stresses).abs();
            assert!(defect < 1e-13 * size, "d = {d}: {defect:e} of {size:e}");
        }
    }
}

#[test]
fn plane_strain_has_no_out_of_plane_gradient_and_force() {
    let body = jittered_box(9, 2);
    let mut random = Random(17);
    for (operator, points) in operators(&body) {
        // Out-of-plane entries of the fields must not leak into the plane or out of it.
        let field: Vec<Vec3> = body.positions.iter().map(|_| random.vector()).collect();
        let stresses: Vec<Mat3> = points.iter().map(|_| random.tensor()).collect();
        let gradient = operator.gradient_at(points.len() / 2, &field);
        assert_eq!(gradient.row(2).norm(), 0.0);
        assert_eq!(gradient.column(2).norm(), 0.0);
        assert!(gradient.norm() > 0.1);
        assert_eq!(operator.divergence_at(40, &stresses).z, 0.0);
    }
}

#[test]
fn inner_points_of_a_lattice_share_their_weights() {
    for (d, coarse, fine) in [(2, 21, 41), (3, 9, 17)] {
        let (small, large) = (
            operators(&unit_box(coarse, d)),
            operators(&unit_box(fine, d)),
        );
        for ((small, _), (large, _)) in small.iter().zip(&large) {
            // Rows and columns together have twice the entries; what is stored are the stencils
            // near faces, edges and corners, whose number does not grow with the body.
            assert!(large.stored_weights() <= small.stored_weights());
            assert!(large.entry_count() > 3 * small.entry_count());
        }
    }
    for (operator, _) in operators(&unit_box(41, 2)) {
        let (stored, entries) = (operator.stored_weights(), 2 * operator.entry_count());
        assert!(20 * stored < entries, "{stored} of {entries}");
    }
}

#[test]
fn irregular_particles_keep_their_own_weights() {
    for (operator, _) in operators(&jittered_box(13, 2)) {
        assert_eq!(operator.stored_weights(), 2 * operator.entry_count());
    }
}

#[test]
fn a_particle_whose_neighbours_are_collinear_is_named() {
    let line: Vec<Vec3> = (0..5)
        .map(|i| Vec3::new(f64::from(i) * 0.1, 0.25, 0.0))
        .collect();
    let support = Support {
        kernel: crate::Kernel::QuinticSpline,
        smoothing_length: 0.12,
        dimension: 2,
    };
    let error = GradientOperator::at_particles(&line, &[0.01; 5], &support).unwrap_err();
    assert_eq!(
        error.to_string(),
        "particle 0 at (0.000000e0, 2.500000e-1, 0.000000e0) m has 2 particles within its support \
         radius 2.4000e-1 m, which do not determine a gradient (condition number inf, limit 1.0e6); \
         increase the smoothing ratio"
    );
}

#[test]
fn points_with_too_few_particles_are_refused() {
    let body = unit_box(5, 2);
    let support = support_of(&body, 0.9);
    let refused = |point: Vec3, found: usize| {
        let points = [Vec3::new(0.5, 0.5, 0.0), point];
        match GradientOperator::at_points(&points, &body.positions, &support) {
            Err(SphError::TooFewNeighbours {
                what,
                index,
                neighbours,
                condition,
                limit,
                ..
            }) => {
                assert_eq!((what, index, neighbours), ("evaluation point", 1, found));
                assert!(condition > limit, "{condition}");
            }
            other => panic!("expected an error, found {other:?}"),
        }
    };
    refused(Vec3::new(9.0, 9.0, 0.0), 0);
    refused(Vec3::new(1.44, 1.0, 0.0), 1);
    // Particles of zero mutual offset do not count as neighbours at all.
    let coincident = [Vec3::zeros(); 4];
    assert!(GradientOperator::at_particles(&coincident, &[1.0; 4], &support).is_err());
}
