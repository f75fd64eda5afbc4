//! Hencky's elasticity, without a yield limit.

use crate::elastic_constants::ElasticConstants;
use crate::logarithmic_strain::deviatoric_hencky_strain;
use crate::material::checked_determinant;
use crate::parameter::{DENSITY, POISSON_RATIO_IN_TEMPERATURE, YOUNG_MODULUS_IN_TEMPERATURE};
use crate::thermal::THERMAL;
use crate::{
    Key, Kinematics, Material, MaterialError, ParameterError, Property, Response, Thermal,
    WaveSpeeds,
};
use jstsph_tensor::{Mat3, norm_squared};
use serde::{Deserialize, Serialize};

/// Quadratic in the logarithmic strain, Greto & Kulasegaram 2019, (A.1) without plasticity:
///
/// ```text
///   Ψ = μ |dev ε|²,   U = ½ κ (ln J)²,   ε = ½ log (F Fᵀ)
///   τ' = 2 μ dev ε,   τ_vol = κ (ln J − 3 α (T − T_ref))
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
    /// E, Pa, positive; may depend on the temperature.
    pub young_modulus: Property,
    /// ν, between −1 and 0.5; may depend on the temperature.
    pub poisson_ratio: Property,
    /// Thermal properties; without them the body keeps its temperature and does not expand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thermal: Option<Thermal>,
}

impl Hencky {
    /// A solid without thermal properties: ρ, kg/m³; E, Pa; ν.
    #[must_use]
    pub fn new(density: f64, young_modulus: f64, poisson_ratio: f64) -> Self {
        Self {
            density,
            young_modulus: young_modulus.into(),
            poisson_ratio: poisson_ratio.into(),
            thermal: None,
        }
    }

    #[inline]
    fn elastic(&self) -> ElasticConstants<'_> {
        ElasticConstants {
            young_modulus: &self.young_modulus,
            poisson_ratio: &self.poisson_ratio,
            thermal: self.thermal.as_ref(),
        }
    }
}

fn deviatoric_strain(now: &Kinematics) -> Mat3 {
    let f = &now.deformation_gradient;
    deviatoric_hencky_strain(&(f * f.transpose()))
}

impl Material for Hencky {
    const NAME: &'static str = "hencky";
    const SUMMARY: &'static str = "elastic: quadratic energy of the logarithmic strain";
    const KEYS: &'static [Key] = &[
        DENSITY,
        YOUNG_MODULUS_IN_TEMPERATURE,
        POISSON_RATIO_IN_TEMPERATURE,
        THERMAL,
    ];
    const VOLUMETRIC_SPLIT: bool = true;

    type History = ();

    fn validate(&self) -> Result<(), ParameterError> {
        DENSITY.check(self.density)?;
        self.young_modulus.check(&YOUNG_MODULUS_IN_TEMPERATURE)?;
        self.poisson_ratio.check(&POISSON_RATIO_IN_TEMPERATURE)?;
        self.thermal.as_ref().map_or(Ok(()), Thermal::validate)
    }

    fn density(&self) -> f64 {
        self.density
    }

    fn shear_modulus(&self) -> f64 {
        self.elastic().largest_shear_modulus()
    }

    fn wave_speeds(&self) -> WaveSpeeds {
        self.elastic().wave_speeds(self.density)
    }

    fn initial_history(&self) {}

    fn respond(&self, now: &Kinematics, (): &()) -> Result<Response<()>, MaterialError> {
        checked_determinant(now)?;
        let mu = self.elastic().shear_modulus(now.temperature);
        Ok(Response::elastic(deviatoric_strain(now) * (2.0 * mu)))
    }

    /// κ (ln J − 3 α (T − T_ref)).
    fn volumetric_stress(&self, jacobian: f64, temperature: f64) -> f64 {
        self.elastic().volumetric_stress(jacobian, temperature)
    }

    /// ½ κ (ln J)² + 3 α κ T_ref ln J where κ does not depend on T.
    fn volumetric_energy(&self, jacobian: f64, temperature: f64) -> f64 {
        self.elastic().volumetric_energy(jacobian, temperature)
    }

    /// −3 α κ T where κ does not depend on T.
    fn thermoelastic_stress(&self, jacobian: f64, temperature: f64) -> f64 {
        self.elastic().thermoelastic_stress(jacobian, temperature)
    }

    fn thermal(&self) -> Option<&Thermal> {
        self.thermal.as_ref()
    }

    /// μ |dev ε|².
    fn point_energy(&self, now: &Kinematics, (): &()) -> f64 {
        self.elastic().shear_modulus(now.temperature) * norm_squared(&deviatoric_strain(now))
    }

    fn examples() -> Vec<Self> {
        let plain = Self::new(8930.0, 117e9, 0.35);
        let warm = Self {
            thermal: Some(super::hencky_von_mises::example_thermal()),
            ..plain.clone()
        };
        vec![plain, warm]
    }
}
