//! Running the cases of a study, or finding them finished.

use std::collections::HashMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use jstsph_case::Case;
use jstsph_output::{RunRecord, Status, Summary};

use super::findings::{RunFinding, RunStatus};
use super::measure::Results;
use super::study::{Run, Study};
use crate::arguments::{ReproduceOptions, RunOptions};
use crate::console::Console;
use crate::error::CliError;
use crate::simulate;
use crate::templates::CASES;
use crate::verdict::duration;

/// How the runs went and what they wrote.
pub(super) struct Runs {
    pub(super) findings: Vec<RunFinding>,
    pub(super) results: HashMap<String, Results>,
}

/// Makes the runs of a study one after the other; `None` when interrupted.
///
/// # Errors
/// None for a run that fails, which is a finding.
pub(super) fn make(
    study: &Study,
    options: &ReproduceOptions,
    out: &Path,
    command: &[OsString],
    console: &mut Console<'_>,
    interrupted: &AtomicBool,
) -> Option<Runs> {
    let mut runs = Runs {
        findings: Vec::new(),
        results: HashMap::new(),
    };
    let part: Vec<&Run> = study.part(options.quick).collect();
    let count = part.len();
    for (number, run) in part.into_iter().enumerate() {
        let mut job = Job {
            run,
            options,
            folder: out.join("runs").join(&run.id),
            finding: not_run(run, options.quick),
        };
        let heading = format!("[{}/{count}] {}", number + 1, run.id);
        let results = job.execute(&heading, command, console, interrupted);
        if interrupted.load(Ordering::Relaxed) && job.finding.status == RunStatus::NotRun {
            console.error(format_args!(
                "interrupted; finished runs are kept, the same command goes on with the others\n"
            ));
            return None;
        }
        runs.findings.push(job.finding);
        if let Some(results) = results {
            runs.results.insert(run.id.clone(), results);
        }
    }
    Some(runs)
}

fn not_run(run: &Run, is_quick: bool) -> RunFinding {
    RunFinding {
        id: run.id.clone(),
        case: run.case.clone(),
        scheme: run.scheme.clone(),
        settings: run.overrides(is_quick).cloned().unwrap_or_default(),
        status: RunStatus::NotRun,
        note: String::new(),
        particles: 0,
        steps: 0,
        wall_seconds: 0.0,
        version: None,
        commit: None,
    }
}

struct Job<'a> {
    run: &'a Run,
    options: &'a ReproduceOptions,
    folder: PathBuf,
    finding: RunFinding,
}

impl Job<'_> {
    fn execute(
        &mut self,
        heading: &str,
        command: &[OsString],
        console: &mut Console<'_>,
        interrupted: &AtomicBool,
    ) -> Option<Results> {
        let case = match self.case() {
            Ok(case) => case,
            Err(error) => {
                console.error(format_args!("{heading}: {error}\n"));
                return self.fail(error.to_string());
            }
        };
        self.finding.particles = case.particles() as u64;
        if self.is_finished(&case) {
            console.error(format_args!("{heading}: finished earlier\n"));
            return self.collect(case);
        }
        if !self.options.only.is_empty() && !self.options.only.contains(&self.run.id) {
            self.finding.note = "not asked for".to_owned();
            return None;
        }
        console.error(format_args!("{heading}\n"));
        let options = RunOptions {
            case: PathBuf::new(),
            out: Some(self.folder.clone()),
            threads: self.options.threads,
            overrides: Vec::new(),
            no_pictures: true,
            profile: false,
            quiet: false,
            // Results of another version or of other settings make room.
            force: true,
            resume: false,
        };
        // A verdict per run would bury the page's.
        let mut ignored = std::io::sink();
        let mut progress = Console {
            stdout: &mut ignored,
            stderr: &mut *console.stderr,
        };
        match simulate::run_case(&case, &options, command, &mut progress, interrupted) {
            Ok(130) => {
                self.finding.note = "interrupted".to_owned();
                None
            }
            Ok(_) | Err(CliError::Failed { .. }) => {
                let results = self.collect(case);
                console.error(format_args!("      {}\n", self.outcome()));
                results
            }
            Err(error) => {
                console.error(format_args!("      {error}\n"));
                self.fail(error.to_string())
            }
        }
    }

    fn case(&self) -> Result<Case, CliError> {
        let (name, text) = CASES
            .iter()
            .find(|(name, _)| *name == self.run.case)
            .ok_or_else(|| CliError::UnknownName {
                what: "case",
                name: self.run.case.clone(),
                allowed: CASES.iter().map(|(name, _)| (*name).to_owned()).collect(),
            })?;
        let overrides: Vec<(String, String)> = self.finding.settings.clone().into_iter().collect();
        Ok(jstsph_case::parse(
            name,
            &format!("{name}.toml"),
            text,
            &overrides,
        )?)
    }

    /// Whether the folder holds the same case, run to its end by the same program.
    fn is_finished(&self, case: &Case) -> bool {
        let (Ok(record), Ok(summary)) =
            (RunRecord::read(&self.folder), Summary::read(&self.folder))
        else {
            return false;
        };
        let file = self.folder.join("case.toml");
        let Ok(text) = std::fs::read_to_string(&file) else {
            return false;
        };
        let is_same = text == case.resolved
            // Another version may have written fewer keys; what counts is how this one reads them.
            || (self.options.any_version
                && jstsph_case::parse(&case.name, &file.display().to_string(), &text, &[])
                    .is_ok_and(|stored| stored.resolved == case.resolved));
        is_same
            && summary.status != Status::Interrupted
            && record.end_time.is_some()
            && (self.options.any_version || is_ours(&record))
    }

    fn collect(&mut self, case: Case) -> Option<Results> {
        let results = match Results::open(case, &self.folder) {
            Ok(results) => results,
            Err(error) => return self.fail(error.to_string()),
        };
        let summary = &results.summary;
        let record = RunRecord::read(&self.folder).ok();
        let finding = &mut self.finding;
        finding.particles = summary.particles;
        finding.steps = summary.steps;
        finding.wall_seconds = summary.wall_seconds;
        finding.version = Some(summary.version.clone());
        finding.commit = record.as_ref().and_then(|record| record.commit.clone());
        finding.status = if summary.status == Status::Completed {
            RunStatus::Completed
        } else {
            finding.note = record
                .and_then(|record| record.exit_reason)
                .unwrap_or_default();
            RunStatus::Failed
        };
        Some(results)
    }

    fn fail(&mut self, note: String) -> Option<Results> {
        self.finding.status = RunStatus::Failed;
        self.finding.note = note;
        None
    }

    fn outcome(&self) -> String {
        let finding = &self.finding;
        let wall = duration(finding.wall_seconds);
        match finding.status {
            RunStatus::Completed => format!("done in {wall}, {} steps", finding.steps),
            _ => format!("{} (after {wall})", finding.note),
        }
    }
}

/// Whether this very program made a run. Sources that were changed after their commit may have
/// changed again.
fn is_ours(record: &RunRecord) -> bool {
    let commit = option_env!("JSTSPH_COMMIT");
    record.version == env!("CARGO_PKG_VERSION")
        && record.commit.as_deref() == commit
        && commit.is_none_or(|commit| !commit.ends_with("with changes"))
}
