//! `[[boundary]]`: prescribed velocities and tractions, temperatures and heat.

use jstsph_geometry::{Dimension, face_areas};
use jstsph_solver::{Condition, ConditionKind, ModelBody, Signal};
use jstsph_tensor::Vec3;

use crate::document::{Node, Value};
use crate::error::Problem;
use crate::schema;
use crate::section::{Field, Section};
use crate::selection::{Selected, read_where};
use crate::signal::{Scope, VARIABLES, signal, signals, velocity_components};
use crate::units::Measure;

/// Reads one condition.
pub(crate) fn read_boundary(
    node: &Node,
    number: usize,
    bodies: &[ModelBody],
    dimension: Dimension,
) -> Result<(Condition, toml::Table), Problem> {
    let mut section = Section::open(node, &format!("boundary.{number}"), schema::BOUNDARY)?;
    let selected = read_where(&mut section, bodies, dimension)?;
    let name = match (section.field("name")?, &selected.resolved) {
        (Some(field), _) => field.text()?.to_owned(),
        (None, toml::Value::String(text)) => text.clone(),
        (None, _) => format!("boundary-{number}"),
    };
    section.record("name", name.as_str());
    let form = section.one_of(schema::CONDITIONS)?;
    let positions: Vec<Vec3> = selected
        .particles
        .iter()
        .map(|a| bodies[selected.body].body.positions[*a as usize])
        .collect();
    let scope = Scope {
        variables: &VARIABLES,
        positions: &positions,
    };
    let at_rest = |held: bool| held.then_some(Signal::Constant(0.0));
    let kind = match form {
        "fixed" => {
            if !section.flag("fixed")? {
                return Err(section.problem(
                    "fixed",
                    format!("`{}.fixed` can only be true", section.path()),
                ));
            }
            let axes = dimension.count();
            ConditionKind::Velocity([0, 1, 2].map(|axis| at_rest(axis < axes)))
        }
        "roller" => {
            let field = section.need("roller")?;
            let axes = read_axes(&field, dimension)?;
            let shown: Vec<toml::Value> = axes
                .iter()
                .map(|axis| ["x", "y", "z"][*axis].into())
                .collect();
            section.record("roller", shown);
            ConditionKind::Velocity([0, 1, 2].map(|axis| at_rest(axes.contains(&axis))))
        }
        "velocity" => {
            let field = section.need("velocity")?;
            let (velocity, resolved) =
                velocity_components(&field.node, &field.path, dimension, scope)?;
            section.record("velocity", resolved);
            ConditionKind::Velocity(velocity)
        }
        "temperature" => {
            let field = section.need("temperature")?;
            let (temperature, resolved) =
                signal(&field.node, &field.path, Measure::TEMPERATURE, scope)?;
            section.record("temperature", resolved);
            ConditionKind::Temperature(temperature)
        }
        "heat_flux" => {
            let field = section.need("heat_flux")?;
            let (flux, resolved) = signal(&field.node, &field.path, Measure::HEAT_FLUX, scope)?;
            section.record("heat_flux", resolved);
            let areas = tributary_areas(&section, &selected, &bodies[selected.body])?;
            ConditionKind::HeatFlux { areas, flux }
        }
        "convection" => {
            let field = section.need("convection")?;
            let mut table = Section::open(&field.node, &field.path, schema::CONVECTION)?;
            let coefficient = table.number("coefficient")?;
            let ambient = table.need("ambient")?;
            let (ambient, resolved) =
                signal(&ambient.node, &ambient.path, Measure::TEMPERATURE, scope)?;
            table.record("ambient", resolved);
            section.record("convection", table.finish());
            let areas = tributary_areas(&section, &selected, &bodies[selected.body])?;
            ConditionKind::Convection {
                areas,
                coefficient,
                ambient,
            }
        }
        _ => {
            let field = section.need("traction")?;
            let (traction, resolved) =
                signals(&field.node, &field.path, Measure::STRESS, dimension, scope)?;
            section.record("traction", resolved);
            let areas = tributary_areas(&section, &selected, &bodies[selected.body])?;
            ConditionKind::Traction { areas, traction }
        }
    };
    let condition = Condition {
        name,
        body: selected.body,
        particles: selected.particles,
        kind,
    };
    Ok((condition, section.finish()))
}

fn read_axes(field: &Field<'_>, dimension: Dimension) -> Result<Vec<usize>, Problem> {
    let nodes = match &field.node.value {
        Value::Array(items) if !items.is_empty() => items.iter().collect(),
        _ => vec![&*field.node],
    };
    let known = &["x", "y", "z"][..dimension.count()];
    nodes
        .into_iter()
        .map(|node| match &node.value {
            Value::Text(text) => known.iter().position(|axis| axis == text).ok_or_else(|| {
                Problem::new(
                    &node.origin,
                    format!("`{}` names the axis `{text}`", field.path),
                )
                .allowed(text, known.iter().copied())
            }),
            other => Err(Problem::new(
                &node.origin,
                format!(
                    "`{}` must be an axis or a list of axes, but is {}",
                    field.path,
                    other.kind()
                ),
            )
            .allowed("", known.iter().copied())),
        })
        .collect()
}

/// Areas of the selected particles on the face the selection names.
fn tributary_areas(
    section: &Section<'_>,
    selected: &Selected,
    body: &ModelBody,
) -> Result<Vec<f64>, Problem> {
    let Some(face) = &selected.face else {
        return Err(section
            .problem(
                "where",
                "a traction or heat flux needs a face, whose areas it acts on",
            )
            .help(format!(
                "where = \"{}.FACE\", or an `and` with a face in it",
                body.name
            )));
    };
    let areas = face_areas(&body.body, face)
        .map_err(|error| section.problem("where", error.to_string()))?;
    let mut found = vec![0.0; selected.particles.len()];
    for share in areas {
        if let Ok(at) = selected.particles.binary_search(&share.node) {
            found[at] += share.area;
        }
    }
    Ok(found)
}
