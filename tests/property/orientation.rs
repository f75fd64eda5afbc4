//! Physics does not know how particles are numbered, nor which way the lattice points.

use std::sync::Arc;

use jstsph_geometry::{Body, Cells, Dimension};
use jstsph_solver::{Scheme, Simulation};
use jstsph_tensor::{Mat3, Vec3};
use jstsph_tests::setup;

use crate::tumbling;

const STEPS: usize = 100;

fn run(body: Body, velocity: impl Fn(&Vec3) -> Vec3, scheme: Scheme) -> Simulation {
    let model = setup::free_body(body, setup::copper(), velocity, scheme);
    let mut simulation = setup::start(model);
    setup::advance_steps(&mut simulation, STEPS);
    assert!(simulation.energies().plastic > 0.0, "the body must yield");
    simulation
}

/// The body with node a renamed to `new_name[a]`.
fn renumbered(body: &Body, new_name: &[u32]) -> Body {
    let mut renamed = body.clone();
    for (a, &b) in new_name.iter().enumerate() {
        let b = b as usize;
        Arc::make_mut(&mut renamed.positions)[b] = body.positions[a];
        renamed.volumes[b] = body.volumes[a];
        renamed.weights[b] = body.weights[a];
        renamed.boundary[b] = body.boundary[a];
    }
    let ends = Arc::make_mut(&mut renamed.bonds.ends);
    for end in ends.iter_mut().flatten() {
        *end = new_name[*end as usize];
    }
    let rename = |corner: &mut u32| *corner = new_name[*corner as usize];
    match &mut renamed.cells {
        Cells::Quads(cells) => cells.iter_mut().flatten().for_each(rename),
        Cells::Hexes(cells) => cells.iter_mut().flatten().for_each(rename),
    }
    renamed
}

/// Sums run in another order, so that the answers agree to round-off: 1e-16 m per step in places of
/// size 0.3 m, which plastic flow amplifies.
#[test]
fn renumbered_particles_move_alike() {
    for dimension in [Dimension::PlaneStrain, Dimension::Solid] {
        let body = tumbling::body(dimension);
        let count = body.positions.len() as u32;
        // A stride that shares no factor with the number of nodes visits each of them once.
        let stride = (0..).map(|k| 37 + 2 * k).find(|s| gcd(*s, count) == 1);
        let stride = stride.expect("some stride does");
        let new_name: Vec<u32> = (0..count).map(|a| (a * stride + 5) % count).collect();
        for (name, scheme) in tumbling::conserving_schemes() {
            let velocity = tumbling::velocity(dimension);
            let expected = run(body.clone(), &velocity, scheme);
            let got = run(renumbered(&body, &new_name), &velocity, scheme);
            for (a, &b) in new_name.iter().enumerate() {
                let difference = got.state().position[b as usize] - expected.state().position[a];
                assert!(
                    difference.norm() < 1e-13,
                    "{name}, {dimension:?}, particle {a}: {:.2e} m",
                    difference.norm()
                );
            }
        }
    }
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// A body whose lattice is turned by an angle that belongs to no symmetry, with its velocities.
/// Kernels depend on distances alone, so that everything turns with it.
#[test]
fn obliquely_turned_bodies_move_alike() {
    let axis = Vec3::new(0.3, -0.5, 0.8).normalize();
    for (dimension, axis) in [
        (Dimension::PlaneStrain, Vec3::z()),
        (Dimension::Solid, axis),
    ] {
        let rotation = rotation(axis, 0.7);
        let mut turned = tumbling::body(dimension);
        for x in Arc::make_mut(&mut turned.positions) {
            *x = rotation * *x;
        }
        for (name, scheme) in tumbling::conserving_schemes() {
            let velocity = tumbling::velocity(dimension);
            let expected = run(tumbling::body(dimension), &velocity, scheme);
            let back = rotation.transpose();
            let got = run(turned.clone(), |x| rotation * velocity(&(back * x)), scheme);
            for (a, x) in expected.state().position.iter().enumerate() {
                let difference = back * got.state().position[a] - x;
                assert!(
                    difference.norm() < 1e-12,
                    "{name}, {dimension:?}, particle {a}: {:.2e} m",
                    difference.norm()
                );
            }
        }
    }
}

/// Rotation by an angle about a unit axis, by Rodrigues' formula.
fn rotation(axis: Vec3, angle: f64) -> Mat3 {
    let cross = Mat3::new(
        0.0, -axis.z, axis.y, axis.z, 0.0, -axis.x, -axis.y, axis.x, 0.0,
    );
    Mat3::identity() + cross * angle.sin() + cross * cross * (1.0 - angle.cos())
}
