//! ParaView frames: VTK unstructured grids, appended raw binary, optionally compressed.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::ops::Range;
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::frame::{Components, Frame, Lattice, flatten_range};
use crate::{OutputError, atomic_write};

/// Bytes per compressed block: large enough that the block table costs nothing, small enough that
/// a reader need not hold two copies of a large array.
const BLOCK: usize = 1 << 18;

/// Floating-point width of the fields and positions in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Precision {
    /// 32 bits: half the size, about seven digits.
    F32,
    /// 64 bits: the simulation's own values, bit for bit.
    #[default]
    F64,
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
/// The encoded arrays are held in memory until the file is complete.
pub fn write_vtu(path: &Path, frame: &Frame, options: FrameOptions) -> Result<(), OutputError> {
    frame.check_magnitude(match options.precision {
        Precision::F32 => f64::from(f32::MAX),
        Precision::F64 => f64::MAX,
    })?;
    let cells = CellArrays::new(frame, options.cells)?;
    let mut encoder = Encoder::new(options);
    let xml = describe(frame, &cells, &mut encoder).map_err(OutputError::io("encode", path))?;
    atomic_write(path, |writer| {
        writer.write_all(xml.as_bytes())?;
        // Readers take the byte right after the underscore as the first of the data.
        writer.write_all(b"  <AppendedData encoding=\"raw\">\n_")?;
        writer.write_all(&encoder.appended)?;
        writer.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
    })
}

/// The XML part up to the appended data, filling the encoder on the way.
fn describe(frame: &Frame, cells: &CellArrays, encoder: &mut Encoder) -> io::Result<String> {
    let compressor = if encoder.options.compression {
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
        cells.types.len()
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
    Ok(xml)
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
    fn encode(frame: &Frame, cells: &CellArrays, encoder: &mut Encoder) -> io::Result<Self> {
        let cells = [
            encoder.bytes("types", &cells.types)?,
            encoder.integers("offsets", &cells.offsets)?,
            encoder.integers("connectivity", &cells.connectivity)?,
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

/// Connectivity of the cells in VTK's three arrays.
pub(crate) struct CellArrays {
    pub(crate) connectivity: Vec<i64>,
    /// End of each cell in the connectivity.
    pub(crate) offsets: Vec<i64>,
    pub(crate) types: Vec<u8>,
}

impl CellArrays {
    pub(crate) fn new(frame: &Frame, kind: CellKind) -> Result<Self, OutputError> {
        // Cell types of VTK's file formats documentation.
        const VERTEX: u8 = 1;
        const QUAD: u8 = 9;
        const HEXAHEDRON: u8 = 12;
        match (kind, frame.lattice) {
            (CellKind::Vertices, _) => {
                let vertices: Vec<[u32; 1]> =
                    (0..frame.positions.len()).map(|a| [a as u32]).collect();
                Ok(Self::of(&vertices, VERTEX))
            }
            (CellKind::Lattice, Lattice::Quads(cells)) => Ok(Self::of(cells, QUAD)),
            (CellKind::Lattice, Lattice::Hexahedra(cells)) => Ok(Self::of(cells, HEXAHEDRON)),
            (CellKind::Lattice, Lattice::None) => Err(OutputError::NoLattice),
        }
    }

    fn of<const N: usize>(cells: &[[u32; N]], cell_type: u8) -> Self {
        Self {
            connectivity: cells
                .iter()
                .flatten()
                .map(|&point| i64::from(point))
                .collect(),
            offsets: (1..=cells.len()).map(|cell| (cell * N) as i64).collect(),
            types: vec![cell_type; cells.len()],
        }
    }
}

/// Collects the appended data and writes the elements that point into it.
struct Encoder {
    options: FrameOptions,
    appended: Vec<u8>,
}

impl Encoder {
    fn new(options: FrameOptions) -> Self {
        Self {
            options,
            appended: Vec::new(),
        }
    }

    fn floats<T: Components>(&mut self, name: &str, values: &[T]) -> io::Result<String> {
        let (kind, size) = match self.options.precision {
            Precision::F32 => ("Float32", 4),
            Precision::F64 => ("Float64", 8),
        };
        let count = values.len() * T::NAMES.len().max(1);
        let piece = |range: Range<usize>| {
            let numbers = flatten_range(values, range).into_iter();
            if size == 4 {
                numbers.flat_map(|v| (v as f32).to_le_bytes()).collect()
            } else {
                numbers.flat_map(f64::to_le_bytes).collect()
            }
        };
        self.array((kind, name, T::NAMES), (count, size), piece)
    }

    fn integers(&mut self, name: &str, values: &[i64]) -> io::Result<String> {
        let piece = |range: Range<usize>| {
            let numbers = values[range].iter();
            numbers.flat_map(|v| v.to_le_bytes()).collect()
        };
        self.array(("Int64", name, &[]), (values.len(), 8), piece)
    }

    fn bytes(&mut self, name: &str, values: &[u8]) -> io::Result<String> {
        let piece = |range: Range<usize>| values[range].to_vec();
        self.array(("UInt8", name, &[]), (values.len(), 1), piece)
    }

    /// Appends `count` numbers of `size` bytes; `piece` gives the bytes of some of them, so that an
    /// array is never held in memory as a whole beside its values.
    fn array(
        &mut self,
        (kind, name, components): (&str, &str, &[&str]),
        (count, size): (usize, usize),
        piece: impl Fn(Range<usize>) -> Vec<u8>,
    ) -> io::Result<String> {
        let offset = self.appended.len();
        let step = BLOCK / size;
        let blocks = (0..count)
            .step_by(step)
            .map(|start| piece(start..count.min(start + step)));
        if self.options.compression {
            self.append_compressed(count * size, blocks)?;
        } else {
            self.append_number(count * size);
            blocks.for_each(|block| self.appended.extend(block));
        }
        let mut element = format!(
            "        <DataArray type=\"{kind}\" Name=\"{}\"",
            escape_xml(name)
        );
        if !components.is_empty() {
            // Writing to a string cannot fail.
            let _ = write!(element, " NumberOfComponents=\"{}\"", components.len());
            for (i, component) in components.iter().enumerate() {
                let _ = write!(element, " ComponentName{i}=\"{component}\"");
            }
        }
        let _ = write!(element, " format=\"appended\" offset=\"{offset}\"/>");
        Ok(element)
    }

    /// Block table (count, size, size of a last partial block, compressed sizes), then the blocks.
    fn append_compressed(
        &mut self,
        bytes: usize,
        blocks: impl Iterator<Item = Vec<u8>>,
    ) -> io::Result<()> {
        let blocks = blocks
            .map(|block| {
                let mut zlib = ZlibEncoder::new(Vec::new(), Compression::fast());
                zlib.write_all(&block)?;
                zlib.finish()
            })
            .collect::<io::Result<Vec<_>>>()?;
        self.append_number(blocks.len());
        self.append_number(BLOCK);
        self.append_number(bytes % BLOCK);
        for block in &blocks {
            self.append_number(block.len());
        }
        self.appended.extend(blocks.into_iter().flatten());
        Ok(())
    }

    fn append_number(&mut self, number: usize) {
        self.appended
            .extend_from_slice(&(number as u64).to_le_bytes());
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
