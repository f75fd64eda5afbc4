//! Polyconvex nearly incompressible Mooney-Rivlin elasticity.

use crate::material::checked_determinant;
use crate::parameter::DENSITY;
use crate::{
    Key, Kinematics, Material, MaterialError, ParameterError, Range, Response, WaveSpeeds,
};
use jstsph_tensor::{cofactor, deviator, norm_squared};
use serde::{Deserialize, Serialize};

/// Mooney-Rivlin solid with an isochoric-volumetric split, polyconvex form of Bonet, Gil & Ortigosa,
/// Computer Methods in Applied Mechanics and Engineering 283 (2015):
///
/// ```text
///   Ψ = α (Ī₁ − 3) + β (Ī₂^(3/2) − 3√3),   Ī₁ = (det F)^(−2/3) F : F,   Ī₂ = (det F)^(−4/3) H : H,   H = cof F
///   U = ½ κ (J − 1)²
///   τ' = 2 α dev b̄ + 3 β √Ī₂ dev (Ī₁ b̄ − b̄²),   b̄ = (det F)^(−2/3) F Fᵀ,   τ_vol = κ J (J − 1)
/// ```
///
/// The shear modulus of small strains is μ = 2 α + 3√3 β.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct MooneyRivlin {
    /// ρ, kg/m³, positive.
    pub density: f64,
    /// α, Pa, positive.
    pub first_coefficient: f64,
    /// β, Pa, zero or positive.
    pub second_coefficient: f64,
    /// κ, Pa, positive.
    pub bulk_modulus: f64,
}

const FIRST_COEFFICIENT: Key = Key {
    name: "first_coefficient",
    unit: "Pa",
    meaning: "factor alpha of the first isochoric invariant; shear modulus = 2 alpha + 3 sqrt(3) beta",
    range: Range::Positive,
    optional: false,
};
const SECOND_COEFFICIENT: Key = Key {
    name: "second_coefficient",
    unit: "Pa",
    meaning: "factor beta of the second isochoric invariant to the power 3/2",
    range: Range::NonNegative,
    optional: false,
};
const BULK_MODULUS: Key = Key {
    name: "bulk_modulus",
    unit: "Pa",
    meaning: "bulk modulus of small strains",
    range: Range::Positive,
    optional: false,
};

/// Ī₂ to the power 3/2 in the undeformed state.
const REFERENCE: f64 = 5.196_152_422_706_632;

impl Material for MooneyRivlin {
    const NAME: &'static str = "mooney_rivlin";
    const SUMMARY: &'static str =
        "elastic, rubber: polyconvex Mooney-Rivlin with isochoric-volumetric split";
    const KEYS: &'static [Key] = &[DENSITY, FIRST_COEFFICIENT, SECOND_COEFFICIENT, BULK_MODULUS];
    const VOLUMETRIC_SPLIT: bool = true;

    type History = ();

    fn validate(&self) -> Result<(), ParameterError> {
        DENSITY.check(self.density)?;
        FIRST_COEFFICIENT.check(self.first_coefficient)?;
        SECOND_COEFFICIENT.check(self.second_coefficient)?;
        BULK_MODULUS.check(self.bulk_modulus)
    }

    fn density(&self) -> f64 {
        self.density
    }

    fn shear_modulus(&self) -> f64 {
        2.0 * self.first_coefficient + REFERENCE * self.second_coefficient
    }

    fn wave_speeds(&self) -> WaveSpeeds {
        WaveSpeeds::from_moduli(self.shear_modulus(), self.bulk_modulus, self.density)
    }

    fn initial_history(&self) {}

    fn respond(&self, now: &Kinematics, (): &()) -> Result<Response<()>, MaterialError> {
        let f = &now.deformation_gradient;
        let determinant = checked_determinant(now)?;
        let b = f * f.transpose() * (1.0 / (determinant * determinant).cbrt());
        let first_invariant = b.trace();
        let second_invariant = 0.5 * (first_invariant * first_invariant - norm_squared(&b));
        let second_stress = deviator(&(b * first_invariant - b * b));
        Ok(Response::elastic(
            deviator(&b) * (2.0 * self.first_coefficient)
                + second_stress * (3.0 * self.second_coefficient * second_invariant.sqrt()),
        ))
    }

    /// κ J (J − 1).
    fn volumetric_stress(&self, jacobian: f64, _temperature: f64) -> f64 {
        self.bulk_modulus * jacobian * (jacobian - 1.0)
    }

    /// ½ κ (J − 1)².
    fn volumetric_energy(&self, jacobian: f64, _temperature: f64) -> f64 {
        0.5 * self.bulk_modulus * (jacobian - 1.0) * (jacobian - 1.0)
    }

    /// α (Ī₁ − 3) + β (Ī₂^(3/2) − 3√3).
    fn point_energy(&self, now: &Kinematics, (): &()) -> f64 {
        let f = &now.deformation_gradient;
        let determinant = f.determinant();
        let first_invariant = norm_squared(f) / (determinant * determinant).cbrt();
        let area_change = norm_squared(&cofactor(f)).sqrt();
        let second = area_change * area_change * area_change / (determinant * determinant);
        self.first_coefficient * (first_invariant - 3.0)
            + self.second_coefficient * (second - REFERENCE)
    }

    fn examples() -> Vec<Self> {
        vec![Self {
            density: 1100.0,
            first_coefficient: 1.2e6,
            second_coefficient: 0.5e6,
            bulk_modulus: 55e6,
        }]
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn reference_value_is_three_to_the_power_three_halves() {
        assert_eq!(super::REFERENCE, 3.0 * 3f64.sqrt());
    }
}
