//! The results folder of a run: who may write there, and what belongs to it.

use std::fs::{self, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::atomic::{atomic_write, is_temporary};
use crate::frames::is_frame_file;
use crate::lock::{FolderLock, LOCK};
use crate::plot::MARK;
use crate::record::RECORD;
use crate::restart::step_of;
use crate::summary::SUMMARY;
use crate::{OutputError, iso8601};

const CASE: &str = "case.toml";
const ORIGINAL: &str = "case.original.toml";
const HISTORY: &str = "history.csv";
const LOG: &str = "run.log";
const FRAMES: &str = "frames";
const RESTART: &str = "restart";

/// The results folder of one run; see the crate's README for the files in it.
///
/// As long as it lives no other process, and no other value in this one, can write there.
#[derive(Debug)]
pub struct ResultsFolder {
    path: PathBuf,
    _lock: FolderLock,
}

impl ResultsFolder {
    /// Name of the report in the folder.
    pub const REPORT: &str = "report.html";

    /// Folder of the copies of files that the case reads.
    pub const INPUTS: &str = "inputs";

    /// Prepares a folder for a new run: creates it with its parents and the folders for frames and
    /// restart files, and tests that files can be written.
    ///
    /// A folder that is not empty is refused without `force`. With `force` the results of an
    /// earlier run are removed: the files that jstsph writes, by name, and pictures that carry its
    /// mark. Nothing else is ever removed, and nothing at all unless a `run.json`, `summary.json` or
    /// `run.log` shows that this is a results folder.
    ///
    /// # Errors
    /// [`OutputError::FolderInUse`] while another run writes there, [`OutputError::FolderNotEmpty`],
    /// [`OutputError::NotAFolder`], [`OutputError::Io`] (for instance without permission to write).
    pub fn create(path: &Path, force: bool) -> Result<Self, OutputError> {
        if path.exists() && !path.is_dir() {
            return Err(OutputError::NotAFolder {
                path: path.to_path_buf(),
            });
        }
        fs::create_dir_all(path).map_err(OutputError::io("create", path))?;
        // Before the lock file is made: a foreign folder that is refused stays as it is.
        if !force && !is_empty(path)? {
            FolderLock::probe(path)?;
            return Err(not_empty(path));
        }
        let lock = FolderLock::acquire(path)?;
        // Another run may have come and gone between the look and the lock.
        if !force && !is_empty(path)? {
            return Err(not_empty(path));
        }
        let folder = Self {
            path: path.to_path_buf(),
            _lock: lock,
        };
        folder.test_writing()?;
        folder.remove_results()?;
        folder.prepare()?;
        Ok(folder)
    }

    /// Opens the folder of an earlier run to continue it; removes nothing but temporary files of a
    /// killed run.
    ///
    /// # Errors
    /// [`OutputError::NotAFolder`]; [`OutputError::NoRun`] for a folder without any trace of a run;
    /// [`OutputError::FolderInUse`] while another run writes there; [`OutputError::Io`].
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        if path.exists() && !path.is_dir() {
            return Err(OutputError::NotAFolder {
                path: path.to_path_buf(),
            });
        }
        if ![LOCK, RECORD, SUMMARY, LOG]
            .iter()
            .any(|name| path.join(name).is_file())
        {
            return Err(OutputError::NoRun {
                path: path.to_path_buf(),
            });
        }
        let folder = Self {
            path: path.to_path_buf(),
            _lock: FolderLock::acquire(path)?,
        };
        folder.test_writing()?;
        folder.prepare()?;
        let inputs = folder.path.join(Self::INPUTS);
        for place in [
            folder.path.clone(),
            folder.frames(),
            folder.restart(),
            inputs,
        ] {
            remove_matching(&place, |name, _| is_temporary(name))?;
        }
        Ok(folder)
    }

    /// The folder itself, where summary and run record go.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Folder of the ParaView frames.
    pub fn frames(&self) -> PathBuf {
        self.path.join(FRAMES)
    }

    /// Folder of the restart files.
    pub fn restart(&self) -> PathBuf {
        self.path.join(RESTART)
    }

    /// The table of the run's history.
    pub fn history(&self) -> PathBuf {
        self.path.join(HISTORY)
    }

    /// The case that was run with every default written out.
    pub fn case(&self) -> PathBuf {
        self.path.join(CASE)
    }

    /// The case that was run as its author wrote it.
    pub fn original_case(&self) -> PathBuf {
        self.path.join(ORIGINAL)
    }

    /// Writes the copy of a file that the case reads, under a name that begins with a number and `-`.
    ///
    /// # Errors
    /// [`OutputError::Io`].
    pub fn write_input(&self, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        debug_assert!(is_input(name), "another name would never be removed");
        let folder = self.path.join(Self::INPUTS);
        fs::create_dir_all(&folder).map_err(OutputError::io("create", &folder))?;
        atomic_write(&folder.join(name), |writer| writer.write_all(bytes))
    }

    /// The report.
    pub fn report(&self) -> PathBuf {
        self.path.join(Self::REPORT)
    }

    /// Appends a message to `run.log`, each of its lines after the time in UTC.
    ///
    /// # Errors
    /// [`OutputError::Io`].
    pub fn log(&self, message: &str) -> Result<(), OutputError> {
        let path = self.path.join(LOG);
        let now = iso8601(SystemTime::now());
        let text: String = message
            .lines()
            .map(|line| format!("{now} {line}\n"))
            .collect();
        OpenOptions::new()
            .create(true)
            .append(true)
            .open(&path)
            .and_then(|mut file| file.write_all(text.as_bytes()))
            .map_err(OutputError::io("append to", &path))
    }

    fn prepare(&self) -> Result<(), OutputError> {
        for folder in [self.frames(), self.restart()] {
            fs::create_dir_all(&folder).map_err(OutputError::io("create", &folder))?;
        }
        Ok(())
    }

    fn test_writing(&self) -> Result<(), OutputError> {
        tempfile::tempfile_in(&self.path)
            .and_then(|mut file| file.write_all(b"test"))
            .map_err(OutputError::io("write into", &self.path))
    }

    fn remove_results(&self) -> Result<(), OutputError> {
        let is_results_folder = [RECORD, SUMMARY, LOG]
            .iter()
            .any(|name| self.path.join(name).is_file());
        if !is_results_folder {
            return Ok(());
        }
        remove_matching(&self.frames(), |name, _| {
            is_frame_file(name) || is_temporary(name)
        })?;
        remove_matching(&self.restart(), |name, _| {
            step_of(name).is_some() || is_temporary(name)
        })?;
        let inputs = self.path.join(Self::INPUTS);
        remove_matching(&inputs, |name, _| is_input(name) || is_temporary(name))?;
        // It stays if something else is in it.
        let _ = fs::remove_dir(&inputs);
        // The marks of a results folder go last: an interrupted removal can be repeated.
        remove_matching(&self.path, |name, path| {
            [HISTORY, CASE, ORIGINAL, Self::REPORT].contains(&name)
                || is_temporary(name)
                || is_picture(name, path)
        })?;
        remove_matching(&self.path, |name, _| [RECORD, SUMMARY, LOG].contains(&name))
    }
}

/// Whether a folder has nothing in it but perhaps the lock file of a run that was refused or killed.
fn is_empty(folder: &Path) -> Result<bool, OutputError> {
    Ok(entries(folder)?.iter().all(|name| name == LOCK))
}

fn not_empty(path: &Path) -> OutputError {
    OutputError::FolderNotEmpty {
        path: path.to_path_buf(),
    }
}

/// Names of a folder's entries; none if it does not exist.
fn entries(folder: &Path) -> Result<Vec<String>, OutputError> {
    let listing = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        other => other.map_err(OutputError::io("list", folder))?,
    };
    listing
        .map(|entry| {
            let entry = entry.map_err(OutputError::io("list", folder))?;
            // A name that is not UTF-8 is not ours; its lossy form is only counted and compared.
            Ok(entry.file_name().to_string_lossy().into_owned())
        })
        .collect()
}

/// Removes the files of a folder that match; a link is removed, not what it points to.
fn remove_matching(
    folder: &Path,
    matches: impl Fn(&str, &Path) -> bool,
) -> Result<(), OutputError> {
    for name in entries(folder)? {
        let path = folder.join(&name);
        if !path.is_dir() && matches(&name, &path) {
            fs::remove_file(&path).map_err(OutputError::io("remove", &path))?;
        }
    }
    Ok(())
}

/// Whether a file is a copy of one that a case reads.
fn is_input(name: &str) -> bool {
    let rest = name.trim_start_matches(|c: char| c.is_ascii_digit());
    rest.len() < name.len() && rest.starts_with('-')
}

/// Whether a file is a picture that [`crate::plot::Figure`] wrote.
fn is_picture(name: &str, path: &Path) -> bool {
    if !name.ends_with(".png") && !name.ends_with(".svg") {
        return false;
    }
    // The mark stands near the beginning in both formats.
    let mut head = Vec::new();
    let read = fs::File::open(path).and_then(|file| file.take(1024).read_to_end(&mut head));
    read.is_ok() && head.windows(MARK.len()).any(|w| w == MARK.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Frame, FrameOptions, FrameSeries, RestartData, Status, Summary, write_restart};
    use jstsph_tensor::Vec3;

    fn run(path: &Path) -> ResultsFolder {
        let folder = ResultsFolder::create(path, false).unwrap();
        folder.log("started\nwith two lines").unwrap();
        Summary::new("a", Status::Completed)
            .write(folder.path())
            .unwrap();
        FrameSeries::create(&folder.frames(), FrameOptions::default())
            .write(&Frame::new(0.0, 0, &[Vec3::zeros()]))
            .unwrap();
        write_restart(&folder.restart(), 3, &RestartData::default()).unwrap();
        for file in [
            folder.history(),
            folder.case(),
            folder.original_case(),
            folder.report(),
        ] {
            fs::write(file, "x").unwrap();
        }
        fs::write(
            folder.path().join("history.svg"),
            format!("<svg><!-- {MARK} -->"),
        )
        .unwrap();
        folder
    }

    #[test]
    fn a_folder_with_anything_in_it_is_refused_and_the_error_tells_the_ways_out() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("foreign.txt"), "x").unwrap();
        let error = ResultsFolder::create(place.path(), false).unwrap_err();
        let text = error.to_string();
        assert!(
            text.contains("--force") && text.contains("--resume"),
            "{text}"
        );
        assert_eq!(entries(place.path()).unwrap(), ["foreign.txt"]);
    }

    #[test]
    fn force_removes_our_files_and_no_others() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("deep").join("results");
        let folder = run(&path);
        let foreign = [
            path.join("photo.png"),
            path.join("notes.txt"),
            folder.frames().join("view.pvsm"),
            folder.restart().join("why.md"),
            path.join(ResultsFolder::INPUTS).join("notes.toml"),
        ];
        folder.write_input("1-steel.toml", b"[material]").unwrap();
        for file in &foreign {
            fs::write(file, "mine").unwrap();
        }
        drop(folder);
        let folder = ResultsFolder::create(&path, true).unwrap();
        assert!(foreign.iter().all(|file| file.exists()));
        let mut left = entries(&path).unwrap();
        left.sort();
        assert_eq!(
            left,
            [
                "frames",
                "inputs",
                "notes.txt",
                "photo.png",
                "restart",
                "run.lock"
            ]
        );
        assert_eq!(entries(&path.join("inputs")).unwrap(), ["notes.toml"]);
        assert_eq!(entries(&folder.frames()).unwrap(), ["view.pvsm"]);
        assert_eq!(entries(&folder.restart()).unwrap(), ["why.md"]);
    }

    #[test]
    fn force_removes_nothing_from_a_folder_that_never_held_results() {
        let place = tempfile::tempdir().unwrap();
        let case = place.path().join(CASE);
        fs::write(&case, "my only copy").unwrap();
        ResultsFolder::create(place.path(), true).unwrap();
        assert_eq!(fs::read_to_string(case).unwrap(), "my only copy");
    }

    #[test]
    fn resuming_removes_only_what_a_killed_run_left_half_written() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("results");
        let folder = run(&path);
        let before = entries(&path).unwrap().len();
        let torn = folder.frames().join(".jstsph-abc.tmp");
        fs::write(&torn, "half").unwrap();
        drop(folder);
        assert_eq!(ResultsFolder::open(&path).unwrap().path(), path);
        assert!(!torn.exists());
        assert_eq!(entries(&path).unwrap().len(), before);
        let missing = ResultsFolder::open(&place.path().join("missing")).unwrap_err();
        assert!(missing.to_string().contains("missing"), "{missing}");
        // A folder that holds something else stays as it is.
        let foreign = place.path().join("foreign");
        fs::create_dir(&foreign).unwrap();
        assert!(matches!(
            ResultsFolder::open(&foreign),
            Err(OutputError::NoRun { .. })
        ));
        assert!(entries(&foreign).unwrap().is_empty());
    }

    #[test]
    fn a_folder_in_use_is_refused_in_every_way_and_left_alone() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("results");
        let first = run(&path);
        for result in [
            ResultsFolder::create(&path, false),
            ResultsFolder::create(&path, true),
            ResultsFolder::open(&path),
        ] {
            assert!(matches!(result, Err(OutputError::FolderInUse { .. })));
        }
        assert!(first.history().exists());
        drop(first);
        assert!(matches!(
            ResultsFolder::create(&path, false),
            Err(OutputError::FolderNotEmpty { .. })
        ));
        ResultsFolder::open(&path).unwrap();
    }

    #[test]
    fn a_file_in_the_place_of_the_folder_is_an_error() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("results");
        fs::write(&file, "x").unwrap();
        for result in [
            ResultsFolder::create(&file, true),
            ResultsFolder::open(&file),
        ] {
            assert!(matches!(result, Err(OutputError::NotAFolder { .. })));
        }
    }

    #[test]
    fn every_line_of_the_log_has_a_time() {
        let place = tempfile::tempdir().unwrap();
        let folder = run(&place.path().join("results"));
        folder.log("again").unwrap();
        let text = fs::read_to_string(folder.path().join(LOG)).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(
            lines.iter().all(|line| line.as_bytes()[19] == b'Z'),
            "{text}"
        );
        assert!(lines[2].ends_with("Z again"));
    }
}
