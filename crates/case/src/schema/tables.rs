//! The tables of keys.

use jstsph_contact::Side;
use jstsph_solver::{
    Field, Formulation, Integrator, Laplacian, Quadrature, SmoothingReference, Statistic, Weights,
};
use jstsph_sph::Kernel;

use super::{Key, Kind, Limit, Presence, names};
use crate::case::Precision;
use crate::units::Measure;

use Kind::{
    Choice, Count, Flag, Number, OneOf, Other, Signal, Signals, Table, TableOr, Tables, Text,
    Vector,
};
use Presence::{Default, Derived, Optional, Required};

const fn key(name: &'static str, kind: Kind, presence: Presence, meaning: &'static str) -> Key {
    Key {
        name,
        kind,
        presence,
        meaning,
    }
}

const LENGTH: Kind = Number(Measure::LENGTH, Limit::Positive);
const PLACE: Kind = Vector(Measure::LENGTH);
const COEFFICIENT: Kind = Number(Measure::NUMBER, Limit::NotNegative);
const AXIS: Kind = Choice(|| vec!["x", "y", "z"]);
const FIELD: Kind = Choice(|| names(FIELDS));
const WHERE: Kind = Other(
    "a selection: \"body\", \"body.face\" or a table { body, face | boundary | half_space | box | and | or | not }",
);

/// A whole case file.
pub const CASE: &[Key] = &[
    key(
        "title",
        Text,
        Default("\"\""),
        "one line that says what is simulated",
    ),
    key(
        "dimension",
        Choice(|| vec!["plane-strain", "3d"]),
        Required,
        "plane strain in x, y, or solid",
    ),
    key(
        "time",
        Table(TIME),
        Required,
        "duration and time integration",
    ),
    key("scheme", Table(SCHEME), Optional, "discretisation"),
    key(
        "stabilisation",
        Table(STABILISATION),
        Optional,
        "dissipation and hourglass control",
    ),
    key(
        "material",
        Other("tables [material.NAME.MODEL]; see `jstsph list materials`"),
        Optional,
        "materials of this case; shipped ones need no table",
    ),
    key("body", Tables(BODY), Required, "deformable bodies"),
    key(
        "boundary",
        Tables(BOUNDARY),
        Optional,
        "conditions on selections of particles",
    ),
    key(
        "obstacle",
        Tables(OBSTACLE),
        Optional,
        "rigid obstacles with frictionless contact",
    ),
    key(
        "probe",
        Tables(PROBE),
        Optional,
        "numbers written to history.csv and summary.json",
    ),
    key(
        "output",
        Table(OUTPUT),
        Optional,
        "what is written how often",
    ),
];

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
        Derived("0.5 for leapfrog, 0.3 for tvd-rk2"),
        "time step times wave speed over spacing (3.17)",
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
];

/// Integrators by name.
pub(crate) const INTEGRATORS: &[(&str, Integrator)] = &[
    ("leapfrog", Integrator::Leapfrog),
    ("tvd-rk2", Integrator::TvdRungeKutta),
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
        "unknowns of the mixed system (3.14)",
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
        TableOr(BIHARMONIC, "a number, zero or positive"),
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

/// `[[body]]`.
pub const BODY: &[Key] = &[
    key(
        "name",
        Text,
        Required,
        "name by which selections, probes and output know it",
    ),
    key("shape", OneOf(SHAPES), Required, "reference shape"),
    key(
        "lattice",
        Table(LATTICE),
        Required,
        "how it is filled with particles; nodes lie on its boundary",
    ),
    key(
        "material",
        Text,
        Required,
        "name of a [material.NAME] table of this case or of a shipped material",
    ),
    key(
        "velocity",
        TableOr(
            INITIAL_VELOCITY,
            "one velocity per axis: numbers or expressions of X, Y, Z",
        ),
        Optional,
        "initial velocity; zero unless given",
    ),
    key(
        "body_force",
        Signals(Measure::ACCELERATION),
        Optional,
        "force per mass",
    ),
];

/// Shapes.
pub const SHAPES: &[Key] = &[
    key(
        "box",
        Table(BOX),
        Optional,
        "box along the axes; faces left, right (x), bottom, top (y in plane strain, z in 3d), front, back (y in 3d)",
    ),
    key(
        "disc",
        Table(DISC),
        Optional,
        "disc, plane strain only; face rim",
    ),
    key(
        "cylinder",
        Table(CYLINDER),
        Optional,
        "cylinder along an axis, 3d only; faces base, top, side, edges rim_base, rim_top",
    ),
];

/// A box.
pub(crate) const BOX: &[Key] = &[
    key("min", PLACE, Required, "lowest corner"),
    key("max", PLACE, Required, "highest corner"),
];
/// A disc.
pub(crate) const DISC: &[Key] = &[
    key("centre", PLACE, Required, "centre"),
    key("radius", LENGTH, Required, "radius"),
];
/// A cylinder.
pub(crate) const CYLINDER: &[Key] = &[
    key("base", PLACE, Required, "centre of the face `base`"),
    key(
        "axis",
        AXIS,
        Default("\"z\""),
        "axis, pointing from `base` to `top`",
    ),
    key("radius", LENGTH, Required, "radius"),
    key("height", LENGTH, Required, "height"),
];

/// How a shape is filled.
pub const LATTICE: &[Key] = &[
    key(
        "spacing",
        LENGTH,
        Optional,
        "cubic lattice with about this spacing",
    ),
    key(
        "counts",
        Other("nodes along each axis, e.g. [21, 11]"),
        Optional,
        "cubic lattice with these nodes, for a box",
    ),
    key(
        "per_radius",
        Count(1),
        Optional,
        "cubic lattice with spacing radius / per_radius, for a disc or cylinder",
    ),
    key(
        "rings",
        Count(1),
        Optional,
        "concentric rings around the centre node, for a disc or cylinder (quadrature at the particles only)",
    ),
    key(
        "per_ring",
        Count(3),
        Default("8"),
        "nodes of the first ring; ring k has k times as many",
    ),
    key(
        "layers",
        Count(2),
        Optional,
        "nodes along the axis of a cylinder, with per_radius or rings",
    ),
];

/// Initial velocity as a table.
pub(crate) const INITIAL_VELOCITY: &[Key] =
    &[key("rotation", Table(ROTATION), Required, "rigid rotation")];

/// Rigid rotation.
pub(crate) const ROTATION: &[Key] = &[
    key(
        "rate",
        Number(Measure::RATE, Limit::Any),
        Required,
        "angular velocity",
    ),
    key(
        "axis",
        Other("direction as three numbers; z in plane strain"),
        Derived("z in plane strain, required in 3d"),
        "axis of rotation, any length",
    ),
    key("centre", PLACE, Required, "a point of the axis"),
];

/// Signals that are not constants.
pub(crate) const SIGNAL: &[Key] = &[
    key(
        "table",
        Other("[[time, value], ...] with ascending times"),
        Optional,
        "piecewise linear in time, constant before and after",
    ),
    key(
        "expression",
        Text,
        Optional,
        "expression in SI units of t, X, Y, Z (time and reference position)",
    ),
];

/// `[[boundary]]`.
pub const BOUNDARY: &[Key] = &[
    key(
        "name",
        Text,
        Derived("the text of `where`, or boundary-N"),
        "name in messages and output",
    ),
    key("where", WHERE, Required, "particles it acts on"),
    key(
        "fixed",
        Flag,
        Optional,
        "true: velocity zero along every axis",
    ),
    key(
        "roller",
        Other("an axis or a list of axes, \"x\" or [\"x\", \"y\"]"),
        Optional,
        "velocity zero along these axes",
    ),
    key(
        "velocity",
        Table(VELOCITY_COMPONENTS),
        Optional,
        "prescribed velocity; axes not named stay free",
    ),
    key(
        "traction",
        Signals(Measure::STRESS),
        Optional,
        "force per reference area of a face",
    ),
];

/// Velocity components by axis.
pub(crate) const VELOCITY_COMPONENTS: &[Key] = &[
    key("x", Signal(Measure::VELOCITY), Optional, "along x"),
    key("y", Signal(Measure::VELOCITY), Optional, "along y"),
    key("z", Signal(Measure::VELOCITY), Optional, "along z, 3d only"),
];

/// A selection of particles.
pub const SELECTION: &[Key] = &[
    key(
        "body",
        Text,
        Derived("the only body"),
        "body; outermost table only",
    ),
    key("all", Flag, Optional, "true: every particle"),
    key(
        "face",
        Text,
        Optional,
        "particles on a face of the body's shape",
    ),
    key(
        "boundary",
        Flag,
        Optional,
        "true: every particle on the boundary",
    ),
    key(
        "half_space",
        Table(HALF_SPACE),
        Optional,
        "particles on the side to which the normal points",
    ),
    key("box", Table(BOX), Optional, "particles in a box"),
    key(
        "and",
        Other("a list of selections"),
        Optional,
        "particles in all of them",
    ),
    key(
        "or",
        Other("a list of selections"),
        Optional,
        "particles in any of them",
    ),
    key("not", Other("a selection"), Optional, "particles not in it"),
];

/// A half-space.
pub(crate) const HALF_SPACE: &[Key] = &[
    key("point", PLACE, Required, "a point of its face"),
    key(
        "normal",
        Vector(Measure::NUMBER),
        Required,
        "direction into the half-space, any length",
    ),
];

/// `[[obstacle]]`.
pub const OBSTACLE: &[Key] = &[
    key(
        "name",
        Text,
        Derived("obstacle-N"),
        "name in messages and output",
    ),
    key(
        "profile",
        TableOr(PROFILE, "the table of a single chain"),
        Optional,
        "plane strain: chains of segments and arcs",
    ),
    key("plane", Table(PLANE), Optional, "a plane"),
    key(
        "sphere",
        Table(SPHERE),
        Optional,
        "a sphere (in plane strain a circle)",
    ),
    key(
        "cylinder",
        Table(CYLINDER_OBSTACLE),
        Optional,
        "a cylinder, 3d only",
    ),
    key("box", Table(BOX_OBSTACLE), Optional, "a box along the axes"),
    key(
        "law",
        Choice(|| vec!["inelastic", "reflection"]),
        Default("\"inelastic\""),
        "what contact does: remove the inward momentum, or mirror it (the paper's)",
    ),
    key(
        "restitution",
        Number(Measure::NUMBER, Limit::Within(0.0, 1.0)),
        Derived("0 for inelastic"),
        "rebound over approach velocity, for the inelastic law",
    ),
    key(
        "allowed_overlap",
        Number(Measure::LENGTH, Limit::NotNegative),
        Derived("1e-6 of the spacing"),
        "how far a particle may stand in it at the start; contact puts such a particle back onto it",
    ),
    key(
        "velocity",
        Table(VELOCITY_COMPONENTS),
        Optional,
        "velocity of its translation, functions of t only; at rest unless given",
    ),
];

/// The forms of an obstacle.
pub const OBSTACLE_FORMS: &[&str] = &["profile", "plane", "sphere", "cylinder", "box"];

/// Chains of a profile.
pub(crate) const PROFILE: &[Key] = &[key("chains", Tables(CHAIN), Required, "chains")];

/// One chain of segments and arcs.
pub const CHAIN: &[Key] = &[
    key(
        "points",
        Other("a list of [x, y] lengths"),
        Required,
        "corners; an open chain goes on straight beyond its ends",
    ),
    key(
        "fillets",
        Other("a list of radii, one per point, 0 for a sharp corner"),
        Derived("all sharp"),
        "radii of the arcs that round the corners",
    ),
    key(
        "free_side",
        Choice(|| names(SIDES)),
        Required,
        "side of the chain, seen along its points, on which particles may be",
    ),
    key(
        "closed",
        Flag,
        Default("false"),
        "whether the last point is joined to the first",
    ),
];

/// Sides by name.
pub(crate) const SIDES: &[(&str, Side)] = &[("left", Side::Left), ("right", Side::Right)];

/// A plane.
pub(crate) const PLANE: &[Key] = &[
    key("point", PLACE, Required, "a point of the plane"),
    key(
        "normal",
        Vector(Measure::NUMBER),
        Required,
        "direction towards the free side, any length",
    ),
];

const INSIDE: Key = key(
    "inside",
    Flag,
    Default("false"),
    "true: particles are inside",
);

/// A sphere.
pub(crate) const SPHERE: &[Key] = &[
    key("centre", PLACE, Required, "centre"),
    key("radius", LENGTH, Required, "radius"),
    INSIDE,
];

/// A cylinder as an obstacle.
pub(crate) const CYLINDER_OBSTACLE: &[Key] = &[
    key(
        "point",
        PLACE,
        Required,
        "a point of the axis; the middle when it has a length",
    ),
    key(
        "axis",
        Vector(Measure::NUMBER),
        Required,
        "direction of the axis, any length",
    ),
    key("radius", LENGTH, Required, "radius"),
    key("length", LENGTH, Optional, "length; infinite unless given"),
    INSIDE,
];

/// A box as an obstacle.
pub(crate) const BOX_OBSTACLE: &[Key] = &[
    key("min", PLACE, Required, "lowest corner"),
    key("max", PLACE, Required, "highest corner"),
    INSIDE,
];

/// `[[probe]]`.
pub const PROBE: &[Key] = &[
    key(
        "name",
        Text,
        Required,
        "column of history.csv and key of summary.json",
    ),
    key(
        "extent",
        Table(EXTENT),
        Optional,
        "largest minus smallest coordinate of a selection",
    ),
    key(
        "radius",
        Table(RADIUS),
        Optional,
        "mean distance of a selection from a line",
    ),
    key(
        "statistic",
        Table(STATISTIC),
        Optional,
        "statistic of a field over a selection",
    ),
    key(
        "point",
        Table(POINT),
        Optional,
        "field at a fixed point of space, by SPH interpolation",
    ),
    key(
        "line",
        Table(LINE),
        Optional,
        "the same at equally spaced points of a line",
    ),
];

/// An extent probe.
pub(crate) const EXTENT: &[Key] = &[
    key("where", WHERE, Required, "particles"),
    key("axis", AXIS, Required, "axis"),
];
/// A radius probe.
pub(crate) const RADIUS: &[Key] = &[
    key("where", WHERE, Required, "particles"),
    key("axis", AXIS, Default("\"z\""), "direction of the line"),
    key("point", PLACE, Derived("the origin"), "a point of the line"),
];
/// A statistic probe.
pub(crate) const STATISTIC: &[Key] = &[
    key("where", WHERE, Required, "particles"),
    key("field", FIELD, Required, "field"),
    key(
        "of",
        Choice(|| names(STATISTICS)),
        Required,
        "which statistic; the mean is weighted with the volume",
    ),
];
/// A point probe.
pub(crate) const POINT: &[Key] = &[
    key("position", PLACE, Required, "point of space"),
    key("field", FIELD, Required, "field"),
];
/// A line probe.
pub(crate) const LINE: &[Key] = &[
    key("from", PLACE, Required, "first point"),
    key("to", PLACE, Required, "last point"),
    key("count", Count(2), Required, "number of points"),
    key("field", FIELD, Required, "field"),
];

/// Fields a probe can read, by name.
pub const FIELDS: &[(&str, Field)] = &[
    ("equivalent_plastic_strain", Field::EquivalentPlasticStrain),
    ("von_mises_stress", Field::VonMisesStress),
    ("pressure", Field::Pressure),
    ("jacobian", Field::Jacobian),
    ("wave_speed", Field::WaveSpeed),
    ("displacement_x", Field::Displacement(0)),
    ("displacement_y", Field::Displacement(1)),
    ("displacement_z", Field::Displacement(2)),
    ("position_x", Field::Position(0)),
    ("position_y", Field::Position(1)),
    ("position_z", Field::Position(2)),
    ("velocity_x", Field::Velocity(0)),
    ("velocity_y", Field::Velocity(1)),
    ("velocity_z", Field::Velocity(2)),
];

/// Statistics by name.
pub(crate) const STATISTICS: &[(&str, Statistic)] = &[
    ("mean", Statistic::Mean),
    ("median", Statistic::Median),
    ("min", Statistic::Minimum),
    ("max", Statistic::Maximum),
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
        "frame_interval",
        Number(Measure::TIME, Limit::Positive),
        Derived("end / 50"),
        "simulated time between frames for ParaView",
    ),
    key(
        "restart_interval",
        Number(Measure::TIME, Limit::Positive),
        Derived("end / 10"),
        "simulated time between restart files",
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
];

/// Precisions by name.
pub(crate) const PRECISIONS: &[(&str, Precision)] =
    &[("double", Precision::Double), ("single", Precision::Single)];
