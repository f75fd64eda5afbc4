//! Where, when and how a run was made: `run.json`.

use std::path::Path;
use std::time::SystemTime;

use serde::{Deserialize, Serialize};

use crate::json::{read_json, write_json};
use crate::{OutputError, iso8601};

/// File name in the results folder.
pub(crate) const RECORD: &str = "run.json";

/// The computer a run was made on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Host name; empty if unknown.
    pub hostname: String,
    /// Processor model; its architecture if the model is unknown.
    pub cpu: String,
    /// Processors available to this program.
    pub processors: u64,
    /// Operating system and version.
    pub os: String,
}

impl Machine {
    /// Asks the system; what it does not tell stays generic.
    pub fn detect() -> Self {
        let read = |path: &str| std::fs::read_to_string(path).ok();
        let cpu = read("/proc/cpuinfo")
            .and_then(|text| value_after(&text, "model name", ':'))
            .unwrap_or_else(|| std::env::consts::ARCH.to_owned());
        let os = read("/etc/os-release")
            .and_then(|text| value_after(&text, "PRETTY_NAME", '='))
            .unwrap_or_else(|| std::env::consts::OS.to_owned());
        let kernel = read("/proc/sys/kernel/osrelease").unwrap_or_default();
        Self {
            hostname: read("/proc/sys/kernel/hostname")
                .unwrap_or_default()
                .trim()
                .to_owned(),
            cpu,
            processors: std::thread::available_parallelism().map_or(1, |n| n.get() as u64),
            os: format!("{os} {}", kernel.trim()).trim().to_owned(),
        }
    }
}

/// The value of the first line `key <separator> value`, without quotes.
fn value_after(text: &str, key: &str, separator: char) -> Option<String> {
    let line = text.lines().find(|line| line.starts_with(key))?;
    let (_, value) = line.split_once(separator)?;
    Some(value.trim().trim_matches('"').to_owned())
}

/// The record of a run; the fields are written in this order.
///
/// Written once at the start, so that a killed run has a record too, and again at the end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Version of the program.
    pub version: String,
    /// Commit the program was built from, if known.
    pub commit: Option<String>,
    /// The command line, one entry per argument.
    pub command: Vec<String>,
    /// The computer.
    pub machine: Machine,
    /// Threads used.
    pub threads: u64,
    /// Start of the run, ISO 8601 in UTC.
    pub start_time: String,
    /// End of the run, ISO 8601 in UTC; none while it runs or if it was killed.
    pub end_time: Option<String>,
    /// Wall-clock time from start to end, s.
    pub wall_seconds: Option<f64>,
    /// Why the run ended.
    pub exit_reason: Option<String>,
}

impl RunRecord {
    /// A record that starts now, on this computer, of this version.
    pub fn start(commit: Option<String>, command: Vec<String>, threads: u64) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit,
            command,
            machine: Machine::detect(),
            threads,
            start_time: iso8601(SystemTime::now()),
            end_time: None,
            wall_seconds: None,
            exit_reason: None,
        }
    }

    /// Notes that the run ends now, after `wall_seconds`, and why.
    pub fn finish(&mut self, wall_seconds: f64, exit_reason: impl Into<String>) {
        self.end_time = Some(iso8601(SystemTime::now()));
        self.wall_seconds = Some(wall_seconds);
        self.exit_reason = Some(exit_reason.into());
    }

    /// Writes `run.json` into `folder`, atomically.
    ///
    /// # Errors
    /// [`OutputError::Io`].
    pub fn write(&self, folder: &Path) -> Result<(), OutputError> {
        write_json(&folder.join(RECORD), self)
    }

    /// Reads `run.json` of `folder`.
    ///
    /// # Errors
    /// [`OutputError::Io`], [`OutputError::Json`].
    pub fn read(folder: &Path) -> Result<Self, OutputError> {
        read_json(&folder.join(RECORD))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_complete_after_the_end_and_honest_before() {
        let folder = tempfile::tempdir().unwrap();
        let command = vec!["jstsph".to_owned(), "run".to_owned()];
        let mut record = RunRecord::start(None, command, 2);
        record.write(folder.path()).unwrap();
        assert_eq!(RunRecord::read(folder.path()).unwrap().exit_reason, None);
        record.finish(1.5, "end time reached");
        record.write(folder.path()).unwrap();
        let read = RunRecord::read(folder.path()).unwrap();
        assert_eq!(read, record);
        assert!(read.end_time >= Some(read.start_time));
        assert_eq!(read.wall_seconds, Some(1.5));
    }

    #[test]
    fn machine_files_are_understood() {
        let cpuinfo = "processor\t: 0\nmodel name\t: Some CPU: 3 GHz\nmodel name\t: other\n";
        assert_eq!(
            value_after(cpuinfo, "model name", ':').as_deref(),
            Some("Some CPU: 3 GHz")
        );
        assert_eq!(
            value_after("PRETTY_NAME=\"Debian 13\"", "PRETTY_NAME", '=').as_deref(),
            Some("Debian 13")
        );
        assert_eq!(value_after("", "model name", ':'), None);
        assert!(Machine::detect().processors >= 1);
        assert!(!Machine::detect().os.is_empty());
    }
}
