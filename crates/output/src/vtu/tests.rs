use super::*;
use crate::Values;
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
fn arrays_lie_in_the_order_opposite_to_their_elements() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frame.vtu");
    let positions = [Vec3::zeros(); 9];
    let frame = Frame::new(0.0, 0, &positions)
        .scalar("a", vec![1.0; 9])
        .scalar("b", vec![2.0; 9])
        .vector("c", &positions[..]);
    write_vtu(&path, &frame, FrameOptions::default()).unwrap();
    let reader = Reader::open(&path);
    let offset = |element: &str| -> usize {
        let text = element.split("offset=\"").nth(1).unwrap();
        text.split('"').next().unwrap().parse().unwrap()
    };
    let appended = reader.xml.lines().filter(|l| l.contains("appended"));
    let offsets: Vec<usize> = appended.map(offset).collect();
    assert_eq!((offsets.len(), offsets[6]), (7, 0));
    assert!(offsets.windows(2).all(|o| o[0] > o[1]), "{offsets:?}");
    let names = ["a", "b", "c"].map(|name| reader.xml.find(&format!("Name=\"{name}\"")));
    assert!(names.is_sorted(), "{names:?}");
}

#[test]
fn an_array_of_exactly_one_block_has_no_partial_block() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frame.vtu");
    let particles = BLOCK / 8;
    let frame =
        Frame::new(0.0, 0, vec![Vec3::zeros(); particles]).scalar("a", vec![7.0; particles]);
    write_vtu(&path, &frame, FrameOptions::default()).unwrap();
    let reader = Reader::open(&path);
    // The last of the arrays is the first field.
    let element = reader.element("a").split("offset=\"").nth(1).unwrap();
    let at: usize = element.split('"').next().unwrap().parse().unwrap();
    let header = [at, at + 8, at + 16].map(|at| reader.number(at));
    assert_eq!(header, [1, BLOCK, 0]);
    assert_eq!(reader.doubles("a"), bits(&vec![7.0; particles]));
}

#[test]
fn pieces_written_by_several_threads_give_the_bytes_of_a_slice() {
    let folder = tempfile::tempdir().unwrap();
    let n = 5 * BLOCK / 72 + 77;
    let tensors: Vec<Mat3> = (0..n)
        .map(|i| Mat3::from_fn(|r, c| awkward(i + 3 * r + c)))
        .collect();
    let bytes = |name: &str, threads: usize, values: Values<'_, Mat3>| {
        let path = folder.path().join(name);
        let frame = Frame::new(0.0, 0, vec![Vec3::zeros(); n]).tensor("stress", values);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().unwrap();
        pool.install(|| write_vtu(&path, &frame, FrameOptions::default()))
            .unwrap();
        std::fs::read(path).unwrap()
    };
    let path = folder.path().join("outside");
    let frame = Frame::new(0.0, 0, vec![Vec3::zeros(); n]).tensor("stress", &tensors);
    write_vtu(&path, &frame, FrameOptions::default()).unwrap();
    let expected = std::fs::read(path).unwrap();
    for threads in [1, 3] {
        let pieces = Values::pieces(n, |range, out: &mut Vec<Mat3>| {
            out.extend_from_slice(&tensors[range]);
        });
        assert!(bytes("frame", threads, pieces) == expected, "{threads}");
    }
    // Of several bad values the first is reported, and no file is left.
    let bad = Values::pieces(n, |range, out: &mut Vec<Mat3>| {
        out.extend(range.map(|i| Mat3::identity() * if i < 9000 { 1.0 } else { f64::NAN }));
    });
    let frame = Frame::new(0.0, 0, vec![Vec3::zeros(); n]).tensor("stress", bad);
    let path = folder.path().join("bad");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3);
    let error = pool
        .build()
        .unwrap()
        .install(|| write_vtu(&path, &frame, FrameOptions::default()))
        .unwrap_err();
    assert!(matches!(error, OutputError::NotFinite { index: 9000, .. }));
    assert!(!path.exists());
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
