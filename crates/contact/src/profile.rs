//! Several chains that together bound the free space of a plane-strain problem.

use crate::{Chain, ContactError};

/// A rigid profile in the x-y plane: one or several [`Chain`]s, for instance the two walls of a
/// channel. Each chain is one part of the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    chains: Vec<Chain>,
}

impl Profile {
    /// Joins chains to a profile. The chains may cross each other: a particle is free where it is
    /// free of all of them.
    ///
    /// # Errors
    /// [`ContactError::NoChains`] if there is none.
    pub fn new(chains: Vec<Chain>) -> Result<Self, ContactError> {
        if chains.is_empty() {
            return Err(ContactError::NoChains);
        }
        Ok(Self { chains })
    }

    /// The chains, at least one.
    #[must_use]
    pub fn chains(&self) -> &[Chain] {
        &self.chains
    }
}
