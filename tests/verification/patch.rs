//! Patch tests: a homogeneous deformation gives its own stress everywhere, no force inside and the
//! exact traction response at the boundary.

use jstsph_geometry::{Body, Dimension, face_areas};
use jstsph_solver::{Condition, ConditionKind, Integrator, Scheme, Signal, Simulation};
use jstsph_tensor::{Mat3, Vec3, deviator, inverse_transpose};
use jstsph_tests::{saved, setup};

const POISSON_RATIO: f64 = 0.3;

/// P of the neo-Hookean rubber in closed form, independent of the solver:
/// τ = μ J^(−2/3) dev(F Fᵀ) + κ J (J − 1) 1, P = τ F⁻ᵀ.
fn first_piola_stress(f: &Mat3) -> Mat3 {
    let shear_modulus = 17e6 / (2.0 * (1.0 + POISSON_RATIO));
    let bulk_modulus = 17e6 / (3.0 * (1.0 - 2.0 * POISSON_RATIO));
    let j = f.determinant();
    let kirchhoff = deviator(&(f * f.transpose())) * (shear_modulus * j.powf(-2.0 / 3.0))
        + Mat3::identity() * (bulk_modulus * j * (j - 1.0));
    kirchhoff * inverse_transpose(f).0
}

fn rotation() -> Mat3 {
    Mat3::new(0.6, -0.8, 0.0, 0.8, 0.6, 0.0, 0.0, 0.0, 1.0)
}

fn stretch() -> Mat3 {
    Mat3::from_diagonal(&Vec3::new(1.3, 0.8, 1.0))
}

fn shear() -> Mat3 {
    Mat3::new(1.0, 0.4, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
}

/// A free body at rest in the homogeneous deformation F, one step later: all momentum it has is
/// the impulse of one evaluation of the internal force.
fn one_step_after(f: &Mat3, body: &Body, scheme: Scheme) -> Simulation {
    let material = setup::rubber(POISSON_RATIO);
    let model = setup::free_body(body.clone(), material, |_| Vec3::zeros(), scheme);
    let mut simulation = setup::start(model);
    let mut saved = simulation.save();
    for (name, array) in &mut saved.arrays {
        match name.as_str() {
            "position" => array.chunks_exact_mut(3).for_each(|x| {
                let moved = f * Vec3::new(x[0], x[1], x[2]);
                x.copy_from_slice(moved.as_slice());
            }),
            "deformation_gradient" => {
                array
                    .chunks_exact_mut(9)
                    .for_each(|entry| entry.copy_from_slice(f.as_slice()));
            }
            "jacobian" => array.fill(f.determinant()),
            _ => {}
        }
    }
    simulation.restore(&saved).expect("the arrays are its own");
    setup::advance_steps(&mut simulation, 1);
    simulation
}

/// Outward area vectors Σ N A of the particles, from the exact areas of the faces.
fn area_vectors(body: &Body) -> Vec<Vec3> {
    let mut vectors = vec![Vec3::zeros(); body.positions.len()];
    for face in body.shape.faces(body.dimension) {
        for part in face_areas(body, face).expect("a box has areas") {
            vectors[part.node as usize] += part.normal * part.area;
        }
    }
    vectors
}

fn bodies() -> [Body; 2] {
    [
        setup::block([1.0, 0.8, 0.0], [10, 8, 1], Dimension::PlaneStrain),
        setup::block([0.6, 0.5, 0.4], [6, 5, 4], Dimension::Solid),
    ]
}

/// A scheme and its largest defects of summation by parts on a box, in units of a face area: the
/// accuracy of the traction response (docs/theory.md). Those of bonds at the boundary are those
/// at edges and corners; the middle of a face has none.
struct Patch {
    name: &'static str,
    scheme: Scheme,
    inner_defect: f64,
    boundary_defect: f64,
}

fn patches() -> [Patch; 4] {
    let patch = |name, scheme, inner_defect, boundary_defect| Patch {
        name,
        scheme,
        inner_defect,
        boundary_defect,
    };
    // Measured, times two: 3.2e-7, 1.3e-7; 9.9e-4, 4.6e-4; round-off, 5.9e-3; 1.2e-6, 1.1e-2.
    [
        patch("particles, h = 0.75", setup::particles(0.75), 6e-7, 3e-7),
        patch("particles, h = 0.9", setup::particles(0.9), 2e-3, 1e-3),
        patch("bonds, h = 0.75", setup::bonds(0.75), 1e-13, 1.2e-2),
        patch("bonds, h = 0.8", setup::bonds(0.8), 2.4e-6, 2.2e-2),
    ]
}

#[test]
fn rotated_body_is_free_of_stress_and_stays_at_rest() {
    for body in bodies() {
        for Patch { name, scheme, .. } in patches() {
            let simulation = one_step_after(&rotation(), &body, scheme);
            // Round-off of F times the largest modulus.
            let largest = saved::first_piola_stress(&simulation)
                .iter()
                .fold(0.0f64, |largest, stress| largest.max(stress.norm()));
            assert!(largest < 1e-14 * 17e6, "{name}: stress {largest:.2e} Pa");
        }
    }
}

#[test]
fn homogeneous_deformation_gives_its_stress_and_the_exact_traction_response() {
    for body in bodies() {
        let areas = area_vectors(&body);
        let face = body.spacing.powi(body.dimension.count() as i32 - 1);
        for Patch {
            name,
            scheme,
            inner_defect,
            boundary_defect,
        } in patches()
        {
            for f in [
                stretch(),
                shear(),
                rotation() * stretch(),
                rotation() * shear(),
            ] {
                // Without the projection: the operator itself is on trial.
                let simulation = one_step_after(
                    &f,
                    &body,
                    Scheme {
                        projection: false,
                        ..scheme
                    },
                );
                let exact = first_piola_stress(&f);
                for stress in saved::first_piola_stress(&simulation) {
                    assert!(
                        (stress - exact).norm() < 1e-13 * 17e6,
                        "{name}: {stress} {exact}"
                    );
                }
                // V_c p_c = −Δt P a_c: nothing inside, the traction −P N at the boundary.
                let impulse = exact.norm() * face * simulation.time_step();
                for (c, area) in areas.iter().enumerate() {
                    let got = simulation.state().momentum[c] * simulation.reference().volume[c];
                    let expected = exact * area * -simulation.time_step();
                    let error = (got - expected).norm() / impulse;
                    let inside = *area == Vec3::zeros();
                    let defect = if inside {
                        inner_defect
                    } else {
                        boundary_defect
                    };
                    assert!(
                        error < defect,
                        "{name}, particle {c}: {error:.2e} of a face"
                    );
                }
            }
        }
    }
}

/// A body whose outer layers move with v = A X: everything inside keeps the momentum it started
/// with, and F = 1 + t A, through large strains.
#[test]
fn affine_motion_of_the_outside_is_the_motion_of_the_inside() {
    let stretching = Mat3::new(0.8, 0.0, 0.0, 0.0, -0.4, 0.0, 0.0, 0.0, 0.0);
    let shearing = Mat3::new(0.0, 1.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let mixed = Mat3::new(0.3, -0.5, 0.0, 0.6, 0.1, 0.0, 0.0, 0.0, 0.0);
    let body = setup::block([1.0, 1.0, 0.0], [16, 16, 1], Dimension::PlaneStrain);
    let steps = 200;
    for Patch { name, scheme, .. } in patches() {
        for integrator in [Integrator::Leapfrog, Integrator::TvdRungeKutta] {
            for rate in [stretching, shearing, mixed] {
                let material = setup::rubber(POISSON_RATIO);
                let density = material.density();
                // Strain 0.4 after all steps; the rate is far below any wave's.
                let rate =
                    rate * (0.5 * material.wave_speeds().pressure / (0.5 * steps as f64 / 16.0));
                let velocity = move |x: &Vec3| rate * x;
                // Without the projection: the operator itself is on trial.
                let scheme = Scheme {
                    integrator,
                    projection: false,
                    ..scheme
                };
                let mut model = setup::free_body(body.clone(), material, velocity, scheme);
                // Summation by parts is exact four smoothing lengths from the boundary.
                let margin = (4.0 * scheme.smoothing_ratio).ceil() * body.spacing - 1e-9;
                let held = |x: &Vec3| (0..2).any(|i| x[i].min(1.0 - x[i]) < margin);
                let signal = |i: usize| {
                    Some(Signal::Function(std::sync::Arc::new(move |_, x: &Vec3| {
                        velocity(x)[i]
                    })))
                };
                model.conditions.push(Condition {
                    name: "outside".into(),
                    body: 0,
                    particles: (0..body.positions.len() as u32)
                        .filter(|&a| held(&body.positions[a as usize]))
                        .collect(),
                    kind: ConditionKind::Velocity([signal(0), signal(1), None]),
                });
                let mut simulation = setup::start(model);
                setup::advance_steps(&mut simulation, steps);
                let speed = rate.norm() * density;
                for (p, x) in simulation
                    .state()
                    .momentum
                    .iter()
                    .zip(body.positions.iter())
                {
                    let error = (p - velocity(x) * density).norm() / speed;
                    assert!(
                        error < 1e-11,
                        "{name}, {integrator:?}: momentum at {x} off by {error:.2e}"
                    );
                }
                let exact = Mat3::identity() + rate * simulation.time();
                assert!(
                    (exact - Mat3::identity()).norm() > 0.2,
                    "the strains must be large"
                );
                for f in &simulation.state().deformation_gradient {
                    assert!(
                        (f - exact).norm() < 1e-12,
                        "{name}, {integrator:?}: {f} {exact}"
                    );
                }
            }
        }
    }
}
