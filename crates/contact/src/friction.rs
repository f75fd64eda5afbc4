//! Coulomb friction of impulses.

use jstsph_tensor::Vec3;

use crate::{ContactError, Wall};

/// Coulomb friction between particles and an obstacle, without regularisation: a touching particle
/// sticks to the wall exactly, or slides against the full friction.
///
/// `[eq:friction]`. Source: Moreau 1988 (impulses of unilateral contact with dry friction); docs/theory.md.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Friction {
    /// Largest impulse along the wall over the normal one; 0 is no friction.
    pub coefficient: f64,
}

impl Friction {
    /// The law with one coefficient for sticking and sliding.
    #[must_use]
    pub const fn coulomb(coefficient: f64) -> Self {
        Self { coefficient }
    }

    /// Checks the coefficient.
    ///
    /// # Errors
    /// [`ContactError::Friction`] when it is negative or not finite.
    pub fn validate(&self) -> Result<(), ContactError> {
        let value = self.coefficient;
        if value.is_finite() && value >= 0.0 {
            Ok(())
        } else {
            Err(ContactError::Friction { value })
        }
    }
}

/// What a wall gives a particle in one step, per unit reference volume, kg m⁻² s⁻¹.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exchange {
    /// Impulse of the contact law, along the normal of the wall.
    pub normal: Vec3,
    /// Impulse of friction, along the wall.
    pub friction: Vec3,
}

impl Exchange {
    /// Adds a part of another exchange.
    #[must_use]
    pub fn plus(self, other: Self, factor: f64) -> Self {
        Self {
            normal: self.normal + other.normal * factor,
            friction: self.friction + other.friction * factor,
        }
    }
}

impl Wall<'_> {
    /// Momentum after friction, for a particle that the contact law has dealt with; `None` when
    /// friction changes nothing.
    ///
    /// ```text
    ///   n = N/|N| ,    s = (p − ρ v_wall) without its part along n
    ///   T* = T − s                         (the particle sticks)
    ///   T' = T* min(1, μ |N| / |T*|)       (or slides)
    ///   p' = p + T' − T
    /// ```
    ///
    /// with the impulses N (normal) and T (friction) that this wall has `given` the particle so
    /// far; N includes that of the contact law just applied, T is zero unless friction has already
    /// acted on a part of the step. p' is the admissible momentum nearest to sticking, and since T lies in
    /// the disc of radius μ |N| friction never adds energy in the frame of the wall.
    ///
    /// # Arguments
    /// * `p`: momentum per unit reference volume, kg m⁻² s⁻¹.
    /// * `given`: impulses of this wall on this particle within the step.
    /// * `density`: reference density, kg/m³.
    ///
    /// # Limits
    /// A particle that two edges of a sharp corner stop at once is treated with the sum of both
    /// impulses, whose direction lies between the normals.
    #[must_use]
    pub fn friction(&self, p: &Vec3, given: &Exchange, density: f64) -> Option<Vec3> {
        let coefficient = self.obstacle.friction.coefficient;
        let normal_impulse = given.normal.norm();
        // Negated so that anything not a number passes by.
        if !(coefficient > 0.0 && normal_impulse > 0.0) {
            return None;
        }
        let normal = given.normal / normal_impulse;
        let along = |v: &Vec3| v - v.dot(&normal) * normal;
        let wall = self.velocity * density;
        let relative = p - wall;
        let slip = along(&relative);
        let before = along(&given.friction);
        let sticking = before - slip;
        let (limit, size) = (coefficient * normal_impulse, sticking.norm());
        let after = if size <= limit {
            // Written so that the velocity along a wall at rest is zero, not nearly zero.
            wall + relative.dot(&normal) * normal
        } else {
            p + (sticking * (limit / size) - before)
        };
        (after != *p).then_some(after)
    }
}

#[cfg(test)]
mod tests;
