//! Lines of straight pieces and arcs in the plane, as drawings have them.

use std::f64::consts::PI;

use crate::{GeometryError, Polygon, Shape};

/// Arcs of the outline of a body are cut into pieces of at most this angle, rad (5°).
const OUTLINE_STEP: f64 = PI / 36.0;

/// A connected line of straight pieces and arcs of circles in the x-y plane, open or closed.
///
/// The piece after point k has bulge k: tan(θ/4) of an arc that turns by θ, positive to the left,
/// and 0 for a straight piece (the convention of DXF).
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    points: Vec<[f64; 2]>,
    bulges: Vec<f64>,
    closed: bool,
}

impl Contour {
    /// A line through points (m); closed, the last piece leads back to the first point.
    ///
    /// # Errors
    /// [`GeometryError::NotFinite`] for a coordinate or bulge that is not.
    ///
    /// # Panics
    /// Unless there is a point and one bulge per piece: a bug in the caller.
    pub fn new(
        points: Vec<[f64; 2]>,
        bulges: Vec<f64>,
        closed: bool,
    ) -> Result<Self, GeometryError> {
        assert_eq!(points.len(), bulges.len() + usize::from(!closed));
        for (quantity, value) in points
            .iter()
            .flatten()
            .map(|value| ("a coordinate", *value))
            .chain(bulges.iter().map(|value| ("a bulge", *value)))
        {
            if !value.is_finite() {
                return Err(GeometryError::NotFinite {
                    item: "drawing",
                    quantity,
                    value,
                });
            }
        }
        Ok(Self {
            points,
            bulges,
            closed,
        })
    }

    /// Where the pieces begin and end, m.
    #[must_use]
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// One bulge per piece.
    #[must_use]
    pub fn bulges(&self) -> &[f64] {
        &self.bulges
    }

    /// Whether the last piece leads back to the first point.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The pieces: begin, end, bulge.
    pub fn pieces(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2], f64)> {
        let next = |k: usize| self.points[(k + 1) % self.points.len()];
        (0..self.bulges.len()).map(move |k| (self.points[k], next(k), self.bulges[k]))
    }

    /// Radii of the arcs, m.
    pub fn radii(&self) -> impl Iterator<Item = f64> {
        self.pieces()
            .filter(|(_, _, bulge)| *bulge != 0.0)
            .map(|(from, to, bulge)| {
                let chord = (to[0] - from[0]).hypot(to[1] - from[1]);
                chord * (1.0 + bulge * bulge) / (4.0 * bulge.abs())
            })
    }

    /// The line with its arcs cut into pieces of at most `step` (rad) whose ends lie on the arc.
    /// The first point is not repeated at the end of a closed line.
    #[must_use]
    pub fn polyline(&self, step: f64) -> Vec<[f64; 2]> {
        let mut line = Vec::with_capacity(self.points.len());
        for (from, to, bulge) in self.pieces() {
            line.push(from);
            let count = (4.0 * bulge.atan().abs() / step).ceil().max(1.0);
            for part in 1..count as usize {
                line.push(point_of_arc(from, to, bulge, part as f64 / count));
            }
        }
        if !self.closed {
            line.extend(self.points.last());
        }
        line
    }

    /// The same line seen in other units and moved.
    pub(crate) fn placed(mut self, scale: f64, translation: [f64; 2]) -> Self {
        for point in &mut self.points {
            *point = [0, 1].map(|axis| scale * point[axis] + translation[axis]);
        }
        self
    }

    pub(crate) fn into_parts(self) -> (Vec<[f64; 2]>, Vec<f64>) {
        (self.points, self.bulges)
    }
}

/// A point of the arc from one point to another, `part` (0 to 1) of its angle behind the first.
///
/// The chord to it is longer than a part of the whole chord and turned; this has no cancellation
/// for flat arcs, as a way over the centre would have.
#[must_use]
pub fn point_of_arc(from: [f64; 2], to: [f64; 2], bulge: f64, part: f64) -> [f64; 2] {
    let half = 2.0 * bulge.atan();
    let stretch = if half == 0.0 {
        part
    } else {
        (part * half).sin() / half.sin()
    };
    let (sin, cos) = (half * (part - 1.0)).sin_cos();
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    [
        from[0] + stretch * (cos * dx - sin * dy),
        from[1] + stretch * (sin * dx + cos * dy),
    ]
}

impl Shape {
    /// The body that closed lines bound: one outline, with or without holes. Arcs are cut into
    /// pieces of 5°. `extrusion` as for [`Polygon::new`].
    ///
    /// # Errors
    /// [`GeometryError::OpenContour`], [`GeometryError::SeveralContours`] where neither of two lines
    /// lies in the other, lines lie in holes or lines meet, and those of [`Polygon::new`].
    pub fn from_contours(
        contours: &[Contour],
        extrusion: Option<[f64; 2]>,
    ) -> Result<Self, GeometryError> {
        if let Some(open) = contours.iter().find(|contour| !contour.closed) {
            let (start, end) = (open.points[0], open.points[open.points.len() - 1]);
            return Err(GeometryError::OpenContour {
                start,
                end,
                gap: (end[0] - start[0]).hypot(end[1] - start[1]),
            });
        }
        let mut polygons = contours
            .iter()
            .map(|contour| Polygon::new(contour.polyline(OUTLINE_STEP), extrusion))
            .collect::<Result<Vec<_>, _>>()?;
        polygons.sort_by(|a, b| b.area().total_cmp(&a.area()));
        let Some((outline, holes)) = polygons.split_first() else {
            return Err(GeometryError::EmptyDrawing);
        };
        for (number, hole) in holes.iter().enumerate() {
            let is_apart = |other: &Polygon| !hole.meets(other) && !other.contains(hole);
            if hole.meets(outline)
                || !outline.contains(hole)
                || !holes[..number].iter().all(is_apart)
            {
                return Err(GeometryError::SeveralContours {
                    count: contours.len(),
                    at: hole.points()[0],
                });
            }
        }
        if holes.is_empty() {
            return Ok(Self::Polygon(outline.clone()));
        }
        Ok(Self::Difference(
            polygons.into_iter().map(Self::Polygon).collect(),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dimension;

    fn circle(x: f64, y: f64, radius: f64) -> Contour {
        Contour::new(vec![[x + radius, y], [x - radius, y]], vec![1.0, 1.0], true).unwrap()
    }

    #[test]
    fn points_of_arcs_lie_on_the_circle() {
        for point in circle(3.0, 4.0, 2.0).polyline(0.1) {
            assert!(((point[0] - 3.0).hypot(point[1] - 4.0) - 2.0).abs() < 1e-14);
        }
        assert_eq!(
            circle(0.0, 0.0, 2.0).radii().collect::<Vec<_>>(),
            [2.0, 2.0]
        );
        // A sagitta of 1e-9 on a chord of 1: bulge is sagitta over half the chord.
        let flat = point_of_arc([0.0, 0.0], [1.0, 0.0], 2e-9, 0.5);
        assert!((flat[1] + 1e-9).abs() < 1e-24, "{flat:?}");
        assert_eq!(point_of_arc([0.0, 0.0], [1.0, 2.0], 0.0, 0.5), [0.5, 1.0]);
    }

    #[test]
    fn lines_within_one_line_are_holes() {
        let plate = |holes: &[Contour]| {
            let square = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
            let mut all = holes.to_vec();
            all.push(Contour::new(square.to_vec(), vec![0.0; 4], true).unwrap());
            Shape::from_contours(&all, None)
        };
        let shape = plate(&[circle(3.0, 3.0, 1.0), circle(7.0, 7.0, 2.0)]).unwrap();
        // Regular 72-gons, as exactly as combinations with slanted edges are integrated.
        let expected = 100.0 - 5.0 * 36.0 * (PI / 36.0).sin();
        let volume = shape.volume(Dimension::PlaneStrain);
        assert!((volume - expected).abs() < 1e-5 * expected, "{volume}");
        for holes in [
            [circle(3.0, 3.0, 1.0), circle(20.0, 3.0, 1.0)],
            [circle(3.0, 3.0, 1.0), circle(3.0, 3.0, 2.0)],
            [circle(3.0, 3.0, 1.0), circle(4.5, 3.0, 1.0)],
            [circle(3.0, 3.0, 1.0), circle(10.0, 3.0, 1.0)],
        ] {
            let error = plate(&holes).unwrap_err();
            assert!(
                matches!(error, GeometryError::SeveralContours { count: 3, .. }),
                "{error}"
            );
        }
    }
}
