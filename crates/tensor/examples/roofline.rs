//! The two ceilings of one core under which every pass of a step stays: how many operations on
//! numbers of 64 bits it makes in a second, and how many bytes it moves.
//!
//! ```text
//! cargo run --release -p jstsph-tensor --example roofline
//! ```
//!
//! docs/performance.md says where the passes lie. A busy machine gives less: the best of many short
//! runs is printed.

#![allow(clippy::print_stdout, reason = "an example talks to its reader")]

use std::hint::black_box;
use std::time::Instant;

use jstsph_tensor::lanes::{Simd, WithSimd, vectorised};

/// Chains of operations that do not wait for each other: more than latency times throughput.
const CHAINS: usize = 16;
const ROUNDS: usize = 20_000;
const REPEATS: usize = 200;

/// a ← a x + y on [`CHAINS`] vectors, as products and sums of their own, which is how the passes are
/// computed, or fused, which they never are.
struct Chains {
    fused: bool,
}

impl WithSimd for Chains {
    /// Operations on numbers that were made.
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> usize {
        let (x, y) = (simd.splat_f64s(0.999), simd.splat_f64s(1e-3));
        let mut a = [simd.splat_f64s(black_box(0.5)); CHAINS];
        if self.fused {
            for _ in 0..ROUNDS {
                for a in &mut a {
                    *a = simd.mul_add_f64s(*a, x, y);
                }
            }
        } else {
            for _ in 0..ROUNDS {
                for a in &mut a {
                    *a = simd.add_f64s(simd.mul_f64s(*a, x), y);
                }
            }
        }
        black_box(a.map(|a| simd.reduce_sum_f64s(a)));
        2 * S::F64_LANES * CHAINS * ROUNDS
    }
}

/// a ← b + s c.
struct Triad<'a> {
    a: &'a mut [f64],
    b: &'a [f64],
    c: &'a [f64],
}

impl WithSimd for Triad<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        for ((a, b), c) in self.a.iter_mut().zip(self.b).zip(self.c) {
            *a = b + 3.0 * c;
        }
    }
}

/// Seconds of the fastest of some runs.
fn fastest(repeats: usize, mut run: impl FnMut()) -> f64 {
    (0..repeats)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

fn main() {
    for (name, fused) in [("products and sums", false), ("fused", true)] {
        let mut operations = 0;
        let seconds = fastest(REPEATS, || operations = vectorised(Chains { fused }));
        let rate = operations as f64 / seconds / 1e9;
        println!("{name:<24} {rate:>7.1} GFLOP/s");
    }
    // The three arrays together.
    for (name, bytes) in [
        ("first cache", 24 << 10),
        ("second cache", 384 << 10),
        ("memory", 768 << 20),
    ] {
        let count = bytes / 24;
        let (b, c) = (vec![1.0; count], vec![2.0; count]);
        let mut a = vec![0.0; count];
        let passes = (64 << 20) / bytes;
        let passes = passes.max(1);
        let repeats = if passes == 1 { 5 } else { 50 };
        let seconds = fastest(repeats, || {
            for _ in 0..passes {
                vectorised(Triad {
                    a: &mut a,
                    b: black_box(&b),
                    c: black_box(&c),
                });
            }
            black_box(a.first());
        });
        let rate = (passes * count * 24) as f64 / seconds / 1e9;
        println!("{name:<24} {rate:>7.1} GB/s, read and written by a program");
    }
}
