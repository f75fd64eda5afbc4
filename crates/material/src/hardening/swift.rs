//! Power law of the shifted plastic strain.

use super::{FlowLanes, FlowState, FlowStress, HardeningLaw};
use crate::{Key, ParameterError, Range};
use jstsph_tensor::lanes::{Lanes, Simd, TILE};
use jstsph_tensor::{power, powers};
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

/// Relative change of strain below which the series is used. Its coefficients are below 1/k: the first
/// term left out is below 0.001⁶/6 < 1e-18.
const SERIES_LIMIT: f64 = 1e-3;
const SERIES_TERMS: u32 = 6;
const RECIPROCALS: [f64; 6] = [0.0, 1.0, 1.0 / 2.0, 1.0 / 3.0, 1.0 / 4.0, 1.0 / 5.0];

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
        let value = self.coefficient * power(strain, self.exponent);
        FlowStress::rate_independent(value, self.exponent * value / strain)
    }

    /// The power by its binomial series: the plastic strain of one explicit step is a small part of
    /// what is there.
    #[inline]
    fn flow_stress_near(&self, start: &FlowStress, from: f64, at: &FlowState) -> FlowStress {
        let x = (at.plastic_strain - from) / (self.offset + from);
        if x.abs() >= SERIES_LIMIT {
            return self.flow_stress(at);
        }
        let mut sum = 1.0;
        for k in (1..SERIES_TERMS).rev() {
            sum = 1.0 + sum * x * ((self.exponent - f64::from(k - 1)) * RECIPROCALS[k as usize]);
        }
        let value = start.value * sum;
        let strain = self.offset + at.plastic_strain;
        FlowStress::rate_independent(value, self.exponent * value / strain)
    }

    const ON_LANES: bool = true;

    #[inline(always)]
    fn flow_stress_tile<S: Simd>(
        &self,
        simd: S,
        plastic_strain: &[f64; TILE],
        [value, slope]: [&mut [f64; TILE]; 2],
    ) {
        let mut strain = [0.0; TILE];
        for i in 0..TILE {
            strain[i] = self.offset + plastic_strain[i];
        }
        powers(simd, &strain, self.exponent, value);
        for i in 0..TILE {
            value[i] *= self.coefficient;
            slope[i] = self.exponent * value[i] / strain[i];
        }
    }

    #[inline(always)]
    fn flow_stress_lanes<S: Simd>(
        &self,
        simd: S,
        start: &FlowLanes<S>,
        from: Lanes<S>,
        at: Lanes<S>,
    ) -> FlowLanes<S> {
        let x = (at - from).over(from + Lanes::splat(simd, self.offset));
        let one = Lanes::splat(simd, 1.0);
        let mut sum = one;
        let mut k = SERIES_TERMS;
        while k > 1 {
            k -= 1;
            sum = one + sum * x * ((self.exponent - f64::from(k - 1)) * RECIPROCALS[k as usize]);
        }
        let value = start.value * sum;
        let none = Lanes::splat(simd, f64::NAN);
        FlowLanes {
            value: x.abs().if_less(SERIES_LIMIT, value, none),
            slope: (value * self.exponent).over(at + Lanes::splat(simd, self.offset)),
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_is_the_power_to_round_off() {
        let law = &Swift::examples()[0];
        let state = |plastic_strain: f64| FlowState {
            plastic_strain,
            rate: 0.0,
            temperature: crate::ROOM_TEMPERATURE,
        };
        for from in [0.0, 1e-4, 0.03, 1.7] {
            let start = law.flow_stress(&state(from));
            for part in [-9.9e-4, 0.0, 1e-12, 1e-6, 5e-4, 9.99e-4, 1.01e-3, 0.3] {
                let at = state(from + part * (law.offset + from));
                let (near, direct) =
                    (law.flow_stress_near(&start, from, &at), law.flow_stress(&at));
                assert!((near.value / direct.value - 1.0).abs() < 6e-16, "{from} {part}");
                assert!((near.slope / direct.slope - 1.0).abs() < 8e-16, "{from} {part}");
            }
        }
    }
}
