//! The `shape` of a body: primitives, polygons and combinations of them.

use std::path::Path;

use jstsph_contact::{Chain, Profile, Side, Surface};
use jstsph_geometry::{Axis, Dimension, Polygon, Shape};
use jstsph_tensor::Vec3;

use crate::document::Node;
use crate::drawing;
use crate::error::Problem;
use crate::schema::{self, Limit};
use crate::section::{Field, Section};
use crate::stl::read_stl;
use crate::units::Measure;
use crate::value::{number, vector};

/// Reads the shape of a body; paths of files start at `folder`.
pub(crate) fn read_shape(
    section: &mut Section<'_>,
    dimension: Dimension,
    folder: &Path,
) -> Result<Shape, Problem> {
    let field = section.need("shape")?;
    let (shape, resolved) = read(&field.node, &field.path, dimension, folder)?;
    section.record("shape", resolved);
    Ok(shape)
}

fn read(
    node: &Node,
    path: &str,
    dimension: Dimension,
    folder: &Path,
) -> Result<(Shape, toml::Table), Problem> {
    let mut outer = Section::open(node, path, schema::SHAPES)?;
    let kind = outer.variant()?;
    let inner = outer.need(kind)?;
    let shape = match kind {
        "union" | "intersection" | "difference" => {
            let (parts, resolved) = read_parts(&inner, dimension, folder)?;
            outer.record(kind, resolved);
            match kind {
                "union" => Shape::Union(parts),
                "intersection" => Shape::Intersection(parts),
                _ => Shape::Difference(parts),
            }
        }
        _ => {
            let mut part = Section::open(&inner.node, &inner.path, inner.kind.keys())?;
            let shape = match kind {
                "stl" => Shape::Mesh(read_stl(&mut part, folder)?),
                "drawing" => read_outline(&mut part, folder)?,
                _ => read_primitive(kind, &mut part, dimension)?,
            };
            outer.record(kind, part.finish());
            shape
        }
    };
    shape
        .validate(dimension)
        .map_err(|error| Problem::new(&node.origin, format!("`{path}`: {error}")))?;
    Ok((shape, outer.finish()))
}

fn read_parts(
    field: &Field<'_>,
    dimension: Dimension,
    folder: &Path,
) -> Result<(Vec<Shape>, Vec<toml::Value>), Problem> {
    let (mut parts, mut resolved) = (Vec::new(), Vec::new());
    for (number, node) in field.items()?.into_iter().enumerate() {
        let (shape, table) = read(node, &format!("{}.{number}", field.path), dimension, folder)?;
        parts.push(shape);
        resolved.push(table.into());
    }
    Ok((parts, resolved))
}

fn read_primitive(
    kind: &str,
    part: &mut Section<'_>,
    dimension: Dimension,
) -> Result<Shape, Problem> {
    Ok(match kind {
        "box" => Shape::Box {
            min: part.vector("min", dimension)?,
            max: part.vector("max", dimension)?,
        },
        "disc" => Shape::Disc {
            centre: part.vector("centre", dimension)?,
            radius: part.number("radius")?,
        },
        "sphere" => Shape::Sphere {
            centre: part.vector("centre", dimension)?,
            radius: part.number("radius")?,
        },
        "polygon" => Shape::Polygon(read_polygon(part)?),
        _ => Shape::Cylinder {
            base: part.vector("base", dimension)?,
            axis: part.choice("axis", &[("x", Axis::X), ("y", Axis::Y), ("z", Axis::Z)])?,
            radius: part.number("radius")?,
            height: part.number("height")?,
        },
    })
}

fn read_polygon(part: &mut Section<'_>) -> Result<Polygon, Problem> {
    let field = part.need("points")?;
    let points = read_points(&field)?;
    part.record(
        "points",
        points
            .iter()
            .map(|p| p.to_vec().into())
            .collect::<Vec<toml::Value>>(),
    );
    let corners = match part.field("fillets")? {
        None => points,
        Some(field) => {
            let radii = read_lengths(&field, Limit::NotNegative)?;
            part.record("fillets", radii.clone());
            rounded(&points, &radii)
                .map_err(|error| field.problem(format!("`{}`: {error}", field.path)))?
        }
    };
    let extrusion = read_extrusion(part)?;
    Polygon::new(corners, extrusion)
        .map_err(|error| part.problem("points", format!("`{}`: {error}", part.path())))
}

/// What the lines of a drawing enclose.
fn read_outline(part: &mut Section<'_>, folder: &Path) -> Result<Shape, Problem> {
    let drawing = drawing::read(part, folder)?;
    let extrusion = read_extrusion(part)?;
    Shape::from_contours(&drawing.contours, extrusion).map_err(|error| {
        let path = part.path();
        part.problem(
            "file",
            format!("`{path}`: {}: {error}", drawing.path.display()),
        )
    })
}

fn read_extrusion(part: &mut Section<'_>) -> Result<Option<[f64; 2]>, Problem> {
    let Some(field) = part.field("extrude")? else {
        return Ok(None);
    };
    let ends = drawing::pair(&field)?;
    part.record("extrude", ends.to_vec());
    Ok(Some(ends))
}

/// The corners of a closed outline whose fillets are cut into pieces of 5°.
fn rounded(
    points: &[[f64; 2]],
    radii: &[f64],
) -> Result<Vec<[f64; 2]>, jstsph_contact::ContactError> {
    let chain = Chain::new(points, radii, true, Side::Left)?;
    let surface = Surface::Profile(Profile::new(vec![chain])?);
    let mut corners: Vec<[f64; 2]> = Vec::new();
    for point in surface
        .outline(&[Vec3::zeros(), Vec3::zeros()])
        .into_iter()
        .flatten()
    {
        if corners.last() != Some(&[point.x, point.y]) {
            corners.push([point.x, point.y]);
        }
    }
    if corners.first() == corners.last() {
        corners.pop();
    }
    Ok(corners)
}

/// A list of [x, y].
pub(crate) fn read_points(field: &Field<'_>) -> Result<Vec<[f64; 2]>, Problem> {
    let mut points = Vec::new();
    for (number, item) in field.items()?.into_iter().enumerate() {
        let point = vector(
            item,
            &format!("{}.{number}", field.path),
            Measure::LENGTH,
            Dimension::PlaneStrain,
        )?;
        points.push([point.x, point.y]);
    }
    Ok(points)
}

pub(crate) fn read_lengths(field: &Field<'_>, limit: Limit) -> Result<Vec<f64>, Problem> {
    let items = field.items()?.into_iter().enumerate();
    items
        .map(|(place, node)| {
            let path = format!("{}.{place}", field.path);
            number(node, &path, Measure::LENGTH, limit)
        })
        .collect()
}
