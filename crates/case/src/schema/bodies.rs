//! Keys of `[[body]]`, its shape, lattice and motion, and of selections and signals.

use super::Kind::{
    Choice, Count, Flag, Number, OneOf, Other, Signal, Signals, Table, TableOr, Text, Vector,
};
use super::Presence::{Default, Derived, Optional, Required};
use super::{AXIS, Form, Key, LENGTH, Limit, PLACE, key};
use crate::units::Measure;

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
            &Signals(Measure::VELOCITY),
        ),
        Optional,
        "initial velocity; zero unless given",
    ),
    key(
        "temperature",
        Signal(Measure::TEMPERATURE),
        Default("\"20 degC\""),
        "initial temperature: a number or an expression of X, Y, Z",
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
    key(
        "sphere",
        Table(SPHERE),
        Optional,
        "sphere, 3d only; faces as for a union",
    ),
    key(
        "polygon",
        Table(POLYGON),
        Optional,
        "polygon in x, y (in 3d the prism over it); faces as for a union",
    ),
    key(
        "stl",
        Table(STL),
        Optional,
        "what a closed surface of triangles encloses, 3d only; faces as for a union",
    ),
    key(
        "drawing",
        Table(DRAWING),
        Optional,
        "what the lines of a DXF or SVG file enclose (in 3d the prism over it); faces as for a union",
    ),
    key(
        "union",
        COMBINATION,
        Optional,
        "what lies in any of the shapes; faces left ... top on the bounding box, and facing_left ... facing_top for all of the surface that faces this way",
    ),
    key(
        "intersection",
        COMBINATION,
        Optional,
        "what lies in every one of the shapes; faces as for a union",
    ),
    key(
        "difference",
        COMBINATION,
        Optional,
        "the first shape without the others; faces as for a union",
    ),
];

const COMBINATION: super::Kind = Other("a list of two or more shapes", Form::Shapes);

/// A sphere as a body.
pub(crate) const SPHERE: &[Key] = &[
    key("centre", PLACE, Required, "centre"),
    key("radius", LENGTH, Required, "radius"),
];

/// The file of a surface.
pub(crate) const STL_FILE: Key = key(
    "file",
    Text,
    Required,
    "path of the STL file, text or binary, relative to the folder of the case",
);
/// Its unit.
pub(crate) const STL_UNIT: Key = key(
    "unit",
    Choice(|| super::names(crate::stl::UNITS)),
    Required,
    "unit of the coordinates in the file",
);
/// A factor for its coordinates.
pub(crate) const STL_SCALE: Key = key(
    "scale",
    Number(Measure::NUMBER, Limit::Positive),
    Default("1.0"),
    "factor for the coordinates",
);
/// Where it is put.
pub(crate) const STL_TRANSLATE: Key = key(
    "translate",
    PLACE,
    Optional,
    "how far the surface is moved, after scaling",
);

/// A surface from an STL file as a body.
pub(crate) const STL: &[Key] = &[STL_FILE, STL_UNIT, STL_SCALE, STL_TRANSLATE];

/// The file of a drawing.
pub(crate) const DRAWING_FILE: Key = key(
    "file",
    Text,
    Required,
    "path of the DXF (text) or SVG file, relative to the folder of the case",
);
/// Its unit.
pub(crate) const DRAWING_UNIT: Key = key(
    "unit",
    Choice(|| super::names(crate::stl::UNITS)),
    Required,
    "unit of the coordinates in the file",
);
/// What is taken of it.
pub(crate) const DRAWING_LAYER: Key = key(
    "layer",
    Text,
    Derived("everything"),
    "only this layer; in SVG the element with this id or Inkscape label",
);
/// What is the same place.
pub(crate) const DRAWING_TOLERANCE: Key = key(
    "tolerance",
    LENGTH,
    Derived("1e-4 of the diagonal of what is taken"),
    "distance up to which ends of lines are joined, and by which straight pieces deviate from curves that are no arcs of circles",
);

/// The outline of a body from a drawing.
pub(crate) const DRAWING: &[Key] = &[
    DRAWING_FILE,
    DRAWING_UNIT,
    DRAWING_LAYER,
    STL_SCALE,
    DRAWING_TRANSLATE,
    DRAWING_TOLERANCE,
    EXTRUDE,
];

/// Where it is put.
pub(crate) const DRAWING_TRANSLATE: Key = key(
    "translate",
    Other("[x, y] lengths", Form::Interval),
    Optional,
    "how far the lines are moved, after scaling",
);

const EXTRUDE: Key = key(
    "extrude",
    Other("[lowest z, highest z]", Form::Interval),
    Derived("none in plane strain, required in 3d"),
    "extent along z",
);

/// A polygon.
pub(crate) const POLYGON: &[Key] = &[
    key(
        "points",
        Other("a list of [x, y] lengths", Form::Points),
        Required,
        "corners in either direction; the last is joined to the first",
    ),
    key(
        "fillets",
        Other(
            "a list of radii, one per point, 0 for a sharp corner",
            Form::Radii,
        ),
        Derived("all sharp"),
        "radii of the arcs that round the corners, cut into pieces of 5 degrees",
    ),
    EXTRUDE,
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
        Other("nodes along each axis, e.g. [21, 11]", Form::Counts),
        Optional,
        "cubic lattice with these nodes along the edges of the bounding box; not for discs and cylinders",
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
        "concentric rings around the centre node, for a disc or cylinder",
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

/// What says how finely a shape is filled: exactly one of these.
pub(crate) const FILLINGS: &[&str] = &["spacing", "counts", "per_radius", "rings"];

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
        Other(
            "direction as three numbers; z in plane strain",
            Form::Direction,
        ),
        Derived("z in plane strain, required in 3d"),
        "axis of rotation, any length",
    ),
    key("centre", PLACE, Required, "a point of the axis"),
];

/// Signals that are not constants.
pub(crate) const SIGNAL: &[Key] = &[
    key(
        "table",
        Other("[[time, value], ...] with ascending times", Form::TimeTable),
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
        Other("a list of selections", Form::Selections),
        Optional,
        "particles in all of them",
    ),
    key(
        "or",
        Other("a list of selections", Form::Selections),
        Optional,
        "particles in any of them",
    ),
    key(
        "not",
        Other("a selection", Form::Selection),
        Optional,
        "particles not in it",
    ),
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
