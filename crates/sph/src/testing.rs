//! Bodies, random numbers and norms that the tests of several modules share.

use jstsph_geometry::{Body, Dimension, Lattice, Shape, Spacing, build_body};
use jstsph_tensor::{Mat3, Vec3};

use crate::{Kernel, Support};

/// A reproducible source of numbers (SplitMix64, Steele, Lea & Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Uniform in [−1, 1).
    pub(crate) fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub(crate) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }

    /// A vector without out-of-plane component when `dimension` is 2.
    pub(crate) fn vector_in(&mut self, dimension: usize) -> Vec3 {
        let mut vector = self.vector();
        if dimension == 2 {
            vector.z = 0.0;
        }
        vector
    }

    pub(crate) fn tensor(&mut self) -> Mat3 {
        Mat3::from_columns(&[self.vector(), self.vector(), self.vector()])
    }
}

/// A square or cube of unit size with `nodes` per side.
pub(crate) fn unit_box(nodes: usize, dimension: usize) -> Body {
    let solid = dimension == 3;
    let shape = Shape::Box {
        min: Vec3::zeros(),
        max: Vec3::new(1.0, 1.0, if solid { 1.0 } else { 0.0 }),
    };
    let spacing = Spacing::Counts([nodes; 3]);
    let dimension = if solid {
        Dimension::Solid
    } else {
        Dimension::PlaneStrain
    };
    build_body(shape, Lattice::Cubic { spacing }, dimension).unwrap()
}

/// The same with every node moved by up to a fifth of the spacing along each axis.
pub(crate) fn jittered_box(nodes: usize, dimension: usize) -> Body {
    let mut body = unit_box(nodes, dimension);
    let mut random = Random(7);
    for position in std::sync::Arc::make_mut(&mut body.positions) {
        *position += random.vector_in(dimension) * (0.2 * body.spacing);
    }
    body
}

/// A box whose inner nodes are moved by up to a fifth of the spacing along each axis.
pub(crate) fn inside_jittered_box(nodes: usize, dimension: usize) -> Body {
    let mut body = unit_box(nodes, dimension);
    let mut random = Random(5);
    for (position, boundary) in std::sync::Arc::make_mut(&mut body.positions)
        .iter_mut()
        .zip(&body.boundary)
    {
        let shift = random.vector_in(dimension) * (0.2 * body.spacing);
        if !boundary {
            *position += shift;
        }
    }
    body
}

/// The default kernel with h = `ratio` spacings.
pub(crate) fn support_of(body: &Body, ratio: f64) -> Support {
    Support {
        kernel: Kernel::QuinticSpline,
        smoothing_length: ratio * body.spacing,
        dimension: body.dimension.count(),
    }
}

/// Asserts that the errors on successively halved spacings fall with `order`.
pub(crate) fn assert_order(errors: &[f64], order: f64, tolerance: f64) {
    let observed: Vec<f64> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
    let last = observed[observed.len() - 1];
    assert!(
        (last - order).abs() < tolerance,
        "errors {errors:?} fall with orders {observed:?}, expected {order} ± {tolerance}"
    );
}
