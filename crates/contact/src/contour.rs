//! Chains and profiles along the lines of a drawing.

use jstsph_geometry::{Contour, point_of_arc};
use jstsph_tensor::Vec3;

use crate::{Chain, ContactError, Profile, Side, Surface};

/// An arc is made of fillets that turn by at most this angle, rad: the corner that a fillet rounds
/// moves away to infinity as the turn approaches a straight angle.
const LARGEST_TURN: f64 = std::f64::consts::FRAC_PI_2;

impl Chain {
    /// A wall along a line of straight pieces and arcs, with particles on one side of it; open
    /// lines go on straight beyond their ends. Arcs stay arcs.
    ///
    /// # Errors
    /// Those of [`Chain::new`]; points count those of the line with the corners of its arcs between
    /// them.
    pub fn along(contour: &Contour, free_side: Side) -> Result<Self, ContactError> {
        let (mut points, mut fillets) = (Vec::new(), Vec::new());
        for (from, to, bulge) in contour.pieces() {
            points.push(from);
            fillets.push(0.0);
            if bulge == 0.0 {
                continue;
            }
            let turn = 4.0 * bulge.atan();
            let count = (turn.abs() / LARGEST_TURN).ceil().max(1.0);
            let mut begin = from;
            for part in 1..=count as usize {
                let end = if part == count as usize {
                    to
                } else {
                    point_of_arc(from, to, bulge, part as f64 / count)
                };
                let (corner, radius) = rounded_corner(begin, end, turn / count);
                points.push(corner);
                fillets.push(radius);
                if part < count as usize {
                    points.push(end);
                    fillets.push(0.0);
                }
                begin = end;
            }
        }
        if !contour.is_closed() {
            points.extend(contour.points().last());
            fillets.push(0.0);
        }
        Self::new(&points, &fillets, contour.is_closed(), free_side)
    }
}

/// Where the tangents at the ends of an arc meet, and the radius of the fillet that fills the
/// corner as far as the nearer end, so that it fits.
fn rounded_corner(from: [f64; 2], to: [f64; 2], turn: f64) -> ([f64; 2], f64) {
    let half = 0.5 * turn;
    let (sin, cos) = half.sin_cos();
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    // The chord turned back by half the angle, as long as to the corner.
    let reach = 0.5 / cos;
    let corner = [
        from[0] + reach * (cos * dx + sin * dy),
        from[1] + reach * (cos * dy - sin * dx),
    ];
    let before = [corner[0] - from[0], corner[1] - from[1]];
    let after = [to[0] - corner[0], to[1] - corner[1]];
    let found = f64::atan2(
        before[0] * after[1] - before[1] * after[0],
        before[0] * after[0] + before[1] * after[1],
    );
    let shorter = before[0].hypot(before[1]).min(after[0].hypot(after[1]));
    (corner, shorter / (0.5 * found.abs()).tan())
}

impl Profile {
    /// Walls along lines, free on the side of each on which a point (m) lies.
    ///
    /// # Errors
    /// Those of [`Chain::new`] and [`Profile::new`]; [`ContactError::FreePointOnWall`] if the point
    /// lies on one of the lines.
    pub fn around(contours: &[Contour], free_point: [f64; 2]) -> Result<Self, ContactError> {
        let [x, y] = free_point;
        let chain = |contour: &Contour| {
            let left = Chain::along(contour, Side::Left)?;
            let surface = Surface::Profile(Self::new(vec![left.clone()])?);
            let distance = surface.gap(&Vec3::new(x, y, 0.0)).distance;
            if distance > 0.0 {
                Ok(left)
            } else if distance < 0.0 {
                Chain::along(contour, Side::Right)
            } else {
                Err(ContactError::FreePointOnWall { x, y })
            }
        };
        Self::new(contours.iter().map(chain).collect::<Result<_, _>>()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(profile: &Profile, x: f64, y: f64) -> f64 {
        let surface = Surface::Profile(profile.clone());
        surface.gap(&Vec3::new(x, y, 0.0)).distance
    }

    #[test]
    fn a_circle_has_the_distance_of_a_circle_inside_and_outside() {
        let circle = Contour::new(vec![[5.0, 1.0], [1.0, 1.0]], vec![1.0, 1.0], true).unwrap();
        for (free, sign) in [([3.0, 1.5], -1.0), ([9.0, 0.0], 1.0)] {
            let profile = Profile::around(std::slice::from_ref(&circle), free).unwrap();
            for k in 0..200 {
                let (sin, cos) = (0.1 * f64::from(k)).sin_cos();
                let radius = 0.2 + 0.03 * f64::from(k);
                let found = distance(&profile, 3.0 + radius * cos, 1.0 + radius * sin);
                assert!(
                    (found - sign * (radius - 2.0)).abs() < 1e-14,
                    "{k}: {found}"
                );
            }
        }
        assert_eq!(
            Profile::around(&[circle], [5.0, 1.0]),
            Err(ContactError::FreePointOnWall { x: 5.0, y: 1.0 })
        );
    }

    #[test]
    fn an_arc_between_two_lines_is_the_fillet_of_their_corner() {
        // A step as in a die: down, round a quarter of radius 2, and to the right.
        let quarter = (std::f64::consts::FRAC_PI_8).tan();
        let points = vec![[0.0, 10.0], [0.0, 2.0], [2.0, 0.0], [10.0, 0.0]];
        let contour = Contour::new(points, vec![0.0, quarter, 0.0], false).unwrap();
        let profile = Profile::around(&[contour], [5.0, 5.0]).unwrap();
        let corner = [[0.0, 10.0], [0.0, 0.0], [10.0, 0.0]];
        let filleted = Chain::new(&corner, &[0.0, 2.0, 0.0], false, Side::Left).unwrap();
        let filleted = Profile::new(vec![filleted]).unwrap();
        for i in -20..40 {
            for j in -20..40 {
                let (x, y) = (0.3 * f64::from(i), 0.3 * f64::from(j));
                let (found, expected) = (distance(&profile, x, y), distance(&filleted, x, y));
                assert!(
                    (found - expected).abs() < 1e-14,
                    "{x} {y}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn an_arc_need_not_be_tangent_to_its_neighbours() {
        // A half circle of radius 1 standing on a floor.
        let points = vec![[-3.0, 0.0], [-1.0, 0.0], [1.0, 0.0], [3.0, 0.0]];
        let contour = Contour::new(points, vec![0.0, -1.0, 0.0], false).unwrap();
        let profile = Profile::around(&[contour], [0.0, 5.0]).unwrap();
        assert!((distance(&profile, 0.0, 1.5) - 0.5).abs() < 1e-15);
        assert!((distance(&profile, 2.5, 0.25) - 0.25).abs() < 1e-15);
        assert!((distance(&profile, 0.0, 0.5) + 0.5).abs() < 1e-15);
        assert!((distance(&profile, -7.0, 1.0) - 1.0).abs() < 1e-15);
    }
}
