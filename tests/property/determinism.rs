//! The same model gives the same bits: for any number of threads, and interrupted or not.

use jstsph_contact::{Friction, Law, Obstacle, Surface};
use jstsph_geometry::Dimension;
use jstsph_solver::{Condition, ConditionKind, Model, ModelObstacle, Saved, Scheme, Signal};
use jstsph_tensor::Vec3;
use jstsph_tests::setup;

use crate::tumbling;

/// Everything that has books or a memory: plasticity, contact, a prescribed velocity that varies.
fn eventful(intervals: [usize; 3], scheme: Scheme) -> Model {
    let body = setup::block([0.1, 0.08, 0.08], intervals, Dimension::Solid);
    let velocity = |x: &Vec3| Vec3::new(500.0 * x.y, 300.0 * x.x, -80.0);
    let mut model = setup::free_body(body, setup::copper(), velocity, scheme);
    model.obstacles.push(ModelObstacle {
        obstacle: Obstacle {
            name: "wall".into(),
            surface: Surface::Plane {
                point: Vec3::new(0.0, 0.0, -1e-4),
                normal: Vec3::z(),
            },
            law: Law::Inelastic { restitution: 0.2 },
            friction: Friction::coulomb(0.2),
        },
        velocity: Some([0.0, 0.0, 5.0].map(Signal::Constant)),
        heat: None,
    });
    model.conditions.push(Condition {
        name: "corner".into(),
        body: 0,
        particles: vec![0, 1],
        kind: ConditionKind::Velocity([
            Some(Signal::Table {
                times: vec![0.0, 1e-4],
                values: vec![0.0, 30.0],
            }),
            None,
            None,
        ]),
    });
    model
}

fn in_a_pool<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a pool");
    pool.install(work)
}

/// Which arrays of two saved states differ.
fn differences(a: &Saved, b: &Saved) -> Vec<String> {
    let bits = |values: &[f64]| {
        values
            .iter()
            .map(|value| value.to_bits())
            .collect::<Vec<_>>()
    };
    let arrays = a.arrays.iter().zip(&b.arrays);
    let mut different: Vec<String> = arrays
        .filter(|((_, a), (_, b))| bits(a) != bits(b))
        .map(|((name, _), _)| name.clone())
        .collect();
    let clock = |saved: &Saved| (saved.time.to_bits(), saved.time_step.to_bits(), saved.step);
    if clock(a) != clock(b) {
        different.push("clock".into());
    }
    different
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    for (name, scheme) in tumbling::conserving_schemes() {
        let run = |threads| {
            in_a_pool(threads, || {
                // 2744 particles: above the size from which loops are parallel.
                let mut simulation = setup::start(eventful([13, 13, 13], scheme));
                setup::advance_steps(&mut simulation, 12);
                (
                    simulation.save(),
                    simulation.energies(),
                    simulation.momenta(),
                )
            })
        };
        let serial = run(1);
        for threads in [2, 7] {
            let parallel = run(threads);
            let different = differences(&serial.0, &parallel.0);
            assert!(
                different.is_empty(),
                "{name}, {threads} threads: {different:?} differ"
            );
            assert_eq!(serial.1, parallel.1, "{name}, {threads} threads");
            assert_eq!(serial.2, parallel.2, "{name}, {threads} threads");
        }
    }
}

#[test]
fn interrupted_run_has_the_bits_of_an_uninterrupted_one() {
    for (name, scheme) in tumbling::conserving_schemes() {
        let end = 1e-4;
        let model = eventful([6, 5, 5], scheme);
        let mut whole = setup::start(model.clone());
        let mut first = setup::start(model.clone());
        while whole.time() < 0.5 * end {
            setup::advance(&mut whole, end);
            setup::advance(&mut first, end);
        }
        let mut second = setup::start(model);
        second
            .restore(&first.save())
            .expect("a state of the same model");
        while whole.time() < end {
            setup::advance(&mut whole, end);
            setup::advance(&mut second, end);
        }
        let different = differences(&whole.save(), &second.save());
        assert!(
            different.is_empty(),
            "{name}: {different:?} differ after the restart"
        );
        assert_eq!(whole.energies(), second.energies(), "{name}");
        assert!(
            whole.energies().plastic > 0.0 && whole.energies().contact != 0.0,
            "{name}: too tame"
        );
    }
}
