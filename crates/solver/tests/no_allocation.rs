//! A step allocates nothing. Alone in its binary, because the counters are those of the process.

use std::alloc::System;

use jstsph_contact::{Friction, Law, Obstacle, Surface};
use jstsph_geometry::{Dimension, Lattice, Shape, Spacing, build_body};
use jstsph_material::library;
use jstsph_solver::{
    Biharmonic, Condition, ConditionKind, Formulation, Integrator, Jst, Laplacian, Model,
    ModelBody, ModelObstacle, Quadrature, Scheme, Signal, Simulation, SmoothingReference,
    Stabilisation, StepLimit, Viscosity, Weights,
};
use jstsph_sph::Kernel;
use jstsph_tensor::Vec3;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// A copper plate that falls onto a wall and is held at a corner, with every stabilisation on.
fn model(quadrature: Quadrature, integrator: Integrator, formulation: Formulation) -> Model {
    let shape = Shape::Box {
        min: Vec3::zeros(),
        max: Vec3::new(10e-3, 6e-3, 0.0),
    };
    let lattice = Lattice::Cubic {
        spacing: Spacing::Counts([11, 7, 1]),
    };
    let body = build_body(shape, lattice, Dimension::PlaneStrain).unwrap();
    let full = formulation == Formulation::MomentumGradientCofactorJacobian;
    Model {
        dimension: Dimension::PlaneStrain,
        bodies: vec![ModelBody {
            name: "plate".into(),
            initial_temperature: vec![jstsph_material::ROOM_TEMPERATURE; body.positions.len()],
            initial_velocity: vec![Vec3::new(20.0, -150.0, 0.0); body.positions.len()],
            body: body.into(),
            material: library()[0].spec.clone(),
            body_force: Some([0.0, -9.81, 0.0].map(Signal::Constant)),
        }],
        conditions: vec![
            Condition {
                name: "hold".into(),
                body: 0,
                particles: vec![76],
                kind: ConditionKind::Velocity([Some(Signal::Constant(0.0)), None, None]),
            },
            Condition {
                name: "load".into(),
                body: 0,
                particles: vec![6, 13],
                kind: ConditionKind::Traction {
                    areas: vec![1e-3; 2],
                    traction: [
                        Signal::Constant(0.0),
                        Signal::Constant(-1e7),
                        Signal::Constant(0.0),
                    ],
                },
            },
        ],
        obstacles: vec![ModelObstacle {
            obstacle: Obstacle {
                name: "wall".into(),
                surface: Surface::Plane {
                    point: Vec3::zeros(),
                    normal: Vec3::y(),
                },
                law: Law::Inelastic { restitution: 0.0 },
                friction: Friction::coulomb(0.2),
            },
            velocity: Some([0.0, 1.0, 0.0].map(Signal::Constant)),
            heat: None,
        }],
        heat: None,
        scheme: Scheme {
            quadrature,
            kernel: Kernel::QuinticSpline,
            smoothing_ratio: 0.9,
            smoothing_reference: SmoothingReference::Spacing,
            weights: Weights::Interpolation,
            boundary_correction: false,
            formulation,
            integrator,
            cfl: 0.3,
            step_limit: StepLimit::Acoustic,
            stabilisation: Stabilisation {
                jst: Some(Jst {
                    harmonic: 0.0,
                    biharmonic: Biharmonic::FallingWithPlasticStrain {
                        initial: 1.0 / 64.0,
                        last: 1.0 / 4096.0,
                        strain: 0.05,
                    },
                    on_jacobian: full,
                    laplacian: Laplacian::Symmetric,
                }),
                upwind: 0.05,
                hourglass: 0.01,
                viscosity: Some(Viscosity {
                    linear: 0.1,
                    quadratic: 0.2,
                }),
            },
            projection: true,
            inertia_scale: 1.0,
            smallest_time_step: 1e-6,
            substeps: 1,
        },
    }
}

/// Allocations of some steps, of the first step too.
fn allocations_of_steps(model: Model) -> usize {
    let mut simulation = Simulation::new(model).expect("the model is sound");
    let region = Region::new(ALLOCATOR);
    // Local steps need some compression to begin.
    let steps = if simulation.scheme().substeps > 1 {
        200
    } else {
        20
    };
    for _ in 0..steps {
        simulation.advance_step(1.0).expect("the run is stable");
    }
    let change = region.change();
    // What was measured is plastic flow in contact.
    assert!(simulation.energies().plastic > 0.0);
    assert!(simulation.obstacle_impulses()[0].1.norm() > 0.0);
    assert_eq!(simulation.has_substeps(), steps > 20);
    change.allocations + change.reallocations
}

#[test]
fn advancing_a_step_allocates_nothing() {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    // The counter is that of the whole process: the test harness, which writes down on its own thread what
    // it has started, and the pool have to be done first.
    pool.install(|| ());
    std::thread::sleep(std::time::Duration::from_millis(100));
    let counter = Region::new(ALLOCATOR);
    assert!(!std::hint::black_box(vec![1u8]).is_empty());
    assert!(
        counter.change().allocations > 0,
        "the allocator is not the counting one"
    );
    for quadrature in [Quadrature::Particles, Quadrature::Bonds] {
        for integrator in [
            Integrator::Leapfrog,
            Integrator::TvdRungeKutta,
            Integrator::RungeKutta4,
        ] {
            for formulation in [
                Formulation::MomentumGradientCofactorJacobian,
                Formulation::MomentumGradient,
            ] {
                let model = model(quadrature, integrator, formulation);
                let allocations = pool.install(|| allocations_of_steps(model));
                assert_eq!(
                    allocations, 0,
                    "{quadrature:?}, {integrator:?}, {formulation:?}"
                );
            }
        }
    }
    let model = with_substeps();
    let allocations = pool.install(|| allocations_of_steps(model));
    assert_eq!(allocations, 0, "sub-steps");
}

/// A block that hits the wall fast enough for local time steps, which know no traction.
fn with_substeps() -> Model {
    let shape = Shape::Box {
        min: Vec3::zeros(),
        max: Vec3::new(4e-3, 10e-3, 3e-3),
    };
    let lattice = Lattice::Cubic {
        spacing: Spacing::Counts([5, 11, 4]),
    };
    let mut model = model(
        Quadrature::Bonds,
        Integrator::Leapfrog,
        Formulation::MomentumGradientCofactorJacobian,
    );
    model.dimension = Dimension::Solid;
    let block = &mut model.bodies[0];
    block.body = build_body(shape, lattice, Dimension::Solid).unwrap().into();
    let count = block.body.positions.len();
    block.initial_temperature = vec![jstsph_material::ROOM_TEMPERATURE; count];
    block.initial_velocity = vec![Vec3::new(20.0, -600.0, 0.0); count];
    model.conditions.pop();
    model.scheme.stabilisation = Stabilisation::default();
    model.scheme.projection = false;
    model.scheme.substeps = 8;
    model
}
