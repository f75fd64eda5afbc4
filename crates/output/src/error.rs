//! The one error type of the crate.

use std::path::{Path, PathBuf};

/// What can go wrong while results are written or read back.
///
/// Every variant names the file or field it is about; input/output errors keep the system's own
/// cause (disk full, permission denied, ...).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The operating system refused an operation on a file or folder.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// What was tried, as a verb: `write`, `read`, `create`, ...
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The system's cause.
        source: std::io::Error,
    },

    /// A result is NaN or infinite, or does not fit the precision asked for; nothing was written.
    #[error(
        "`{field}` is {value} at index {index}: not finite in the precision of the file; nothing was written"
    )]
    NotFinite {
        /// Name of the field or column.
        field: String,
        /// Position of the value in the field (particle), or of the column in the row.
        index: usize,
        /// The value itself.
        value: f64,
    },

    /// A field does not have one entry per particle.
    #[error("field `{field}` has {found} entries, expected {expected}")]
    FieldLength {
        /// Name of the field.
        field: String,
        /// Entries found.
        found: usize,
        /// Entries expected.
        expected: usize,
    },

    /// Two fields of a frame or two columns of a table share a name.
    #[error("the name `{name}` is used twice; names must differ")]
    DuplicateName {
        /// The name.
        name: String,
    },

    /// A cell refers to a point that does not exist.
    #[error("cell {cell} refers to point {point}, but there are only {points} points")]
    CellPoint {
        /// Index of the cell.
        cell: usize,
        /// The point it asks for.
        point: usize,
        /// Number of points.
        points: usize,
    },

    /// Lattice cells were asked for, but the frame carries none.
    #[error("lattice cells were asked for, but this body has no lattice; use vertex cells")]
    NoLattice,

    /// VTKHDF files were asked for of a program that cannot write them.
    #[error(
        "output.format = \"vtkhdf\" needs a program that was built with it: cargo build --release \
         --features vtkhdf"
    )]
    NoVtkhdf,

    /// A table file has a line that cannot be read.
    #[error("{}, line {line}: {problem}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
        /// What is wrong with it.
        problem: TableProblem,
    },

    /// A table has no column of this name.
    #[error("there is no column `{column}`; the columns are {}", columns.join(", "))]
    NoColumn {
        /// The name asked for.
        column: String,
        /// The names there are.
        columns: Vec<String>,
    },

    /// A `.pvd` collection cannot be read.
    #[error("{}, line {line}: not a frame entry written by jstsph; remove the file to start a new collection", path.display())]
    Collection {
        /// The file.
        path: PathBuf,
        /// Line, counted from 1.
        line: usize,
    },

    /// A frame cannot be read.
    #[error("cannot read {}: {problem}", path.display())]
    Frame {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: FrameProblem,
    },

    /// A JSON file cannot be understood.
    #[error("cannot understand {}: {source}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// The parser's message, with line and column.
        source: serde_json::Error,
    },

    /// The results folder is not empty and may not be overwritten.
    #[error("results folder {} is not empty; give --force to replace its results, --resume to continue them, or another folder with --out", path.display())]
    FolderNotEmpty {
        /// The folder.
        path: PathBuf,
    },

    /// Another run writes into the results folder.
    #[error("results folder {} is in use by a run ({holder}); wait for its end, or give another folder with --out", path.display())]
    FolderInUse {
        /// The folder.
        path: PathBuf,
        /// The process and since when.
        holder: String,
    },

    /// No run has written into the folder.
    #[error("no run was ever begun in {}", path.display())]
    NoRun {
        /// The folder.
        path: PathBuf,
    },

    /// A file stands where a folder is needed.
    #[error("{} is not a folder; give another folder with --out", path.display())]
    NotAFolder {
        /// The path.
        path: PathBuf,
    },

    /// A restart array's shape and its number of values disagree.
    #[error(
        "restart array `{name}` has {values} values, its shape {shape:?} asks for another number"
    )]
    RestartShape {
        /// Name of the array.
        name: String,
        /// The shape given.
        shape: Vec<u64>,
        /// Number of values given.
        values: usize,
    },

    /// No restart file of the folder can be used.
    #[error("no usable restart file in {}{}", path.display(), list(problems))]
    NoRestart {
        /// The folder searched.
        path: PathBuf,
        /// Why each candidate was rejected, newest first; empty if there was none.
        problems: Vec<crate::RestartWarning>,
    },

    /// A picture would show nothing.
    #[error("nothing to draw in figure `{title}`: {reason}")]
    NothingToDraw {
        /// Title of the figure.
        title: String,
        /// What is missing.
        reason: &'static str,
    },

    /// A logarithmic axis cannot show zero or negative values.
    #[error(
        "series `{series}` has the value {value} at index {index}, a logarithmic axis needs positive values"
    )]
    NotPositive {
        /// Label of the series.
        series: String,
        /// Index of the point.
        index: usize,
        /// The value.
        value: f64,
    },
}

/// What is wrong with a frame.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FrameProblem {
    /// Something that every frame of ours has is not there.
    #[error("it has no {element}: not a frame written by jstsph")]
    Missing {
        /// What is missing.
        element: String,
    },
    /// The bytes of an array are not what the description says.
    #[error("array `{array}` is cut off or damaged; the file cannot be used")]
    Damaged {
        /// Name of the array.
        array: String,
    },
    /// An array has another number of entries than there are particles.
    #[error("array `{array}` has {found} numbers, expected {expected}")]
    Length {
        /// Name of the array.
        array: String,
        /// Numbers found.
        found: usize,
        /// Numbers expected.
        expected: usize,
    },
    /// An array has a type, or a number of components, that we do not write.
    #[error("array `{array}` has a type that jstsph does not write")]
    Kind {
        /// Name of the array.
        array: String,
    },
}

/// What is wrong with a line of a table.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TableProblem {
    /// The file has no header line.
    #[error("the header line is missing")]
    NoHeader,
    /// The header differs from the columns this run writes.
    #[error(
        "the columns are `{found}`, this run writes `{expected}`; resume with the same case file and version"
    )]
    Header {
        /// Header of the file.
        found: String,
        /// Header this run would write.
        expected: String,
    },
    /// A row has more or fewer entries than the header.
    #[error("{found} entries, the header has {expected}")]
    Entries {
        /// Entries found.
        found: usize,
        /// Entries of the header.
        expected: usize,
    },
    /// An entry is not a number.
    #[error("column `{column}`: `{text}` is not a number")]
    Number {
        /// Name of the column.
        column: String,
        /// The entry.
        text: String,
    },
}

impl OutputError {
    /// Attaches what was tried, and on which path, to a system error.
    pub(crate) fn io(action: &'static str, path: &Path) -> impl Fn(std::io::Error) -> Self {
        move |source| Self::Io {
            action,
            path: path.to_path_buf(),
            source,
        }
    }
}

/// Fails on the first value that is not finite.
pub(crate) fn require_finite(
    field: &str,
    values: impl IntoIterator<Item = f64>,
) -> Result<(), OutputError> {
    match values.into_iter().enumerate().find(|(_, v)| !v.is_finite()) {
        None => Ok(()),
        Some((index, value)) => Err(OutputError::NotFinite {
            field: field.to_owned(),
            index,
            value,
        }),
    }
}

/// Fails unless a field has one entry per particle.
pub(crate) fn require_length(
    field: &str,
    found: usize,
    expected: usize,
) -> Result<(), OutputError> {
    if found == expected {
        return Ok(());
    }
    Err(OutputError::FieldLength {
        field: field.to_owned(),
        found,
        expected,
    })
}

fn list(problems: &[crate::RestartWarning]) -> String {
    if problems.is_empty() {
        return ": there is none".to_owned();
    }
    problems.iter().map(|p| format!("; {p}")).collect()
}
