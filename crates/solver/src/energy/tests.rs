use super::*;
use crate::constraint::Stage;
use crate::leapfrog::Kick;
use crate::model::{Condition, ConditionKind, Integrator, Model, Quadrature, Signal};
use crate::testing::{INTEGRATORS, QUADRATURES, Random, elastic, model, scheme};

fn kinetic(simulation: &Simulation) -> f64 {
    let reference = &simulation.reference;
    simulation
        .state
        .momentum
        .iter()
        .zip(&reference.volume)
        .zip(&reference.density)
        .map(|((p, volume), density)| 0.5 * volume * p.norm_squared() / density)
        .sum()
}

/// A body whose corner is held and whose edge is pushed, with random momenta.
fn moving(integrator: Integrator) -> Simulation {
    let mut model = model(
        [5, 4, 1],
        elastic(),
        scheme(Quadrature::Particles, integrator),
    );
    let mut random = Random(37);
    model.bodies[0]
        .initial_velocity
        .fill_with(|| random.vector() * 10.0);
    model.conditions = vec![
        velocity("hold", vec![0], [Some(0.0), Some(0.0), None]),
        velocity("push", vec![3, 7, 11], [Some(4.0), None, None]),
    ];
    let mut simulation = Simulation::new(model).unwrap();
    // Room, and accounts, for what the model does not have.
    let Simulation { work, ledger, .. } = &mut simulation;
    let particles = work.internal_force.len();
    work.external_force = vec![Vec3::zeros(); particles];
    work.dissipation = vec![Vec3::zeros(); particles];
    ledger.open_accounts(work, false);
    simulation
}

fn velocity(name: &str, particles: Vec<u32>, components: [Option<f64>; 3]) -> Condition {
    Condition {
        name: name.into(),
        body: 0,
        particles,
        kind: ConditionKind::Velocity(components.map(|v| v.map(Signal::Constant))),
    }
}

/// Random loads and dissipation; no internal force, so that these alone do work.
fn randomise(simulation: &mut Simulation, random: &mut Random) {
    let work = &mut simulation.work;
    work.internal_force.fill(Vec3::zeros());
    for field in [&mut work.external_force, &mut work.dissipation] {
        field.fill_with(|| random.vector() * 1e9);
    }
}

fn assert_books_close(simulation: &Simulation, start: f64, what: &str) {
    let energies = simulation.energies();
    let work = energies.external + energies.contact - energies.numerical - energies.friction;
    let change = kinetic(simulation) - start;
    // Gross energies, of which the books hold differences.
    let size = start + kinetic(simulation);
    assert!(
        energies.numerical.abs() > 1e-3 * size && change.abs() > 1e-3 * size,
        "{energies:?}"
    );
    assert!(
        (work - change).abs() < 1e-14 * size,
        "{what}: {work} {change}"
    );
}

#[test]
fn opening_full_and_closing_kicks_book_the_change_of_kinetic_energy() {
    let dt = 1e-7;
    for full in [0, 1, 4] {
        let mut simulation = moving(Integrator::Leapfrog);
        let mut random = Random(41);
        let start = kinetic(&simulation);
        randomise(&mut simulation, &mut random);
        simulation.kick(Kick::Opening, 0.5 * dt, dt);
        for k in 0..full {
            randomise(&mut simulation, &mut random);
            // Steps of different length: a kick spans half of either.
            simulation.kick(Kick::Full, (1.0 + 0.2 * f64::from(k)) * dt, dt);
        }
        randomise(&mut simulation, &mut random);
        simulation.kick(Kick::Closing, 0.5 * dt, 0.0);
        assert_books_close(&simulation, start, &format!("{full} full kicks"));
    }
}

#[test]
fn between_kicks_the_books_hold_half_of_the_last_one() {
    let mut simulation = moving(Integrator::Leapfrog);
    let mut random = Random(43);
    randomise(&mut simulation, &mut random);
    simulation.kick(Kick::Opening, 0.5e-7, 1e-7);
    simulation.synchronised = false;
    let particles = 0..simulation.state().position.len();
    let last = |simulation: &Simulation, a| simulation.ledger.last_work(a).external;
    let opened: Vec<f64> = particles.clone().map(|a| last(&simulation, a)).collect();
    assert!(opened.iter().any(|work| *work != 0.0));
    assert_eq!(simulation.energies().external, 0.0);
    randomise(&mut simulation, &mut random);
    simulation.kick(Kick::Full, 1e-7, 1e-7);
    for a in particles {
        let total = simulation.ledger.work(a).external;
        assert_eq!(total, 0.5 * opened[a] + 0.5 * last(&simulation, a));
    }
}

#[test]
fn stages_of_runge_kutta_book_the_change_of_kinetic_energy() {
    let dt = 1e-7;
    let mut simulation = moving(Integrator::TvdRungeKutta);
    let mut random = Random(47);
    let start = kinetic(&simulation);
    for step in 0..3 {
        let time = f64::from(step) * dt;
        simulation.open_books();
        simulation.save_start();
        for first in [true, false] {
            randomise(&mut simulation, &mut random);
            simulation.stage(dt, 0.5);
            let factor = 0.5;
            simulation.constrain(time + dt, dt, Stage::Within { factor, first });
        }
        simulation.average_with_start(0.5);
        simulation.constrain(time + dt, dt, Stage::End);
        simulation.close_books();
    }
    assert_books_close(&simulation, start, "three steps");
}

/// A thick rubber-like plate in free vibration, hourglass stiffness on.
fn vibrating(quadrature: Quadrature, integrator: Integrator, hourglass: f64) -> Model {
    let mut scheme = scheme(quadrature, integrator);
    scheme.stabilisation.hourglass = hourglass;
    scheme.cfl = 0.2;
    let mut model = model([7, 7, 1], elastic(), scheme);
    let body = &mut model.bodies[0];
    for (v, x) in body
        .initial_velocity
        .iter_mut()
        .zip(body.body.positions.iter())
    {
        // Bending and stretch: the stiffness sees what F does not.
        *v = Vec3::new(4e6 * x.x * x.y, -3e6 * x.x * x.x, 0.0);
    }
    model
}

fn run(simulation: &mut Simulation, steps: usize) {
    for _ in 0..steps {
        simulation.advance_step(f64::INFINITY).unwrap();
    }
}

#[test]
fn hourglass_energy_belongs_to_the_present_positions() {
    for quadrature in QUADRATURES {
        for integrator in INTEGRATORS {
            let model = vibrating(quadrature, integrator, 0.05);
            let what = format!("{quadrature:?}, {integrator:?}");
            let mut simulation = Simulation::new(model.clone()).unwrap();
            assert_eq!(simulation.energies().hourglass, 0.0, "{what}: undeformed");
            run(&mut simulation, 40);
            let energy = simulation.energies().hourglass;
            assert!(
                energy > 1e-6 * simulation.energies().initial,
                "{what}: {energy}"
            );

            // By its definition ¼ ζ μ Σ_ab V_a V_b w_ab |x_b − x_a − ½ (F_a + F_b)(X_b − X_a)|².
            let (reference, state) = (&simulation.reference, &simulation.state);
            let body = &reference.bodies[0];
            let gradient = |a: usize| {
                body.shares
                    .mean_tensor(a, |q| state.deformation_gradient[q])
            };
            let mut expected = 0.0;
            for a in 0..reference.position.len() {
                for (b, weight) in body.pairs.as_ref().unwrap().row(a).entries() {
                    let offset = reference.position[b] - reference.position[a];
                    let predicted = (gradient(a) + gradient(b)) * offset * 0.5;
                    let unseen = state.position[b] - state.position[a] - predicted;
                    expected += 0.25
                        * 0.05
                        * body.shear_modulus
                        * reference.volume[a]
                        * weight
                        * unseen.norm_squared();
                }
            }
            assert!(
                (energy / expected - 1.0).abs() < 1e-10,
                "{what}: {energy} {expected}"
            );

            let saved = simulation.save();
            let mut restored = Simulation::new(model).unwrap();
            restored.restore(&saved).unwrap();
            assert_eq!(
                restored.energies(),
                simulation.energies(),
                "{what}: restored"
            );
        }
    }
}

#[test]
fn uniform_body_force_does_the_work_that_the_body_gains() {
    for integrator in INTEGRATORS {
        let mut model = model([4, 4, 1], elastic(), scheme(Quadrature::Bonds, integrator));
        let field = [3e4, -1e4, 0.0];
        model.bodies[0].body_force = Some(field.map(Signal::Constant));
        let mut simulation = Simulation::new(model).unwrap();
        let end = 20.5 * simulation.stable_time_step();
        while simulation.time() < end {
            simulation.advance_step(end).unwrap();
        }
        let energies = simulation.energies();
        let mass = 1000.0 * 9e-6;
        let expected = 0.5 * mass * (Vec3::from(field) * end).norm_squared();
        assert!(
            (energies.kinetic / expected - 1.0).abs() < 1e-12,
            "{integrator:?}"
        );
        assert!(
            (energies.external / expected - 1.0).abs() < 1e-12,
            "{integrator:?}"
        );
        assert!(
            energies.balance().abs() < 1e-12,
            "{integrator:?}: {}",
            energies.balance()
        );
        let momentum = simulation.momenta().linear;
        assert!(
            (momentum / mass - Vec3::from(field) * end).norm() < 1e-12 * momentum.norm() / mass
        );
    }
}
