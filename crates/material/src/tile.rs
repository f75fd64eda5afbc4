//! The contract for many points at once.

use jstsph_tensor::lanes::{TILE, TensorTile};

/// The kinematics of [`TILE`] points, at the end of the step under evaluation; see
/// [`Kinematics`](crate::Kinematics).
#[derive(Clone, Debug)]
pub struct KinematicsTile {
    /// F.
    pub deformation_gradient: TensorTile,
    /// J as an unknown of its own.
    pub jacobian: [f64; TILE],
    /// T, K.
    pub temperature: [f64; TILE],
    /// Time since the committed history, s.
    pub dt: f64,
    /// Whether the points are in plane strain: of F only the components 11, 21, 12, 22 and 33 are read,
    /// and histories and stresses have no others.
    pub plane: bool,
}

impl KinematicsTile {
    /// A buffer to fill, for a step of `dt` seconds; not of plane strain.
    #[must_use]
    pub fn new(dt: f64) -> Self {
        Self {
            deformation_gradient: TensorTile::ZERO,
            jacobian: [0.0; TILE],
            temperature: [0.0; TILE],
            dt,
            plane: false,
        }
    }
}

/// What [`TILE`] points answer; see [`Response`](crate::Response).
#[derive(Clone, Debug)]
pub struct ResponseTile {
    /// Kirchhoff stress τ without the volumetric part, Pa, as 11, 22, 33, 12, 13, 23.
    pub kirchhoff_stress: [[f64; TILE]; 6],
    /// Plastic work, J per m³ of reference volume.
    pub plastic_work: [f64; TILE],
}

impl ResponseTile {
    /// A buffer to fill.
    pub const ZERO: Self = Self {
        kirchhoff_stress: [[0.0; TILE]; 6],
        plastic_work: [0.0; TILE],
    };
}
