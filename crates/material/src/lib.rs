//! Constitutive models of large-strain solid mechanics as pure functions of one point's kinematics and history.
//!
//! A [`Material`] sees one point's deformation gradient, its independent Jacobian and its committed
//! history, and returns a [`Response`]: the Kirchhoff stress of the point and the history the point
//! would have if the step were accepted. Nothing is stored and nothing is changed; accepting is
//! [`Block::commit`], once per step.
//!
//! The volumetric answer is a function of its own, [`Material::volumetric_stress`], because in the
//! mixed schemes the Jacobian may live elsewhere than the deformation gradient (on particles, while
//! the deformation gradient lives on bonds). The total Kirchhoff stress is
//! `kirchhoff_stress + volumetric_stress(J) 1`.
//!
//! ```
//! use jstsph_material::{Kinematics, Material, MaterialSpec, hardening::{Hardening, Linear}, models::HenckyVonMises};
//! use jstsph_tensor::{Mat3, von_mises};
//!
//! let hardening = Hardening::Linear(Linear { initial_yield_stress: 0.4e9, modulus: 0.1e9 });
//! let copper = HenckyVonMises::new(8930.0, 117e9, 0.35, hardening);
//! copper.validate()?;
//!
//! // Simple shear by two per cent: far beyond yield.
//! let f = Mat3::new(1.0, 0.02, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
//! let now = Kinematics { deformation_gradient: f, jacobian: 1.0, dt: 1e-6, temperature: 293.15 };
//! let response = copper.respond(&now, &copper.initial_history())?;
//! let flow_stress = 0.4e9 + 0.1e9 * response.plastic_increment;
//! assert!((von_mises(&response.kirchhoff_stress) / flow_stress - 1.0).abs() < 1e-12);
//!
//! // The same model, chosen by name as in a case file, for a run of 1000 points.
//! let mut block = MaterialSpec::HenckyVonMises(copper).block(1000);
//! block.commit();
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A new model is one file in `models/` and one line in `models.rs`; a new hardening law one file in
//! `hardening/` and one line in `hardening.rs`. Either brings its conformance tests with it.

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod block;
mod damage;
mod elastic_constants;
mod equation_of_state;
mod error;
mod history;
mod library;
mod logarithmic_strain;
mod material;
mod parameter;
mod return_map;
mod thermal;
mod tile;

pub mod hardening;
pub mod models;

#[cfg(test)]
mod conformance;

pub use block::{Block, BlockReader, BlockVisitor};
pub use damage::{DAMAGE_LAWS, Damage, JohnsonCookDamage};
pub use equation_of_state::{EQUATIONS_OF_STATE, EquationOfState, MieGrueneisen};
pub use error::{MaterialError, ParameterError};
pub use history::{History, PlasticHistory};
pub use library::{NamedMaterial, library};
pub use material::{Kinematics, Material, ROOM_TEMPERATURE, Response, WaveSpeeds};
pub use models::{MODELS, MaterialBlock, MaterialSpec, NAMES, SUMMARIES};
pub use parameter::{Description, Key, Range};
pub use thermal::{Property, Thermal};
pub use tile::{KinematicsTile, ResponseTile};
