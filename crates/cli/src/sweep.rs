//! `jstsph sweep`: a case for every combination of values, in parallel.

mod table;
mod vary;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use jstsph_case::Case;
use jstsph_output::{RunRecord, Status, Summary};

use crate::arguments::{RunOptions, SweepOptions};
use crate::console::Console;
use crate::error::CliError;
use crate::verdict::duration;
use crate::{plot, simulate};
use table::Row;
use vary::Varied;

/// Reads every case, runs those that are not finished, writes table and plot.
pub(crate) fn run(
    options: &SweepOptions,
    command: &[OsString],
    console: &mut Console<'_>,
    interrupted: &AtomicBool,
) -> Result<u8, CliError> {
    let base = jstsph_case::load(&options.case, &options.overrides)?;
    let varied = options
        .vary
        .iter()
        .map(|entry| Varied::new(entry, &base))
        .collect::<Result<Vec<_>, _>>()?;
    let probes = table::probes(&base);
    let probe = probe(options, &probes)?;
    let out = options
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("results").join(format!("sweep-{}", base.name)));
    // Mistakes in values end the sweep before anything runs.
    let mut jobs: Vec<Job> = Vec::new();
    for combination in vary::combinations(&varied) {
        let mut job = Job::new(options, &varied, combination)?;
        if jobs.iter().any(|other| other.folder == job.folder) {
            job.folder += &format!("-{}", jobs.len() + 1);
        }
        jobs.push(job);
    }

    let rows = execute(&jobs, options, &out, command, console, interrupted);
    std::fs::create_dir_all(&out).map_err(|source| CliError::Unwritable {
        path: out.clone(),
        source,
    })?;
    let csv = out.join("sweep.csv");
    table::write_csv(&csv, &varied, &probes, &rows)?;
    console.print(table::printed(&varied, &probes, &rows));
    console.print(format_args!("wrote {}\n", csv.display()));
    if let Some(probe) = probe
        && let Some(figure) = table::figure(&base, &varied, &probe, &rows)?
    {
        let path = out.join("sweep.png");
        plot::save(&figure, &path)?;
        console.print(format_args!("wrote {}\n", path.display()));
    }
    if interrupted.load(Ordering::Relaxed) {
        console.print(
            "interrupted; finished runs are kept, the same command goes on with the others\n",
        );
        return Ok(130);
    }
    Ok(u8::from(!rows.iter().all(Row::is_completed)))
}

/// The probe to draw: the one asked for, else the first.
fn probe(options: &SweepOptions, probes: &[String]) -> Result<Option<String>, CliError> {
    match &options.probe {
        Some(name) if !probes.contains(name) => Err(CliError::UnknownName {
            what: "probe",
            name: name.clone(),
            allowed: probes.to_vec(),
        }),
        Some(name) => Ok(Some(name.clone())),
        None => Ok(probes.first().cloned()),
    }
}

/// One combination.
struct Job {
    combination: Vec<usize>,
    folder: String,
    case: Case,
}

impl Job {
    fn new(
        options: &SweepOptions,
        varied: &[Varied],
        combination: Vec<usize>,
    ) -> Result<Self, CliError> {
        let mut overrides = options.overrides.clone();
        for (varied, at) in varied.iter().zip(&combination) {
            overrides.push((varied.key.clone(), varied.values[*at].clone()));
        }
        Ok(Self {
            folder: vary::folder_name(varied, &combination),
            case: jstsph_case::load(&options.case, &overrides)?,
            combination,
        })
    }

    fn row(&self, status: &'static str, note: String, summary: Option<Summary>) -> Row {
        Row {
            combination: self.combination.clone(),
            status,
            note,
            folder: self.folder.clone(),
            summary,
        }
    }

    /// The summary of an earlier run of the same case by the same program to its end.
    fn finished(&self, folder: &Path) -> Option<Summary> {
        let text = std::fs::read_to_string(folder.join("case.toml")).ok()?;
        let record = RunRecord::read(folder).ok()?;
        let summary = Summary::read(folder).ok()?;
        let is_ours = record.version == env!("CARGO_PKG_VERSION")
            && record.commit.as_deref() == option_env!("JSTSPH_COMMIT");
        (text == self.case.resolved && is_ours && summary.status == Status::Completed)
            .then_some(summary)
    }

    fn execute(&self, out: &Path, command: &[OsString], interrupted: &AtomicBool) -> Row {
        let folder = out.join(&self.folder);
        if interrupted.load(Ordering::Relaxed) {
            return self.row("not run", "interrupted before".to_owned(), None);
        }
        let options = RunOptions {
            case: PathBuf::new(),
            out: Some(folder.clone()),
            threads: Some(1),
            overrides: Vec::new(),
            no_pictures: true,
            profile: false,
            quiet: true,
            force: true,
            resume: false,
        };
        let (mut out, mut err) = (std::io::sink(), std::io::sink());
        let mut silent = Console {
            stdout: &mut out,
            stderr: &mut err,
        };
        let result = simulate::run_case(&self.case, &options, command, &mut silent, interrupted);
        let summary = Summary::read(&folder).ok();
        match result {
            Ok(130) => self.row("interrupted", "interrupted".to_owned(), summary),
            Ok(_) => self.row("completed", String::new(), summary),
            // The first line says what happened; the others how to go on with a single run.
            Err(error @ CliError::Failed { .. }) => self.row("failed", first_line(&error), summary),
            Err(error) => self.row("failed", first_line(&error), None),
        }
    }
}

fn first_line(error: &CliError) -> String {
    let text = error.to_string();
    text.lines().next().unwrap_or_default().to_owned()
}

/// Runs the jobs on as many threads as asked for; rows in the order of the jobs.
fn execute(
    jobs: &[Job],
    options: &SweepOptions,
    out: &Path,
    command: &[OsString],
    console: &mut Console<'_>,
    interrupted: &AtomicBool,
) -> Vec<Row> {
    let workers = options.jobs.map_or_else(
        || std::thread::available_parallelism().map_or(1, usize::from),
        usize::from,
    );
    let next = AtomicUsize::new(0);
    let rows = Mutex::new(vec![None; jobs.len()]);
    let console = Mutex::new(console);
    let work = || {
        loop {
            let number = next.fetch_add(1, Ordering::SeqCst);
            let Some(job) = jobs.get(number) else {
                return;
            };
            let (row, how) = match job.finished(&out.join(&job.folder)) {
                Some(summary) => (
                    job.row("completed", String::new(), Some(summary)),
                    "finished earlier".to_owned(),
                ),
                None => {
                    let row = job.execute(out, command, interrupted);
                    let wall = row.summary.as_ref().map_or(0.0, |found| found.wall_seconds);
                    let how = match row.note.as_str() {
                        "" => format!("done in {}", duration(wall)),
                        note => note.to_owned(),
                    };
                    (row, how)
                }
            };
            if let Ok(mut console) = console.lock() {
                console.error(format_args!(
                    "[{}/{}] {}: {how}\n",
                    number + 1,
                    jobs.len(),
                    job.folder
                ));
            }
            if let Ok(mut rows) = rows.lock() {
                rows[number] = Some(row);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..workers.min(jobs.len()) {
            scope.spawn(work);
        }
    });
    let rows = rows.into_inner().unwrap_or_default();
    jobs.iter()
        .enumerate()
        .map(|(number, job)| {
            let row = rows.get(number).cloned().flatten();
            row.unwrap_or_else(|| job.row("not run", String::new(), None))
        })
        .collect()
}
