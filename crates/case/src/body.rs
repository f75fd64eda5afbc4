//! `[[body]]`: shape, lattice, material, initial velocity.

use std::path::Path;

use jstsph_geometry::{Body, Dimension, Lattice, Shape, Spacing, build_body};
use jstsph_material::ROOM_TEMPERATURE;
use jstsph_solver::ModelBody;
use jstsph_tensor::Vec3;

use crate::document::{Node, Value};
use crate::error::{Origin, Problem};
use crate::material::Materials;
use crate::schema;
use crate::section::{Field, Section};
use crate::shape::read_shape;
use crate::signal::{Scope, VARIABLES, signal, signals};
use crate::units::Measure;
use crate::value::{components, count, to_integer, vector};

/// Places of a body in the case file, for mistakes that only show later.
#[derive(Clone, Debug)]
pub(crate) struct BodyPlace {
    pub(crate) name: String,
    pub(crate) table: Origin,
    pub(crate) lattice: Origin,
    pub(crate) material: Origin,
    pub(crate) material_name: String,
}

/// What the bodies of a case share.
pub(crate) struct Context<'a> {
    pub(crate) dimension: Dimension,
    pub(crate) materials: &'a Materials,
    /// Folder of the case file.
    pub(crate) folder: &'a Path,
}

/// Reads one body; `others` are the places of those before it.
pub(crate) fn read_body(
    node: &Node,
    number: usize,
    context: &Context<'_>,
    others: &[BodyPlace],
) -> Result<(ModelBody, BodyPlace, toml::Table), Problem> {
    let mut table = Section::open(node, &format!("body.{number}"), schema::BODY)?;
    let name = table.text("name")?;
    check_name(&table, &name)?;
    if others.iter().any(|other| other.name == name) {
        return Err(table.problem("name", format!("two bodies are called `{name}`")));
    }
    table.rename(format!("body.{name}"));
    let section = &mut table;

    let shape = read_shape(section, context.dimension, context.folder)?;
    let (lattice, lattice_origin) = read_lattice(section, &shape, context.dimension)?;
    let body = build_body(shape, lattice, context.dimension)
        .map_err(|error| Problem::new(&lattice_origin, format!("body `{name}`: {error}")))?;
    let material_field = section.need("material")?;
    let material = context.materials.find(&material_field)?;
    section.record("material", material_field.text()?);
    let initial_velocity = read_velocity(section, &body)?;
    let initial_temperature = read_temperature(section, &body)?;
    let body_force = match section.field("body_force")? {
        None => None,
        Some(field) => {
            let scope = Scope {
                variables: &VARIABLES,
                positions: &body.positions,
            };
            let (force, resolved) = signals(
                &field.node,
                &field.path,
                Measure::ACCELERATION,
                body.dimension,
                scope,
            )?;
            section.record("body_force", resolved);
            Some(force)
        }
    };
    let place = BodyPlace {
        name: name.clone(),
        table: node.origin.clone(),
        lattice: lattice_origin,
        material: material_field.origin().clone(),
        material_name: material_field.text()?.to_owned(),
    };
    let model = ModelBody {
        name,
        body: body.into(),
        material,
        initial_velocity,
        initial_temperature,
        body_force,
    };
    Ok((model, place, table.finish()))
}

/// Names stand in paths and column names.
pub(crate) fn check_name(section: &Section<'_>, name: &str) -> Result<(), Problem> {
    let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
    if name.is_empty() || !name.chars().all(allowed) {
        return Err(section
            .problem("name", format!("`{name}` cannot be a name"))
            .help("allowed: letters, digits, `_` and `-`"));
    }
    Ok(())
}

fn read_lattice(
    section: &mut Section<'_>,
    shape: &Shape,
    dimension: Dimension,
) -> Result<(Lattice, Origin), Problem> {
    let field = section.need("lattice")?;
    let mut part = Section::open(&field.node, &field.path, schema::LATTICE)?;
    let kind = part.one_of(schema::FILLINGS)?;
    for (key, with) in [
        ("layers", &["per_radius", "rings"][..]),
        ("per_ring", &["rings"]),
    ] {
        if part.has(key) && !with.contains(&kind) {
            return Err(part.problem(
                key,
                format!(
                    "`{}.{key}` belongs to {}, not to {kind}",
                    field.path,
                    with.join(" and ")
                ),
            ));
        }
    }
    let lattice = match kind {
        "spacing" => Lattice::Cubic {
            spacing: Spacing::Length(part.number("spacing")?),
        },
        "counts" => {
            let counts = read_counts(&part.need("counts")?, dimension)?;
            let shown: Vec<toml::Value> = counts
                .iter()
                .take(dimension.count())
                .map(|n| to_integer(*n))
                .collect();
            part.record("counts", shown);
            Lattice::Cubic {
                spacing: Spacing::Counts(counts),
            }
        }
        "per_radius" => Lattice::Cubic {
            spacing: Spacing::Radial {
                per_radius: part.count("per_radius")?.unwrap_or(1),
                layers: read_layers(&mut part, shape)?,
            },
        },
        _ => Lattice::Rings {
            rings: part.count("rings")?.unwrap_or(1),
            per_ring: part.count("per_ring")?.unwrap_or(8),
            layers: read_layers(&mut part, shape)?,
        },
    };
    section.record("lattice", part.finish());
    Ok((lattice, field.origin().clone()))
}

/// A cylinder needs its layers; a disc has one.
fn read_layers(part: &mut Section<'_>, shape: &Shape) -> Result<usize, Problem> {
    let layers = part.count("layers")?;
    match (layers, shape) {
        (Some(layers), Shape::Cylinder { .. }) => Ok(layers),
        (None, Shape::Cylinder { .. }) => Err(Problem::new(
            part.origin(),
            format!("`layers` is missing in {}", part.path()),
        )
        .help("layers: nodes along the axis of the cylinder, both ends included")),
        (Some(_), _) => Err(part.problem(
            "layers",
            format!("`{}.layers`: a {} has no layers", part.path(), shape.name()),
        )),
        (None, _) => Ok(1),
    }
}

fn read_counts(field: &Field<'_>, dimension: Dimension) -> Result<[usize; 3], Problem> {
    let mut counts = [1; 3];
    for (axis, item) in field.per_axis(dimension)?.into_iter().enumerate() {
        counts[axis] = count(item, &format!("{}.{axis}", field.path), 2)?;
    }
    Ok(counts)
}

fn read_velocity(section: &mut Section<'_>, body: &Body) -> Result<Vec<Vec3>, Problem> {
    let at_rest = vec![Vec3::zeros(); body.positions.len()];
    let Some(field) = section.field("velocity")? else {
        return Ok(at_rest);
    };
    if let Value::Table(_) = field.node.value {
        let mut outer = Section::open(&field.node, &field.path, schema::INITIAL_VELOCITY)?;
        let inner = outer.need("rotation")?;
        let mut rotation = Section::open(&inner.node, &inner.path, schema::ROTATION)?;
        let rate = rotation.number("rate")?;
        let centre = rotation.vector("centre", body.dimension)?;
        let axis = rotation_axis(&mut rotation, body.dimension)?;
        outer.record("rotation", rotation.finish());
        section.record("velocity", outer.finish());
        return Ok(body
            .positions
            .iter()
            .map(|x| (axis * rate).cross(&(x - centre)))
            .collect());
    }
    let scope = Scope {
        variables: &VARIABLES[1..],
        positions: &body.positions,
    };
    let (velocity, resolved) = signals(
        &field.node,
        &field.path,
        Measure::VELOCITY,
        body.dimension,
        scope,
    )?;
    section.record("velocity", resolved);
    let at = |x: &Vec3| Vec3::from_fn(|axis, _| velocity[axis].at(0.0, x));
    Ok(body.positions.iter().map(at).collect())
}

/// Temperature of every particle at time zero; it must be above absolute zero.
fn read_temperature(section: &mut Section<'_>, body: &Body) -> Result<Vec<f64>, Problem> {
    let Some(field) = section.field("temperature")? else {
        section.record("temperature", ROOM_TEMPERATURE);
        return Ok(vec![ROOM_TEMPERATURE; body.positions.len()]);
    };
    let scope = Scope {
        variables: &VARIABLES[1..],
        positions: &body.positions,
    };
    let (temperature, resolved) = signal(&field.node, &field.path, Measure::TEMPERATURE, scope)?;
    section.record("temperature", resolved);
    let found: Vec<f64> = body
        .positions
        .iter()
        .map(|x| temperature.at(0.0, x))
        .collect();
    match found.iter().find(|t| **t <= 0.0) {
        None => Ok(found),
        Some(cold) => Err(field
            .problem(format!(
                "`{}` must be greater than 0 K, but is {cold} K",
                field.path
            ))
            .help("a number without unit is in kelvin; write \"20 degC\" for degrees Celsius")),
    }
}

fn rotation_axis(rotation: &mut Section<'_>, dimension: Dimension) -> Result<Vec3, Problem> {
    let Some(node) = rotation.node("axis") else {
        return match dimension {
            Dimension::PlaneStrain => Ok(Vec3::z()),
            Dimension::Solid => Err(Problem::new(
                rotation.origin(),
                format!("`axis` is missing in {}", rotation.path()),
            )
            .help("axis: direction of the axis of rotation, e.g. [0, 0, 1]")),
        };
    };
    // The axis has three components in plane strain too: it is z there.
    let path = format!("{}.axis", rotation.path());
    let axis = vector(node, &path, Measure::NUMBER, Dimension::Solid)?;
    let Some(unit) = axis.try_normalize(f64::MIN_POSITIVE) else {
        return Err(rotation.problem(
            "axis",
            format!("`{path}` must not be zero: it gives a direction"),
        ));
    };
    if dimension == Dimension::PlaneStrain && (unit.x != 0.0 || unit.y != 0.0) {
        return Err(rotation.problem("axis", format!("`{path}` must be along z in plane strain")));
    }
    rotation.record("axis", components(&axis, Dimension::Solid));
    Ok(unit)
}
