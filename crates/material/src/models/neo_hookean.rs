//! Nearly incompressible neo-Hookean elasticity.

use crate::material::checked_determinant;
use crate::parameter::{DENSITY, POISSON_RATIO, YOUNG_MODULUS, bulk_modulus, shear_modulus};
use crate::{Key, Kinematics, Material, MaterialError, ParameterError, Response, WaveSpeeds};
use jstsph_tensor::{deviator, norm_squared};
use serde::{Deserialize, Serialize};

/// Neo-Hookean solid with an isochoric-volumetric split, the form of the benchmarks of Lee, Gil &
/// Bonet, Computers & Structures 118 (2013):
///
/// ```text
///   Ψ = ½ μ ((det F)^(−2/3) F : F − 3),   U = ½ κ (J − 1)²
///   τ' = μ (det F)^(−2/3) dev (F Fᵀ),     τ_vol = κ J (J − 1)
/// ```
///
/// # Limits
/// U stays finite as J goes to 0: collapse is not punished.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct NeoHookean {
    /// ρ, kg/m³, positive.
    pub density: f64,
    /// E of small strains, Pa, positive.
    pub young_modulus: f64,
    /// ν of small strains, between −1 and 0.5.
    pub poisson_ratio: f64,
}

impl Material for NeoHookean {
    const NAME: &'static str = "neo_hookean";
    const SUMMARY: &'static str = "elastic, rubber: neo-Hookean with isochoric-volumetric split";
    const KEYS: &'static [Key] = &[DENSITY, YOUNG_MODULUS, POISSON_RATIO];
    const VOLUMETRIC_SPLIT: bool = true;

    type History = ();

    fn validate(&self) -> Result<(), ParameterError> {
        DENSITY.check(self.density)?;
        YOUNG_MODULUS.check(self.young_modulus)?;
        POISSON_RATIO.check(self.poisson_ratio)
    }

    fn density(&self) -> f64 {
        self.density
    }

    #[inline]
    fn shear_modulus(&self) -> f64 {
        shear_modulus(self.young_modulus, self.poisson_ratio)
    }

    fn wave_speeds(&self) -> WaveSpeeds {
        let kappa = bulk_modulus(self.young_modulus, self.poisson_ratio);
        WaveSpeeds::from_moduli(self.shear_modulus(), kappa, self.density)
    }

    fn initial_history(&self) {}

    #[inline]
    fn respond(&self, now: &Kinematics, (): &()) -> Result<Response<()>, MaterialError> {
        let f = &now.deformation_gradient;
        let determinant = checked_determinant(now)?;
        let scale = self.shear_modulus() / (determinant * determinant).cbrt();
        Ok(Response::elastic(deviator(&(f * f.transpose())) * scale))
    }

    /// κ J (J − 1).
    fn volumetric_stress(&self, jacobian: f64, _temperature: f64) -> f64 {
        bulk_modulus(self.young_modulus, self.poisson_ratio) * jacobian * (jacobian - 1.0)
    }

    /// ½ κ (J − 1)².
    fn volumetric_energy(&self, jacobian: f64, _temperature: f64) -> f64 {
        let change = jacobian - 1.0;
        0.5 * bulk_modulus(self.young_modulus, self.poisson_ratio) * change * change
    }

    /// ½ μ ((det F)^(−2/3) F : F − 3).
    fn point_energy(&self, now: &Kinematics, (): &()) -> f64 {
        let f = &now.deformation_gradient;
        let determinant = f.determinant();
        let first_invariant = norm_squared(f) / (determinant * determinant).cbrt();
        0.5 * self.shear_modulus() * (first_invariant - 3.0)
    }

    fn examples() -> Vec<Self> {
        vec![Self {
            density: 1100.0,
            young_modulus: 17e6,
            poisson_ratio: 0.45,
        }]
    }
}
