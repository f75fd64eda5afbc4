//! Which points make sub-steps, how many, and how long the step is.

use super::Groups;
use crate::SolverError;
use crate::acoustic::Frequency;
use crate::model::Scheme;
use crate::reference::Reference;
use crate::simulation::Simulation;
use crate::state::Workspace;
use crate::time_step::{StableStep, point_time, stable_step_of_part};

/// Steps after which the groups are chosen again at the latest.
const LATEST: u64 = 256;

/// Steps before which they are not.
const EARLIEST: u64 = 12;

/// Relative change of the stretch limit of one of the groups by which they are chosen again in between.
const CHANGE: f64 = 0.15;

/// Work on a fine point in a sub-step over that on another point in a step, roughly: particles around the
/// fine points sum over all their points.
const FINE_WORK: f64 = 1.5;

/// By how much the limit of the rest must be longer than its step: impulses once a step resonate with
/// vibrations of the fine parts whose half period is a step. With this margin and a CFL number of 0.9
/// these are 3.5 times above all frequencies of the rest and hardly reach it. A vibrating Taylor bar
/// gains energy at 1, in one of four resolutions at 1.6, and in none at 2. docs/theory.md.
const MARGIN: f64 = 2.0;

/// Most by which a step is shortened because points are being compressed.
const LARGEST_SHORTENING: f64 = 0.5;

/// Threshold over the smallest time of all, to begin with.
const FIRST_THRESHOLD: f64 = 1.4;

/// Factors on the threshold that are tried in turn.
const STRIDES: [f64; 4] = [1.3, 1.7, 1.0 / 1.3, 1.0 / 1.7];

/// What groups are worth.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Outcome {
    /// Sub-steps of a step.
    ratio: u32,
    /// Limit of the sub-step, s.
    limit: f64,
    /// Simulated time per work on a point of equal steps, s.
    speed: f64,
}

/// The groups in use: points whose time Δx λ_min / c is below a threshold, and their surroundings.
/// Now and then limits and groups are computed anew, and another threshold is tried.
#[derive(Clone, Debug)]
pub(super) struct Choice {
    frequency: Frequency,
    /// What the frequency needs of a workspace: that of the simulation is in use while this one is asked.
    work: Workspace,
    largest_ratio: u32,
    /// Δx λ_min / c of every point, s.
    point_time: Vec<f64>,
    trial: Vec<Groups>,
    ratio: u32,
    /// s; zero before the first choice.
    threshold: f64,
    /// Which stride is tried next.
    turn: usize,
    /// Limit of the sub-step at the last choice, s.
    limit: f64,
    /// Smallest times of the fine points and of the others at the last choice, s; infinite when there
    /// are none.
    times: [f64; 2],
    /// Smallest time of all points one step ago, s; zero before the first.
    previous: f64,
    /// Step of the last choice.
    step: u64,
}

impl Choice {
    pub(super) fn new(scheme: &Scheme, reference: &Reference) -> Self {
        Self {
            frequency: Frequency::new(reference),
            work: Workspace::of_strains(reference),
            largest_ratio: scheme.substeps,
            point_time: vec![0.0; reference.point_volume.len()],
            trial: reference.bodies.iter().map(Groups::new).collect(),
            ratio: 1,
            threshold: 0.0,
            turn: 0,
            limit: 0.0,
            times: [f64::INFINITY; 2],
            previous: 0.0,
            step: 0,
        }
    }

    /// Sub-steps of a step.
    pub(super) fn ratio(&self) -> u32 {
        self.ratio
    }

    /// Whether the groups are to be chosen again.
    pub(super) fn is_due(&self, step: u64, now: &StretchLimits) -> bool {
        let age = step + 1 - self.step;
        if !(EARLIEST..LATEST).contains(&age) {
            return age >= LATEST;
        }
        let mut changes = now.iter().zip(self.times);
        changes.any(|(now, then)| (now.time - then).abs() > CHANGE * then)
    }

    /// Chooses the groups for the present state.
    pub(super) fn renew(&mut self, simulation: &Simulation, groups: &mut Vec<Groups>) {
        let Simulation {
            reference, state, ..
        } = simulation;
        for body in &reference.bodies {
            for q in body.points.clone() {
                self.point_time[q] = point_time(body, &state.deformation_gradient[q]);
            }
        }
        let smallest = self.point_time.iter().fold(f64::INFINITY, |a, b| a.min(*b));
        let limit = self.limit_of(simulation, None);
        let threshold = if self.ratio == 1 {
            smallest * FIRST_THRESHOLD
        } else {
            self.threshold
        };
        let other = threshold * STRIDES[self.turn];
        let fine = self.group(simulation, groups, threshold);
        let rest = if self.best(fine, limit, f64::INFINITY).ratio > 1 {
            self.limit_of(simulation, Some(groups)) / MARGIN
        } else {
            // Nothing to be gained whatever the rest allows.
            0.0
        };
        let mut outcome = self.best(fine, limit, rest);
        self.threshold = threshold;
        let mut trial = std::mem::take(&mut self.trial);
        let others = self.group(simulation, &mut trial, other);
        // With more of the body the rest cannot have a longer step.
        let bound = if other < threshold && rest > 0.0 {
            rest
        } else {
            f64::INFINITY
        };
        self.turn = (self.turn + 1) % STRIDES.len();
        if others != fine && self.best(others, limit, bound).speed > outcome.speed {
            let rest = self.limit_of(simulation, Some(&trial)) / MARGIN;
            let tried = self.best(others, limit, rest);
            if tried.speed > outcome.speed {
                (self.threshold, outcome) = (other, tried);
                std::mem::swap(groups, &mut trial);
            }
        }
        self.trial = trial;
        if outcome.ratio == 1 {
            for (body, groups) in reference.bodies.iter().zip(&mut *groups) {
                groups.choose(body, |_| false);
            }
        }
        self.ratio = outcome.ratio;
        self.limit = outcome.limit;
        self.times = stretch_limits(simulation, groups).map(|step| step.time);
        self.step = simulation.step + 1;
    }

    /// 2/ω_max of the bodies, or of what is not fine in them, s.
    fn limit_of(&mut self, simulation: &Simulation, without_fine: Option<&[Groups]>) -> f64 {
        let Simulation {
            reference,
            state,
            scheme,
            ..
        } = simulation;
        self.frequency
            .limit(&mut self.work, reference, scheme, state, without_fine)
    }

    /// Makes the groups of a threshold and returns the number of fine points.
    fn group(&self, simulation: &Simulation, groups: &mut [Groups], threshold: f64) -> usize {
        let mut fine = 0;
        for (body, groups) in simulation.reference.bodies.iter().zip(groups) {
            let time = &self.point_time[body.points.clone()];
            groups.choose(body, |q| time[q] < threshold);
            fine += groups.fine.count();
        }
        fine
    }

    /// The best ratio for that many fine points, where `limit` is that of the whole bodies and `rest`
    /// that of the others. `[eq:local-limit]`
    fn best(&self, fine: usize, limit: f64, rest: f64) -> Outcome {
        let (points, fine) = (self.point_time.len() as f64, fine as f64);
        let mut best = Outcome {
            ratio: 1,
            limit,
            speed: limit / points,
        };
        let mut ratio = 2;
        while ratio <= self.largest_ratio {
            let limit = limit.min(rest / f64::from(ratio));
            let work = (points - fine) / f64::from(ratio) + FINE_WORK * fine;
            let speed = limit / work;
            if speed > best.speed {
                best = Outcome {
                    ratio,
                    limit,
                    speed,
                };
            }
            ratio *= 2;
        }
        best
    }

    /// The step that follows, cut at `end`; checks that strains are finite.
    pub(super) fn next_time_step(
        &mut self,
        simulation: &mut Simulation,
        now: &StretchLimits,
        end: f64,
    ) -> Result<f64, SolverError> {
        let mut change = f64::INFINITY;
        for (now, then) in now.iter().zip(self.times) {
            if now.time.is_nan() {
                return Err(simulation.not_finite(now.point));
            }
            if then.is_finite() {
                change = change.min(now.time / then);
            }
        }
        let [fine, rest] = *now;
        let stable = if fine.time < rest.time { fine } else { rest };
        // The last sub-step of the step that follows sees what one step more has compressed.
        if self.previous > 0.0 {
            change *= (stable.time / self.previous).clamp(LARGEST_SHORTENING, 1.0);
        }
        self.previous = stable.time;
        let sub_step = simulation.scheme.cfl * self.limit * change;
        simulation.check_time_step(sub_step, &stable)?;
        Ok(simulation.cut_at(end, sub_step * f64::from(self.ratio)))
    }

    /// What a restart needs.
    #[expect(clippy::cast_precision_loss, reason = "no run makes 2^53 steps")]
    pub(super) fn saved(&self) -> [f64; 8] {
        [
            f64::from(self.ratio),
            self.threshold,
            self.turn as f64,
            self.limit,
            self.times[0],
            self.times[1],
            self.step as f64,
            self.previous,
        ]
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "written by `saved`"
    )]
    pub(super) fn restore(&mut self, saved: &[f64]) {
        self.ratio = saved[0] as u32;
        self.threshold = saved[1];
        self.turn = saved[2] as usize % STRIDES.len();
        self.limit = saved[3];
        self.times = [saved[4], saved[5]];
        self.step = saved[6] as u64;
        self.previous = saved[7];
    }
}

/// Limits by stretch of the fine points and of the others.
pub(super) type StretchLimits = [StableStep; 2];

/// The limits by stretch at the present state.
pub(super) fn stretch_limits(simulation: &Simulation, groups: &[Groups]) -> StretchLimits {
    let state = (&simulation.state, &simulation.work.stretch_bounds);
    [true, false].map(|fine| stable_step_of_part(&simulation.reference, state, (groups, fine)))
}
