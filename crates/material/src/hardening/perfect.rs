//! No hardening.

use super::{FlowState, FlowStress, HardeningLaw, INITIAL_YIELD_STRESS};
use crate::{Key, ParameterError};
use serde::{Deserialize, Serialize};

/// σ_Y constant.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Perfect {
    /// σ_Y, Pa, positive.
    pub initial_yield_stress: f64,
}

impl HardeningLaw for Perfect {
    const NAME: &'static str = "perfect";
    const SUMMARY: &'static str = "constant: initial_yield_stress";
    const KEYS: &'static [Key] = &[INITIAL_YIELD_STRESS];

    fn validate(&self) -> Result<(), ParameterError> {
        INITIAL_YIELD_STRESS.check(self.initial_yield_stress)
    }

    #[inline(always)]
    fn flow_stress(&self, _at: &FlowState) -> FlowStress {
        FlowStress::rate_independent(self.initial_yield_stress, 0.0)
    }

    fn examples() -> Vec<Self> {
        vec![Self {
            initial_yield_stress: 0.4e9,
        }]
    }
}
