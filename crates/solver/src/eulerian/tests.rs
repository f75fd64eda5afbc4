use super::*;
use crate::Simulation;
use crate::model::{Formulation, Integrator, Quadrature, Viscosity};
use crate::testing::{Random, elastic, model, scheme};

fn simulation(nodes: [usize; 3]) -> Simulation {
    let mut scheme = scheme(Quadrature::Particles, Integrator::Leapfrog);
    scheme.formulation = Formulation::EulerianKernel;
    scheme.projection = false;
    scheme.smoothing_ratio = 1.2;
    scheme.stabilisation.viscosity = Some(Viscosity {
        linear: 0.5,
        quadratic: 1.0,
    });
    Simulation::new(model(nodes, elastic(), scheme)).unwrap()
}

/// l is exact for a linear velocity field in a deformed body: l F of any F.
#[test]
fn velocity_gradient_of_a_linear_field_is_exact() {
    for nodes in [[7, 6, 1], [6, 5, 5]] {
        let mut simulation = simulation(nodes);
        let mut random = Random(3);
        let plane = nodes[2] == 1;
        let mut gradient = random.tensor() * 100.0;
        if plane {
            gradient.m13 = 0.0;
            gradient.m23 = 0.0;
            (gradient.m31, gradient.m32, gradient.m33) = (0.0, 0.0, 0.0);
        }
        let density = simulation.reference.bodies[0].density;
        for a in 0..simulation.state.position.len() {
            let mut shift = random.vector() * 2e-4;
            if plane {
                shift.z = 0.0;
            }
            simulation.state.position[a] += shift;
            simulation.state.momentum[a] = gradient * simulation.state.position[a] * density;
            simulation.state.deformation_gradient[a] =
                Mat3::identity() + random.tensor() * if plane { 0.0 } else { 0.1 };
        }
        simulation.velocity_gradient();
        for a in 0..simulation.state.position.len() {
            let expected = gradient * simulation.state.deformation_gradient[a];
            let found = simulation.work.velocity_gradient[a];
            assert!(
                (found - expected).norm() < 1e-11 * expected.norm(),
                "particle {a}"
            );
        }
    }
}

/// Forces of any stress and the viscosity add up to nothing, and the viscosity only takes energy,
/// exactly what it reports as heat.
#[test]
fn forces_conserve_momentum_and_viscosity_dissipates() {
    let mut simulation = simulation([6, 5, 4]);
    let mut random = Random(8);
    let density = simulation.reference.bodies[0].density;
    for a in 0..simulation.state.position.len() {
        simulation.state.position[a] += random.vector() * 2e-4;
        simulation.state.momentum[a] = random.vector() * density;
        simulation.work.scaled_stress[a] = random.tensor();
    }
    simulation.velocity_gradient();
    simulation.forces(|state, a| state.position[a]);
    let (work, volume) = (&simulation.work, &simulation.reference.volume);
    for force in [&work.internal_force, &work.dissipation] {
        let (sum, size) = force
            .iter()
            .zip(volume)
            .fold((Vec3::zeros(), 0.0), |(sum, size), (f, v)| {
                (sum + f * *v, size + f.norm() * v)
            });
        assert!(size > 0.0 && sum.norm() < 1e-13 * size);
    }
    let power: f64 = (0..volume.len())
        .map(|a| volume[a] * work.dissipation[a].dot(&simulation.state.momentum[a]) / density)
        .sum();
    let heat: f64 = (0..volume.len())
        .map(|a| volume[a] * work.viscous_heating[a])
        .sum();
    assert!(heat > 0.0 && (power + heat).abs() < 1e-12 * heat);
    assert!(work.viscous_heating.iter().all(|rate| *rate >= 0.0));
}

/// In the undeformed body the force is that of a constant stress inside: none.
#[test]
fn constant_stress_gives_no_force_inside_the_undeformed_body() {
    let mut simulation = simulation([11, 11, 11]);
    let stress = Mat3::new(3.0, 1.0, 0.5, 1.0, -2.0, 0.2, 0.5, 0.2, 1.0) * 1e6;
    let volume = simulation.reference.volume.clone();
    for (scaled, v) in simulation.work.scaled_stress.iter_mut().zip(&volume) {
        *scaled = stress * *v;
    }
    simulation.velocity_gradient();
    simulation.forces(|state, a| state.position[a]);
    // The node in the middle sees full neighbours alone: its kernel gradients cancel in pairs.
    let middle = (0..volume.len())
        .min_by(|a, b| {
            let centre = Vec3::repeat(6e-3);
            let distance = |a: &usize| (simulation.state.position[*a] - centre).norm();
            distance(a).total_cmp(&distance(b))
        })
        .unwrap();
    let surface = simulation
        .work
        .internal_force
        .iter()
        .fold(0.0f64, |most, f| most.max(f.norm()));
    assert!(simulation.work.internal_force[middle].norm() < 1e-12 * surface);
}
