//! From the commands of a path to straight pieces, arcs of circles, and curves made straight.

use kurbo::{Affine, Arc, PathEl, Point, SvgArc, Vec2};
use svgtypes::PathSegment;

use super::bulge;
use crate::{Contour, GeometryError};

/// Part of its radius by which an arc of an ellipse may deviate from the cubic curves that it is
/// made of: far below any tolerance.
const ELLIPSE: f64 = 1e-7;

/// Two radii, or the two stretches of a transformation, are equal to this part.
const ROUND: f64 = 1e-9;

/// A piece of a line; it begins where the one before ends.
enum Piece {
    /// Straight, or an arc with this bulge.
    Arc(Point, f64),
    /// A cubic Bézier curve: two control points and the end.
    Curve(Point, Point, Point),
}

struct Line {
    start: Point,
    pieces: Vec<Piece>,
    closed: bool,
}

/// All lines of a file.
#[derive(Default)]
pub(super) struct Lines {
    lines: Vec<Line>,
}

/// Where a path stands; coordinates of its element.
struct Pen {
    at: Point,
    start: Point,
    /// The last control point and the order of its curve, which smooth curves go on from.
    control: Option<(u8, Point)>,
}

impl Pen {
    fn place(&self, abs: bool, x: f64, y: f64) -> Point {
        if abs {
            Point::new(x, y)
        } else {
            self.at + Vec2::new(x, y)
        }
    }

    /// The mirrored control point of the curve before, if it was of the same order.
    fn mirrored(&self, order: u8) -> Point {
        match self.control {
            Some((known, control)) if known == order => self.at + (self.at - control),
            _ => self.at,
        }
    }
}

impl Lines {
    /// Adds the lines of a path, transformed.
    pub(super) fn add(&mut self, segments: &[PathSegment], affine: Affine) {
        let mut pen = Pen {
            at: Point::ZERO,
            start: Point::ZERO,
            control: None,
        };
        let first = self.lines.len();
        // After Z a path goes on where its last line began.
        let mut is_new = true;
        for &segment in segments {
            if let PathSegment::MoveTo { abs, x, y } = segment {
                pen.at = pen.place(abs, x, y);
                (pen.start, pen.control, is_new) = (pen.at, None, true);
                continue;
            }
            if is_new {
                self.lines.push(Line {
                    start: affine * pen.start,
                    pieces: Vec::new(),
                    closed: false,
                });
                is_new = false;
            }
            let place = self.lines.len() - 1;
            let line = &mut self.lines[place];
            if let PathSegment::ClosePath { .. } = segment {
                line.closed = true;
                (pen.at, pen.control, is_new) = (pen.start, None, true);
                continue;
            }
            let control = line.add(segment, &pen, affine);
            pen.control = control;
            pen.at = end(segment, &pen);
        }
        // Nothing is drawn by a command without an extent, such as "M 0 0 Z".
        let is_drawn = |line: &Line| !line.pieces.is_empty();
        let added = self.lines.split_off(first);
        self.lines.extend(added.into_iter().filter(is_drawn));
    }

    /// All points, control points included.
    pub(super) fn points(&self) -> impl Iterator<Item = [f64; 2]> {
        self.lines.iter().flat_map(|line| {
            let of = |piece: &Piece| match *piece {
                Piece::Arc(end, _) => vec![end],
                Piece::Curve(a, b, end) => vec![a, b, end],
            };
            let pieces = line.pieces.iter().flat_map(of);
            std::iter::once(line.start)
                .chain(pieces)
                .map(|p| [p.x, p.y])
        })
    }

    /// The lines with straight pieces for curves, from which they deviate by about the tolerance.
    pub(super) fn flatten(self, tolerance: f64) -> Result<Vec<Contour>, GeometryError> {
        self.lines
            .into_iter()
            .map(|line| line.flatten(tolerance))
            .collect()
    }
}

/// Where a command leads.
fn end(segment: PathSegment, pen: &Pen) -> Point {
    match segment {
        PathSegment::MoveTo { abs, x, y }
        | PathSegment::LineTo { abs, x, y }
        | PathSegment::CurveTo { abs, x, y, .. }
        | PathSegment::SmoothCurveTo { abs, x, y, .. }
        | PathSegment::Quadratic { abs, x, y, .. }
        | PathSegment::SmoothQuadratic { abs, x, y }
        | PathSegment::EllipticalArc { abs, x, y, .. } => pen.place(abs, x, y),
        PathSegment::HorizontalLineTo { abs, x } => {
            Point::new(if abs { x } else { pen.at.x + x }, pen.at.y)
        }
        PathSegment::VerticalLineTo { abs, y } => {
            Point::new(pen.at.x, if abs { y } else { pen.at.y + y })
        }
        PathSegment::ClosePath { .. } => pen.start,
    }
}

impl Line {
    /// Adds a command that draws; returns the control point for a smooth curve after it.
    fn add(&mut self, segment: PathSegment, pen: &Pen, affine: Affine) -> Option<(u8, Point)> {
        let end = end(segment, pen);
        match segment {
            PathSegment::CurveTo {
                abs,
                x1,
                y1,
                x2,
                y2,
                ..
            } => {
                let (a, b) = (pen.place(abs, x1, y1), pen.place(abs, x2, y2));
                self.curve([a, b, end], affine);
                return Some((3, b));
            }
            PathSegment::SmoothCurveTo { abs, x2, y2, .. } => {
                let b = pen.place(abs, x2, y2);
                self.curve([pen.mirrored(3), b, end], affine);
                return Some((3, b));
            }
            PathSegment::Quadratic { abs, x1, y1, .. } => {
                let control = pen.place(abs, x1, y1);
                self.curve(raised(pen.at, control, end), affine);
                return Some((2, control));
            }
            PathSegment::SmoothQuadratic { .. } => {
                let control = pen.mirrored(2);
                self.curve(raised(pen.at, control, end), affine);
                return Some((2, control));
            }
            PathSegment::EllipticalArc {
                rx,
                ry,
                x_axis_rotation,
                large_arc,
                sweep,
                ..
            } => {
                let arc = Arc::from_svg_arc(&SvgArc {
                    from: pen.at,
                    to: end,
                    radii: Vec2::new(rx, ry),
                    x_rotation: x_axis_rotation.to_radians(),
                    large_arc,
                    sweep,
                });
                match arc {
                    Some(arc) => self.arc(arc, end, affine),
                    None => self.pieces.push(Piece::Arc(affine * end, 0.0)),
                }
            }
            _ => self.pieces.push(Piece::Arc(affine * end, 0.0)),
        }
        None
    }

    fn curve(&mut self, [a, b, end]: [Point; 3], affine: Affine) {
        self.pieces
            .push(Piece::Curve(affine * a, affine * b, affine * end));
    }

    /// An arc of a circle stays one, if the transformation keeps circles; `end` as written.
    fn arc(&mut self, arc: Arc, end: Point, affine: Affine) {
        let [a, b, c, d, ..] = affine.as_coeffs();
        let (across, along) = (a * c + b * d, a * a + b * b);
        let keeps = across.abs() <= ROUND * along && (c * c + d * d - along).abs() <= ROUND * along;
        if !keeps || (arc.radii.x - arc.radii.y).abs() > ROUND * arc.radii.x {
            let mut curves: Vec<[Point; 3]> = Vec::new();
            arc.to_cubic_beziers(ELLIPSE * arc.radii.x.min(arc.radii.y), |a, b, end| {
                curves.push([a, b, end]);
            });
            if let Some(last) = curves.last_mut() {
                last[2] = end;
            }
            curves
                .into_iter()
                .for_each(|curve| self.curve(curve, affine));
            return;
        }
        // Halves, so that a whole turn has a chord.
        let half = 0.5 * arc.sweep_angle;
        let bulge = bulge(half) * affine.determinant().signum();
        let middle =
            arc.center + arc.radii.x * Vec2::from_angle(arc.x_rotation + arc.start_angle + half);
        self.pieces.push(Piece::Arc(affine * middle, bulge));
        self.pieces.push(Piece::Arc(affine * end, bulge));
    }

    fn flatten(self, tolerance: f64) -> Result<Contour, GeometryError> {
        let mut points = vec![[self.start.x, self.start.y]];
        let mut bulges = Vec::new();
        let mut at = self.start;
        for piece in self.pieces {
            match piece {
                Piece::Arc(end, bulge) => {
                    points.push([end.x, end.y]);
                    bulges.push(bulge);
                    at = end;
                }
                Piece::Curve(a, b, end) => {
                    let path = [PathEl::MoveTo(at), PathEl::CurveTo(a, b, end)];
                    kurbo::flatten(path, tolerance, |element| {
                        if let PathEl::LineTo(point) = element {
                            points.push([point.x, point.y]);
                            bulges.push(0.0);
                        }
                    });
                    at = end;
                }
            }
        }
        if self.closed {
            // Z is a straight line back, unless the last piece has led there.
            if points.len() > 1 && points.last() == points.first() {
                points.pop();
            } else {
                bulges.push(0.0);
            }
        }
        Contour::new(points, bulges, self.closed)
    }
}

/// The control points of a quadratic curve as a cubic one.
fn raised(start: Point, control: Point, end: Point) -> [Point; 3] {
    let toward = |from: Point| from + (control - from) * (2.0 / 3.0);
    [toward(start), toward(end), end]
}
