//! Restart files: the state of a run, bit for bit, with a checksum.

use std::collections::HashSet;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::{OutputError, atomic_write};

const MAGIC: [u8; 8] = *b"JSTSPH\r\n";
const VERSION: u32 = 1;
const CHECKSUM: usize = blake3::OUT_LEN;
/// Restart files kept in a folder: the latest, and one in case the latest is damaged.
const KEPT: usize = 2;

/// A named array of a restart file.
#[derive(Debug, Clone, PartialEq)]
pub struct RestartArray {
    /// Name, unique in the file.
    pub name: String,
    /// Extents; their product is the number of values.
    pub shape: Vec<u64>,
    /// Values, the last extent running fastest.
    pub values: Vec<f64>,
}

/// Everything a run needs to go on as if it had not been stopped.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RestartData {
    /// Scalars, names and whatever else is not an array; floating-point numbers keep every bit as
    /// long as they are finite.
    pub header: serde_json::Value,
    /// The arrays.
    pub arrays: Vec<RestartArray>,
}

impl RestartData {
    /// The array `name`, if there is one.
    pub fn array(&self, name: &str) -> Option<&RestartArray> {
        self.arrays.iter().find(|array| array.name == name)
    }
}

/// Appends the values of some items.
type Append<'a> = dyn Fn(Range<usize>, &mut Vec<f64>) + 'a;

/// An array of a restart file that is written piece by piece, without a copy of all its values.
pub struct RestartPieces<'a> {
    name: String,
    shape: Vec<u64>,
    items: usize,
    width: usize,
    append: Box<Append<'a>>,
}

impl<'a> RestartPieces<'a> {
    /// A list of `items` times `width` values; `append` appends those of a range of items.
    pub fn list(
        name: String,
        items: usize,
        width: usize,
        append: impl Fn(Range<usize>, &mut Vec<f64>) + 'a,
    ) -> Self {
        Self {
            name,
            shape: vec![(items * width) as u64],
            items,
            width,
            append: Box::new(append),
        }
    }
}

impl<'a> From<&'a RestartArray> for RestartPieces<'a> {
    fn from(array: &'a RestartArray) -> Self {
        Self {
            name: array.name.clone(),
            shape: array.shape.clone(),
            items: array.values.len(),
            width: 1,
            append: Box::new(|range, out| out.extend_from_slice(&array.values[range])),
        }
    }
}

/// A restart file that could not be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{} {problem}", path.display())]
pub struct RestartWarning {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub problem: RestartProblem,
}

/// Why a restart file could not be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RestartProblem {
    /// The system refused to read it.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// It does not start like a restart file.
    #[error("is not a restart file")]
    Foreign,
    /// It was written by another version of the format.
    #[error("has format version {found}, this program reads version {VERSION}")]
    Version {
        /// Version found.
        found: u32,
    },
    /// It is incomplete or was changed after it was written.
    #[error("is damaged: its checksum does not match its content")]
    Damaged,
    /// The checksum is right, the content is not that of a restart file.
    #[error("is inconsistent: {what}")]
    Inconsistent {
        /// What does not fit.
        what: &'static str,
    },
}

/// Writes `state-<step>.jstsph` into `folder`, atomically, and returns its path.
///
/// Afterwards the folder holds this file and the latest one before it. Files of later steps stem
/// from a run that was continued from an earlier state; they are removed too.
///
/// Layout, little-endian: 8 bytes `JSTSPH\r\n`, version (u32), length of the header (u64), header (JSON,
/// UTF-8), number of arrays (u64); for each array length of the name (u64), name (UTF-8), rank (u64), extents
/// (u64 each), values (IEEE-754 binary64); last the blake3 checksum (32 bytes) of all bytes before it.
///
/// # Errors
/// [`OutputError::RestartShape`], [`OutputError::DuplicateName`], [`OutputError::Io`].
pub fn write_restart(folder: &Path, step: u64, data: &RestartData) -> Result<PathBuf, OutputError> {
    let path = path_of(folder, step);
    check(data)?;
    let header = encoded(&path, &data.header)?;
    let arrays: Vec<RestartPieces<'_>> = data.arrays.iter().map(RestartPieces::from).collect();
    write_arrays(folder, step, &header, &arrays)
}

/// [`write_restart`] of arrays that are read while they are written.
///
/// # Errors
/// [`OutputError::DuplicateName`], [`OutputError::Json`], [`OutputError::Io`].
pub fn write_restart_pieces(
    folder: &Path,
    step: u64,
    header: &serde_json::Value,
    arrays: &[RestartPieces<'_>],
) -> Result<PathBuf, OutputError> {
    distinct(arrays.iter().map(|array| &array.name))?;
    let header = encoded(&path_of(folder, step), header)?;
    write_arrays(folder, step, &header, arrays)
}

fn path_of(folder: &Path, step: u64) -> PathBuf {
    folder.join(format!("state-{step:012}.jstsph"))
}

fn write_arrays(
    folder: &Path,
    step: u64,
    header: &[u8],
    arrays: &[RestartPieces<'_>],
) -> Result<PathBuf, OutputError> {
    let path = path_of(folder, step);
    atomic_write(&path, |writer| encode(header, arrays, writer))?;
    let states = states(folder)?;
    let kept = states.iter().filter(|(s, _)| *s <= step).take(KEPT);
    let kept: Vec<u64> = kept.map(|(s, _)| *s).collect();
    for (_, path) in states.iter().filter(|(s, _)| !kept.contains(s)) {
        std::fs::remove_file(path).map_err(OutputError::io("remove", path))?;
    }
    Ok(path)
}

/// Reads the latest usable restart file of `folder`, with a warning for each later one that was
/// truncated, changed or is not a restart file.
///
/// # Errors
/// [`OutputError::NoRestart`] with all reasons if none can be used, [`OutputError::Io`].
pub fn read_latest_restart(
    folder: &Path,
) -> Result<(RestartData, Vec<RestartWarning>), OutputError> {
    let mut problems = Vec::new();
    for (_, path) in states(folder)? {
        let result = std::fs::read(&path)
            .map_err(|error| RestartProblem::Unreadable(error.to_string()))
            .and_then(|bytes| decode(&bytes));
        match result {
            Ok(data) => return Ok((data, problems)),
            Err(problem) => problems.push(RestartWarning { path, problem }),
        }
    }
    Err(OutputError::NoRestart {
        path: folder.to_path_buf(),
        problems,
    })
}

/// Path of the restart file that [`read_latest_restart`] would use; `None` if there is none.
#[must_use]
pub fn latest_restart(folder: &Path) -> Option<PathBuf> {
    let usable = |path: &PathBuf| std::fs::read(path).is_ok_and(|bytes| decode(&bytes).is_ok());
    let mut paths = states(folder).ok()?.into_iter().map(|(_, path)| path);
    paths.find(usable)
}

/// Step of a restart file by its name.
pub(crate) fn step_of(name: &str) -> Option<u64> {
    let digits = name.strip_prefix("state-")?.strip_suffix(".jstsph")?;
    let is_number = !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
    is_number.then(|| digits.parse().ok()).flatten()
}

/// Steps and paths of the restart files of a folder, latest first.
fn states(folder: &Path) -> Result<Vec<(u64, PathBuf)>, OutputError> {
    let entries = std::fs::read_dir(folder).map_err(OutputError::io("list", folder))?;
    let mut states = Vec::new();
    for entry in entries {
        let entry = entry.map_err(OutputError::io("list", folder))?;
        if let Some(step) = entry.file_name().to_str().and_then(step_of) {
            states.push((step, entry.path()));
        }
    }
    states.sort_by(|a, b| b.cmp(a));
    Ok(states)
}

/// Checks that the arrays can be read back.
fn check(data: &RestartData) -> Result<(), OutputError> {
    distinct(data.arrays.iter().map(|array| &array.name))?;
    for array in &data.arrays {
        if product(&array.shape) != Some(array.values.len() as u64) {
            return Err(OutputError::RestartShape {
                name: array.name.clone(),
                shape: array.shape.clone(),
                values: array.values.len(),
            });
        }
    }
    Ok(())
}

fn distinct<'a>(names: impl Iterator<Item = &'a String>) -> Result<(), OutputError> {
    let mut known = HashSet::new();
    for name in names {
        if !known.insert(name) {
            return Err(OutputError::DuplicateName { name: name.clone() });
        }
    }
    Ok(())
}

fn encoded(path: &Path, header: &serde_json::Value) -> Result<Vec<u8>, OutputError> {
    serde_json::to_vec(header).map_err(|source| OutputError::Json {
        path: path.to_path_buf(),
        source,
    })
}

/// Writes the file piece by piece: the state of a large run is not held in memory once more.
fn encode(header: &[u8], arrays: &[RestartPieces<'_>], writer: &mut dyn Write) -> io::Result<()> {
    let mut writer = Hashing {
        writer,
        hasher: blake3::Hasher::new(),
    };
    writer.write_all(&MAGIC)?;
    writer.write_all(&VERSION.to_le_bytes())?;
    writer.length(header.len())?;
    writer.write_all(header)?;
    writer.length(arrays.len())?;
    let (mut values, mut piece) = (Vec::new(), Vec::new());
    for array in arrays {
        writer.length(array.name.len())?;
        writer.write_all(array.name.as_bytes())?;
        writer.length(array.shape.len())?;
        for extent in &array.shape {
            writer.write_all(&extent.to_le_bytes())?;
        }
        let step = PIECE / array.width.max(1);
        for start in (0..array.items).step_by(step) {
            values.clear();
            (array.append)(start..array.items.min(start + step), &mut values);
            piece.clear();
            piece.extend(values.iter().flat_map(|value| value.to_le_bytes()));
            writer.write_all(&piece)?;
        }
    }
    let checksum = writer.hasher.finalize();
    writer.writer.write_all(checksum.as_bytes())
}

/// Values that are written at once, at most.
const PIECE: usize = 1 << 14;

/// Writes, and sums up what was written.
struct Hashing<'a> {
    writer: &'a mut dyn Write,
    hasher: blake3::Hasher,
}

impl Hashing<'_> {
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hasher.update(bytes);
        self.writer.write_all(bytes)
    }

    fn length(&mut self, number: usize) -> io::Result<()> {
        self.write_all(&(number as u64).to_le_bytes())
    }
}

fn product(shape: &[u64]) -> Option<u64> {
    shape
        .iter()
        .try_fold(1_u64, |n, &extent| n.checked_mul(extent))
}

fn decode(bytes: &[u8]) -> Result<RestartData, RestartProblem> {
    if !bytes.starts_with(&MAGIC) {
        return Err(RestartProblem::Foreign);
    }
    let end = bytes
        .len()
        .checked_sub(CHECKSUM)
        .ok_or(RestartProblem::Damaged)?;
    let (content, checksum) = bytes.split_at(end);
    if blake3::hash(content).as_bytes() != checksum {
        return Err(RestartProblem::Damaged);
    }
    // The checksum tells that this is what was written; a foreign writer may still have written
    // nonsense, so that every length is checked against what is there.
    let mut reader = Reader(&content[MAGIC.len()..]);
    let version = u32::from_le_bytes(reader.take_array()?);
    if version != VERSION {
        return Err(RestartProblem::Version { found: version });
    }
    let length = reader.number()?;
    let header =
        serde_json::from_slice(reader.take(length)?).map_err(|_| inconsistent("header"))?;
    let count = reader.number()?;
    let mut arrays = Vec::new();
    for _ in 0..count {
        let length = reader.number()?;
        let name = String::from_utf8(reader.take(length)?.to_vec())
            .map_err(|_| inconsistent("name of an array"))?;
        let rank = reader.number()?;
        let mut shape = Vec::new();
        for _ in 0..rank {
            shape.push(reader.number()?);
        }
        let size = product(&shape)
            .and_then(|n| n.checked_mul(8))
            .ok_or(inconsistent("shape of an array"))?;
        let values = reader
            .take(size)?
            .chunks_exact(8)
            .filter_map(|word| word.try_into().ok().map(f64::from_le_bytes))
            .collect();
        arrays.push(RestartArray {
            name,
            shape,
            values,
        });
    }
    if !reader.0.is_empty() {
        return Err(inconsistent("bytes after the last array"));
    }
    Ok(RestartData { header, arrays })
}

fn inconsistent(what: &'static str) -> RestartProblem {
    RestartProblem::Inconsistent { what }
}

/// The bytes not yet read.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, length: u64) -> Result<&'a [u8], RestartProblem> {
        let length = usize::try_from(length).unwrap_or(usize::MAX);
        let (taken, rest) = self
            .0
            .split_at_checked(length)
            .ok_or(inconsistent("a length beyond the end"))?;
        self.0 = rest;
        Ok(taken)
    }

    fn take_array<const N: usize>(&mut self) -> Result<[u8; N], RestartProblem> {
        let (taken, rest) = self
            .0
            .split_first_chunk()
            .ok_or(inconsistent("a number beyond the end"))?;
        self.0 = rest;
        Ok(*taken)
    }

    fn number(&mut self) -> Result<u64, RestartProblem> {
        self.take_array().map(u64::from_le_bytes)
    }
}

#[cfg(test)]
mod tests;
