//! St Venant-Kirchhoff elasticity.

use crate::material::checked_determinant;
use crate::parameter::{DENSITY, POISSON_RATIO, YOUNG_MODULUS, bulk_modulus, shear_modulus};
use crate::{Key, Kinematics, Material, MaterialError, ParameterError, Response, WaveSpeeds};
use jstsph_tensor::{Mat3, norm_squared, symmetric_part};
use serde::{Deserialize, Serialize};

/// Quadratic in the Green-Lagrange strain, without a volumetric split:
///
/// ```text
///   Ψ = ½ λ (tr E)² + μ |E|²,   E = ½ (Fᵀ F − 1),   U = 0
///   τ = F (λ tr E 1 + 2 μ E) Fᵀ
/// ```
///
/// # Limits
/// Softens in compression and collapses below a stretch of about 0.6; for small strains with large
/// rotations, and for comparison with the literature. The independent Jacobian is not used, so the
/// mixed scheme cannot relieve locking.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct StVenantKirchhoff {
    /// ρ, kg/m³, positive.
    pub density: f64,
    /// E, Pa, positive.
    pub young_modulus: f64,
    /// ν, between −1 and 0.5.
    pub poisson_ratio: f64,
}

impl StVenantKirchhoff {
    fn bulk_modulus(&self) -> f64 {
        bulk_modulus(self.young_modulus, self.poisson_ratio)
    }

    fn lame_lambda(&self) -> f64 {
        self.bulk_modulus() - 2.0 / 3.0 * self.shear_modulus()
    }
}

/// E = ½ (Fᵀ F − 1), by the displacement gradient so that small strains keep their digits.
fn green_lagrange_strain(now: &Kinematics) -> Mat3 {
    let displacement_gradient = now.deformation_gradient - Mat3::identity();
    symmetric_part(&displacement_gradient)
        + displacement_gradient.transpose() * displacement_gradient * 0.5
}

impl Material for StVenantKirchhoff {
    const NAME: &'static str = "st_venant_kirchhoff";
    const SUMMARY: &'static str =
        "elastic: quadratic energy of the Green-Lagrange strain, small strains only, no volumetric split";
    const KEYS: &'static [Key] = &[DENSITY, YOUNG_MODULUS, POISSON_RATIO];
    const VOLUMETRIC_SPLIT: bool = false;

    type History = ();

    fn validate(&self) -> Result<(), ParameterError> {
        DENSITY.check(self.density)?;
        YOUNG_MODULUS.check(self.young_modulus)?;
        POISSON_RATIO.check(self.poisson_ratio)
    }

    fn density(&self) -> f64 {
        self.density
    }

    fn shear_modulus(&self) -> f64 {
        shear_modulus(self.young_modulus, self.poisson_ratio)
    }

    fn wave_speeds(&self) -> WaveSpeeds {
        WaveSpeeds::from_moduli(self.shear_modulus(), self.bulk_modulus(), self.density)
    }

    fn initial_history(&self) {}

    fn respond(&self, now: &Kinematics, (): &()) -> Result<Response<()>, MaterialError> {
        checked_determinant(now)?;
        let f = &now.deformation_gradient;
        let strain = green_lagrange_strain(now);
        let second_piola_stress = strain * (2.0 * self.shear_modulus())
            + Mat3::identity() * (self.lame_lambda() * strain.trace());
        Ok(Response::elastic(symmetric_part(
            &(f * second_piola_stress * f.transpose()),
        )))
    }

    /// Zero: all stress is at the point.
    fn volumetric_stress(&self, _jacobian: f64, _temperature: f64) -> f64 {
        0.0
    }

    /// Zero: all energy is at the point.
    fn volumetric_energy(&self, _jacobian: f64, _temperature: f64) -> f64 {
        0.0
    }

    /// ½ λ (tr E)² + μ |E|².
    fn point_energy(&self, now: &Kinematics, (): &()) -> f64 {
        let strain = green_lagrange_strain(now);
        let trace = strain.trace();
        0.5 * self.lame_lambda() * trace * trace + self.shear_modulus() * norm_squared(&strain)
    }

    fn examples() -> Vec<Self> {
        vec![Self {
            density: 1000.0,
            young_modulus: 1e6,
            poisson_ratio: 0.3,
        }]
    }
}
