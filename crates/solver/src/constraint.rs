//! What fixes momenta from outside: prescribed velocities and contact with rigid obstacles.

use std::ops::Range;

use jstsph_contact::{CachedGap, ContactStep, Exchange, Surface, Wall};
use jstsph_tensor::Vec3;

use crate::force::vector;
use crate::model::{Condition, ConditionKind, Model, ModelObstacle};
use crate::parallel;
use crate::reference::{BodyReference, Reference};
use crate::state::{ContactSlot, Impulse, Ledger, State};

/// Gap below which a particle touches a wall, as a fraction of the spacing: a node that lies on
/// the wall must count as touching, or it keeps an inward momentum that its strains feel.
pub(crate) const CONTACT_TOLERANCE: f64 = 1e-6;

/// Penetration above which a particle is put back, as a fraction of the spacing.
const LARGEST_PENETRATION: f64 = 1e-4;

/// Above one by more than the rounding of a norm and a product.
const REACH_MARGIN: f64 = 1.0 + 1e-12;

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
        self.apply_where(reference, (time, factor), momentum, ledger, |_, _| true);
    }

    /// The same for the particles of each body, counted in it, for which `chosen(body, particle)` holds.
    pub(crate) fn apply_where(
        &self,
        reference: &Reference,
        (time, factor): (f64, f64),
        momentum: &mut [Vec3],
        ledger: &mut Ledger,
        chosen: impl Fn(usize, usize) -> bool,
    ) {
        for (k, condition) in self.conditions.iter().enumerate() {
            let ConditionKind::Velocity(components) = &condition.kind else {
                continue;
            };
            let body = &reference.bodies[condition.body];
            let mut total = Vec3::zeros();
            for &particle in &condition.particles {
                if !chosen(condition.body, particle as usize) {
                    continue;
                }
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
            given: Exchange::default(),
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
    /// are going to make.
    pub(crate) fn apply(
        &self,
        reference: &Reference,
        time: f64,
        dt: f64,
        stage: Stage,
        state: &mut State,
        ledger: &mut Ledger,
    ) {
        let travel = self.travel(time, dt, stage);
        for (body, range) in reference
            .bodies
            .iter()
            .map(|body| (body, 0..body.particles.len()))
        {
            self.meet(&travel, (body, range), reference, state, ledger);
        }
    }

    /// How the obstacles move while particles travel over `dt` from `time`.
    pub(crate) fn travel(&self, time: f64, dt: f64, stage: Stage) -> Travel {
        let mut velocities = [Vec3::zeros(); MAX_OBSTACLES];
        for (o, velocity) in velocities.iter_mut().enumerate().take(self.obstacles.len()) {
            *velocity = self.velocity(o, time + 0.5 * dt);
        }
        Travel {
            dt,
            stage,
            velocities,
            speeds: velocities.map(|velocity| velocity.norm()),
        }
    }

    /// [`apply`](Self::apply) for a run of the particles of one body.
    pub(crate) fn meet(
        &self,
        travel: &Travel,
        (body, run): (&BodyReference, Range<usize>),
        reference: &Reference,
        state: &mut State,
        ledger: &mut Ledger,
    ) {
        if self.parts.is_empty() {
            return;
        }
        let slots = self.parts.len();
        let Travel {
            dt,
            stage,
            velocities,
            speeds,
        } = *travel;
        let range = body.particles.start + run.start..body.particles.start + run.end;
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
        // At least the travel of a particle relative to a wall: see `Wall::resolve_cached`.
        let per_momentum = dt / body.density * REACH_MARGIN;
        parallel::for_each_with_group(particles, contact, slots, |a, x, p, impulse, group| {
            if stage.begins() {
                for slot in group.iter_mut() {
                    slot.given = Exchange::default();
                }
            }
            // Most particles are far from all walls, which takes one root to see.
            let travel = p.norm() * per_momentum;
            let far = |(slot, (o, _)): (&ContactSlot, &(usize, usize))| {
                let reach = step.tolerance + travel + speeds[*o] * dt * REACH_MARGIN;
                !slot.cache.needs_check(&(*x - self.displacement[*o]), reach)
            };
            if group.iter().zip(&self.parts).all(far) {
                return;
            }
            let mut particle = Particle {
                x,
                p,
                impulse,
                volume: volume[a],
                stage,
            };
            let mut rubbed = false;
            for (slot, part) in group.iter_mut().zip(&self.parts) {
                let wall = self.wall(*part, &velocities);
                let normal = particle.meet(&wall, slot, &step);
                rubbed |= particle.rub(&wall, slot, normal, &step);
            }
            // Friction along one wall may point into another: none is entered in the end.
            if rubbed {
                for (slot, part) in group.iter_mut().zip(&self.parts) {
                    particle.meet(&self.wall(*part, &velocities), slot, &step);
                }
            }
        });
    }

    fn wall(&self, (o, part): (usize, usize), velocities: &[Vec3]) -> Wall<'_> {
        Wall {
            obstacle: &self.obstacles[o].obstacle,
            part,
            displacement: self.displacement[o],
            velocity: velocities[o],
        }
    }
}

/// How obstacles move during one travel of the particles.
pub(crate) struct Travel {
    dt: f64,
    stage: Stage,
    velocities: [Vec3; MAX_OBSTACLES],
    speeds: [f64; MAX_OBSTACLES],
}

/// A particle that walls act on, and its books.
struct Particle<'a> {
    x: &'a mut Vec3,
    p: &'a mut Vec3,
    impulse: &'a mut Impulse,
    volume: f64,
    stage: Stage,
}

impl Particle<'_> {
    /// Applies the contact law and returns its impulse per unit volume.
    #[inline]
    fn meet(&mut self, wall: &Wall<'_>, slot: &mut ContactSlot, step: &ContactStep) -> Vec3 {
        let Some(resolution) = wall.resolve_cached(&mut slot.cache, self.x, self.p, step) else {
            return Vec3::zeros();
        };
        let change = resolution.momentum - *self.p;
        *self.p = resolution.momentum;
        let factor = self.stage.factor();
        self.impulse.contact += change * factor;
        slot.impulse += change * (factor * self.volume);
        slot.given.normal += change * factor;
        if let Some(position) = resolution.position {
            *self.x = position;
            slot.corrections += 1;
        }
        change
    }

    /// Applies friction after an impulse `normal` of the contact law; whether it changed anything.
    #[inline]
    fn rub(
        &mut self,
        wall: &Wall<'_>,
        slot: &mut ContactSlot,
        normal: Vec3,
        step: &ContactStep,
    ) -> bool {
        let given = if self.stage == Stage::End {
            // The contact law has already added its part to the impulses of the step.
            slot.given
        } else {
            Exchange {
                normal,
                friction: Vec3::zeros(),
            }
        };
        let Some(after) = wall.friction(self.p, &given, step.density) else {
            return false;
        };
        let change = after - *self.p;
        *self.p = after;
        let factor = self.stage.factor();
        self.impulse.friction += change * factor;
        self.impulse.friction_at_walls += change.dot(&wall.velocity) * factor;
        slot.impulse += change * (factor * self.volume);
        slot.given.friction += change * factor;
        true
    }
}

/// Which momenta of a step constraints act on, hence which part of the step their impulses are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stage {
    /// Those after a kick of the leapfrog.
    Whole,
    /// Those within a Runge-Kutta step.
    Within {
        /// Part of an impulse that remains in uⁿ⁺¹.
        factor: f64,
        /// Whether the step begins.
        first: bool,
    },
    /// uⁿ⁺¹ of a Runge-Kutta step. Friction may use what the impulses of the whole step leave of it: a
    /// particle that has come to rest in all stages is at rest, and not at half its velocity.
    End,
}

impl Stage {
    /// Part of an impulse that is felt at the end of the step.
    pub(crate) fn factor(self) -> f64 {
        match self {
            Self::Whole | Self::End => 1.0,
            Self::Within { factor, .. } => factor,
        }
    }

    fn begins(self) -> bool {
        matches!(self, Self::Whole | Self::Within { first: true, .. })
    }
}

/// Most obstacles of one model; their velocities live on the stack of a step.
pub(crate) const MAX_OBSTACLES: usize = 64;

#[cfg(test)]
mod tests;
