//! `[[probe]]`: numbers read off the running simulation.

mod edge;

use jstsph_geometry::{Dimension, Shape, face_areas};
use jstsph_solver::{EdgePart, ModelBody, Probe, ProbeKind};
use jstsph_tensor::Vec3;

use crate::document::Node;
use crate::error::Problem;
use crate::schema;
use crate::section::Section;
use crate::selection::read_where;
use crate::value::components;

/// Reads one probe; `taken` are the names of those before it.
pub(crate) fn read_probe(
    node: &Node,
    number: usize,
    bodies: &[ModelBody],
    dimension: Dimension,
    taken: &[Probe],
) -> Result<(Probe, toml::Table), Problem> {
    let mut section = Section::open(node, &format!("probe.{number}"), schema::PROBE)?;
    let name = section.text("name")?;
    crate::body::check_name(&section, &name)?;
    if taken.iter().any(|probe| probe.name == name) {
        return Err(section.problem("name", format!("two probes are called `{name}`")));
    }
    section.rename(format!("probe.{name}"));
    let form = section.one_of(schema::PROBE_QUANTITIES)?;
    let field = section.need(form)?;
    let mut part = Section::open(&field.node, &field.path, field.kind.keys())?;
    let kind = match form {
        "extent" => ProbeKind::Extent {
            particles: particles(&mut part, bodies, dimension)?,
            axis: axis(&mut part, dimension)?,
        },
        "radius" => ProbeKind::Radius {
            particles: particles(&mut part, bodies, dimension)?,
            axis: part.choice("axis", AXES)?,
            point: point_or_origin(&mut part, dimension)?,
        },
        "edge_radius" => {
            let axis = part.choice("axis", AXES)?;
            let point = point_or_origin(&mut part, dimension)?;
            let edge = if part.has("radius") {
                cut_edge(&mut part, bodies, dimension, (axis, point))?
            } else {
                edge(&mut part, bodies, dimension)?
            };
            ProbeKind::EdgeRadius { edge, axis, point }
        }
        "statistic" => ProbeKind::Statistic {
            particles: particles(&mut part, bodies, dimension)?,
            field: part.choice("field", schema::FIELDS)?,
            statistic: part.choice("of", schema::STATISTICS)?,
        },
        "point" => ProbeKind::Point {
            position: part.vector("position", dimension)?,
            field: part.choice("field", schema::FIELDS)?,
        },
        _ => ProbeKind::Line {
            from: part.vector("from", dimension)?,
            to: part.vector("to", dimension)?,
            count: part.count("count")?.unwrap_or(2),
            field: part.choice("field", schema::FIELDS)?,
        },
    };
    section.record(form, part.finish());
    Ok((Probe { name, kind }, section.finish()))
}

const AXES: &[(&str, usize)] = &[("x", 0), ("y", 1), ("z", 2)];

/// An axis along which something can be measured: not z in plane strain.
fn axis(part: &mut Section<'_>, dimension: Dimension) -> Result<usize, Problem> {
    part.choice("axis", &AXES[..dimension.count()])
}

fn point_or_origin(part: &mut Section<'_>, dimension: Dimension) -> Result<Vec3, Problem> {
    if part.has("point") {
        return part.vector("point", dimension);
    }
    part.record("point", components(&Vec3::zeros(), dimension));
    Ok(Vec3::zeros())
}

/// Selected particles on the round face of their body, with the way to the true surface.
fn edge(
    part: &mut Section<'_>,
    bodies: &[ModelBody],
    dimension: Dimension,
) -> Result<Vec<EdgePart>, Problem> {
    let selected = read_where(part, bodies, dimension)?;
    let first = first_particle(part, bodies, selected.body)?;
    let body = &bodies[selected.body].body;
    let round = match body.shape {
        Shape::Disc { .. } => "rim",
        _ => "side",
    };
    // A box has no such face.
    let areas = face_areas(body, round).unwrap_or_default();
    let edge: Vec<EdgePart> = areas
        .iter()
        .filter(|area| selected.particles.binary_search(&area.node).is_ok())
        .map(|area| EdgePart {
            particle: first + area.node,
            arm: area.point - body.positions[area.node as usize],
            weight: area.area,
        })
        .collect();
    if edge.is_empty() {
        return Err(part.problem(
            "where",
            "an edge radius needs particles on the rim of a disc or the side of a cylinder, or `radius`",
        ));
    }
    Ok(edge)
}

/// The edge of a body that was cut out of a disc or cylinder around a line.
fn cut_edge(
    part: &mut Section<'_>,
    bodies: &[ModelBody],
    dimension: Dimension,
    (axis, point): (usize, Vec3),
) -> Result<Vec<EdgePart>, Problem> {
    let radius = part.number("radius")?;
    let selected = read_where(part, bodies, dimension)?;
    let first = first_particle(part, bodies, selected.body)?;
    let body = &bodies[selected.body].body;
    let nodes: Vec<(u32, Vec3)> = selected
        .particles
        .iter()
        .map(|&node| (node, body.positions[node as usize]))
        .collect();
    let mut edge = edge::parts(&nodes, body.spacing, axis, &point, radius);
    if edge.is_empty() {
        return Err(part.problem(
            "radius",
            format!(
                "no selected particle lies within one and a half spacings, {:.4e} m, inside of this radius",
                1.5 * body.spacing
            ),
        ));
    }
    for part in &mut edge {
        part.particle += first;
    }
    Ok(edge)
}

/// Index of the first particle of a body in the whole simulation.
fn first_particle(part: &Section<'_>, bodies: &[ModelBody], body: usize) -> Result<u32, Problem> {
    let before: usize = bodies[..body]
        .iter()
        .map(|body| body.body.positions.len())
        .sum();
    u32::try_from(before).map_err(|_| {
        part.problem(
            "where",
            format!(
                "the bodies before this one have {before} particles, more than {}",
                u32::MAX
            ),
        )
    })
}

/// Selected particles as indices into the whole simulation.
fn particles(
    part: &mut Section<'_>,
    bodies: &[ModelBody],
    dimension: Dimension,
) -> Result<Vec<u32>, Problem> {
    let selected = read_where(part, bodies, dimension)?;
    let first = first_particle(part, bodies, selected.body)?;
    Ok(selected.particles.iter().map(|a| a + first).collect())
}
