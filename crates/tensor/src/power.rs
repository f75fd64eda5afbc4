//! Powers, logarithms and exponentials of many numbers at once, and the same bits for a single one.
//!
//! The libraries of the systems round them differently; this one gives the same bits on every machine.

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

/// 2⁵² as bits, and 2⁵² + 2048: a number k + 2048 in the lowest bits of the first is k after subtraction.
const COUNT: u64 = 0x4330_0000_0000_0000;
const COUNT_OF_ZERO: f64 = 4_503_599_627_372_544.0;

/// Largest |y (|k| + 1)| of a power (2ᵏ m)ʸ and largest |x| of exp x: the results stay normal numbers.
const LARGEST_BINARY_EXPONENT: f64 = 1000.0;
const LARGEST_EXPONENT: f64 = 700.0;

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

/// xʸ to a relative error of 1.2 (1 + |y ln x|) 2⁻⁵², for positive x and results between 1e-300 and 1e300;
/// that of the system elsewhere.
#[inline]
#[must_use]
pub fn power(x: f64, y: f64) -> f64 {
    let (k, m) = split(x);
    if !(is_normal(x) && is_reached(k, y)) {
        return x.powf(y);
    }
    let product = logarithm_of_parts(Scalar, [k, m].map(scalar)) * y;
    let [fraction, rounded] = exponential_parts(Scalar, product);
    fraction.largest() * two_to(rounded.largest())
}

/// ln x to a relative error of 2⁻⁵¹, for positive normal numbers; that of the system elsewhere.
#[inline]
#[must_use]
pub fn logarithm(x: f64) -> f64 {
    if !is_normal(x) {
        return x.ln();
    }
    let (k, m) = split(x);
    logarithm_of_parts(Scalar, [k, m].map(scalar)).largest()
}

/// exp x to a relative error of 2⁻⁵², for |x| ≤ 700; that of the system elsewhere.
#[inline]
#[must_use]
pub fn exponential(x: f64) -> f64 {
    if !(-LARGEST_EXPONENT..=LARGEST_EXPONENT).contains(&x) {
        return x.exp();
    }
    let [fraction, rounded] = exponential_parts(Scalar, scalar(x));
    fraction.largest() * two_to(rounded.largest())
}

/// [`power`] of a tile of numbers, in the instruction set of the function it is inlined into.
#[inline(always)]
pub fn powers<S: Simd>(simd: S, x: &[f64; TILE], y: f64, out: &mut [f64; TILE]) {
    let (mut k, mut m) = ([0.0; TILE], [0.0; TILE]);
    let mut usual = true;
    for i in 0..TILE {
        (k[i], m[i]) = split(x[i]);
        usual &= is_normal(x[i]) & is_reached(k[i], y);
    }
    if !usual {
        for (out, x) in out.iter_mut().zip(x) {
            *out = power(*x, y);
        }
        return;
    }
    for pack in 0..TILE / S::F64_LANES {
        let parts = [Lanes::load(simd, &k, pack), Lanes::load(simd, &m, pack)];
        let [fraction, rounded] = exponential_parts(simd, logarithm_of_parts(simd, parts) * y);
        fraction.store(&mut m, pack);
        rounded.store(&mut k, pack);
    }
    for i in 0..TILE {
        out[i] = m[i] * two_to(k[i]);
    }
}

/// [`logarithm`] of a tile of numbers, in the instruction set of the function it is inlined into.
#[inline(always)]
pub fn logarithms<S: Simd>(simd: S, x: &[f64; TILE], out: &mut [f64; TILE]) {
    let (mut k, mut m) = ([0.0; TILE], [0.0; TILE]);
    let mut usual = true;
    for i in 0..TILE {
        (k[i], m[i]) = split(x[i]);
        usual &= is_normal(x[i]);
    }
    if !usual {
        for (out, x) in out.iter_mut().zip(x) {
            *out = logarithm(*x);
        }
        return;
    }
    for pack in 0..TILE / S::F64_LANES {
        let parts = [Lanes::load(simd, &k, pack), Lanes::load(simd, &m, pack)];
        logarithm_of_parts(simd, parts).store(out, pack);
    }
}

/// [`exponential`] of a tile of numbers, in the instruction set of the function it is inlined into.
#[inline(always)]
pub fn exponentials<S: Simd>(simd: S, x: &[f64; TILE], out: &mut [f64; TILE]) {
    let mut usual = true;
    for x in x {
        usual &= x.abs() <= LARGEST_EXPONENT;
    }
    if !usual {
        for (out, x) in out.iter_mut().zip(x) {
            *out = exponential(*x);
        }
        return;
    }
    let mut scale = [0.0; TILE];
    for pack in 0..TILE / S::F64_LANES {
        let [fraction, rounded] = exponential_parts(simd, Lanes::load(simd, x, pack));
        fraction.store(out, pack);
        rounded.store(&mut scale, pack);
    }
    for i in 0..TILE {
        out[i] *= two_to(scale[i]);
    }
}

/// Positive, neither subnormal nor infinite nor none.
#[inline(always)]
fn is_normal(x: f64) -> bool {
    (f64::MIN_POSITIVE..=f64::MAX).contains(&x)
}

/// Whether xʸ with x = 2ᵏ m, √½ ≤ m < √2, is a normal number for certain.
#[inline(always)]
fn is_reached(k: f64, y: f64) -> bool {
    (y.abs() <= 1.0) | (y.abs() * (k.abs() + 1.0) <= LARGEST_BINARY_EXPONENT)
}

/// k and m of a normal x = 2ᵏ m.
#[inline(always)]
fn split(x: f64) -> (f64, f64) {
    let bits = x.to_bits();
    let offset = bits.wrapping_sub(ROOT_OF_HALF);
    // The upper twelve bits are k with its sign; turning that bit over adds 2048.
    let counted = ((offset >> 52) ^ 0x800) | COUNT;
    (
        f64::from_bits(counted) - COUNT_OF_ZERO,
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

/// ln(2ᵏ m).
#[inline(always)]
fn logarithm_of_parts<S: Simd>(simd: S, [k, m]: [Lanes<S>; 2]) -> Lanes<S> {
    let one = Lanes::splat(simd, 1.0);
    // m − 1 is exact; ln m = f + f + ... keeps the leading part of small logarithms exact too.
    let f = (m - one).over(m + one);
    let square = f * f;
    let series = horner(simd, &LOGARITHM, square);
    k * LN_2_HIGH + (f * 2.0 * series + k * LN_2_LOW)
}

/// exp r and j + [`ROUNDING`] of x = j ln 2 + r.
#[inline(always)]
fn exponential_parts<S: Simd>(simd: S, x: Lanes<S>) -> [Lanes<S>; 2] {
    let rounding = Lanes::splat(simd, ROUNDING);
    let rounded = x * std::f64::consts::LOG2_E + rounding;
    let j = rounded - rounding;
    let remainder = (x - j * LN_2_HIGH) - j * LN_2_LOW;
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

    /// One of the functions of a tile.
    #[derive(Clone, Copy)]
    enum Of {
        Power(f64),
        Logarithm,
        Exponential,
    }
    struct Functions<'a>(Of, &'a [f64; TILE], &'a mut [f64; TILE]);
    impl WithSimd for Functions<'_> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            match self.0 {
                Of::Power(y) => powers(simd, self.1, y, self.2),
                Of::Logarithm => logarithms(simd, self.1, self.2),
                Of::Exponential => exponentials(simd, self.1, self.2),
            }
        }
    }

    fn tile(of: Of, x: &[f64; TILE]) -> [f64; TILE] {
        let mut out = [0.0; TILE];
        vectorised(Functions(of, x, &mut out));
        out
    }

    /// Bits, so that what is no number compares.
    fn bits(x: [f64; TILE]) -> [u64; TILE] {
        x.map(f64::to_bits)
    }

    #[test]
    fn powers_are_those_of_the_system_to_round_off() {
        let mut worst: f64 = 0.0;
        for step in 0..40_000 {
            // From 1e-12 to 1e12, plastic strains and ratios of rates among them.
            let x = 10.0_f64.powf(f64::from(step) * 6e-4 - 12.0) * (1.0 + 1e-9 * f64::from(step));
            for y in [1.0, -1.0, 0.5, 0.27, 0.1, -0.7, 1e-3, 1.09, 3.0, -7.3] {
                let scale = (1.0 + (y * x.ln()).abs()) * f64::EPSILON;
                worst = worst.max((power(x, y) / x.powf(y) - 1.0).abs() / scale);
            }
        }
        assert!(worst < 1.2, "{worst}");
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
    fn logarithms_and_exponentials_are_those_of_the_system_to_round_off() {
        let (mut worst_logarithm, mut worst_exponential): (f64, f64) = (0.0, 0.0);
        for step in 0..40_000 {
            let x = 10.0_f64.powf(f64::from(step) * 6e-4 - 12.0) * (1.0 + 1e-9 * f64::from(step));
            worst_logarithm = worst_logarithm.max((logarithm(x) / x.ln() - 1.0).abs());
            let near_one = 1.0 + 1e-6 * f64::from(step - 20_000);
            if near_one != 1.0 {
                let error = logarithm(near_one) / near_one.ln() - 1.0;
                worst_logarithm = worst_logarithm.max(error.abs());
            }
            let y = 0.035 * f64::from(step - 20_000);
            let error = exponential(y) / y.exp() - 1.0;
            worst_exponential = worst_exponential.max(error.abs());
        }
        assert!(worst_logarithm <= 2.0 * f64::EPSILON, "{worst_logarithm}");
        assert!(worst_exponential <= f64::EPSILON, "{worst_exponential}");
        assert_eq!((logarithm(1.0), exponential(0.0)), (0.0, 1.0));
    }

    #[test]
    fn tiles_have_the_bits_of_single_numbers() {
        let mut x: [f64; TILE] = std::array::from_fn(|i| 0.02 * 1.7_f64.powi(i as i32 - 6));
        // Usual ones, then one that is not normal, one that is no number, and results out of range.
        for unusual in [0.3, 1e-310, f64::NAN, 0.0, 1e-200, f64::MAX, -2.0] {
            x[9] = unusual;
            for y in [0.27, -0.4, 1.0, 1.3, -2.5] {
                let single = x.map(|x| power(x, y));
                assert_eq!(bits(tile(Of::Power(y), &x)), bits(single), "{unusual} {y}");
            }
            assert_eq!(bits(tile(Of::Logarithm, &x)), bits(x.map(logarithm)));
            assert_eq!(bits(tile(Of::Exponential, &x)), bits(x.map(exponential)));
        }
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
        assert_eq!(power(1e-200, 1.6), 1e-200_f64.powf(1.6));
        assert_eq!(
            (logarithm(0.0), logarithm(1e-310)),
            (f64::NEG_INFINITY, 1e-310_f64.ln())
        );
        assert_eq!(
            (exponential(-800.0), exponential(710.0)),
            (0.0, f64::INFINITY)
        );
        assert!(exponential(f64::NAN).is_nan());
    }
}
