//! Powers xʸ of many positive numbers at once, and the same bits for a single one.
//!
//! The libraries of the systems round powers differently; this one gives the same bits on every
//! machine.

use pulp::Scalar;

use crate::lanes::{Lanes, Simd, TILE};

/// Bits of √½: numbers are split as 2ᵏ m with √½ ≤ m < √2.
const ROOT_OF_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
const EXPONENT_MASK: u64 = 0xfff0_0000_0000_0000;
const ONE: u64 = 0x3ff0_0000_0000_0000;

/// ln 2 in two parts; k times the first is exact for the exponents of all numbers.
const LN_2_HIGH: f64 = f64::from_bits(0x3fe6_2e42_fee0_0000);
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// 1.5 · 2⁵²: adding it rounds to an integer, which is then in the lowest bits.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// Largest |y|: the result stays a normal number.
const LARGEST_EXPONENT: f64 = 1.0;

/// ln m = 2 f Σ f²ʲ/(2j + 1), f = (m − 1)/(m + 1), f² < 0.0295: the first term left out is below 1e-17.
const LOGARITHM: [f64; 11] = [
    1.0,
    1.0 / 3.0,
    1.0 / 5.0,
    1.0 / 7.0,
    1.0 / 9.0,
    1.0 / 11.0,
    1.0 / 13.0,
    1.0 / 15.0,
    1.0 / 17.0,
    1.0 / 19.0,
    1.0 / 21.0,
];

/// exp r = Σ rʲ/j!, |r| < 0.347: the first term left out is below 1e-17.
const EXPONENTIAL: [f64; 14] = [
    1.0,
    1.0,
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];

/// xʸ to a relative error of (1 + |y ln x|) 2⁻⁵², for positive x and |y| ≤ 1; that of the system elsewhere.
#[inline]
#[must_use]
pub fn power(x: f64, y: f64) -> f64 {
    if !(is_normal(x) && y.abs() <= LARGEST_EXPONENT) {
        return x.powf(y);
    }
    let (k, m) = split(x);
    let [fraction, rounded] = exponential_of_logarithm(Scalar, [k, m].map(scalar), y);
    fraction.largest() * two_to(rounded.largest())
}

/// [`power`] of a tile of numbers, in the instruction set of the function it is inlined into.
#[inline(always)]
pub fn powers<S: Simd>(simd: S, x: &[f64; TILE], y: f64, out: &mut [f64; TILE]) {
    let mut usual = y.abs() <= LARGEST_EXPONENT;
    for x in x {
        usual &= is_normal(*x);
    }
    if !usual {
        for (out, x) in out.iter_mut().zip(x) {
            *out = power(*x, y);
        }
        return;
    }
    let (mut k, mut m) = ([0.0; TILE], [0.0; TILE]);
    for i in 0..TILE {
        (k[i], m[i]) = split(x[i]);
    }
    for pack in 0..TILE / S::F64_LANES {
        let parts = [Lanes::load(simd, &k, pack), Lanes::load(simd, &m, pack)];
        let [fraction, rounded] = exponential_of_logarithm(simd, parts, y);
        fraction.store(&mut m, pack);
        rounded.store(&mut k, pack);
    }
    for i in 0..TILE {
        out[i] = m[i] * two_to(k[i]);
    }
}

/// Positive, neither subnormal nor infinite nor none.
#[inline(always)]
fn is_normal(x: f64) -> bool {
    (f64::MIN_POSITIVE..=f64::MAX).contains(&x)
}

/// k and m of x = 2ᵏ m.
#[inline(always)]
fn split(x: f64) -> (f64, f64) {
    let bits = x.to_bits();
    let offset = bits.wrapping_sub(ROOT_OF_HALF);
    #[expect(clippy::cast_possible_wrap, reason = "the sign of the shift is meant")]
    let k = (offset as i64) >> 52;
    #[expect(clippy::cast_precision_loss, reason = "eleven bits")]
    (
        k as f64,
        f64::from_bits(bits.wrapping_sub(offset & EXPONENT_MASK)),
    )
}

/// 2ʲ of a small integer j to which [`ROUNDING`] was added.
#[inline(always)]
fn two_to(rounded: f64) -> f64 {
    f64::from_bits(ONE.wrapping_add(rounded.to_bits() << 52))
}

#[inline(always)]
fn scalar(x: f64) -> Lanes<Scalar> {
    Lanes::splat(Scalar, x)
}

/// exp r and j + [`ROUNDING`] of y ln(2ᵏ m) = j ln 2 + r.
#[inline(always)]
fn exponential_of_logarithm<S: Simd>(simd: S, [k, m]: [Lanes<S>; 2], y: f64) -> [Lanes<S>; 2] {
    let one = Lanes::splat(simd, 1.0);
    let rounding = Lanes::splat(simd, ROUNDING);
    // m − 1 is exact; ln m = f + f + ... keeps the leading part of small logarithms exact too.
    let f = (m - one).over(m + one);
    let square = f * f;
    let series = horner(simd, &LOGARITHM, square);
    let logarithm = k * LN_2_HIGH + (f * 2.0 * series + k * LN_2_LOW);
    let product = logarithm * y;

    let rounded = product * std::f64::consts::LOG2_E + rounding;
    let j = rounded - rounding;
    let remainder = (product - j * LN_2_HIGH) - j * LN_2_LOW;
    [horner(simd, &EXPONENTIAL, remainder), rounded]
}

#[inline(always)]
fn horner<S: Simd, const N: usize>(simd: S, coefficients: &[f64; N], x: Lanes<S>) -> Lanes<S> {
    let mut sum = Lanes::splat(simd, coefficients[N - 1]);
    let mut j = N - 1;
    while j > 0 {
        j -= 1;
        sum = Lanes::splat(simd, coefficients[j]) + sum * x;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{WithSimd, vectorised};

    struct Powers<'a>(&'a [f64; TILE], f64, &'a mut [f64; TILE]);
    impl WithSimd for Powers<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            powers(simd, self.0, self.1, self.2);
        }
    }

    fn powers_of(x: &[f64; TILE], y: f64) -> [f64; TILE] {
        let mut out = [0.0; TILE];
        vectorised(Powers(x, y, &mut out));
        out
    }

    #[test]
    fn powers_are_those_of_the_system_to_round_off() {
        let mut worst: f64 = 0.0;
        for step in 0..40_000 {
            // From 1e-12 to 1e12, plastic strains and ratios of rates among them.
            let x = 10.0_f64.powf(f64::from(step) * 6e-4 - 12.0) * (1.0 + 1e-9 * f64::from(step));
            for y in [1.0, -1.0, 0.5, 0.27, 0.1, -0.7, 1e-3] {
                let scale = (1.0 + (y * x.ln()).abs()) * f64::EPSILON;
                worst = worst.max((power(x, y) / x.powf(y) - 1.0).abs() / scale);
            }
        }
        assert!(worst < 1.0, "{worst}");
        assert!(worst > 0.0, "compared with itself");
    }

    #[test]
    fn exact_powers_are_exact() {
        for y in [0.0, 0.3, -1.0] {
            assert_eq!(power(1.0, y), 1.0);
        }
        assert_eq!(power(4.0, 0.5), 2.0);
        assert_eq!(power(0.25, -1.0), 4.0);
    }

    #[test]
    fn tiles_have_the_bits_of_single_numbers() {
        let mut x: [f64; TILE] = std::array::from_fn(|i| 0.02 * 1.7_f64.powi(i as i32 - 6));
        for y in [0.27, -0.4, 1.0, 1.3] {
            assert_eq!(powers_of(&x, y), x.map(|x| power(x, y)));
        }
        x[9] = 1e-310;
        assert_eq!(powers_of(&x, 0.27), x.map(|x| power(x, 0.27)));
    }

    #[test]
    fn unusual_arguments_are_those_of_the_system() {
        for (x, y) in [
            (0.0, 0.3),
            (f64::INFINITY, 0.5),
            (1e-310, 0.5),
            (2.0, 900.0),
            (3.0, f64::INFINITY),
        ] {
            assert_eq!(power(x, y), x.powf(y));
        }
        for (x, y) in [(-1.0, 0.5), (f64::NAN, 0.5), (2.0, f64::NAN)] {
            assert!(power(x, y).is_nan());
        }
    }
}
