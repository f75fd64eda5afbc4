use super::*;
use crate::acoustic::{Frequency, Vibrations};
use crate::constraint;
use crate::model::{
    Condition, ConditionKind, Integrator, Model, ModelObstacle, Quadrature, Signal, StepLimit,
};
use crate::state::Workspace;
use crate::testing::{copper, in_pool, model, scheme};
use jstsph_contact::{Friction, Law, Obstacle, Surface};

fn local_scheme(substeps: u32) -> Scheme {
    Scheme {
        step_limit: StepLimit::Acoustic,
        cfl: 0.9,
        substeps,
        ..scheme(Quadrature::Bonds, Integrator::Leapfrog)
    }
}

/// A free, spinning block of copper whose lowest three layers run into the others at 800 m/s.
fn collision(nodes: [usize; 3], substeps: u32) -> Model {
    let mut model = model(nodes, copper(), local_scheme(substeps));
    let spin = Vec3::new(4e3, 3e3, 5e3);
    let body = &mut model.bodies[0];
    for (velocity, x) in body
        .initial_velocity
        .iter_mut()
        .zip(body.body.positions.iter())
    {
        *velocity = spin.cross(x);
        if x.y < 3.5e-3 {
            velocity.y += 800.0;
        }
    }
    model
}

fn run(simulation: &mut Simulation, end: f64) {
    while simulation.time() < end {
        simulation.advance_step(end).unwrap();
    }
}

fn ratio(simulation: &Simulation) -> u32 {
    1 << simulation.local.as_ref().unwrap().choice.finest()
}

/// Points that make sub-steps now.
fn fine_points(simulation: &Simulation) -> usize {
    let groups = &simulation.local.as_ref().unwrap().groups;
    groups
        .iter()
        .map(|groups| groups.points.count(Levels::from(1)))
        .sum()
}

fn assert_grouped(simulation: &Simulation) {
    let (ratio, fine) = (ratio(simulation), fine_points(simulation));
    let points = simulation.reference.point_volume.len();
    assert!(
        ratio > 1 && fine > 0 && fine < points / 2,
        "{ratio}: {fine} of {points}"
    );
}

#[test]
fn momenta_of_a_free_body_stay_to_round_off() {
    let mut simulation = Simulation::new(collision([4, 25, 4], 8)).unwrap();
    let (start, reference) = (simulation.momenta(), simulation.reference());
    // Sums of the sizes of the terms, which is what round-off is relative to.
    let (mut size, mut moment) = (0.0, 0.0);
    for ((x, p), volume) in reference
        .position
        .iter()
        .zip(&simulation.state().momentum)
        .zip(&reference.volume)
    {
        size += p.norm() * volume;
        moment += x.norm() * p.norm() * volume;
    }
    run(&mut simulation, 15e-6);
    assert!(simulation.energies().plastic > 1.0);
    assert_grouped(&simulation);
    let end = simulation.momenta();
    assert!((end.linear - start.linear).norm() < 1e-13 * size);
    assert!((end.angular - start.angular).norm() < 1e-13 * moment);
}

#[test]
fn the_answer_is_that_of_equal_steps() {
    let run = |substeps: u32| {
        let mut simulation = Simulation::new(handled([4, 25, 4], substeps)).unwrap();
        run(&mut simulation, 20e-6);
        simulation
    };
    let (equal, local) = (run(1), run(8));
    assert!(local.step_count() < equal.step_count());
    let (one, other) = (equal.energies(), local.energies());
    assert!(one.friction > 0.0 && one.external.abs() > 0.0);
    // Longer steps: the books of plastic work and of friction are of first order.
    for (one, other) in [
        (one.plastic, other.plastic),
        (one.contact, other.contact),
        (one.external, other.external),
        (one.friction, other.friction),
    ] {
        let difference = (one - other).abs() / equal.energies().plastic;
        assert!(difference < 0.01, "{difference}");
    }
    assert!(
        other.balance().abs() < 1.5 * one.balance().abs() + 2e-3,
        "{one:?} {other:?}"
    );
    let height = |simulation: &Simulation| {
        let y = simulation.state().position.iter().map(|x| x.y);
        y.clone().fold(f64::MIN, f64::max) - y.fold(f64::MAX, f64::min)
    };
    let difference = height(&local) / height(&equal) - 1.0;
    assert!(difference.abs() < 2e-3, "{difference}");
}

#[test]
fn a_long_vibration_neither_gains_nor_loses_energy() {
    let mut simulation = Simulation::new(collision([4, 17, 4], 8)).unwrap();
    run(&mut simulation, 40e-6);
    let (start, first_step) = (simulation.energies(), simulation.step_count());
    let vibration = |simulation: &Simulation| {
        let energies = simulation.energies();
        energies.kinetic + energies.elastic
    };
    let begin = vibration(&simulation);
    let mut largest = begin;
    for k in 1..=30 {
        run(&mut simulation, 40e-6 + 10e-6 * f64::from(k));
        largest = largest.max(vibration(&simulation));
    }
    let end = simulation.energies();
    assert_grouped(&simulation);
    let steps = simulation.step_count() - first_step;
    assert!(steps > 1500, "{steps}");
    assert!(largest < 1.01 * begin, "{begin} {largest}");
    assert!(
        (end.plastic - start.plastic) < 0.01 * begin,
        "{start:?} {end:?}"
    );
    // Nothing is lost but what flows plastically.
    assert!((end.error() - start.error()).abs() < 0.01 * begin);
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    // Enough points for parallel loops.
    let run = |threads: usize| {
        in_pool(threads, || {
            let mut simulation = Simulation::new(handled([4, 61, 4], 8)).unwrap();
            while !simulation.has_substeps() {
                simulation.advance_step(60e-6).unwrap();
                assert!(simulation.time() < 60e-6);
            }
            for _ in 0..30 {
                simulation.advance_step(1.0).unwrap();
            }
            assert_grouped(&simulation);
            simulation.save()
        })
    };
    assert!(run(1) == run(3));
}

#[test]
fn a_restored_run_goes_on_with_the_same_bits() {
    let model = collision([4, 25, 4], 8);
    let mut whole = Simulation::new(model.clone()).unwrap();
    let mut resumed = Simulation::new(model).unwrap();
    let mut groups = Vec::new();
    for _ in 0..8 {
        for _ in 0..11 {
            whole.advance_step(1.0).unwrap();
        }
        groups.push((ratio(&whole), fine_points(&whole)));
        resumed.restore(&whole.save()).unwrap();
        for _ in 0..5 {
            whole.advance_step(1.0).unwrap();
            resumed.advance_step(1.0).unwrap();
        }
        assert!(resumed.save() == whole.save(), "after {groups:?}");
    }
    // The groups have changed on the way.
    assert_grouped(&whole);
    groups.dedup();
    assert!(groups.len() > 1, "{groups:?}");
}

/// An impact on a wall that moves, with friction; the upper end is swung sideways, and the lower part
/// cannot leave its plane.
fn handled(nodes: [usize; 3], substeps: u32) -> Model {
    let mut model = model(nodes, copper(), local_scheme(substeps));
    model.bodies[0]
        .initial_velocity
        .fill(Vec3::new(0.0, -300.0, 0.0));
    let positions = &model.bodies[0].body.positions;
    let held = |low: f64, high: f64| -> Vec<u32> {
        let within = |a: &usize| (low..high).contains(&positions[*a].y);
        let particles = (0..positions.len()).filter(within);
        particles.map(|a| a as u32).collect()
    };
    let swing = Signal::Table {
        times: vec![0.0, 4e-6, 8e-6],
        values: vec![0.0, 40.0, -20.0],
    };
    let condition = |name: &str, particles: Vec<u32>, components| Condition {
        name: name.into(),
        body: 0,
        particles,
        kind: ConditionKind::Velocity(components),
    };
    model.conditions = vec![
        condition("handle", held(24.5e-3, 26e-3), [Some(swing), None, None]),
        // Particles of the most compressed layers and of those above them.
        condition(
            "slot",
            held(0.0, 5.5e-3),
            [None, None, Some(Signal::Constant(0.0))],
        ),
    ];
    model.obstacles.push(ModelObstacle {
        obstacle: Obstacle {
            name: "wall".into(),
            surface: Surface::Plane {
                point: Vec3::new(0.0, 0.9e-3, 0.0),
                normal: Vec3::y(),
            },
            law: Law::Inelastic { restitution: 0.0 },
            friction: Friction::coulomb(0.2),
        },
        velocity: Some([
            Signal::Constant(0.0),
            Signal::Constant(20.0),
            Signal::Constant(0.0),
        ]),
        heat: None,
    });
    model
}

#[test]
fn books_of_constraints_account_for_the_momentum() {
    let mut simulation = Simulation::new(handled([4, 25, 4], 8)).unwrap();
    let start = simulation.momenta().linear;
    run(&mut simulation, 20e-6);
    assert_grouped(&simulation);
    let mut expected = start;
    for (_, impulse) in simulation.condition_impulses() {
        assert!(impulse.norm() > 0.0);
        expected += impulse;
    }
    let wall = simulation.obstacle_impulses()[0].1;
    assert!(wall.norm() > 0.0);
    expected -= wall;
    let end = simulation.momenta().linear;
    assert!((end - expected).norm() < 1e-12 * wall.norm());
    // Nothing is in the wall, which has moved.
    let tolerance = constraint::CONTACT_TOLERANCE * 1e-3;
    let level = 0.9e-3 + 20.0 * 20e-6;
    let lowest = simulation.state().position.iter().map(|x| x.y);
    assert!(lowest.fold(f64::MAX, f64::min) > level - 100.0 * tolerance);
}

#[test]
fn fine_and_slow_stresses_add_up() {
    let mut simulation = Simulation::new(collision([4, 25, 4], 8)).unwrap();
    run(&mut simulation, 15e-6);
    assert_grouped(&simulation);
    let mut local = simulation.local.take().unwrap();
    // The same parts from the sum as from the sub-steps.
    let (stress, pressure) = (local.fine_stress.clone(), local.fine_pressure.clone());
    local.split_stress(&simulation);
    let size = stress.iter().map(Mat3::norm).fold(0.0, f64::max);
    let mut mixed = 0;
    let groups = &local.groups[0];
    for (q, (one, other)) in stress.iter().zip(&local.fine_stress).enumerate() {
        assert!((one - other).norm() < 1e-13 * size, "point {q}");
        let pure = simulation.work.scaled_stress[q] * (1.0 - share(groups.points.level(q)));
        mixed += usize::from((one - pure).norm() > 1e-3 * size);
    }
    assert!(mixed > 0);
    assert_eq!(pressure, local.fine_pressure);
}

#[test]
fn the_fastest_vibration_is_found_in_its_surroundings() {
    let mut simulation = Simulation::new(collision([4, 25, 4], 8)).unwrap();
    run(&mut simulation, 15e-6);
    assert_grouped(&simulation);
    let mut local = simulation.local.take().unwrap();
    local.regroup(&simulation);
    let found = local.choice.survey(&simulation);
    let reference = simulation.reference();
    let mut work = Workspace::of_strains(reference);
    let (scheme, state) = (simulation.scheme(), simulation.state());
    let all = Vibrations::default();
    let limit = Frequency::new(reference).limit(&mut work, reference, scheme, state, all);
    // The vibration decays within its surroundings, which are whole tiles.
    assert!((found / limit - 1.0).abs() < 1e-2, "{found} {limit}");
}

#[test]
fn runs_of_tiles_are_their_items() {
    let simulation = Simulation::new(collision([4, 25, 4], 8)).unwrap();
    let body = &simulation.reference().bodies[0];
    let mut groups = Groups::new(body);
    let asked = |q: usize| match q {
        70 => 1,
        305 => 3,
        300..310 => 2,
        _ => 0,
    };
    groups.choose(body, asked);
    let all = 0..body.points.len();
    let mut items = 0;
    for level in 0..=LARGEST_LEVEL {
        let own = Levels::only(level);
        for run in groups.points.runs(all.clone(), own) {
            assert!(run.clone().all(|q| groups.points.level(q) == level));
            items += run.len();
        }
        assert_eq!(groups.points.count(own) > 0, level < 4, "{level}");
    }
    assert_eq!(items, all.len());
    for q in all {
        // All points of its ends have its level at least, and their J.
        let of_ends = body.ends[q].map(|a| groups.jacobian[a as usize]);
        assert!(of_ends.iter().all(|level| *level >= asked(q)));
    }
    for (a, level) in groups.jacobian.iter().enumerate() {
        let (points, _) = body.shares.of(a);
        let levels = points.iter().map(|q| groups.points.level(*q as usize));
        assert_eq!(Some(*level), levels.min());
        assert!(groups.moving.level(a) >= *level);
    }
}

#[test]
fn what_local_steps_cannot_do_is_refused() {
    let refused = |change: fn(&mut Model)| {
        let mut model = collision([4, 6, 4], 4);
        change(&mut model);
        Simulation::new(model).unwrap_err().to_string()
    };
    for (change, needed) in [
        (
            (|model| model.scheme.substeps = 6) as fn(&mut Model),
            "a power of two",
        ),
        (
            |model| model.scheme.integrator = Integrator::RungeKutta4,
            "the leapfrog",
        ),
        (
            |model| model.scheme.quadrature = Quadrature::Particles,
            "bonds",
        ),
        (
            |model| model.scheme.step_limit = StepLimit::Stretch,
            "the acoustic limit",
        ),
        (
            |model| model.scheme.stabilisation.upwind = 0.1,
            "without stabilisation",
        ),
        (|model| model.scheme.projection = true, "without projection"),
    ] {
        let message = refused(change);
        assert!(message.contains(needed), "{message}");
    }
}

/// The impact of neighbouring layers drives a shock of a spacing's width through the boundaries between
/// levels.
#[test]
fn a_shock_through_levels_keeps_its_energy_and_tangles_nothing() {
    let run = |substeps: u32| {
        let mut simulation = Simulation::new(collision([4, 25, 4], substeps)).unwrap();
        let (mut smallest, mut finest) = (f64::INFINITY, 1);
        while simulation.time() < 20e-6 {
            simulation.advance_step(20e-6).unwrap();
            let state = simulation.state();
            for f in &state.deformation_gradient {
                smallest = smallest.min(crate::time_step::smallest_stretch(f));
                assert!(f.determinant() > 0.0);
            }
            if substeps > 1 {
                finest = finest.max(ratio(&simulation));
            }
        }
        (finest, smallest, simulation.energies())
    };
    let (equal, local) = (run(1), run(8));
    assert!(local.0 > 1);
    // 0.076 and 0.052: layers of a spacing are pressed into one another, but no bond turns over.
    assert!(local.1 > 0.5 * equal.1);
    // A shock of a spacing's width has its own error, 0.042 with equal steps and 0.038 here.
    let (one, other) = (equal.2, local.2);
    assert!(
        other.balance().abs() < one.balance().abs() + 0.01,
        "{other:?}"
    );
    assert!((other.plastic / one.plastic - 1.0).abs() < 0.01);
}
