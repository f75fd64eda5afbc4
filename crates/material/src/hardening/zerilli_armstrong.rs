//! Strength by the thermal activation of dislocations: `[eq:zerilli-armstrong]`.

use super::power_term::PowerTerm;
use super::{FlowState, FlowStateTile, FlowStress, FlowStressTile, HardeningLaw};
use crate::{Key, ParameterError, Range};
use jstsph_tensor::lanes::{Simd, TILE};
use jstsph_tensor::{exponential, exponentials, logarithm, logarithms};
use serde::{Deserialize, Serialize};

/// σ_Y = C_0 + (C_1 + C_2 √ε_p) exp(−C_3 T + C_4 T ln ε̇_p) + C_5 ε_pⁿ, ε̇_p in 1/s,
/// `[eq:zerilli-armstrong]`.
///
/// F. J. Zerilli & R. W. Armstrong, Journal of Applied Physics 61 (1987), 1816-1825: body-centred
/// metals with C_2 = 0, face-centred ones with C_1 = C_5 = 0. C_0 is the athermal part, that of the
/// grain size included.
///
/// The rate factor ε̇_p^(C_4 T) goes to zero with the rate: yield is tested against the athermal part
/// C_0 + C_5 ε_pⁿ.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ZerilliArmstrong {
    /// C_0, Pa, positive.
    pub c0: f64,
    /// C_1, Pa, zero or positive: thermal part independent of strain (bcc).
    #[serde(default)]
    pub c1: f64,
    /// C_2, Pa, zero or positive: thermal part that grows with √ε_p (fcc).
    #[serde(default)]
    pub c2: f64,
    /// C_3, 1/K, zero or positive.
    pub c3: f64,
    /// C_4, 1/K, zero or positive.
    pub c4: f64,
    /// C_5, Pa, zero or positive: athermal hardening (bcc).
    #[serde(default)]
    pub c5: f64,
    /// n, positive.
    #[serde(default = "one")]
    pub n: f64,
}

fn one() -> f64 {
    1.0
}

const C0: Key = Key {
    name: "c0",
    unit: "Pa",
    meaning: "athermal strength, that of the grain size included",
    range: Range::Positive,
    optional: false,
};
const C1: Key = Key {
    name: "c1",
    unit: "Pa",
    meaning: "thermal strength independent of strain (bcc); if left out, 0",
    range: Range::NonNegative,
    optional: true,
};
const C2: Key = Key {
    name: "c2",
    unit: "Pa",
    meaning: "thermal strength that grows with the root of strain (fcc); if left out, 0",
    range: Range::NonNegative,
    optional: true,
};
const C3: Key = Key {
    name: "c3",
    unit: "1/K",
    meaning: "thermal softening",
    range: Range::NonNegative,
    optional: false,
};
const C4: Key = Key {
    name: "c4",
    unit: "1/K",
    meaning: "growth of the thermal strength with the logarithm of the rate in 1/s",
    range: Range::NonNegative,
    optional: false,
};
const C5: Key = Key {
    name: "c5",
    unit: "Pa",
    meaning: "athermal hardening (bcc); if left out, 0",
    range: Range::NonNegative,
    optional: true,
};
const N: Key = Key {
    name: "n",
    unit: "-",
    meaning: "exponent of athermal hardening; if left out, 1",
    range: Range::Positive,
    optional: true,
};

impl HardeningLaw for ZerilliArmstrong {
    const NAME: &'static str = "zerilli_armstrong";
    const SUMMARY: &'static str =
        "c0 + (c1 + c2 * sqrt(eps_p)) * exp(-c3 * T + c4 * T * ln(rate)) + c5 * eps_p^n";
    const KEYS: &'static [Key] = &[C0, C1, C2, C3, C4, C5, N];

    fn validate(&self) -> Result<(), ParameterError> {
        C0.check(self.c0)?;
        C1.check(self.c1)?;
        C2.check(self.c2)?;
        C3.check(self.c3)?;
        C4.check(self.c4)?;
        C5.check(self.c5)?;
        N.check(self.n)
    }

    // Out of the way of the laws that are a few operations.
    #[inline(never)]
    fn flow_stress(&self, at: &FlowState) -> FlowStress {
        let (hardened, slope) = self.hardened().at(at.plastic_strain);
        let root = at.plastic_strain.sqrt();
        let (base, exponent) = self.activation(at.rate, at.temperature);
        let activated = exponential(exponent + self.c4 * at.temperature * logarithm(base));
        self.assembled(at, [hardened, slope], root, activated)
    }

    const RATE_DEPENDENT: bool = true;

    #[inline(always)]
    fn flow_stress_tile<S: Simd>(&self, simd: S, at: &FlowStateTile, out: &mut FlowStressTile) {
        let (mut hardened, mut slope) = ([0.0; TILE], [0.0; TILE]);
        let terms = [&mut hardened, &mut slope];
        self.hardened().tile(simd, &at.plastic_strain, terms);
        let (mut base, mut exponent) = ([0.0; TILE], [0.0; TILE]);
        for i in 0..TILE {
            (base[i], exponent[i]) = self.activation(at.rate[i], at.temperature[i]);
        }
        let mut activated = [0.0; TILE];
        logarithms(simd, &base, &mut activated);
        for i in 0..TILE {
            exponent[i] += self.c4 * at.temperature[i] * activated[i];
        }
        exponentials(simd, &exponent, &mut activated);
        for i in 0..TILE {
            let root = at.plastic_strain[i].sqrt();
            let terms = [hardened[i], slope[i]];
            out.set(i, self.assembled(&at.at(i), terms, root, activated[i]));
        }
    }

    /// Armco iron (bcc) and OFHC copper (fcc), Zerilli & Armstrong 1987, Table I.
    fn examples() -> Vec<Self> {
        vec![
            Self {
                c0: 65e6,
                c1: 1033e6,
                c2: 0.0,
                c3: 0.00698,
                c4: 0.000_415,
                c5: 266e6,
                n: 0.289,
            },
            Self {
                c0: 65e6,
                c1: 0.0,
                c2: 890e6,
                c3: 0.0028,
                c4: 0.000_115,
                c5: 0.0,
                n: 1.0,
            },
        ]
    }
}

impl ZerilliArmstrong {
    #[inline(always)]
    fn hardened(&self) -> PowerTerm {
        PowerTerm {
            coefficient: self.c5,
            exponent: self.n,
        }
    }

    /// The rate whose logarithm counts, 1/s, and −C_3 T.
    #[inline(always)]
    fn activation(&self, rate: f64, temperature: f64) -> (f64, f64) {
        let rate = if rate >= f64::MIN_POSITIVE { rate } else { 1.0 };
        (rate, -self.c3 * temperature)
    }

    /// σ_Y and its slopes from C_5 ε_pⁿ and its slope, √ε_p and exp(−C_3 T + C_4 T ln ε̇_p).
    #[inline(always)]
    fn assembled(
        &self,
        at: &FlowState,
        [hardened, slope]: [f64; 2],
        root: f64,
        activated: f64,
    ) -> FlowStress {
        let sensitivity = self.c4 * at.temperature;
        // Without rate sensitivity the factor is the same at all rates, zero included.
        let moves = sensitivity > 0.0;
        let still = at.rate < f64::MIN_POSITIVE;
        let factor = if moves & still { 0.0 } else { activated };
        let first_slope = if sensitivity < 1.0 { f64::INFINITY } else { 0.0 };
        let factor_slope = if still { first_slope } else { sensitivity * activated / at.rate };
        let thermal = self.c1 + self.c2 * root;
        // 0 × ∞ at strain zero or rate zero has no meaning; the other factor decides.
        let root_slope = 0.5 * self.c2 / root;
        let thermal_slope = if (self.c2 > 0.0) & (factor > 0.0) { root_slope * factor } else { 0.0 };
        FlowStress {
            value: self.c0 + thermal * factor + hardened,
            slope: thermal_slope + slope,
            rate_slope: if moves & (thermal > 0.0) { thermal * factor_slope } else { 0.0 },
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
    fn iron_and_copper_have_the_strengths_of_their_formulas() {
        let [iron, copper] = &ZerilliArmstrong::examples()[..] else {
            unreachable!("two examples")
        };
        // By hand at 300 K: iron, ε_p = 0.1, 1e3/s: exp(−2.094 + 0.1245 × 6.9078) = 0.29113, 300.7 MPa;
        // copper, ε_p = 0.25, 1/s: exp(−0.84) = 0.43171, 192.1 MPa.
        let flow = iron.flow_stress(&at(0.1, 1e3, 300.0)).value;
        assert!((flow - (65e6 + 1033e6 * 0.291_13 + 266e6 * 0.1f64.powf(0.289))).abs() < 0.05e6);
        let flow = copper.flow_stress(&at(0.25, 1.0, 300.0)).value;
        assert!((flow - (65e6 + 445e6 * 0.431_71)).abs() < 0.01e6, "{flow}");
    }

    #[test]
    fn at_rate_zero_only_the_athermal_part_is_left() {
        for law in ZerilliArmstrong::examples() {
            let flow = law.flow_stress(&at(0.2, 0.0, 300.0));
            assert_eq!(flow.value, law.c0 + law.c5 * 0.2f64.powf(law.n));
        }
        let rigid = ZerilliArmstrong {
            c4: 0.0,
            ..ZerilliArmstrong::examples()[0].clone()
        };
        let flow = rigid.flow_stress(&at(0.0, 0.0, 300.0));
        assert_eq!(
            (flow.value, flow.rate_slope),
            (65e6 + 1033e6 * (-0.00698f64 * 300.0).exp(), 0.0)
        );
    }
}
