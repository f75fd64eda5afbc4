//! Lines of bodies and obstacles from DXF and SVG files.

use std::path::{Path, PathBuf};

use jstsph_geometry::{Contour, DrawingFormat, DrawingOptions, read_drawing};

use crate::error::Problem;
use crate::schema::Limit;
use crate::section::{Field, Section};
use crate::shape::read_lengths;
use crate::stl::UNITS;

/// The lines that a table names, and the file they come from.
pub(crate) struct Drawing {
    pub(crate) contours: Vec<Contour>,
    pub(crate) path: PathBuf,
}

/// Reads the file that a table names; relative paths start at `folder`.
pub(crate) fn read(section: &mut Section<'_>, folder: &Path) -> Result<Drawing, Problem> {
    let field = section.need("file")?;
    let path = folder.join(field.text()?);
    let wrong =
        |reason: String| field.problem(format!("`{}`: {}: {reason}", field.path, path.display()));
    let extension = path.extension().map(|end| end.to_ascii_lowercase());
    let format = match extension.as_ref().and_then(|end| end.to_str()) {
        Some("dxf") => DrawingFormat::Dxf,
        Some("svg") => DrawingFormat::Svg,
        _ => return Err(wrong("the name must end with .dxf or .svg".to_owned())),
    };
    let (unit, metres) = section.need("unit")?.choice(UNITS)?;
    let layer = match section.field("layer")? {
        None => None,
        Some(field) => Some(field.text()?.to_owned()),
    };
    let scale = section.number("scale")?;
    let translation = match section.field("translate")? {
        None => [0.0, 0.0],
        Some(field) => pair(&field)?,
    };
    let tolerance = match section.field("tolerance")? {
        None => None,
        Some(_) => Some(section.number("tolerance")?),
    };
    let bytes = std::fs::read(&path).map_err(|error| wrong(format!("cannot be read: {error}")))?;
    let options = DrawingOptions {
        format,
        layer: layer.as_deref(),
        unit: metres * scale,
        translation,
        tolerance,
    };
    let contours = read_drawing(&bytes, &options).map_err(|error| wrong(error.to_string()))?;
    // A resolved case stands in another folder.
    let absolute = std::fs::canonicalize(&path).unwrap_or_else(|_| path.clone());
    section.record("file", absolute.display().to_string());
    section.record("unit", unit);
    if let Some(layer) = layer {
        section.record("layer", layer);
    }
    if translation != [0.0, 0.0] {
        section.record("translate", translation.to_vec());
    }
    Ok(Drawing { contours, path })
}

/// Two lengths.
pub(crate) fn pair(field: &Field<'_>) -> Result<[f64; 2], Problem> {
    let lengths = read_lengths(field, Limit::Any)?;
    let [x, y] = lengths[..] else {
        return Err(field.problem(format!(
            "`{}` must have 2 entries, but has {}",
            field.path,
            lengths.len()
        )));
    };
    Ok([x, y])
}
