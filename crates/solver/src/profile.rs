//! Where the time of a step goes. Nothing here reads a clock: whoever watches brings one.

use std::fmt::Debug;
use std::sync::Arc;

use crate::simulation::Simulation;

/// A part of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Velocity gradients at the points.
    Gradient,
    /// Positions, F, H and J.
    Strain,
    /// Constitutive update and first Piola-Kirchhoff stress.
    Stress,
    /// Internal force.
    Force,
    /// Dissipation, hourglass stiffness, projection, loads.
    Stabilisation,
    /// Momentum, prescribed velocities, contact, and their books.
    Constraint,
    /// The stable time step.
    TimeStep,
    /// Temperatures.
    Heat,
}

impl Phase {
    /// All phases, in the order of their numbers.
    pub const ALL: [Self; 8] = [
        Self::Gradient,
        Self::Strain,
        Self::Stress,
        Self::Force,
        Self::Stabilisation,
        Self::Constraint,
        Self::TimeStep,
        Self::Heat,
    ];

    /// A name for tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Gradient => "gradient",
            Self::Strain => "strain",
            Self::Stress => "stress",
            Self::Force => "force",
            Self::Stabilisation => "stabilisation",
            Self::Constraint => "constraint",
            Self::TimeStep => "time step",
            Self::Heat => "heat",
        }
    }
}

/// Hears when a phase has ended; the next one begins then.
pub trait PhaseObserver: Debug + Send + Sync {
    /// The phase that has just ended.
    fn finished(&self, phase: Phase);
}

/// Who hears where the time goes, if anybody does.
pub(crate) type Observer = Option<Arc<dyn PhaseObserver>>;

impl Simulation {
    /// Tells `observer` about every phase from now on; a clone of the simulation tells it too.
    pub fn watch(&mut self, observer: Arc<dyn PhaseObserver>) {
        self.observer = Some(observer);
    }

    #[inline]
    pub(crate) fn finished(&self, phase: Phase) {
        if let Some(observer) = &self.observer {
            observer.finished(phase);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Quadrature;
    use crate::testing::{INTEGRATORS, elastic, model, scheme};
    use std::sync::Mutex;

    #[derive(Debug, Default)]
    struct Heard(Mutex<Vec<Phase>>);

    impl PhaseObserver for Heard {
        fn finished(&self, phase: Phase) {
            self.0.lock().unwrap().push(phase);
        }
    }

    #[test]
    fn every_phase_of_a_step_is_heard_and_the_state_is_the_same() {
        for integrator in INTEGRATORS {
            let model = model([4, 4, 3], elastic(), scheme(Quadrature::Bonds, integrator));
            let mut plain = Simulation::new(model).unwrap();
            let mut watched = plain.clone();
            let heard = Arc::new(Heard::default());
            watched.watch(heard.clone());
            for _ in 0..3 {
                plain.advance_step(1.0).unwrap();
                watched.advance_step(1.0).unwrap();
            }
            assert_eq!(plain.state(), watched.state());
            let heard = heard.0.lock().unwrap();
            for phase in Phase::ALL {
                assert!(
                    heard.iter().filter(|p| **p == phase).count() >= 3,
                    "{phase:?}"
                );
            }
        }
    }
}
