//! The appended data of a frame, written block by block.

use std::fmt::Write as _;
use std::io::{self, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;

use super::{FrameOptions, Precision, escape_xml};
use crate::atomic::TemporaryFile;
use crate::frame::{Components, flatten_range};
use crate::{OutputError, Values};

/// Bytes per compressed block: large enough that the block table costs nothing, small enough that
/// a reader need not hold two copies of a large array.
pub(super) const BLOCK: usize = 1 << 18;

/// Digits of the largest offset.
const DIGITS: usize = 20;

/// Where the arrays go.
struct Target<'a> {
    file: &'a mut TemporaryFile,
    path: &'a Path,
    /// Where the appended data begin in the file.
    start: u64,
}

/// Writes the appended data and makes the elements that point into it.
pub(super) struct Encoder<'a> {
    options: FrameOptions,
    target: Option<Target<'a>>,
}

impl<'a> Encoder<'a> {
    /// Makes elements as long as they are going to be, and writes nothing.
    pub(super) fn blank(options: FrameOptions) -> Self {
        Self {
            options,
            target: None,
        }
    }

    /// Appends to a file from where it is.
    pub(super) fn new(
        options: FrameOptions,
        path: &'a Path,
        file: &'a mut TemporaryFile,
    ) -> Result<Self, OutputError> {
        let start = file
            .stream_position()
            .map_err(OutputError::io("write", path))?;
        Ok(Self {
            options,
            target: Some(Target { file, path, start }),
        })
    }

    pub(super) fn floats<T: Components>(
        &mut self,
        name: &str,
        values: &Values<'_, T>,
    ) -> Result<String, OutputError> {
        let precision = self.options.precision;
        let (kind, size) = match precision {
            Precision::F32 => ("Float32", 4),
            Precision::F64 => ("Float64", 8),
        };
        // What users know as a field.
        let field = if name == "Points" { "position" } else { name };
        let count = values.len() * T::NAMES.len().max(1);
        let piece = |range: Range<usize>| {
            let numbers = flatten_range(field, values, range, precision.largest())?;
            let numbers = numbers.into_iter();
            #[expect(clippy::cast_possible_truncation, reason = "asked for, and in range")]
            Ok(match precision {
                Precision::F32 => numbers.flat_map(|v| (v as f32).to_le_bytes()).collect(),
                Precision::F64 => numbers.flat_map(f64::to_le_bytes).collect(),
            })
        };
        self.array((kind, name, T::NAMES), (count, size), piece)
    }

    pub(super) fn integers(
        &mut self,
        name: &str,
        count: usize,
        values: impl Fn(Range<usize>) -> Vec<i64> + Sync,
    ) -> Result<String, OutputError> {
        let piece = |range: Range<usize>| {
            let numbers = values(range).into_iter();
            Ok(numbers.flat_map(i64::to_le_bytes).collect())
        };
        self.array(("Int64", name, &[]), (count, 8), piece)
    }

    /// The same byte `count` times.
    pub(super) fn bytes(
        &mut self,
        name: &str,
        count: usize,
        value: u8,
    ) -> Result<String, OutputError> {
        let piece = |range: Range<usize>| Ok(vec![value; range.len()]);
        self.array(("UInt8", name, &[]), (count, 1), piece)
    }

    /// Appends `count` numbers of `size` bytes; `piece` gives the bytes of some of them, so that an
    /// array is never held in memory as a whole.
    fn array(
        &mut self,
        (kind, name, components): (&str, &str, &[&str]),
        (count, size): (usize, usize),
        piece: impl Fn(Range<usize>) -> Result<Vec<u8>, OutputError> + Sync,
    ) -> Result<String, OutputError> {
        let compression = self.options.compression;
        let offset = match &mut self.target {
            None => 0,
            Some(target) => target.append(compression, (count, size), piece)?,
        };
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
        let offset = format!("\"{offset}\"");
        // As long for any offset.
        let _ = write!(
            element,
            " format=\"appended\" offset={offset:<width$}/>",
            width = DIGITS + 2
        );
        Ok(element)
    }
}

impl Target<'_> {
    /// Appends an array and returns its offset.
    fn append(
        &mut self,
        compression: bool,
        (count, size): (usize, usize),
        piece: impl Fn(Range<usize>) -> Result<Vec<u8>, OutputError> + Sync,
    ) -> Result<u64, OutputError> {
        let path = self.path;
        let failed = OutputError::io("write", path);
        let begin = self.file.stream_position().map_err(&failed)?;
        let step = BLOCK / size;
        let blocks = count.div_ceil(step);
        let bytes = count * size;
        // Block table (count, size, size of a last partial block, compressed sizes), then the blocks; or
        // the size of all.
        let mut table = if compression {
            vec![blocks, BLOCK, bytes % BLOCK]
        } else {
            vec![bytes]
        };
        let entries = table.len() + if compression { blocks } else { 0 };
        self.file
            .write_all(&vec![0; 8 * entries])
            .map_err(&failed)?;
        let block = |k: usize| {
            let bytes = piece(k * step..count.min((k + 1) * step))?;
            if compression {
                compressed(&bytes).map_err(OutputError::io("encode", path))
            } else {
                Ok(bytes)
            }
        };
        // Not in a pool: a thread beside the run, which must not take more than one processor.
        let in_pool = rayon::current_thread_index().is_some();
        let at_once = if in_pool {
            2 * rayon::current_num_threads()
        } else {
            1
        };
        for first in (0..blocks).step_by(at_once) {
            let batch = first..blocks.min(first + at_once);
            let made: Result<Vec<Vec<u8>>, OutputError> = if in_pool {
                // The error of the first block that has one, whoever comes first.
                let made: Vec<_> = batch.into_par_iter().map(block).collect();
                made.into_iter().collect()
            } else {
                batch.map(block).collect()
            };
            for block in made? {
                if compression {
                    table.push(block.len());
                }
                self.file.write_all(&block).map_err(&failed)?;
            }
        }
        self.patch(begin, &table).map_err(&failed)?;
        Ok(begin - self.start)
    }

    /// Writes numbers at a place and goes back to the end.
    fn patch(&mut self, place: u64, numbers: &[usize]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(place))?;
        for number in numbers {
            self.file.write_all(&(*number as u64).to_le_bytes())?;
        }
        self.file.seek(SeekFrom::End(0))?;
        Ok(())
    }
}

fn compressed(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut zlib = ZlibEncoder::new(Vec::new(), Compression::fast());
    zlib.write_all(bytes)?;
    zlib.finish()
}
