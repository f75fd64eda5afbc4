//! Deformation gradients to test with: reproducible, of no special orientation.

use jstsph_tensor::{Mat3, Vec3};

/// Numbers in (−1, 1), the same in every run (splitmix64).
pub(super) struct Numbers(u64);

impl Numbers {
    pub(super) fn new() -> Self {
        Self(0)
    }

    pub(super) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        (z >> 11) as f64 * 2f64.powi(-52) - 1.0
    }

    pub(super) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }

    /// A matrix of norm one.
    pub(super) fn matrix(&mut self) -> Mat3 {
        Mat3::from_fn(|_, _| self.next()).normalize()
    }

    pub(super) fn rotation(&mut self) -> Mat3 {
        let angle = 3.0 * self.next();
        rotation(&self.vector(), angle)
    }
}

/// Rotation about an axis (of any length but zero) by an angle in radians: Rodrigues' formula.
pub(super) fn rotation(axis: &Vec3, angle: f64) -> Mat3 {
    let k = axis.normalize().cross_matrix();
    Mat3::identity() + k * angle.sin() + k * k * (1.0 - angle.cos())
}

/// A smooth path from the identity at t = 0: shear, then stretch, then a change of volume, while the
/// body turns. Principal directions turn in the material, so that no step is proportional.
pub(super) fn twisted_path(t: f64) -> Mat3 {
    let shear = Mat3::new(0.0, 0.4 * t, 0.0, 0.0, 0.0, 0.0, 0.15 * t * t, 0.0, 0.0);
    let stretch = Mat3::new(
        0.3 * t * t,
        0.0,
        0.0,
        0.0,
        -0.2 * t * t,
        0.1 * t * t,
        0.0,
        0.0,
        0.05 * t,
    );
    let volume = 1.0 - 0.02 * t;
    rotation(&Vec3::new(0.3, -0.5, 0.8), 0.7 * t) * (Mat3::identity() + shear + stretch) * volume
}
