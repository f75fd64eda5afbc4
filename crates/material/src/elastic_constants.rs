//! Young's modulus, Poisson's ratio and thermal expansion of an isotropic solid whose volumetric
//! stress is linear in ln J.

use crate::parameter::{bulk_modulus, shear_modulus};
use crate::{Property, Thermal, WaveSpeeds};

/// The elastic constants of a model and its thermal part, by reference.
///
/// The volumetric part has the free energy, per unit reference volume and less that of heat alone,
///
/// ```text
///   A(J, T) = ½ κ(T) (ln J)² − 3 α κ(T) (T − T_ref) ln J          [eq:thermal-energy]
/// ```
#[derive(Clone, Copy)]
pub(crate) struct ElasticConstants<'a> {
    pub(crate) young_modulus: &'a Property,
    pub(crate) poisson_ratio: &'a Property,
    pub(crate) thermal: Option<&'a Thermal>,
}

impl ElasticConstants<'_> {
    /// μ(T), Pa.
    #[inline]
    pub(crate) fn shear_modulus(&self, temperature: f64) -> f64 {
        shear_modulus(
            self.young_modulus.at(temperature),
            self.poisson_ratio.at(temperature),
        )
    }

    /// μ(T) of many points, Pa.
    #[inline]
    pub(crate) fn shear_moduli<const N: usize>(&self, temperature: &[f64; N]) -> [f64; N] {
        match (self.young_modulus, self.poisson_ratio) {
            (Property::Constant(young), Property::Constant(poisson)) => {
                [shear_modulus(*young, *poisson); N]
            }
            _ => temperature.map(|temperature| self.shear_modulus(temperature)),
        }
    }

    /// κ(T), Pa, at constant temperature.
    #[inline]
    pub(crate) fn bulk_modulus(&self, temperature: f64) -> f64 {
        bulk_modulus(
            self.young_modulus.at(temperature),
            self.poisson_ratio.at(temperature),
        )
    }

    /// dκ/dT, Pa/K.
    fn bulk_modulus_slope(&self, temperature: f64) -> f64 {
        let factor = 1.0 - 2.0 * self.poisson_ratio.at(temperature);
        let young_modulus = self.young_modulus.at(temperature);
        (self.young_modulus.slope(temperature)
            + 2.0 * young_modulus * self.poisson_ratio.slope(temperature) / factor)
            / (3.0 * factor)
    }

    /// Largest value of a modulus: between the corners of the tables it is a quotient of linear
    /// functions of T, hence monotonic.
    fn largest(&self, modulus: impl Fn(f64) -> f64) -> f64 {
        let corners = |property: &Property| match property {
            Property::Constant(_) => Vec::new(),
            Property::Table { temperatures, .. } => temperatures.clone(),
        };
        let mut temperatures = corners(self.young_modulus);
        temperatures.extend(corners(self.poisson_ratio));
        temperatures.push(crate::ROOM_TEMPERATURE);
        temperatures.into_iter().map(modulus).fold(0.0, f64::max)
    }

    /// The largest μ, Pa.
    pub(crate) fn largest_shear_modulus(&self) -> f64 {
        match (self.young_modulus, self.poisson_ratio) {
            (Property::Constant(young), Property::Constant(poisson)) => {
                shear_modulus(*young, *poisson)
            }
            _ => self.largest(|temperature| self.shear_modulus(temperature)),
        }
    }

    /// Wave speeds with the largest moduli, and the bulk modulus that of a wave, which is too fast for
    /// heat to flow: κ + (3 α κ)² T_ref / (ρ c).
    pub(crate) fn wave_speeds(&self, density: f64) -> WaveSpeeds {
        let mut bulk = self.largest(|temperature| self.bulk_modulus(temperature));
        if let Some(thermal) = self.thermal {
            bulk += adiabatic_stiffening(thermal, 3.0 * thermal.expansion * bulk, density);
        }
        WaveSpeeds::from_moduli(self.largest_shear_modulus(), bulk, density)
    }

    /// 3 α (T − T_ref), the logarithm of the volume change at zero pressure.
    #[inline]
    fn free_expansion(&self, temperature: f64) -> f64 {
        self.thermal.map_or(0.0, |thermal| {
            3.0 * thermal.expansion * (temperature - thermal.reference_temperature)
        })
    }

    /// τ_vol = J ∂A/∂J = κ (ln J − 3 α (T − T_ref)).
    #[inline]
    pub(crate) fn volumetric_stress(&self, jacobian: f64, temperature: f64) -> f64 {
        self.bulk_modulus(temperature) * (jacobian.ln() - self.free_expansion(temperature))
    }

    /// A − T ∂A/∂T = ½ (κ − T κ') (ln J)² + 3 α (κ T_ref + T κ' (T − T_ref)) ln J.
    #[inline]
    pub(crate) fn volumetric_energy(&self, jacobian: f64, temperature: f64) -> f64 {
        let log = jacobian.ln();
        let bulk = self.bulk_modulus(temperature);
        let Some(thermal) = self.thermal else {
            return 0.5 * bulk * log * log;
        };
        let lost = temperature * self.bulk_modulus_slope(temperature);
        0.5 * (bulk - lost) * log * log
            + (3.0 * thermal.expansion * bulk * thermal.reference_temperature
                + lost * self.free_expansion(temperature))
                * log
    }

    /// T ∂τ_vol/∂T = T κ' (ln J − 3 α (T − T_ref)) − 3 α κ T.
    #[inline]
    pub(crate) fn thermoelastic_stress(&self, jacobian: f64, temperature: f64) -> f64 {
        let Some(thermal) = self.thermal else {
            return 0.0;
        };
        let expansion = -3.0 * thermal.expansion * self.bulk_modulus(temperature) * temperature;
        match self.bulk_modulus_slope(temperature) {
            0.0 => expansion,
            slope => {
                temperature * slope * (jacobian.ln() - self.free_expansion(temperature)) + expansion
            }
        }
    }
}

/// What adiabatic compression adds to the bulk modulus at the reference state, (∂τ_vol/∂T)² T_ref /
/// (ρ c), Pa.
pub(crate) fn adiabatic_stiffening(thermal: &Thermal, stress_per_kelvin: f64, density: f64) -> f64 {
    let temperature = thermal.reference_temperature;
    stress_per_kelvin * stress_per_kelvin * temperature
        / (density * thermal.heat_capacity.at(temperature))
}
