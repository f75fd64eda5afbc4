use super::*;
use crate::model::{Formulation, Integrator, StepLimit};
use crate::testing::{QUADRATURES, Random, elastic, model, scheme};

/// Growth of the kinetic energy of a small random motion over a few hundred steps.
fn growth(scheme: Scheme) -> f64 {
    let mut model = model([6, 5, 4], elastic(), scheme);
    let mut random = Random(5);
    for velocity in &mut model.bodies[0].initial_velocity {
        *velocity = random.vector() * 1e-6;
    }
    let mut simulation = Simulation::new(model).unwrap();
    let initial = simulation.energies().kinetic;
    for _ in 0..400 {
        if simulation.advance_step(f64::INFINITY).is_err() {
            return f64::INFINITY;
        }
    }
    simulation.energies().kinetic / initial
}

/// Limits on the imaginary axis over that of the leapfrog, ω Δt = 2: √3 for three stages of third
/// order, 3.34 for the method of Carpenter & Kennedy.
#[test]
fn vibrations_are_stable_below_the_limit_and_grow_above() {
    for quadrature in QUADRATURES {
        for (integrator, fraction) in [
            (Integrator::Leapfrog, 1.0),
            (Integrator::SspRungeKutta, 0.866),
            (Integrator::RungeKutta4, 1.668),
        ] {
            let at = |cfl: f64| {
                growth(Scheme {
                    formulation: Formulation::MomentumGradientJacobian,
                    step_limit: StepLimit::Acoustic,
                    cfl,
                    ..scheme(quadrature, integrator)
                })
            };
            let what = format!("{quadrature:?}, {integrator:?}");
            let (below, above) = (at(0.95 * fraction), at(1.1 * fraction));
            assert!(below < 10.0, "{what}: {below}");
            assert!(above > 1e6, "{what}: {above}");
        }
    }
}

#[test]
fn the_limit_of_the_undeformed_body_is_the_acoustic_one() {
    for quadrature in QUADRATURES {
        let scheme = scheme(quadrature, Integrator::Leapfrog);
        let simulation = Simulation::new(model([6, 5, 4], elastic(), scheme)).unwrap();
        let acoustic = Scheme {
            step_limit: StepLimit::Acoustic,
            ..scheme
        };
        let other = Simulation::new(model([6, 5, 4], elastic(), acoustic)).unwrap();
        let expected = simulation.elastic_cfl_limit() * simulation.stable_time_step();
        assert!((other.stable_time_step() / expected - 1.0).abs() < 1e-12);
        assert!((0.8..1.3).contains(&simulation.elastic_cfl_limit()));
    }
}

/// The body scaled by s has its frequencies scaled by 1/s; turned, it keeps them.
#[test]
fn frequencies_follow_the_deformation() {
    for quadrature in QUADRATURES {
        let scheme = scheme(quadrature, Integrator::Leapfrog);
        let simulation = Simulation::new(model([6, 5, 4], elastic(), scheme)).unwrap();
        let reference = simulation.reference();
        let mut frequency = Frequency::new(reference);
        let mut work = Workspace::new(reference, true);
        let mut of = |state: Option<&State>| {
            frequency.largest(
                &mut work,
                reference,
                &reference.bodies[0],
                &scheme,
                (state, Vibrations::default(), 0),
            )
        };
        let undeformed = of(None);
        let turn = Mat3::new(0.6, -0.8, 0.0, 0.8, 0.6, 0.0, 0.0, 0.0, 1.0);
        // One bond of many squeezed to a third: the stretch limit falls to a third, the mass that
        // moves is that of whole particles.
        for (f, at_one_point, range) in [
            (Mat3::identity(), false, 1.0 - 1e-12..1.0 + 1e-12),
            (Mat3::identity() * 0.4, false, 2.5 - 1e-10..2.5 + 1e-10),
            (turn, false, 0.99..1.01),
            (
                Mat3::from_diagonal(&Vec3::new(1.0 / 3.0, 1.0, 1.0)),
                true,
                1.001..2.5,
            ),
        ] {
            let mut state = simulation.state().clone();
            let places = if at_one_point {
                60..61
            } else {
                0..state.deformation_gradient.len()
            };
            for q in places {
                state.deformation_gradient[q] = f;
            }
            let ratio = of(Some(&state)) / undeformed;
            assert!(range.contains(&ratio), "{quadrature:?}: {ratio}");
        }
    }
}
