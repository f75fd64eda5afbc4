//! Models built in code: boxes, materials, schemes, conditions.

use jstsph_geometry::{Body, Dimension, Lattice, Selection, Shape, Spacing, build_body, select};
use jstsph_material::hardening::{Hardening, Linear};
use jstsph_material::models::{Hencky, HenckyVonMises, NeoHookean};
use jstsph_material::{MaterialSpec, Property, Thermal};
use jstsph_solver::{
    Condition, ConditionKind, Formulation, Integrator, Model, ModelBody, Quadrature, Scheme,
    Signal, Simulation, SmoothingReference, Stabilisation, StepLimit, Viscosity, Weights,
};
use jstsph_sph::Kernel;
use jstsph_tensor::Vec3;

/// Strain measures at the particles, h = `smoothing_ratio` spacings, leapfrog, momentum
/// projection, upwind dissipation 0.3: the recommended form of the paper's scheme.
#[must_use]
pub fn particles(smoothing_ratio: f64) -> Scheme {
    Scheme {
        quadrature: Quadrature::Particles,
        kernel: Kernel::QuinticSpline,
        smoothing_ratio,
        smoothing_reference: SmoothingReference::Spacing,
        weights: Weights::Interpolation,
        boundary_correction: false,
        formulation: Formulation::MomentumGradientCofactorJacobian,
        integrator: Integrator::Leapfrog,
        cfl: 0.5,
        step_limit: StepLimit::Stretch,
        stabilisation: Stabilisation {
            upwind: 0.3,
            ..Default::default()
        },
        projection: true,
        inertia_scale: 1.0,
        smallest_time_step: 1e-6,
        substeps: 1,
    }
}

/// Strain measures at the bonds, leapfrog, no stabilisation and no projection.
#[must_use]
pub fn bonds(smoothing_ratio: f64) -> Scheme {
    Scheme {
        quadrature: Quadrature::Bonds,
        stabilisation: Stabilisation::default(),
        projection: false,
        ..particles(smoothing_ratio)
    }
}

/// F from the positions at the particles, leapfrog, artificial viscosity: the scheme of Ba & Gakwaya.
#[must_use]
pub fn displacement(smoothing_ratio: f64) -> Scheme {
    Scheme {
        formulation: Formulation::Displacement,
        stabilisation: Stabilisation {
            viscosity: Some(Viscosity {
                linear: 0.1,
                quadratic: 0.2,
            }),
            ..Default::default()
        },
        ..particles(smoothing_ratio)
    }
}

/// The scheme with the gradient made to sum by parts.
#[must_use]
pub fn corrected(scheme: Scheme) -> Scheme {
    Scheme {
        boundary_correction: true,
        ..scheme
    }
}

/// Axis-parallel box from the origin with nodes on its faces; `intervals` cells along each axis.
/// One of two axes in plane strain.
#[must_use]
pub fn block(size: [f64; 3], intervals: [usize; 3], dimension: Dimension) -> Body {
    block_at([0.0; 3], size, intervals, dimension)
}

/// [`block`] with its lowest corner at `origin`.
///
/// # Panics
/// If the box cannot be built.
#[must_use]
pub fn block_at(
    origin: [f64; 3],
    size: [f64; 3],
    intervals: [usize; 3],
    dimension: Dimension,
) -> Body {
    let min = Vec3::from(origin);
    let shape = Shape::Box {
        min,
        max: min + Vec3::from(size),
    };
    let spacing = Spacing::Counts(intervals.map(|n| n + 1));
    build_body(shape, Lattice::Cubic { spacing }, dimension).expect("the box is valid")
}

/// The body with its inner nodes moved by up to `amount` spacings along each axis, the same every
/// time; bonds follow their ends, volumes stay those of the lattice.
#[must_use]
pub fn jittered(mut body: Body, amount: f64) -> Body {
    let axes = body.dimension.count();
    // SplitMix64 (Steele, Lea & Flood 2014), in [-1, 1).
    let mut seed = 7u64;
    let mut number = || {
        seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = seed;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let positions = std::sync::Arc::make_mut(&mut body.positions);
    for (position, boundary) in positions.iter_mut().zip(&body.boundary) {
        let mut shift = Vec3::zeros();
        for i in 0..axes {
            shift[i] = amount * body.spacing * number();
        }
        if !boundary {
            *position += shift;
        }
    }
    body
}

/// Neo-Hookean rubber of the swinging plate and cube: E = 17 MPa, ρ = 1100 kg/m³.
#[must_use]
pub fn rubber(poisson_ratio: f64) -> MaterialSpec {
    MaterialSpec::NeoHookean(NeoHookean {
        density: 1100.0,
        young_modulus: 17e6,
        poisson_ratio,
    })
}

/// Copper of Greto & Kulasegaram 2019, Sect. 4.1: yields at a strain of 0.34 %.
#[must_use]
pub fn copper() -> MaterialSpec {
    MaterialSpec::HenckyVonMises(HenckyVonMises::new(
        8930.0,
        117e9,
        0.35,
        Hardening::Linear(Linear {
            initial_yield_stress: 0.4e9,
            modulus: 0.1e9,
        }),
    ))
}

/// An elastic solid that conducts heat: the moduli of a soft rubber, so that sound takes as long as
/// heat, ρ c = 1.1 MJ/(m³ K), and a diffusivity of 10 m²/s; `expansion` in 1/K.
#[must_use]
pub fn conductor(expansion: f64) -> Hencky {
    Hencky {
        thermal: Some(Thermal {
            heat_capacity: Property::Constant(1000.0),
            conductivity: Property::Constant(1.1e7),
            taylor_quinney: 0.9,
            expansion,
            reference_temperature: jstsph_material::ROOM_TEMPERATURE,
        }),
        ..Hencky::new(1100.0, 17e6, 0.3)
    }
}

/// One body that starts with `velocity(X)`, free of conditions.
#[must_use]
pub fn free_body(
    body: Body,
    material: MaterialSpec,
    velocity: impl Fn(&Vec3) -> Vec3,
    scheme: Scheme,
) -> Model {
    Model {
        dimension: body.dimension,
        bodies: vec![ModelBody {
            name: "body".into(),
            initial_temperature: vec![jstsph_material::ROOM_TEMPERATURE; body.positions.len()],
            initial_velocity: body.positions.iter().map(velocity).collect(),
            body: body.into(),
            material,
            body_force: None,
        }],
        conditions: vec![],
        obstacles: vec![],
        heat: None,
        scheme,
    }
}

/// Fixes components of the velocity at zero on a face of the first body.
///
/// # Panics
/// If there is no such face.
pub fn fix(model: &mut Model, face: &str, axes: [bool; 3]) {
    let particles = select(&model.bodies[0].body, &Selection::Face(face.into())).expect("a face");
    model.conditions.push(Condition {
        name: face.into(),
        body: 0,
        particles,
        kind: ConditionKind::Velocity(axes.map(|fixed| fixed.then_some(Signal::Constant(0.0)))),
    });
}

/// Runs a model to `end`.
///
/// # Panics
/// If the model is inconsistent or the run breaks.
#[must_use]
pub fn run(model: Model, end: f64) -> Simulation {
    let mut simulation = start(model);
    while simulation.time() < end {
        advance(&mut simulation, end);
    }
    simulation
}

/// A simulation at time zero.
///
/// # Panics
/// If the model is inconsistent.
#[must_use]
pub fn start(model: Model) -> Simulation {
    Simulation::new(model).unwrap_or_else(|error| panic!("{error}"))
}

/// Makes one step towards `end`.
///
/// # Panics
/// If the run breaks.
pub fn advance(simulation: &mut Simulation, end: f64) {
    simulation
        .advance_step(end)
        .unwrap_or_else(|error| panic!("{error}"));
}

/// Makes `count` steps without an end in sight: with the leapfrog the momenta stay half a step
/// ahead of the positions.
///
/// # Panics
/// If the run breaks.
pub fn advance_steps(simulation: &mut Simulation, count: usize) {
    for _ in 0..count {
        advance(simulation, f64::INFINITY);
    }
}
