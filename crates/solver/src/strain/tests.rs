use super::*;
use crate::model::{Integrator, Model};
use crate::testing::{QUADRATURES, Random, elastic, model, scheme};

const FORMULATIONS: [Formulation; 3] = [
    Formulation::MomentumGradientCofactorJacobian,
    Formulation::MomentumGradientJacobian,
    Formulation::MomentumGradient,
];

/// A body with a random but consistent state (H = cof F, J = mean of det F) and random G, s⁻¹.
fn deformed(quadrature: Quadrature) -> (Reference, State, Workspace) {
    let model: Model = model(
        [4, 3, 3],
        elastic(),
        scheme(quadrature, Integrator::Leapfrog),
    );
    let reference = Reference::new(&model).unwrap();
    let mut state = State::undeformed(&reference, vec![jstsph_tensor::Vec3::zeros(); 36]);
    let mut work = Workspace::new(&reference);
    let mut random = Random(29);
    for q in 0..state.deformation_gradient.len() {
        state.deformation_gradient[q] = Mat3::identity() + random.tensor() * 0.2;
        work.velocity_gradient[q] = random.tensor();
    }
    let reduced = Strains {
        formulation: Formulation::MomentumGradient,
        quadrature,
    };
    constrain(reduced, &reference, &mut state);
    (reference, state, work)
}

/// Largest |H − cof F| / |H|.
fn cofactor_error(state: &State) -> f64 {
    let pairs = state.cofactor.iter().zip(&state.deformation_gradient);
    pairs
        .map(|(h, f)| (h - cofactor(f)).norm() / h.norm())
        .fold(0.0, f64::max)
}

/// Mean of a function of F over the points of every particle.
fn means(reference: &Reference, state: &State, of: impl Fn(&Mat3) -> f64) -> Vec<f64> {
    let shares = &reference.bodies[0].shares;
    (0..state.jacobian.len())
        .map(|a| shares.mean(a, |q| of(&state.deformation_gradient[q])))
        .collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

#[test]
fn drift_keeps_the_cofactor_exactly_over_any_step() {
    for quadrature in QUADRATURES {
        for formulation in FORMULATIONS {
            let (reference, mut state, mut work) = deformed(quadrature);
            let strains = Strains {
                formulation,
                quadrature,
            };
            let before = state.deformation_gradient[5];
            for _ in 0..3 {
                drift(strains, &reference, &mut state, &mut work, 0.1);
            }
            assert!((state.deformation_gradient[5] - before).norm() > 0.1);
            let error = cofactor_error(&state);
            assert!(error < 1e-14, "{quadrature:?}, {formulation:?}: {error:e}");
        }
    }
}

#[test]
fn drift_of_particles_keeps_the_jacobian_equal_to_the_determinant() {
    // det F is a cubic in time, for which Simpson's rule is exact.
    let quadrature = Quadrature::Particles;
    for formulation in FORMULATIONS {
        let (reference, mut state, mut work) = deformed(quadrature);
        let strains = Strains {
            formulation,
            quadrature,
        };
        let before = state.jacobian.clone();
        for _ in 0..3 {
            drift(strains, &reference, &mut state, &mut work, 0.1);
        }
        assert!(largest_difference(&state.jacobian, &before) > 0.1);
        let error = largest_difference(
            &state.jacobian,
            &means(&reference, &state, Mat3::determinant),
        );
        assert!(error < 1e-14, "{formulation:?}: {error:e}");
    }
}

#[test]
fn drift_of_bonds_follows_the_mean_logarithm_of_the_determinant_to_third_order() {
    let quadrature = Quadrature::Bonds;
    for formulation in [FORMULATIONS[0], FORMULATIONS[1]] {
        let strains = Strains {
            formulation,
            quadrature,
        };
        let errors = [0.1, 0.05, 0.025].map(|dt| {
            let (reference, mut state, mut work) = deformed(quadrature);
            let logarithm = |f: &Mat3| f.determinant().ln();
            let start = means(&reference, &state, logarithm);
            let before = state.jacobian.clone();
            drift(strains, &reference, &mut state, &mut work, dt);
            let expected: Vec<f64> = means(&reference, &state, logarithm)
                .iter()
                .zip(&start)
                .map(|(end, start)| end - start)
                .collect();
            let grown: Vec<f64> = state
                .jacobian
                .iter()
                .zip(&before)
                .map(|(j, j0)| (j / j0).ln())
                .collect();
            largest_difference(&grown, &expected)
        });
        let order = (errors[1] / errors[2]).log2();
        assert!(
            (order - 3.0).abs() < 0.15,
            "{formulation:?}: {errors:?}, order {order}"
        );
    }
}

#[test]
fn without_a_jacobian_of_their_own_particles_have_the_mean_determinant() {
    for quadrature in QUADRATURES {
        let (reference, mut state, mut work) = deformed(quadrature);
        let strains = Strains {
            formulation: Formulation::MomentumGradient,
            quadrature,
        };
        drift(strains, &reference, &mut state, &mut work, 0.1);
        let expected = means(&reference, &state, Mat3::determinant);
        assert!(largest_difference(&state.jacobian, &expected) < 1e-15);
        euler(strains, &reference, &mut state, &mut work, 0.1);
        let expected = means(&reference, &state, Mat3::determinant);
        assert!(largest_difference(&state.jacobian, &expected) < 1e-15);
        assert!(cofactor_error(&state) < 1e-15);
    }
}

#[test]
fn dissipation_of_the_jacobian_is_added_to_its_growth() {
    for quadrature in QUADRATURES {
        let strains = Strains {
            formulation: Formulation::MomentumGradientCofactorJacobian,
            quadrature,
        };
        for advance in [drift, euler] {
            let [without, with] = [0.0, 3.0].map(|rate| {
                let (reference, mut state, mut work) = deformed(quadrature);
                work.jacobian_dissipation[7] = rate;
                advance(strains, &reference, &mut state, &mut work, 0.01);
                state.jacobian
            });
            assert!((with[7] - without[7] - 0.03).abs() < 1e-15);
            assert_eq!(with[8], without[8]);
        }
    }
}

#[test]
fn euler_adds_the_rates_of_the_state_it_starts_from() {
    for quadrature in QUADRATURES {
        for formulation in [FORMULATIONS[0], FORMULATIONS[1]] {
            let (reference, start, mut work) = deformed(quadrature);
            let strains = Strains {
                formulation,
                quadrature,
            };
            let dt = 0.1;
            let mut state = start.clone();
            euler(strains, &reference, &mut state, &mut work, dt);
            for q in 0..start.cofactor.len() {
                let (f, g) = (start.deformation_gradient[q], work.velocity_gradient[q]);
                assert_eq!(state.deformation_gradient[q], f + g * dt);
                let expected = match formulation {
                    Formulation::MomentumGradientCofactorJacobian => {
                        start.cofactor[q] + tensor_cross(&f, &g) * dt
                    }
                    _ => cofactor(&(f + g * dt)),
                };
                assert!((state.cofactor[q] - expected).norm() < 1e-15);
            }
            // dJ/dt = H : G, for bonds J times the mean of tr(G F⁻¹).
            for a in 0..start.jacobian.len() {
                let rate = reference.bodies[0].shares.mean(a, |q| {
                    let (f, g) = (start.deformation_gradient[q], work.velocity_gradient[q]);
                    let trace = (g * f.try_inverse().unwrap()).trace();
                    match quadrature {
                        Quadrature::Particles => f.determinant() * trace,
                        Quadrature::Bonds => start.jacobian[a] * trace,
                    }
                });
                let grown = state.jacobian[a] - start.jacobian[a];
                assert!(
                    (grown - dt * rate).abs() < 1e-14,
                    "{a}: {grown} {}",
                    dt * rate
                );
            }
        }
    }
}

#[test]
fn velocity_gradient_of_a_linear_field_is_its_slope_everywhere() {
    for quadrature in QUADRATURES {
        let (reference, mut state, mut work) = deformed(quadrature);
        let slope = Random(31).tensor() * 1e3;
        for (a, p) in state.momentum.iter_mut().enumerate() {
            *p = slope * reference.position[a] * reference.density[a];
        }
        velocity_gradient(&reference, &state, &mut work);
        for g in &work.velocity_gradient {
            assert!((g - slope).norm() < 1e-11 * slope.norm(), "{quadrature:?}");
        }
    }
}
