//! ParaView frames: VTK unstructured grids, appended raw binary, optionally compressed.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::frame::{Components, Field, Frame, Lattice, flatten};
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
    for field in &frame.scalars {
        line(&encoder.field(field)?);
    }
    for field in &frame.vectors {
        line(&encoder.field(field)?);
    }
    for field in &frame.tensors {
        line(&encoder.field(field)?);
    }
    line("      </PointData>");
    line("      <Points>");
    line(&encoder.floats("Points", frame.positions)?);
    line("      </Points>");
    line("      <Cells>");
    line(&encoder.integers("connectivity", &cells.connectivity)?);
    line(&encoder.integers("offsets", &cells.offsets)?);
    line(&encoder.array("UInt8", "types", &[], &cells.types)?);
    line("      </Cells>");
    line("    </Piece>");
    line("  </UnstructuredGrid>");
    Ok(xml)
}

/// Connectivity of the cells in VTK's three arrays.
struct CellArrays {
    connectivity: Vec<i64>,
    offsets: Vec<i64>,
    types: Vec<u8>,
}

impl CellArrays {
    fn new(frame: &Frame, kind: CellKind) -> Result<Self, OutputError> {
        // Cell types of VTK's file formats documentation.
        const VERTEX: u8 = 1;
        const QUAD: u8 = 9;
        const HEXAHEDRON: u8 = 12;
        match (kind, frame.lattice) {
            (CellKind::Vertices, _) => {
                let vertices: Vec<[usize; 1]> = (0..frame.positions.len()).map(|a| [a]).collect();
                Ok(Self::of(&vertices, VERTEX))
            }
            (CellKind::Lattice, Lattice::Quads(cells)) => Ok(Self::of(cells, QUAD)),
            (CellKind::Lattice, Lattice::Hexahedra(cells)) => Ok(Self::of(cells, HEXAHEDRON)),
            (CellKind::Lattice, Lattice::None) => Err(OutputError::NoLattice),
        }
    }

    fn of<const N: usize>(cells: &[[usize; N]], cell_type: u8) -> Self {
        Self {
            connectivity: cells.iter().flatten().map(|&point| point as i64).collect(),
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

    fn field<T: Components>(&mut self, (name, values): &Field<T>) -> io::Result<String> {
        self.floats(name, values)
    }

    fn floats<T: Components>(&mut self, name: &str, values: &[T]) -> io::Result<String> {
        let flat = flatten(values).into_iter();
        let (kind, bytes): (_, Vec<u8>) = match self.options.precision {
            Precision::F32 => (
                "Float32",
                flat.flat_map(|v| (v as f32).to_le_bytes()).collect(),
            ),
            Precision::F64 => ("Float64", flat.flat_map(f64::to_le_bytes).collect()),
        };
        self.array(kind, name, T::NAMES, &bytes)
    }

    fn integers(&mut self, name: &str, values: &[i64]) -> io::Result<String> {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.array("Int64", name, &[], &bytes)
    }

    fn array(
        &mut self,
        kind: &str,
        name: &str,
        components: &[&str],
        bytes: &[u8],
    ) -> io::Result<String> {
        let offset = self.appended.len();
        if self.options.compression {
            self.append_compressed(bytes)?;
        } else {
            self.append_number(bytes.len());
            self.appended.extend_from_slice(bytes);
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
    fn append_compressed(&mut self, bytes: &[u8]) -> io::Result<()> {
        let blocks = bytes
            .chunks(BLOCK)
            .map(|block| {
                let mut zlib = ZlibEncoder::new(Vec::new(), Compression::fast());
                zlib.write_all(block)?;
                zlib.finish()
            })
            .collect::<io::Result<Vec<_>>>()?;
        self.append_number(blocks.len());
        self.append_number(BLOCK);
        self.append_number(bytes.len() % BLOCK);
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
mod tests {
    use super::*;
    use jstsph_tensor::{Mat3, Vec3};
    use std::io::Read;

    /// A reader of the format by its specification, independent of the writer's code.
    struct Reader {
        xml: String,
        data: Vec<u8>,
    }

    impl Reader {
        fn open(path: &Path) -> Self {
            let bytes = std::fs::read(path).unwrap();
            let marker = b"<AppendedData encoding=\"raw\">\n_";
            let at = bytes
                .windows(marker.len())
                .position(|w| w == marker)
                .unwrap();
            Self {
                xml: String::from_utf8(bytes[..at].to_vec()).unwrap(),
                data: bytes[at + marker.len()..].to_vec(),
            }
        }

        fn element(&self, name: &str) -> &str {
            let key = format!("Name=\"{name}\"");
            self.xml.lines().find(|line| line.contains(&key)).unwrap()
        }

        fn number(&self, at: usize) -> usize {
            u64::from_le_bytes(self.data[at..at + 8].try_into().unwrap()) as usize
        }

        fn bytes(&self, name: &str) -> Vec<u8> {
            let element = self.element(name);
            let offset = element.split("offset=\"").nth(1).unwrap();
            let at: usize = offset.split('"').next().unwrap().parse().unwrap();
            if !self.xml.contains("vtkZLibDataCompressor") {
                let length = self.number(at);
                return self.data[at + 8..at + 8 + length].to_vec();
            }
            let (blocks, full, last) = (self.number(at), self.number(at + 8), self.number(at + 16));
            let mut start = at + 24 + 8 * blocks;
            let mut all = Vec::new();
            for block in 0..blocks {
                let length = self.number(at + 24 + 8 * block);
                let before = all.len();
                flate2::read::ZlibDecoder::new(&self.data[start..start + length])
                    .read_to_end(&mut all)
                    .unwrap();
                let partial = block + 1 == blocks && last > 0;
                assert_eq!(all.len() - before, if partial { last } else { full });
                start += length;
            }
            all
        }

        fn doubles(&self, name: &str) -> Vec<u64> {
            assert!(self.element(name).contains("Float64"));
            let bytes = self.bytes(name);
            let words = bytes.chunks_exact(8);
            words
                .map(|w| u64::from_le_bytes(w.try_into().unwrap()))
                .collect()
        }
    }

    fn bits(values: &[f64]) -> Vec<u64> {
        values.iter().map(|v| v.to_bits()).collect()
    }

    /// Values that lose something in any sloppy conversion.
    fn awkward(i: usize) -> f64 {
        match i % 5 {
            0 => -0.0,
            1 => 5e-324,
            2 => f64::MAX,
            3 => -1.0 / 3.0,
            _ => i as f64 * 1e-7,
        }
    }

    #[test]
    fn every_bit_comes_back_from_a_frame_of_several_blocks() {
        let folder = tempfile::tempdir().unwrap();
        // Points take 24 n bytes: three blocks, the last of them partial.
        let n = 2 * BLOCK / 24 + 1000;
        let positions: Vec<Vec3> = (0..n)
            .map(|i| Vec3::new(awkward(i), awkward(i + 1), awkward(i + 2)))
            .collect();
        let scalar: Vec<f64> = (0..n).map(awkward).collect();
        let tensors: Vec<Mat3> = (0..n)
            .map(|i| Mat3::from_fn(|r, c| awkward(i + 3 * r + c)))
            .collect();
        for compression in [true, false] {
            let path = folder.path().join("frame.vtu");
            let options = FrameOptions {
                compression,
                ..FrameOptions::default()
            };
            let frame = Frame::new(0.1 + 0.2, 7, &positions)
                .scalar("pressure <&>", &scalar[..])
                .vector("velocity", &positions[..])
                .tensor("cauchy_stress", &tensors[..]);
            write_vtu(&path, &frame, options).unwrap();
            let reader = Reader::open(&path);
            let flat: Vec<f64> = positions.iter().flat_map(|x| [x.x, x.y, x.z]).collect();
            assert_eq!(reader.doubles("Points"), bits(&flat));
            assert_eq!(reader.doubles("velocity"), bits(&flat));
            assert_eq!(reader.doubles("pressure &lt;&amp;&gt;"), bits(&scalar));
            let rows: Vec<f64> = tensors
                .iter()
                .flat_map(|t| (0..9).map(|i| t[(i / 3, i % 3)]))
                .collect();
            assert_eq!(reader.doubles("cauchy_stress"), bits(&rows));
            assert!(
                reader
                    .element("cauchy_stress")
                    .contains("ComponentName1=\"XY\"")
            );
            assert!(
                reader
                    .element("TimeValue")
                    .contains(">0.30000000000000004<")
            );
            assert!(reader.element("Step").contains(">7<"));
            assert_eq!(reader.bytes("types"), vec![1; n]);
        }
    }

    #[test]
    fn an_array_of_exactly_one_block_has_no_partial_block() {
        let mut encoder = Encoder::new(FrameOptions::default());
        encoder.append_compressed(&vec![7; BLOCK]).unwrap();
        let header: Vec<u64> = encoder.appended[..24]
            .chunks_exact(8)
            .map(|w| u64::from_le_bytes(w.try_into().unwrap()))
            .collect();
        assert_eq!(header, [1, BLOCK as u64, 0]);
    }

    #[test]
    fn lattice_cells_are_written_when_asked_for() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.vtu");
        let positions = [
            Vec3::zeros(),
            Vec3::x(),
            Vec3::new(1.0, 1.0, 0.0),
            Vec3::y(),
        ];
        let options = FrameOptions {
            cells: CellKind::Lattice,
            ..FrameOptions::default()
        };
        let frame = Frame::new(0.0, 0, &positions);
        assert!(matches!(
            write_vtu(&path, &frame, options),
            Err(OutputError::NoLattice)
        ));
        write_vtu(
            &path,
            &frame.lattice(Lattice::Quads(&[[0, 1, 2, 3]])),
            options,
        )
        .unwrap();
        let reader = Reader::open(&path);
        assert_eq!(reader.bytes("types"), [9]);
        let expected: Vec<u8> = [0_i64, 1, 2, 3]
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        assert_eq!(reader.bytes("connectivity"), expected);
        assert_eq!(reader.bytes("offsets"), 4_i64.to_le_bytes());
    }

    #[test]
    fn nothing_that_is_not_finite_in_the_file_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.vtu");
        let positions = [Vec3::zeros(), Vec3::x()];
        let frame = Frame::new(0.0, 0, &positions).scalar("pressure", vec![0.0, 1e300]);
        let single = FrameOptions {
            precision: Precision::F32,
            ..FrameOptions::default()
        };
        let error = write_vtu(&path, &frame, single).unwrap_err();
        assert!(matches!(error, OutputError::NotFinite { index: 1, .. }));
        assert!(!path.exists());
        write_vtu(&path, &frame, FrameOptions::default()).unwrap();
        let fits = Frame::new(0.0, 0, &positions).scalar("pressure", vec![0.0, 1.5]);
        write_vtu(&path, &fits, single).unwrap();
        let reader = Reader::open(&path);
        let expected: Vec<u8> = [0.0_f32, 1.5]
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        assert_eq!(reader.bytes("pressure"), expected);
    }
}
