//! Heat: what is conserved, and how it couples to the motion.

use jstsph_contact::{Friction, Law, Obstacle, Surface};
use jstsph_geometry::Dimension;
use jstsph_material::models::HenckyVonMises;
use jstsph_material::{MaterialSpec, Property, Thermal};
use jstsph_solver::{
    Condition, ConditionKind, Heat, Model, ModelObstacle, ObstacleHeat, Scheme, Signal,
};
use jstsph_tensor::Vec3;
use jstsph_tests::{Study, setup};

use crate::tumbling;

const ROOM: f64 = jstsph_material::ROOM_TEMPERATURE;

const HEAT: Heat = Heat {
    conduction: true,
    viscous_heating: true,
    friction_heating: true,
};

/// Copper of the Taylor bar with the thermal properties of copper (CRC Handbook).
fn thermal_copper(expansion: f64, taylor_quinney: f64) -> MaterialSpec {
    let MaterialSpec::HenckyVonMises(copper) = setup::copper() else {
        unreachable!("the copper of the set-up is hencky_von_mises")
    };
    MaterialSpec::HenckyVonMises(HenckyVonMises {
        thermal: Some(Thermal {
            heat_capacity: Property::Constant(385.0),
            conductivity: Property::Constant(400.0),
            taylor_quinney,
            expansion,
            reference_temperature: ROOM,
        }),
        ..copper
    })
}

fn hot(mut model: Model, material: MaterialSpec, temperature: impl Fn(&Vec3) -> f64) -> Model {
    let body = &mut model.bodies[0];
    body.material = material;
    body.initial_temperature = body.body.positions.iter().map(temperature).collect();
    model.heat = Some(HEAT);
    model
}

fn schemes() -> impl Iterator<Item = (&'static str, Scheme)> {
    tumbling::conserving_schemes()
        .into_iter()
        .filter(|(name, _)| !name.contains("JST"))
}

/// Heat conducted inside an insulated body stays in it, to round-off, with a capacity that depends
/// on the temperature, in a body at rest.
#[test]
fn insulated_body_keeps_its_heat() {
    for (name, scheme) in schemes() {
        let mut material = setup::conductor(0.0);
        if let Some(thermal) = &mut material.thermal {
            thermal.heat_capacity = Property::Table {
                temperatures: vec![200.0, 400.0, 500.0, 900.0],
                values: vec![800.0, 1000.0, 1500.0, 1200.0],
            };
        }
        let body = tumbling::body(Dimension::Solid);
        let model = setup::free_body(body, setup::rubber(0.3), |_| Vec3::zeros(), scheme);
        let model = hot(model, MaterialSpec::Hencky(material), |x| {
            450.0 + 1500.0 * (x.x - 0.35) + 1000.0 * (x.y + 0.16) * (40.0 * x.z).sin()
        });
        let spread = |t: &[f64]| {
            let (low, high) = t.iter().fold((f64::MAX, 0.0f64), |(low, high), t| {
                (low.min(*t), high.max(*t))
            });
            high - low
        };
        let before = spread(&model.bodies[0].initial_temperature);
        let mut simulation = setup::start(model);
        setup::advance_steps(&mut simulation, 20);
        assert!(
            spread(&simulation.state().temperature) < 0.5 * before,
            "{name}"
        );
        // Relative to the heat that moved: about ρ c V × 30 K.
        let moved = 1.1e6 * 0.1 * 0.08 * 0.08 * 30.0;
        let content = simulation.energies().thermal;
        assert!(
            content.abs() < 1e-11 * moved,
            "{name}: {content:.1e} J of {moved:.1e} J"
        );
    }
}

/// Without conduction the heat is the Taylor-Quinney share of the plastic work (and all of the
/// viscous and friction work).
#[test]
fn adiabatic_heat_is_the_share_of_the_plastic_work() {
    for (name, scheme) in schemes() {
        let mut model = hot(
            tumbling::model(Dimension::PlaneStrain, scheme),
            thermal_copper(0.0, 0.9),
            |_| ROOM,
        );
        model.heat = Some(Heat {
            conduction: false,
            viscous_heating: false,
            ..HEAT
        });
        let simulation = setup::run(model, 1e-5);
        let energies = simulation.energies();
        assert!(energies.plastic > 0.0, "{name}: too tame");
        let expected = 0.9 * energies.plastic;
        assert!((energies.thermal / expected - 1.0).abs() < 1e-11, "{name}");
        assert!(
            (energies.heat_generated / expected - 1.0).abs() < 1e-11,
            "{name}"
        );
    }
}

/// Mechanical and thermal energy together: plastic heating, thermoelastic exchange and conduction in
/// a tumbling, yielding body close the balance as the step is refined.
#[test]
fn energy_of_motion_and_heat_balances() {
    for (name, scheme) in schemes() {
        let study = Study::over(name, &["balance"], &[4, 8, 16], |refinement| {
            let mut model = hot(
                tumbling::model(Dimension::PlaneStrain, scheme),
                thermal_copper(17e-6, 0.9),
                |x| ROOM + 2000.0 * (x.x - 0.3),
            );
            model.scheme.cfl = 1.0 / refinement as f64;
            let simulation = setup::run(model, 1e-5);
            vec![simulation.energies().balance().abs()]
        });
        study.show();
        study.assert_finest_error("balance", 2e-4);
    }
}

/// A body that cannot move is under the pressure −3 α κ (T − T_ref) when it is heated.
#[test]
fn confined_body_is_under_thermal_pressure() {
    for (name, scheme) in schemes() {
        let body = tumbling::body(Dimension::Solid);
        let particles = (0..body.positions.len() as u32).collect();
        let model = setup::free_body(body, setup::rubber(0.3), |_| Vec3::zeros(), scheme);
        let mut model = hot(model, MaterialSpec::Hencky(setup::conductor(1e-5)), |_| {
            ROOM + 50.0
        });
        model.conditions = vec![Condition {
            name: "all".into(),
            body: 0,
            particles,
            kind: ConditionKind::Velocity([0.0; 3].map(|v| Some(Signal::Constant(v)))),
        }];
        let mut simulation = setup::start(model);
        setup::advance_steps(&mut simulation, 3);
        let bulk_modulus = 17e6 / (3.0 * (1.0 - 0.6));
        let expected = -3.0 * 1e-5 * bulk_modulus * 50.0;
        for pressure in simulation.particle_fields().pressure {
            assert!(
                (pressure / expected - 1.0).abs() < 1e-12,
                "{name}: {pressure} Pa"
            );
        }
    }
}

/// A block that touches a hot plate: heat enters at h A (T_plate − T) and no other way.
#[test]
fn hot_plate_heats_what_touches_it() {
    for (name, scheme) in schemes() {
        let body = setup::block([0.1, 0.08, 0.08], [5, 4, 4], Dimension::Solid);
        let model = setup::free_body(body, setup::rubber(0.3), |_| Vec3::zeros(), scheme);
        let mut model = hot(model, MaterialSpec::Hencky(setup::conductor(0.0)), |_| ROOM);
        model.obstacles.push(ModelObstacle {
            obstacle: Obstacle {
                name: "plate".into(),
                surface: Surface::Plane {
                    point: Vec3::zeros(),
                    normal: Vec3::z(),
                },
                law: Law::Inelastic { restitution: 0.0 },
                friction: Friction::default(),
            },
            velocity: None,
            heat: Some(ObstacleHeat {
                conductance: 5000.0,
                temperature: Signal::Constant(ROOM + 200.0),
            }),
        });
        let mut simulation = setup::start(model);
        setup::advance_steps(&mut simulation, 1);
        let expected = 5000.0 * 0.1 * 0.08 * 200.0 * simulation.time();
        let energies = simulation.energies();
        // The area of the base by summation by parts: exact to 1e-6 at these smoothing lengths.
        assert!(
            (energies.heat_supplied / expected - 1.0).abs() < 1e-2,
            "{name}: {:.6e} J, not {expected:.6e} J",
            energies.heat_supplied
        );
        // Round-off of 293 K against the 1e-3 K of one step.
        let relative = energies.thermal / energies.heat_supplied - 1.0;
        assert!(relative.abs() < 1e-8, "{name}: {relative:.1e}");
    }
}

/// Adiabatic elastic waves with a strong thermoelastic coupling (a tenth of the bulk modulus) keep
/// their energy: an exchange one step behind the stress would make them grow by some per cent a step.
#[test]
fn adiabatic_elastic_waves_do_not_grow() {
    for (name, scheme) in schemes() {
        let body = tumbling::body(Dimension::PlaneStrain);
        let velocity =
            |x: &Vec3| Vec3::new(0.3 * (60.0 * x.x).sin(), 0.2 * (70.0 * x.y).cos(), 0.0);
        let model = setup::free_body(body, setup::rubber(0.3), velocity, scheme);
        // (3 α κ)² T/(ρ c) = 0.09 κ.
        let mut model = hot(
            model,
            MaterialSpec::Hencky(setup::conductor(1.6e-3)),
            |_| ROOM,
        );
        model.heat = Some(Heat {
            conduction: false,
            ..HEAT
        });
        let mut simulation = setup::start(model);
        let start = simulation.energies().initial;
        setup::advance_steps(&mut simulation, 1000);
        let energies = simulation.energies();
        assert!(
            energies.kinetic < 1.05 * start && energies.balance().abs() < 2e-3,
            "{name}: {energies:?}"
        );
    }
}
