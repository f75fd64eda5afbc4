//! Cost of a whole step of the shipped problems, on one thread and on two.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use jstsph_contact::{Friction, Law, Obstacle, Surface};
use jstsph_geometry::{Axis, Body, Dimension, Lattice, Shape, Spacing, build_body};
use jstsph_material::{MaterialSpec, library};
use jstsph_solver::{
    Formulation, Integrator, Model, ModelBody, ModelObstacle, Quadrature, Scheme, Simulation,
    SmoothingReference, Stabilisation, StepLimit, Weights,
};
use jstsph_sph::Kernel;
use jstsph_tensor::Vec3;

fn scheme(quadrature: Quadrature, integrator: Integrator) -> Scheme {
    let bonds = quadrature == Quadrature::Bonds;
    Scheme {
        quadrature,
        kernel: Kernel::QuinticSpline,
        smoothing_ratio: if bonds { 0.8 } else { 1.2 },
        smoothing_reference: SmoothingReference::Spacing,
        weights: Weights::Interpolation,
        boundary_correction: false,
        formulation: Formulation::MomentumGradientCofactorJacobian,
        integrator,
        cfl: 0.3,
        step_limit: StepLimit::Stretch,
        stabilisation: Stabilisation {
            upwind: if bonds { 0.0 } else { 0.15 },
            ..Stabilisation::default()
        },
        projection: !bonds,
        inertia_scale: 1.0,
        smallest_time_step: 1e-6,
        substeps: 1,
    }
}

fn material(name: &str) -> MaterialSpec {
    let found = library().iter().find(|material| material.name == name);
    found
        .expect("the library has the paper's materials")
        .spec
        .clone()
}

fn wall(normal: Vec3) -> ModelObstacle {
    ModelObstacle {
        obstacle: Obstacle {
            name: "wall".into(),
            surface: Surface::Plane {
                point: Vec3::zeros(),
                normal,
            },
            law: Law::Inelastic { restitution: 0.0 },
            friction: Friction::default(),
        },
        velocity: None,
        heat: None,
    }
}

fn model(
    body: Body,
    material: MaterialSpec,
    velocity: Vec3,
    obstacles: Vec<ModelObstacle>,
    scheme: Scheme,
) -> Model {
    Model {
        dimension: body.dimension,
        bodies: vec![ModelBody {
            name: "body".into(),
            initial_temperature: vec![jstsph_material::ROOM_TEMPERATURE; body.positions.len()],
            initial_velocity: vec![velocity; body.positions.len()],
            body: body.into(),
            material,
            body_force: None,
        }],
        conditions: Vec::new(),
        obstacles,
        heat: None,
        scheme,
    }
}

/// The copper bar on its wall: 899 nodes with three per radius, 4131 with five.
fn taylor_bar(per_radius: usize, scheme: Scheme) -> Model {
    let shape = Shape::Cylinder {
        base: Vec3::zeros(),
        axis: Axis::Z,
        radius: 3.2e-3,
        height: 32e-3,
    };
    let spacing = Spacing::Radial {
        per_radius,
        layers: 10 * per_radius + 1,
    };
    let body =
        build_body(shape, Lattice::Cubic { spacing }, Dimension::Solid).expect("a bar has nodes");
    let velocity = Vec3::new(0.0, 0.0, -227.0);
    model(
        body,
        material("copper_taylor"),
        velocity,
        vec![wall(Vec3::z())],
        scheme,
    )
}

/// The aluminium billet of equal channel angular extrusion, 8 × 50 nodes between two walls.
fn billet(scheme: Scheme) -> Model {
    let shape = Shape::Box {
        min: Vec3::zeros(),
        max: Vec3::new(8e-3, 56e-3, 0.0),
    };
    let spacing = Spacing::Counts([8, 50, 1]);
    let body = build_body(shape, Lattice::Cubic { spacing }, Dimension::PlaneStrain)
        .expect("a billet has nodes");
    let velocity = Vec3::new(0.0, -20.0, 0.0);
    let walls = vec![wall(Vec3::y()), wall(Vec3::x())];
    model(body, material("al1100_ecae"), velocity, walls, scheme)
}

/// Steps made before the clock starts: the lower end is then in plastic flow.
const WARM_UP: usize = 300;

/// Steps of one sample, each sample from the same state.
const STEPS: u32 = 20;

fn warmed_up(model: Model) -> Simulation {
    let mut simulation = Simulation::new(model).expect("the model is sound");
    advance(&mut simulation, WARM_UP);
    simulation
}

fn advance(simulation: &mut Simulation, steps: usize) {
    for _ in 0..steps {
        simulation
            .advance_step(f64::INFINITY)
            .expect("the run is stable");
    }
}

fn step(c: &mut Criterion) {
    type Build = fn(Scheme) -> Model;
    let cases: [(&str, Quadrature, Build); 4] = [
        ("billet_400_bonds", Quadrature::Bonds, billet),
        ("bar_899_bonds", Quadrature::Bonds, |scheme| {
            taylor_bar(3, scheme)
        }),
        ("bar_4131_bonds", Quadrature::Bonds, |scheme| {
            taylor_bar(5, scheme)
        }),
        ("bar_4131_particles", Quadrature::Particles, |scheme| {
            taylor_bar(5, scheme)
        }),
    ];
    let mut group = c.benchmark_group("step");
    group.sample_size(20);
    for (name, quadrature, build) in cases {
        for (integrator, label) in [
            (Integrator::Leapfrog, "leapfrog"),
            (Integrator::TvdRungeKutta, "tvd_rk2"),
        ] {
            let start = warmed_up(build(scheme(quadrature, integrator)));
            group.throughput(Throughput::Elements(
                start.reference().point_volume.len() as u64
            ));
            for threads in [1, 2] {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .expect("threads can be started");
                let id = BenchmarkId::new(format!("{name}/{label}"), threads);
                group.bench_function(id, |b| {
                    b.iter_custom(|iterations| {
                        // Whole steps only: the clone that each run starts from is not timed.
                        let mut left = iterations;
                        let mut total = std::time::Duration::ZERO;
                        while left > 0 {
                            let steps = left.min(u64::from(STEPS));
                            let mut simulation = start.clone();
                            total += pool.install(|| {
                                let clock = std::time::Instant::now();
                                advance(&mut simulation, steps as usize);
                                clock.elapsed()
                            });
                            left -= steps;
                        }
                        total
                    });
                });
            }
        }
    }
    group.finish();
}

criterion_group!(benches, step);
criterion_main!(benches);
