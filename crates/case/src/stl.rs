//! Surfaces of triangles from STL files.

use std::path::Path;
use std::sync::Arc;

use jstsph_geometry::{Dimension, TriangleMesh};
use jstsph_tensor::Vec3;

use crate::error::Problem;
use crate::section::Section;

/// Lengths an STL file may be in, m; the format itself has no unit.
pub(crate) const UNITS: &[(&str, f64)] = &[
    ("m", 1.0),
    ("cm", 1e-2),
    ("mm", 1e-3),
    ("um", 1e-6),
    ("in", 0.0254),
];

/// Reads the file that a table names; relative paths start at `folder`.
pub(crate) fn read_stl(
    section: &mut Section<'_>,
    folder: &Path,
) -> Result<Arc<TriangleMesh>, Problem> {
    let field = section.need("file")?;
    let path = folder.join(field.text()?);
    let (unit, metres) = section.need("unit")?.choice(UNITS)?;
    let scale = section.number("scale")?;
    let translation = match section.field("translate")? {
        None => Vec3::zeros(),
        Some(_) => section.vector("translate", Dimension::Solid)?,
    };
    let bytes = std::fs::read(&path).map_err(|error| {
        field.problem(format!(
            "`{}`: cannot read {}: {error}",
            field.path,
            path.display()
        ))
    })?;
    let mesh = TriangleMesh::from_stl(&bytes, metres * scale, &translation)
        .map_err(|error| field.problem(format!("`{}`: {}: {error}", field.path, path.display())))?;
    // A resolved case stands in another folder.
    let absolute = std::fs::canonicalize(&path).unwrap_or(path);
    section.record("file", absolute.display().to_string());
    section.record("unit", unit);
    Ok(Arc::new(mesh))
}
