//! Power law of the shifted plastic strain.

use super::{FlowState, FlowStress, HardeningLaw};
use crate::{Key, ParameterError, Range};
use serde::{Deserialize, Serialize};

/// σ_Y = A (ε_0 + ε_p)ⁿ, Greto & Kulasegaram 2019, (4.3), `[eq:swift]`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Swift {
    /// A, Pa, positive.
    pub coefficient: f64,
    /// ε_0, positive: the initial flow stress is A ε_0ⁿ.
    pub offset: f64,
    /// n, in (0, 1].
    pub exponent: f64,
}

const COEFFICIENT: Key = Key {
    name: "coefficient",
    unit: "Pa",
    meaning: "flow stress at offset + eps_p = 1",
    range: Range::Positive,
    optional: false,
};
const OFFSET: Key = Key {
    name: "offset",
    unit: "-",
    meaning: "strain added to eps_p; the initial flow stress is coefficient * offset^exponent",
    range: Range::Positive,
    optional: false,
};
const EXPONENT: Key = Key {
    name: "exponent",
    unit: "-",
    meaning: "hardening exponent",
    range: Range::PositiveUpTo { most: 1.0 },
    optional: false,
};

impl HardeningLaw for Swift {
    const NAME: &'static str = "swift";
    const SUMMARY: &'static str = "coefficient * (offset + eps_p)^exponent";
    const KEYS: &'static [Key] = &[COEFFICIENT, OFFSET, EXPONENT];

    fn validate(&self) -> Result<(), ParameterError> {
        COEFFICIENT.check(self.coefficient)?;
        OFFSET.check(self.offset)?;
        EXPONENT.check(self.exponent)
    }

    #[inline]
    fn flow_stress(&self, at: &FlowState) -> FlowStress {
        let strain = self.offset + at.plastic_strain;
        let value = self.coefficient * strain.powf(self.exponent);
        FlowStress::rate_independent(value, self.exponent * value / strain)
    }

    /// Al 1100 of Greto & Kulasegaram 2019, Sect. 4.3.
    fn examples() -> Vec<Self> {
        vec![Self {
            coefficient: 159e6,
            offset: 0.02,
            exponent: 0.27,
        }]
    }
}
