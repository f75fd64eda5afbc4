//! Heat conduction against series solutions: a bar with cold ends, an insulated block, a stretched
//! bar, and convection.

use std::f64::consts::PI;

use jstsph_geometry::{Dimension, Selection, face_areas, select};
use jstsph_material::MaterialSpec;
use jstsph_solver::{
    Condition, ConditionKind, Heat, Model, Scheme, Signal, Simulation, Stabilisation,
};
use jstsph_tensor::Vec3;
use jstsph_tests::{Study, setup};

const ROOM: f64 = 293.15;
const DIFFUSIVITY: f64 = 10.0;

const CONDUCTION: Heat = Heat {
    conduction: true,
    viscous_heating: true,
    friction_heating: true,
};

fn schemes() -> [(&'static str, Scheme); 2] {
    let nodal = Scheme {
        stabilisation: Stabilisation::default(),
        ..setup::particles(0.9)
    };
    [("particles", nodal), ("bonds", setup::bonds(0.8))]
}

/// A body at rest with a conductor's properties and the given initial temperature.
fn resting(
    intervals: [usize; 3],
    size: [f64; 3],
    dimension: Dimension,
    scheme: Scheme,
    temperature: impl Fn(&Vec3) -> f64,
) -> Model {
    let body = setup::block(size, intervals, dimension);
    let found = body.positions.iter().map(temperature).collect();
    let material = MaterialSpec::Hencky(setup::conductor(0.0));
    let mut model = setup::free_body(body, material, |_| Vec3::zeros(), scheme);
    model.heat = Some(CONDUCTION);
    model.bodies[0].initial_temperature = found;
    model
}

fn on_face(model: &Model, face: &str, kind: ConditionKind) -> Condition {
    let particles = select(&model.bodies[0].body, &Selection::Face(face.into())).expect("a face");
    Condition {
        name: face.into(),
        body: 0,
        particles,
        kind,
    }
}

/// Root of the volume-weighted mean square of T − exact, over the amplitude 100 K.
fn error(simulation: &Simulation, exact: impl Fn(&Vec3) -> f64) -> f64 {
    let reference = simulation.reference();
    let (mut sum, mut volume) = (0.0, 0.0);
    for ((x, v), t) in reference
        .position
        .iter()
        .zip(&reference.volume)
        .zip(&simulation.state().temperature)
    {
        sum += v * (t - exact(x)).powi(2);
        volume += v;
    }
    (sum / volume).sqrt() / 100.0
}

/// T = T0 + 100 sin(π X/L) exp(−α π² t/L²), both ends held at T0.
#[test]
fn bar_with_cold_ends_is_second_order() {
    let end = 1.0 / (DIFFUSIVITY * PI * PI);
    let profile =
        |x: &Vec3, t: f64| ROOM + 100.0 * (PI * x.x).sin() * (-DIFFUSIVITY * PI * PI * t).exp();
    for (name, scheme) in schemes() {
        let study = Study::over(name, &["temperature"], &[10, 20, 40], |n| {
            let mut model = resting(
                [n, 4, 1],
                [1.0, 4.0 / n as f64, 0.0],
                Dimension::PlaneStrain,
                scheme,
                |x| profile(x, 0.0),
            );
            model.conditions = ["left", "right"]
                .map(|face| {
                    let held = ConditionKind::Temperature(Signal::Constant(ROOM));
                    on_face(&model, face, held)
                })
                .to_vec();
            let simulation = setup::run(model, end);
            vec![error(&simulation, |x| profile(x, end))]
        });
        study.show();
        study.assert_order("temperature", 1.9..2.3);
        study.assert_finest_error("temperature", 1e-3);
    }
}

/// T = T0 + 100 cos(π X) cos(π Y) cos(π Z) exp(−3 α π² t) in an insulated cube.
#[test]
fn insulated_cube_is_second_order() {
    let end = 0.5 / (3.0 * DIFFUSIVITY * PI * PI);
    let profile = |x: &Vec3, t: f64| {
        let shape = (PI * x.x).cos() * (PI * x.y).cos() * (PI * x.z).cos();
        ROOM + 100.0 * shape * (-3.0 * DIFFUSIVITY * PI * PI * t).exp()
    };
    for (name, scheme) in schemes() {
        let study = Study::over(name, &["temperature"], &[6, 12, 24], |n| {
            let model = resting([n; 3], [1.0; 3], Dimension::Solid, scheme, |x| {
                profile(x, 0.0)
            });
            let simulation = setup::run(model, end);
            vec![error(&simulation, |x| profile(x, end))]
        });
        study.show();
        study.assert_order("temperature", 1.8..2.4);
    }
}

/// A bar that is pulled to twice its length, its cross-section kept, conducts like a bar of that
/// length: the wave decays with α π²/(2 L)².
#[test]
fn stretched_bar_conducts_along_its_present_length() {
    for (name, scheme) in schemes() {
        let n = 40;
        let mut model = resting(
            [n, 4, 1],
            [1.0, 4.0 / n as f64, 0.0],
            Dimension::PlaneStrain,
            scheme,
            |_| ROOM,
        );
        // Every particle moves as the stretch prescribes; the temperatures are set when it is over.
        let stretch_time = 0.02;
        let velocity = move |t: f64, x: &Vec3| {
            if t < stretch_time {
                x.x / stretch_time
            } else {
                0.0
            }
        };
        model.conditions = vec![Condition {
            name: "stretch".into(),
            body: 0,
            particles: (0..model.bodies[0].body.positions.len() as u32).collect(),
            kind: ConditionKind::Velocity([
                Some(Signal::Function(std::sync::Arc::new(velocity))),
                Some(Signal::Constant(0.0)),
                None,
            ]),
        }];
        let mut simulation = setup::run(model, stretch_time);
        let mut saved = simulation.save();
        let reference = simulation.reference().position.clone();
        for (array, values) in &mut saved.arrays {
            if array == "temperature" {
                for (t, x) in values.iter_mut().zip(reference.iter()) {
                    *t = ROOM + 100.0 * (PI * x.x).cos();
                }
            }
        }
        simulation.restore(&saved).expect("its own state");
        let duration = 4.0 * 0.5 / (DIFFUSIVITY * PI * PI);
        while simulation.time() < stretch_time + duration {
            setup::advance(&mut simulation, stretch_time + duration);
        }
        // J = 2 doubles the volume of the reference conductivity per length, the stretch quarters it;
        // the heat capacity is that of the mass: decay by J k/λ² = k/2 per reference volume.
        let decay = (-0.5 * DIFFUSIVITY * PI * PI * duration).exp();
        let found = error(&simulation, |x| ROOM + 100.0 * decay * (PI * x.x).cos());
        assert!(found < 2e-3, "{name}: {found:.2e}");
    }
}

/// A thin plate in cold surroundings: its temperature falls as exp(−h A t/(ρ c V)).
#[test]
fn convection_cools_a_thin_plate_exponentially() {
    let (coefficient, ambient) = (1e6, 273.15);
    for (name, scheme) in schemes() {
        let mut model = resting(
            [8, 2, 1],
            [0.8, 0.2, 0.0],
            Dimension::PlaneStrain,
            scheme,
            |_| ROOM + 100.0,
        );
        let areas: Vec<f64> = face_areas(&model.bodies[0].body, "top")
            .expect("a box has areas")
            .iter()
            .map(|share| share.area)
            .collect();
        let cooled = ConditionKind::Convection {
            areas,
            coefficient,
            ambient: Signal::Constant(ambient),
        };
        model.conditions = vec![on_face(&model, "top", cooled)];
        let end = 0.1;
        let simulation = setup::run(model, end);
        // Biot number h d/k = 0.02: the plate is uniform to a per cent of the difference.
        let lumped =
            ambient + (ROOM + 100.0 - ambient) * (-coefficient * end / (1.1e6 * 0.2)).exp();
        let mean = simulation.state().temperature.iter().sum::<f64>()
            / simulation.state().temperature.len() as f64;
        assert!(
            (mean - lumped).abs() < 1.0,
            "{name}: {mean} K, not {lumped} K"
        );
        let energies = simulation.energies();
        assert!((energies.thermal - energies.heat_supplied).abs() < 1e-12 * energies.thermal.abs());
    }
}
