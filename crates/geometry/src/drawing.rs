//! Lines from the files of drawing programs.

mod dxf;
mod join;
mod svg;
mod svg_path;

use crate::{Contour, GeometryError};

/// Part of the diagonal of a drawing that its tolerance is unless given.
const TOLERANCE: f64 = 1e-4;

/// Which format a drawing has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawingFormat {
    /// Drawing exchange format, as text.
    Dxf,
    /// Scalable vector graphics.
    Svg,
}

/// What is taken from a drawing, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawingOptions<'a> {
    /// Format of the file.
    pub format: DrawingFormat,
    /// Only this layer (DXF); only the element with this id or Inkscape label, and what is in it
    /// (SVG).
    pub layer: Option<&'a str>,
    /// Length of one unit of the file, m.
    pub unit: f64,
    /// How far the lines are then moved, m.
    pub translation: [f64; 2],
    /// How far ends of lines may lie apart to be joined, and straight pieces from the curve that
    /// they replace, m; a ten-thousandth of the diagonal of what is taken unless given.
    pub tolerance: Option<f64>,
}

/// The lines of a drawing, ends that lie at the same place joined.
///
/// DXF: `LINE`, `ARC`, `CIRCLE`, `LWPOLYLINE` and `POLYLINE` with their bulges; z is not read. SVG:
/// paths with all their commands, lines, polylines, polygons, rectangles, circles and ellipses, with
/// their transformations; y, which points down in the file, is turned. Arcs of circles stay arcs,
/// other curves become straight pieces. Texts, dimensions, points and hatches are passed over.
///
/// # Errors
/// [`GeometryError::UnreadableDrawing`], [`GeometryError::UnsupportedDrawing`] for splines, inserted
/// blocks and the like, [`GeometryError::UnknownLayer`], [`GeometryError::EmptyDrawing`],
/// [`GeometryError::BranchingContour`], [`GeometryError::NotFinite`].
pub fn read_drawing(
    bytes: &[u8],
    options: &DrawingOptions<'_>,
) -> Result<Vec<Contour>, GeometryError> {
    let tolerance = options.tolerance.map(|metres| metres / options.unit);
    let (lines, tolerance) = match options.format {
        DrawingFormat::Dxf => {
            let lines = dxf::read(bytes, options.layer)?;
            let points = lines.iter().flat_map(Contour::points).copied();
            let tolerance = tolerance.unwrap_or_else(|| TOLERANCE * diagonal(points));
            (lines, tolerance)
        }
        DrawingFormat::Svg => svg::read(bytes, options.layer, tolerance)?,
    };
    if lines.is_empty() {
        return Err(GeometryError::EmptyDrawing);
    }
    let placed = lines
        .into_iter()
        .map(|line| line.placed(options.unit, options.translation))
        .collect();
    join::join(placed, tolerance * options.unit)
}

/// Diagonal of the smallest box around points.
fn diagonal(points: impl Iterator<Item = [f64; 2]>) -> f64 {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in points {
        for axis in 0..2 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    let diagonal = (high[0] - low[0]).hypot(high[1] - low[1]);
    if diagonal.is_finite() { diagonal } else { 0.0 }
}

/// Bulge of an arc that turns by an angle, rad.
fn bulge(turn: f64) -> f64 {
    (0.25 * turn).tan()
}

#[cfg(test)]
mod tests;
