//! Finite-strain metal plasticity: Hencky elasticity, von Mises yield, isotropic hardening.

use crate::hardening::{self, Hardening};
use crate::logarithmic_strain::{deviatoric_hencky_strain, isochoric_exponential_less_one};
use crate::material::checked_determinant;
use crate::parameter::{
    DENSITY, POISSON_RATIO, Range, YOUNG_MODULUS, bulk_modulus, shear_modulus,
};
use crate::return_map::plastic_increment;
use crate::{
    History, Key, Kinematics, Material, MaterialError, ParameterError, PlasticHistory, Response,
    WaveSpeeds,
};
use jstsph_tensor::{Mat3, cofactor, norm_squared};
use serde::{Deserialize, Serialize};

/// Hencky elasticity with von Mises plasticity, Greto & Kulasegaram 2019, Appendix A.
///
/// ```text
///   b_e = F C_p⁻¹ Fᵀ                                                      (A.8)
///   ε' = ½ dev log b_e,   τ' = 2 μ ε',   τ_vol = κ ln J                   (A.6), (A.9)
///   τ_eq = √(3/2) |τ'|,   elastic if τ_eq ≤ J σ_Y(ε_p)                    (A.10)
///   ν = τ' / (√(2/3) |τ'|)                                                (A.11)
///   τ_eq − 3 μ Δε_p = J σ_Y(ε_p + Δε_p)                                   (A.12), (A.13)
///   ε' ← ε' − Δε_p ν,   τ' ← τ' (1 − 3 μ Δε_p/τ_eq)                       (A.16), (A.17)
///   C_p⁻¹ ← F⁻¹ b_e F⁻ᵀ,   ε_p ← ε_p + Δε_p                               (A.19)
/// ```
///
/// Differences from the paper, reasoned in docs/theory.md. (A.11) lacks the √(2/3), which contradicts
/// (A.15). (A.9) subtracts ⅓ ln J, here it is ⅓ Σ ln λ_e: the same where J = det F, and trace-free
/// where the independent J has drifted. (A.12) and (A.15) take the stiffness of the Kirchhoff stress
/// for that of the Cauchy stress: a Cauchy stress falls by 3 μ Δε_p/J. Yield is on the Cauchy stress
/// τ/J, as in the paper.
///
/// The update is fully implicit (backward Euler in the logarithm), so the yield condition holds at
/// the end of every step, whatever its size. The return is radial and coaxial: b_e only changes its
/// principal values, and all tensors are functions of b_e, evaluated without a spectral decomposition.
///
/// # Limits
/// Isotropic, rate-independent, no temperature, no kinematic hardening.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct HenckyVonMises {
    /// ρ, kg/m³, positive.
    pub density: f64,
    /// E, Pa, positive.
    pub young_modulus: f64,
    /// ν, between −1 and 0.5.
    pub poisson_ratio: f64,
    /// How the flow stress grows with the equivalent plastic strain.
    pub hardening: Hardening,
}

const HARDENING: Key = Key {
    name: "hardening",
    unit: "-",
    meaning: "flow stress as a function of the equivalent plastic strain",
    range: Range::OneOf(hardening::LAWS),
};

/// F A Fᵀ of a symmetric A: symmetric bit for bit.
#[inline]
fn congruence(f: &Mat3, a: &Mat3) -> Mat3 {
    let fa = f * a;
    let entry = |i: usize, j: usize| {
        fa[(i, 0)] * f[(j, 0)] + fa[(i, 1)] * f[(j, 1)] + fa[(i, 2)] * f[(j, 2)]
    };
    let (m12, m13, m23) = (entry(0, 1), entry(0, 2), entry(1, 2));
    Mat3::new(
        entry(0, 0),
        m12,
        m13,
        m12,
        entry(1, 1),
        m23,
        m13,
        m23,
        entry(2, 2),
    )
}

impl Material for HenckyVonMises {
    const NAME: &'static str = "hencky_von_mises";
    const SUMMARY: &'static str =
        "metals: Hencky elasticity, von Mises yield on the Cauchy stress, isotropic hardening";
    const KEYS: &'static [Key] = &[DENSITY, YOUNG_MODULUS, POISSON_RATIO, HARDENING];
    const VOLUMETRIC_SPLIT: bool = true;

    type History = PlasticHistory;

    fn validate(&self) -> Result<(), ParameterError> {
        DENSITY.check(self.density)?;
        YOUNG_MODULUS.check(self.young_modulus)?;
        POISSON_RATIO.check(self.poisson_ratio)?;
        self.hardening
            .validate()
            .map_err(|error| error.within(HARDENING.name))
    }

    #[inline]
    fn density(&self) -> f64 {
        self.density
    }

    #[inline]
    fn shear_modulus(&self) -> f64 {
        shear_modulus(self.young_modulus, self.poisson_ratio)
    }

    fn wave_speeds(&self) -> WaveSpeeds {
        WaveSpeeds::from_moduli(
            self.shear_modulus(),
            bulk_modulus(self.young_modulus, self.poisson_ratio),
            self.density,
        )
    }

    #[inline]
    fn initial_history(&self) -> PlasticHistory {
        PlasticHistory::INITIAL
    }

    #[inline]
    fn respond(
        &self,
        now: &Kinematics,
        old: &PlasticHistory,
    ) -> Result<Response<PlasticHistory>, MaterialError> {
        let f = &now.deformation_gradient;
        let determinant = checked_determinant(now)?;
        let mu = self.shear_modulus();

        let b = congruence(f, &old.inverse_plastic_cauchy_green());
        let trial_stress = deviatoric_hencky_strain(&b) * (2.0 * mu);
        let trial_equivalent_stress = (1.5 * norm_squared(&trial_stress)).sqrt();

        let flow_stress = self.hardening.flow_stress(old.equivalent_plastic_strain);
        if trial_equivalent_stress <= now.jacobian * flow_stress.value {
            return Ok(Response {
                kirchhoff_stress: trial_stress,
                plastic_increment: 0.0,
                plastic_work: 0.0,
                history: *old,
            });
        }
        // Not only the infinite: a NaN, which no comparison accepts, arrives here too.
        if !trial_equivalent_stress.is_finite() {
            return Err(MaterialError::NotFinite {
                jacobian: now.jacobian,
                determinant,
            });
        }

        let increment = plastic_increment(
            trial_equivalent_stress,
            mu,
            now.jacobian,
            old.equivalent_plastic_strain,
            flow_stress,
            |strain| self.hardening.flow_stress(strain),
        )?;
        let equivalent_stress = trial_equivalent_stress - 3.0 * mu * increment;

        // b_e shrinks by exp(−2 Δε_p ν), ν = 3/2 τ'/τ_eq, and C_p⁻¹ with it. The change is formed, not
        // the new value, so that round-off is relative to the increment and det C_p⁻¹ stays 1.
        let direction = trial_stress * (-3.0 * increment / trial_equivalent_stress);
        let b_change = b * isochoric_exponential_less_one(&direction);
        let f_inverse = cofactor(f).transpose() * (1.0 / determinant);
        let inverse_plastic_cauchy_green =
            old.inverse_plastic_cauchy_green() + congruence(&f_inverse, &b_change);

        Ok(Response {
            kirchhoff_stress: trial_stress * (equivalent_stress / trial_equivalent_stress),
            plastic_increment: increment,
            plastic_work: equivalent_stress * increment,
            history: PlasticHistory::new(
                old.equivalent_plastic_strain + increment,
                &inverse_plastic_cauchy_green,
            ),
        })
    }

    /// κ ln J.
    #[inline]
    fn volumetric_stress(&self, jacobian: f64, _temperature: f64) -> f64 {
        bulk_modulus(self.young_modulus, self.poisson_ratio) * jacobian.ln()
    }

    /// ½ κ (ln J)².
    #[inline]
    fn volumetric_energy(&self, jacobian: f64, _temperature: f64) -> f64 {
        let log = jacobian.ln();
        0.5 * bulk_modulus(self.young_modulus, self.poisson_ratio) * log * log
    }

    /// μ |dev ε_e|².
    #[inline]
    fn point_energy(&self, now: &Kinematics, history: &PlasticHistory) -> f64 {
        let b = congruence(
            &now.deformation_gradient,
            &history.inverse_plastic_cauchy_green(),
        );
        self.shear_modulus() * norm_squared(&deviatoric_hencky_strain(&b))
    }

    fn flow_stress(&self, history: &PlasticHistory) -> Option<f64> {
        Some(
            self.hardening
                .flow_stress(history.equivalent_plastic_strain)
                .value,
        )
    }

    /// Copper of the Taylor bar, Greto & Kulasegaram 2019, Sect. 4.1, with every hardening law.
    fn examples() -> Vec<Self> {
        Hardening::examples()
            .into_iter()
            .map(|hardening| Self {
                density: 8930.0,
                young_modulus: 117e9,
                poisson_ratio: 0.35,
                hardening,
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
