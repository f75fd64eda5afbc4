//! Linear hardening.

use super::{FlowState, FlowStress, HardeningLaw, INITIAL_YIELD_STRESS};
use crate::{Key, ParameterError, Range};
use serde::{Deserialize, Serialize};

/// σ_Y = σ_Y0 + H ε_p, Greto & Kulasegaram 2019, (A.14), `[eq:linear-hardening]`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Linear {
    /// σ_Y0, Pa, positive.
    pub initial_yield_stress: f64,
    /// H, Pa, zero or positive.
    pub modulus: f64,
}

const MODULUS: Key = Key {
    name: "modulus",
    unit: "Pa",
    meaning: "slope of the flow stress over the equivalent plastic strain",
    range: Range::NonNegative,
    optional: false,
};

impl HardeningLaw for Linear {
    const NAME: &'static str = "linear";
    const SUMMARY: &'static str = "initial_yield_stress + modulus * eps_p";
    const KEYS: &'static [Key] = &[INITIAL_YIELD_STRESS, MODULUS];

    fn validate(&self) -> Result<(), ParameterError> {
        INITIAL_YIELD_STRESS.check(self.initial_yield_stress)?;
        MODULUS.check(self.modulus)
    }

    #[inline(always)]
    fn flow_stress(&self, at: &FlowState) -> FlowStress {
        FlowStress::rate_independent(
            self.initial_yield_stress + self.modulus * at.plastic_strain,
            self.modulus,
        )
    }

    /// Copper of Greto & Kulasegaram 2019, Sect. 4.1.
    fn examples() -> Vec<Self> {
        vec![Self {
            initial_yield_stress: 0.4e9,
            modulus: 0.1e9,
        }]
    }
}
