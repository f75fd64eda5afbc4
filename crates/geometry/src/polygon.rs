//! Polygons in the plane, and prisms over them.

use jstsph_tensor::Vec3;

use crate::GeometryError;

/// A simple polygon in the x-y plane, counter-clockwise, with or without an extent along z.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    points: Vec<[f64; 2]>,
    extrusion: Option<[f64; 2]>,
}

impl Polygon {
    /// A polygon from its corners (m, in either direction, the last joined to the first). With
    /// `extrusion` it is the prism between two values of z; without, it belongs to plane strain.
    ///
    /// # Errors
    /// Fewer than three corners, numbers that are not finite, corners that coincide with the next,
    /// edges that cross or touch others, or an extrusion that is not positive.
    pub fn new(
        mut points: Vec<[f64; 2]>,
        extrusion: Option<[f64; 2]>,
    ) -> Result<Self, GeometryError> {
        const ITEM: &str = "polygon";
        if points.len() < 3 {
            return Err(GeometryError::TooFew {
                quantity: "number of corners of the polygon",
                value: points.len(),
                minimum: 3,
            });
        }
        let numbers = points.iter().flatten().chain(extrusion.iter().flatten());
        if let Some(&value) = numbers.into_iter().find(|value| !value.is_finite()) {
            return Err(GeometryError::NotFinite {
                item: ITEM,
                quantity: "a coordinate",
                value,
            });
        }
        if let Some([low, high]) = extrusion {
            crate::shape::positive(ITEM, "extent of the extrusion", high - low)?;
        }
        let count = points.len();
        for index in 0..count {
            if points[index] == points[(index + 1) % count] {
                let [x, y] = points[index];
                return Err(GeometryError::CoincidentCorners { index, x, y });
            }
        }
        for first in 0..count {
            for second in first + 1..count {
                if let Some([x, y]) = touch(&points, first, second) {
                    return Err(GeometryError::CrossesItself {
                        first,
                        second,
                        x,
                        y,
                    });
                }
            }
        }
        if signed_area(&points) < 0.0 {
            points.reverse();
        }
        Ok(Self { points, extrusion })
    }

    /// Corners, counter-clockwise, m.
    #[must_use]
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Lowest and highest z of a prism, m.
    #[must_use]
    pub fn extrusion(&self) -> Option<[f64; 2]> {
        self.extrusion
    }

    /// Area, m².
    #[must_use]
    pub fn area(&self) -> f64 {
        signed_area(&self.points)
    }

    /// Corners of the smallest axis-parallel box around it; z = 0 without an extrusion.
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        let [bottom, top] = self.extrusion.unwrap_or([0.0, 0.0]);
        let (mut low, mut high) = (
            Vec3::new(f64::INFINITY, f64::INFINITY, bottom),
            Vec3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, top),
        );
        for &[x, y] in &self.points {
            (low.x, low.y) = (low.x.min(x), low.y.min(y));
            (high.x, high.y) = (high.x.max(x), high.y.max(y));
        }
        (low, high)
    }

    /// Signed distance in the plane, m; negative inside.
    pub(crate) fn planar_distance(&self, x: &Vec3) -> f64 {
        let mut nearest = f64::INFINITY;
        for (from, to) in self.edges() {
            let (along, offset) = (
                [to[0] - from[0], to[1] - from[1]],
                [x.x - from[0], x.y - from[1]],
            );
            let length = along[0] * along[0] + along[1] * along[1];
            let part = ((offset[0] * along[0] + offset[1] * along[1]) / length).clamp(0.0, 1.0);
            let away = [offset[0] - part * along[0], offset[1] - part * along[1]];
            nearest = nearest.min(away[0].hypot(away[1]));
        }
        let beyond = self.crossings(x.y).iter().filter(|&&at| at > x.x).count();
        if beyond % 2 == 1 { -nearest } else { nearest }
    }

    /// Whether a corner of another polygon lies inside: all of it does if the edges do not meet.
    pub(crate) fn contains(&self, other: &Self) -> bool {
        let [x, y] = other.points[0];
        self.planar_distance(&Vec3::new(x, y, 0.0)) < 0.0
    }

    /// Whether edges of the two have a point in common.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        self.edges()
            .any(|edge| other.edges().any(|second| common(edge, second).is_some()))
    }

    /// Where the line of this y crosses the edges, ascending; their number is even.
    pub(crate) fn crossings(&self, y: f64) -> Vec<f64> {
        let mut found: Vec<f64> = self
            .edges()
            .filter(|(from, to)| (from[1] > y) != (to[1] > y))
            .map(|(from, to)| from[0] + (y - from[1]) / (to[1] - from[1]) * (to[0] - from[0]))
            .collect();
        found.sort_by(f64::total_cmp);
        found
    }

    fn edges(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
        let count = self.points.len();
        (0..count).map(move |i| (self.points[i], self.points[(i + 1) % count]))
    }
}

fn signed_area(points: &[[f64; 2]]) -> f64 {
    // Relative to a corner, so that round-off scales with the polygon.
    let [x, y] = points[0];
    let shifted = |i: usize| {
        let [a, b] = points[i % points.len()];
        [a - x, b - y]
    };
    let twice: f64 = (0..points.len())
        .map(|i| cross(shifted(i), shifted(i + 1)))
        .sum();
    0.5 * twice
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// A point where edges `first` < `second` meet although they are not neighbours, or lie on each
/// other although they are.
fn touch(points: &[[f64; 2]], first: usize, second: usize) -> Option<[f64; 2]> {
    let count = points.len();
    let at = |i: usize| points[i % count];
    let (a, b, c, d) = (at(first), at(first + 1), at(second), at(second + 1));
    let (along, other) = (minus(b, a), minus(d, c));
    if first + 1 == second || (first == 0 && second == count - 1) {
        // Neighbours share a corner; they must not turn back on each other.
        let folds = cross(along, other) == 0.0 && along[0] * other[0] + along[1] * other[1] < 0.0;
        return folds.then_some(if first + 1 == second { b } else { a });
    }
    common((a, b), (c, d))
}

/// A point that two segments have in common.
fn common((a, b): ([f64; 2], [f64; 2]), (c, d): ([f64; 2], [f64; 2])) -> Option<[f64; 2]> {
    let (along, other) = (minus(b, a), minus(d, c));
    let side = |p: [f64; 2], from: [f64; 2], along: [f64; 2]| cross(along, minus(p, from));
    let (c_side, d_side) = (side(c, a, along), side(d, a, along));
    let (a_side, b_side) = (side(a, c, other), side(b, c, other));
    if c_side == 0.0 && d_side == 0.0 {
        // On one line: they meet if their intervals do.
        let length = along[0] * along[0] + along[1] * along[1];
        let place = |p: [f64; 2]| {
            let offset = minus(p, a);
            (offset[0] * along[0] + offset[1] * along[1]) / length
        };
        let (low, high) = (place(c).min(place(d)), place(c).max(place(d)));
        return (low <= 1.0 && high >= 0.0).then_some(c);
    }
    let meets = c_side * d_side <= 0.0 && a_side * b_side <= 0.0;
    meets.then(|| {
        let part = a_side / (a_side - b_side);
        [a[0] + part * along[0], a[1] + part * along[1]]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ell() -> Vec<[f64; 2]> {
        vec![
            [0.0, 0.0],
            [6.0, 0.0],
            [6.0, 3.0],
            [3.0, 3.0],
            [3.0, 10.0],
            [0.0, 10.0],
        ]
    }

    #[test]
    fn area_and_distance_do_not_depend_on_the_direction() {
        let mut reversed = ell();
        reversed.reverse();
        for points in [ell(), reversed] {
            let polygon = Polygon::new(points, None).unwrap();
            assert_eq!(polygon.area(), 39.0);
            let distance = |x, y| polygon.planar_distance(&Vec3::new(x, y, 0.0));
            assert_eq!(distance(1.0, 5.0), -1.0);
            assert_eq!(distance(5.0, 5.0), 2.0);
            // Nearest to the re-entrant corner from inside.
            assert!((distance(2.0, 2.0) + 2.0_f64.sqrt()).abs() < 1e-15);
        }
    }

    #[test]
    fn knots_folds_and_touching_edges_are_refused() {
        let bow = vec![[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        assert_eq!(
            Polygon::new(bow, None).unwrap_err().to_string(),
            "edges 0 and 2 of the polygon cross or touch near (0.5, 0.5) m; edge k runs from \
             corner k to the next one"
        );
        let fold = vec![[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        assert!(Polygon::new(fold, None).is_err());
        let pinched = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]];
        assert!(Polygon::new(pinched, None).is_err());
        let twice = vec![[0.0, 0.0], [0.0, 0.0], [1.0, 1.0]];
        assert!(matches!(
            Polygon::new(twice, None),
            Err(GeometryError::CoincidentCorners { index: 0, .. })
        ));
        assert!(Polygon::new(ell(), Some([1.0, 1.0])).is_err());
    }
}
