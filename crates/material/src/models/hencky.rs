//! Hencky's elasticity, without a yield limit.

use crate::logarithmic_strain::deviatoric_hencky_strain;
use crate::material::checked_determinant;
use crate::parameter::{DENSITY, POISSON_RATIO, YOUNG_MODULUS, bulk_modulus, shear_modulus};
use crate::{Key, Kinematics, Material, MaterialError, ParameterError, Response, WaveSpeeds};
use jstsph_tensor::{Mat3, norm_squared};
use serde::{Deserialize, Serialize};

/// Quadratic in the logarithmic strain, Greto & Kulasegaram 2019, (A.1) without plasticity:
///
/// ```text
///   Ψ = μ |dev ε|²,   U = ½ κ (ln J)²,   ε = ½ log (F Fᵀ)
///   τ' = 2 μ dev ε,   τ_vol = κ ln J
/// ```
///
/// # Limits
/// Not polyconvex: waves become imaginary at stretches beyond about e; for metals below their yield
/// stress this is never met.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Hencky {
    /// ρ, kg/m³, positive.
    pub density: f64,
    /// E, Pa, positive.
    pub young_modulus: f64,
    /// ν, between −1 and 0.5.
    pub poisson_ratio: f64,
}

fn deviatoric_strain(now: &Kinematics) -> Mat3 {
    let f = &now.deformation_gradient;
    deviatoric_hencky_strain(&(f * f.transpose()))
}

impl Material for Hencky {
    const NAME: &'static str = "hencky";
    const SUMMARY: &'static str = "elastic: quadratic energy of the logarithmic strain";
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

    fn shear_modulus(&self) -> f64 {
        shear_modulus(self.young_modulus, self.poisson_ratio)
    }

    fn wave_speeds(&self) -> WaveSpeeds {
        let kappa = bulk_modulus(self.young_modulus, self.poisson_ratio);
        WaveSpeeds::from_moduli(self.shear_modulus(), kappa, self.density)
    }

    fn initial_history(&self) {}

    fn respond(&self, now: &Kinematics, (): &()) -> Result<Response<()>, MaterialError> {
        checked_determinant(now)?;
        Ok(Response::elastic(
            deviatoric_strain(now) * (2.0 * self.shear_modulus()),
        ))
    }

    /// κ ln J.
    fn volumetric_stress(&self, jacobian: f64, _temperature: f64) -> f64 {
        bulk_modulus(self.young_modulus, self.poisson_ratio) * jacobian.ln()
    }

    /// ½ κ (ln J)².
    fn volumetric_energy(&self, jacobian: f64, _temperature: f64) -> f64 {
        let log = jacobian.ln();
        0.5 * bulk_modulus(self.young_modulus, self.poisson_ratio) * log * log
    }

    /// μ |dev ε|².
    fn point_energy(&self, now: &Kinematics, (): &()) -> f64 {
        self.shear_modulus() * norm_squared(&deviatoric_strain(now))
    }

    fn examples() -> Vec<Self> {
        vec![Self {
            density: 8930.0,
            young_modulus: 117e9,
            poisson_ratio: 0.35,
        }]
    }
}
