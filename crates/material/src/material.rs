//! The contract between a constitutive model and whoever evaluates it.

use crate::{History, Key, KinematicsTile, MaterialError, ParameterError, ResponseTile, Thermal};
use jstsph_tensor::Mat3;
use std::fmt::Debug;

/// The kinematics of one point, at the end of the step under evaluation.
#[derive(Clone, Copy, Debug)]
pub struct Kinematics {
    /// F.
    pub deformation_gradient: Mat3,
    /// J as an unknown of its own, not det F; at a bond √(J_a J_b).
    pub jacobian: f64,
    /// Time since the committed history, s.
    pub dt: f64,
    /// T, K. Models without a thermal part do not read it.
    pub temperature: f64,
}

/// Temperature of a body whose temperature nobody gives, K: 20 °C.
pub const ROOM_TEMPERATURE: f64 = 293.15;

/// What a point answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response<H> {
    /// Kirchhoff stress τ of the point without [`Material::volumetric_stress`], Pa; symmetric, and
    /// trace-free for a model with [`Material::VOLUMETRIC_SPLIT`].
    pub kirchhoff_stress: Mat3,
    /// Δε_p ≥ 0.
    pub plastic_increment: f64,
    /// τ_eq Δε_p at the end of the step, J per m³ of reference volume; where the metal has lost its
    /// strength, molten or failed, the elastic energy ½ τ_eq,trial Δε_p it gives up.
    pub plastic_work: f64,
    /// The history to commit if the step is accepted.
    pub history: H,
}

impl Response<()> {
    /// The answer of a model that remembers nothing.
    #[inline]
    pub(crate) fn elastic(kirchhoff_stress: Mat3) -> Self {
        Self {
            kirchhoff_stress,
            plastic_increment: 0.0,
            plastic_work: 0.0,
            history: (),
        }
    }
}

/// Wave speeds of the unstretched material, m/s. In a deformed body they are divided by the smallest
/// principal stretch, Greto & Kulasegaram 2019, (3.17).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveSpeeds {
    /// c_p = √((λ + 2 μ)/ρ).
    pub pressure: f64,
    /// c_s = √(μ/ρ).
    pub shear: f64,
}

impl WaveSpeeds {
    /// From μ and κ, Pa, and the reference density ρ, kg/m³.
    #[inline]
    #[must_use]
    pub fn from_moduli(shear_modulus: f64, bulk_modulus: f64, density: f64) -> Self {
        Self {
            pressure: ((bulk_modulus + 4.0 / 3.0 * shear_modulus) / density).sqrt(),
            shear: (shear_modulus / density).sqrt(),
        }
    }
}

/// An isotropic constitutive model: parameters, and pure functions of one point.
///
/// The stored energy per unit reference volume is Ψ(F, history) + U(J), with the point's part Ψ
/// ([`point_energy`](Self::point_energy)) and the volumetric part U
/// ([`volumetric_energy`](Self::volumetric_energy)); the stresses are their derivatives,
/// P = ∂Ψ/∂F + U'(J) cof F. Every registered model is held to this by the conformance tests.
pub trait Material: Clone + Debug + Send + Sync + 'static {
    /// Name in a case file.
    const NAME: &'static str;
    /// One line for the list of models.
    const SUMMARY: &'static str;
    /// The keys of the model's table.
    const KEYS: &'static [Key];
    /// Whether the point's part is isochoric: its Kirchhoff stress is trace-free and all volumetric
    /// stiffness is in [`volumetric_stress`](Self::volumetric_stress). Models without the split gain
    /// nothing from an independent Jacobian.
    const VOLUMETRIC_SPLIT: bool;

    /// What a point remembers; `()` for elastic models.
    type History: History;

    /// Checks the parameters.
    ///
    /// # Errors
    /// The first key whose value lies outside its range.
    fn validate(&self) -> Result<(), ParameterError>;

    /// ρ, mass per unit reference volume, kg/m³.
    fn density(&self) -> f64;

    /// μ of the reference state, Pa; the largest where it depends on the temperature.
    fn shear_modulus(&self) -> f64;

    /// Wave speeds of the reference state; the largest where they depend on the temperature. A pressure
    /// wave is too fast for heat to flow: its stiffness is the adiabatic one.
    fn wave_speeds(&self) -> WaveSpeeds;

    /// History of undeformed material.
    fn initial_history(&self) -> Self::History;

    /// Stress at `now` and the history that goes with it, from the committed history `old`.
    ///
    /// Pure: the same input gives the same bits, and nothing is remembered.
    ///
    /// # Errors
    /// [`MaterialError::Inverted`] or [`MaterialError::NotFinite`] for kinematics no body can have,
    /// [`MaterialError::ReturnMap`] if a plastic return does not converge.
    fn respond(
        &self,
        now: &Kinematics,
        old: &Self::History,
    ) -> Result<Response<Self::History>, MaterialError>;

    /// [`respond`](Self::respond) for [`TILE`](jstsph_tensor::lanes::TILE) points at once, with the same bits:
    /// writes `new` and `response` from the histories `old`, or returns false when the points have to
    /// be asked one by one. This is so for models without such a path, and for a point that is not
    /// sound or strained beyond the range of it; what was written is then worthless.
    ///
    /// # Panics
    /// If there are fewer histories than points: a bug in the caller.
    #[inline]
    fn respond_tile(
        &self,
        _now: &KinematicsTile,
        _old: &[Self::History],
        _new: &mut [Self::History],
        _response: &mut ResponseTile,
    ) -> bool {
        false
    }

    /// τ_vol(J, T), Pa: the Kirchhoff stress to add as τ_vol 1; J U'(J) for a model that does not
    /// read the temperature. The caller makes sure that J > 0.
    fn volumetric_stress(&self, jacobian: f64, temperature: f64) -> f64;

    /// The internal energy of the volumetric part less its heat ∫ ρ c dT, J/m³ of reference volume;
    /// U(J) for a model that does not read the temperature. The caller makes sure that J > 0.
    ///
    /// With the free energy A(J, T) it is A − T ∂A/∂T without the heat, so that
    /// J ∂/∂J of it = τ_vol − T ∂τ_vol/∂T ([`thermoelastic_stress`](Self::thermoelastic_stress)).
    fn volumetric_energy(&self, jacobian: f64, temperature: f64) -> f64;

    /// T ∂τ_vol/∂T, Pa: the part of τ_vol whose power τ J̇/J goes into (or comes from) heat.
    /// Zero for a model without thermal expansion.
    fn thermoelastic_stress(&self, _jacobian: f64, _temperature: f64) -> f64 {
        0.0
    }

    /// Ψ, the stored energy of the point's part, J/m³ of reference volume, for the history that the
    /// response at `now` returned.
    fn point_energy(&self, now: &Kinematics, history: &Self::History) -> f64;

    /// [`point_energy`](Self::point_energy) for [`TILE`](jstsph_tensor::lanes::TILE) points at once, the
    /// same to round-off; J is not read. Returns false, as [`respond_tile`](Self::respond_tile), when the
    /// points have to be asked one by one.
    ///
    /// # Panics
    /// If there are fewer histories than points: a bug in the caller.
    #[inline]
    fn point_energies_tile(
        &self,
        _now: &KinematicsTile,
        _history: &[Self::History],
        _energies: &mut [f64; jstsph_tensor::lanes::TILE],
    ) -> bool {
        false
    }

    /// Thermal properties; `None` for a model that has none, whose bodies keep their temperature.
    fn thermal(&self) -> Option<&Thermal> {
        None
    }

    /// Whether a point with this history can still carry tension; a failed one carries pressure in
    /// compression only.
    #[inline]
    fn carries_tension(&self, _history: &Self::History) -> bool {
        true
    }

    /// Cauchy stress σ_Y at which the point flows at a plastic strain rate, 1/s, and a temperature, K,
    /// in Pa; at rate zero that at which it yields. `None` for a model that never does.
    fn flow_stress(&self, _history: &Self::History, _rate: f64, _temperature: f64) -> Option<f64> {
        None
    }

    /// Parameter sets on which the conformance tests run.
    fn examples() -> Vec<Self>;
}

/// det F, after a check that the kinematics are those of a body.
#[inline]
pub(crate) fn checked_determinant(now: &Kinematics) -> Result<f64, MaterialError> {
    let determinant = now.deformation_gradient.determinant();
    let jacobian = now.jacobian;
    // Comparisons with NaN are false, so this is the only test on the way of a healthy point.
    if determinant > 0.0
        && determinant < f64::INFINITY
        && jacobian > 0.0
        && jacobian < f64::INFINITY
    {
        return Ok(determinant);
    }
    Err(kinematics_error(jacobian, determinant))
}

#[cold]
fn kinematics_error(jacobian: f64, determinant: f64) -> MaterialError {
    if determinant.is_finite() && jacobian.is_finite() {
        MaterialError::Inverted {
            jacobian,
            determinant,
        }
    } else {
        MaterialError::NotFinite {
            jacobian,
            determinant,
        }
    }
}
