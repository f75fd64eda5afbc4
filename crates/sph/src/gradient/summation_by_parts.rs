//! How nearly Σ_q V_q B_qc is the outward area vector of particle c: docs/theory.md.

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
            let bonds = body.bonds.as_ref().unwrap();
            let operator =
                GradientOperator::at_points(&bonds.midpoints, &body.positions, &support).unwrap();
            (operator, &bonds.volumes)
        }
    }
}

/// Largest defect over all particles, in units of one lattice face Δx^(d−1).
fn defect(body: &Body, form: Form, ratio: f64) -> f64 {
    let (operator, volumes) = operator(body, form, ratio);
    let face = body.spacing.powi(body.dimension.count() as i32 - 1);
    operator
        .boundary_vectors(volumes)
        .iter()
        .zip(area_vectors(body))
        .map(|(found, exact)| (found - exact).norm() / face)
        .fold(0.0, f64::max)
}

#[test]
fn print_defects() {
    for d in [2, 3] {
        let body = unit_box(11, d);
        for form in [Form::TwoWeights, Form::OneVolume, Form::Bonds] {
            for ratio in [0.75, 0.8, 0.9, 1.0, 1.08, 1.2, 1.4] {
                eprintln!("{d} {form:?} {ratio} {:e}", defect(&body, form, ratio));
            }
        }
    }
    for d in [2, 3] {
        let body = unit_box(11, d);
        for form in [Form::TwoWeights, Form::OneVolume, Form::Bonds] {
            for ratio in [0.75, 0.8, 0.9, 1.0, 1.2] {
                let (operator, volumes) = operator(&body, form, ratio);
                let face = body.spacing.powi(d as i32 - 1);
                let mut by = [0.0f64; 4];
                for ((x, v), e) in body.positions.iter().zip(operator.boundary_vectors(volumes)).zip(area_vectors(&body)) {
                    let k = x.iter().take(d).filter(|c| **c < 1e-9 || **c > 1.0 - 1e-9).count();
                    by[k] = by[k].max((v - e).norm() / face);
                }
                eprintln!("{d} {form:?} {ratio} {:.1e} {:.1e} {:.1e} {:.1e}", by[0], by[1], by[2], by[3]);
            }
        }
    }
    let _ = Mat3::zeros();
}
