use jstsph_tensor::{Vec3, cofactor};

use super::*;
use crate::Simulation;
use crate::model::{Formulation, Integrator};
use crate::testing::{QUADRATURES, copper, elastic, in_pool, model, scheme};

/// Moduli of [`elastic`], Pa.
const BULK: f64 = 2e9;
const SHEAR: f64 = 0.75e9;

fn simulation(quadrature: Quadrature, formulation: Formulation) -> Simulation {
    let mut scheme = scheme(quadrature, Integrator::Leapfrog);
    scheme.formulation = formulation;
    Simulation::new(model([4, 4, 3], elastic(), scheme)).unwrap()
}

const PRINCIPAL: Vec3 = Vec3::new(1.25, 0.9, 1.05);

/// R U with a rotation R about a tilted axis and U of the given principal stretches along x, y, z.
fn rotation() -> Mat3 {
    let (s, c) = 0.7f64.sin_cos();
    let about_z = Mat3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
    let about_x = Mat3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c);
    about_z * about_x
}

fn deform(simulation: &mut Simulation, f: &Mat3) {
    let state = &mut simulation.state;
    state.deformation_gradient.fill(*f);
    state.cofactor.fill(cofactor(f));
    state.jacobian.fill(f.determinant());
    for (x, start) in state
        .position
        .iter_mut()
        .zip(simulation.reference.position.iter())
    {
        *x = f * start;
    }
}

/// P of Hencky's material: in the principal frame τ_i = κ ln J + 2 μ (ln λ_i − ⅓ ln λ1 λ2 λ3).
fn hencky_stress(log_jacobian: f64) -> Mat3 {
    let log = PRINCIPAL.map(f64::ln);
    let tau = log.map(|l| BULK * log_jacobian + 2.0 * SHEAR * (l - log.sum() / 3.0));
    // P = R τ U⁻¹ for F = R U with U diagonal.
    rotation() * Mat3::from_diagonal(&tau.component_div(&PRINCIPAL))
}

fn assert_stress(simulation: &Simulation, expected: &Mat3, what: &str) {
    for (q, scaled) in simulation.work.scaled_stress.iter().enumerate() {
        let error = (scaled / simulation.reference.point_volume[q] - expected).norm();
        assert!(
            error < 1e-12 * expected.norm(),
            "{what}: {error:e} at point {q}"
        );
    }
}

#[test]
fn constant_deformation_has_the_analytic_stress_in_every_formulation() {
    let f = rotation() * Mat3::from_diagonal(&PRINCIPAL);
    for quadrature in QUADRATURES {
        for formulation in [
            Formulation::MomentumGradientCofactorJacobian,
            Formulation::MomentumGradientJacobian,
            Formulation::MomentumGradient,
        ] {
            let mut simulation = simulation(quadrature, formulation);
            deform(&mut simulation, &f);
            simulation.evaluate_stress(0.0).unwrap();
            let expected = hencky_stress(PRINCIPAL.product().ln());
            assert_stress(
                &simulation,
                &expected,
                &format!("{quadrature:?}, {formulation:?}"),
            );
        }
    }
}

#[test]
fn undeformed_and_rotated_bodies_have_no_stress() {
    for quadrature in QUADRATURES {
        let mut simulation = simulation(quadrature, Formulation::MomentumGradientCofactorJacobian);
        deform(&mut simulation, &rotation());
        simulation.evaluate_stress(0.0).unwrap();
        for (q, scaled) in simulation.work.scaled_stress.iter().enumerate() {
            let stress = scaled.norm() / simulation.reference.point_volume[q];
            assert!(stress < 1e-14 * BULK, "{quadrature:?}: {stress} Pa");
        }
    }
}

#[test]
fn pressure_comes_from_the_jacobian_unknown_of_the_particles() {
    let f = rotation() * Mat3::from_diagonal(&PRINCIPAL);
    let determinant = PRINCIPAL.product();
    for quadrature in QUADRATURES {
        let mut simulation = simulation(quadrature, Formulation::MomentumGradientCofactorJacobian);
        deform(&mut simulation, &f);
        let particles = simulation.state.jacobian.len();
        for a in 0..particles {
            simulation.state.jacobian[a] = 1.0 + 0.01 * a as f64;
        }
        simulation.evaluate_stress(0.0).unwrap();
        for (q, scaled) in simulation.work.scaled_stress.iter().enumerate() {
            let ends = simulation.reference.bodies[0].ends[q];
            let [a, b] = ends.map(|end| simulation.state.jacobian[end as usize]);
            // P = τ H / J with the particle's own J; with bonds P = τ F⁻ᵀ and the mean τ of its ends.
            let scale = match quadrature {
                Quadrature::Particles => determinant / a,
                Quadrature::Bonds => 1.0,
            };
            let expected = hencky_stress(0.5 * (a.ln() + b.ln())) * scale;
            let error = (scaled / simulation.reference.point_volume[q] - expected).norm();
            assert!(
                error < 1e-12 * expected.norm(),
                "{quadrature:?}: {error:e} at point {q}"
            );
        }
    }
}

#[test]
fn elastic_energy_is_that_of_the_material_times_the_volume() {
    let f = rotation() * Mat3::from_diagonal(&PRINCIPAL);
    let log = PRINCIPAL.map(f64::ln);
    let deviator = log.map(|l| l - log.sum() / 3.0);
    let density = SHEAR * deviator.norm_squared() + 0.5 * BULK * log.sum().powi(2);
    let volume = 3e-3 * 3e-3 * 2e-3;
    for quadrature in QUADRATURES {
        for formulation in [
            Formulation::MomentumGradientCofactorJacobian,
            Formulation::MomentumGradient,
        ] {
            let mut simulation = simulation(quadrature, formulation);
            deform(&mut simulation, &f);
            let energy = simulation.energies().elastic;
            assert!(
                (energy / (density * volume) - 1.0).abs() < 1e-12,
                "{quadrature:?}, {formulation:?}: {energy} of {}",
                density * volume
            );
        }
    }
}

#[test]
fn evaluation_does_not_move_history() {
    let shear = Mat3::new(1.0, 0.05, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    for quadrature in QUADRATURES {
        let scheme = scheme(quadrature, Integrator::Leapfrog);
        let mut simulation = Simulation::new(model([4, 3, 1], copper(), scheme)).unwrap();
        deform(&mut simulation, &shear);
        simulation.evaluate_stress(1e-6).unwrap();
        let first = simulation.work.scaled_stress.clone();
        let strain = |simulation: &Simulation| {
            simulation
                .particle_fields()
                .equivalent_plastic_strain
                .into_iter()
                .fold(0.0, f64::max)
        };
        assert_eq!(strain(&simulation), 0.0);
        simulation.evaluate_stress(1e-6).unwrap();
        assert_eq!(simulation.work.scaled_stress, first);
        simulation.commit_history();
        // Shear yields at 0.4/(√3 43.3) = 0.53 %: nearly all of 5 %/√3 is plastic.
        assert!(
            (strain(&simulation) - 0.05 / 3f64.sqrt()).abs() < 0.004,
            "{}",
            strain(&simulation)
        );
    }
}

#[test]
fn failures_name_the_smallest_failing_point() {
    for quadrature in QUADRATURES {
        for threads in [1, 3] {
            let scheme = scheme(quadrature, Integrator::Leapfrog);
            let mut model = model([50, 50, 1], elastic(), scheme);
            model
                .bodies
                .push(crate::testing::body("second", [48, 48, 1], elastic()));
            let mut simulation = Simulation::new(model).unwrap();
            let first = simulation.reference.bodies[1].points.start;
            let inverted = Mat3::from_diagonal(&Vec3::new(-0.5, 1.0, 1.0));
            for point in [2100, 1234, 40 + 1234] {
                let q = first + point;
                simulation.state.deformation_gradient[q] = inverted;
            }
            let failure = in_pool(threads, || {
                evaluate(
                    simulation.strains(),
                    &simulation.reference,
                    &simulation.state,
                    &mut simulation.materials,
                    &mut simulation.work,
                    0.0,
                )
            })
            .unwrap_err();
            assert_eq!(
                (failure.body, failure.point),
                (1, 1234),
                "{quadrature:?}, {threads} threads"
            );
            assert!(
                matches!(
                    failure.source,
                    MaterialError::Inverted {
                        determinant: -0.5,
                        ..
                    }
                ),
                "{:?}",
                failure.source
            );
        }
    }
}

#[test]
fn a_bond_with_an_inverted_end_fails_whatever_the_other_end() {
    for (one, other) in [(-0.1, 0.9), (0.9, -0.1), (-0.1, -0.1)] {
        let mut simulation = simulation(
            Quadrature::Bonds,
            Formulation::MomentumGradientCofactorJacobian,
        );
        let [a, b] = simulation.reference.bodies[0].ends[0];
        simulation.state.jacobian[a as usize] = one;
        simulation.state.jacobian[b as usize] = other;
        let error = simulation.evaluate_stress(0.0).unwrap_err();
        let text = error.to_string();
        assert!(text.starts_with("bond 0 of body \"block\" at ("), "{text}");
    }
}
