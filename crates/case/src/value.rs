//! Numbers, counts and vectors of a document, checked and in SI units.

use jstsph_geometry::Dimension;
use jstsph_tensor::Vec3;

use crate::document::{Calculated, Node, Value};
use crate::error::Problem;
use crate::schema::Limit;
use crate::suggestion::nearest;
use crate::units::{Measure, PREFIXES, UNITS, UnitError, parse_quantity};

pub(crate) fn wrong_type(node: &Node, path: &str, wanted: &str) -> Problem {
    let path = if path.is_empty() { "the case" } else { path };
    Problem::new(
        &node.origin,
        format!("`{path}` must be {wanted}, but is {}", node.value.kind()),
    )
}

/// Number of a node in SI units.
pub(crate) fn number(
    node: &Node,
    path: &str,
    measure: Measure,
    limit: Limit,
) -> Result<f64, Problem> {
    let value = match &node.value {
        #[expect(
            clippy::cast_precision_loss,
            reason = "integers of case files are small"
        )]
        Value::Integer(value) => *value as f64,
        Value::Float(value) => *value,
        Value::Text(text) => with_unit(node, path, text, measure)?,
        Value::Calculated(number) => calculated(node, path, number, measure)?,
        other => {
            return Err(Problem::new(
                &node.origin,
                format!(
                    "`{path}` must be {}, but is {}",
                    measure.description(),
                    other.kind()
                ),
            )
            .help("a plain number is in SI units; a text carries its unit, e.g. \"8 mm\""));
        }
    };
    match limit.violated(value) {
        Some(wanted) => Err(Problem::new(
            &node.origin,
            format!("`{path}` must be {wanted}, but is {value}{}", si(measure)),
        )),
        None => Ok(value),
    }
}

fn calculated(
    node: &Node,
    path: &str,
    number: &Calculated,
    measure: Measure,
) -> Result<f64, Problem> {
    if number.measure == measure {
        return Ok(number.value);
    }
    let problem = Problem::new(
        &node.origin,
        format!(
            "`{path}` must be {}, but \"{}\" is {}",
            measure.description(),
            number.text,
            number.measure.description()
        ),
    );
    Err(if number.measure == Measure::NUMBER {
        problem.help(
            "in expressions and [parameters] a number without unit has no dimension: \
             write \"8 mm\", not 0.008",
        )
    } else {
        problem
    })
}

fn si(measure: Measure) -> String {
    if measure == Measure::NUMBER {
        String::new()
    } else {
        format!(" {measure}")
    }
}

fn with_unit(node: &Node, path: &str, text: &str, measure: Measure) -> Result<f64, Problem> {
    match parse_quantity(text) {
        Ok((value, found)) if found == measure => Ok(value),
        Ok((_, found)) => Err(Problem::new(
            &node.origin,
            format!(
                "`{path}` must be {}, but \"{text}\" is {}",
                measure.description(),
                found.description()
            ),
        )),
        Err(error) => {
            let problem = Problem::new(&node.origin, format!("`{path}`: {error}"))
                .help(format!("`{path}` is {}", measure.description()));
            let UnitError::UnknownUnit { symbol, .. } = &error else {
                return Err(problem);
            };
            Err(match nearest_unit(symbol, measure) {
                Some(name) => problem.help(format!("did you mean `{name}`?")),
                None => problem,
            })
        }
    }
}

/// The most similar unit, one of the wanted dimension when there is such a one.
fn nearest_unit(symbol: &str, measure: Measure) -> Option<String> {
    let known: Vec<(Measure, String)> = UNITS
        .iter()
        .flat_map(|unit| {
            let prefixes = PREFIXES
                .iter()
                .map(|(prefix, _)| *prefix)
                .filter(|_| unit.prefixed);
            prefixes
                .chain([""])
                .map(|prefix| (unit.measure, format!("{prefix}{}", unit.symbol)))
        })
        .collect();
    let fitting = known
        .iter()
        .filter(|(of, _)| *of == measure)
        .map(|(_, name)| name.as_str());
    nearest(symbol, fitting)
        .or_else(|| nearest(symbol, known.iter().map(|(_, name)| name.as_str())))
        .map(str::to_owned)
}

/// Non-negative integer of a node.
pub(crate) fn count(node: &Node, path: &str, least: usize) -> Result<usize, Problem> {
    let value = match &node.value {
        Value::Integer(value) => *value,
        Value::Calculated(number) => {
            let value = calculated(node, path, number, Measure::NUMBER)?;
            #[expect(clippy::cast_possible_truncation, reason = "whole and within 2^53")]
            let whole = (value.fract() == 0.0 && value.abs() < 9e15).then_some(value as i64);
            whole.ok_or_else(|| {
                Problem::new(
                    &node.origin,
                    format!(
                        "`{path}` must be an integer, but \"{}\" is {value}",
                        number.text
                    ),
                )
                .help("round with floor() or ceil()")
            })?
        }
        _ => return Err(wrong_type(node, path, "an integer")),
    };
    usize::try_from(value)
        .ok()
        .filter(|value| *value >= least)
        .ok_or_else(|| {
            Problem::new(
                &node.origin,
                format!("`{path}` must be at least {least}, but is {value}"),
            )
        })
}

pub(crate) fn per_axis<'n>(
    node: &'n Node,
    path: &str,
    dimension: Dimension,
) -> Result<Vec<&'n Node>, Problem> {
    let axes = dimension.count();
    match &node.value {
        Value::Array(items) if items.len() == axes => Ok(items.iter().collect()),
        Value::Array(items) => Err(Problem::new(
            &node.origin,
            format!(
                "`{path}` must have {axes} entries, one per axis, but has {}",
                items.len()
            ),
        )),
        _ => Err(wrong_type(
            node,
            path,
            &format!("an array of {axes} entries, one per axis"),
        )),
    }
}

/// One number per axis, z = 0 in plane strain.
pub(crate) fn vector(
    node: &Node,
    path: &str,
    measure: Measure,
    dimension: Dimension,
) -> Result<Vec3, Problem> {
    let mut value = Vec3::zeros();
    for (axis, item) in per_axis(node, path, dimension)?.into_iter().enumerate() {
        value[axis] = number(item, path, measure, Limit::Any)?;
    }
    Ok(value)
}

/// The components that exist, as TOML.
pub(crate) fn components(value: &Vec3, dimension: Dimension) -> toml::Value {
    value
        .iter()
        .take(dimension.count())
        .copied()
        .collect::<Vec<f64>>()
        .into()
}

/// A count as TOML.
pub(crate) fn to_integer(value: usize) -> toml::Value {
    toml::Value::Integer(i64::try_from(value).unwrap_or(i64::MAX))
}

/// A position for people: six significant digits.
pub(crate) fn shown(x: &Vec3) -> String {
    let short = |value: f64| {
        format!("{value:.5e}")
            .parse::<f64>()
            .unwrap_or(value)
            .to_string()
    };
    format!("({}, {}, {})", short(x.x), short(x.y), short(x.z))
}
