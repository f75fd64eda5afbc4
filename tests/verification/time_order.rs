//! Temporal order: particles fixed, time step halved, every unknown against a fine-step reference.
//!
//! A free elastic body starts with strains of about ten per cent on their way, so that F, H and J
//! are far from linear in time.

use std::f64::consts::PI;

use jstsph_geometry::Dimension;
use jstsph_solver::{Integrator, Model, Scheme, State};
use jstsph_tensor::Vec3;
use jstsph_tests::{Study, setup};

const UNKNOWNS: [&str; 5] = ["p", "F", "H", "J", "x"];

/// Courant numbers are one over these.
const REFINEMENTS: [usize; 3] = [4, 8, 16];
const REFERENCE: usize = 128;

/// Speed over the pressure wave speed: of the order of the strains that follow.
const SPEED: f64 = 0.1;

fn model(dimension: Dimension, material: jstsph_material::MaterialSpec, scheme: Scheme) -> Model {
    let intervals = match dimension {
        Dimension::PlaneStrain => [8, 6, 1],
        Dimension::Solid => [5, 4, 4],
    };
    let body = setup::block([1.0, 0.75, 0.75], intervals, dimension);
    let speed = SPEED * material.wave_speeds().pressure;
    let flat = if dimension == Dimension::Solid { 1.0 } else { 0.0 };
    setup::free_body(
        body,
        material,
        |x| {
            Vec3::new((PI * x.x).cos() - x.y, x.x - 0.5 + (PI * x.y).sin(), flat * (x.z * x.x - 0.3))
                * speed
        },
        scheme,
    )
}

/// Free vibration until pressure waves have crossed the body once.
fn state_at_end(dimension: Dimension, scheme: Scheme) -> State {
    let material = setup::rubber(0.3);
    let end = 1.0 / material.wave_speeds().pressure;
    setup::run(model(dimension, material, scheme), end).state().clone()
}

fn distance(now: &State, reference: &State) -> Vec<f64> {
    fn root_mean_square(squares: impl Iterator<Item = f64>) -> f64 {
        let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
        f64::sqrt(sum / count)
    }
    vec![
        root_mean_square(
            now.momentum.iter().zip(&reference.momentum).map(|(a, b)| (a - b).norm_squared()),
        ),
        root_mean_square(
            now.deformation_gradient
                .iter()
                .zip(&reference.deformation_gradient)
                .map(|(a, b)| (a - b).norm_squared()),
        ),
        root_mean_square(
            now.cofactor.iter().zip(&reference.cofactor).map(|(a, b)| (a - b).norm_squared()),
        ),
        root_mean_square(
            now.jacobian.iter().zip(&reference.jacobian).map(|(a, b)| (a - b) * (a - b)),
        ),
        root_mean_square(
            now.position.iter().zip(&reference.position).map(|(a, b)| (a - b).norm_squared()),
        ),
    ]
}

fn study(name: &str, dimension: Dimension, scheme: Scheme) -> Study {
    let at = |refinement: usize| {
        state_at_end(dimension, Scheme { cfl: 1.0 / refinement as f64, ..scheme })
    };
    let reference = at(REFERENCE);
    let study =
        Study::over(format!("time step, {name}, {dimension}"), &UNKNOWNS, &REFINEMENTS, |n| {
            distance(&at(n), &reference)
        });
    study.show();
    study
}

fn undamped(scheme: Scheme) -> Scheme {
    Scheme { stabilisation: Default::default(), ..scheme }
}

#[test]
fn measure() {
    let material = setup::copper();
    for (name, scheme) in [("particles", setup::particles(0.9)), ("bonds", setup::bonds(0.8))] {
        for integrator in [Integrator::Leapfrog, Integrator::TvdRungeKutta] {
            let end = 1.0 / material.wave_speeds().pressure;
            let at = |r: usize| {
                let m = model(Dimension::PlaneStrain, material.clone(), Scheme { integrator, cfl: 1.0 / r as f64, ..undamped(scheme) });
                let s = setup::run(m, end);
                let e: Vec<f64> = jstsph_tests::saved::plastic_history(&s).iter().map(|h| h.equivalent_plastic_strain).collect();
                (s.state().clone(), e, s.energies().balance())
            };
            let r = at(256);
            let mut q = UNKNOWNS.to_vec(); q.push("eps"); q.push("balance");
            Study::over(format!("plastic {name} {integrator:?} max eps {:?}", r.1.iter().fold(0.0f64, |a, b| a.max(*b))), &q, &[4, 8, 16, 32], |n| {
                let n = at(n);
                let mut d = distance(&n.0, &r.0);
                d.push((n.1.iter().zip(&r.1).map(|(a, b)| (a-b)*(a-b)).sum::<f64>() / r.1.len() as f64).sqrt());
                d.push(n.2.abs());
                d
            }).show();
        }
    }
}
