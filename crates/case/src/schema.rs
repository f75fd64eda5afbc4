//! Every key of a case file, described once: reading, defaults, error messages, the comments of
//! resolved cases and `jstsph list` all use these tables.

use crate::units::Measure;

use Kind::{Choice, Number, Other, Table, Tables, Text, Vector};
use Presence::{Default, Optional, Required};

mod bodies;
mod conditions;
mod numerics;

pub use bodies::{BODY, LATTICE, SELECTION, SHAPES};
pub(crate) use bodies::{BOX, FILLINGS, HALF_SPACE, INITIAL_VELOCITY, ROTATION, SIGNAL};
pub use conditions::{
    BOUNDARY, CHAIN, CONDITIONS, FIELDS, OBSTACLE, OBSTACLE_FORMS, PROBE, PROBE_QUANTITIES,
};
pub(crate) use conditions::{
    CONVECTION, OBSTACLE_HEAT, PROFILE, SIDES, STATISTICS, VELOCITY_COMPONENTS,
};
pub(crate) use numerics::{
    BIHARMONIC, CELLS, FORMATS, FORMULATIONS, INTEGRATORS, JST, LAPLACIANS, PRECISIONS,
    QUADRATURES, SMOOTHING_REFERENCES, STEP_LIMITS, VISCOSITY, WEIGHTS,
};
pub use numerics::{FRAME_FIELDS, HEAT, OUTPUT, SCHEME, STABILISATION, TIME};

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
        "include",
        Other("a list of paths", Form::Paths),
        Optional,
        "files with further [material.NAME.MODEL] tables, relative to the folder of the case",
    ),
    key(
        "parameters",
        Other(
            "named numbers, with unit or as \"= expression\"",
            Form::Parameters,
        ),
        Optional,
        "values to use by name, as in \"= 2 * radius + 1 mm\"; change them with --set parameters.NAME",
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
        "heat",
        Table(HEAT),
        Optional,
        "temperatures change: heat of plastic work, conduction, heat from outside",
    ),
    key(
        "material",
        Other(
            "tables [material.NAME.MODEL]; see `jstsph list materials`",
            Form::Materials,
        ),
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
        "rigid obstacles, with or without friction",
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

/// One key of a table.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Name.
    pub name: &'static str,
    /// What it holds.
    pub kind: Kind,
    /// Whether it must be given, and what holds when it is not.
    pub presence: Presence,
    /// One line for the reader of a list.
    pub meaning: &'static str,
}

/// What a key holds.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// A number, SI or with a unit.
    Number(Measure, Limit),
    /// An integer not below the given one.
    Count(usize),
    /// `true` or `false`.
    Flag,
    /// Any text.
    Text,
    /// One of these texts.
    Choice(fn() -> Vec<&'static str>),
    /// One number per axis.
    Vector(Measure),
    /// A number, a table in time or an expression.
    Signal(Measure),
    /// One signal per axis.
    Signals(Measure),
    /// A table with exactly one of these keys.
    OneOf(&'static [Key]),
    /// A table.
    Table(&'static [Key]),
    /// A list of tables.
    Tables(&'static [Key]),
    /// A table with these keys, or what the words say.
    TableOr(&'static [Key], &'static str, &'static Kind),
    /// Something else, described in words.
    Other(&'static str, Form),
}

/// How values are written that are no single number, text or table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Tables `[material.NAME.MODEL]`.
    Materials,
    /// Numbers with or without units, by name.
    Parameters,
    /// Paths.
    Paths,
    /// A selection of particles.
    Selection,
    /// A list of selections.
    Selections,
    /// A list of two or more shapes.
    Shapes,
    /// A list of pairs of lengths.
    Points,
    /// A list of lengths, zero or positive.
    Radii,
    /// Two lengths.
    Interval,
    /// One count per axis.
    Counts,
    /// Three numbers.
    Direction,
    /// A list of pairs of a time and a value.
    TimeTable,
    /// An axis or a list of axes.
    Axes,
    /// A list of names of [`FRAME_FIELDS`].
    Fields,
}

/// Which numbers are allowed; only finite ones ever are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Any.
    Any,
    /// Greater than zero.
    Positive,
    /// Zero or greater.
    NotNegative,
    /// Between two numbers, ends included.
    Within(f64, f64),
}

impl Limit {
    /// What the number must be, when it is not.
    pub(crate) fn violated(self, value: f64) -> Option<String> {
        let (allowed, message) = match self {
            Self::Any => (true, "finite".to_owned()),
            Self::Positive => (value > 0.0, "positive".to_owned()),
            Self::NotNegative => (value >= 0.0, "zero or positive".to_owned()),
            Self::Within(least, most) => (
                (least..=most).contains(&value),
                format!("between {least} and {most}"),
            ),
        };
        if !value.is_finite() {
            return Some("finite".to_owned());
        }
        (!allowed).then_some(message)
    }
}

/// Whether a key must be given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presence {
    /// It must.
    Required,
    /// It need not; without it nothing happens.
    Optional,
    /// It need not; this TOML value holds without it.
    Default(&'static str),
    /// It need not; what holds without it depends on other keys, as described.
    Derived(&'static str),
}

impl Kind {
    /// What the key holds, in words.
    #[must_use]
    pub fn description(&self) -> String {
        match self {
            Self::Number(measure, limit) => {
                let base = measure.description();
                match limit {
                    Limit::Any => base,
                    Limit::Positive => format!("{base}, positive"),
                    Limit::NotNegative => format!("{base}, zero or positive"),
                    Limit::Within(least, most) => format!("{base}, {least} to {most}"),
                }
            }
            Self::Count(least) => format!("an integer, at least {least}"),
            Self::Flag => "true or false".to_owned(),
            Self::Text => "a text".to_owned(),
            Self::Choice(names) => names().join(" | "),
            Self::Vector(measure) => format!("one number per axis, each {}", measure.description()),
            Self::Signal(measure) => format!(
                "{}: constant, {{ table = [[t, value], ...] }} or {{ expression = \"...\" }}",
                measure.description()
            ),
            Self::Signals(measure) => format!(
                "one value per axis, each {}: constant, table or expression",
                measure.description()
            ),
            Self::OneOf(keys) => {
                let names: Vec<&str> = keys.iter().map(|key| key.name).collect();
                format!("a table with one of: {}", names.join(", "))
            }
            Self::Table(_) => "a table".to_owned(),
            Self::Tables(_) => "a list of tables".to_owned(),
            Self::TableOr(_, words, _) => format!("a table, or {words}"),
            Self::Other(words, _) => (*words).to_owned(),
        }
    }

    /// Unit in which a resolved case writes the number, when there is one.
    pub(crate) fn unit(&self) -> Option<String> {
        match self {
            Self::Number(measure, _)
            | Self::Vector(measure)
            | Self::Signal(measure)
            | Self::Signals(measure)
                if *measure != Measure::NUMBER =>
            {
                Some(measure.to_string())
            }
            _ => None,
        }
    }

    /// Keys of the tables below this key.
    #[must_use]
    pub fn keys(&self) -> &'static [Key] {
        match self {
            Self::OneOf(keys)
            | Self::Table(keys)
            | Self::Tables(keys)
            | Self::TableOr(keys, _, _) => keys,
            _ => &[],
        }
    }
}

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
    Form::Selection,
);

/// First entries of a list of pairs.
pub(crate) fn names<T>(pairs: &[(&'static str, T)]) -> Vec<&'static str> {
    pairs.iter().map(|(name, _)| *name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(keys: &[Key], path: &str, visited: usize) -> usize {
        let mut count = visited;
        for (at, key) in keys.iter().enumerate() {
            count += 1;
            assert!(
                !key.meaning.is_empty(),
                "{path}.{} has no meaning",
                key.name
            );
            assert!(
                keys[..at].iter().all(|other| other.name != key.name),
                "{path}.{} is described twice",
                key.name
            );
            if let Presence::Default(text) = key.presence {
                let value = text.parse::<toml::Value>();
                assert!(
                    value.is_ok(),
                    "{path}.{}: default {text} is not TOML",
                    key.name
                );
            }
            count = check(key.kind.keys(), &format!("{path}.{}", key.name), count);
        }
        count
    }

    #[test]
    fn every_key_is_described_once_and_its_default_is_toml() {
        assert!(check(CASE, "case", 0) > 80);
    }

    #[test]
    fn limits_refuse_what_they_say() {
        assert_eq!(Limit::Positive.violated(0.0), Some("positive".to_owned()));
        assert_eq!(Limit::NotNegative.violated(0.0), None);
        assert_eq!(
            Limit::Within(0.0, 1.0).violated(1.5),
            Some("between 0 and 1".to_owned())
        );
        assert_eq!(
            Limit::Any.violated(f64::INFINITY),
            Some("finite".to_owned())
        );
    }
}
