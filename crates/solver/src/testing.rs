//! Small models and random numbers that the tests of several modules share.

use jstsph_contact::{Friction, Law, Obstacle, Surface};
use jstsph_geometry::{Dimension, Lattice, Shape, Spacing, build_body};
use jstsph_material::models::Hencky;
use jstsph_material::{MaterialSpec, library};
use jstsph_sph::Kernel;
use jstsph_tensor::{Mat3, Vec3};

use crate::model::{
    Formulation, Integrator, Model, ModelBody, ModelObstacle, Quadrature, Scheme,
    SmoothingReference, Stabilisation, StepLimit, Weights,
};

/// A reproducible source of numbers (SplitMix64, Steele, Lea & Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Uniform in [−1, 1).
    pub(crate) fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub(crate) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }

    pub(crate) fn tensor(&mut self) -> Mat3 {
        Mat3::from_columns(&[self.vector(), self.vector(), self.vector()])
    }
}

pub(crate) const QUADRATURES: [Quadrature; 2] = [Quadrature::Particles, Quadrature::Bonds];
pub(crate) const INTEGRATORS: [Integrator; 4] = [
    Integrator::Leapfrog,
    Integrator::TvdRungeKutta,
    Integrator::SspRungeKutta,
    Integrator::RungeKutta4,
];

/// The full system without stabilisation.
pub(crate) fn scheme(quadrature: Quadrature, integrator: Integrator) -> Scheme {
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
        stabilisation: Stabilisation::default(),
        projection: !bonds,
        inertia_scale: 1.0,
        smallest_time_step: 1e-6,
        substeps: 1,
    }
}

/// Copper of the Taylor bar: elastic-plastic.
pub(crate) fn copper() -> MaterialSpec {
    library()[0].spec.clone()
}

/// An elastic material with round moduli: κ = 2 GPa, μ = 0.75 GPa, ρ = 1000 kg/m³.
pub(crate) fn elastic() -> MaterialSpec {
    MaterialSpec::Hencky(Hencky::new(1000.0, 2e9, 1.0 / 3.0))
}

/// A box of `nodes` (plane strain when the last is 1) with 1 mm spacing, standing on its lowest
/// corner at 1 mm along each axis.
pub(crate) fn body(name: &str, nodes: [usize; 3], material: MaterialSpec) -> ModelBody {
    let solid = nodes[2] > 1;
    let size = nodes.map(|n| (n - 1) as f64 * 1e-3);
    let min = Vec3::new(1e-3, 1e-3, if solid { 1e-3 } else { 0.0 });
    let shape = Shape::Box {
        min,
        max: min + Vec3::from(size),
    };
    let lattice = Lattice::Cubic {
        spacing: Spacing::Counts(nodes),
    };
    let body = build_body(shape, lattice, dimension(nodes)).unwrap();
    ModelBody {
        name: name.into(),
        initial_temperature: vec![jstsph_material::ROOM_TEMPERATURE; body.positions.len()],
        initial_velocity: vec![Vec3::zeros(); body.positions.len()],
        body: body.into(),
        material,
        body_force: None,
    }
}

fn dimension(nodes: [usize; 3]) -> Dimension {
    if nodes[2] > 1 {
        Dimension::Solid
    } else {
        Dimension::PlaneStrain
    }
}

/// A single box at rest, with nothing around it.
pub(crate) fn model(nodes: [usize; 3], material: MaterialSpec, scheme: Scheme) -> Model {
    Model {
        dimension: dimension(nodes),
        bodies: vec![body("block", nodes, material)],
        conditions: Vec::new(),
        obstacles: Vec::new(),
        heat: None,
        scheme,
    }
}

/// A copper plate that hits the wall y = 1 mm, which it touches, at an angle.
pub(crate) fn impact(nodes: [usize; 3], scheme: Scheme) -> Model {
    let mut model = model(nodes, copper(), scheme);
    model.bodies[0]
        .initial_velocity
        .fill(Vec3::new(30.0, -150.0, 0.0));
    model.obstacles.push(ModelObstacle {
        obstacle: Obstacle {
            name: "wall".into(),
            surface: Surface::Plane {
                point: Vec3::new(0.0, 1e-3, 0.0),
                normal: Vec3::y(),
            },
            law: Law::Inelastic { restitution: 0.0 },
            friction: Friction::default(),
        },
        velocity: None,
        heat: None,
    });
    model
}

/// Runs `work` with that many rayon threads.
pub(crate) fn in_pool<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap()
        .install(work)
}
