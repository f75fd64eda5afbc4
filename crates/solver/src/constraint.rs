//! What fixes momenta from outside: prescribed velocities and contact with rigid obstacles.

use jstsph_contact::{CachedGap, ContactStep, Surface, Wall};
use jstsph_tensor::Vec3;

use crate::force::vector;
use crate::model::{Condition, ConditionKind, Model, ModelObstacle};
use crate::parallel;
use crate::reference::Reference;
use crate::state::{ContactSlot, Ledger, State};

/// Gap below which a particle touches a wall, as a fraction of the spacing: a node that lies on
/// the wall must count as touching, or it keeps an inward momentum that its strains feel.
pub(crate) const CONTACT_TOLERANCE: f64 = 1e-6;

/// Penetration above which a particle is put back, as a fraction of the spacing.
const LARGEST_PENETRATION: f64 = 1e-4;

/// Prescribed velocities.
#[derive(Clone, Debug)]
pub(crate) struct Prescribed {
    conditions: Vec<Condition>,
}

impl Prescribed {
    pub(crate) fn new(model: &Model) -> Self {
        Self {
            conditions: model
                .conditions
                .iter()
                .filter(|condition| matches!(condition.kind, ConditionKind::Velocity(_)))
                .cloned()
                .collect(),
        }
    }

    /// Names, in the order of the impulses of the ledger.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.conditions
            .iter()
            .map(|condition| condition.name.as_str())
    }

    /// Number of conditions.
    pub(crate) fn len(&self) -> usize {
        self.conditions.len()
    }

    /// Sets the prescribed components of the momentum to those at `time` and books the impulse
    /// with the given factor. Later conditions win where they overlap.
    pub(crate) fn apply(
        &self,
        reference: &Reference,
        time: f64,
        factor: f64,
        momentum: &mut [Vec3],
        ledger: &mut Ledger,
    ) {
        for (k, condition) in self.conditions.iter().enumerate() {
            let ConditionKind::Velocity(components) = &condition.kind else {
                continue;
            };
            let body = &reference.bodies[condition.body];
            let mut total = Vec3::zeros();
            for &particle in &condition.particles {
                let a = body.particles.start + particle as usize;
                let mut change = Vec3::zeros();
                for (axis, signal) in components.iter().enumerate() {
                    if let Some(signal) = signal {
                        let prescribed = body.density * signal.at(time, &reference.position[a]);
                        change[axis] = prescribed - momentum[a][axis];
                        momentum[a][axis] = prescribed;
                    }
                }
                ledger.impulse[a].external += change * factor;
                total += change * (factor * reference.volume[a]);
            }
            ledger.condition_impulse[k] += total;
        }
    }
}

/// Rigid obstacles and where they are.
#[derive(Clone, Debug)]
pub(crate) struct Obstacles {
    obstacles: Vec<ModelObstacle>,
    /// Obstacle and part of every contact slot of a particle.
    parts: Vec<(usize, usize)>,
    /// Displacement of each obstacle so far, m.
    pub(crate) displacement: Vec<Vec3>,
}

impl Obstacles {
    pub(crate) fn new(model: &Model) -> Self {
        let parts = model
            .obstacles
            .iter()
            .enumerate()
            .flat_map(|(o, obstacle)| {
                (0..Surface::parts(&obstacle.obstacle.surface)).map(move |part| (o, part))
            })
            .collect();
        Self {
            obstacles: model.obstacles.clone(),
            parts,
            displacement: vec![Vec3::zeros(); model.obstacles.len()],
        }
    }

    /// Contact slots per particle.
    pub(crate) fn slots(&self) -> usize {
        self.parts.len()
    }

    /// Slots of a particle before anything happened.
    pub(crate) fn new_slots(&self, particles: usize) -> Vec<ContactSlot> {
        let slot = ContactSlot {
            cache: CachedGap::default(),
            impulse: Vec3::zeros(),
            corrections: 0,
        };
        vec![slot; particles * self.parts.len()]
    }

    /// The obstacles.
    pub(crate) fn obstacles(&self) -> &[ModelObstacle] {
        &self.obstacles
    }

    /// Which obstacle each slot of a particle belongs to.
    pub(crate) fn owners(&self) -> impl Iterator<Item = usize> {
        self.parts.iter().map(|(o, _)| *o)
    }

    /// Velocity of an obstacle at `time`, m/s.
    fn velocity(&self, obstacle: usize, time: f64) -> Vec3 {
        self.obstacles[obstacle]
            .velocity
            .as_ref()
            .map_or_else(Vec3::zeros, |signals| vector(signals, time, &Vec3::zeros()))
    }

    /// Moves the obstacles from `time` over `dt`, midpoint rule.
    pub(crate) fn advance(&mut self, time: f64, dt: f64) {
        for o in 0..self.obstacles.len() {
            let velocity = self.velocity(o, time + 0.5 * dt);
            self.displacement[o] += velocity * dt;
        }
    }

    /// Corrects the momentum (and, where a particle is deep in a wall, the position) of every
    /// particle. `time` and `dt` are the beginning and length of the travel that these momenta
    /// are going to make; impulses are booked with `factor`.
    pub(crate) fn apply(
        &self,
        reference: &Reference,
        time: f64,
        dt: f64,
        factor: f64,
        state: &mut State,
        ledger: &mut Ledger,
    ) {
        if self.parts.is_empty() {
            return;
        }
        let mut velocities = [Vec3::zeros(); MAX_OBSTACLES];
        for (o, velocity) in velocities.iter_mut().enumerate().take(self.obstacles.len()) {
            *velocity = self.velocity(o, time + 0.5 * dt);
        }
        let slots = self.parts.len();
        for body in &reference.bodies {
            let range = body.particles.clone();
            let step = ContactStep {
                dt,
                tolerance: CONTACT_TOLERANCE * body.spacing,
                density: body.density,
                max_penetration: LARGEST_PENETRATION * body.spacing,
            };
            let volume = &reference.volume[range.clone()];
            let contact = &mut ledger.contact[range.start * slots..range.end * slots];
            let particles = (
                &mut state.position[range.clone()],
                &mut state.momentum[range.clone()],
                &mut ledger.impulse[range.clone()],
            );
            parallel::for_each_with_group(particles, contact, slots, |a, x, p, impulse, group| {
                for (slot, &(o, part)) in group.iter_mut().zip(&self.parts) {
                    let wall = Wall {
                        obstacle: &self.obstacles[o].obstacle,
                        part,
                        displacement: self.displacement[o],
                        velocity: velocities[o],
                    };
                    if let Some(resolution) = wall.resolve_cached(&mut slot.cache, x, p, &step) {
                        let change = resolution.momentum - *p;
                        *p = resolution.momentum;
                        impulse.contact += change * factor;
                        slot.impulse += change * (factor * volume[a]);
                        if let Some(position) = resolution.position {
                            *x = position;
                            slot.corrections += 1;
                        }
                    }
                }
            });
        }
    }
}

/// Most obstacles of one model; their velocities live on the stack of a step.
pub(crate) const MAX_OBSTACLES: usize = 64;

#[cfg(test)]
mod tests;
