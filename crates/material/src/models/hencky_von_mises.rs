//! Finite-strain metal plasticity: Hencky elasticity, von Mises yield, isotropic hardening.

use crate::damage::DAMAGE;
use crate::elastic_constants::ElasticConstants;
use crate::equation_of_state::{EQUATION_OF_STATE, StateEquation};
use crate::hardening::{self, FlowState, FlowStress, Hardening};
use crate::logarithmic_strain::{deviatoric_hencky_strain, isochoric_exponential_less_one};
use crate::material::checked_determinant;
use crate::parameter::{
    DENSITY, POISSON_RATIO_IN_TEMPERATURE, Range, YOUNG_MODULUS_IN_TEMPERATURE,
};
use crate::return_map::{PlasticFlow, RadialReturn};
use crate::thermal::THERMAL;
use crate::{
    Damage, EquationOfState, History, JohnsonCookDamage, Key, Kinematics, KinematicsTile, Material,
    MaterialError, MieGrueneisen, ParameterError, PlasticHistory, Property, Response, ResponseTile,
    Thermal, WaveSpeeds,
};
use jstsph_tensor::lanes::TILE;
use jstsph_tensor::{Mat3, cofactor, norm_squared};
use serde::{Deserialize, Serialize};

/// Hencky elasticity with von Mises plasticity, Greto & Kulasegaram 2019, Appendix A.
///
/// ```text
///   b_e = F C_p⁻¹ Fᵀ                                                      (A.8) [eq:trial]
///   ε' = ½ dev log b_e,   τ' = 2 μ ε',   τ_vol = κ (ln J − 3 α (T − T_ref))  (A.6), (A.9) [eq:hencky]
///   τ_eq = √(3/2) |τ'|,   elastic if τ_eq ≤ J σ_Y(ε_p, 0, T)              (A.10) [eq:yield]
///   ν = τ' / (√(2/3) |τ'|)                                                (A.11) [eq:flow]
///   τ_eq − 3 μ Δε_p = J σ_Y(ε_p + Δε_p, Δε_p/Δt, T)                       (A.12), (A.13) [eq:return]
///   ε' ← ε' − Δε_p ν,   τ' ← τ' (1 − 3 μ Δε_p/τ_eq)                       (A.16), (A.17) [eq:update]
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
/// Isotropic, no kinematic hardening. T is that of the start of the step. Where μ depends on T, the
/// heat that goes with elastic distortion, T μ'(T) |ε'|², is left out: metals distort too little
/// elastically for it to be felt.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct HenckyVonMises {
    /// ρ, kg/m³, positive.
    pub density: f64,
    /// E, Pa, positive; may depend on the temperature.
    pub young_modulus: Property,
    /// ν, between −1 and 0.5; may depend on the temperature.
    pub poisson_ratio: Property,
    /// How the flow stress depends on the equivalent plastic strain, its rate and the temperature.
    pub hardening: Hardening,
    /// Thermal properties; without them the body keeps its temperature and does not expand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thermal: Option<Thermal>,
    /// How much plastic strain the metal bears; without it any. A point whose damage reaches 1 has
    /// neither shear strength nor, to the caller's care, tension from the next step on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damage: Option<Damage>,
    /// Volumetric stress at strong compression, in place of κ (ln J − 3 α (T − T_ref)).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub equation_of_state: Option<EquationOfState>,
}

impl HenckyVonMises {
    /// A metal without thermal properties: ρ, kg/m³; E, Pa; ν; hardening.
    #[must_use]
    pub fn new(density: f64, young_modulus: f64, poisson_ratio: f64, hardening: Hardening) -> Self {
        Self {
            density,
            young_modulus: young_modulus.into(),
            poisson_ratio: poisson_ratio.into(),
            hardening,
            thermal: None,
            damage: None,
            equation_of_state: None,
        }
    }

    /// The equation of state, if there is one; it has a thermal part beside it.
    #[inline]
    fn state_equation(&self) -> Option<StateEquation<'_>> {
        let law = self.equation_of_state.as_ref()?;
        Some(law.of(self.density, self.thermal.as_ref()?))
    }

    /// Whether damage has taken the strength.
    #[inline]
    fn has_failed(&self, history: &PlasticHistory) -> bool {
        self.damage.is_some() && history.damage >= 1.0
    }

    /// D at the end of a step in which the point flowed.
    #[inline(never)]
    fn damage_after(
        &self,
        damage: &Damage,
        [jacobian, temperature, dt]: [f64; 3],
        before: f64,
        increment: f64,
        equivalent_stress: f64,
    ) -> f64 {
        if equivalent_stress <= 0.0 {
            return before;
        }
        let rate = if dt > 0.0 { increment / dt } else { 0.0 };
        let triaxiality = self.volumetric_stress(jacobian, temperature) / equivalent_stress;
        damage.after(before, increment, rate, triaxiality, temperature)
    }

    /// The volumetric stress of a model with thermal properties, apart from the usual case.
    #[inline(never)]
    fn warm_volumetric_stress(&self, jacobian: f64, temperature: f64) -> f64 {
        match self.state_equation() {
            None => self.elastic().volumetric_stress(jacobian, temperature),
            Some(law) => law.volumetric_stress(jacobian, temperature),
        }
    }

    /// # Errors
    /// [`MaterialError::Compressed`] outside the range of the equation of state.
    #[inline(never)]
    fn check_compression(&self, jacobian: f64) -> Result<(), MaterialError> {
        self.state_equation()
            .map_or(Ok(()), |law| law.check(jacobian))
    }

    /// Whether all points are inside the range of the equation of state.
    #[inline]
    fn bears_compression(&self, now: &KinematicsTile) -> bool {
        self.equation_of_state.is_none()
            || (now.jacobian.iter()).all(|jacobian| self.check_compression(*jacobian).is_ok())
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

const HARDENING: Key = Key {
    name: "hardening",
    unit: "-",
    meaning: "flow stress as a function of the equivalent plastic strain, its rate and the temperature",
    range: Range::OneOf(hardening::LAWS),
    optional: false,
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
    const KEYS: &'static [Key] = &[
        DENSITY,
        YOUNG_MODULUS_IN_TEMPERATURE,
        POISSON_RATIO_IN_TEMPERATURE,
        HARDENING,
        THERMAL,
        DAMAGE,
        EQUATION_OF_STATE,
    ];
    const VOLUMETRIC_SPLIT: bool = true;

    type History = PlasticHistory;

    fn validate(&self) -> Result<(), ParameterError> {
        DENSITY.check(self.density)?;
        self.young_modulus.check(&YOUNG_MODULUS_IN_TEMPERATURE)?;
        self.poisson_ratio.check(&POISSON_RATIO_IN_TEMPERATURE)?;
        self.hardening
            .validate()
            .map_err(|error| error.within(HARDENING.name))?;
        self.thermal.as_ref().map_or(Ok(()), Thermal::validate)?;
        if let Some(damage) = &self.damage {
            damage
                .validate()
                .map_err(|error| error.within(DAMAGE.name))?;
        }
        if let Some(law) = &self.equation_of_state {
            law.validate(self.thermal.as_ref())
                .map_err(|error| error.within(EQUATION_OF_STATE.name))?;
        }
        Ok(())
    }

    #[inline]
    fn density(&self) -> f64 {
        self.density
    }

    #[inline]
    fn shear_modulus(&self) -> f64 {
        self.elastic().largest_shear_modulus()
    }

    fn wave_speeds(&self) -> WaveSpeeds {
        match self.state_equation() {
            None => self.elastic().wave_speeds(self.density),
            Some(law) => {
                WaveSpeeds::from_moduli(self.shear_modulus(), law.bulk_modulus(), self.density)
            }
        }
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
        let mu = self.elastic().shear_modulus(now.temperature);
        if self.equation_of_state.is_some() {
            self.check_compression(now.jacobian)?;
        }

        let b = congruence(f, &old.inverse_plastic_cauchy_green());
        let trial_stress = deviatoric_hencky_strain(&b) * (2.0 * mu);
        let trial_equivalent_stress = (1.5 * norm_squared(&trial_stress)).sqrt();

        let flow_stress = if self.has_failed(old) {
            FlowStress::rate_independent(0.0, 0.0)
        } else {
            self.hardening.flow_stress(&FlowState {
                plastic_strain: old.equivalent_plastic_strain,
                rate: 0.0,
                temperature: now.temperature,
            })
        };
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

        let PlasticFlow {
            increment,
            stress: equivalent_stress,
            work: plastic_work,
        } = RadialReturn {
            trial_stress: trial_equivalent_stress,
            shear_modulus: mu,
            jacobian: now.jacobian,
            plastic_strain: old.equivalent_plastic_strain,
            dt: now.dt,
            temperature: now.temperature,
        }
        .flow(&self.hardening, flow_stress)?;

        let damage = match &self.damage {
            None => old.damage,
            Some(law) => {
                let state = [now.jacobian, now.temperature, now.dt];
                self.damage_after(law, state, old.damage, increment, equivalent_stress)
            }
        };

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
            plastic_work,
            history: PlasticHistory::new(
                old.equivalent_plastic_strain + increment,
                &inverse_plastic_cauchy_green,
            )
            .with_damage(damage),
        })
    }

    #[inline]
    fn respond_tile(
        &self,
        now: &KinematicsTile,
        old: &[PlasticHistory],
        new: &mut [PlasticHistory],
        response: &mut ResponseTile,
    ) -> bool {
        tile::respond(self, now, old, new, response)
    }

    /// κ (ln J − 3 α (T − T_ref)).
    #[inline]
    fn volumetric_stress(&self, jacobian: f64, temperature: f64) -> f64 {
        match self.thermal {
            None => self.elastic().bulk_modulus(temperature) * jacobian.ln(),
            Some(_) => self.warm_volumetric_stress(jacobian, temperature),
        }
    }

    /// ½ κ (ln J)² + 3 α κ T_ref ln J where κ does not depend on T.
    #[inline]
    fn volumetric_energy(&self, jacobian: f64, temperature: f64) -> f64 {
        match self.state_equation() {
            None => self.elastic().volumetric_energy(jacobian, temperature),
            Some(law) => law.volumetric_energy(jacobian),
        }
    }

    /// −3 α κ T where κ does not depend on T.
    #[inline]
    fn thermoelastic_stress(&self, jacobian: f64, temperature: f64) -> f64 {
        match self.state_equation() {
            None => self.elastic().thermoelastic_stress(jacobian, temperature),
            Some(law) => law.thermoelastic_stress(jacobian, temperature),
        }
    }

    fn thermal(&self) -> Option<&Thermal> {
        self.thermal.as_ref()
    }

    #[inline]
    fn carries_tension(&self, history: &PlasticHistory) -> bool {
        !self.has_failed(history)
    }

    /// μ |dev ε_e|².
    #[inline]
    fn point_energy(&self, now: &Kinematics, history: &PlasticHistory) -> f64 {
        let b = congruence(
            &now.deformation_gradient,
            &history.inverse_plastic_cauchy_green(),
        );
        self.elastic().shear_modulus(now.temperature) * norm_squared(&deviatoric_hencky_strain(&b))
    }

    fn point_energies_tile(
        &self,
        now: &KinematicsTile,
        history: &[PlasticHistory],
        energies: &mut [f64; TILE],
    ) -> bool {
        tile::energies(self, now, history, energies)
    }

    fn flow_stress(&self, history: &PlasticHistory, rate: f64, temperature: f64) -> Option<f64> {
        if self.has_failed(history) {
            return Some(0.0);
        }
        let at = FlowState {
            plastic_strain: history.equivalent_plastic_strain,
            rate,
            temperature,
        };
        Some(self.hardening.flow_stress(&at).value)
    }

    /// Copper of the Taylor bar, Greto & Kulasegaram 2019, Sect. 4.1, with every hardening law; with
    /// thermal properties; with moduli that fall with the temperature; with damage and an equation of
    /// state (D. J. Steinberg, UCRL-MA-106439, 1996; Johnson & Cook 1985).
    fn examples() -> Vec<Self> {
        let copper = |hardening| Self::new(8930.0, 117e9, 0.35, hardening);
        let hardening = Hardening::Linear(hardening::Linear {
            initial_yield_stress: 0.4e9,
            modulus: 0.1e9,
        });
        let warm = Self {
            thermal: Some(example_thermal()),
            ..copper(hardening)
        };
        let softening = Self {
            young_modulus: Property::Table {
                temperatures: vec![293.15, 700.0, 1300.0],
                values: vec![117e9, 100e9, 60e9],
            },
            poisson_ratio: Property::Table {
                temperatures: vec![293.15, 1300.0],
                values: vec![0.35, 0.36],
            },
            ..warm.clone()
        };
        let shocked = Self {
            thermal: Some(Thermal {
                expansion: 0.0,
                ..example_thermal()
            }),
            damage: Some(Damage::JohnsonCook(JohnsonCookDamage {
                d1: 0.54,
                d2: 4.89,
                d3: -3.03,
                d4: 0.014,
                d5: 1.12,
                reference_rate: 1.0,
                reference_temperature: 293.15,
                melting_temperature: 1356.0,
            })),
            equation_of_state: Some(EquationOfState::MieGrueneisen(MieGrueneisen {
                c0: 3940.0,
                s: 1.489,
                gamma0: 2.02,
            })),
            ..warm.clone()
        };
        let mut examples: Vec<_> = Hardening::examples().into_iter().map(copper).collect();
        examples.extend([warm, softening, shocked]);
        examples
    }
}

/// Thermal properties of copper at room temperature (CRC Handbook of Chemistry and Physics).
pub(super) fn example_thermal() -> Thermal {
    Thermal {
        heat_capacity: 385.0.into(),
        conductivity: 401.0.into(),
        taylor_quinney: 0.9,
        expansion: 16.5e-6,
        reference_temperature: crate::ROOM_TEMPERATURE,
    }
}

mod flow;
mod series;
mod tile;

#[cfg(test)]
mod homogeneous;
#[cfg(test)]
mod tests;
