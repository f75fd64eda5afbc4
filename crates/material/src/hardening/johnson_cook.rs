//! Hardening by strain and rate, softening by temperature: `[eq:johnson-cook]`.

use super::power_term::{GrowthTile, PowerTerm};
use super::{FlowState, FlowStateTile, FlowStress, FlowStressTile, HardeningLaw};
use crate::{Key, ParameterError, Range};
use jstsph_tensor::lanes::{Simd, TILE};
use jstsph_tensor::{logarithm, logarithms, power, powers};
use serde::{Deserialize, Serialize};

/// σ_Y = (A + B ε_pⁿ) (1 + C ln(ε̇_p/ε̇_0)) (1 − T*ᵐ), T* = (T − T_r)/(T_m − T_r) in [0, 1],
/// `[eq:johnson-cook]`.
///
/// G. R. Johnson & W. H. Cook, Proc. 7th International Symposium on Ballistics (1983), 541-547.
///
/// Below the reference rate ε̇_0 the rate factor is 1, unless
/// [`slow_rates_soften`](Self::slow_rates_soften): then the logarithm goes on, down to a factor of
/// 0.05, which keeps the strength positive at rate zero, where yield is tested.
///
/// At the melting point the strength is zero.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct JohnsonCook {
    /// A, Pa, positive.
    pub a: f64,
    /// B, Pa, zero or positive.
    pub b: f64,
    /// n, positive.
    pub n: f64,
    /// C, zero or positive.
    pub c: f64,
    /// m, positive.
    pub m: f64,
    /// ε̇_0, 1/s, positive.
    pub reference_rate: f64,
    /// T_r, K: at and below it there is no thermal softening.
    pub reference_temperature: f64,
    /// T_m, K, above T_r.
    pub melting_temperature: f64,
    /// Whether rates below ε̇_0 lower the strength.
    #[serde(default)]
    pub slow_rates_soften: bool,
}

/// Smallest rate factor.
const SMALLEST_RATE_FACTOR: f64 = 0.05;

const A: Key = Key {
    name: "a",
    unit: "Pa",
    meaning: "yield stress at the reference rate and temperature",
    range: Range::Positive,
    optional: false,
};
const B: Key = Key {
    name: "b",
    unit: "Pa",
    meaning: "growth of the flow stress from eps_p = 0 to 1",
    range: Range::NonNegative,
    optional: false,
};
const N: Key = Key {
    name: "n",
    unit: "-",
    meaning: "hardening exponent",
    range: Range::Positive,
    optional: false,
};
const C: Key = Key {
    name: "c",
    unit: "-",
    meaning: "growth of the strength with the logarithm of the rate",
    range: Range::NonNegative,
    optional: false,
};
const M: Key = Key {
    name: "m",
    unit: "-",
    meaning: "exponent of thermal softening",
    range: Range::Positive,
    optional: false,
};
const REFERENCE_RATE: Key = Key {
    name: "reference_rate",
    unit: "1/s",
    meaning: "plastic strain rate at which a, b and n were measured",
    range: Range::Positive,
    optional: false,
};
const REFERENCE_TEMPERATURE: Key = Key {
    name: "reference_temperature",
    unit: "K",
    meaning: "temperature up to which there is no thermal softening",
    range: Range::Positive,
    optional: false,
};
const MELTING_TEMPERATURE: Key = Key {
    name: "melting_temperature",
    unit: "K",
    meaning: "temperature of zero strength; above reference_temperature",
    range: Range::Positive,
    optional: false,
};
const SLOW_RATES_SOFTEN: Key = Key {
    name: "slow_rates_soften",
    unit: "-",
    meaning: "whether rates below reference_rate lower the strength, down to a factor of 0.05; if left out, false",
    range: Range::Flag,
    optional: true,
};

/// Checks that the metal melts above its reference temperature.
pub(crate) fn check_melting(melting: f64, reference: f64) -> Result<(), ParameterError> {
    if melting > reference {
        return Ok(());
    }
    Err(ParameterError::Order {
        key: MELTING_TEMPERATURE.name.to_owned(),
        value: melting,
        relation: "greater than",
        bound: reference,
        reason: "the metal must melt above its reference_temperature",
    })
}

/// T* = (T − T_r)/(T_m − T_r), cut to [0, 1].
#[inline]
pub(crate) fn homologous_temperature(temperature: f64, reference: f64, melting: f64) -> f64 {
    ((temperature - reference) / (melting - reference)).clamp(0.0, 1.0)
}

impl HardeningLaw for JohnsonCook {
    const NAME: &'static str = "johnson_cook";
    const SUMMARY: &'static str =
        "(a + b * eps_p^n) * (1 + c * ln(rate / reference_rate)) * (1 - T*^m)";
    const KEYS: &'static [Key] = &[
        A,
        B,
        N,
        C,
        M,
        REFERENCE_RATE,
        REFERENCE_TEMPERATURE,
        MELTING_TEMPERATURE,
        SLOW_RATES_SOFTEN,
    ];

    fn validate(&self) -> Result<(), ParameterError> {
        A.check(self.a)?;
        B.check(self.b)?;
        N.check(self.n)?;
        C.check(self.c)?;
        M.check(self.m)?;
        REFERENCE_RATE.check(self.reference_rate)?;
        REFERENCE_TEMPERATURE.check(self.reference_temperature)?;
        MELTING_TEMPERATURE.check(self.melting_temperature)?;
        check_melting(self.melting_temperature, self.reference_temperature)
    }

    // Out of the way of the laws that are a few operations.
    #[inline(never)]
    fn flow_stress(&self, at: &FlowState) -> FlowStress {
        let thermal = self.thermal_factor(at.temperature);
        let (rate, rate_slope) = self.rate_factor(at.rate);
        let (hardened, slope) = self.hardened().at(at.plastic_strain);
        let strength = self.a + hardened;
        FlowStress {
            value: strength * rate * thermal,
            slope: slope * rate * thermal,
            rate_slope: strength * rate_slope * thermal,
        }
    }

    /// The temperature is that of the start, and the plastic strain of one explicit step is a small part of
    /// what is there.
    #[inline]
    fn flow_stress_near(&self, start: &FlowStress, from: f64, at: &FlowState) -> FlowStress {
        let Some((growth, slope)) = self.hardened().growth(start.slope, from, at.plastic_strain)
        else {
            return self.flow_stress(at);
        };
        let (rate, rate_slope) = self.rate_factor(at.rate);
        let first_rate = self.rate_factor(0.0).0;
        let strength = start.value + growth;
        let rate = rate / first_rate;
        FlowStress {
            value: strength * rate,
            slope: slope * rate,
            rate_slope: strength * (rate_slope / first_rate),
        }
    }

    const RATE_DEPENDENT: bool = true;

    #[inline(always)]
    fn flow_stress_tile<S: Simd>(&self, simd: S, at: &FlowStateTile, out: &mut FlowStressTile) {
        let mut thermal = [0.0; TILE];
        self.thermal_factors(simd, &at.temperature, &mut thermal);
        let (mut rate, mut rate_slope) = ([0.0; TILE], [0.0; TILE]);
        self.rate_factors(simd, &at.rate, [&mut rate, &mut rate_slope]);
        let (mut hardened, mut slope) = ([0.0; TILE], [0.0; TILE]);
        let terms = [&mut hardened, &mut slope];
        self.hardened().tile(simd, &at.plastic_strain, terms);
        for i in 0..TILE {
            let strength = self.a + hardened[i];
            out.value[i] = strength * rate[i] * thermal[i];
            out.slope[i] = slope[i] * rate[i] * thermal[i];
            out.rate_slope[i] = strength * rate_slope[i] * thermal[i];
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
        let mut grown = GrowthTile::ZERO;
        let strains = [from, &at.plastic_strain];
        let hardened = self.hardened();
        if !hardened.growth_tile(simd, &start.slope, strains, &mut grown) {
            self.flow_stress_tile(simd, at, out);
        }
        let (mut rate, mut rate_slope) = ([0.0; TILE], [0.0; TILE]);
        self.rate_factors(simd, &at.rate, [&mut rate, &mut rate_slope]);
        let first_rate = self.rate_factor(0.0).0;
        for i in 0..TILE {
            let strength = start.value[i] + grown.growth[i];
            let rate = rate[i] / first_rate;
            let near = FlowStress {
                value: strength * rate,
                slope: grown.slope[i] * rate,
                rate_slope: strength * (rate_slope[i] / first_rate),
            };
            let far = out.at(i);
            let reached = grown.reached[i] > 0.0;
            out.value[i] = if reached { near.value } else { far.value };
            out.slope[i] = if reached { near.slope } else { far.slope };
            out.rate_slope[i] = if reached { near.rate_slope } else { far.rate_slope };
        }
    }

    /// OFHC copper and 4340 steel of Johnson & Cook 1983; the latter with softening at slow rates.
    fn examples() -> Vec<Self> {
        vec![
            Self {
                a: 90e6,
                b: 292e6,
                n: 0.31,
                c: 0.025,
                m: 1.09,
                reference_rate: 1.0,
                reference_temperature: 293.15,
                melting_temperature: 1356.0,
                slow_rates_soften: false,
            },
            Self {
                a: 792e6,
                b: 510e6,
                n: 0.26,
                c: 0.014,
                m: 1.03,
                reference_rate: 1.0,
                reference_temperature: 293.15,
                melting_temperature: 1793.0,
                slow_rates_soften: true,
            },
        ]
    }
}

impl JohnsonCook {
    #[inline(always)]
    fn hardened(&self) -> PowerTerm {
        PowerTerm {
            coefficient: self.b,
            exponent: self.n,
        }
    }

    /// 1 − T*ᵐ.
    #[inline(always)]
    fn thermal_factor(&self, temperature: f64) -> f64 {
        let hot = self.homologous(temperature);
        if hot > 0.0 {
            1.0 - power(hot, self.m)
        } else {
            1.0
        }
    }

    #[inline(always)]
    fn thermal_factors<S: Simd>(
        &self,
        simd: S,
        temperature: &[f64; TILE],
        factor: &mut [f64; TILE],
    ) {
        let (mut hot, mut base) = ([0.0; TILE], [1.0; TILE]);
        let mut hottest: f64 = 0.0;
        for i in 0..TILE {
            hot[i] = self.homologous(temperature[i]);
            base[i] = if hot[i] > 0.0 { hot[i] } else { 1.0 };
            hottest = hottest.max(hot[i]);
        }
        if hottest <= 0.0 {
            *factor = [1.0; TILE];
            return;
        }
        powers(simd, &base, self.m, factor);
        for i in 0..TILE {
            let softened = 1.0 - factor[i];
            factor[i] = if hot[i] > 0.0 { softened } else { 1.0 };
        }
    }

    #[inline(always)]
    fn homologous(&self, temperature: f64) -> f64 {
        homologous_temperature(
            temperature,
            self.reference_temperature,
            self.melting_temperature,
        )
    }

    /// 1 + C ln(ε̇_p/ε̇_0) inside its limits, and its slope.
    #[inline(always)]
    fn rate_factor(&self, rate: f64) -> (f64, f64) {
        let relative_rate = rate / self.reference_rate;
        if !(self.c > 0.0 && (relative_rate > 1.0 || self.slow_rates_soften)) {
            return (1.0, 0.0);
        }
        let factor = if relative_rate >= f64::MIN_POSITIVE {
            1.0 + self.c * logarithm(relative_rate)
        } else {
            0.0
        };
        if factor < SMALLEST_RATE_FACTOR {
            (SMALLEST_RATE_FACTOR, 0.0)
        } else {
            (factor, self.c / rate)
        }
    }

    #[inline(always)]
    fn rate_factors<S: Simd>(
        &self,
        simd: S,
        rate: &[f64; TILE],
        [factor, slope]: [&mut [f64; TILE]; 2],
    ) {
        // Rates that count, relative to the reference; 1 for the others.
        let mut relative_rate = [1.0; TILE];
        let least = if self.slow_rates_soften {
            f64::MIN_POSITIVE
        } else {
            1.0
        };
        let mut any = self.slow_rates_soften;
        for i in 0..TILE {
            let relative = rate[i] / self.reference_rate;
            relative_rate[i] = if relative >= least { relative } else { 1.0 };
            any |= relative > 1.0;
        }
        if !(any && self.c > 0.0) {
            (*factor, *slope) = ([1.0; TILE], [0.0; TILE]);
            return;
        }
        logarithms(simd, &relative_rate, factor);
        for i in 0..TILE {
            let relative = rate[i] / self.reference_rate;
            let grown = 1.0 + self.c * factor[i];
            let of_rate = self.c / rate[i];
            let counts = self.slow_rates_soften | (relative > 1.0);
            let floor = self.slow_rates_soften
                & ((relative < f64::MIN_POSITIVE) | (grown < SMALLEST_RATE_FACTOR));
            factor[i] = if floor { SMALLEST_RATE_FACTOR } else { grown };
            slope[i] = if floor | !counts { 0.0 } else { of_rate };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(plastic_strain: f64, rate: f64, temperature: f64) -> FlowState {
        FlowState {
            plastic_strain,
            rate,
            temperature,
        }
    }

    #[test]
    fn copper_has_the_strengths_of_the_formula() {
        let copper = &JohnsonCook::examples()[0];
        // By hand: 90 + 292 × 0.3^0.31 = 291.05 MPa; ln 1e4 = 9.2103; T* = 0.5 at 824.575 K.
        let quasi_static = copper.flow_stress(&at(0.3, 1.0, 293.15)).value;
        assert!((quasi_static - (90e6 + 292e6 * 0.3f64.powf(0.31))).abs() < 1.0);
        assert!((quasi_static - 291.05e6).abs() < 0.05e6, "{quasi_static}");
        let fast = copper.flow_stress(&at(0.3, 1e4, 293.15)).value;
        assert!((fast / quasi_static - (1.0 + 0.025 * 9.210_340_372)).abs() < 1e-9);
        let hot = copper
            .flow_stress(&at(0.3, 1.0, 0.5 * (293.15 + 1356.0)))
            .value;
        assert!((hot / quasi_static - (1.0 - 0.5f64.powf(1.09))).abs() < 1e-12);
    }

    #[test]
    fn rates_below_the_reference_and_cold_do_not_change_the_strength() {
        let copper = &JohnsonCook::examples()[0];
        let reference = copper.flow_stress(&at(0.1, 1.0, 293.15));
        for (rate, temperature) in [(0.0, 293.15), (1e-3, 293.15), (1.0, 77.0)] {
            let flow = copper.flow_stress(&at(0.1, rate, temperature));
            assert_eq!((flow.value, flow.rate_slope), (reference.value, 0.0));
        }
        for temperature in [1356.0, 2000.0] {
            assert_eq!(copper.flow_stress(&at(0.1, 1e5, temperature)).value, 0.0);
        }
    }

    #[test]
    fn the_logarithm_may_go_on_below_the_reference_rate_down_to_its_floor() {
        let mut law = JohnsonCook::examples()[1].clone();
        let strength = law.a + law.b * 0.1f64.powf(law.n);
        let flow = |law: &JohnsonCook, rate| law.flow_stress(&at(0.1, rate, 293.15));
        let slow = flow(&law, 1e-3).value;
        assert!((slow / strength - (1.0 - 0.014 * 1000f64.ln())).abs() < 1e-12);
        assert!((flow(&law, 0.0).value / strength - SMALLEST_RATE_FACTOR).abs() < 1e-12);
        assert_eq!(flow(&law, 0.0).rate_slope, 0.0);
        law.c = 0.0;
        assert!((flow(&law, 0.0).value / strength - 1.0).abs() < 1e-14);
    }

    #[test]
    fn a_metal_that_melts_below_its_reference_temperature_is_refused() {
        let mut law = JohnsonCook::examples()[0].clone();
        law.melting_temperature = 293.15;
        assert_eq!(law.validate().unwrap_err().key(), "melting_temperature");
        law = JohnsonCook::examples()[0].clone();
        law.reference_rate = 0.0;
        assert_eq!(law.validate().unwrap_err().key(), "reference_rate");
    }
}
