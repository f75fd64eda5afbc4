//! `jstsph run`.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use jstsph_case::{Case, FrameFormat};
use jstsph_geometry::inverted_cells;
use jstsph_output::{
    HAS_VTKHDF, OutputError, ResultsFolder, RunRecord, Status, Summary, latest_restart,
    read_latest_restart,
};
use jstsph_solver::{Quadrature, Simulation};
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::arguments::RunOptions;
use crate::console::Console;
use crate::copies;
use crate::error::CliError;
use crate::plot;
use crate::profile::Profile;
use crate::progress::Progress;
use crate::recorder::{Recorder, energies, extra_columns, extremes, probe_values};
use crate::restart::{LastRow, decode};
use crate::stability::{self, Stability};
use crate::verdict;

/// Evaluation points from which several threads pay.
const POINTS_FOR_THREADS: usize = 20_000;

/// How the time loop ended.
enum End {
    Completed,
    Interrupted(PathBuf),
    Failed(String),
}

/// Loads, simulates, writes.
pub(crate) fn run(
    options: &RunOptions,
    command: &[OsString],
    console: &mut Console<'_>,
    interrupted: &AtomicBool,
) -> Result<u8, CliError> {
    let case = jstsph_case::load(&options.case, &options.overrides)?;
    run_case(&case, options, command, console, interrupted)
}

/// Simulates a case that is already read, and writes.
pub(crate) fn run_case(
    case: &Case,
    options: &RunOptions,
    command: &[OsString],
    console: &mut Console<'_>,
    interrupted: &AtomicBool,
) -> Result<u8, CliError> {
    let columns = extra_columns(case)?;
    let (pool, threads) = pool(case, options.threads)?;
    if case.output.format == FrameFormat::VtuAndVtkhdf && !HAS_VTKHDF {
        return Err(CliError::Folder(OutputError::NoVtkhdf));
    }
    pool.install(|| {
        let simulation =
            Simulation::new(case.model.clone()).map_err(|error| case.setup_error(&error))?;
        let mut warnings = case.warnings.clone();
        warnings.extend(Stability::warning_before_run(case, &simulation));
        let job = Job {
            options,
            case,
            warnings,
            columns: &columns,
            threads,
            command,
        };
        job.run(simulation, console, interrupted)
    })
}

/// The pool in which a whole command runs.
pub(crate) fn pool(case: &Case, threads: Option<u16>) -> Result<(ThreadPool, usize), CliError> {
    let threads = threads.map_or_else(|| default_threads(case), usize::from);
    let pool = ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| CliError::Threads {
            threads,
            reason: error.to_string(),
        })?;
    Ok((pool, threads))
}

fn default_threads(case: &Case) -> usize {
    let points: usize = case
        .model
        .bodies
        .iter()
        .map(|body| match case.model.scheme.quadrature {
            Quadrature::Bonds => body.body.bonds.ends.len(),
            Quadrature::Particles => body.body.positions.len(),
        })
        .sum();
    if points < POINTS_FOR_THREADS {
        1
    } else {
        std::thread::available_parallelism().map_or(1, usize::from)
    }
}

struct Job<'a> {
    options: &'a RunOptions,
    case: &'a Case,
    /// What looks wrong before the first step.
    warnings: Vec<String>,
    columns: &'a [String],
    threads: usize,
    command: &'a [OsString],
}

impl Job<'_> {
    fn run(
        &self,
        mut simulation: Simulation,
        console: &mut Console<'_>,
        interrupted: &AtomicBool,
    ) -> Result<u8, CliError> {
        let path = self
            .options
            .out
            .clone()
            .unwrap_or_else(|| PathBuf::from("results").join(&self.case.name));
        let (folder, resumed) = if self.options.resume {
            self.resume(path, &mut simulation, console)?
        } else {
            (
                ResultsFolder::create(&path, self.options.force).map_err(CliError::Folder)?,
                None,
            )
        };
        let mut record = RunRecord::start(
            option_env!("JSTSPH_COMMIT").map(str::to_owned),
            self.command
                .iter()
                .map(|word| word.to_string_lossy().into_owned())
                .collect(),
            self.threads as u64,
        );
        let start = Instant::now();
        let result = self.recorded(
            &folder,
            &mut record,
            &mut simulation,
            resumed,
            console,
            interrupted,
        );
        if let Err(CliError::Writing { source, .. }) = &result {
            // Where nothing can be written, perhaps this can; if not, the record says what a killed
            // run's says.
            let reason = format!("stopped: {source}");
            let _ = folder.log(&reason);
            record.finish(start.elapsed().as_secs_f64(), reason);
            let _ = record.write(folder.path());
        }
        result
    }

    /// From the first file to the last.
    fn recorded(
        &self,
        folder: &ResultsFolder,
        record: &mut RunRecord,
        simulation: &mut Simulation,
        resumed: Option<LastRow>,
        console: &mut Console<'_>,
        interrupted: &AtomicBool,
    ) -> Result<u8, CliError> {
        let stopped = |time: f64| {
            move |source| CliError::Writing {
                time,
                source,
                restart: latest_restart(&folder.restart()),
            }
        };
        let time = simulation.time();
        let mut recorder = self
            .open(folder, record, simulation, resumed)
            .map_err(|source| match source {
                OutputError::Io { .. } => stopped(time)(source),
                // Tables and frames of another case.
                _ => CliError::Folder(source),
            })?;
        self.announce(simulation, folder, console)
            .map_err(stopped(time))?;
        let mut progress = Progress::new(simulation, self.case.time.end, self.options.quiet);
        let first_step = simulation.step_count();
        let profile = self.options.profile.then(|| Arc::new(Profile::start()));
        if let Some(profile) = &profile {
            simulation.watch(profile.clone());
        }
        let end = self.advance(
            simulation,
            &mut recorder,
            (&mut progress, profile.as_deref()),
            folder,
            console,
            interrupted,
        );
        progress.clear();
        let wall = progress.elapsed().as_secs_f64();
        let time = simulation.time();

        let (status, reason, outcome) = match end.map_err(stopped(time))? {
            End::Completed => {
                recorder.finish(simulation).map_err(stopped(time))?;
                (Status::Completed, "completed".to_owned(), Ok(0))
            }
            End::Interrupted(file) => {
                let reason = format!(
                    "interrupted; the state is in {}; continue with --resume",
                    file.display()
                );
                (Status::Interrupted, reason, Ok(130))
            }
            End::Failed(reason) => {
                let path = recorder.fail(simulation).map_err(stopped(time))?;
                let failed = CliError::Failed {
                    reason: reason.clone(),
                    time: simulation.time(),
                    step: simulation.step_count(),
                    path,
                };
                (Status::Failed, format!("failed: {reason}"), Err(failed))
            }
        };
        let mut summary = self.summary(simulation, status, wall, first_step);
        if outcome.is_err() {
            summary.warnings.push(reason.clone());
        }
        let pictures = self.draw(folder, &mut summary);
        summary.write(folder.path()).map_err(stopped(time))?;
        record.finish(wall, reason.clone());
        record.write(folder.path()).map_err(stopped(time))?;
        folder.log(&reason).map_err(stopped(time))?;
        if let Some(profile) = &profile {
            let (particles, points) = (summary.particles as usize, summary.points as usize);
            let steps = simulation.step_count().saturating_sub(first_step);
            console.print(profile.table(steps, particles, points));
        }
        if !self.options.quiet {
            console.print(verdict::verdict(
                &summary,
                self.columns,
                folder.path(),
                &pictures,
            ));
            if status == Status::Interrupted {
                console.print(format_args!("  {reason}\n"));
            }
        }
        outcome
    }

    /// Opens an earlier run's folder and puts its latest state into the simulation.
    fn resume(
        &self,
        path: PathBuf,
        simulation: &mut Simulation,
        console: &mut Console<'_>,
    ) -> Result<(ResultsFolder, Option<LastRow>), CliError> {
        let nothing = |source| CliError::NothingToResume {
            path: path.clone(),
            source,
        };
        let foreign = |reason: String| CliError::ForeignState {
            path: path.clone(),
            reason,
        };
        let folder = ResultsFolder::open(&path).map_err(|source| match source {
            OutputError::FolderInUse { .. } => CliError::Folder(source),
            _ => nothing(source),
        })?;
        let (data, damaged) = match read_latest_restart(&folder.restart()) {
            // Killed before its first row: nothing is lost by beginning.
            Err(OutputError::NoRestart { problems, .. })
                if problems.is_empty() && !folder.history().exists() =>
            {
                return Ok((folder, None));
            }
            other => other.map_err(nothing)?,
        };
        for warning in damaged {
            let text = format!("warning: {warning}; the state before it is used");
            folder.log(&text).map_err(CliError::Folder)?;
            console.error(format_args!("{text}\n"));
        }
        let (saved, last, resolved) = decode(data)
            .ok_or_else(|| foreign("its restart file was written by another version".to_owned()))?;
        if let Some(line) = changed_line(&resolved, &copies::resolved(self.case)) {
            console.error(format_args!(
                "warning: the case differs from the one that is continued, first in: {line}\n"
            ));
        }
        simulation
            .restore(&saved)
            .map_err(|error| foreign(error.to_string()))?;
        let forces = simulation.obstacle_impulses().len() + simulation.condition_impulses().len();
        if last.impulses.len() != forces {
            return Err(foreign(
                "it has another number of obstacles or prescribed velocities".to_owned(),
            ));
        }
        Ok((folder, Some(last)))
    }

    fn open<'a>(
        &'a self,
        folder: &'a ResultsFolder,
        record: &RunRecord,
        simulation: &Simulation,
        resumed: Option<LastRow>,
    ) -> Result<Recorder<'a>, OutputError> {
        record.write(folder.path())?;
        copies::write(folder, self.case)?;
        Recorder::start(self.case, folder, self.columns, simulation, resumed)
    }

    fn announce(
        &self,
        simulation: &Simulation,
        folder: &ResultsFolder,
        console: &mut Console<'_>,
    ) -> Result<(), OutputError> {
        let reference = simulation.reference();
        let mut text = format!(
            "{}: {} particles, {} evaluation points, {} to {}, {} {}",
            self.case.name,
            reference.position.len(),
            reference.point_volume.len(),
            verdict::seconds(simulation.time()),
            verdict::seconds(self.case.time.end),
            self.threads,
            if self.threads == 1 {
                "thread"
            } else {
                "threads"
            }
        );
        for warning in &self.warnings {
            text += &format!("\nwarning: {warning}");
        }
        folder.log(&text)?;
        if !self.options.quiet {
            console.error(format_args!("{text}\n"));
        }
        Ok(())
    }

    fn advance(
        &self,
        simulation: &mut Simulation,
        recorder: &mut Recorder<'_>,
        (progress, profile): (&mut Progress, Option<&Profile>),
        folder: &ResultsFolder,
        console: &mut Console<'_>,
        interrupted: &AtomicBool,
    ) -> Result<End, OutputError> {
        let end = self.case.time.end;
        while simulation.time() < end {
            if let Err(error) = simulation.advance_step(end) {
                return Ok(End::Failed(error.to_string()));
            }
            match recorder.observe(simulation) {
                Ok(()) => {}
                Err(error @ OutputError::NotFinite { .. }) => {
                    let (time, step) = (simulation.time(), simulation.step_count());
                    return Ok(End::Failed(format!(
                        "{error}, at t = {time:.6e} s (step {step}); reduce time.cfl"
                    )));
                }
                Err(error) => return Err(error),
            }
            if let Some(line) = progress.update(simulation, console) {
                folder.log(&line)?;
            }
            if let Some(profile) = profile {
                profile.output();
            }
            if interrupted.load(Ordering::Relaxed) && simulation.time() < end {
                return recorder.interrupt(simulation).map(End::Interrupted);
            }
        }
        Ok(End::Completed)
    }

    /// Draws the end of the run; a picture that cannot be drawn is no reason to fail.
    fn draw(&self, folder: &ResultsFolder, summary: &mut Summary) -> Vec<PathBuf> {
        if self.options.no_pictures {
            return Vec::new();
        }
        plot::after_run(self.case, folder.path()).unwrap_or_else(|error| {
            summary.warnings.push(format!("no pictures: {error}"));
            Vec::new()
        })
    }

    #[expect(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
    fn summary(
        &self,
        simulation: &Simulation,
        status: Status,
        wall: f64,
        first_step: u64,
    ) -> Summary {
        let reference = simulation.reference();
        let (particles, points) = (reference.position.len(), reference.point_volume.len());
        let entries: usize = reference
            .bodies
            .iter()
            .map(|body| body.gradient.entry_count())
            .sum();
        let steps_here = simulation.step_count().saturating_sub(first_step);
        let mut summary = Summary::new(self.case.name.as_str(), status);
        summary.particles = particles as u64;
        summary.points = points as u64;
        summary.neighbours_per_particle = entries as f64 / points.max(1) as f64;
        summary.steps = simulation.step_count();
        summary.simulated_time = simulation.time();
        summary.wall_seconds = wall;
        summary.particle_steps_per_second = particles as f64 * steps_here as f64 / wall.max(1e-9);
        summary.energies = energies(simulation);
        let ratio = summary.energies.kinetic_to_internal();
        summary.kinetic_to_internal = ratio.is_finite().then_some(ratio);
        summary.extremes = extremes(simulation);
        let positions = &simulation.state().position;
        let inverted = reference.bodies.iter().map(|body| {
            inverted_cells(&body.body.cells, &positions[body.particles.clone()]).inverted as u64
        });
        summary.inverted_cells = inverted.sum();
        summary.probes = probe_values(self.case, simulation).into_iter().collect();
        summary.warnings = self.warnings.clone();
        let found = verdict::warnings(&summary, simulation.position_corrections());
        summary.warnings.extend(found);
        let scale = self.case.model.scheme.inertia_scale;
        summary
            .warnings
            .extend(stability::inertia(&summary.energies, scale));
        summary
    }
}

/// The first line of the new resolved case that the old one lacks, apart from duration and output,
/// which may change between the parts of a run.
fn changed_line<'a>(old: &str, new: &'a str) -> Option<&'a str> {
    let known: std::collections::HashSet<&str> = old.lines().collect();
    let mut table = "";
    new.lines().find(|line| {
        if line.starts_with('[') {
            table = line;
        }
        let may_change = table == "[output]" || (table == "[time]" && line.starts_with("end ="));
        !may_change && !known.contains(line)
    })
}

#[cfg(test)]
mod tests {
    use super::changed_line;

    #[test]
    fn duration_and_output_may_change_between_the_parts_of_a_run() {
        let old =
            "title = \"a\"\n[time]\nend = 1.0  # s\ncfl = 0.3\n[output]\nprecision = \"double\"\n";
        assert_eq!(
            changed_line(
                old,
                &old.replace("end = 1.0", "end = 2.0")
                    .replace("double", "single")
            ),
            None
        );
        assert_eq!(
            changed_line(old, &old.replace("cfl = 0.3", "cfl = 0.4")),
            Some("cfl = 0.4")
        );
    }
}
