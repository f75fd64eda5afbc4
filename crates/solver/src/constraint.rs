//! What fixes momenta from outside: prescribed velocities and contact with rigid obstacles.

use jstsph_contact::{CachedGap, ContactStep, Exchange, Surface, Wall};
use jstsph_tensor::Vec3;

use crate::books::{Impulse, Ledger, Met, Page};
use crate::force::vector;
use crate::model::{Condition, ConditionKind, Model, ModelObstacle};
use crate::parallel::{self, CHUNK};
use crate::reference::{BodyReference, Reference};
use crate::state::State;

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

    /// Particles of the simulation that conditions hold, each with the condition.
    pub(crate) fn held(&self, reference: &Reference) -> impl Iterator<Item = (usize, usize)> {
        let conditions = self.conditions.iter().enumerate();
        conditions.flat_map(|(k, condition)| {
            let first = reference.bodies[condition.body].particles.start;
            let particles = condition.particles.iter();
            particles.map(move |&particle| (first + particle as usize, k))
        })
    }

    /// Sets the components of a momentum that a condition prescribes to those at `time`, and returns the
    /// change.
    pub(crate) fn hold(
        &self,
        condition: usize,
        (density, position): (f64, &Vec3),
        time: f64,
        momentum: &mut Vec3,
    ) -> Vec3 {
        let mut change = Vec3::zeros();
        if let ConditionKind::Velocity(components) = &self.conditions[condition].kind {
            for (axis, signal) in components.iter().enumerate() {
                if let Some(signal) = signal {
                    let prescribed = density * signal.at(time, position);
                    change[axis] = prescribed - momentum[axis];
                    momentum[axis] = prescribed;
                }
            }
        }
        change
    }

    /// Sets the prescribed components of all momenta to those at `time` and books the impulse
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
            let body = &reference.bodies[condition.body];
            let mut total = Vec3::zeros();
            for &particle in &condition.particles {
                let a = body.particles.start + particle as usize;
                let place = (body.density, &reference.position[a]);
                let change = self.hold(k, place, time, &mut momentum[a]);
                // None are kept before the first kick of the leapfrog.
                if let Some(impulse) = ledger.impulse.get_mut(a) {
                    impulse.external += change * factor;
                }
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

    /// Whether a particle in its reference position is nearer to a wall than its spacing.
    pub(crate) fn is_near(&self, reference: &Reference, a: usize) -> bool {
        let spacing = reference.bodies[reference.owner_of_particle(a).0].spacing;
        let x = &reference.position[a];
        self.parts.iter().any(|&(o, part)| {
            let surface = &self.obstacles[o].obstacle.surface;
            surface.gap_of(part, x).distance < spacing
        })
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
    /// particle, and keeps the impulses. `time` and `dt` are the beginning and length of the travel that
    /// these momenta are going to make.
    pub(crate) fn apply(
        &self,
        reference: &Reference,
        time: f64,
        dt: f64,
        stage: Stage,
        state: &mut State,
        ledger: &mut Ledger,
    ) {
        if self.parts.is_empty() {
            return;
        }
        let travel = self.travel(time, dt, stage);
        let Ledger { impulse, pages, .. } = ledger;
        for body in &reference.bodies {
            let near = self.near(&travel, body);
            let arrays = (
                &mut state.position[..],
                &mut state.momentum[..],
                &mut impulse[..],
            );
            let range = body.particles.clone();
            parallel::for_each_page(range, arrays, pages, |first, x, p, impulse, page| {
                for (k, ((x, p), impulse)) in x.iter_mut().zip(p).zip(impulse).enumerate() {
                    near.meet(
                        page,
                        (first + k) % CHUNK,
                        reference.volume[first + k],
                        (x, p, impulse),
                    );
                }
            });
        }
    }

    /// The walls as the particles of a body see them.
    pub(crate) fn near<'a>(&'a self, travel: &'a Travel, body: &BodyReference) -> Near<'a> {
        Near {
            obstacles: self,
            travel,
            step: ContactStep {
                dt: travel.dt,
                tolerance: CONTACT_TOLERANCE * body.spacing,
                density: body.density,
                max_penetration: LARGEST_PENETRATION * body.spacing,
            },
            // At least the travel of a particle relative to a wall: see `Wall::resolve_cached`.
            per_momentum: travel.dt / body.density * REACH_MARGIN,
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

    fn wall(&self, (o, part): (usize, usize), velocities: &[Vec3]) -> Wall<'_> {
        Wall {
            obstacle: &self.obstacles[o].obstacle,
            part,
            displacement: self.displacement[o],
            velocity: velocities[o],
        }
    }
}

/// All walls during one travel of the particles of a body.
pub(crate) struct Near<'a> {
    obstacles: &'a Obstacles,
    travel: &'a Travel,
    step: ContactStep,
    per_momentum: f64,
}

impl Near<'_> {
    /// Contact and friction of the particle at `place` of a page, with its position, momentum and impulse.
    #[inline]
    pub(crate) fn meet(
        &self,
        page: &mut Page,
        place: usize,
        volume: f64,
        (x, p, impulse): (&mut Vec3, &mut Vec3, &mut Impulse),
    ) {
        let (obstacles, step) = (self.obstacles, &self.step);
        let parts = &obstacles.parts;
        let stage = self.travel.stage;
        let group = place * parts.len()..(place + 1) * parts.len();
        let Page { gaps, met, .. } = page;
        if stage.begins()
            && let Some(met) = met
        {
            for slot in &mut met.slots[group.clone()] {
                slot.given = Exchange::default();
            }
        }
        let gaps = &mut gaps[group.clone()];
        // Most particles are far from all walls, which takes one root to see.
        let travel = p.norm() * self.per_momentum;
        let far = |(gap, (o, _)): (&CachedGap, &(usize, usize))| {
            let reach =
                step.tolerance + travel + self.travel.speeds[*o] * self.travel.dt * REACH_MARGIN;
            !gap.needs_check(&(*x - obstacles.displacement[*o]), reach)
        };
        if gaps.iter().zip(parts).all(far) {
            return;
        }
        let mut particle = Particle {
            x,
            p,
            impulse,
            volume,
            stage,
            met,
            parts: parts.len(),
        };
        let mut rubbed = false;
        for ((gap, part), slot) in gaps.iter_mut().zip(parts).zip(group.clone()) {
            let wall = obstacles.wall(*part, &self.travel.velocities);
            let normal = particle.meet(&wall, (gap, slot), step);
            rubbed |= particle.rub(&wall, slot, normal, step);
        }
        // Friction along one wall may point into another: none is entered in the end.
        if rubbed {
            for ((gap, part), slot) in gaps.iter_mut().zip(parts).zip(group) {
                let wall = obstacles.wall(*part, &self.travel.velocities);
                particle.meet(&wall, (gap, slot), step);
            }
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
    met: &'a mut Option<Box<Met>>,
    /// Obstacle parts.
    parts: usize,
}

impl Particle<'_> {
    /// Applies the contact law and returns its impulse per unit volume.
    #[inline]
    fn meet(
        &mut self,
        wall: &Wall<'_>,
        (gap, slot): (&mut CachedGap, usize),
        step: &ContactStep,
    ) -> Vec3 {
        let Some(resolution) = wall.resolve_cached(gap, self.x, self.p, step) else {
            return Vec3::zeros();
        };
        let slot = &mut Page::opened(self.met, self.parts).slots[slot];
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
    fn rub(&mut self, wall: &Wall<'_>, slot: usize, normal: Vec3, step: &ContactStep) -> bool {
        // Where there is no slot nothing was ever given.
        let Some(met) = self.met else {
            return false;
        };
        let slot = &mut met.slots[slot];
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
