//! Keys of `[[boundary]]`, `[[obstacle]]` and `[[probe]]`.

use jstsph_contact::Side;
use jstsph_solver::{Field, Statistic};

use super::Kind::{
    Choice, Count, Flag, Number, Other, Signal, Signals, Table, TableOr, Tables, Text, Vector,
};
use super::Presence::{Default, Derived, Optional, Required};
use super::bodies::{
    DRAWING_FILE, DRAWING_LAYER, DRAWING_TOLERANCE, DRAWING_TRANSLATE, DRAWING_UNIT, STL_FILE,
    STL_SCALE, STL_TRANSLATE, STL_UNIT,
};
use super::{AXIS, FIELD, Form, Key, LENGTH, Limit, PLACE, WHERE, key, names};
use crate::units::Measure;

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
        Other(
            "an axis or a list of axes, \"x\" or [\"x\", \"y\"]",
            Form::Axes,
        ),
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
    key(
        "temperature",
        Signal(Measure::TEMPERATURE),
        Optional,
        "prescribed temperature; needs [heat]",
    ),
    key(
        "heat_flux",
        Signal(Measure::HEAT_FLUX),
        Optional,
        "heat into the body per reference area of a face; needs [heat]",
    ),
    key(
        "convection",
        Table(CONVECTION),
        Optional,
        "heat exchange with surroundings through a face; needs [heat]",
    ),
];

/// What a boundary prescribes: exactly one of these.
pub const CONDITIONS: &[&str] = &[
    "fixed",
    "roller",
    "velocity",
    "traction",
    "temperature",
    "heat_flux",
    "convection",
];

/// Heat exchange with surroundings.
pub(crate) const CONVECTION: &[Key] = &[
    key(
        "coefficient",
        Number(Measure::HEAT_TRANSFER, Limit::NotNegative),
        Required,
        "heat flux per difference of temperature",
    ),
    key(
        "ambient",
        Signal(Measure::TEMPERATURE),
        Required,
        "temperature of the surroundings",
    ),
];

/// Heat exchange with an obstacle.
pub(crate) const OBSTACLE_HEAT: &[Key] = &[
    key(
        "conductance",
        Number(Measure::HEAT_TRANSFER, Limit::NotNegative),
        Required,
        "heat flux per difference of temperature where a body touches it",
    ),
    key(
        "temperature",
        Signal(Measure::TEMPERATURE),
        Required,
        "temperature of the obstacle, a function of t only",
    ),
];

/// Velocity components by axis.
pub(crate) const VELOCITY_COMPONENTS: &[Key] = &[
    key("x", Signal(Measure::VELOCITY), Optional, "along x"),
    key("y", Signal(Measure::VELOCITY), Optional, "along y"),
    key("z", Signal(Measure::VELOCITY), Optional, "along z, 3d only"),
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
        TableOr(PROFILE, "the table of a single chain", &Table(CHAIN)),
        Optional,
        "plane strain: chains of segments and arcs",
    ),
    key(
        "drawing",
        Table(DRAWING_OBSTACLE),
        Optional,
        "plane strain: the lines of a DXF or SVG file",
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
        "stl",
        Table(STL_OBSTACLE),
        Optional,
        "a closed surface of triangles, 3d only",
    ),
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
        "friction",
        Number(Measure::NUMBER, Limit::NotNegative),
        Default("0"),
        "Coulomb coefficient: largest tangential over normal impulse; 0 slides freely",
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
    key(
        "heat",
        Table(OBSTACLE_HEAT),
        Optional,
        "heat exchange with bodies that touch it; it insulates unless given",
    ),
];

/// The forms of an obstacle: exactly one of these.
pub const OBSTACLE_FORMS: &[&str] = &[
    "profile", "drawing", "plane", "sphere", "cylinder", "box", "stl",
];

/// Chains of a profile.
pub(crate) const PROFILE: &[Key] = &[key("chains", Tables(CHAIN), Required, "chains")];

/// One chain of segments and arcs.
pub const CHAIN: &[Key] = &[
    key(
        "points",
        Other("a list of [x, y] lengths", Form::Points),
        Required,
        "corners; an open chain goes on straight beyond its ends",
    ),
    key(
        "fillets",
        Other(
            "a list of radii, one per point, 0 for a sharp corner",
            Form::Radii,
        ),
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

/// Walls along the lines of a drawing.
pub(crate) const DRAWING_OBSTACLE: &[Key] = &[
    DRAWING_FILE,
    DRAWING_UNIT,
    DRAWING_LAYER,
    STL_SCALE,
    DRAWING_TRANSLATE,
    DRAWING_TOLERANCE,
    key(
        "free_point",
        Other("[x, y] lengths", Form::Interval),
        Required,
        "a point on that side of every line on which particles may be",
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

/// A surface from an STL file as an obstacle.
pub(crate) const STL_OBSTACLE: &[Key] = &[STL_FILE, STL_UNIT, STL_SCALE, STL_TRANSLATE, INSIDE];

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
        "edge_radius",
        Table(EDGE_RADIUS),
        Optional,
        "mean radius of the edge of a disc or cylinder where a selection meets it",
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

/// An edge radius probe.
pub(crate) const EDGE_RADIUS: &[Key] = &[
    key("where", WHERE, Required, "particles"),
    key("axis", AXIS, Default("\"z\""), "direction of the line"),
    key("point", PLACE, Derived("the origin"), "a point of the line"),
    key(
        "radius",
        LENGTH,
        Optional,
        "radius of the undeformed edge, for a body cut out of a disc or cylinder, such as a quarter of one",
    ),
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

/// What a probe reads: exactly one of these.
pub const PROBE_QUANTITIES: &[&str] = &[
    "extent",
    "radius",
    "edge_radius",
    "statistic",
    "point",
    "line",
];

/// Fields a probe can read, by name.
pub const FIELDS: &[(&str, Field)] = &[
    ("equivalent_plastic_strain", Field::EquivalentPlasticStrain),
    ("von_mises_stress", Field::VonMisesStress),
    ("pressure", Field::Pressure),
    ("jacobian", Field::Jacobian),
    ("wave_speed", Field::WaveSpeed),
    ("temperature", Field::Temperature),
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
