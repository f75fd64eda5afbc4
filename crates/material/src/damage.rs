//! Ductile damage: how much plastic strain a metal bears, `[eq:damage]`.

use crate::hardening::{check_melting, homologous_temperature};
use crate::{Description, Key, ParameterError, Range};
use serde::{Deserialize, Serialize};

/// A damage law, as in `damage = { <law> = { ... } }` of a case file.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Damage {
    /// See [`JohnsonCookDamage`].
    JohnsonCook(JohnsonCookDamage),
}

/// The damage laws with their keys, units and ranges.
pub const DAMAGE_LAWS: &[Description] = &[Description {
    name: "johnson_cook",
    summary: "fracture strain (d1 + d2 * exp(d3 * mean stress / equivalent stress)) * (1 + d4 * ln(rate / reference_rate)) * (1 + d5 * T*)",
    keys: KEYS,
}];

/// dD = dε_p/ε_f; at D = 1 the metal has failed: it carries pressure, but neither shear nor tension.
///
/// ```text
///   ε_f = (D_1 + D_2 exp(D_3 σ*)) (1 + D_4 ln(ε̇_p/ε̇_0)) (1 + D_5 T*)    [eq:damage]
/// ```
///
/// with σ* the mean stress over the equivalent stress, cut at 1.5, the end of the measurements; the
/// rate factor is 1 below ε̇_0; T* = (T − T_r)/(T_m − T_r) in [0, 1]. G. R. Johnson & W. H. Cook,
/// Engineering Fracture Mechanics 21 (1985), 31-48. Damage does not weaken the metal before it fails.
///
/// # Limits
/// Failure is local: the strain at which a row of points fails depends on the spacing.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct JohnsonCookDamage {
    /// D_1.
    pub d1: f64,
    /// D_2.
    pub d2: f64,
    /// D_3, negative where tension embrittles.
    pub d3: f64,
    /// D_4.
    pub d4: f64,
    /// D_5.
    pub d5: f64,
    /// ε̇_0, 1/s, positive.
    pub reference_rate: f64,
    /// T_r, K.
    pub reference_temperature: f64,
    /// T_m, K, above T_r.
    pub melting_temperature: f64,
}

/// Largest σ* of the measurements.
const LARGEST_TRIAXIALITY: f64 = 1.5;

/// Smallest ε_f, so that parameters far outside their measurements do not heal.
const SMALLEST_FRACTURE_STRAIN: f64 = 1e-6;

const fn number(name: &'static str, meaning: &'static str) -> Key {
    Key {
        name,
        unit: "-",
        meaning,
        range: Range::Any,
        optional: false,
    }
}

const fn positive(name: &'static str, unit: &'static str, meaning: &'static str) -> Key {
    Key {
        name,
        unit,
        meaning,
        range: Range::Positive,
        optional: false,
    }
}

const D1: Key = number("d1", "fracture strain under high tension");
const D2: Key = number("d2", "fracture strain that tension takes away");
const D3: Key = number(
    "d3",
    "exponent of tension; negative where tension embrittles",
);
const D4: Key = number("d4", "growth with the logarithm of the rate");
const D5: Key = number("d5", "growth with the temperature");
const RATE: Key = positive(
    "reference_rate",
    "1/s",
    "plastic strain rate up to which the rate does not matter",
);
const REFERENCE: Key = positive(
    "reference_temperature",
    "K",
    "temperature up to which it does not matter",
);
const MELTING: Key = positive(
    "melting_temperature",
    "K",
    "temperature at which T* is 1; above reference_temperature",
);
const KEYS: &[Key] = &[D1, D2, D3, D4, D5, RATE, REFERENCE, MELTING];

/// The optional key of a model that can fail.
pub(crate) const DAMAGE: Key = Key {
    name: "damage",
    unit: "-",
    meaning: "how much plastic strain the metal bears; a failed point carries pressure only",
    range: Range::OneOf(DAMAGE_LAWS),
    optional: true,
};

impl Damage {
    /// Checks the parameters.
    ///
    /// # Errors
    /// The first key that cannot be used, as `<law>.<key>`.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let Self::JohnsonCook(law) = self;
        law.validate()
            .map_err(|error| error.within(DAMAGE_LAWS[0].name))
    }

    /// D after a plastic increment, at most 1.
    ///
    /// # Arguments
    /// * `before`: D before it.
    /// * `increment`, `rate`: Δε_p and its rate, 1/s.
    /// * `triaxiality`: mean over equivalent stress.
    /// * `temperature`: K.
    #[must_use]
    pub fn after(
        &self,
        before: f64,
        increment: f64,
        rate: f64,
        triaxiality: f64,
        temperature: f64,
    ) -> f64 {
        (before + increment / self.fracture_strain(triaxiality, rate, temperature)).min(1.0)
    }

    /// ε_f at a triaxiality σ*, a plastic strain rate, 1/s, and a temperature, K.
    #[must_use]
    pub fn fracture_strain(&self, triaxiality: f64, rate: f64, temperature: f64) -> f64 {
        let Self::JohnsonCook(law) = self;
        law.fracture_strain(triaxiality, rate, temperature)
    }
}

impl JohnsonCookDamage {
    fn validate(&self) -> Result<(), ParameterError> {
        D1.check(self.d1)?;
        D2.check(self.d2)?;
        D3.check(self.d3)?;
        D4.check(self.d4)?;
        D5.check(self.d5)?;
        RATE.check(self.reference_rate)?;
        REFERENCE.check(self.reference_temperature)?;
        MELTING.check(self.melting_temperature)?;
        check_melting(self.melting_temperature, self.reference_temperature)?;
        let least = -self.d2 * (self.d3 * LARGEST_TRIAXIALITY).exp();
        if self.d1 <= least {
            return Err(ParameterError::Order {
                key: D1.name.to_owned(),
                value: self.d1,
                relation: "greater than",
                bound: least,
                reason: "at a mean stress of 1.5 times the equivalent stress the fracture strain would not be positive",
            });
        }
        Ok(())
    }

    fn fracture_strain(&self, triaxiality: f64, rate: f64, temperature: f64) -> f64 {
        let stress = self.d1 + self.d2 * (self.d3 * triaxiality.min(LARGEST_TRIAXIALITY)).exp();
        let rate = 1.0 + self.d4 * (rate / self.reference_rate).max(1.0).ln();
        let hot = homologous_temperature(
            temperature,
            self.reference_temperature,
            self.melting_temperature,
        );
        (stress * rate * (1.0 + self.d5 * hot)).max(SMALLEST_FRACTURE_STRAIN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 4340 steel of Johnson & Cook 1985.
    fn steel() -> JohnsonCookDamage {
        JohnsonCookDamage {
            d1: 0.05,
            d2: 3.44,
            d3: -2.12,
            d4: 0.002,
            d5: 0.61,
            reference_rate: 1.0,
            reference_temperature: 293.15,
            melting_temperature: 1793.0,
        }
    }

    #[test]
    fn fracture_strain_of_steel_follows_the_formula() {
        let strain = |triaxiality, rate, temperature| {
            Damage::JohnsonCook(steel()).fracture_strain(triaxiality, rate, temperature)
        };
        // By hand: torsion 0.05 + 3.44; tension 0.05 + 3.44 exp(−2.12/3) = 1.7469; 1.5 and beyond 0.1931.
        assert!((strain(0.0, 1.0, 293.15) - 3.49).abs() < 1e-12);
        assert!((strain(1.0 / 3.0, 1.0, 293.15) - 1.7469).abs() < 1e-4);
        assert!((strain(1.5, 0.0, 100.0) - 0.1931).abs() < 1e-4);
        assert_eq!(strain(9.0, 0.0, 100.0), strain(1.5, 0.0, 100.0));
        assert!((strain(0.0, 1e3, 293.15) / 3.49 - (1.0 + 0.002 * 1e3f64.ln())).abs() < 1e-12);
        assert!((strain(0.0, 1.0, 5000.0) / 3.49 - 1.61).abs() < 1e-12);
    }

    #[test]
    fn a_fracture_strain_that_is_not_positive_is_refused() {
        let brittle = JohnsonCookDamage {
            d1: -0.2,
            ..steel()
        };
        assert_eq!(
            Damage::JohnsonCook(brittle).validate().unwrap_err().key(),
            "johnson_cook.d1"
        );
        assert_eq!(Damage::JohnsonCook(steel()).validate(), Ok(()));
    }
}
