//! A Taylor bar built in code, without a case file: a copper cylinder hits a rigid wall.
//!
//! `cargo run --release -p jstsph-solver --example taylor_bar -- [per_radius] [cfl] [particles|bonds] [substeps]`
#![allow(clippy::print_stdout, reason = "an example talks to its reader")]

use jstsph_contact::{Friction, Law, Obstacle, Surface};
use jstsph_geometry::{Axis, Dimension, Lattice, Shape, Spacing, build_body, face_nodes};
use jstsph_material::library;
use jstsph_solver::{
    Formulation, Integrator, Model, ModelBody, ModelObstacle, Probe, ProbeKind, Quadrature, Scheme,
    Simulation, SmoothingReference, Stabilisation, StepLimit, Weights,
};
use jstsph_sph::Kernel;
use jstsph_tensor::Vec3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let per_radius: usize = arguments.get(1).map_or(Ok(3), |text| text.parse())?;
    let cfl: f64 = arguments.get(2).map_or(Ok(0.6), |text| text.parse())?;
    let bonds = arguments.get(3).is_none_or(|text| text == "bonds");
    let substeps: u32 = arguments.get(4).map_or(Ok(1), |text| text.parse())?;

    let shape = Shape::Cylinder {
        base: Vec3::zeros(),
        axis: Axis::Z,
        radius: 3.2e-3,
        height: 32e-3,
    };
    let layers = 10 * per_radius + 1;
    let lattice = Lattice::Cubic {
        spacing: Spacing::Radial { per_radius, layers },
    };
    let body = build_body(shape, lattice, Dimension::Solid)?;
    let rim = face_nodes(&body, "rim_base")?;
    let everything: Vec<u32> = (0..body.positions.len() as u32).collect();
    let copper = library()
        .iter()
        .find(|material| material.name == "copper_taylor")
        .ok_or("copper_taylor is not in the library")?;
    let model = Model {
        dimension: Dimension::Solid,
        bodies: vec![ModelBody {
            name: "bar".into(),
            initial_temperature: vec![jstsph_material::ROOM_TEMPERATURE; body.positions.len()],
            initial_velocity: vec![Vec3::new(0.0, 0.0, -227.0); body.positions.len()],
            body: body.into(),
            material: copper.spec.clone(),
            body_force: None,
        }],
        conditions: vec![],
        obstacles: vec![ModelObstacle {
            obstacle: Obstacle {
                name: "wall".into(),
                surface: Surface::Plane {
                    point: Vec3::zeros(),
                    normal: Vec3::z(),
                },
                law: Law::Inelastic { restitution: 0.0 },
                friction: Friction::default(),
            },
            velocity: None,
            heat: None,
        }],
        heat: None,
        scheme: Scheme {
            quadrature: if bonds {
                Quadrature::Bonds
            } else {
                Quadrature::Particles
            },
            kernel: Kernel::QuinticSpline,
            smoothing_ratio: if bonds { 0.8 } else { 1.2 },
            smoothing_reference: if bonds {
                SmoothingReference::Spacing
            } else {
                SmoothingReference::Volume
            },
            weights: Weights::Interpolation,
            boundary_correction: false,
            formulation: Formulation::MomentumGradientCofactorJacobian,
            integrator: Integrator::Leapfrog,
            cfl,
            step_limit: StepLimit::Acoustic,
            stabilisation: Stabilisation {
                upwind: if bonds { 0.0 } else { 0.15 },
                ..Default::default()
            },
            projection: !bonds,
            inertia_scale: 1.0,
            smallest_time_step: 1e-6,
            substeps,
        },
    };
    let probes = [
        Probe {
            name: "base_radius".into(),
            kind: ProbeKind::Radius {
                particles: rim,
                point: Vec3::zeros(),
                axis: 2,
            },
        },
        Probe {
            name: "length".into(),
            kind: ProbeKind::Extent {
                particles: everything,
                axis: 2,
            },
        },
    ];
    let mut simulation = Simulation::new(model)?;
    let reference = simulation.reference();
    println!(
        "{} particles, {} points, {:.1} neighbours, {} stored weights",
        reference.position.len(),
        reference.point_volume.len(),
        reference.neighbours_per_point(),
        reference.bodies[0].gradient.stored_weights(),
    );
    let clock = std::time::Instant::now();
    let end = 80e-6;
    while simulation.time() < end {
        simulation.advance_step(end)?;
    }
    let seconds = clock.elapsed().as_secs_f64();
    let fields = simulation.particle_fields();
    for probe in &probes {
        println!(
            "{} = {:.4} mm",
            probe.name,
            1e3 * simulation.probe(probe)[0]
        );
    }
    let largest = fields
        .equivalent_plastic_strain
        .iter()
        .copied()
        .fold(0.0, f64::max);
    let energies = simulation.energies();
    println!("largest plastic strain {largest:.3}, energies {energies:?}");
    println!(
        "balance {:.5} of the initial energy",
        energies.error() / energies.initial
    );
    let steps = simulation.step_count() as f64;
    println!(
        "{steps} steps in {seconds:.2} s: {:.0} ns per point and step",
        1e9 * seconds / (steps * simulation.reference().point_volume.len() as f64)
    );
    Ok(())
}
