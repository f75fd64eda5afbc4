//! What contact does to one particle in one step.

use jstsph_tensor::Vec3;

use crate::{CachedGap, Exchange, Gap, Law, Obstacle, Surface};

/// What contact has to know about the step and the particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactStep {
    /// Time over which the particle is going to move with its momentum, s; 0 if not known.
    pub dt: f64,
    /// Gap below which a particle touches the wall, m; about 1e-6 of the particle spacing.
    pub tolerance: f64,
    /// Reference density of the particle, kg/m³.
    pub density: f64,
    /// Penetration up to which the inelastic law leaves a particle where it is, m; about 1e-4 of
    /// the particle spacing. Moving a particle breaks F = ∂x/∂X, so that it is only repaired when
    /// it matters.
    pub max_penetration: f64,
}

/// The state of a particle after contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Momentum per unit reference volume, kg m⁻² s⁻¹. The impulse on the obstacle is the volume
    /// times the momentum before minus this.
    pub momentum: Vec3,
    /// New position, m, if the particle had to be moved out of the wall; worth counting.
    pub position: Option<Vec3>,
    /// Gap before anything was changed, m.
    pub gap: f64,
}

/// One part of an obstacle where it is now: what a loop over particles works with.
#[derive(Clone, Copy, Debug)]
pub struct Wall<'a> {
    /// The obstacle.
    pub obstacle: &'a Obstacle,
    /// Which part of its surface, below [`Surface::parts`].
    pub part: usize,
    /// How far the obstacle has moved from where it was defined, m.
    pub displacement: Vec3,
    /// Its velocity, m/s.
    pub velocity: Vec3,
}

/// What contact with one part of an obstacle, friction included, does to one particle; `None` if
/// nothing.
///
/// ```text
///   d = gap(x − displacement),    v_n = (p/ρ − velocity) · n
///   inelastic, touching (d ≤ tolerance):   v_n < 0      →  v_n = −e v_n
///   inelastic, ahead of the wall:          v_n < −d/dt  →  v_n = −d/dt
///   reflection, d < 0:                     x = x − d n, and v_n < 0  →  v_n = −v_n
/// ```
///
/// After the inelastic law a particle can reach the wall by the end of the step but not pass it. It is
/// put back on the wall only when it is deeper than `max_penetration`. In a sharp corner of a
/// [`Chain`](crate::Chain) that points into the wall the law holds for both edges. The components
/// of the momentum along the wall are changed by [`Wall::friction`] alone.
///
/// Source: Greto & Kulasegaram 2019, Sect. 4.3 (reflection); docs/theory.md (inelastic).
///
/// # Arguments
/// * `part`: which part of the surface; a particle in a corner between parts is resolved with
///   each in turn.
/// * `displacement`, `velocity`: the rigid translation of the obstacle, m and m/s.
/// * `x`: position, m.
/// * `p`: momentum per unit reference volume, kg m⁻² s⁻¹.
///
/// # Panics
/// If `part` is not below [`Surface::parts`]: a bug in the caller.
///
/// # Limits
/// Parts that meet at an acute angle disturb each other's result: what is left shrinks with every
/// round over the parts. The wall is taken as straight over the travel of one step.
#[must_use]
pub fn resolve(
    obstacle: &Obstacle,
    part: usize,
    displacement: &Vec3,
    velocity: &Vec3,
    x: &Vec3,
    p: &Vec3,
    step: &ContactStep,
) -> Option<Resolution> {
    let wall = Wall {
        obstacle,
        part,
        displacement: *displacement,
        velocity: *velocity,
    };
    wall.resolve(x, p, step)
}

impl Wall<'_> {
    /// As [`resolve`].
    #[must_use]
    pub fn resolve(&self, x: &Vec3, p: &Vec3, step: &ContactStep) -> Option<Resolution> {
        let mut cache = CachedGap::UNKNOWN;
        let mut resolution = self.resolve_cached(&mut cache, x, p, step)?;
        let given = Exchange {
            normal: resolution.momentum - p,
            friction: Vec3::zeros(),
        };
        if let Some(momentum) = self.friction(&resolution.momentum, &given, step.density) {
            resolution.momentum = momentum;
        }
        Some(resolution)
    }

    /// The contact law of [`resolve`] without friction, with the same bits, but cheap for a
    /// particle far from the wall.
    ///
    /// # Arguments
    /// * `cache`: belongs to this particle and this part; rewritten when the gap is computed.
    #[inline]
    #[must_use]
    pub fn resolve_cached(
        &self,
        cache: &mut CachedGap,
        x: &Vec3,
        p: &Vec3,
        step: &ContactStep,
    ) -> Option<Resolution> {
        let local = x - self.displacement;
        let travel = (p / step.density - self.velocity).norm() * step.dt;
        let reach = step.tolerance + travel;
        if !cache.needs_check(&local, reach) {
            return None;
        }
        let gap = self.obstacle.surface.gap_of(self.part, &local);
        *cache = CachedGap::new(&local, gap.distance);
        if gap.distance > reach {
            return None;
        }
        match self.obstacle.law {
            Law::Inelastic { restitution } => self.inelastic(restitution, &local, &gap, p, step),
            Law::Reflection => self.reflection(&local, &gap, p, step),
        }
    }

    fn inelastic(
        &self,
        restitution: f64,
        local: &Vec3,
        gap: &Gap,
        p: &Vec3,
        step: &ContactStep,
    ) -> Option<Resolution> {
        let demand = |face: &Gap| self.demand(restitution, face, p, step);
        let momentum = match self.corner_faces(local) {
            None => demand(gap).and_then(|demand| demand.apply(p)),
            Some([one, other]) => match (demand(&one), demand(&other)) {
                (Some(one), Some(other)) => apply_both(&one, &other, p),
                (one, other) => one.or(other).and_then(|demand| demand.apply(p)),
            },
        };
        let position = (gap.distance < -step.max_penetration).then(|| self.foot(local, gap));
        if momentum.is_none() && position.is_none() {
            return None;
        }
        Some(Resolution {
            momentum: momentum.unwrap_or(*p),
            position,
            gap: gap.distance,
        })
    }

    fn reflection(
        &self,
        local: &Vec3,
        gap: &Gap,
        p: &Vec3,
        step: &ContactStep,
    ) -> Option<Resolution> {
        // Also false for a gap that is not a number.
        if gap.distance < 0.0 {
            let wall = step.density * self.velocity.dot(&gap.normal);
            let normal = p.dot(&gap.normal) - wall;
            let momentum = if normal < 0.0 {
                p - 2.0 * normal * gap.normal
            } else {
                *p
            };
            let position = Some(self.foot(local, gap));
            return Some(Resolution {
                momentum,
                position,
                gap: gap.distance,
            });
        }
        None
    }

    /// The point of the wall nearest to a particle.
    fn foot(&self, local: &Vec3, gap: &Gap) -> Vec3 {
        self.displacement + local - gap.distance * gap.normal
    }

    fn corner_faces(&self, local: &Vec3) -> Option<[Gap; 2]> {
        match &self.obstacle.surface {
            Surface::Profile(profile) => profile.chains()[self.part].corner_faces(local),
            _ => None,
        }
    }

    /// What the inelastic law asks of the normal momentum; `None` if it asks nothing because the
    /// wall is ahead and the travel unknown.
    fn demand(&self, restitution: f64, face: &Gap, p: &Vec3, step: &ContactStep) -> Option<Demand> {
        let wall = step.density * self.velocity.dot(&face.normal);
        let normal = face.normal;
        if face.distance <= step.tolerance {
            let approach = p.dot(&normal) - wall;
            let rebound = if approach < 0.0 {
                -restitution * approach
            } else {
                0.0
            };
            Some(Demand {
                normal,
                least: wall,
                target: wall + rebound,
            })
        } else if step.dt > 0.0 {
            let least = wall - step.density * face.distance / step.dt;
            Some(Demand {
                normal,
                least,
                target: least,
            })
        } else {
            None
        }
    }
}

/// p · normal must be at least `least`; if it is not, it becomes `target`.
struct Demand {
    normal: Vec3,
    least: f64,
    target: f64,
}

impl Demand {
    fn is_met(&self, p: &Vec3) -> bool {
        p.dot(&self.normal) >= self.least
    }

    fn apply(&self, p: &Vec3) -> Option<Vec3> {
        let now = p.dot(&self.normal);
        (now < self.least).then(|| p + (self.target - now) * self.normal)
    }
}

/// Below this value of 1 − cos² (2° of turn) two edges are too parallel to divide by it.
const NEARLY_PARALLEL: f64 = 1e-3;

/// The smallest change of momentum that meets two demands.
fn apply_both(one: &Demand, other: &Demand, p: &Vec3) -> Option<Vec3> {
    if one.is_met(p) && other.is_met(p) {
        return None;
    }
    let cosine = one.normal.dot(&other.normal);
    let sine_squared = 1.0 - cosine * cosine;
    if sine_squared < NEARLY_PARALLEL && cosine > 0.0 {
        // What the second adds is along the first, too.
        let first = one.apply(p).unwrap_or(*p);
        return Some(other.apply(&first).unwrap_or(first));
    }
    for (active, passive) in [(one, other), (other, one)] {
        if let Some(after) = active.apply(p)
            && passive.is_met(&after)
        {
            return Some(after);
        }
    }
    // Neither alone: both become equalities.
    let change = |demand: &Demand| {
        let target = if demand.is_met(p) {
            demand.least
        } else {
            demand.target
        };
        target - p.dot(&demand.normal)
    };
    let (first, second) = (change(one), change(other));
    let along_one = (first - cosine * second) / sine_squared;
    let along_other = (second - cosine * first) / sine_squared;
    Some(p + along_one * one.normal + along_other * other.normal)
}

#[cfg(test)]
mod tests;
