//! Frames read back from `.vtu` files.

use std::io::Read;
use std::path::Path;

use flate2::read::ZlibDecoder;
use jstsph_tensor::{Mat3, Vec3};

use crate::OutputError;
use crate::error::FrameProblem;
use crate::vtu::unescape_xml;

/// What separates the description of the arrays from their bytes.
const MARKER: &[u8] = b"<AppendedData encoding=\"raw\">\n_";

/// The particles of one instant as they stand in a file, all in SI units.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StoredFrame {
    /// Simulated time, s.
    pub time: f64,
    /// Number of steps done.
    pub step: u64,
    /// Current positions, m.
    pub positions: Vec<Vec3>,
    /// Scalar fields by name, one value per particle.
    pub scalars: Vec<(String, Vec<f64>)>,
    /// Vector fields by name.
    pub vectors: Vec<(String, Vec<Vec3>)>,
    /// Tensor fields by name.
    pub tensors: Vec<(String, Vec<Mat3>)>,
    /// Cells of the undeformed lattice.
    pub cells: StoredCells,
}

/// Cells of a stored frame, by particle.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum StoredCells {
    /// One vertex per particle: the frame knows no lattice.
    #[default]
    None,
    /// Quadrilaterals, corners in order around the cell.
    Quads(Vec<[usize; 4]>),
    /// Hexahedra: corners around the lower face, then those above them.
    Hexahedra(Vec<[usize; 8]>),
}

impl StoredFrame {
    /// Values of a scalar field.
    pub fn scalar(&self, name: &str) -> Option<&[f64]> {
        find(&self.scalars, name)
    }

    /// Values of a vector field.
    pub fn vector(&self, name: &str) -> Option<&[Vec3]> {
        find(&self.vectors, name)
    }

    /// Values of a tensor field.
    pub fn tensor(&self, name: &str) -> Option<&[Mat3]> {
        find(&self.tensors, name)
    }
}

fn find<'a, T>(fields: &'a [(String, Vec<T>)], name: &str) -> Option<&'a [T]> {
    let field = fields.iter().find(|(other, _)| other == name);
    field.map(|(_, values)| values.as_slice())
}

/// Reads a frame that [`write_vtu`](crate::write_vtu) wrote, in either precision, compressed or not.
///
/// With 64-bit precision every bit comes back (test `frames_come_back`).
///
/// # Errors
/// [`OutputError::Io`]; [`OutputError::Frame`] for a file of another program or one that was cut
/// off or changed, with the array it is about.
///
/// # Limits
/// Not a reader of VTK files in general: it knows the layout of our own, line by line.
pub fn read_vtu(path: &Path) -> Result<StoredFrame, OutputError> {
    let bytes = std::fs::read(path).map_err(OutputError::io("read", path))?;
    parse(&bytes).map_err(|problem| OutputError::Frame {
        path: path.to_path_buf(),
        problem,
    })
}

fn parse(bytes: &[u8]) -> Result<StoredFrame, FrameProblem> {
    let missing = |element: &str| FrameProblem::Missing {
        element: element.to_owned(),
    };
    let at = bytes
        .windows(MARKER.len())
        .position(|window| window == MARKER)
        .ok_or_else(|| missing("appended data"))?;
    let xml = std::str::from_utf8(&bytes[..at]).map_err(|_| missing("readable description"))?;
    let file = File {
        xml,
        data: &bytes[at + MARKER.len()..],
        is_compressed: xml.contains("compressor=\"vtkZLibDataCompressor\""),
    };
    let number = |name: &str| {
        let line = file.lines().find(|line| is_named(line, name));
        line.and_then(content).ok_or_else(|| missing(name))
    };
    let mut frame = StoredFrame {
        time: number("TimeValue")?
            .parse()
            .map_err(|_| missing("TimeValue"))?,
        step: number("Step")?.parse().map_err(|_| missing("Step"))?,
        ..StoredFrame::default()
    };
    let points = file
        .lines()
        .find_map(|line| attribute(line, "NumberOfPoints"))
        .and_then(|text| text.parse().ok())
        .ok_or_else(|| missing("NumberOfPoints"))?;
    let mut is_point_data = false;
    for line in file.lines() {
        match line.trim() {
            "<PointData>" => is_point_data = true,
            "</PointData>" => is_point_data = false,
            element if is_point_data => file.read_field(element, points, &mut frame)?,
            _ => {}
        }
    }
    let line = file.named("Points")?;
    frame.positions = vectors(&file.floats(line, points, 3)?);
    frame.cells = file.cells(points)?;
    Ok(frame)
}

/// The two parts of a file.
struct File<'a> {
    xml: &'a str,
    data: &'a [u8],
    is_compressed: bool,
}

impl<'a> File<'a> {
    fn lines(&self) -> impl Iterator<Item = &'a str> {
        self.xml.lines()
    }

    /// The array of this name outside of the point data, where names are free.
    fn named(&self, name: &str) -> Result<&'a str, FrameProblem> {
        let last = self.lines().filter(|line| is_named(line, name)).last();
        last.ok_or_else(|| FrameProblem::Missing {
            element: name.to_owned(),
        })
    }

    fn read_field(
        &self,
        element: &str,
        points: usize,
        frame: &mut StoredFrame,
    ) -> Result<(), FrameProblem> {
        let name = array_name(element);
        match attribute(element, "NumberOfComponents") {
            None => frame.scalars.push((name, self.floats(element, points, 1)?)),
            Some("3") => {
                let flat = self.floats(element, points, 3)?;
                frame.vectors.push((name, vectors(&flat)));
            }
            Some("9") => {
                let flat = self.floats(element, points, 9)?;
                let tensors = flat.chunks_exact(9).map(Mat3::from_row_slice).collect();
                frame.tensors.push((name, tensors));
            }
            Some(_) => return Err(FrameProblem::Kind { array: name }),
        }
        Ok(())
    }

    fn floats(
        &self,
        element: &str,
        points: usize,
        components: usize,
    ) -> Result<Vec<f64>, FrameProblem> {
        let kind = attribute(element, "type");
        let values: Vec<f64> = match kind {
            Some("Float64") => self.words(element)?.map(f64::from_le_bytes).collect(),
            Some("Float32") => self
                .words(element)?
                .map(|word| f64::from(f32::from_le_bytes(word)))
                .collect(),
            _ => {
                return Err(FrameProblem::Kind {
                    array: array_name(element),
                });
            }
        };
        if values.len() != points * components {
            return Err(FrameProblem::Length {
                array: array_name(element),
                found: values.len(),
                expected: points * components,
            });
        }
        Ok(values)
    }

    fn words<const N: usize>(
        &self,
        element: &str,
    ) -> Result<impl Iterator<Item = [u8; N]>, FrameProblem> {
        let bytes = self.bytes(element)?;
        Ok(
            (0..bytes.len() / N)
                .map(move |word| std::array::from_fn(|byte| bytes[word * N + byte])),
        )
    }

    fn cells(&self, points: usize) -> Result<StoredCells, FrameProblem> {
        let kinds = self.bytes(self.named("types")?)?;
        let Some(&kind) = kinds.first() else {
            return Ok(StoredCells::None);
        };
        let connectivity = self.named("connectivity")?;
        let corners: Vec<usize> = self
            .words(connectivity)?
            .map(|word| usize::try_from(i64::from_le_bytes(word)).unwrap_or(usize::MAX))
            .collect();
        let damaged = || FrameProblem::Damaged {
            array: "connectivity".to_owned(),
        };
        if corners.iter().any(|corner| *corner >= points) {
            return Err(damaged());
        }
        // VTK's numbers for vertex, quadrilateral and hexahedron, and their corners.
        let known = [(1, 1), (9, 4), (12, 8)];
        let known = known.iter().find(|(number, _)| *number == kind);
        let Some((_, size)) = known.filter(|_| kinds.iter().all(|other| *other == kind)) else {
            return Err(FrameProblem::Kind {
                array: "types".to_owned(),
            });
        };
        if corners.len() != size * kinds.len() {
            return Err(damaged());
        }
        Ok(match kind {
            9 => StoredCells::Quads(groups(&corners)),
            12 => StoredCells::Hexahedra(groups(&corners)),
            _ => StoredCells::None,
        })
    }

    /// The bytes of an array, decompressed.
    fn bytes(&self, element: &str) -> Result<Vec<u8>, FrameProblem> {
        let offset = attribute(element, "offset").and_then(|text| text.parse().ok());
        let bytes = offset.and_then(|offset| {
            if self.is_compressed {
                self.decompress(offset)
            } else {
                let length = self.number(offset)?;
                Some(self.slice(offset.checked_add(8)?, length)?.to_vec())
            }
        });
        bytes.ok_or_else(|| FrameProblem::Damaged {
            array: array_name(element),
        })
    }

    /// Block table (count, size, size of a last partial block, compressed sizes), then the blocks.
    fn decompress(&self, offset: usize) -> Option<Vec<u8>> {
        let blocks = self.number(offset)?;
        let size = self.number(offset.checked_add(8)?)?;
        let partial = self.number(offset.checked_add(16)?)?;
        let table = offset.checked_add(24)?;
        let mut start = table.checked_add(blocks.checked_mul(8)?)?;
        // A damaged count must not ask for more memory than its table could describe.
        self.slice(table, blocks * 8)?;
        let mut bytes = Vec::new();
        for block in 0..blocks {
            let length = self.number(table + 8 * block)?;
            let is_partial = block + 1 == blocks && partial > 0;
            let expected = if is_partial { partial } else { size };
            let before = bytes.len();
            ZlibDecoder::new(self.slice(start, length)?)
                .take(expected as u64 + 1)
                .read_to_end(&mut bytes)
                .ok()?;
            if bytes.len() - before != expected {
                return None;
            }
            start += length;
        }
        Some(bytes)
    }

    fn number(&self, at: usize) -> Option<usize> {
        let bytes = self.slice(at, 8)?.try_into().ok()?;
        usize::try_from(u64::from_le_bytes(bytes)).ok()
    }

    fn slice(&self, at: usize, length: usize) -> Option<&'a [u8]> {
        self.data.get(at..at.checked_add(length)?)
    }
}

fn vectors(flat: &[f64]) -> Vec<Vec3> {
    flat.chunks_exact(3).map(Vec3::from_column_slice).collect()
}

fn groups<const N: usize>(flat: &[usize]) -> Vec<[usize; N]> {
    flat.chunks_exact(N)
        .map(|group| std::array::from_fn(|i| group[i]))
        .collect()
}

fn is_named(line: &str, name: &str) -> bool {
    line.trim_start().starts_with("<DataArray") && attribute(line, "Name") == Some(name)
}

fn array_name(element: &str) -> String {
    unescape_xml(attribute(element, "Name").unwrap_or("without a name"))
}

/// Value of an attribute of an element on one line.
pub(crate) fn attribute<'a>(line: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = line.split_once(&format!(" {name}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}

/// Text between the tags of an element on one line.
fn content(line: &str) -> Option<&str> {
    let (_, rest) = line.split_once('>')?;
    rest.split_once('<').map(|(text, _)| text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CellKind, Frame, FrameOptions, Lattice, Precision, write_vtu};

    /// Two by two by two particles with a field of each kind.
    struct Sample {
        positions: Vec<Vec3>,
        pressure: Vec<f64>,
        stress: Vec<Mat3>,
    }

    impl Sample {
        fn new() -> Self {
            let positions: Vec<Vec3> = (0..8)
                .map(|i| Vec3::new(f64::from(i % 2), f64::from(i / 2 % 2), f64::from(i / 4)) / 3.0)
                .collect();
            let pressure = (0..8).map(|i| -0.1 * f64::from(i)).collect();
            let stress = (0..8)
                .map(|i| Mat3::from_fn(|r, c| f64::from(i) + 0.1 * r as f64 + 0.01 * c as f64))
                .collect();
            Self {
                positions,
                pressure,
                stress,
            }
        }

        fn frame(&self) -> Frame<'_> {
            Frame::new(0.1 + 0.2, 17, &self.positions[..])
                .scalar("pressure & <more>", &self.pressure[..])
                .vector("Points", &self.positions[..])
                .tensor("cauchy_stress", &self.stress[..])
                .lattice(Lattice::Hexahedra(&[[0, 1, 3, 2, 4, 5, 7, 6]]))
        }

        /// What comes back, in the precision of the file.
        fn stored(&self, cells: StoredCells, round: fn(f64) -> f64) -> StoredFrame {
            let positions: Vec<Vec3> = self.positions.iter().map(|x| x.map(round)).collect();
            StoredFrame {
                time: 0.1 + 0.2,
                step: 17,
                positions: positions.clone(),
                scalars: vec![(
                    "pressure & <more>".to_owned(),
                    self.pressure.iter().copied().map(round).collect(),
                )],
                vectors: vec![("Points".to_owned(), positions)],
                tensors: vec![(
                    "cauchy_stress".to_owned(),
                    self.stress.iter().map(|s| s.map(round)).collect(),
                )],
                cells,
            }
        }
    }

    fn written(frame: &Frame, options: FrameOptions) -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.vtu");
        write_vtu(&path, frame, options).unwrap();
        std::fs::read(path).unwrap()
    }

    #[test]
    fn frames_come_back() {
        let sample = Sample::new();
        for (precision, round) in [
            (Precision::F64, (|v| v) as fn(f64) -> f64),
            (Precision::F32, |v| f64::from(v as f32)),
        ] {
            for compression in [true, false] {
                for cells in [CellKind::Vertices, CellKind::Lattice] {
                    let options = FrameOptions {
                        precision,
                        compression,
                        cells,
                    };
                    let expected = match cells {
                        CellKind::Vertices => StoredCells::None,
                        CellKind::Lattice => StoredCells::Hexahedra(vec![[0, 1, 3, 2, 4, 5, 7, 6]]),
                    };
                    let read = parse(&written(&sample.frame(), options)).unwrap();
                    assert_eq!(read, sample.stored(expected, round), "{options:?}");
                }
            }
        }
    }

    #[test]
    fn arrays_of_several_blocks_come_back() {
        // Points take 24 n bytes, a block 2^18.
        let positions: Vec<Vec3> = (0..23_000)
            .map(|i| Vec3::new(f64::from(i), 1.0 / f64::from(i + 1), -0.0))
            .collect();
        let frame = Frame::new(0.0, 0, &positions);
        let read = parse(&written(&frame, FrameOptions::default())).unwrap();
        assert!(
            read.positions
                .iter()
                .zip(&positions)
                .all(|(a, b)| a.map(f64::to_bits) == b.map(f64::to_bits))
        );
        assert_eq!(read.positions.len(), positions.len());
    }

    #[test]
    fn quadrilaterals_and_fields_are_found_by_name() {
        let sample = Sample::new();
        let quads = [[0_u32, 1, 3, 2], [4, 5, 7, 6]];
        let options = FrameOptions {
            cells: CellKind::Lattice,
            ..FrameOptions::default()
        };
        let frame = sample.frame().lattice(Lattice::Quads(&quads));
        let read = parse(&written(&frame, options)).unwrap();
        let expected = quads.map(|cell| cell.map(|point| point as usize));
        assert_eq!(read.cells, StoredCells::Quads(expected.to_vec()));
        assert_eq!(read.scalar("pressure & <more>"), Some(&sample.pressure[..]));
        assert_eq!(read.tensor("cauchy_stress"), Some(&sample.stress[..]));
        assert_eq!(read.scalar("cauchy_stress"), None);
    }

    #[test]
    fn a_file_that_was_cut_off_or_changed_is_refused_with_the_array() {
        let whole = written(&Sample::new().frame(), FrameOptions::default());
        let end = whole.len() - b"\n  </AppendedData>\n</VTKFile>\n".len();
        // The arrays lie last first: the one at the end is the first field.
        let error = parse(&whole[..end - 1]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "array `pressure & <more>` is cut off or damaged; the file cannot be used"
        );
        for cut in [0, 100, end / 2, end - 40] {
            assert!(parse(&whole[..cut]).is_err(), "{cut}");
        }
        let text = String::from_utf8_lossy(&whole[..2000]).into_owned();
        let at = text.find("NumberOfPoints=\"8\"").unwrap();
        let mut changed = whole.clone();
        changed[at + "NumberOfPoints=\"".len()] = b'9';
        assert_eq!(
            parse(&changed).unwrap_err(),
            FrameProblem::Length {
                array: "pressure & <more>".to_owned(),
                found: 8,
                expected: 9
            }
        );
    }

    #[test]
    fn a_foreign_file_is_refused_with_its_path() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("other.vtu");
        std::fs::write(&path, "<VTKFile type=\"PolyData\"/>").unwrap();
        let error = read_vtu(&path).unwrap_err().to_string();
        assert!(
            error.contains("other.vtu")
                && error.contains("it has no appended data: not a frame written by jstsph"),
            "{error}"
        );
        assert!(matches!(
            read_vtu(&folder.path().join("none.vtu")),
            Err(OutputError::Io { .. })
        ));
    }
}
