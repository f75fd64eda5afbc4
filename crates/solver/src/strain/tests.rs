use std::collections::BTreeSet;

use super::*;
use crate::model::{Integrator, Model, Scheme};
use crate::testing::{QUADRATURES, Random, elastic, model, scheme};
use crate::time_step::stable_step;

const FORMULATIONS: [Formulation; 3] = [
    Formulation::MomentumGradientCofactorJacobian,
    Formulation::MomentumGradientJacobian,
    Formulation::MomentumGradient,
];

/// A body with a random but consistent state (H = cof F where it has a place, J = mean of det F) and
/// random G, s⁻¹.
fn deformed(strains: Strains, integrator: Integrator) -> (Reference, State, Workspace) {
    let quadrature = strains.quadrature;
    let scheme = Scheme {
        formulation: strains.formulation,
        ..scheme(quadrature, integrator)
    };
    let model: Model = model([4, 3, 3], elastic(), scheme);
    let reference = Reference::new(&model).unwrap();
    let mut state = State::undeformed(&reference, &scheme, vec![Vec3::zeros(); 36]);
    let mut work = Workspace::new(&reference, true);
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
    let gradients = &state.deformation_gradient;
    for (h, f) in state.cofactor.iter_mut().zip(gradients) {
        *h = cofactor(f);
    }
    (reference, state, work)
}

/// A step of the leapfrog with the random G.
fn drift_freely(
    strains: Strains,
    reference: &Reference,
    state: &mut State,
    work: &mut Workspace,
    dt: f64,
) {
    drift(strains, reference, state, work, (dt, true));
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
fn only_runge_kutta_methods_of_the_full_system_keep_a_cofactor() {
    for formulation in FORMULATIONS {
        for integrator in [Integrator::Leapfrog, Integrator::TvdRungeKutta] {
            let strains = Strains {
                formulation,
                quadrature: Quadrature::Bonds,
            };
            let (_, state, _) = deformed(strains, integrator);
            let kept = formulation == FORMULATIONS[0] && integrator == Integrator::TvdRungeKutta;
            assert_eq!(!state.cofactor.is_empty(), kept);
            let (h, determinant) = state.deformation(0..9).cofactor_and_determinant(5);
            let f = &state.deformation_gradient[5];
            assert_eq!(h, cofactor(f));
            assert!((determinant - f.determinant()).abs() < 1e-15);
        }
    }
}

#[test]
fn drift_by_the_momenta_is_that_by_their_gradients_bit_by_bit() {
    for quadrature in QUADRATURES {
        let strains = Strains {
            formulation: FORMULATIONS[0],
            quadrature,
        };
        let results = [false, true].map(|kept| {
            let (reference, mut state, mut work) = deformed(strains, Integrator::Leapfrog);
            let mut random = Random(37);
            let moved = |p: &mut Vec3| *p = random.tensor() * Vec3::new(1e5, 2e5, 3e5);
            state.momentum.iter_mut().for_each(moved);
            pad_momenta(&state, &mut work);
            velocity_gradient(&reference, &mut work);
            if !kept {
                work.velocity_gradient.fill(Mat3::zeros());
            }
            let before = state.clone();
            drift(strains, &reference, &mut state, &mut work, (1e-6, kept));
            assert!(state.deformation_gradient[3] != before.deformation_gradient[3]);
            assert!(state.jacobian[3] != before.jacobian[3]);
            state
        });
        assert_eq!(results[0], results[1]);
    }
}

#[test]
fn bounds_that_the_drift_leaves_do_not_change_the_time_step() {
    let strains = Strains {
        formulation: FORMULATIONS[0],
        quadrature: Quadrature::Bonds,
    };
    let (reference, mut state, mut work) = deformed(strains, Integrator::Leapfrog);
    assert!(!work.stretch_bounds.are_fresh);
    let stale = work.stretch_bounds.clone();
    let (mut random, mut places) = (Random(41), BTreeSet::new());
    for _ in 0..20 {
        for f in &mut state.deformation_gradient {
            *f = Mat3::identity() + random.tensor() * 0.2;
        }
        drift_freely(strains, &reference, &mut state, &mut work, 0.02);
        let fast = stable_step(&reference, &state, &work.stretch_bounds);
        let slow = stable_step(&reference, &state, &stale);
        assert_eq!((fast.time, fast.point), (slow.time, slow.point));
        places.insert(fast.point);
    }
    assert!(places.len() > 10, "always the same place: {places:?}");
    for q in [70, 41] {
        state.deformation_gradient[q].m31 = f64::NAN;
        drift_freely(strains, &reference, &mut state, &mut work, 0.02);
        let found = stable_step(&reference, &state, &work.stretch_bounds);
        assert!(found.time.is_nan() && found.point == q);
    }
}

#[test]
fn drift_of_particles_keeps_the_jacobian_equal_to_the_determinant() {
    // det F is a cubic in time, for which Simpson's rule is exact.
    let quadrature = Quadrature::Particles;
    for formulation in FORMULATIONS {
        let strains = Strains {
            formulation,
            quadrature,
        };
        let (reference, mut state, mut work) = deformed(strains, Integrator::Leapfrog);
        let before = state.jacobian.clone();
        for _ in 0..3 {
            drift_freely(strains, &reference, &mut state, &mut work, 0.1);
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
            let (reference, mut state, mut work) = deformed(strains, Integrator::Leapfrog);
            let logarithm = |f: &Mat3| f.determinant().ln();
            let start = means(&reference, &state, logarithm);
            let before = state.jacobian.clone();
            drift_freely(strains, &reference, &mut state, &mut work, dt);
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
        let strains = Strains {
            formulation: Formulation::MomentumGradient,
            quadrature,
        };
        let (reference, mut state, mut work) = deformed(strains, Integrator::Leapfrog);
        drift_freely(strains, &reference, &mut state, &mut work, 0.1);
        let expected = means(&reference, &state, Mat3::determinant);
        assert!(largest_difference(&state.jacobian, &expected) < 1e-15);
        euler(strains, &reference, &mut state, &mut work, 0.1);
        let expected = means(&reference, &state, Mat3::determinant);
        assert!(largest_difference(&state.jacobian, &expected) < 1e-15);
    }
}

#[test]
fn dissipation_of_the_jacobian_is_added_to_its_growth() {
    for quadrature in QUADRATURES {
        let strains = Strains {
            formulation: Formulation::MomentumGradientCofactorJacobian,
            quadrature,
        };
        for advance in [drift_freely, euler] {
            let [without, with] = [0.0, 3.0].map(|rate| {
                let (reference, mut state, mut work) = deformed(strains, Integrator::Leapfrog);
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
            let strains = Strains {
                formulation,
                quadrature,
            };
            let (reference, start, mut work) = deformed(strains, Integrator::TvdRungeKutta);
            let dt = 0.1;
            let mut state = start.clone();
            euler(strains, &reference, &mut state, &mut work, dt);
            for q in 0..work.velocity_gradient.len() {
                let (f, g) = (start.deformation_gradient[q], work.velocity_gradient[q]);
                assert_eq!(state.deformation_gradient[q], f + g * dt);
                let expected = match formulation {
                    Formulation::MomentumGradientCofactorJacobian => {
                        cofactor(&f) + tensor_cross(&f, &g) * dt
                    }
                    _ => cofactor(&(f + g * dt)),
                };
                let found = state.deformation(0..start.deformation_gradient.len());
                assert!((found.cofactor(q) - expected).norm() < 1e-15);
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
        let strains = Strains {
            formulation: FORMULATIONS[0],
            quadrature,
        };
        let (reference, mut state, mut work) = deformed(strains, Integrator::Leapfrog);
        let slope = Random(31).tensor() * 1e3;
        for (a, p) in state.momentum.iter_mut().enumerate() {
            *p = slope * reference.position[a] * reference.density[a];
        }
        pad_momenta(&state, &mut work);
        velocity_gradient(&reference, &mut work);
        for g in &work.velocity_gradient {
            assert!((g - slope).norm() < 1e-11 * slope.norm(), "{quadrature:?}");
        }
    }
}
