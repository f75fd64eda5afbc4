//! What a simulation is made of, already resolved: no files, no units, no names to look up.
//!
//! `jstsph-case` builds a [`Model`] from a case file; a program can build one in code.

use std::sync::Arc;

use jstsph_contact::Obstacle;
use jstsph_geometry::{Body, Dimension};
use jstsph_material::MaterialSpec;
use jstsph_sph::Kernel;
use jstsph_tensor::Vec3;

/// A complete problem: bodies, what acts on them, and how it is solved.
#[derive(Clone, Debug)]
pub struct Model {
    /// Plane strain or solid.
    pub dimension: Dimension,
    /// Deformable bodies; particles of different bodies do not interact.
    pub bodies: Vec<ModelBody>,
    /// Prescribed velocities and tractions.
    pub conditions: Vec<Condition>,
    /// Rigid obstacles, which act on every body.
    pub obstacles: Vec<ModelObstacle>,
    /// What becomes of heat; without it every particle keeps its temperature.
    pub heat: Option<Heat>,
    /// Discretisation, stabilisation and time integration.
    pub scheme: Scheme,
}

/// Which heat is generated, and whether it flows. Every body then needs a material with thermal
/// properties.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heat {
    /// Heat flows inside the bodies; without it every particle is on its own (adiabatic).
    pub conduction: bool,
    /// What the artificial viscosity takes from the motion becomes heat.
    pub viscous_heating: bool,
    /// What friction takes from the motion becomes heat of the body, all of it.
    pub friction_heating: bool,
}

/// One deformable body.
#[derive(Clone, Debug)]
pub struct ModelBody {
    /// Name used in messages and output.
    pub name: String,
    /// Particles, volumes, bonds; shared, because it is most of a model.
    pub body: Arc<Body>,
    /// Constitutive model with its parameters.
    pub material: MaterialSpec,
    /// Velocity of every particle at time zero, m/s.
    pub initial_velocity: Vec<Vec3>,
    /// Temperature of every particle at time zero, K.
    pub initial_temperature: Vec<f64>,
    /// Body force per unit mass, m/s², one signal per axis.
    pub body_force: Option<[Signal; 3]>,
}

/// A condition on a set of particles of one body.
#[derive(Clone, Debug)]
pub struct Condition {
    /// Name used in messages and output.
    pub name: String,
    /// Index into [`Model::bodies`].
    pub body: usize,
    /// Particles of that body, ascending.
    pub particles: Vec<u32>,
    /// What is prescribed.
    pub kind: ConditionKind,
}

/// What a [`Condition`] prescribes.
#[derive(Clone, Debug)]
pub enum ConditionKind {
    /// Velocity per axis, m/s; `None` leaves the axis free (a roller is `Some(0)` along one axis).
    Velocity([Option<Signal>; 3]),
    /// Dead traction per reference area, Pa, with the tributary area of every particle in m²
    /// (per metre of thickness in plane strain).
    Traction {
        /// Tributary areas, one per particle of the condition.
        areas: Vec<f64>,
        /// Traction per axis.
        traction: [Signal; 3],
    },
    /// Temperature, K.
    Temperature(Signal),
    /// Heat that enters per reference area and time, W/m², with the tributary areas in m².
    HeatFlux {
        /// Tributary areas, one per particle of the condition.
        areas: Vec<f64>,
        /// Heat flux into the body.
        flux: Signal,
    },
    /// Heat exchange with surroundings, h (T_ambient − T) per reference area.
    Convection {
        /// Tributary areas, one per particle of the condition.
        areas: Vec<f64>,
        /// h, W/(m² K).
        coefficient: f64,
        /// Temperature of the surroundings, K.
        ambient: Signal,
    },
}

impl ConditionKind {
    /// Whether it acts on the temperature.
    #[must_use]
    pub fn is_thermal(&self) -> bool {
        matches!(
            self,
            Self::Temperature(_) | Self::HeatFlux { .. } | Self::Convection { .. }
        )
    }

    /// Tributary areas of the condition's particles, for the kinds that act on a face.
    #[must_use]
    pub fn areas(&self) -> Option<&[f64]> {
        match self {
            Self::Traction { areas, .. }
            | Self::HeatFlux { areas, .. }
            | Self::Convection { areas, .. } => Some(areas),
            Self::Velocity(_) | Self::Temperature(_) => None,
        }
    }
}

/// A rigid obstacle and its motion.
#[derive(Clone, Debug)]
pub struct ModelObstacle {
    /// Surface and contact law.
    pub obstacle: Obstacle,
    /// Velocity of its translation, m/s, a function of time only; `None` when it rests.
    pub velocity: Option<[Signal; 3]>,
    /// Heat exchange with the particles that touch it; `None` when it insulates.
    pub heat: Option<ObstacleHeat>,
}

/// Heat exchange between an obstacle and the particles in contact with it, h (T_obstacle − T) per
/// current area of contact.
#[derive(Clone, Debug)]
pub struct ObstacleHeat {
    /// Contact conductance h, W/(m² K).
    pub conductance: f64,
    /// Temperature of the obstacle, K, a function of time only.
    pub temperature: Signal,
}

/// A function of time and reference position.
pub type SignalFunction = dyn Fn(f64, &Vec3) -> f64 + Send + Sync;

/// A number that may change with time and, for functions, with the reference position.
#[derive(Clone)]
pub enum Signal {
    /// The same at all times.
    Constant(f64),
    /// Piecewise linear in time, constant before the first and after the last entry.
    /// Times ascend strictly; both lists have the same, non-zero length.
    Table {
        /// Times, s.
        times: Vec<f64>,
        /// Values at these times.
        values: Vec<f64>,
    },
    /// Any pure function of time (s) and reference position (m).
    Function(Arc<SignalFunction>),
}

impl std::fmt::Debug for Signal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Constant(value) => f.debug_tuple("Constant").field(value).finish(),
            Self::Table { times, values } => f
                .debug_struct("Table")
                .field("times", times)
                .field("values", values)
                .finish(),
            Self::Function(_) => f.write_str("Function"),
        }
    }
}

impl Signal {
    /// Value at `time` (s) for a particle whose reference position is given (m).
    #[must_use]
    pub fn at(&self, time: f64, reference_position: &Vec3) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Table { times, values } => {
                let next = times.partition_point(|t| *t <= time);
                if next == 0 {
                    values[0]
                } else if next == times.len() {
                    values[next - 1]
                } else {
                    let (t0, t1) = (times[next - 1], times[next]);
                    let (v0, v1) = (values[next - 1], values[next]);
                    v0 + (v1 - v0) * (time - t0) / (t1 - t0)
                }
            }
            Self::Function(function) => function(time, reference_position),
        }
    }
}

/// Where the strains and stresses are evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quadrature {
    /// At the particles: the paper's scheme. Has zero-energy modes and needs a stabilisation.
    Particles,
    /// At the midpoints of the lattice bonds, with J at the particles: no zero-energy modes.
    Bonds,
}

/// What stands for V_b in the gradient sum (3.6).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weights {
    /// A full cell for every particle: second order.
    Interpolation,
    /// The tributary volume, as the paper writes it: first order.
    Volume,
}

/// To which length the smoothing length is proportional.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SmoothingReference {
    /// (total volume / particles)^(1/d), the paper's algorithm box.
    Volume,
    /// The lattice spacing.
    Spacing,
}

/// Which strain measures are unknowns of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Formulation {
    /// {p, F, H, J}: the paper's full system (3.14).
    MomentumGradientCofactorJacobian,
    /// {p, F, J}: H = cof F evaluated.
    MomentumGradientJacobian,
    /// {p, F}: H = cof F and J = det F evaluated.
    MomentumGradient,
    /// {p} alone: F = grad x by the corrected operators, H = cof F, J = det F (Ba & Gakwaya).
    Displacement,
    /// Classical SPH with neighbours and kernels in the current configuration, for comparison.
    EulerianKernel,
}

impl Formulation {
    /// Whether J is an unknown of its own.
    #[must_use]
    pub fn integrates_jacobian(self) -> bool {
        matches!(
            self,
            Self::MomentumGradientCofactorJacobian | Self::MomentumGradientJacobian
        )
    }
}

/// Time integration scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// Two-stage TVD Runge-Kutta (3.16): the paper's. Second order.
    TvdRungeKutta,
    /// Three-stage strong-stability-preserving Runge-Kutta of Shu & Osher 1988. Third order.
    SspRungeKutta,
    /// Five-stage low-storage Runge-Kutta of Carpenter & Kennedy 1994. Fourth order.
    RungeKutta4,
    /// Staggered leapfrog: half the work per step, twice to three times the step.
    Leapfrog,
}

/// What the stable time step is a fraction of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepLimit {
    /// Δx λ_min / c over all points (3.17): the paper's, pessimistic where few points are compressed.
    Stretch,
    /// 2/ω_max of the elastic operator of the deformed bodies: twice as long in extreme deformation.
    Acoustic,
}

/// Laplacian of the JST dissipation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Laplacian {
    /// Symmetric pair form of Brookshaw: can only remove energy.
    Symmetric,
    /// With the clamped linear correction: vanishes on linear fields up to the boundary.
    Corrected,
}

/// Biharmonic coefficient κ⁽⁴⁾ of (3.13b).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Biharmonic {
    /// The same everywhere.
    Constant(f64),
    /// Falls linearly with the equivalent plastic strain and stays at its final value (4.2), `[eq:falling-coefficient]`.
    FallingWithPlasticStrain {
        /// Value at zero plastic strain.
        initial: f64,
        /// Value from `strain` on.
        last: f64,
        /// Equivalent plastic strain at which the final value is reached.
        strain: f64,
    },
}

/// JST dissipation (3.12)-(3.13).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jst {
    /// κ⁽²⁾.
    pub harmonic: f64,
    /// κ⁽⁴⁾.
    pub biharmonic: Biharmonic,
    /// Whether J is dissipated too, as in the paper.
    pub on_jacobian: bool,
    /// Form of the Laplacian.
    pub laplacian: Laplacian,
}

/// Artificial viscosity of Monaghan 1992 between approaching particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscosity {
    /// α of the linear term.
    pub linear: f64,
    /// β of the quadratic term.
    pub quadratic: f64,
}

/// Everything that is added to the bare scheme to suppress unseen or underresolved motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stabilisation {
    /// JST dissipation, when wanted.
    pub jst: Option<Jst>,
    /// Coefficient β of the upwind pair dissipation; zero switches it off.
    pub upwind: f64,
    /// Coefficient ζ of the hourglass stiffness; zero switches it off.
    pub hourglass: f64,
    /// Artificial viscosity, when wanted.
    pub viscosity: Option<Viscosity>,
}

/// Discretisation, stabilisation and time integration.
#[derive(Clone, Copy, Debug)]
pub struct Scheme {
    /// Where strains and stresses live.
    pub quadrature: Quadrature,
    /// Kernel function.
    pub kernel: Kernel,
    /// Smoothing length over the reference length.
    pub smoothing_ratio: f64,
    /// The reference length.
    pub smoothing_reference: SmoothingReference,
    /// Interpolation weights.
    pub weights: Weights,
    /// Whether the gradient is changed near the boundary so that it sums by parts, on bodies where it
    /// does not do so by itself: round ones, irregular ones, wide supports. docs/theory.md.
    pub boundary_correction: bool,
    /// Which unknowns are integrated.
    pub formulation: Formulation,
    /// Time integration.
    pub integrator: Integrator,
    /// Fraction of the limit taken as time step (3.17).
    pub cfl: f64,
    /// The limit.
    pub step_limit: StepLimit,
    /// Stabilisation.
    pub stabilisation: Stabilisation,
    /// Whether resultants and torques of internal forces and dissipation are projected out (3.15).
    pub projection: bool,
    /// Factor on the density in the inertia, and there alone: mass scaling. A process that is run
    /// s times faster in time, with its rates and conductivities scaled back, obeys the same
    /// equations with the factor s² (docs/theory.md), so that times and rates stay those of the
    /// process.
    pub inertia_scale: f64,
    /// The run stops when the time step falls below this fraction of the first one.
    pub smallest_time_step: f64,
    /// Most steps, a power of two, that the most compressed parts of the bodies may make within one
    /// step of the rest; 1 makes all steps equal. Needs the leapfrog, bonds and the acoustic limit.
    /// `[eq:local-step]`, docs/theory.md.
    pub substeps: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_signal_is_piecewise_linear_and_constant_outside() {
        let signal = Signal::Table {
            times: vec![1.0, 2.0, 4.0],
            values: vec![10.0, 20.0, 0.0],
        };
        let origin = Vec3::zeros();
        for (time, expected) in [
            (0.0, 10.0),
            (1.0, 10.0),
            (1.5, 15.0),
            (3.0, 10.0),
            (4.0, 0.0),
            (9.0, 0.0),
        ] {
            assert_eq!(signal.at(time, &origin), expected, "at {time}");
        }
    }

    #[test]
    fn function_signal_sees_time_and_reference_position() {
        let signal = Signal::Function(Arc::new(|t, x| 2.0 * t + x.y));
        assert_eq!(signal.at(3.0, &Vec3::new(0.0, 0.5, 0.0)), 6.5);
    }
}
