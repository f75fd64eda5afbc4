//! What a run writes while it goes on: history, frames, restart files, summary.

use std::path::PathBuf;

use jstsph_case::{Case, FrameCells, FrameFormat, Interval, Precision};
use jstsph_geometry::Dimension;
use jstsph_output::{
    CellKind, Energies, Extremes, FrameOptions, FrameSeries, HISTORY_COLUMNS, HistoryRow,
    HistoryWriter, OutputError, ResultsFolder, read_latest_restart, write_restart,
};
use jstsph_solver::{ConditionKind, Saved, Simulation};

use crate::copies;
use crate::error::CliError;
use crate::frame;
use crate::restart::{self, LastRow, decode, encode};
use crate::writer::{OwnedCells, Series, Thread, Writer};

/// Writes results at the first step at or past each interval.
pub(crate) struct Recorder<'a> {
    case: &'a Case,
    folder: &'a ResultsFolder,
    history: HistoryWriter,
    writer: Writer,
    next: Next,
    last: LastRow,
    /// Whether a state may still be on its way to the disk.
    state_is_open: bool,
    /// The resolved case, with the names of the copies of the files that it reads.
    resolved: String,
    /// The state at one of the last rows, which is known to be finite; of a large run the latest
    /// restart file is that state, because a copy takes half as much memory as the run itself.
    good: Option<Saved>,
}

/// Fewest steps from one state that is kept to the next: a copy takes as long as one or two steps.
const STEPS_BETWEEN_SAVES: u64 = 50;

/// Evaluation points up to which the state of one of the last rows is kept in memory, 100 MB, and a copy of
/// the fields is made for a thread that writes them.
const POINTS_KEPT: usize = 300_000;

fn is_small(simulation: &Simulation) -> bool {
    simulation.reference().point_volume.len() <= POINTS_KEPT
}

/// When what is due next.
struct Next {
    history: Due,
    frame: Due,
    restart: Due,
}

/// When one thing is due next.
struct Due {
    interval: Interval,
    /// Simulated time, s; of no meaning for an interval in steps.
    next: f64,
}

impl Due {
    fn after(time: f64, interval: Interval) -> Self {
        let next = match interval {
            Interval::Time(interval) => next_multiple(time, interval),
            Interval::Steps(_) => f64::INFINITY,
        };
        Self { interval, next }
    }

    /// Whether it is due; from then on the next one is.
    fn is_due(&mut self, simulation: &Simulation) -> bool {
        match self.interval {
            Interval::Time(_) if simulation.time() < self.next => false,
            Interval::Time(_) => {
                *self = Self::after(simulation.time(), self.interval);
                true
            }
            Interval::Steps(steps) => simulation.step_count().is_multiple_of(steps),
        }
    }
}

/// The quantities of Greto & Kulasegaram 2019, (4.1), for the last time step.
const PAPER_COLUMNS: [&str; 3] = [
    "paper_internal_energy",
    "paper_plastic_dissipation",
    "paper_jst_dissipation",
];

/// `force_` and a name without blanks.
fn force_column(name: &str) -> String {
    format!("force_{}", name.replace(char::is_whitespace, "_"))
}

/// Names of the history's columns after the fixed ones.
///
/// # Errors
/// [`CliError::ProbeName`] for a probe whose name is taken.
pub(crate) fn extra_columns(case: &Case) -> Result<Vec<String>, CliError> {
    let (axes, rotations) = axes(case.model.dimension);
    let named = |quantity: &str, axes: &[usize]| -> Vec<String> {
        axes.iter()
            .map(|axis| format!("{quantity}_{}", ["x", "y", "z"][*axis]))
            .collect()
    };
    let mut columns = named("momentum", axes);
    columns.extend(named("angular_momentum", rotations));
    for obstacle in &case.model.obstacles {
        columns.extend(named(&force_column(&obstacle.obstacle.name), axes));
    }
    let prescribed = |kind: &ConditionKind| matches!(kind, ConditionKind::Velocity(_));
    for condition in case.model.conditions.iter().filter(|c| prescribed(&c.kind)) {
        columns.extend(named(&force_column(&condition.name), axes));
    }
    columns.extend(PAPER_COLUMNS.map(str::to_owned));
    for probe in &case.probes {
        for column in Simulation::probe_columns(probe) {
            if columns.contains(&column) || HISTORY_COLUMNS.iter().any(|fixed| fixed.name == column)
            {
                return Err(CliError::ProbeName {
                    name: probe.name.clone(),
                });
            }
            columns.push(column);
        }
    }
    Ok(columns)
}

/// Axes along which, and about which, anything can move.
fn axes(dimension: Dimension) -> (&'static [usize], &'static [usize]) {
    match dimension {
        Dimension::PlaneStrain => (&[0, 1], &[2]),
        Dimension::Solid => (&[0, 1, 2], &[0, 1, 2]),
    }
}

impl<'a> Recorder<'a> {
    /// Starts the files of a new run with the initial state, or continues those of an earlier one.
    pub(crate) fn start(
        case: &'a Case,
        folder: &'a ResultsFolder,
        columns: &[String],
        simulation: &Simulation,
        resumed: Option<LastRow>,
    ) -> Result<Self, OutputError> {
        let time = simulation.time();
        let cells = match case.output.cells {
            FrameCells::Lattice => OwnedCells::of(simulation),
            FrameCells::Particles => OwnedCells::None,
        };
        let options = FrameOptions {
            precision: match case.output.precision {
                Precision::Double => jstsph_output::Precision::F64,
                Precision::Single => jstsph_output::Precision::F32,
            },
            compression: case.output.compression,
            cells: if matches!(cells, OwnedCells::None) {
                CellKind::Vertices
            } else {
                CellKind::Lattice
            },
        };
        let last = resumed.unwrap_or_else(|| LastRow {
            time,
            impulses: impulses(simulation),
        });
        let is_new = simulation.step_count() == 0;
        let resolved = copies::resolved(case);
        let (history, frames) = if is_new {
            // Also when it is resumed: it may have been killed before its first row or frame. The
            // state comes first, so that where there is a history there is a state.
            restart::write(&folder.restart(), simulation, &resolved, &last)?;
            (
                HistoryWriter::create(&folder.history(), columns)?,
                FrameSeries::resume(&folder.frames(), options, f64::NEG_INFINITY)?,
            )
        } else {
            (
                HistoryWriter::resume(&folder.history(), columns, time)?,
                FrameSeries::resume(&folder.frames(), options, time)?,
            )
        };
        let frames = match case.output.format {
            FrameFormat::Vtu => frames,
            FrameFormat::VtuAndVtkhdf => frames.with_vtkhdf()?,
        };
        let series = Series::new(frames, cells);
        let writer = if is_small(simulation) {
            Writer::Beside(Box::new(Thread::start(series, folder.frames())?))
        } else {
            Writer::Within(Box::new(series))
        };
        let mut recorder = Self {
            case,
            folder,
            history,
            writer,
            next: Next {
                history: Due::after(time, case.output.history_interval),
                frame: Due::after(time, case.output.frame_interval),
                restart: Due::after(time, case.output.restart_interval),
            },
            last,
            state_is_open: false,
            resolved,
            good: is_small(simulation).then(|| simulation.save()),
        };
        if is_new {
            recorder.row(simulation)?;
            recorder.frame(simulation)?;
        }
        Ok(recorder)
    }

    /// Writes what is due after a step.
    pub(crate) fn observe(&mut self, simulation: &Simulation) -> Result<(), OutputError> {
        let row = self.next.history.is_due(simulation);
        let frame = self.next.frame.is_due(simulation);
        if row {
            self.row(simulation)?;
            if let Some(good) = &mut self.good
                && simulation.step_count() >= good.step + STEPS_BETWEEN_SAVES
            {
                simulation.save_into(good);
            }
        }
        if frame {
            self.frame(simulation)?;
        }
        // Last: a restart file finds the rows and frames of its own time written.
        if self.next.restart.is_due(simulation) {
            self.restart_later(simulation)?;
        }
        Ok(())
    }

    /// Writes the last row and frame, unless they were just written, and the state.
    pub(crate) fn finish(&mut self, simulation: &Simulation) -> Result<(), OutputError> {
        if self.last.time < simulation.time() {
            self.row(simulation)?;
        }
        self.last_frame(simulation)?;
        self.restart(simulation)?;
        Ok(())
    }

    /// Writes the state as it is, for a run that is to be continued.
    pub(crate) fn interrupt(&mut self, simulation: &Simulation) -> Result<PathBuf, OutputError> {
        self.restart(simulation)
    }

    /// Puts the simulation back to its last good state and writes that.
    pub(crate) fn fail(&mut self, simulation: &mut Simulation) -> Result<PathBuf, OutputError> {
        let good = match self.good.take() {
            Some(good) => good,
            None => {
                let (data, _) = read_latest_restart(&self.folder.restart())?;
                match decode(data) {
                    Some((saved, last, _)) => {
                        self.last = last;
                        saved
                    }
                    // Not one that this run has written: what there is is better than nothing.
                    None => return self.restart(simulation),
                }
            }
        };
        if simulation.restore(&good).is_ok() {
            self.last_frame(simulation)?;
        }
        self.settle()?;
        let step = good.step;
        let data = encode(good, &self.resolved, &self.last);
        write_restart(&self.folder.restart(), step, &data)
    }

    fn last_frame(&mut self, simulation: &Simulation) -> Result<(), OutputError> {
        match self.writer.last_frame() {
            Some(time) if time >= simulation.time() => Ok(()),
            _ => self.frame(simulation),
        }
    }

    /// Writes a state, after the rows and frames before it.
    fn restart(&mut self, simulation: &Simulation) -> Result<PathBuf, OutputError> {
        self.settle()?;
        let folder = self.folder.restart();
        restart::write(&folder, simulation, &self.resolved, &self.last)
    }

    /// The same while the run goes on, if it is small.
    fn restart_later(&mut self, simulation: &Simulation) -> Result<(), OutputError> {
        let Writer::Beside(thread) = &mut self.writer else {
            return self.restart(simulation).map(|_| ());
        };
        // Of two states one is on the disk: no more is lost than what two intervals have done.
        if self.state_is_open {
            thread.wait()?;
        }
        self.state_is_open = true;
        let rows = self.history.syncing()?;
        let data = encode(simulation.save(), &self.resolved, &self.last);
        let (folder, step) = (self.folder.restart(), simulation.step_count());
        thread.give(Box::new(move |_| {
            rows()?;
            write_restart(&folder, step, &data)
        }))
    }

    /// Rows that a power failure takes must not be missing before a state that it leaves.
    fn settle(&mut self) -> Result<(), OutputError> {
        self.history.sync()?;
        self.writer.wait()
    }

    fn row(&mut self, simulation: &Simulation) -> Result<(), OutputError> {
        let momenta = simulation.momenta();
        let (axes, rotations) = axes(self.case.model.dimension);
        let mut extra: Vec<f64> = axes.iter().map(|axis| momenta.linear[*axis]).collect();
        extra.extend(rotations.iter().map(|axis| momenta.angular[*axis]));
        let now = LastRow {
            time: simulation.time(),
            impulses: impulses(simulation),
        };
        let passed = now.time - self.last.time;
        for (after, before) in now.impulses.iter().zip(&self.last.impulses) {
            // The mean force since the last row: the contact of a single particle is a series of
            // single blows.
            let force = if passed > 0.0 {
                (after - before) / passed
            } else {
                after - before
            };
            extra.extend(axes.iter().map(|axis| force[*axis]));
        }
        let paper = simulation.paper_energies();
        extra.extend([paper.internal, paper.plastic, paper.jst]);
        extra.extend(
            probe_values(self.case, simulation)
                .into_iter()
                .map(|(_, value)| value),
        );
        self.history.append(&HistoryRow {
            time: now.time,
            step: simulation.step_count(),
            dt: simulation.time_step(),
            energies: energies(simulation),
            extremes: extremes(simulation),
            probes: &extra,
        })?;
        self.last = now;
        Ok(())
    }

    fn frame(&mut self, simulation: &Simulation) -> Result<(), OutputError> {
        let chosen = &self.case.output.fields;
        self.writer.frame(
            || frame::whole(simulation, chosen),
            || frame::lazy(simulation, chosen),
        )
    }
}

/// The first multiple of the interval after a time.
fn next_multiple(time: f64, interval: f64) -> f64 {
    let next = ((time / interval).floor() + 1.0) * interval;
    if next > time { next } else { next + interval }
}

/// Impulse on every obstacle, then of every prescribed velocity on its particles.
fn impulses(simulation: &Simulation) -> Vec<jstsph_tensor::Vec3> {
    let on_obstacles = simulation.obstacle_impulses();
    let of_conditions = simulation.condition_impulses();
    on_obstacles
        .into_iter()
        .chain(of_conditions)
        .map(|(_, impulse)| impulse)
        .collect()
}

/// Columns and values of all probes.
pub(crate) fn probe_values(case: &Case, simulation: &Simulation) -> Vec<(String, f64)> {
    case.probes
        .iter()
        .flat_map(|probe| {
            Simulation::probe_columns(probe)
                .into_iter()
                .zip(simulation.probe(probe))
        })
        .collect()
}

/// Energies with the balance as a fraction of the largest.
pub(crate) fn energies(simulation: &Simulation) -> Energies {
    let energies = simulation.energies();
    Energies {
        kinetic: energies.kinetic,
        elastic: energies.elastic,
        plastic: energies.plastic,
        // Zero may carry a sign, which only puzzles readers.
        numerical: energies.numerical + 0.0,
        hourglass: energies.hourglass + 0.0,
        external: energies.external + 0.0,
        contact: energies.contact + 0.0,
        friction: energies.friction + 0.0,
        balance: energies.balance(),
    }
}

/// Extremes over the particles.
pub(crate) fn extremes(simulation: &Simulation) -> Extremes {
    let (jacobian_min, jacobian_max) = simulation.jacobian_range();
    Extremes {
        equivalent_plastic_strain: simulation.largest_plastic_strain(),
        jacobian_min,
        jacobian_max,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiples_lie_after_the_time_whatever_the_rounding() {
        assert_eq!(next_multiple(0.0, 0.1), 0.1);
        assert_eq!(next_multiple(0.05, 0.1), 0.1);
        for step in 1..1000 {
            let time = f64::from(step) * 0.1;
            let next = next_multiple(time, 0.1);
            assert!(
                next > time && next <= time + 0.1 * (1.0 + 1e-9),
                "{time} {next}"
            );
        }
    }
}
