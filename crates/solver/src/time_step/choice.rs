//! The step a run takes next: the stable one by the chosen limit, cut at the end.

use super::{StableStep, stable_step};
use crate::SolverError;
use crate::acoustic::{Frequency, Vibrations};
use crate::model::{Integrator, Scheme, StepLimit};
use crate::reference::Reference;
use crate::simulation::Simulation;
use crate::state::{State, Workspace};

/// Steps after which the frequency of the deformed bodies is computed again at the latest: it costs
/// about as much as eight steps.
const LATEST: u64 = 256;

/// Steps before which it is not.
const EARLIEST: u64 = 32;

/// Relative change of the stretch limit by which it is computed again in between.
const CHANGE: f64 = 0.05;

/// The largest frequency of the deformed bodies, computed now and then. In between the step follows
/// the smallest stretch.
#[derive(Clone, Debug)]
pub(crate) struct AcousticLimit {
    frequency: Frequency,
    /// 2/ω_max over the time of [`stable_step`] at the last look; zero before the first.
    gain: f64,
    /// Time of [`stable_step`] at the last look, s.
    time: f64,
    /// Step of the last look.
    step: u64,
}

impl AcousticLimit {
    /// For schemes that ask for it.
    pub(crate) fn new(scheme: &Scheme, reference: &Reference) -> Option<Box<Self>> {
        (scheme.step_limit == StepLimit::Acoustic).then(|| {
            Box::new(Self {
                frequency: Frequency::new(reference),
                gain: 0.0,
                time: 0.0,
                step: 0,
            })
        })
    }

    /// Looks again if that is due. `time` is that of [`stable_step`].
    fn renew(
        &mut self,
        work: &mut Workspace,
        reference: &Reference,
        scheme: &Scheme,
        state: &State,
        (time, step): (f64, u64),
    ) {
        let age = step - self.step;
        let changed = (time - self.time).abs() > CHANGE * self.time;
        if self.gain == 0.0 || age >= LATEST || (changed && age >= EARLIEST) {
            self.gain = self
                .frequency
                .limit(work, reference, scheme, state, Vibrations::default())
                / time;
            self.time = time;
            self.step = step;
        }
    }

    /// What a restart needs.
    #[expect(clippy::cast_precision_loss, reason = "no run makes 2^53 steps")]
    pub(crate) fn saved(&self) -> [f64; 3] {
        [self.gain, self.time, self.step as f64]
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "written by `saved`"
    )]
    pub(crate) fn restore(&mut self, saved: &[f64]) {
        (self.gain, self.time, self.step) = (saved[0], saved[1], saved[2] as u64);
    }
}

impl Simulation {
    /// The stable time step of the present state, s, CFL number included.
    #[must_use]
    pub fn stable_time_step(&self) -> f64 {
        let time = self.stretch_limit().time;
        let gain = self.acoustic.clone().map_or(1.0, |mut limit| {
            let now = (time, self.step);
            let work = &mut Workspace::of_strains(&self.reference);
            limit.renew(work, &self.reference, &self.scheme, &self.state, now);
            limit.gain
        });
        self.scheme.cfl * gain * time
    }

    fn stretch_limit(&self) -> StableStep {
        stable_step(&self.reference, &self.state, &self.work.stretch_bounds)
    }

    /// Looks at the frequency of the deformed bodies if that is due. With the leapfrog the stresses of the
    /// workspace are overwritten, in the middle of a step when they are no longer needed; with other methods
    /// the velocity gradients, at its beginning.
    pub(crate) fn renew_acoustic_limit(&mut self) {
        let time = self.stretch_limit().time;
        // Strains that are not finite are found where the step is chosen.
        if let Some(limit) = self.acoustic.as_mut().filter(|_| time.is_finite()) {
            let (now, work) = ((time, self.step), &mut self.work);
            let leapfrog = self.scheme.integrator == Integrator::Leapfrog;
            if leapfrog {
                std::mem::swap(&mut work.velocity_gradient, &mut work.scaled_stress);
            }
            limit.renew(work, &self.reference, &self.scheme, &self.state, now);
            if leapfrog {
                std::mem::swap(&mut work.velocity_gradient, &mut work.scaled_stress);
            }
        }
    }

    /// Δt = CFL min Δx λ_min / c (3.17), or the acoustic limit, cut at `end`; checks that strains are
    /// finite.
    pub(crate) fn next_time_step(&mut self, end: f64) -> Result<f64, SolverError> {
        let stable = self.stretch_limit();
        if !stable.time.is_finite() {
            return Err(self.not_finite(stable.point));
        }
        let gain = self.acoustic.as_ref().map_or(1.0, |limit| limit.gain);
        let dt = self.scheme.cfl * stable.time * gain;
        self.check_time_step(dt, &stable)?;
        Ok(self.cut_at(end, dt))
    }

    /// Remembers the first step and refuses one far below it.
    pub(crate) fn check_time_step(
        &mut self,
        dt: f64,
        stable: &StableStep,
    ) -> Result<(), SolverError> {
        self.smallest_stretch = stable.stretch;
        if self.first_dt == 0.0 {
            self.first_dt = dt;
        }
        let limit = self.scheme.smallest_time_step * self.first_dt;
        if dt < limit {
            return Err(self.too_small(dt, limit, stable));
        }
        Ok(())
    }

    /// A step of `dt` that does not go beyond `end`.
    pub(crate) fn cut_at(&self, end: f64, dt: f64) -> f64 {
        // A last step below a thousandth of the stable one would come from round-off in the sum of
        // steps; the present one is stretched over it instead.
        let rest = end - self.time;
        if rest <= dt * 1.001 { rest } else { dt }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Integrator, Quadrature};
    use crate::state::StretchBounds;
    use crate::testing::{elastic, model, scheme};
    use jstsph_tensor::Mat3;

    #[test]
    fn the_frequency_is_computed_when_it_is_old_or_the_stretch_has_changed() {
        let scheme = Scheme {
            step_limit: StepLimit::Acoustic,
            ..scheme(Quadrature::Bonds, Integrator::Leapfrog)
        };
        let simulation = Simulation::new(model([5, 4, 3], elastic(), scheme)).unwrap();
        let (reference, mut state) = (simulation.reference(), simulation.state().clone());
        let mut limit = AcousticLimit::new(&scheme, reference).unwrap();
        let mut gain = |state: &State, time: f64, step: u64| {
            let work = &mut Workspace::of_strains(reference);
            limit.renew(work, reference, &scheme, state, (time, step));
            limit.gain
        };
        let time = stable_step(reference, &state, &StretchBounds::default()).time;
        let first = gain(&state, time, 7);
        assert!((0.8..1.4).contains(&first), "{first}");
        let half = Mat3::identity() * 0.5;
        state.deformation_gradient.fill(half);
        // Within the given times and step numbers the old answer stands, whatever the state.
        let marked = 3.0 * time;
        assert_eq!(gain(&state, marked, 7 + EARLIEST - 1), first);
        assert_eq!(
            gain(&state, time * (1.0 + 0.5 * CHANGE), 7 + LATEST - 1),
            first
        );
        let third = gain(&state, marked, 7 + EARLIEST);
        assert!((third * 6.0 / first - 1.0).abs() < 1e-9, "{third}");
        let last = gain(&state, marked, 7 + EARLIEST + LATEST);
        assert_eq!(last, third);
        state.deformation_gradient[0].m11 = f64::NAN;
        let broken = gain(&state, marked, 8 + EARLIEST + 2 * LATEST);
        assert!(!(broken * marked).is_normal());
    }
}
