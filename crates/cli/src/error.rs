//! Why the program ends early, and with which exit code.

use std::path::{Path, PathBuf};

use jstsph_case::CaseError;
use jstsph_output::OutputError;

/// Everything that ends the program early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum CliError {
    /// The case file is wrong.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The results folder cannot be used.
    #[error(transparent)]
    Folder(OutputError),
    /// A probe has the name of another column.
    #[error("probe `{name}` has the name of another column of history.csv; give it another name")]
    ProbeName {
        /// The name.
        name: String,
    },
    /// A name that no list or case has.
    #[error("unknown {what} `{name}`\n = allowed: {}{}", allowed.join(", "), suggestion(name, allowed))]
    UnknownName {
        /// What was named.
        what: &'static str,
        /// The name.
        name: String,
        /// Names there are.
        allowed: Vec<String>,
    },
    /// There is nothing to continue.
    #[error("{} has no results to continue: {source}; start without --resume", path.display())]
    NothingToResume {
        /// Results folder.
        path: PathBuf,
        /// Cause.
        source: OutputError,
    },
    /// The saved state belongs to another case.
    #[error("cannot continue the run in {}: {reason}", path.display())]
    ForeignState {
        /// Results folder.
        path: PathBuf,
        /// What does not fit.
        reason: String,
    },
    /// A picture cannot be drawn or written, or results cannot be read for it.
    #[error(transparent)]
    Picture(OutputError),
    /// A picture of a format that we do not write.
    #[error("cannot draw {}: the name of a picture ends with .png or .svg", path.display())]
    PictureFormat {
        /// File asked for.
        path: PathBuf,
    },
    /// An animation of a format that we do not write.
    #[error("cannot draw {}: the name of an animation ends with .gif, .png or .apng", path.display())]
    MovieFormat {
        /// File asked for.
        path: PathBuf,
    },
    /// An animation of several runs.
    #[error("--animate shows one run, but {count} folders are given; animate them one by one")]
    MovieRuns {
        /// Number of folders.
        count: usize,
    },
    /// Another number of names than of runs.
    #[error("{given} of --label for {runs} folders; give one for each, in their order")]
    Labels {
        /// Names given.
        given: usize,
        /// Folders given.
        runs: usize,
    },
    /// A folder that no run has written.
    #[error("{} is not a folder of results: it has no case.toml; give the folder of a run", path.display())]
    NoResults {
        /// Folder.
        path: PathBuf,
    },
    /// A results folder without frames.
    #[error("{} has no frames (frames/frames.pvd); give the folder of a run", path.display())]
    NoFrames {
        /// Folder.
        path: PathBuf,
    },
    /// A frame and the case beside it do not belong together.
    #[error(
        "the frame has {found} particles, but case.toml describes {expected}: they are of different runs"
    )]
    ForeignFrame {
        /// Particles of the frame.
        found: usize,
        /// Particles of the case.
        expected: usize,
    },
    /// A time at which there is nothing to draw.
    #[error(
        "time `{text}`: {reason}\n = there are {count} frames from {first} to {last}; write a time with unit, first or last"
    )]
    BadTime {
        /// What was asked for.
        text: String,
        /// What is wrong with it.
        reason: String,
        /// Number of frames.
        count: usize,
        /// Time of the first frame.
        first: String,
        /// Time of the last frame.
        last: String,
    },
    /// The ends of a colour range have another unit than the field.
    #[error("the range of `{field}` is given as {found}, but the field's unit is {unit}")]
    RangeUnit {
        /// Field.
        field: String,
        /// Dimension of the range.
        found: String,
        /// SI unit of the field.
        unit: String,
    },
    /// A study's data file, or the numbers for it, do not fit.
    #[error("{name}: {reason}")]
    Study {
        /// The study, or the file.
        name: String,
        /// What does not fit.
        reason: String,
    },
    /// The page of a study cannot be written.
    #[error(transparent)]
    Page(OutputError),
    /// A file for other programs cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Unwritable {
        /// File or folder.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// What a sweep varies cannot be varied.
    #[error("--vary {key}={values}: {reason}")]
    Vary {
        /// Dotted key.
        key: String,
        /// Its values as given.
        values: String,
        /// What is wrong.
        reason: String,
    },
    /// Threads cannot be started.
    #[error("cannot start {threads} threads: {reason}; give a smaller number with --threads")]
    Threads {
        /// Number asked for.
        threads: usize,
        /// Cause.
        reason: String,
    },
    /// Results can no longer be written.
    #[error("the run stopped at t = {time:.6e} s: {source}\n = {}", way_on(restart.as_deref()))]
    Writing {
        /// Simulated time, s.
        time: f64,
        /// Cause.
        source: OutputError,
        /// The latest restart file that can be used.
        restart: Option<PathBuf>,
    },
    /// The simulation broke down; the last good state was written.
    #[error("the run failed: {reason}\n = the last good state, t = {time:.6e} s, step {step}, is in {}", path.display())]
    Failed {
        /// What happened.
        reason: String,
        /// Time of the last good state, s.
        time: f64,
        /// Its step.
        step: u64,
        /// Its restart file.
        path: PathBuf,
    },
}

impl CliError {
    /// 2 for wrong input, 1 for a run that failed.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Writing { .. } | Self::Failed { .. } | Self::Page(_) => 1,
            _ => 2,
        }
    }
}

/// What to do when results could not be written.
fn way_on(restart: Option<&Path>) -> String {
    match restart {
        Some(path) => format!(
            "the last good state is {}; when there is room to write, continue with --resume",
            path.display()
        ),
        None => "no state was saved; when there is room to write, start again".to_owned(),
    }
}

fn suggestion(name: &str, allowed: &[String]) -> String {
    match jstsph_case::nearest(name, allowed.iter().map(String::as_str)) {
        Some(near) => format!("\n = did you mean `{near}`?"),
        None => String::new(),
    }
}
