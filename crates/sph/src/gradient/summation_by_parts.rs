//! How nearly Σ_q V_q B_qc is the outward area vector of particle c: docs/theory.md,
//! `[eq:summation-by-parts]`, `[eq:area-vectors]`.

use jstsph_geometry::{Body, face_areas};
use jstsph_tensor::{Mat3, Vec3};

use crate::GradientOperator;
use crate::testing::{support_of, unit_box};

/// Outward area vectors of the nodes: zero inside.
fn area_vectors(body: &Body) -> Vec<Vec3> {
    let mut vectors = vec![Vec3::zeros(); body.positions.len()];
    for face in body.shape.faces(body.dimension) {
        for part in face_areas(body, face).unwrap() {
            vectors[part.node as usize] += part.normal * part.area;
        }
    }
    vectors
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    /// Points are the particles, weights are full cells.
    TwoWeights,
    /// Points are the particles, weights are the tributary volumes: the paper's.
    OneVolume,
    /// Points are the bonds.
    Bonds,
}

fn operator(body: &Body, form: Form, ratio: f64) -> (GradientOperator, &[f64]) {
    let support = support_of(body, ratio);
    let nodal = |weights: &[f64]| {
        GradientOperator::at_particles(&body.positions, weights, &support).unwrap()
    };
    match form {
        Form::TwoWeights => (nodal(&body.weights), &body.volumes),
        Form::OneVolume => (nodal(&body.volumes), &body.volumes),
        Form::Bonds => {
            let bonds = &body.bonds;
            let operator = GradientOperator::at_points(
                &bonds.midpoints(&body.positions),
                &body.positions,
                &support,
            )
            .unwrap();
            (operator, &bonds.volumes)
        }
    }
}

/// Largest component of the defect over inner and over boundary particles, in units of one lattice
/// face Δx^(d−1).
fn defects(body: &Body, form: Form, ratio: f64) -> (f64, f64) {
    let (operator, volumes) = operator(body, form, ratio);
    let face = body.spacing.powi(body.dimension.count() as i32 - 1);
    let (mut inner, mut boundary) = (0.0f64, 0.0f64);
    for (a, (found, exact)) in operator
        .boundary_vectors(volumes)
        .iter()
        .zip(area_vectors(body))
        .enumerate()
    {
        let defect = (found - exact).amax() / face;
        if body.boundary[a] {
            boundary = boundary.max(defect);
        } else {
            inner = inner.max(defect);
        }
    }
    (inner, boundary)
}

/// Asserts that every defect of the table is met within a factor of three.
fn assert_inner_defects(form: Form, dimension: usize, table: &[(f64, f64)]) {
    let body = unit_box(11, dimension);
    for &(ratio, expected) in table {
        let (inner, _) = defects(&body, form, ratio);
        assert!(
            (expected / 3.0..3.0 * expected).contains(&inner),
            "{form:?}, d = {dimension}, h = {ratio} dx: {inner:e}, expected {expected:e}"
        );
    }
}

#[test]
fn two_weights_nearly_sum_by_parts() {
    // Magnitudes of docs/theory.md, at h = 0.75, 0.9, 1.0, 1.2 and 1.4 spacings.
    let table = [
        (0.75, 1e-7),
        (0.9, 3e-4),
        (1.0, 1e-3),
        (1.2, 1e-2),
        (1.4, 4e-2),
    ];
    assert_inner_defects(Form::TwoWeights, 2, &table);
    assert_inner_defects(Form::TwoWeights, 3, &table);
}

#[test]
fn bonds_nearly_sum_by_parts() {
    assert_inner_defects(Form::Bonds, 2, &[(0.8, 1.5e-7), (1.0, 3e-4)]);
    // At h = 0.8 the tails of three dimensions add up to more.
    assert_inner_defects(Form::Bonds, 3, &[(0.8, 7e-7), (1.0, 3e-4)]);
    for d in [2, 3] {
        // 2h = 1.5 spacings: the second node along a bond lies where the kernel ends.
        let (inner, _) = defects(&unit_box(11, d), Form::Bonds, 0.75);
        assert!(inner < 2e-14, "d = {d}: {inner:e}");
    }
}

#[test]
fn tributary_volumes_as_weights_do_not_sum_by_parts_at_any_smoothing_length() {
    for d in [2, 3] {
        for ratio in [0.75, 0.9, 1.2] {
            let (inner, _) = defects(&unit_box(11, d), Form::OneVolume, ratio);
            assert!(
                (0.32..0.42).contains(&inner),
                "d = {d}, h = {ratio} dx: {inner}"
            );
        }
    }
}

#[test]
fn constant_stress_gives_no_inner_force_and_the_exact_traction() {
    let stress = Mat3::new(3.0, 1.0, -0.5, 1.0, -2.0, 0.7, -0.5, 0.7, 1.2) * 1e6;
    for d in [2, 3] {
        let body = unit_box(9, d);
        let face = body.spacing.powi(d as i32 - 1);
        // Exact to the defect; bonds along a face have no partner outside, which costs one per cent.
        for (form, tolerance) in [(Form::TwoWeights, 1e-6), (Form::Bonds, 1e-2)] {
            let (operator, volumes) = operator(&body, form, 0.75);
            let stresses: Vec<Mat3> = volumes.iter().map(|v| stress * *v).collect();
            for (c, area) in area_vectors(&body).into_iter().enumerate() {
                let mut traction = stress * area;
                if d == 2 {
                    traction.z = 0.0;
                }
                let defect = (operator.divergence_at(c, &stresses) - traction).norm();
                let tolerance = if body.boundary[c] { tolerance } else { 1e-6 };
                assert!(
                    defect < tolerance * stress.norm() * face,
                    "{form:?}, d = {d}, particle {c}: {:e}",
                    defect / (stress.norm() * face)
                );
            }
        }
    }
}

#[test]
fn boundary_vectors_close_the_body() {
    for d in [2, 3] {
        for form in [Form::TwoWeights, Form::OneVolume, Form::Bonds] {
            let body = unit_box(7, d);
            let (operator, volumes) = operator(&body, form, 0.9);
            let vectors = operator.boundary_vectors(volumes);
            let total: Vec3 = vectors.iter().sum();
            assert!(total.norm() < 1e-13, "{form:?}, d = {d}: {total}");
            // Σ_c X_c ⊗ Σ_q V_q B_qc = Σ_q V_q grad X = V 1: Gauss's theorem for a linear field.
            let moment: Mat3 = vectors
                .iter()
                .zip(body.positions.iter())
                .map(|(v, x)| x * v.transpose())
                .sum();
            let expected =
                Mat3::from_diagonal(&Vec3::new(1.0, 1.0, if d == 2 { 0.0 } else { 1.0 }));
            assert!(
                (moment - expected).norm() < 1e-12,
                "{form:?}, d = {d}: {moment}"
            );
        }
    }
}
