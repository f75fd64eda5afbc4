//! A cylinder upset between platens: with friction it barrels, without it stays a cylinder.

use jstsph_contact::{Friction, Law, Obstacle, Surface};
use jstsph_geometry::{Dimension, Lattice, Shape, Spacing, build_body};
use jstsph_solver::{ModelObstacle, Signal, Simulation};
use jstsph_tensor::Vec3;
use jstsph_tests::setup;

const HEIGHT: f64 = 12e-3;
const RADIUS: f64 = 4e-3;

/// The cylinder at 70 % of its height.
fn upset(friction: f64) -> Simulation {
    let shape = Shape::Cylinder {
        base: Vec3::zeros(),
        axis: jstsph_geometry::Axis::Z,
        radius: RADIUS,
        height: HEIGHT,
    };
    let lattice = Lattice::Cubic {
        spacing: Spacing::Radial {
            per_radius: 3,
            layers: 10,
        },
    };
    let body = build_body(shape, lattice, Dimension::Solid).expect("a cylinder");
    let mut model = setup::free_body(body, setup::copper(), |_| Vec3::zeros(), setup::bonds(0.8));
    let speed = 20.0;
    for (name, z, way) in [("bottom", 0.0, 1.0), ("top", HEIGHT, -1.0)] {
        model.obstacles.push(ModelObstacle {
            obstacle: Obstacle {
                name: name.into(),
                surface: Surface::Plane {
                    point: Vec3::new(0.0, 0.0, z),
                    normal: Vec3::z() * way,
                },
                law: Law::default(),
                friction: Friction::coulomb(friction),
            },
            velocity: Some([0.0, 0.0, speed * way].map(Signal::Constant)),
            heat: None,
        });
    }
    setup::run(model, 0.15 * HEIGHT / speed)
}

/// Widest reach along x of the nodes in the layers for which `chosen` holds, m.
fn reach(simulation: &Simulation, chosen: impl Fn(f64) -> bool) -> f64 {
    let reference = &simulation.reference().position;
    let nodes = simulation.state().position.iter().zip(reference.iter());
    nodes
        .filter(|(_, start)| chosen(start.z))
        .fold(0.0, |reach, (x, _)| x.x.max(reach))
}

#[test]
fn barrelling_grows_with_friction() {
    let mut last = -1.0;
    for friction in [0.0, 0.1, 0.3] {
        let simulation = upset(friction);
        let end = reach(&simulation, |z| z < 1e-9);
        let middle = reach(&simulation, |z| (z - 0.5 * HEIGHT).abs() < 0.1 * HEIGHT);
        let barrel = (middle - end) / RADIUS;
        let energies = simulation.energies();
        assert!(barrel > last, "friction {friction}: {barrel} after {last}");
        last = barrel;
        assert!(energies.balance().abs() < 1e-3, "{energies:?}");
        if friction == 0.0 {
            // The volume stays: the radius grows by 1/sqrt(0.7).
            for radius in [end, middle] {
                assert!((radius / RADIUS * 0.7_f64.sqrt() - 1.0).abs() < 5e-3);
            }
        }
    }
    // Measured 0.09 and 0.20 of the radius.
    assert!(last > 0.15, "{last}");
}
