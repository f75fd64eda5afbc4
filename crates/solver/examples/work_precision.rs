//! Work and precision of the integrators: a plate swings for five eighths of a period (the problem of
//! `tests/verification/swinging_plate.rs`), with bonds and no dissipation.
//!
//! `cargo run --example work_precision -p jstsph-solver -- [intervals]` prints, per integrator and CFL
//! number (a fraction of 2/ω_max), the evaluations of the right-hand side, the processor time, the
//! error of the velocity that is due to the time step, and that against the exact solution.
#![allow(clippy::print_stdout, reason = "an example talks to its reader")]

use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};
use std::time::Instant;

use jstsph_geometry::{Dimension, Lattice, Shape, Spacing, build_body, face_nodes};
use jstsph_material::MaterialSpec;
use jstsph_material::models::Hencky;
use jstsph_solver::{
    Condition, ConditionKind, Formulation, Integrator, Model, ModelBody, Quadrature, Scheme,
    Signal, Simulation, SmoothingReference, Stabilisation, StepLimit, Weights,
};
use jstsph_sph::Kernel;
use jstsph_tensor::Vec3;

type Failure = Box<dyn std::error::Error>;

/// Small enough for linear elasticity, so that the solution is known.
const AMPLITUDE: f64 = 1e-6;
const PERIODS: f64 = 0.625;

/// Evaluations per step, and CFL numbers up to the limit of vibrations.
const INTEGRATORS: [(&str, Integrator, u64, &[f64]); 4] = [
    (
        "leapfrog",
        Integrator::Leapfrog,
        1,
        &[0.95, 0.5, 0.25, 0.125],
    ),
    (
        "tvd-rk2",
        Integrator::TvdRungeKutta,
        2,
        &[0.25, 0.125, 0.0625],
    ),
    (
        "ssp-rk3",
        Integrator::SspRungeKutta,
        3,
        &[0.82, 0.5, 0.25, 0.125],
    ),
    ("rk4", Integrator::RungeKutta4, 5, &[1.6, 0.8, 0.4, 0.2]),
];

fn shape(x: &Vec3) -> Vec3 {
    let (x, y) = (x.x * FRAC_PI_2, x.y * FRAC_PI_2);
    Vec3::new(-x.sin() * y.cos(), x.cos() * y.sin(), 0.0)
}

/// The problem and its angular frequency.
fn problem(intervals: usize, integrator: Integrator, cfl: f64) -> Result<(Model, f64), Failure> {
    let square = Shape::Box {
        min: Vec3::zeros(),
        max: Vec3::new(1.0, 1.0, 0.0),
    };
    let spacing = Spacing::Counts([intervals + 1, intervals + 1, 1]);
    let body = build_body(square, Lattice::Cubic { spacing }, Dimension::PlaneStrain)?;
    let material = MaterialSpec::Hencky(Hencky::new(1100.0, 17e6, 0.3));
    let frequency = PI * material.wave_speeds().shear / SQRT_2;
    let roller = |face: &str, axis: usize| -> Result<Condition, Failure> {
        let mut velocity = [None, None, None];
        velocity[axis] = Some(Signal::Constant(0.0));
        Ok(Condition {
            name: face.to_owned(),
            body: 0,
            particles: face_nodes(&body, face)?,
            kind: ConditionKind::Velocity(velocity),
        })
    };
    let conditions = vec![roller("left", 0)?, roller("bottom", 1)?];
    let speed = AMPLITUDE * frequency;
    let model = Model {
        dimension: Dimension::PlaneStrain,
        bodies: vec![ModelBody {
            name: "plate".into(),
            initial_temperature: vec![jstsph_material::ROOM_TEMPERATURE; body.positions.len()],
            initial_velocity: body.positions.iter().map(|x| shape(x) * speed).collect(),
            body: body.into(),
            material,
            body_force: None,
        }],
        conditions,
        obstacles: vec![],
        heat: None,
        scheme: Scheme {
            quadrature: Quadrature::Bonds,
            kernel: Kernel::QuinticSpline,
            smoothing_ratio: 0.8,
            smoothing_reference: SmoothingReference::Spacing,
            weights: Weights::Interpolation,
            boundary_correction: false,
            formulation: Formulation::MomentumGradientCofactorJacobian,
            integrator,
            cfl,
            step_limit: StepLimit::Acoustic,
            stabilisation: Stabilisation::default(),
            projection: false,
            inertia_scale: 1.0,
            smallest_time_step: 1e-6,
            substeps: 1,
        },
    };
    Ok((model, frequency))
}

/// Processor time of this thread, s; that of the clock where the system does not tell.
fn processor_time(started: Instant) -> f64 {
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok())
        .map_or_else(|| started.elapsed().as_secs_f64(), |ns| ns * 1e-9)
}

/// Momenta at the end, steps and processor time.
fn run(
    intervals: usize,
    integrator: Integrator,
    cfl: f64,
) -> Result<(Vec<Vec3>, u64, f64), Failure> {
    let (model, frequency) = problem(intervals, integrator, cfl)?;
    let end = PERIODS * 2.0 * PI / frequency;
    let mut simulation = Simulation::new(model)?;
    let started = Instant::now();
    let before = processor_time(started);
    while simulation.time() < end {
        simulation.advance_step(end)?;
    }
    let seconds = processor_time(started) - before;
    let momenta = simulation.state().momentum.clone();
    Ok((momenta, simulation.step_count(), seconds))
}

fn relative(found: &[Vec3], expected: &[Vec3]) -> f64 {
    let error: f64 = found
        .iter()
        .zip(expected)
        .map(|(a, b)| (a - b).norm_squared())
        .sum();
    let size: f64 = expected.iter().map(Vec3::norm_squared).sum();
    (error / size).sqrt()
}

fn main() -> Result<(), Failure> {
    let intervals: usize = std::env::args()
        .nth(1)
        .map_or(Ok(20), |text| text.parse())?;
    let (model, frequency) = problem(intervals, Integrator::RungeKutta4, 1.0)?;
    let body = &model.bodies[0];
    let density = body.material.density();
    let factor = density * AMPLITUDE * frequency * (2.0 * PI * PERIODS).cos();
    let exact: Vec<Vec3> = body
        .body
        .positions
        .iter()
        .map(|x| shape(x) * factor)
        .collect();
    let (reference, ..) = run(intervals, Integrator::RungeKutta4, 0.05)?;
    println!("integrator,cfl,steps,evaluations,processor_seconds,time_error,total_error");
    for (name, integrator, evaluations, cfls) in INTEGRATORS {
        for &cfl in cfls {
            let (momenta, steps, seconds) = run(intervals, integrator, cfl)?;
            println!(
                "{name},{cfl},{steps},{},{seconds:.4},{:.3e},{:.3e}",
                steps * evaluations,
                relative(&momenta, &reference),
                relative(&momenta, &exact)
            );
        }
    }
    Ok(())
}
