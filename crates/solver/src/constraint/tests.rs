use super::*;
use crate::Simulation;
use crate::model::Signal;
use crate::model::{Integrator, Quadrature};
use crate::testing::{INTEGRATORS, QUADRATURES, elastic, model, scheme};

fn velocity(name: &str, particles: Vec<u32>, components: [Option<f64>; 3]) -> Condition {
    Condition {
        name: name.into(),
        body: 0,
        particles,
        kind: ConditionKind::Velocity(components.map(|v| v.map(Signal::Constant))),
    }
}

fn simulation(conditions: Vec<Condition>) -> Simulation {
    let mut model = model(
        [5, 4, 1],
        elastic(),
        scheme(Quadrature::Particles, Integrator::TvdRungeKutta),
    );
    model.bodies[0]
        .initial_velocity
        .fill(Vec3::new(1.0, 2.0, 0.0));
    model.conditions = conditions;
    Simulation::new(model).unwrap()
}

/// ρ of the material, kg/m³.
const DENSITY: f64 = 1000.0;

#[test]
fn prescribed_components_are_met_and_their_impulse_is_booked() {
    let mut simulation = simulation(vec![velocity(
        "pull",
        vec![2, 7],
        [Some(5.0), None, Some(0.0)],
    )]);
    let before = vec![Vec3::new(1.0, 2.0, 0.5) * DENSITY; 20];
    let mut momentum = before.clone();
    let Simulation {
        reference,
        prescribed,
        ledger,
        ..
    } = &mut simulation;
    prescribed.apply(reference, 0.0, 0.5, &mut momentum, ledger);
    for a in 0..20 {
        let held = a == 2 || a == 7;
        let change = if held {
            Vec3::new(4.0, 0.0, -0.5) * DENSITY
        } else {
            Vec3::zeros()
        };
        assert_eq!(momentum[a], before[a] + change);
        assert_eq!(ledger.impulse[a].external, change * 0.5);
    }
    let expected =
        Vec3::new(4.0, 0.0, -0.5) * (0.5 * DENSITY * (reference.volume[2] + reference.volume[7]));
    assert!((ledger.condition_impulse[0] - expected).norm() < 1e-15 * expected.norm());
}

#[test]
fn momenta_at_time_zero_obey_conditions_without_an_impulse() {
    let simulation = simulation(vec![velocity(
        "hold",
        vec![0, 1, 2, 3],
        [Some(0.0), None, None],
    )]);
    for (a, p) in simulation.state().momentum.iter().enumerate() {
        let expected = if a < 4 {
            Vec3::y() * 2.0
        } else {
            Vec3::new(1.0, 2.0, 0.0)
        };
        assert_eq!(*p, expected * DENSITY);
    }
    assert_eq!(simulation.condition_impulses(), [("hold", Vec3::zeros())]);
}

#[test]
fn later_conditions_win_where_they_overlap() {
    let mut simulation = simulation(vec![
        velocity("left", vec![0, 1, 2], [Some(10.0), Some(-3.0), None]),
        velocity("corner", vec![2], [Some(-7.0), None, None]),
    ]);
    let before = vec![Vec3::zeros(); 20];
    let mut momentum = before.clone();
    let Simulation {
        reference,
        prescribed,
        ledger,
        ..
    } = &mut simulation;
    prescribed.apply(reference, 0.0, 1.0, &mut momentum, ledger);
    assert_eq!(momentum[1], Vec3::new(10.0, -3.0, 0.0) * DENSITY);
    assert_eq!(momentum[2], Vec3::new(-7.0, -3.0, 0.0) * DENSITY);
    // Whoever wins, the impulses add up to what the particles have received.
    let received: Vec3 = (0..20).map(|a| momentum[a] * reference.volume[a]).sum();
    let booked: Vec3 = ledger.condition_impulse.iter().sum();
    assert!((booked - received).norm() < 1e-14 * received.norm());
    assert_eq!(ledger.impulse[2].external, momentum[2]);
}

#[test]
fn signals_see_time_and_the_reference_position() {
    let signal = Signal::Function(std::sync::Arc::new(|t, x| 100.0 * t + 1e3 * x.x));
    let mut simulation = simulation(vec![Condition {
        name: "shear".into(),
        body: 0,
        particles: vec![3],
        kind: ConditionKind::Velocity([None, Some(signal), None]),
    }]);
    let mut momentum = vec![Vec3::zeros(); 20];
    let Simulation {
        reference,
        prescribed,
        ledger,
        ..
    } = &mut simulation;
    prescribed.apply(reference, 0.25, 1.0, &mut momentum, ledger);
    let expected = DENSITY * (25.0 + 1e3 * reference.position[3].x);
    assert!((momentum[3].y - expected).abs() < 1e-12 * expected);
}

#[test]
fn total_momentum_changes_by_the_impulses_of_the_conditions_alone() {
    for quadrature in QUADRATURES {
        for integrator in INTEGRATORS {
            let mut model = model([6, 5, 1], elastic(), scheme(quadrature, integrator));
            // The lattice runs along the longer side: the first five nodes are a column or a row.
            model.conditions = vec![
                velocity("pull", vec![0, 1, 2, 3, 4], [Some(2.0), Some(0.5), None]),
                velocity("hold", vec![25, 26], [Some(0.0), None, None]),
            ];
            let mut simulation = Simulation::new(model).unwrap();
            let start = simulation.momenta().linear;
            let end = 25.5 * simulation.stable_time_step();
            while simulation.time() < end {
                simulation.advance_step(end).unwrap();
            }
            let change = simulation.momenta().linear - start;
            let impulses = simulation.condition_impulses();
            assert_eq!((impulses[0].0, impulses[1].0), ("pull", "hold"));
            let total = impulses[0].1 + impulses[1].1;
            let size = impulses[0].1.norm() + impulses[1].1.norm();
            assert!(
                impulses[1].1.norm() > 0.01 * size,
                "the wave has not arrived"
            );
            assert!(
                (total - change).norm() < 1e-12 * size,
                "{quadrature:?}, {integrator:?}: {total} {change}"
            );
        }
    }
}

#[test]
fn the_books_of_an_obstacle_are_opened_when_it_is_met() {
    use jstsph_contact::{Friction, Law, Obstacle};
    let mut model = model(
        [5, 4, 1],
        elastic(),
        scheme(Quadrature::Particles, Integrator::Leapfrog),
    );
    model.bodies[0]
        .initial_velocity
        .fill(Vec3::new(0.0, -1.0, 0.0));
    let positions = &model.bodies[0].body.positions;
    let lowest = positions.iter().map(|x| x.y).fold(f64::INFINITY, f64::min);
    let ahead = 2.0 * model.bodies[0].body.spacing;
    model.obstacles.push(ModelObstacle {
        obstacle: Obstacle {
            name: "floor".into(),
            surface: Surface::Plane {
                point: Vec3::new(0.0, lowest - ahead, 0.0),
                normal: Vec3::y(),
            },
            law: Law::Inelastic { restitution: 0.0 },
            friction: Friction::default(),
        },
        velocity: None,
        heat: None,
    });
    let mut simulation = Simulation::new(model).unwrap();
    let end = 2.0 * ahead;
    while simulation.time() < end {
        simulation.advance_step(end).unwrap();
        let books = &simulation.ledger.pages[0];
        // Up to then it flies at 1 m/s.
        if simulation.time() < 0.9 * ahead {
            assert!(books.met.is_none());
            assert_eq!(simulation.energies().contact, 0.0);
        }
    }
    assert!(simulation.ledger.pages[0].met.is_some());
    assert!(simulation.energies().contact < 0.0);
    assert!(simulation.obstacle_impulses()[0].1.y < 0.0);
}
