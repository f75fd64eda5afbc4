//! Power law of the shifted plastic strain.

use super::{FlowState, FlowStateTile, FlowStress, FlowStressTile, HardeningLaw};
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

    #[inline(always)]
    fn flow_stress_tile<S: Simd>(&self, simd: S, at: &FlowStateTile, out: &mut FlowStressTile) {
        let mut strain = at.plastic_strain;
        for strain in &mut strain {
            *strain += self.offset;
        }
        powers(simd, &strain, self.exponent, &mut out.value);
        for (i, strain) in strain.iter().enumerate() {
            out.value[i] *= self.coefficient;
            out.slope[i] = self.exponent * out.value[i] / strain;
        }
    }

    #[inline(always)]
    fn flow_stress_near_tile<S: Simd>(
        &self,
        simd: S,
        start: &FlowStressTile,
        from: &[f64; TILE],
        at: &FlowStateTile,
        out: &mut FlowStressTile,
    ) {
        let one = Lanes::splat(simd, 1.0);
        let offset = Lanes::splat(simd, self.offset);
        let mut farthest = one.zero();
        for pack in 0..TILE / S::F64_LANES {
            let from = Lanes::load(simd, from, pack);
            let strain = Lanes::load(simd, &at.plastic_strain, pack);
            let x = (strain - from).over(from + offset);
            farthest = farthest.if_below(x.abs(), x.abs(), farthest);
            let mut sum = one;
            let mut k = SERIES_TERMS;
            while k > 1 {
                k -= 1;
                sum = one
                    + sum * x * ((self.exponent - f64::from(k - 1)) * RECIPROCALS[k as usize]);
            }
            let value = Lanes::load(simd, &start.value, pack) * sum;
            value.store(&mut out.value, pack);
            (value * self.exponent)
                .over(strain + offset)
                .store(&mut out.slope, pack);
        }
        if farthest.largest() >= SERIES_LIMIT {
            for (i, from) in from.iter().enumerate() {
                out.set(i, self.flow_stress_near(&start.at(i), *from, &at.at(i)));
            }
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
