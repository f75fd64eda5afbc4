//! Which points make sub-steps, how many, and how long the step is.

use super::{Groups, LARGEST_LEVEL, Levels, share};
use crate::SolverError;
use crate::acoustic::{CONVERGED, Frequency, Region, Vibrations};
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
const FINE_WORK: f64 = 1.3;

/// By how much the limit of what is coarser than a level must be longer than its step: impulses once a
/// step resonate with vibrations of the finer parts whose half period is a step. With this margin and a
/// CFL number of 0.9 these are 3.5 times above all frequencies of the coarser part and hardly reach it.
/// Vibrating Taylor bars gain energy in four of twelve runs at 1.5, in seven at 1.75, and in none at 2.
/// docs/theory.md.
const MARGIN: f64 = 2.0;

/// Most by which a step is shortened because points are being compressed.
const LARGEST_SHORTENING: f64 = 0.5;

/// Factor between thresholds that are tried.
const STRIDE: f64 = 1.3;

/// Change of ω² in a Lanczos step by which the limits of the rest are known well enough: they have
/// [`MARGIN`].
const ROUGHLY: f64 = 0.01;

/// Points with less than this part of the undeformed time are compressed far more than the rest: the
/// fastest vibrations are among them.
const SOFT: f64 = 0.5;

/// Part of the largest step of the rest from which on larger groups do not help.
const SATURATED: f64 = 0.98;

/// Most thresholds that are tried.
const MOST_THRESHOLDS: usize = 24;

/// Levels, 0 included.
const LEVELS: usize = LARGEST_LEVEL as usize + 1;

/// A threshold that is tried.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// s.
    threshold: f64,
    /// Points below it, with their surroundings.
    points: f64,
    /// Largest step of the others, s, before the CFL number.
    rest: f64,
}

/// What groups are worth.
#[derive(Clone, Copy, Debug)]
struct Outcome {
    finest: u8,
    /// Of the levels from 1 on, s; zero beyond the finest.
    thresholds: [f64; LEVELS],
    /// Largest step of the finest level, s, before the CFL number.
    limit: f64,
    /// Simulated time per work on a point of equal steps, s.
    speed: f64,
}

/// The levels in use: points whose time Δx λ_min / c is below a threshold, and their surroundings. Now and
/// then limits and levels are computed anew, from several thresholds.
#[derive(Clone, Debug)]
pub(super) struct Choice {
    frequency: Frequency,
    /// What the frequency needs of a workspace: that of the simulation is in use while this one is asked.
    work: Workspace,
    largest_level: u8,
    /// Δx λ_min / c of every point, s.
    point_time: Vec<f64>,
    /// Smallest of the undeformed bodies, s.
    undeformed_time: f64,
    trial: Vec<Groups>,
    regions: Vec<Region>,
    candidates: Vec<Candidate>,
    finest: u8,
    /// Limit of the sub-step at the last choice, s.
    limit: f64,
    /// Smallest times of the points of the levels at the last choice, s; infinite when there are none.
    times: [f64; LEVELS],
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
            largest_level: u8::try_from(scheme.substeps.ilog2())
                .map_or(LARGEST_LEVEL, |level| level.min(LARGEST_LEVEL)),
            point_time: vec![0.0; reference.point_volume.len()],
            undeformed_time: reference
                .bodies
                .iter()
                .map(|body| body.spacing / body.wave_speed)
                .fold(f64::INFINITY, f64::min),
            trial: reference.bodies.iter().map(Groups::new).collect(),
            regions: reference.bodies.iter().map(Region::new).collect(),
            candidates: Vec::with_capacity(MOST_THRESHOLDS),
            finest: 0,
            limit: 0.0,
            times: [f64::INFINITY; LEVELS],
            previous: 0.0,
            step: 0,
        }
    }

    /// The finest level in use.
    pub(super) fn finest(&self) -> u8 {
        self.finest
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
    pub(super) fn renew(&mut self, simulation: &Simulation, groups: &mut [Groups]) {
        let Simulation {
            reference, state, ..
        } = simulation;
        for body in &reference.bodies {
            for q in body.points.clone() {
                self.point_time[q] = point_time(body, &state.deformation_gradient[q]);
            }
        }
        let limit = self.survey(simulation);
        let outcome = self.best(limit);
        let thresholds = &outcome.thresholds[..usize::from(outcome.finest)];
        for (body, groups) in reference.bodies.iter().zip(&mut *groups) {
            let time = &self.point_time[body.points.clone()];
            groups.choose(body, |q| {
                thresholds
                    .iter()
                    .map(|threshold| u8::from(time[q] < *threshold))
                    .sum()
            });
        }
        self.finest = outcome.finest;
        self.limit = outcome.limit;
        self.times = stretch_limits(simulation, groups).map(|step| step.time);
        self.step = simulation.step + 1;
    }

    /// Finds what several thresholds would allow, and returns 2/ω_max of the bodies, s.
    ///
    /// The fastest vibrations of what is compressed stay there: they are looked for in its
    /// surroundings only.
    pub(super) fn survey(&mut self, simulation: &Simulation) -> f64 {
        let smallest = self.point_time.iter().fold(f64::INFINITY, |a, b| a.min(*b));
        self.candidates.clear();
        let all = self.point_time.len();
        let mut trial = std::mem::take(&mut self.trial);
        let mut widest = (SOFT * self.undeformed_time).max(smallest * STRIDE * STRIDE);
        let mut most = self.group(simulation, &mut trial, widest);
        while 2 * most > all && widest > smallest {
            widest /= STRIDE;
            most = self.group(simulation, &mut trial, widest);
        }
        let mut regions = std::mem::take(&mut self.regions);
        let bodies = simulation.reference.bodies.iter();
        for ((body, groups), region) in bodies.zip(&trial).zip(&mut regions) {
            region.around(body, groups);
        }
        let inside = self.limit_of(simulation, None, (Some(&regions), CONVERGED));
        let mut rest = f64::INFINITY;
        if self.finest > 0 {
            rest = self.limit_of(simulation, Some(&trial), (None, ROUGHLY));
        }
        if self.finest == 0 || rest < MARGIN * inside {
            // It may be the limit of all.
            rest = self.limit_of(simulation, Some(&trial), (None, CONVERGED));
        }
        let limit = rest.min(inside);
        let mut last = 0;
        let mut threshold = smallest * STRIDE;
        while rest > MARGIN * limit
            && threshold < widest
            && self.candidates.len() + 1 < MOST_THRESHOLDS
        {
            let fine = self.group(simulation, &mut trial, threshold);
            if fine > last && fine < most {
                let own = self.limit_of(simulation, Some(&trial), (Some(&regions), ROUGHLY));
                self.candidates.push(Candidate {
                    threshold,
                    points: fine as f64,
                    rest: rest.min(own) / MARGIN,
                });
                if own > SATURATED * rest {
                    break;
                }
                last = fine;
            }
            threshold *= STRIDE;
        }
        self.candidates.push(Candidate {
            threshold: widest,
            points: most as f64,
            rest: rest / MARGIN,
        });
        self.trial = trial;
        self.regions = regions;
        limit
    }

    /// 2/ω_max of the bodies, or of some of their vibrations, s.
    fn limit_of(
        &mut self,
        simulation: &Simulation,
        without: Option<&[Groups]>,
        (region, tolerance): (Option<&[Region]>, f64),
    ) -> f64 {
        let Simulation {
            reference,
            state,
            scheme,
            ..
        } = simulation;
        let vibrations = Vibrations {
            without,
            region,
            tolerance,
        };
        self.frequency
            .limit(&mut self.work, reference, scheme, state, vibrations)
    }

    /// Makes the groups of a threshold and returns the number of fine points.
    fn group(&self, simulation: &Simulation, groups: &mut [Groups], threshold: f64) -> usize {
        let mut fine = 0;
        for (body, groups) in simulation.reference.bodies.iter().zip(groups) {
            let time = &self.point_time[body.points.clone()];
            groups.choose(body, |q| u8::from(time[q] < threshold));
            fine += groups.points.count(Levels::from(1));
        }
        fine
    }

    /// The best levels of those that the candidates make, where `limit` is the largest step of the whole
    /// bodies. `[eq:local-limit]`
    fn best(&self, limit: f64) -> Outcome {
        let points = self.point_time.len() as f64;
        let mut best = Outcome {
            finest: 0,
            thresholds: [0.0; LEVELS],
            limit,
            speed: limit / points,
        };
        for (k, outermost) in self.candidates.iter().enumerate() {
            for finest in 1..=self.largest_level {
                let step = outermost.rest.min(limit / share(finest));
                let mut thresholds = [0.0; LEVELS];
                let mut work = points - outermost.points;
                // The level that is looked at, with what is finer.
                let mut around = *outermost;
                for level in 1..=finest {
                    thresholds[usize::from(level) - 1] = around.threshold;
                    let inner = if level == finest {
                        None
                    } else {
                        let own = step * share(level);
                        self.candidates[..=k].iter().find(|inner| inner.rest >= own)
                    };
                    let finer = inner.map_or(0.0, |inner| inner.points.min(around.points));
                    work += FINE_WORK * (around.points - finer) / share(level);
                    if let Some(inner) = inner.filter(|inner| inner.points < around.points) {
                        around = *inner;
                    }
                }
                let speed = step / work;
                if speed > best.speed {
                    best = Outcome {
                        finest,
                        thresholds,
                        limit: step * share(finest),
                        speed,
                    };
                }
            }
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
        let stable = now
            .iter()
            .fold(now[0], |a, b| if b.time < a.time { *b } else { a });
        // The last sub-step of the step that follows sees what one step more has compressed.
        if self.previous > 0.0 {
            change *= (stable.time / self.previous).clamp(LARGEST_SHORTENING, 1.0);
        }
        self.previous = stable.time;
        let sub_step = simulation.scheme.cfl * self.limit * change;
        simulation.check_time_step(sub_step, &stable)?;
        Ok(simulation.cut_at(end, sub_step / share(self.finest)))
    }

    /// What a restart needs.
    #[expect(clippy::cast_precision_loss, reason = "no run makes 2^53 steps")]
    pub(super) fn saved(&self) -> [f64; 4 + LEVELS] {
        let mut saved = [0.0; 4 + LEVELS];
        saved[..4].copy_from_slice(&[
            f64::from(self.finest),
            self.limit,
            self.step as f64,
            self.previous,
        ]);
        saved[4..].copy_from_slice(&self.times);
        saved
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "written by `saved`"
    )]
    pub(super) fn restore(&mut self, saved: &[f64]) {
        self.finest = (saved[0] as u8).min(self.largest_level);
        self.limit = saved[1];
        self.step = saved[2] as u64;
        self.previous = saved[3];
        self.times.copy_from_slice(&saved[4..]);
    }
}

/// Limits by stretch of the points of the levels.
pub(super) type StretchLimits = [StableStep; LEVELS];

/// The limits by stretch at the present state.
pub(super) fn stretch_limits(simulation: &Simulation, groups: &[Groups]) -> StretchLimits {
    let reference = &simulation.reference;
    let state = (&simulation.state, &simulation.work.stretch_bounds);
    let mut level = 0;
    [(); LEVELS].map(|()| {
        let step = stable_step_of_part(reference, state, (groups, level));
        level += 1;
        step
    })
}
