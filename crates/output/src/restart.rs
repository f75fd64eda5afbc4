//! Restart files: the state of a run, bit for bit, with a checksum.

use std::io::{self, Write};
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
    let path = folder.join(format!("state-{step:012}.jstsph"));
    let header = header(&path, data)?;
    atomic_write(&path, |writer| encode(&header, data, writer))?;
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

/// The header, after checking that the arrays can be read back.
fn header(path: &Path, data: &RestartData) -> Result<Vec<u8>, OutputError> {
    for (index, array) in data.arrays.iter().enumerate() {
        if data.arrays[..index].iter().any(|a| a.name == array.name) {
            return Err(OutputError::DuplicateName {
                name: array.name.clone(),
            });
        }
        if product(&array.shape) != Some(array.values.len() as u64) {
            return Err(OutputError::RestartShape {
                name: array.name.clone(),
                shape: array.shape.clone(),
                values: array.values.len(),
            });
        }
    }
    serde_json::to_vec(&data.header).map_err(|source| OutputError::Json {
        path: path.to_path_buf(),
        source,
    })
}

/// Writes the file piece by piece: the state of a large run is not held in memory once more.
fn encode(header: &[u8], data: &RestartData, writer: &mut dyn Write) -> io::Result<()> {
    let mut writer = Hashing {
        writer,
        hasher: blake3::Hasher::new(),
    };
    writer.write_all(&MAGIC)?;
    writer.write_all(&VERSION.to_le_bytes())?;
    writer.length(header.len())?;
    writer.write_all(header)?;
    writer.length(data.arrays.len())?;
    for array in &data.arrays {
        writer.length(array.name.len())?;
        writer.write_all(array.name.as_bytes())?;
        writer.length(array.shape.len())?;
        for extent in &array.shape {
            writer.write_all(&extent.to_le_bytes())?;
        }
        let mut piece = Vec::with_capacity(8 * PIECE.min(array.values.len()));
        for values in array.values.chunks(PIECE) {
            piece.clear();
            piece.extend(values.iter().flat_map(|value| value.to_le_bytes()));
            writer.write_all(&piece)?;
        }
    }
    let checksum = writer.hasher.finalize();
    writer.writer.write_all(checksum.as_bytes())
}

/// Values that are written at once.
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
mod tests {
    use super::*;

    fn bytes_of(data: &RestartData) -> Vec<u8> {
        let mut bytes = Vec::new();
        let header = header(Path::new("a"), data).unwrap();
        encode(&header, data, &mut bytes).unwrap();
        bytes
    }
    use serde_json::json;

    fn sample() -> RestartData {
        RestartData {
            header: json!({ "time": 0.1 + 0.2, "dt": 2.2250738585072e-310, "step": 12 }),
            arrays: vec![
                RestartArray {
                    name: "momentum".to_owned(),
                    shape: vec![2, 3],
                    values: vec![
                        -0.0,
                        5e-324,
                        f64::MAX,
                        f64::NAN,
                        f64::NEG_INFINITY,
                        1.0 / 3.0,
                    ],
                },
                RestartArray {
                    name: "empty".to_owned(),
                    shape: vec![0, 3],
                    values: vec![],
                },
            ],
        }
    }

    fn assert_same_bits(a: &RestartData, b: &RestartData) {
        assert_eq!(a.header, b.header);
        assert_eq!(a.arrays.len(), b.arrays.len());
        for (a, b) in a.arrays.iter().zip(&b.arrays) {
            assert_eq!((&a.name, &a.shape), (&b.name, &b.shape));
            let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&a.values), bits(&b.values));
        }
    }

    fn numbered(step: u64) -> RestartData {
        RestartData {
            header: json!(step),
            arrays: vec![],
        }
    }

    fn steps(folder: &Path) -> Vec<u64> {
        states(folder).unwrap().iter().map(|(s, _)| *s).collect()
    }

    #[test]
    fn every_bit_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = write_restart(folder.path(), 12, &sample()).unwrap();
        assert!(path.ends_with("state-000000000012.jstsph"));
        let (data, warnings) = read_latest_restart(folder.path()).unwrap();
        assert_same_bits(&data, &sample());
        assert!(warnings.is_empty());
        assert_eq!(data.array("momentum").map(|a| a.values.len()), Some(6));
    }

    #[test]
    fn every_flipped_bit_and_every_truncation_is_noticed() {
        let bytes = bytes_of(&sample());
        assert_same_bits(&decode(&bytes).unwrap(), &sample());
        for at in 0..bytes.len() {
            for bit in 0..8 {
                let mut flipped = bytes.clone();
                flipped[at] ^= 1 << bit;
                assert!(decode(&flipped).is_err(), "byte {at}, bit {bit}");
            }
        }
        for length in 0..bytes.len() {
            assert!(decode(&bytes[..length]).is_err(), "length {length}");
        }
        let mut longer = bytes.clone();
        longer.push(0);
        assert!(decode(&longer).is_err());
    }

    #[test]
    fn nonsense_with_a_right_checksum_is_refused_without_panic_or_huge_memory() {
        let bytes = bytes_of(&sample());
        let content = &bytes[..bytes.len() - CHECKSUM];
        // Overwrite each aligned and unaligned word of the content by a huge number.
        for at in MAGIC.len()..content.len() - 8 {
            let mut changed = content.to_vec();
            changed[at..at + 8].copy_from_slice(&u64::MAX.to_le_bytes());
            let checksum = blake3::hash(&changed);
            changed.extend(checksum.as_bytes());
            // Values may become others, which a checksum cannot know; lengths may not.
            let _ = decode(&changed);
        }
        let mut newer = content.to_vec();
        newer[8] = 2;
        let checksum = blake3::hash(&newer);
        newer.extend(checksum.as_bytes());
        assert_eq!(decode(&newer), Err(RestartProblem::Version { found: 2 }));
    }

    #[test]
    fn damaged_and_foreign_files_are_passed_over_with_a_warning() {
        let folder = tempfile::tempdir().unwrap();
        write_restart(folder.path(), 5, &numbered(5)).unwrap();
        let last = write_restart(folder.path(), 6, &numbered(6)).unwrap();
        let bytes = std::fs::read(&last).unwrap();
        std::fs::write(&last, &bytes[..bytes.len() - 3]).unwrap();
        std::fs::write(folder.path().join("state-8.jstsph"), "").unwrap();
        let foreign = folder.path().join("state-7.jstsph");
        std::fs::write(&foreign, "my notes").unwrap();
        std::fs::write(folder.path().join("notes.txt"), "ignored").unwrap();

        let (data, warnings) = read_latest_restart(folder.path()).unwrap();
        assert_eq!(data.header, json!(5));
        let latest = latest_restart(folder.path()).unwrap();
        assert!(latest.ends_with("state-000000000005.jstsph"));
        let problems: Vec<_> = warnings.iter().map(|w| w.problem.clone()).collect();
        let (foreign, damaged) = (RestartProblem::Foreign, RestartProblem::Damaged);
        assert_eq!(problems, [foreign.clone(), foreign, damaged]);
        assert!(
            warnings[1]
                .to_string()
                .ends_with("state-7.jstsph is not a restart file")
        );

        std::fs::remove_file(folder.path().join("state-000000000005.jstsph")).unwrap();
        assert_eq!(latest_restart(folder.path()), None);
        let text = read_latest_restart(folder.path()).unwrap_err().to_string();
        assert!(
            text.contains("not a restart file") && text.contains("checksum"),
            "{text}"
        );
    }

    #[test]
    fn the_two_latest_are_kept_and_an_abandoned_future_is_not() {
        let folder = tempfile::tempdir().unwrap();
        for step in [10, 20, 30, 100] {
            write_restart(folder.path(), step, &numbered(step)).unwrap();
        }
        assert_eq!(steps(folder.path()), [100, 30]);
        // A run continued from step 30 because 100 was damaged.
        write_restart(folder.path(), 40, &numbered(40)).unwrap();
        assert_eq!(steps(folder.path()), [40, 30]);
    }

    #[test]
    fn shapes_and_names_are_checked() {
        let folder = tempfile::tempdir().unwrap();
        let array = RestartArray {
            name: "a".to_owned(),
            shape: vec![2, 2],
            values: vec![1.0; 3],
        };
        let mut data = RestartData {
            header: json!(null),
            arrays: vec![array],
        };
        assert!(matches!(
            write_restart(folder.path(), 0, &data),
            Err(OutputError::RestartShape { values: 3, .. })
        ));
        data.arrays[0].shape = vec![3];
        data.arrays.push(data.arrays[0].clone());
        assert!(matches!(
            write_restart(folder.path(), 0, &data),
            Err(OutputError::DuplicateName { .. })
        ));
        assert!(steps(folder.path()).is_empty());
    }
}
