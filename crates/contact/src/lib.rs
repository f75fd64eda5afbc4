//! Rigid obstacles for particle methods: signed distance, contact laws, reaction forces.
//!
//! A [`Surface`] answers how far a point is from a rigid wall and which way is out ([`Gap`]); a
//! [`Law`] says what the wall does to the momentum of a particle; an [`Obstacle`] is both with a
//! name. Obstacles translate rigidly: the caller says how far and how fast, and everything is
//! evaluated in the obstacle's own frame. Walls are frictionless or have Coulomb [`Friction`].
//!
//! A particle may touch several walls of one obstacle at once, for instance the two sides of a
//! channel. A surface therefore has [`Surface::parts`], and each part acts on its own.
//!
//! ```
//! use jstsph_contact::{
//!     Chain, ContactStep, Friction, Law, Obstacle, Profile, Side, Surface, resolve,
//! };
//! use jstsph_tensor::Vec3;
//!
//! // A floor that turns upwards into a wall through a fillet of 1 mm; free above and to the left.
//! let chain = Chain::new(
//!     &[[0.0, 0.0], [0.02, 0.0], [0.02, 0.02]],
//!     &[0.0, 1.0e-3, 0.0],
//!     false,
//!     Side::Left,
//! )?;
//! let die = Obstacle {
//!     name: "die".into(),
//!     surface: Surface::Profile(Profile::new(vec![chain])?),
//!     law: Law::Inelastic { restitution: 0.0 },
//!     friction: Friction::coulomb(0.1),
//! };
//! die.validate()?;
//!
//! // A particle on the floor that wants to go down, at 2 m/s and a density of 1000 kg/m³.
//! let step = ContactStep { dt: 1e-7, tolerance: 1e-9, density: 1000.0, max_penetration: 1e-7 };
//! let position = Vec3::new(0.01, 0.0, 0.0);
//! let momentum = Vec3::new(500.0, -2000.0, 0.0);
//! let rest = Vec3::zeros();
//! let resolution = resolve(&die, 0, &rest, &rest, &position, &momentum, &step).unwrap();
//! assert_eq!(resolution.momentum, Vec3::new(300.0, 0.0, 0.0)); // it slides
//! assert_eq!(resolution.position, None); // and was not moved
//! # Ok::<(), jstsph_contact::ContactError>(())
//! ```

mod cache;
mod chain;
mod contour;
mod error;
mod fillet;
mod friction;
mod law;
mod mesh;
mod outline;
mod profile;
mod resolve;
mod solid;
mod surface;
#[cfg(test)]
mod testing;

pub use cache::CachedGap;
pub use chain::Chain;
pub use error::ContactError;
pub use fillet::Side;
pub use friction::{Exchange, Friction};
pub use law::{Law, Obstacle};
pub use profile::Profile;
pub use resolve::{ContactStep, Resolution, Wall, resolve};
pub use surface::{Gap, Surface};
