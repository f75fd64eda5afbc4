//! ParaView frames: VTK unstructured grids, appended raw binary, optionally compressed.

use std::io::{Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;

use crate::OutputError;
use crate::atomic::{TemporaryFile, atomic_file};
use crate::frame::{Frame, Lattice};

#[cfg(test)]
use encoder::BLOCK;
use encoder::Encoder;

mod encoder;

/// Floating-point width of the fields and positions in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// 32 bits: half the size, about seven digits.
    F32,
    /// 64 bits: the simulation's own values, bit for bit.
    #[default]
    F64,
}

impl Precision {
    /// The largest number.
    pub(crate) fn largest(self) -> f64 {
        match self {
            Self::F32 => f64::from(f32::MAX),
            Self::F64 => f64::MAX,
        }
    }
}

/// What the particles are shown as in ParaView.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CellKind {
    /// One vertex per particle: show them with `Point Gaussian` or a glyph.
    #[default]
    Vertices,
    /// The undeformed lattice's quadrilaterals or hexahedra, which deform with the particles.
    Lattice,
}

/// How a frame is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameOptions {
    /// Width of floating-point values.
    pub precision: Precision,
    /// Whether arrays are compressed (zlib, level 1: the fastest).
    pub compression: bool,
    /// Cells joining the particles.
    pub cells: CellKind,
}

impl Default for FrameOptions {
    /// Bit-exact, compressed, one vertex per particle.
    fn default() -> Self {
        Self {
            precision: Precision::F64,
            compression: true,
            cells: CellKind::Vertices,
        }
    }
}

/// Writes one frame as a VTK XML unstructured grid (`.vtu`), atomically.
///
/// Positions are the points, fields are point data (a tensor as nine components row by row,
/// named `XX XY XZ YX ...`), and the field data `TimeValue` (s) and `Step` carry the instant.
/// Arrays are appended as raw binary with 64-bit headers; with [`Precision::F64`] a reader gets
/// every bit back.
///
/// # Errors
/// Those of [`Frame::check`] (a value beyond single precision counts as not finite when that is
/// asked for), [`OutputError::NoLattice`], [`OutputError::Io`]. In each case nothing is written.
///
/// # Cost
/// Arrays are read, compressed and written some blocks of a quarter of a megabyte at a time; on a thread
/// of a rayon pool all its threads do so. The bytes do not depend on it.
pub fn write_vtu(path: &Path, frame: &Frame, options: FrameOptions) -> Result<(), OutputError> {
    frame.check_form()?;
    let cells = CellArrays::new(frame, options.cells)?;
    let failed = OutputError::io("write", path);
    atomic_file(path, |file| {
        // Where the arrays begin is known when they are written; the length of the text does not change.
        let blank = describe(frame, &cells, &mut Encoder::blank(options), options)?;
        file.write_all(&blank).map_err(&failed)?;
        let text = {
            let mut encoder = Encoder::new(options, path, file)?;
            describe(frame, &cells, &mut encoder, options)?
        };
        finish(file, &text).map_err(&failed)
    })
}

/// Ends the file and puts its beginning in place.
fn finish(file: &mut TemporaryFile, text: &[u8]) -> std::io::Result<()> {
    file.write_all(b"\n  </AppendedData>\n</VTKFile>\n")?;
    file.seek(SeekFrom::Start(0))?;
    file.write_all(text)?;
    file.seek(SeekFrom::End(0))?;
    Ok(())
}

/// The text up to the appended data, which the encoder writes on the way.
fn describe(
    frame: &Frame,
    cells: &CellArrays<'_>,
    encoder: &mut Encoder<'_>,
    options: FrameOptions,
) -> Result<Vec<u8>, OutputError> {
    let compressor = if options.compression {
        " compressor=\"vtkZLibDataCompressor\""
    } else {
        ""
    };
    let points = frame.positions.len();
    let elements = Elements::encode(frame, cells, encoder)?;
    let mut xml = String::new();
    let mut line = |text: &str| {
        xml.push_str(text);
        xml.push('\n');
    };
    line("<?xml version=\"1.0\"?>");
    line(&format!(
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"{compressor}>"
    ));
    line("  <UnstructuredGrid>");
    line("    <FieldData>");
    line(&format!(
        "      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{:?}</DataArray>",
        frame.time
    ));
    line(&format!(
        "      <DataArray type=\"Int64\" Name=\"Step\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>",
        frame.step
    ));
    line("    </FieldData>");
    line(&format!(
        "    <Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{}\">",
        cells.count()
    ));
    line("      <PointData>");
    elements.fields.iter().rev().for_each(|field| line(field));
    line("      </PointData>");
    line("      <Points>");
    line(&elements.points);
    line("      </Points>");
    line("      <Cells>");
    elements.cells.iter().rev().for_each(|array| line(array));
    line("      </Cells>");
    line("    </Piece>");
    line("  </UnstructuredGrid>");
    // Readers take the byte right after the underscore as the first of the data.
    xml.push_str("  <AppendedData encoding=\"raw\">\n_");
    Ok(xml.into_bytes())
}

/// The elements that point into the appended data, each group last first.
struct Elements {
    cells: [String; 3],
    points: String,
    fields: Vec<String>,
}

impl Elements {
    /// Appends the arrays in the order opposite to that of their elements in the file.
    ///
    /// VTK does not care. meshio (5.3.5) looks up each array by its offset and then overwrites the
    /// attribute by another number, which may be the offset of a later array: with the arrays in the order
    /// of the elements it exchanges fields of uncompressed files without a word. This way the element that
    /// it looks for always comes before those that it has changed, and it takes the first.
    fn encode(
        frame: &Frame,
        cells: &CellArrays<'_>,
        encoder: &mut Encoder<'_>,
    ) -> Result<Self, OutputError> {
        let cells = [
            encoder.bytes("types", cells.count(), cells.kind())?,
            encoder.integers("offsets", cells.count(), |range| cells.ends(range))?,
            encoder.integers("connectivity", cells.corners(), |range| {
                cells.connectivity(range)
            })?,
        ];
        let points = encoder.floats("Points", &frame.positions)?;
        let mut fields = Vec::new();
        for (name, values) in frame.tensors.iter().rev() {
            fields.push(encoder.floats(name, values)?);
        }
        for (name, values) in frame.vectors.iter().rev() {
            fields.push(encoder.floats(name, values)?);
        }
        for (name, values) in frame.scalars.iter().rev() {
            fields.push(encoder.floats(name, values)?);
        }
        Ok(Self {
            cells,
            points,
            fields,
        })
    }
}

/// Connectivity of the cells in VTK's three arrays, of which only pieces are made.
pub(crate) enum CellArrays<'a> {
    /// As many vertices.
    Vertices(usize),
    Quads(&'a [[u32; 4]]),
    Hexahedra(&'a [[u32; 8]]),
}

impl<'a> CellArrays<'a> {
    pub(crate) fn new(frame: &Frame<'a>, kind: CellKind) -> Result<Self, OutputError> {
        match (kind, frame.lattice) {
            (CellKind::Vertices, _) => Ok(Self::Vertices(frame.positions.len())),
            (CellKind::Lattice, Lattice::Quads(cells)) => Ok(Self::Quads(cells)),
            (CellKind::Lattice, Lattice::Hexahedra(cells)) => Ok(Self::Hexahedra(cells)),
            (CellKind::Lattice, Lattice::None) => Err(OutputError::NoLattice),
        }
    }

    /// The type of every cell, from VTK's file formats documentation.
    pub(crate) fn kind(&self) -> u8 {
        match self {
            Self::Vertices(_) => 1,
            Self::Quads(_) => 9,
            Self::Hexahedra(_) => 12,
        }
    }

    /// Number of cells.
    pub(crate) fn count(&self) -> usize {
        match self {
            Self::Vertices(count) => *count,
            Self::Quads(cells) => cells.len(),
            Self::Hexahedra(cells) => cells.len(),
        }
    }

    /// Corners of a cell.
    fn width(&self) -> usize {
        match self {
            Self::Vertices(_) => 1,
            Self::Quads(_) => 4,
            Self::Hexahedra(_) => 8,
        }
    }

    /// Corners of all cells.
    pub(crate) fn corners(&self) -> usize {
        self.count() * self.width()
    }

    /// Ends of some cells in the connectivity.
    pub(crate) fn ends(&self, cells: Range<usize>) -> Vec<i64> {
        let width = self.width();
        cells.map(|cell| ((cell + 1) * width) as i64).collect()
    }

    /// Some of the corners, cell by cell.
    pub(crate) fn connectivity(&self, corners: Range<usize>) -> Vec<i64> {
        let wide = |points: &[u32]| points.iter().map(|&point| i64::from(point)).collect();
        match self {
            Self::Vertices(_) => corners.map(|point| point as i64).collect(),
            Self::Quads(cells) => wide(&cells.as_flattened()[corners]),
            Self::Hexahedra(cells) => wide(&cells.as_flattened()[corners]),
        }
    }
}

/// Replaces the characters that have a meaning in XML.
pub(crate) fn escape_xml(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            other => escaped.push(other),
        }
    }
    escaped
}

/// Undoes [`escape_xml`].
pub(crate) fn unescape_xml(text: &str) -> String {
    text.replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&quot;", "\"")
        .replace("&amp;", "&")
}

#[cfg(test)]
mod tests;
