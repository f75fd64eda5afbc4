//! Physics does not know units or axes.

use jstsph_contact::{Friction, Law, Obstacle, Surface};
use jstsph_geometry::{Dimension, face_areas};
use jstsph_material::MaterialSpec;
use jstsph_material::hardening::{Hardening, Linear};
use jstsph_material::models::HenckyVonMises;
use jstsph_solver::{Condition, ConditionKind, Model, ModelObstacle, Scheme, Signal, Simulation};
use jstsph_tensor::{Mat3, Vec3};
use jstsph_tests::setup;

use crate::tumbling;

/// New units per old one: a length of 1 becomes `length`, and so on.
#[derive(Clone, Copy, Debug)]
struct Units {
    length: f64,
    mass: f64,
    time: f64,
}

impl Units {
    fn pressure(self) -> f64 {
        self.mass / (self.length * self.time * self.time)
    }
    fn speed(self) -> f64 {
        self.length / self.time
    }
    fn energy(self) -> f64 {
        self.mass * self.speed() * self.speed()
    }
}

/// A copper block under traction that hits a wall, in the given units.
fn model_in(units: Units, scheme: Scheme) -> Model {
    let Units { length, mass, .. } = units;
    let material = MaterialSpec::HenckyVonMises(HenckyVonMises::new(
        8930.0 * mass / length.powi(3),
        117e9 * units.pressure(),
        0.35,
        Hardening::Linear(Linear {
            initial_yield_stress: 0.4e9 * units.pressure(),
            modulus: 0.1e9 * units.pressure(),
        }),
    ));
    let body = setup::block(
        [0.1, 0.08, 0.08].map(|l| l * length),
        [5, 4, 4],
        Dimension::Solid,
    );
    let areas = face_areas(&body, "right").expect("a box has areas");
    let velocity = |x: &Vec3| {
        let x = x / length;
        Vec3::new(900.0 * x.y, 500.0 * x.x * x.z * 10.0, -150.0) * units.speed()
    };
    let mut model = setup::free_body(body, material, velocity, scheme);
    model.obstacles.push(ModelObstacle {
        obstacle: Obstacle {
            name: "wall".into(),
            surface: Surface::Plane {
                point: Vec3::new(0.0, 0.0, -1e-4) * length,
                normal: Vec3::z(),
            },
            law: Law::Inelastic { restitution: 0.0 },
            friction: Friction::default(),
        },
        velocity: None,
        heat: None,
    });
    model.conditions.push(Condition {
        name: "pulled".into(),
        body: 0,
        particles: areas.iter().map(|part| part.node).collect(),
        kind: ConditionKind::Traction {
            areas: areas.iter().map(|part| part.area).collect(),
            traction: [0.1e9, 0.05e9, 0.0].map(|t| Signal::Constant(t * units.pressure())),
        },
    });
    model
}

/// Largest difference of two positions, given how to get from one frame to the other.
fn largest_difference(a: &[Vec3], b: &[Vec3], into_a: impl Fn(usize) -> Vec3) -> f64 {
    debug_assert_eq!(a.len(), b.len());
    a.iter()
        .enumerate()
        .fold(0.0, |largest, (i, x)| largest.max((x - into_a(i)).norm()))
}

/// Finds any hidden unit and any absolute tolerance. Factors that are no powers of two change
/// every rounding; plastic flow amplifies that to 1e-12 or so within 200 steps.
#[test]
fn results_scale_with_the_units() {
    let foot_pound_minute = Units {
        length: 3.280_839_9,
        mass: 2.204_622_6,
        time: 1.0 / 60.0,
    };
    let micro = Units {
        length: 1.1e6,
        mass: 1.7e9,
        time: 1.3e6,
    };
    let kilo = Units {
        length: 0.7e-3,
        mass: 1.9e-6,
        time: 2.3e-3,
    };
    let si = Units {
        length: 1.0,
        mass: 1.0,
        time: 1.0,
    };
    for (name, scheme) in tumbling::conserving_schemes() {
        let run = |units| {
            let mut simulation = setup::start(model_in(units, scheme));
            setup::advance_steps(&mut simulation, 200);
            simulation
        };
        let expected = run(si);
        assert!(
            expected.energies().plastic > 0.0 && expected.energies().contact != 0.0,
            "{name}"
        );
        for units in [foot_pound_minute, micro, kilo] {
            let got = run(units);
            let close = |what: &str, got: f64, expected: f64, unit: f64, scale: f64| {
                let error = (got / unit - expected).abs() / scale;
                assert!(error < 1e-9, "{name}, {units:?}: {what} off by {error:.2e}");
            };
            close(
                "time",
                got.time(),
                expected.time(),
                units.time,
                expected.time(),
            );
            let (position, reference) = (&got.state().position, &expected.state().position);
            let difference =
                largest_difference(reference, position, |i| position[i] / units.length);
            assert!(
                difference < 1e-9 * 0.1,
                "{name}, {units:?}: positions off by {difference:.2e}"
            );
            let (e, s) = (got.energies(), expected.energies());
            let unit = units.energy();
            close("kinetic energy", e.kinetic, s.kinetic, unit, s.largest());
            close("elastic energy", e.elastic, s.elastic, unit, s.largest());
            close(
                "plastic dissipation",
                e.plastic,
                s.plastic,
                unit,
                s.largest(),
            );
            close(
                "numerical dissipation",
                e.numerical,
                s.numerical,
                unit,
                s.largest(),
            );
            close("external work", e.external, s.external, unit, s.largest());
            close("work of contact", e.contact, s.contact, unit, s.largest());
        }
    }
}

/// A turn by 90 degrees about an axis, which takes the box and its lattice along.
struct Turn {
    name: &'static str,
    rotation: Mat3,
}

fn turned(turn: &Turn, scheme: Scheme) -> Simulation {
    let (size, intervals) = (Vec3::new(0.1, 0.08, 0.06), Vec3::new(5.0, 4.0, 3.0));
    let rotation = turn.rotation;
    let corner = rotation * size;
    let min = corner.map(|c| c.min(0.0));
    let counts = (rotation * intervals).map(f64::abs);
    let body = setup::block_at(
        min.into(),
        corner.map(f64::abs).into(),
        [0, 1, 2].map(|i| counts[i] as usize),
        Dimension::Solid,
    );
    let velocity = tumbling::velocity(Dimension::Solid);
    let rotated = move |x: &Vec3| rotation * velocity(&(rotation.transpose() * x));
    let mut simulation = setup::start(setup::free_body(body, setup::copper(), rotated, scheme));
    setup::advance_steps(&mut simulation, 200);
    simulation
}

/// Nodes are numbered along the axes, so that a turn renumbers them too: sums run in another order.
///
/// The leapfrog agrees to round-off of the size, 0.1 m. With TVD-RK2, H differs from cof F at second
/// order in the time step, and the stable step takes det F from the first rows of the two: known
/// limitation, measured 4e-9 m after 200 steps.
#[test]
fn turned_set_up_gives_turned_results() {
    let none = Turn {
        name: "none",
        rotation: Mat3::identity(),
    };
    let about_z = Turn {
        name: "about z",
        rotation: Mat3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0),
    };
    let about_x = Turn {
        name: "about x",
        rotation: Mat3::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0),
    };
    let cyclic = Turn {
        name: "about the diagonal",
        rotation: Mat3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0),
    };
    for (name, scheme) in tumbling::conserving_schemes() {
        let expected = turned(&none, scheme);
        assert!(
            expected.energies().plastic > 0.0,
            "{name}: the body must yield"
        );
        for turn in [&about_z, &about_x, &cyclic] {
            let got = turned(turn, scheme);
            let back = turn.rotation.transpose();
            let start: Vec<Vec3> = got.reference().position.iter().map(|x| back * x).collect();
            let node = |x: &Vec3| {
                start
                    .iter()
                    .position(|y| (x - y).norm() < 1e-3)
                    .expect("the same node, turned")
            };
            let reference = &expected.reference().position;
            let difference =
                largest_difference(&expected.state().position, &got.state().position, |a| {
                    back * got.state().position[node(&reference[a])]
                });
            // Round-off of coordinates of size one over a few hundred steps.
            let limit = 1e-14;
            assert!(
                difference < limit,
                "{name}, {}: positions off by {difference:.2e} m",
                turn.name
            );
        }
    }
}
