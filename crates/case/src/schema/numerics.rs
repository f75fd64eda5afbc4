//! Keys of `[time]`, `[scheme]`, `[stabilisation]`, `[heat]` and `[output]`.

use jstsph_solver::{
    Formulation, Integrator, Laplacian, Quadrature, SmoothingReference, StepLimit, Weights,
};
use jstsph_sph::Kernel;

use super::Kind::{Choice, Count, Flag, Number, Other, Table, TableOr};
use super::Presence::{Default, Derived, Optional, Required};
use super::{COEFFICIENT, Form, Key, Limit, key, names};
use crate::case::{FrameCells, FrameFormat, Precision};
use crate::units::Measure;

/// `[time]`.
pub const TIME: &[Key] = &[
    key(
        "end",
        Number(Measure::TIME, Limit::Positive),
        Required,
        "simulated time",
    ),
    key(
        "cfl",
        Number(Measure::NUMBER, Limit::Positive),
        Derived("0.5 for leapfrog, 0.3 for tvd-rk2, 0.4 for ssp-rk3, 0.8 for rk4"),
        "fraction of the limit taken as time step (3.17)",
    ),
    key(
        "limit",
        Choice(|| names(STEP_LIMITS)),
        Default("\"stretch\""),
        "stretch: spacing over wave speed times the smallest stretch (3.17); acoustic: 2/frequency of the deformed bodies, twice as long where few points are compressed",
    ),
    key(
        "substeps",
        Count(1),
        Default("1"),
        "most steps, a power of two, that the most compressed parts of the bodies make within one step of the rest; 1: all steps are equal",
    ),
    key(
        "integrator",
        Choice(|| names(INTEGRATORS)),
        Default("\"leapfrog\""),
        "time integration",
    ),
    key(
        "smallest_step",
        Number(Measure::NUMBER, Limit::Within(0.0, 1.0)),
        Default("1e-6"),
        "the run stops when the time step falls below this fraction of the first",
    ),
    key(
        "rate_scale",
        Number(Measure::NUMBER, Limit::Positive),
        Optional,
        "a slow process computed this many times faster; times, velocities, strain rates and heat stay those of the process, inertia grows by the square",
    ),
    key(
        "mass_scale",
        Number(Measure::NUMBER, Limit::Positive),
        Optional,
        "factor on the density in the inertia alone: rate_scale squared",
    ),
];

/// Integrators by name.
pub(crate) const INTEGRATORS: &[(&str, Integrator)] = &[
    ("leapfrog", Integrator::Leapfrog),
    ("tvd-rk2", Integrator::TvdRungeKutta),
    ("ssp-rk3", Integrator::SspRungeKutta),
    ("rk4", Integrator::RungeKutta4),
];

/// Limits of the time step by name.
pub(crate) const STEP_LIMITS: &[(&str, StepLimit)] = &[
    ("stretch", StepLimit::Stretch),
    ("acoustic", StepLimit::Acoustic),
];

/// `[scheme]`.
pub const SCHEME: &[Key] = &[
    key(
        "quadrature",
        Choice(|| names(QUADRATURES)),
        Default("\"bonds\""),
        "where strains and stresses live: at lattice bonds (no zero-energy modes) or at the particles (the paper's scheme)",
    ),
    key(
        "formulation",
        Choice(|| names(FORMULATIONS)),
        Default("\"pFHJ\""),
        "unknowns of the mixed system (3.14); displacement: F from the positions (Ba & Gakwaya); eulerian-kernel: classical SPH, for comparison",
    ),
    key(
        "kernel",
        Choice(|| Kernel::ALL.iter().map(|kernel| kernel.name()).collect()),
        Default("\"quintic-spline\""),
        "kernel function",
    ),
    key(
        "smoothing_ratio",
        Number(Measure::NUMBER, Limit::Positive),
        Derived("0.8 for bonds, 1.2 for particles"),
        "smoothing length over the reference length",
    ),
    key(
        "smoothing_reference",
        Choice(|| names(SMOOTHING_REFERENCES)),
        Derived("spacing for bonds, volume for particles"),
        "reference length: lattice spacing, or (volume / particles)^(1/d)",
    ),
    key(
        "weights",
        Choice(|| names(WEIGHTS)),
        Default("\"interpolation\""),
        "weights of the gradient sum: full cells (second order) or tributary volumes (the paper's)",
    ),
    key(
        "boundary_correction",
        Flag,
        Default("false"),
        "whether the gradient is changed near the boundary, where needed, so that it sums by parts",
    ),
    key(
        "projection",
        Flag,
        Derived("false for bonds, true for particles"),
        "whether resultants and torques of internal forces are projected out (3.15)",
    ),
];

/// Quadratures by name.
pub(crate) const QUADRATURES: &[(&str, Quadrature)] = &[
    ("bonds", Quadrature::Bonds),
    ("particles", Quadrature::Particles),
];

/// Formulations by name.
pub(crate) const FORMULATIONS: &[(&str, Formulation)] = &[
    ("pFHJ", Formulation::MomentumGradientCofactorJacobian),
    ("pFJ", Formulation::MomentumGradientJacobian),
    ("pF", Formulation::MomentumGradient),
    ("displacement", Formulation::Displacement),
    ("eulerian-kernel", Formulation::EulerianKernel),
];

/// Smoothing references by name.
pub(crate) const SMOOTHING_REFERENCES: &[(&str, SmoothingReference)] = &[
    ("spacing", SmoothingReference::Spacing),
    ("volume", SmoothingReference::Volume),
];

/// Interpolation weights by name.
pub(crate) const WEIGHTS: &[(&str, Weights)] = &[
    ("interpolation", Weights::Interpolation),
    ("volume", Weights::Volume),
];

/// `[stabilisation]`.
pub const STABILISATION: &[Key] = &[
    key(
        "upwind",
        COEFFICIENT,
        Derived("0 for bonds, 0.3 for particles unless jst is given"),
        "upwind pair dissipation of the velocity that the gradient does not see",
    ),
    key(
        "hourglass",
        COEFFICIENT,
        Default("0.0"),
        "hourglass stiffness over the shear modulus",
    ),
    key(
        "jst",
        Table(JST),
        Optional,
        "Jameson-Schmidt-Turkel dissipation (3.13)",
    ),
    key(
        "viscosity",
        Table(VISCOSITY),
        Optional,
        "artificial viscosity of approaching particles (Monaghan 1992)",
    ),
];

/// `stabilisation.viscosity`.
pub(crate) const VISCOSITY: &[Key] = &[
    key(
        "linear",
        COEFFICIENT,
        Default("0.1"),
        "coefficient of the linear term",
    ),
    key(
        "quadratic",
        COEFFICIENT,
        Default("0.2"),
        "coefficient of the quadratic term",
    ),
];

/// `[heat]`.
pub const HEAT: &[Key] = &[
    key(
        "conduction",
        Flag,
        Default("true"),
        "whether heat flows inside the bodies; false is adiabatic",
    ),
    key(
        "viscous_heating",
        Flag,
        Default("true"),
        "whether what the artificial viscosity takes from the motion becomes heat",
    ),
    key(
        "friction_heating",
        Flag,
        Default("true"),
        "whether what friction takes from the motion becomes heat of the body",
    ),
];

/// `stabilisation.jst`.
pub(crate) const JST: &[Key] = &[
    key(
        "harmonic",
        COEFFICIENT,
        Default("0.0"),
        "coefficient of the Laplacian",
    ),
    key(
        "biharmonic",
        TableOr(BIHARMONIC, "a number, zero or positive", &COEFFICIENT),
        Default("0.0009765625"),
        "coefficient of the double Laplacian, 1/1024 unless given; as a table it falls with the plastic strain (4.2)",
    ),
    key(
        "on_jacobian",
        Flag,
        Default("false"),
        "whether J is dissipated too, as in the paper",
    ),
    key(
        "laplacian",
        Choice(|| names(LAPLACIANS)),
        Default("\"symmetric\""),
        "form of the Laplacian",
    ),
];

/// A biharmonic coefficient that falls with the plastic strain.
pub(crate) const BIHARMONIC: &[Key] = &[
    key(
        "initial",
        COEFFICIENT,
        Default("0.015625"),
        "value without plastic strain",
    ),
    key(
        "final",
        COEFFICIENT,
        Default("0.000244140625"),
        "value from `plastic_strain` on",
    ),
    key(
        "plastic_strain",
        Number(Measure::NUMBER, Limit::Positive),
        Default("0.5"),
        "equivalent plastic strain at which the final value is reached",
    ),
];

/// Forms of the Laplacian by name.
pub(crate) const LAPLACIANS: &[(&str, Laplacian)] = &[
    ("symmetric", Laplacian::Symmetric),
    ("corrected", Laplacian::Corrected),
];

/// `[output]`.
pub const OUTPUT: &[Key] = &[
    key(
        "history_interval",
        Number(Measure::TIME, Limit::Positive),
        Derived("end / 500"),
        "simulated time between rows of history.csv",
    ),
    key(
        "history_steps",
        Count(1),
        Optional,
        "steps between rows of history.csv, instead of history_interval",
    ),
    key(
        "frame_interval",
        Number(Measure::TIME, Limit::Positive),
        Derived("end / 50"),
        "simulated time between frames for ParaView",
    ),
    key(
        "frame_steps",
        Count(1),
        Optional,
        "steps between frames, instead of frame_interval",
    ),
    key(
        "restart_interval",
        Number(Measure::TIME, Limit::Positive),
        Derived("end / 10"),
        "simulated time between restart files",
    ),
    key(
        "restart_steps",
        Count(1),
        Optional,
        "steps between restart files, instead of restart_interval",
    ),
    key(
        "fields",
        Other("a list of names of fields", Form::Fields),
        Optional,
        "fields in frames; all of them unless some are chosen",
    ),
    key(
        "precision",
        Choice(|| names(PRECISIONS)),
        Default("\"double\""),
        "numbers in frames",
    ),
    key(
        "compression",
        Flag,
        Default("true"),
        "whether frames are compressed",
    ),
    key(
        "format",
        Choice(|| names(FORMATS)),
        Default("\"vtu\""),
        "files of a frame: VTU only, which pictures and reports read, or VTKHDF beside it (programs built with the feature vtkhdf)",
    ),
    key(
        "cells",
        Choice(|| names(CELLS)),
        Default("\"lattice\""),
        "what ParaView shows: the cells of the lattice (where all bodies have one) or the particles as points",
    ),
];

/// Fields of frames, in the order in which they are written.
pub const FRAME_FIELDS: &[&str] = &[
    "displacement",
    "velocity",
    "deformation_gradient",
    "jacobian",
    "determinant",
    "cauchy_stress",
    "von_mises_stress",
    "pressure",
    "equivalent_plastic_strain",
    "wave_speed",
    "temperature",
];

/// Precisions by name.
pub(crate) const PRECISIONS: &[(&str, Precision)] =
    &[("double", Precision::Double), ("single", Precision::Single)];

/// Files of a frame by name.
pub(crate) const FORMATS: &[(&str, FrameFormat)] = &[
    ("vtu", FrameFormat::Vtu),
    ("vtkhdf", FrameFormat::VtuAndVtkhdf),
];

/// What frames show, by name.
pub(crate) const CELLS: &[(&str, FrameCells)] = &[
    ("lattice", FrameCells::Lattice),
    ("particles", FrameCells::Particles),
];
