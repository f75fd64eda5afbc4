//! Saturating hardening.

use super::{FlowState, FlowStateTile, FlowStress, FlowStressTile, HardeningLaw, INITIAL_YIELD_STRESS};
use jstsph_tensor::lanes::{Simd, TILE};
use jstsph_tensor::{exponential, exponentials};
use crate::{Key, ParameterError, Range};
use serde::{Deserialize, Serialize};

/// σ_Y = σ_s − (σ_s − σ_Y0) exp(−δ ε_p), E. Voce, Journal of the Institute of Metals 74 (1948).
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Voce {
    /// σ_Y0, Pa, positive.
    pub initial_yield_stress: f64,
    /// σ_s, Pa, at least σ_Y0.
    pub saturation_stress: f64,
    /// δ, positive.
    pub rate: f64,
}

const SATURATION_STRESS: Key = Key {
    name: "saturation_stress",
    unit: "Pa",
    meaning: "flow stress at large strain; at least initial_yield_stress",
    range: Range::Positive,
    optional: false,
};
const RATE: Key = Key {
    name: "rate",
    unit: "-",
    meaning: "inverse of the strain over which the flow stress saturates",
    range: Range::Positive,
    optional: false,
};

impl HardeningLaw for Voce {
    const NAME: &'static str = "voce";
    const SUMMARY: &'static str =
        "saturation_stress - (saturation_stress - initial_yield_stress) * exp(-rate * eps_p)";
    const KEYS: &'static [Key] = &[INITIAL_YIELD_STRESS, SATURATION_STRESS, RATE];

    fn validate(&self) -> Result<(), ParameterError> {
        INITIAL_YIELD_STRESS.check(self.initial_yield_stress)?;
        SATURATION_STRESS.check(self.saturation_stress)?;
        RATE.check(self.rate)?;
        if self.saturation_stress < self.initial_yield_stress {
            return Err(ParameterError::Order {
                key: SATURATION_STRESS.name.to_owned(),
                value: self.saturation_stress,
                relation: "at least",
                bound: self.initial_yield_stress,
                reason: "below the initial_yield_stress it would soften, which depends on the spacing",
            });
        }
        Ok(())
    }

    #[inline]
    fn flow_stress(&self, at: &FlowState) -> FlowStress {
        let below = (self.saturation_stress - self.initial_yield_stress)
            * exponential(-self.rate * at.plastic_strain);
        FlowStress::rate_independent(self.saturation_stress - below, self.rate * below)
    }

    #[inline(always)]
    fn flow_stress_tile<S: Simd>(&self, simd: S, at: &FlowStateTile, out: &mut FlowStressTile) {
        let mut exponent = at.plastic_strain;
        for exponent in &mut exponent {
            *exponent *= -self.rate;
        }
        exponentials(simd, &exponent, &mut out.value);
        for value in &mut out.value {
            *value *= self.saturation_stress - self.initial_yield_stress;
        }
        for i in 0..TILE {
            out.slope[i] = self.rate * out.value[i];
            out.value[i] = self.saturation_stress - out.value[i];
        }
    }

    fn examples() -> Vec<Self> {
        vec![Self {
            initial_yield_stress: 0.2e9,
            saturation_stress: 0.45e9,
            rate: 12.0,
        }]
    }
}
