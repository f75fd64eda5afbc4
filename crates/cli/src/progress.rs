//! Progress of a run on standard error.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use jstsph_solver::Simulation;

use crate::console::Console;
use crate::verdict::{duration, seconds};

/// Time between drawings of the bar.
const REDRAW: Duration = Duration::from_millis(250);
/// Least time between plain lines, apart from those at every tenth of the run.
const QUIET: Duration = Duration::from_secs(10);
/// Parts of the bar.
const PARTS: u64 = 1000;

/// A bar on a terminal, lines elsewhere, nothing when quiet.
pub(crate) struct Progress {
    form: Form,
    end: f64,
    started: Instant,
    first: (f64, u64),
    shown: Instant,
    next_tenth: f64,
}

enum Form {
    None,
    Lines,
    Bar(ProgressBar),
}

impl Progress {
    /// Progress of a simulation towards `end` (s).
    pub(crate) fn new(simulation: &Simulation, end: f64, quiet: bool) -> Self {
        let now = Instant::now();
        let form = if quiet {
            Form::None
        } else if std::io::IsTerminal::is_terminal(&std::io::stderr()) {
            let bar = ProgressBar::with_draw_target(Some(PARTS), ProgressDrawTarget::stderr());
            // The template is a constant; a wrong one would show as indicatif's default bar.
            if let Ok(style) = ProgressStyle::with_template("{bar:24} {percent:>3} %  {msg}") {
                bar.set_style(style);
            }
            Form::Bar(bar)
        } else {
            Form::Lines
        };
        Self {
            form,
            end,
            started: now,
            first: (simulation.time(), simulation.step_count()),
            shown: now,
            next_tenth: ((10.0 * simulation.time() / end).floor() + 1.0) / 10.0,
        }
    }

    /// Wall-clock time since the start.
    pub(crate) fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }

    /// Shows where the run is, when it is time to; returns the line for the log at every tenth.
    pub(crate) fn update(
        &mut self,
        simulation: &Simulation,
        console: &mut Console<'_>,
    ) -> Option<String> {
        let part = simulation.time() / self.end;
        let now = Instant::now();
        let since = now - self.shown;
        let tenth = part >= self.next_tenth;
        let due = match self.form {
            Form::None => false,
            Form::Bar(_) => since >= REDRAW,
            // Lines become rarer in long runs: a log of a day's run is read by a person.
            Form::Lines => since >= QUIET.max((now - self.started) / 10),
        };
        if !due && !tenth {
            return None;
        }
        self.shown = now;
        let message = self.message(simulation, now);
        match &self.form {
            Form::None => {}
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a fraction of PARTS"
            )]
            Form::Bar(bar) => {
                bar.set_position((part.clamp(0.0, 1.0) * PARTS as f64) as u64);
                bar.set_message(message.clone());
            }
            Form::Lines => console.error(format_args!("{:5.1} %  {message}\n", 100.0 * part)),
        }
        if !tenth {
            return None;
        }
        self.next_tenth = ((10.0 * part).floor() + 1.0) / 10.0;
        Some(format!("{:5.1} %  {message}", 100.0 * part))
    }

    #[expect(
        clippy::cast_precision_loss,
        reason = "steps of a run are far below 2^53"
    )]
    fn message(&self, simulation: &Simulation, now: Instant) -> String {
        let wall = (now - self.started).as_secs_f64().max(1e-9);
        let rate = (simulation.step_count() - self.first.1) as f64 / wall;
        let advanced = simulation.time() - self.first.0;
        let left = if advanced > 0.0 {
            duration(wall * (self.end - simulation.time()).max(0.0) / advanced)
        } else {
            "unknown".to_owned()
        };
        format!(
            "t = {}  {rate:.0} steps/s  {left} left  balance {:+.4} %",
            seconds(simulation.time()),
            100.0 * simulation.energies().balance()
        )
    }

    /// Removes the bar.
    pub(crate) fn clear(&self) {
        if let Form::Bar(bar) = &self.form {
            bar.finish_and_clear();
        }
    }
}
