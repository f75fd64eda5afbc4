//! The term B ε_pⁿ, which several laws have.

use jstsph_tensor::lanes::{Lanes, Simd, TILE};
use jstsph_tensor::{power, powers};

/// B ε_pⁿ.
#[derive(Clone, Copy, Debug)]
pub(super) struct PowerTerm {
    /// B, zero or positive.
    pub(super) coefficient: f64,
    /// n, positive.
    pub(super) exponent: f64,
}

/// Relative growth of ε_p below which the series is used, for n ≤ 1. Its coefficients are below 1/k: what is
/// left out is below n 0.03¹⁰/90 < 1e-17 of the term.
const SERIES_LIMIT: f64 = 0.03;
const SERIES_TERMS: usize = 8;
/// 1/(k + 1).
const RECIPROCALS: [f64; SERIES_TERMS + 1] = [
    1.0,
    1.0 / 2.0,
    1.0 / 3.0,
    1.0 / 4.0,
    1.0 / 5.0,
    1.0 / 6.0,
    1.0 / 7.0,
    1.0 / 8.0,
    1.0 / 9.0,
];

/// How much the terms of many points have grown, and their slopes then.
pub(super) struct GrowthTile {
    pub(super) growth: [f64; TILE],
    pub(super) slope: [f64; TILE],
    /// 1 where the series reaches, else 0.
    pub(super) reached: [f64; TILE],
}

impl GrowthTile {
    pub(super) const ZERO: Self = Self {
        growth: [0.0; TILE],
        slope: [0.0; TILE],
        reached: [0.0; TILE],
    };
}

impl PowerTerm {
    /// The term and its slope, which is infinite at ε_p = 0 if n < 1.
    #[inline(always)]
    pub(super) fn at(self, strain: f64) -> (f64, f64) {
        if strain > 0.0 {
            let value = self.coefficient * power(strain, self.exponent);
            (value, self.exponent * value / strain)
        } else {
            (0.0, self.first_slope())
        }
    }

    /// [`at`](Self::at) of many points.
    #[inline(always)]
    pub(super) fn tile<S: Simd>(
        self,
        simd: S,
        strain: &[f64; TILE],
        [value, slope]: [&mut [f64; TILE]; 2],
    ) {
        let mut base = [1.0; TILE];
        for i in 0..TILE {
            base[i] = if strain[i] > 0.0 { strain[i] } else { 1.0 };
        }
        powers(simd, &base, self.exponent, value);
        let first_slope = self.first_slope();
        for i in 0..TILE {
            let term = self.coefficient * value[i];
            let of_term = self.exponent * term / base[i];
            value[i] = if strain[i] > 0.0 { term } else { 0.0 };
            slope[i] = if strain[i] > 0.0 {
                of_term
            } else {
                first_slope
            };
        }
    }

    /// At ε_p = 0.
    #[inline(always)]
    fn first_slope(self) -> f64 {
        if self.coefficient == 0.0 || self.exponent > 1.0 {
            0.0
        } else if self.exponent < 1.0 {
            f64::INFINITY
        } else {
            self.coefficient
        }
    }

    /// How much the term, times any number, grows between two strains, and its slope at the second, from its
    /// slope at the first: the binomial series. None where it does not reach.
    #[inline(always)]
    pub(super) fn growth(self, slope: f64, from: f64, to: f64) -> Option<(f64, f64)> {
        let more = to - from;
        let x = if more > 0.0 { more / from } else { 0.0 };
        if x >= self.series_limit() {
            return None;
        }
        let mut sum = 1.0;
        for k in (1..=SERIES_TERMS).rev() {
            sum = 1.0 + sum * x * self.series_coefficient(k);
        }
        let growth = slope * more * sum;
        Some((growth, (slope * from + growth * self.exponent) / to))
    }

    /// [`growth`](Self::growth) of many points; whether the series reaches all.
    #[inline(always)]
    pub(super) fn growth_tile<S: Simd>(
        self,
        simd: S,
        slope: &[f64; TILE],
        [from, to]: [&[f64; TILE]; 2],
        out: &mut GrowthTile,
    ) -> bool {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let mut beyond = zero;
        for pack in 0..TILE / S::F64_LANES {
            let slope = Lanes::load(simd, slope, pack);
            let (from, to) = (Lanes::load(simd, from, pack), Lanes::load(simd, to, pack));
            let more = to - from;
            let x = zero.if_below(more, more.over(from), zero);
            let mut sum = one;
            let mut k = SERIES_TERMS;
            while k > 0 {
                sum = one + sum * x * self.series_coefficient(k);
                k -= 1;
            }
            let growth = slope * more * sum;
            growth.store(&mut out.growth, pack);
            (slope * from + growth * self.exponent)
                .over(to)
                .store(&mut out.slope, pack);
            let reached = x.if_less(self.series_limit(), one, zero);
            reached.store(&mut out.reached, pack);
            beyond = beyond + (one - reached);
        }
        beyond.largest() <= 0.0
    }

    #[inline(always)]
    fn series_limit(self) -> f64 {
        if self.exponent <= 1.0 {
            SERIES_LIMIT
        } else {
            0.0
        }
    }

    /// Of xᵏ in ((1 + x)ⁿ − 1)/(n x), over that of xᵏ⁻¹.
    #[inline(always)]
    fn series_coefficient(self, k: usize) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a handful")]
        {
            (self.exponent - k as f64) * RECIPROCALS[k]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_is_the_power_to_round_off() {
        for exponent in [0.05, 0.31, 0.8, 1.0] {
            let term = PowerTerm {
                coefficient: 2.0,
                exponent,
            };
            for from in [1e-7, 1e-3, 0.2, 1.9_f64] {
                // Both powers have their errors, then a few products.
                let tolerance = 3.0 * f64::EPSILON * (1.0 + (exponent * from.ln()).abs());
                let (value, slope) = term.at(from);
                for part in [0.0, 1e-9, 1e-4, 0.01, 0.0299] {
                    let to = from + part * from;
                    let (growth, slope) = term.growth(slope, from, to).unwrap();
                    let (direct, direct_slope) = term.at(to);
                    assert!(
                        ((value + growth) / direct - 1.0).abs() < tolerance,
                        "{exponent} {from} {part}"
                    );
                    assert!(
                        (slope / direct_slope - 1.0).abs() < tolerance,
                        "{exponent} {from} {part}"
                    );
                }
                assert!(term.growth(slope, from, 1.0301 * from).is_none());
            }
        }
    }

    #[test]
    fn the_series_leaves_out_virgin_points_and_large_exponents() {
        let mut term = PowerTerm {
            coefficient: 2.0,
            exponent: 0.3,
        };
        assert!(term.growth(f64::INFINITY, 0.0, 1e-9).is_none());
        term.exponent = 1.5;
        assert!(term.growth(1.0, 0.1, 0.1001).is_none());
    }
}
