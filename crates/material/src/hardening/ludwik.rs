//! Power law of the plastic strain, added to the initial flow stress.

use super::power_term::PowerTerm;
use super::{FlowState, FlowStateTile, FlowStress, FlowStressTile, HardeningLaw, INITIAL_YIELD_STRESS};
use jstsph_tensor::lanes::Simd;
use crate::{Key, ParameterError, Range};
use serde::{Deserialize, Serialize};

/// σ_Y = σ_Y0 + K ε_pⁿ, P. Ludwik, Elemente der technologischen Mechanik (1909).
///
/// For n < 1 the slope at ε_p = 0 is infinite; the plastic return brackets its root and copes.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Ludwik {
    /// σ_Y0, Pa, positive.
    pub initial_yield_stress: f64,
    /// K, Pa, zero or positive.
    pub coefficient: f64,
    /// n, in (0, 1].
    pub exponent: f64,
}

const COEFFICIENT: Key = Key {
    name: "coefficient",
    unit: "Pa",
    meaning: "growth of the flow stress from eps_p = 0 to 1",
    range: Range::NonNegative,
    optional: false,
};
const EXPONENT: Key = Key {
    name: "exponent",
    unit: "-",
    meaning: "hardening exponent",
    range: Range::PositiveUpTo { most: 1.0 },
    optional: false,
};

impl HardeningLaw for Ludwik {
    const NAME: &'static str = "ludwik";
    const SUMMARY: &'static str = "initial_yield_stress + coefficient * eps_p^exponent";
    const KEYS: &'static [Key] = &[INITIAL_YIELD_STRESS, COEFFICIENT, EXPONENT];

    fn validate(&self) -> Result<(), ParameterError> {
        INITIAL_YIELD_STRESS.check(self.initial_yield_stress)?;
        COEFFICIENT.check(self.coefficient)?;
        EXPONENT.check(self.exponent)
    }

    #[inline]
    fn flow_stress(&self, at: &FlowState) -> FlowStress {
        let (hardened, slope) = self.hardened().at(at.plastic_strain);
        FlowStress::rate_independent(self.initial_yield_stress + hardened, slope)
    }

    #[inline(always)]
    fn flow_stress_tile<S: Simd>(&self, simd: S, at: &FlowStateTile, out: &mut FlowStressTile) {
        let terms = [&mut out.value, &mut out.slope];
        self.hardened().tile(simd, &at.plastic_strain, terms);
        for value in &mut out.value {
            *value += self.initial_yield_stress;
        }
    }

    fn examples() -> Vec<Self> {
        vec![Self {
            initial_yield_stress: 0.3e9,
            coefficient: 0.25e9,
            exponent: 0.4,
        }]
    }
}

impl Ludwik {
    #[inline(always)]
    fn hardened(&self) -> PowerTerm {
        PowerTerm {
            coefficient: self.coefficient,
            exponent: self.exponent,
        }
    }
}
