//! `jstsph run --profile`: where the time of a run goes.

use std::fmt::Write as _;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use jstsph_solver::{Phase, PhaseObserver};

/// A clock that is read whenever a phase ends.
#[derive(Debug)]
pub(crate) struct Profile(Mutex<Laps>);

#[derive(Debug)]
struct Laps {
    last: Instant,
    phases: [Duration; Phase::ALL.len()],
    output: Duration,
}

impl Profile {
    /// Starts the clock.
    pub(crate) fn start() -> Self {
        Self(Mutex::new(Laps {
            last: Instant::now(),
            phases: [Duration::ZERO; Phase::ALL.len()],
            output: Duration::ZERO,
        }))
    }

    fn lap(&self, of: impl FnOnce(&mut Laps) -> &mut Duration) {
        // A poisoned clock is still a clock.
        let mut laps = self
            .0
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let now = Instant::now();
        let passed = now - laps.last;
        laps.last = now;
        *of(&mut laps) += passed;
    }

    /// Books what passed since the last phase as output.
    pub(crate) fn output(&self) {
        self.lap(|laps| &mut laps.output);
    }

    /// The table: seconds, share, and nanoseconds per particle and per point of one step.
    #[expect(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
    pub(crate) fn table(&self, steps: u64, particles: usize, points: usize) -> String {
        let laps = self
            .0
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let mut rows: Vec<(&str, f64)> = Phase::ALL
            .iter()
            .zip(&laps.phases)
            .map(|(phase, time)| (phase.name(), time.as_secs_f64()))
            .collect();
        rows.push(("output", laps.output.as_secs_f64()));
        let total: f64 = rows.iter().map(|(_, seconds)| seconds).sum();
        rows.push(("all", total));
        let mut text = format!(
            "{:<14} {:>9} {:>7} {:>13} {:>10}\n",
            "phase", "s", "%", "ns/particle", "ns/point"
        );
        let steps = steps.max(1) as f64;
        for (name, seconds) in rows {
            let per = |count: usize| 1e9 * seconds / (steps * count.max(1) as f64);
            let share = 100.0 * seconds / total.max(f64::MIN_POSITIVE);
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "{name:<14} {seconds:>9.3} {share:>7.1} {:>13.1} {:>10.1}",
                per(particles),
                per(points)
            );
        }
        text
    }
}

impl PhaseObserver for Profile {
    fn finished(&self, phase: Phase) {
        self.lap(|laps| &mut laps.phases[phase as usize]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_phase_has_its_row_and_the_last_one_is_their_sum() {
        let profile = Profile::start();
        std::thread::sleep(Duration::from_millis(2));
        profile.finished(Phase::Heat);
        profile.output();
        let table = profile.table(10, 2, 4);
        assert_eq!(table.lines().count(), 1 + Phase::ALL.len() + 2);
        let row = |name: &str| -> Vec<f64> {
            let line = table.lines().find(|line| line.starts_with(name)).unwrap();
            line.split_whitespace()
                .filter_map(|word| word.parse().ok())
                .collect()
        };
        let (heat, all) = (row("heat"), row("all"));
        assert!(heat[0] >= 0.002 && heat[1] > 90.0);
        assert_eq!(row("gradient"), [0.0; 4]);
        assert!(all[0] >= heat[0] && all[1] == 100.0);
        // 2 ms over ten steps of two particles and four points.
        assert!(heat[2] >= 1e5 && (heat[2] / heat[3] - 2.0).abs() < 1e-3);
    }
}
