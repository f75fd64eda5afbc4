//! Skipping particles that cannot have reached a wall.

use jstsph_tensor::Vec3;

/// Safety margin of the skip relative to the gap, and relative to the coordinates: far above the
/// rounding of a signed distance, far below what would cost an evaluation.
const GAP_MARGIN: f64 = 1e-9;
const COORDINATE_MARGIN: f64 = 1e-14;

/// Above the relative rounding of a number to single precision, 2⁻²⁴.
const ROUNDING: f64 = 1.2e-7;

/// Where a particle was when its gap to one part of an obstacle was last computed, and how far
/// around that point there is no wall. One per particle and part.
///
/// A signed distance is 1-Lipschitz: a particle that has moved by less than its gap is still
/// free. Skipping by this rule never changes a result, whatever happened in between.
///
/// # Limits
/// The margin for rounding supposes that centres and radii are not many orders of magnitude larger
/// than the coordinates of the particles and their gaps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CachedGap {
    /// About the position in the frame of the obstacle, m: in single precision, because every particle has
    /// one of these per wall.
    position: [f32; 3],
    /// Radius of the ball around it that is free of walls, m; negative if there is none.
    clearance: f32,
}

impl CachedGap {
    /// Nothing is known: the particle needs a check.
    pub const UNKNOWN: Self = Self {
        position: [0.0; 3],
        clearance: f32::NEG_INFINITY,
    };

    /// Remembers a gap (m) computed at a position relative to the obstacle (m).
    #[inline]
    #[must_use]
    pub fn new(x: &Vec3, gap: f64) -> Self {
        let position = [x.x as f32, x.y as f32, x.z as f32];
        // The ball is around the rounded position, and no larger for being rounded itself.
        let off = (x - wide(position)).norm();
        let clearance = gap - GAP_MARGIN * gap.abs() - COORDINATE_MARGIN * x.amax() - off;
        let clearance = clearance - ROUNDING * clearance.abs();
        Self {
            position,
            clearance: clearance as f32,
        }
    }

    /// Whether the wall may be within `reach` of the particle, now at `x` relative to the
    /// obstacle. With a reach of the contact tolerance plus the relative travel of the coming step,
    /// a particle that needs no check is not touched by any [`Law`](crate::Law).
    #[inline]
    #[must_use]
    pub fn needs_check(&self, x: &Vec3, reach: f64) -> bool {
        let slack = f64::from(self.clearance) - reach;
        // Negated so that anything not a number needs a check.
        !(slack > 0.0 && (x - wide(self.position)).norm_squared() < slack * slack)
    }
}

fn wide(position: [f32; 3]) -> Vec3 {
    Vec3::from(position.map(f64::from))
}

impl Default for CachedGap {
    fn default() -> Self {
        Self::UNKNOWN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_unknown_needs_a_check() {
        assert!(CachedGap::default().needs_check(&Vec3::zeros(), 0.0));
    }

    #[test]
    fn a_particle_is_skipped_until_its_reach_meets_the_gap() {
        let cached = CachedGap::new(&Vec3::new(1.0, 0.0, 0.0), 0.5);
        assert!(!cached.needs_check(&Vec3::new(1.0, 0.0, 0.2), 0.299));
        assert!(cached.needs_check(&Vec3::new(1.0, 0.0, 0.2), 0.3));
        assert!(cached.needs_check(&Vec3::new(1.0, 0.0, 0.5), 0.0));
    }

    #[test]
    fn touching_penetrating_and_broken_particles_always_need_a_check() {
        for gap in [0.0, -0.1, f64::NAN] {
            assert!(CachedGap::new(&Vec3::x(), gap).needs_check(&Vec3::x(), 0.0));
        }
        let cached = CachedGap::new(&Vec3::x(), 1.0);
        assert!(cached.needs_check(&Vec3::new(f64::NAN, 0.0, 0.0), 0.0));
        assert!(cached.needs_check(&Vec3::x(), f64::NAN));
    }

    #[test]
    fn rounding_to_single_precision_never_hides_a_wall() {
        // No number here is one of single precision; the wall is the plane x = 0.3.
        for k in 0..2000 {
            let x = Vec3::new(0.1 + 1e-7 * f64::from(k).sin(), 1.0 / 3.0, -7.0 / 9.0);
            let gap = 0.3 - x.x;
            let cached = CachedGap::new(&x, gap);
            let near = x + Vec3::x() * (gap * (1.0 - 1e-9));
            assert!(cached.needs_check(&near, 0.3 - near.x));
            assert!(!cached.needs_check(&x, gap * 0.999_99));
        }
    }
}
