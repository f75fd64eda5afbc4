//! Temporal order: particles fixed, time step halved, every unknown against a fine-step reference.
//!
//! A free elastic body starts with strains of about ten per cent on their way, so that F, H and J
//! are far from linear in time.

use std::f64::consts::PI;

use jstsph_geometry::Dimension;
use jstsph_material::MaterialSpec;
use jstsph_solver::{Integrator, Model, Scheme, Simulation, Stabilisation};
use jstsph_tensor::{Mat3, Vec3};
use jstsph_tests::{Study, saved, setup};

/// Columns of the tables; the last one is zero for elastic materials.
const UNKNOWNS: [&str; 6] = ["p", "F", "H", "J", "x", "eps_p"];
const ELASTIC_UNKNOWNS: [&str; 5] = ["p", "F", "H", "J", "x"];

/// Courant numbers are one over these.
const REFINEMENTS: [usize; 3] = [4, 8, 16];
const REFERENCE: usize = 256;

/// Speed over the pressure wave speed: of the order of the strains that follow.
const SPEED: f64 = 0.1;

fn model(dimension: Dimension, material: MaterialSpec, scheme: Scheme) -> Model {
    let intervals = match dimension {
        Dimension::PlaneStrain => [8, 6, 1],
        Dimension::Solid => [5, 4, 4],
    };
    let body = setup::block([1.0, 0.75, 0.75], intervals, dimension);
    let speed = SPEED * material.wave_speeds().pressure;
    let flat = if dimension == Dimension::Solid {
        1.0
    } else {
        0.0
    };
    setup::free_body(
        body,
        material,
        |x| {
            Vec3::new(
                (PI * x.x).cos() - x.y,
                x.x - 0.5 + (PI * x.y).sin(),
                flat * (x.z * x.x - 0.3),
            ) * speed
        },
        scheme,
    )
}

/// A run until pressure waves have crossed the body once.
fn run(dimension: Dimension, material: &MaterialSpec, scheme: Scheme) -> Simulation {
    let end = 1.0 / material.wave_speeds().pressure;
    setup::run(model(dimension, material.clone(), scheme), end)
}

/// Root mean square of the differences of two lists, given their squares.
fn root_mean_square(squares: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
    f64::sqrt(sum / count)
}

/// One difference per entry of [`UNKNOWNS`].
fn differences(now: &Simulation, reference: &Simulation) -> Vec<f64> {
    fn tensors(a: &[Mat3], b: &[Mat3]) -> f64 {
        root_mean_square(a.iter().zip(b).map(|(a, b)| (a - b).norm_squared()))
    }
    fn vectors(a: &[Vec3], b: &[Vec3]) -> f64 {
        root_mean_square(a.iter().zip(b).map(|(a, b)| (a - b).norm_squared()))
    }
    let (a, b) = (now.state(), reference.state());
    let strain = |simulation| {
        saved::plastic_history(simulation)
            .into_iter()
            .map(|h| h.equivalent_plastic_strain)
    };
    vec![
        vectors(&a.momentum, &b.momentum),
        tensors(&a.deformation_gradient, &b.deformation_gradient),
        root_mean_square(
            (0..a.deformation_gradient.len())
                .map(|q| (a.cofactor_at(q) - b.cofactor_at(q)).norm_squared()),
        ),
        root_mean_square(
            a.jacobian
                .iter()
                .zip(&b.jacobian)
                .map(|(a, b)| (a - b) * (a - b)),
        ),
        vectors(&a.position, &b.position),
        root_mean_square(
            strain(now)
                .zip(strain(reference))
                .map(|(a, b)| (a - b) * (a - b)),
        ),
    ]
}

fn study(name: &str, dimension: Dimension, material: &MaterialSpec, scheme: Scheme) -> Study {
    let at = |refinement: usize| {
        run(
            dimension,
            material,
            Scheme {
                cfl: 1.0 / refinement as f64,
                ..scheme
            },
        )
    };
    let reference = at(REFERENCE);
    let title = format!("time step, {name}, {dimension}, {:?}", scheme.integrator);
    let study = Study::over(title, &UNKNOWNS, &REFINEMENTS, |n| {
        differences(&at(n), &reference)
    });
    study.show();
    study
}

fn schemes(integrator: Integrator) -> [(&'static str, Scheme); 2] {
    [
        (
            "particles",
            Scheme {
                integrator,
                ..setup::particles(0.9)
            },
        ),
        (
            "bonds",
            Scheme {
                integrator,
                ..setup::bonds(0.8)
            },
        ),
    ]
}

/// Orders of the integrators, as ranges of what is observed.
const INTEGRATORS: [(Integrator, std::ops::Range<f64>); 4] = [
    (Integrator::Leapfrog, 1.9..2.15),
    (Integrator::TvdRungeKutta, 1.9..2.15),
    (Integrator::SspRungeKutta, 2.8..3.2),
    (Integrator::RungeKutta4, 3.85..4.2),
];

/// (3.16), the leapfrog and the methods of higher order: measured 1.98 to 2.07, 2.93 to 3.12
/// and 3.98 to 4.10 for every unknown.
#[test]
fn elastic_vibration_has_the_order_of_the_integrator_in_every_unknown() {
    for dimension in [Dimension::PlaneStrain, Dimension::Solid] {
        for (integrator, order) in INTEGRATORS {
            for (name, scheme) in schemes(integrator) {
                let scheme = Scheme {
                    stabilisation: Stabilisation::default(),
                    ..scheme
                };
                let study = study(name, dimension, &setup::rubber(0.3), scheme);
                for unknown in ELASTIC_UNKNOWNS {
                    study.assert_order(unknown, order.clone());
                }
            }
        }
    }
}

/// Dissipation is part of R(u) in all stages: measured 1.97 to 2.06, 2.85 to 3.11
/// and 3.88 to 4.13.
#[test]
fn runge_kutta_keeps_its_order_with_dissipation() {
    for (integrator, order) in INTEGRATORS.into_iter().skip(1) {
        for (name, scheme) in schemes(integrator) {
            let scheme = Scheme {
                stabilisation: setup::particles(0.9).stabilisation,
                ..scheme
            };
            let study = study(name, Dimension::PlaneStrain, &setup::rubber(0.3), scheme);
            for unknown in ELASTIC_UNKNOWNS {
                study.assert_order(unknown, order.clone());
            }
        }
    }
}

/// Known limitation: the leapfrog evaluates the dissipation with the momentum of half a step
/// before, which is first order in the (small) dissipative part. Measured 1.2 to 1.3 on the way
/// down to 1; the error at a Courant number of 1/16 is four times that without dissipation.
#[test]
fn leapfrog_takes_the_dissipation_half_a_step_late() {
    for (name, scheme) in schemes(Integrator::Leapfrog) {
        let scheme = Scheme {
            stabilisation: setup::particles(0.9).stabilisation,
            ..scheme
        };
        let study = study(name, Dimension::PlaneStrain, &setup::rubber(0.3), scheme);
        for unknown in ELASTIC_UNKNOWNS {
            study.assert_order(unknown, 1.0..1.6);
        }
    }
}

/// The return map is backward Euler: first order in the plastic strain increments, hence in
/// everything that follows from them; measured 0.8 to 1.8, falling to 1. Methods of higher order gain
/// nothing here.
#[test]
fn plastic_flow_is_first_order() {
    for (integrator, order, finest) in [
        (Integrator::Leapfrog, 0.8..2.2, 1e-4),
        (Integrator::TvdRungeKutta, 0.8..2.2, 1e-4),
        (Integrator::SspRungeKutta, 0.7..2.2, 1.5e-4),
        (Integrator::RungeKutta4, 0.7..2.2, 1.5e-4),
    ] {
        for (name, scheme) in schemes(integrator) {
            let scheme = Scheme {
                stabilisation: Stabilisation::default(),
                ..scheme
            };
            let study = study(name, Dimension::PlaneStrain, &setup::copper(), scheme);
            for unknown in UNKNOWNS {
                study.assert_order(unknown, order.clone());
            }
            study.assert_finest_error("eps_p", finest);
        }
    }
}
