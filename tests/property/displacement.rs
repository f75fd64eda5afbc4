//! The displacement formulation and mass scaling: what must hold beside the common properties.

use jstsph_geometry::Dimension;
use jstsph_solver::{Formulation, Scheme, Stabilisation};
use jstsph_tensor::Vec3;
use jstsph_tests::setup;

use crate::tumbling;

fn bare() -> Scheme {
    Scheme {
        stabilisation: Stabilisation::default(),
        projection: false,
        cfl: 0.8,
        ..setup::displacement(0.9)
    }
}

/// The leapfrog of a Hamiltonian system keeps an energy close to the true one for ever: a small
/// body that vibrates freely, with strains of a per cent, for a hundred thousand steps. Points at
/// the particles need the hourglass stiffness, which is the gradient of an energy too: bare, their
/// unseen modes drift until the body inverts.
#[test]
fn energy_of_an_elastic_vibration_stays_bounded() {
    let nodal = Scheme {
        stabilisation: Stabilisation {
            hourglass: 0.05,
            ..Stabilisation::default()
        },
        ..bare()
    };
    let bonds = Scheme {
        formulation: Formulation::Displacement,
        cfl: 0.8,
        ..setup::bonds(0.8)
    };
    for (name, scheme) in [("particles", nodal), ("bonds", bonds)] {
        let body = setup::block([0.1, 0.08, 0.0], [4, 3, 1], Dimension::PlaneStrain);
        let velocity = |x: &Vec3| Vec3::new(60.0 * (x.x - 0.05), 20.0 * (x.y - 0.04), 0.0);
        let model = setup::free_body(body, setup::rubber(0.3), velocity, scheme);
        let mut simulation = setup::start(model);
        let start = simulation.energies().initial;
        // Constant steps: those that follow the stretch are in phase with the vibration and feed it.
        let dt = 0.3 * simulation.stable_time_step();
        let mut step = 0;
        let mut largest = [0.0f64; 2];
        let mut stored = 0.0f64;
        for half in &mut largest {
            for _ in 0..500 {
                for _ in 0..100 {
                    step += 1;
                    setup::advance(&mut simulation, f64::from(step) * dt);
                }
                let energies = simulation.energies();
                let total = energies.kinetic + energies.elastic + energies.hourglass;
                *half = half.max((total / start - 1.0).abs());
                stored = stored.max(energies.elastic / start);
            }
        }
        // A vibration that exchanges most of its energy; its error is of the order of (ω Δt)² and
        // does not grow from the first half to the second.
        assert!(stored > 0.3, "{name}: {stored}");
        assert!(largest[0] < 0.02, "{name}: {largest:?}");
        assert!(largest[1] < 1.2 * largest[0], "{name}: {largest:?}");
    }
}

/// F from the positions and F integrated from the velocity gradient are the same linear map of the
/// same numbers.
#[test]
fn displacement_formulation_agrees_with_the_integrated_gradient() {
    let run = |formulation| {
        let mut scheme = Scheme {
            formulation,
            ..bare()
        };
        scheme.cfl = 0.4;
        let mut simulation = setup::start(tumbling::model(Dimension::Solid, scheme));
        setup::advance_steps(&mut simulation, 50);
        simulation
    };
    let [from_positions, integrated] =
        [Formulation::Displacement, Formulation::MomentumGradient].map(run);
    let pairs = from_positions
        .state()
        .deformation_gradient
        .iter()
        .zip(&integrated.state().deformation_gradient);
    let difference = pairs.fold(0.0f64, |most, (a, b)| most.max((a - b).norm()));
    // Round-off of fifty steps; the two differ in nothing else.
    assert!(difference < 1e-12, "{difference:.1e}");
}

/// Mass scaled by s² with velocities and times of the process is the process run s times faster:
/// positions agree, stresses agree, and the time step is s times longer.
#[test]
fn mass_scaling_is_a_change_of_the_unit_of_time() {
    let scale = 16.0;
    let end = 2e-5;
    let model = |scheme, speed: f64| {
        let body = tumbling::body(Dimension::PlaneStrain);
        let velocity = tumbling::velocity(Dimension::PlaneStrain);
        setup::free_body(body, setup::copper(), move |x| velocity(x) * speed, scheme)
    };
    let fast = setup::run(model(bare(), 1.0), end);
    let scaled = Scheme {
        inertia_scale: scale * scale,
        ..bare()
    };
    let slow = setup::run(model(scaled, 1.0 / scale), scale * end);
    assert!(fast.energies().plastic > 0.0);
    assert_eq!(fast.step_count(), slow.step_count());
    let pairs = fast.state().position.iter().zip(&slow.state().position);
    let difference = pairs.fold(0.0f64, |most, (a, b)| most.max((a - b).norm()));
    // Powers of two scale without round-off: the same numbers in another unit of time.
    assert!(difference < 1e-15, "{difference:.1e}");
    let (a, b) = (fast.energies(), slow.energies());
    assert!((a.plastic / b.plastic - 1.0).abs() < 1e-12);
    assert!((a.kinetic / b.kinetic - 1.0).abs() < 1e-12);
}
