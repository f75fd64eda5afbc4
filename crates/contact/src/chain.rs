//! Signed distance of a chain of straight segments and tangent arcs.

use std::ops::Range;

use jstsph_tensor::Vec3;

use crate::fillet::Path;
use crate::{ContactError, Gap, Side};

/// Segments per bounding box. A box costs about as much as a segment, so that the chains of a die
/// (a handful of segments) should have one box, which is never tested.
const BLOCK: usize = 8;

/// Two edges that turn by less than this (rad) are one straight line to double precision.
const SMOOTH_TURN: f64 = 1e-9;

/// Distances below this part of the largest coordinate carry no direction any more.
const DIRECTION_ROUNDING: f64 = 1e-14;

/// Arcs are drawn, and checked for crossings, in pieces of at most this angle, rad (5°).
const DRAWING_STEP: f64 = std::f64::consts::PI / 36.0;

/// A straight piece; origin + s tangent, s between start and end, free side on the left.
#[derive(Clone, Debug, PartialEq)]
struct Segment {
    origin: [f64; 2],
    tangent: [f64; 2],
    /// Zero, or −∞ for the extended first edge of an open chain.
    start: f64,
    /// The length (zero if fillets take all of the edge), or +∞.
    end: f64,
}

impl Segment {
    /// How far a point is beyond the ends along the segment (0 between them), and its distance to
    /// the line, positive on the free side.
    #[inline]
    fn beyond_and_across(&self, x: f64, y: f64) -> (f64, f64) {
        let [rx, ry] = [x - self.origin[0], y - self.origin[1]];
        let [tx, ty] = self.tangent;
        let along = rx * tx + ry * ty;
        (
            along - along.max(self.start).min(self.end),
            ry * tx - rx * ty,
        )
    }

    fn line_gap(&self, x: f64, y: f64) -> Gap {
        let [tx, ty] = self.tangent;
        let (_, distance) = self.beyond_and_across(x, y);
        Gap {
            distance,
            normal: Vec3::new(-ty, tx, 0.0),
        }
    }
}

/// What a segment meets at one of its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Joint {
    /// An arc, a straight continuation, or nothing: the normal does not jump.
    Smooth,
    /// A sharp corner that points into the free side; its unit normal is the bisector's.
    Convex {
        vertex: [f64; 2],
        bisector: [f64; 2],
    },
    /// A sharp corner that points into the wall.
    Reentrant {
        vertex: [f64; 2],
        bisector: [f64; 2],
    },
}

/// A fillet. It answers for points within its angle only: its ends belong to the segments on both
/// sides, of which there is always one, if need be of length zero.
#[derive(Clone, Debug, PartialEq)]
struct FilletArc {
    centre: [f64; 2],
    /// Unit vectors to the ends, anticlockwise; the angle between them is below π.
    first: [f64; 2],
    last: [f64; 2],
    radius: f64,
    /// +1 if the centre lies in the wall (convex), −1 if it lies in the free side.
    sign: f64,
}

impl FilletArc {
    #[inline]
    fn faces(&self, vx: f64, vy: f64) -> bool {
        let [fx, fy] = self.first;
        let [lx, ly] = self.last;
        fx * vy - fy * vx >= 0.0 && vx * ly - vy * lx >= 0.0
    }
}

/// Consecutive segments and their arcs, with a box around them.
#[derive(Clone, Debug, PartialEq)]
struct Block {
    min: [f64; 2],
    max: [f64; 2],
    segments: Range<usize>,
    arcs: Range<usize>,
}

impl Block {
    fn include(&mut self, [x, y]: [f64; 2]) {
        self.min = [self.min[0].min(x), self.min[1].min(y)];
        self.max = [self.max[0].max(x), self.max[1].max(y)];
    }

    fn distance_squared(&self, x: f64, y: f64) -> f64 {
        let dx = (self.min[0] - x).max(x - self.max[0]).max(0.0);
        let dy = (self.min[1] - y).max(y - self.max[1]).max(0.0);
        dx * dx + dy * dy
    }
}

/// The feature nearest to a point.
#[derive(Clone, Copy)]
enum Nearest {
    Segment(usize),
    Arc(usize),
}

/// A rigid wall in the x-y plane (plane strain): straight edges through points, with corners that
/// are sharp or rounded by tangent arcs, and particles on one side.
///
/// A closed chain joins its last point to its first. An open chain has no ends: its first and
/// last edges extend straight to infinity, so that every point of the plane is on one side or the
/// other. The z coordinate is ignored.
///
/// # Limits
/// The signed distance is exact and 1-Lipschitz everywhere. At a sharp corner that points into the
/// wall a particle touches two edges; [`gap`](crate::Surface::gap) reports the nearer one, while
/// [`resolve`](crate::resolve) respects both.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    segments: Vec<Segment>,
    /// The joints at start and end of each segment.
    joints: Vec<[Joint; 2]>,
    arcs: Vec<FilletArc>,
    blocks: Vec<Block>,
    /// For drawing; without the extension.
    polyline: Vec<[f64; 2]>,
    closed: bool,
    reentrant: bool,
    /// Length below which a difference of coordinates has no direction, m.
    rounding: f64,
}

impl Chain {
    /// Builds the chain and checks it.
    ///
    /// # Arguments
    /// * `points`: corners in order, m.
    /// * `fillets`: one radius per point, m; 0 is a sharp corner. The ends of an open chain have 0.
    /// * `closed`: join the last point to the first (which is not repeated).
    /// * `free_side`: where particles may be, seen along the chain.
    ///
    /// # Errors
    /// Too few points, numbers that are not finite, a wrong number of fillets, negative ones, or
    /// ones that do not fit on their edges; points that coincide, edges that double back, a chain
    /// (with its extension) that crosses or touches itself.
    pub fn new(
        points: &[[f64; 2]],
        fillets: &[f64],
        closed: bool,
        free_side: Side,
    ) -> Result<Self, ContactError> {
        let path = Path::new(points, fillets, closed, free_side)?;
        let largest = points.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
        let mut chain = Self {
            segments: Vec::with_capacity(path.edges()),
            joints: Vec::with_capacity(path.edges()),
            arcs: Vec::new(),
            blocks: Vec::with_capacity(path.edges().div_ceil(BLOCK)),
            polyline: path.polyline(DRAWING_STEP),
            closed,
            reentrant: false,
            rounding: DIRECTION_ROUNDING * largest,
        };
        for edge in 0..path.edges() {
            chain.push(&path, edge);
        }
        chain.check_crossings(largest)?;
        Ok(chain)
    }

    /// Adds the arc before an edge and the straight part of the edge.
    fn push(&mut self, path: &Path, edge: usize) {
        let count = path.points.len();
        let next = (edge + 1) % count;
        if edge.is_multiple_of(BLOCK) {
            self.blocks.push(Block {
                min: [f64::INFINITY; 2],
                max: [f64::NEG_INFINITY; 2],
                segments: edge..edge,
                arcs: self.arcs.len()..self.arcs.len(),
            });
        }
        let (origin, length) = path.straight(edge);
        let tangent = path.tangents[edge];
        let start = if !path.closed && edge == 0 {
            f64::NEG_INFINITY
        } else {
            0.0
        };
        let end = if !path.closed && next == count - 1 {
            f64::INFINITY
        } else {
            length
        };
        let joints = [joint(path, edge), joint(path, next)];
        let is_reentrant = |joint: &Joint| matches!(joint, Joint::Reentrant { .. });
        self.reentrant |= joints.iter().any(is_reentrant);

        let block = self
            .blocks
            .last_mut()
            .expect("a block was begun with the first edge");
        for s in [start, end] {
            // A box needs a number that can be multiplied by a zero component of the tangent.
            let s = s.clamp(-f64::MAX.sqrt(), f64::MAX.sqrt());
            block.include([origin[0] + s * tangent[0], origin[1] + s * tangent[1]]);
        }
        if let Some(arc) = path.arc_before(edge) {
            let radius = path.corners[edge].radius;
            let convex = path.corners[edge].turn < 0.0;
            let [first, last] = if convex {
                [arc.to, arc.from]
            } else {
                [arc.from, arc.to]
            };
            // The arc lies in the triangle of its ends and the corner it replaces.
            block.include(path.points[edge]);
            for [ux, uy] in [first, last] {
                block.include([arc.centre[0] + radius * ux, arc.centre[1] + radius * uy]);
            }
            let sign = if convex { 1.0 } else { -1.0 };
            self.arcs.push(FilletArc {
                centre: arc.centre,
                first,
                last,
                radius,
                sign,
            });
        }
        block.segments.end = edge + 1;
        block.arcs.end = self.arcs.len();
        self.segments.push(Segment {
            origin,
            tangent,
            start,
            end,
        });
        self.joints.push(joints);
    }

    #[inline]
    fn nearest(&self, x: f64, y: f64) -> Nearest {
        let mut best = f64::INFINITY;
        let mut nearest = Nearest::Segment(0);
        let single = self.blocks.len() == 1;
        for block in &self.blocks {
            if !single && block.distance_squared(x, y) >= best {
                continue;
            }
            for (offset, segment) in self.segments[block.segments.clone()].iter().enumerate() {
                let (beyond, across) = segment.beyond_and_across(x, y);
                let squared = beyond * beyond + across * across;
                if squared < best {
                    best = squared;
                    nearest = Nearest::Segment(block.segments.start + offset);
                }
            }
            for (offset, arc) in self.arcs[block.arcs.clone()].iter().enumerate() {
                let [vx, vy] = [x - arc.centre[0], y - arc.centre[1]];
                if arc.faces(vx, vy) {
                    let distance = (vx * vx + vy * vy).sqrt() - arc.radius;
                    if distance * distance < best {
                        best = distance * distance;
                        nearest = Nearest::Arc(block.arcs.start + offset);
                    }
                }
            }
        }
        nearest
    }

    /// Signed distance and normal.
    #[inline]
    pub(crate) fn gap(&self, point: &Vec3) -> Gap {
        let (x, y) = (point.x, point.y);
        match self.nearest(x, y) {
            Nearest::Segment(index) => {
                let segment = &self.segments[index];
                let (beyond, _) = segment.beyond_and_across(x, y);
                if beyond == 0.0 {
                    return segment.line_gap(x, y);
                }
                match self.joints[index][usize::from(beyond > 0.0)] {
                    // The foot is a smooth point: the point is on its normal, up to rounding.
                    Joint::Smooth => segment.line_gap(x, y),
                    Joint::Convex { vertex, bisector } => {
                        self.vertex_gap([x - vertex[0], y - vertex[1]], bisector, 1.0)
                    }
                    Joint::Reentrant { vertex, bisector } => {
                        self.vertex_gap([x - vertex[0], y - vertex[1]], bisector, -1.0)
                    }
                }
            }
            Nearest::Arc(index) => {
                let FilletArc {
                    centre,
                    first,
                    last,
                    radius,
                    sign,
                } = self.arcs[index];
                let [vx, vy] = [x - centre[0], y - centre[1]];
                let length = (vx * vx + vy * vy).sqrt();
                let (ux, uy) = if length > 0.0 {
                    (vx / length, vy / length)
                } else {
                    // The centre is as far from every point of the arc: take its middle.
                    let [mx, my] = [first[0] + last[0], first[1] + last[1]];
                    let norm = mx.hypot(my);
                    (mx / norm, my / norm)
                };
                let distance = sign * (length - radius);
                Gap {
                    distance,
                    normal: Vec3::new(sign * ux, sign * uy, 0.0),
                }
            }
        }
    }

    /// Gap to a sharp corner from the points for which it is nearest: they are all on the free
    /// side of a convex corner (`sign` +1) and all in the wall behind a reentrant one (−1).
    fn vertex_gap(&self, [rx, ry]: [f64; 2], bisector: [f64; 2], sign: f64) -> Gap {
        let distance = rx.hypot(ry);
        let [nx, ny] = if distance > self.rounding {
            [sign * rx / distance, sign * ry / distance]
        } else {
            bisector
        };
        Gap {
            distance: sign * distance,
            normal: Vec3::new(nx, ny, 0.0),
        }
    }

    /// The lines of the two edges of a sharp corner that points into the wall, if the point is
    /// nearest to one of them; the point touches both when it is in the corner.
    ///
    /// For a point on the free side both distances are at least that of [`Chain::gap`].
    pub(crate) fn corner_faces(&self, point: &Vec3) -> Option<[Gap; 2]> {
        if !self.reentrant {
            return None;
        }
        let (x, y) = (point.x, point.y);
        let Nearest::Segment(index) = self.nearest(x, y) else {
            return None;
        };
        let count = self.segments.len();
        let (beyond, _) = self.segments[index].beyond_and_across(x, y);
        let mut corner: Option<(f64, usize)> = None;
        for (end, joint) in self.joints[index].iter().enumerate() {
            let Joint::Reentrant { vertex, .. } = joint else {
                continue;
            };
            // Nearest to the other end: not in this corner.
            if (end == 0 && beyond > 0.0) || (end == 1 && beyond < 0.0) {
                continue;
            }
            let neighbour = if end == 0 {
                index + count - 1
            } else {
                index + 1
            } % count;
            // Beyond the far end of the neighbour its line means nothing.
            let (past, _) = self.segments[neighbour].beyond_and_across(x, y);
            if (end == 0 && past < 0.0) || (end == 1 && past > 0.0) {
                continue;
            }
            let distance = (x - vertex[0]).hypot(y - vertex[1]);
            if corner.is_none_or(|(least, _)| distance < least) {
                corner = Some((distance, neighbour));
            }
        }
        let (_, neighbour) = corner?;
        Some([
            self.segments[index].line_gap(x, y),
            self.segments[neighbour].line_gap(x, y),
        ])
    }

    /// The drawn polyline and, for an open chain, the directions in which its ends extend.
    pub(crate) fn drawing(&self) -> (&[[f64; 2]], Option<[[f64; 2]; 2]>) {
        let [fx, fy] = self.segments[0].tangent;
        let last = self.segments[self.segments.len() - 1].tangent;
        (&self.polyline, (!self.closed).then_some([[-fx, -fy], last]))
    }

    /// Refuses a chain that has no two sides.
    fn check_crossings(&self, largest: f64) -> Result<(), ContactError> {
        let mut line = self.polyline.clone();
        // Arcs that meet in the middle of an edge do so up to rounding.
        let near = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-12 * largest;
        line.dedup_by(|a, b| near(a, b));
        if self.closed {
            let last = line.len() - 1;
            line[last] = line[0];
        }
        if !self.closed {
            // Rays that meet farther out than this are parallel for any particle.
            let reach = 1e3 * largest;
            let (_, directions) = self.drawing();
            let [before, after] = directions.unwrap_or_default();
            let (first, last) = (line[0], line[line.len() - 1]);
            line.insert(
                0,
                [first[0] + reach * before[0], first[1] + reach * before[1]],
            );
            line.push([last[0] + reach * after[0], last[1] + reach * after[1]]);
        }
        let pieces = line.len() - 1;
        for i in 0..pieces {
            // The next piece shares a point; so do the last and the first of a closed chain.
            let end = if self.closed && i == 0 {
                pieces - 1
            } else {
                pieces
            };
            for j in i + 2..end {
                let (a, b) = ([line[i], line[i + 1]], [line[j], line[j + 1]]);
                if touch(a, b) {
                    let [x, y] = crossing(a, b);
                    return Err(ContactError::CrossesItself { x, y });
                }
            }
        }
        Ok(())
    }
}

fn joint(path: &Path, index: usize) -> Joint {
    let corner = &path.corners[index];
    if corner.radius > 0.0 || corner.turn.abs() < SMOOTH_TURN {
        return Joint::Smooth;
    }
    let before = path.tangents[(index + path.edges() - 1) % path.edges()];
    let after = path.tangents[index];
    let [sx, sy] = [before[0] + after[0], before[1] + after[1]];
    let norm = sx.hypot(sy);
    let bisector = [-sy / norm, sx / norm];
    let vertex = path.points[index];
    if corner.turn < 0.0 {
        Joint::Convex { vertex, bisector }
    } else {
        Joint::Reentrant { vertex, bisector }
    }
}

/// Twice the signed area of the triangle a, b, c.
fn area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Whether two segments have a point in common.
fn touch([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let overlap = |axis: usize| {
        a[axis].min(b[axis]) <= c[axis].max(d[axis]) && c[axis].min(d[axis]) <= a[axis].max(b[axis])
    };
    overlap(0)
        && overlap(1)
        && area(a, b, c) * area(a, b, d) <= 0.0
        && area(c, d, a) * area(c, d, b) <= 0.0
}

/// Where two segments that touch do so; for collinear ones an end of the second.
fn crossing([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> [f64; 2] {
    let (at_c, at_d) = (area(a, b, c), area(a, b, d));
    let part = if at_c == at_d {
        0.0
    } else {
        at_c / (at_c - at_d)
    };
    [c[0] + part * (d[0] - c[0]), c[1] + part * (d[1] - c[1])]
}

#[cfg(test)]
mod tests;
