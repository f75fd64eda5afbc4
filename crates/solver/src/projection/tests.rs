use super::*;
use crate::model::{Integrator, Quadrature};
use crate::testing::{Random, body, elastic, model, scheme};

fn reference(nodes: [usize; 3]) -> Reference {
    Reference::new(&model(
        nodes,
        elastic(),
        scheme(Quadrature::Particles, Integrator::Leapfrog),
    ))
    .unwrap()
}

fn random_field(reference: &Reference, seed: u64) -> Vec<Vec3> {
    let mut random = Random(seed);
    reference
        .position
        .iter()
        .map(|_| random.vector() * 1e6)
        .collect()
}

/// |Σ V f| over Σ V |f|, and |Σ V y × f| over Σ V |y| |f|.
fn imbalance(reference: &Reference, lever: impl Fn(usize) -> Vec3, field: &[Vec3]) -> (f64, f64) {
    let (mut force, mut torque) = (Vec3::zeros(), Vec3::zeros());
    let (mut force_size, mut torque_size) = (0.0, 0.0);
    for (a, f) in field.iter().enumerate() {
        let f = f * reference.volume[a];
        let y = lever(a);
        force += f;
        torque += y.cross(&f);
        force_size += f.norm();
        torque_size += y.norm() * f.norm();
    }
    (force.norm() / force_size, torque.norm() / torque_size)
}

/// Arms of bodies that fill space, a plane, a tilted line and a point.
fn levers(reference: &Reference) -> Vec<(&'static str, Vec<Vec3>)> {
    let x = &reference.position;
    let tilted = Vec3::new(1.0, -2.0, 0.5);
    vec![
        ("solid", x.to_vec()),
        (
            "deformed",
            x.iter()
                .map(|x| x + Vec3::new(x.y * x.z, x.z * x.z, x.x * x.y) * 100.0)
                .collect(),
        ),
        (
            "coplanar",
            x.iter()
                .map(|x| Vec3::new(x.x + x.z, x.y, x.x - x.y))
                .collect(),
        ),
        ("collinear", x.iter().map(|x| tilted * x.x).collect()),
        ("one point", vec![tilted; x.len()]),
    ]
}

#[test]
fn projected_forces_have_neither_resultant_nor_torque() {
    for nodes in [[5, 4, 3], [7, 5, 1]] {
        let reference = reference(nodes);
        for (name, arms) in levers(&reference) {
            let mut field = random_field(&reference, 1);
            conserve(&reference, &|a| arms[a], [&mut field]);
            let (force, torque) = imbalance(&reference, |a| arms[a], &field);
            assert!(
                force < 1e-14 && torque < 1e-14,
                "{name}: {force:e}, {torque:e}"
            );
            assert!(
                field.iter().all(|f| f.norm() < 1e8),
                "{name}: forces blew up"
            );
        }
    }
}

#[test]
fn change_is_the_least_possible() {
    // It is if and only if it is orthogonal, in the volume-weighted product, to every field
    // without resultant and torque.
    let reference = reference([5, 4, 3]);
    let product = |f: &[Vec3], g: &[Vec3]| -> f64 {
        (0..f.len())
            .map(|a| reference.volume[a] * f[a].dot(&g[a]))
            .sum()
    };
    for (name, arms) in levers(&reference) {
        let before = random_field(&reference, 2);
        let mut after = before.clone();
        conserve(&reference, &|a| arms[a], [&mut after]);
        let change: Vec<Vec3> = before.iter().zip(&after).map(|(b, a)| a - b).collect();
        let mut admissible = random_field(&reference, 3);
        conserve(&reference, &|a| arms[a], [&mut admissible]);
        let size = (product(&change, &change) * product(&admissible, &admissible)).sqrt();
        let inner = product(&change, &admissible);
        assert!(inner.abs() < 1e-13 * size, "{name}: {inner:e} of {size:e}");
        assert!(
            product(&change, &change) > 0.0,
            "{name}: nothing was changed"
        );
    }
}

#[test]
fn balanced_forces_are_left_alone() {
    let reference = reference([5, 4, 3]);
    let lever = |a: usize| reference.position[a];
    let mut field = random_field(&reference, 4);
    conserve(&reference, &lever, [&mut field]);
    let once = field.clone();
    conserve(&reference, &lever, [&mut field]);
    let largest = once
        .iter()
        .zip(&field)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max);
    assert!(largest < 1e-13 * 1e6, "{largest:e}");
}

#[test]
fn rigid_accelerations_are_removed_entirely() {
    let reference = reference([5, 4, 3]);
    let (push, spin) = (Vec3::new(3.0, -1.0, 2.0), Vec3::new(-400.0, 250.0, 700.0));
    let mut field: Vec<Vec3> = reference
        .position
        .iter()
        .map(|x| push + spin.cross(x))
        .collect();
    conserve(&reference, &|a| reference.position[a], [&mut field]);
    assert!(field.iter().all(|f| f.norm() < 1e-13 * push.norm()));
}

#[test]
fn every_body_is_balanced_by_itself() {
    let mut model = model(
        [4, 3, 3],
        elastic(),
        scheme(Quadrature::Particles, Integrator::Leapfrog),
    );
    model.bodies.push(body("other", [3, 3, 5], elastic()));
    let reference = Reference::new(&model).unwrap();
    let mut field = random_field(&reference, 5);
    let first = reference.bodies[0].particles.clone();
    // The second body starts balanced: a force on the first must not reach it.
    conserve(&reference, &|a| reference.position[a], [&mut field]);
    let second: Vec<Vec3> = field[first.end..].to_vec();
    field[first.clone()]
        .iter_mut()
        .for_each(|f| *f += Vec3::new(1e6, 0.0, 0.0));
    conserve(&reference, &|a| reference.position[a], [&mut field]);
    for (after, before) in field[first.end..].iter().zip(&second) {
        assert!((after - before).norm() < 1e-7);
    }
    let resultant: Vec3 = first.map(|a| field[a] * reference.volume[a]).sum();
    let size = 1e6 * reference.volume.iter().sum::<f64>();
    assert!(resultant.norm() < 1e-13 * size);
}
