//! Signals: constants, tables in time and expressions, as a case file writes them.

use std::sync::Arc;

use jstsph_geometry::Dimension;
use jstsph_solver::Signal;
use jstsph_tensor::Vec3;

use crate::document::{Node, Value};
use crate::error::Problem;
use crate::expression::{CONSTANTS, Expression, FUNCTIONS, FUNCTIONS_OF_TWO};
use crate::schema::{self, Limit};
use crate::section::Section;
use crate::units::Measure;
use crate::value::{number, shown};

/// Variables of expressions, in the order of their values.
pub(crate) const VARIABLES: [&str; 4] = ["t", "X", "Y", "Z"];

/// What a signal may depend on, and where it will be evaluated.
#[derive(Clone, Copy)]
pub(crate) struct Scope<'a> {
    /// Names an expression may use: all of [`VARIABLES`] or a part of them.
    pub(crate) variables: &'a [&'a str],
    /// Reference positions at which the value at time zero must be finite.
    pub(crate) positions: &'a [Vec3],
}

/// A signal and how the resolved case writes it.
pub(crate) type Resolved = (Signal, toml::Value);

/// Reads a signal.
pub(crate) fn signal(
    node: &Node,
    path: &str,
    measure: Measure,
    scope: Scope<'_>,
) -> Result<Resolved, Problem> {
    let Value::Table(_) = node.value else {
        let value = number(node, path, measure, Limit::Any)?;
        return Ok((Signal::Constant(value), value.into()));
    };
    let mut section = Section::open(node, path, schema::SIGNAL)?;
    let signal = if section.variant()? == "table" {
        table(&mut section, measure, scope)?
    } else {
        expression(&mut section, scope)?
    };
    Ok((signal, section.finish().into()))
}

fn table(section: &mut Section<'_>, measure: Measure, scope: Scope<'_>) -> Result<Signal, Problem> {
    let field = section.need("table")?;
    if !scope.variables.contains(&"t") {
        return Err(field.problem(format!("`{}` cannot change with time", section.path())));
    }
    let (mut times, mut values) = (Vec::new(), Vec::new());
    for (row, node) in field.items()?.into_iter().enumerate() {
        let path = format!("{}.{row}", field.path);
        let pair = match &node.value {
            Value::Array(items) if items.len() == 2 => items,
            _ => {
                return Err(Problem::new(
                    &node.origin,
                    format!("`{path}` must be a pair [time, value]"),
                ));
            }
        };
        let time = number(&pair[0], &path, Measure::TIME, Limit::Any)?;
        if times.last().is_some_and(|last| *last >= time) {
            return Err(Problem::new(
                &pair[0].origin,
                format!(
                    "times of `{}` must ascend, but {time} s follows {} s",
                    field.path,
                    times[row - 1]
                ),
            ));
        }
        times.push(time);
        values.push(number(&pair[1], &path, measure, Limit::Any)?);
    }
    if times.is_empty() {
        return Err(field.problem(format!(
            "`{}` is empty, but needs at least one [time, value]",
            field.path
        )));
    }
    let rows: Vec<toml::Value> = times
        .iter()
        .zip(&values)
        .map(|(t, v)| vec![*t, *v].into())
        .collect();
    section.record("table", rows);
    Ok(Signal::Table { times, values })
}

fn expression(section: &mut Section<'_>, scope: Scope<'_>) -> Result<Signal, Problem> {
    let text = section.text("expression")?;
    let path = section.path();
    let expression = Expression::parse(&text, &VARIABLES).map_err(|error| {
        let problem = section.problem("expression", format!("`{path}`: {error}"));
        match &error.unknown {
            None => problem,
            Some(name) => {
                let functions = FUNCTIONS.iter().map(|(name, _)| *name);
                let functions = functions.chain(FUNCTIONS_OF_TWO.iter().map(|(name, _)| *name));
                let names = scope
                    .variables
                    .iter()
                    .copied()
                    .chain(CONSTANTS.iter().map(|(name, _)| *name));
                problem.allowed(name, names.chain(functions))
            }
        }
    })?;
    for (index, name) in VARIABLES.iter().enumerate() {
        if expression.uses(index) && !scope.variables.contains(name) {
            return Err(section
                .problem("expression", format!("`{path}` cannot depend on `{name}`"))
                .help(format!("allowed: {}", scope.variables.join(", "))));
        }
    }
    let value_at = move |t: f64, x: &Vec3| expression.evaluate(&[t, x.x, x.y, x.z]);
    for x in scope.positions {
        let value = value_at(0.0, x);
        if !value.is_finite() {
            return Err(section.problem(
                "expression",
                format!(
                    "`{path}` is {value} at t = 0 and reference position {} m, but must be finite",
                    shown(x)
                ),
            ));
        }
    }
    Ok(Signal::Function(Arc::new(value_at)))
}

/// One signal per axis of an array; zero along z in plane strain.
pub(crate) fn signals(
    node: &Node,
    path: &str,
    measure: Measure,
    dimension: Dimension,
    scope: Scope<'_>,
) -> Result<([Signal; 3], toml::Value), Problem> {
    let mut found = [const { Signal::Constant(0.0) }; 3];
    let mut resolved = Vec::new();
    for (axis, item) in crate::value::per_axis(node, path, dimension)?
        .into_iter()
        .enumerate()
    {
        let (signal, value) = signal(
            item,
            &format!("{path}.{}", ["x", "y", "z"][axis]),
            measure,
            scope,
        )?;
        found[axis] = signal;
        resolved.push(value);
    }
    Ok((found, resolved.into()))
}

/// Velocities named by axis, `{ y = "-1 m/s" }`.
pub(crate) fn velocity_components(
    node: &Node,
    path: &str,
    dimension: Dimension,
    scope: Scope<'_>,
) -> Result<([Option<Signal>; 3], toml::Value), Problem> {
    let mut section = Section::open(node, path, schema::VELOCITY_COMPONENTS)?;
    let mut found = [None, None, None];
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let Some(component) = section.node(name) else {
            continue;
        };
        if axis >= dimension.count() {
            return Err(section.problem(
                name,
                format!("`{path}.{name}`: there is no {name} axis in plane strain"),
            ));
        }
        let (signal, value) = signal(
            component,
            &format!("{path}.{name}"),
            Measure::VELOCITY,
            scope,
        )?;
        found[axis] = Some(signal);
        section.record(name, value);
    }
    if found.iter().all(Option::is_none) {
        return Err(
            Problem::new(&node.origin, format!("`{path}` names no axis"))
                .help("write for instance { y = \"-1 m/s\" }; axes not named stay free"),
        );
    }
    Ok((found, section.finish().into()))
}
