//! Contact laws and obstacles.

use crate::{ContactError, Friction, Surface};

/// What a wall does to the momentum of a particle that runs into it. Only the component along the
/// normal changes, measured relative to the wall; [`Friction`] changes the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// The momentum into the wall is taken away before the particle penetrates: it may go as far
    /// as the wall within the step and no farther.
    ///
    /// With restitution 0 and particles *on* the wall counted as touching it, the energy balance
    /// of a body that slides along a wall closes; the paper's reflection leaves a gap in it (see
    /// docs/theory.md, `[eq:inelastic]`).
    Inelastic {
        /// Part of the approach speed with which a touching particle leaves, 0 to 1.
        restitution: f64,
    },
    /// Bounce-back: a particle found in the wall is put on it, and its momentum into the wall is
    /// mirrored, `[eq:reflection]`. Greto & Kulasegaram 2019, Sect. 4.3.
    Reflection,
}

impl Default for Law {
    fn default() -> Self {
        Self::Inelastic { restitution: 0.0 }
    }
}

/// A rigid obstacle. Its motion, a translation, is given by the caller at each evaluation.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// What messages and tables call it.
    pub name: String,
    /// Its shape, where it is before it moves.
    pub surface: Surface,
    /// What it does to particles.
    pub law: Law,
    /// Friction along it.
    pub friction: Friction,
}

impl Obstacle {
    /// Checks surface, law and friction.
    ///
    /// # Errors
    /// Those of [`Surface::validate`] and [`Friction::validate`], and a restitution outside 0 to 1.
    pub fn validate(&self) -> Result<(), ContactError> {
        if let Law::Inelastic { restitution: value } = self.law
            && !(0.0..=1.0).contains(&value)
        {
            return Err(ContactError::Restitution { value });
        }
        self.friction.validate()?;
        self.surface.validate()
    }
}
