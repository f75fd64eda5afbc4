//! From points and fillet radii to straight edges joined by tangent arcs.

use crate::ContactError;

/// The side of a chain on which particles may be, seen along the direction of its points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The left side: inside a closed chain that runs anticlockwise.
    Left,
    /// The right side: outside a closed chain that runs anticlockwise.
    Right,
}

/// Two edges that meet at less than this angle (rad) leave no room between them, and their
/// normals no direction in which to push: they double back.
const SMALLEST_CORNER: f64 = 1e-3;

/// Part of an edge length that rounding may take from two fillets which fill it exactly.
const LENGTH_ROUNDING: f64 = 1e-12;

/// A corner: the edges before and after it, and its fillet.
pub(crate) struct Corner {
    /// The angle by which the chain turns to the left, rad, in (−π, π).
    pub(crate) turn: f64,
    /// Fillet radius, m; zero if there is no arc.
    pub(crate) radius: f64,
    /// How much of either edge the fillet takes, m.
    pub(crate) cut: f64,
}

/// A chain cleaned up: the free side is on the left, every length is checked.
pub(crate) struct Path {
    /// Points, m.
    pub(crate) points: Vec<[f64; 2]>,
    /// Unit direction of the edge that starts at each point; a closed path has as many edges as
    /// points, an open one less.
    pub(crate) tangents: Vec<[f64; 2]>,
    /// Length of each edge, m, at least the cuts at its ends.
    pub(crate) lengths: Vec<f64>,
    /// One per point; the ends of an open path have neither turn nor radius.
    pub(crate) corners: Vec<Corner>,
    /// The last point is joined to the first.
    pub(crate) closed: bool,
}

impl Path {
    /// Checks points and fillets and orients the chain. Arguments and errors as
    /// [`Chain::new`](crate::Chain::new).
    pub(crate) fn new(
        points: &[[f64; 2]],
        fillets: &[f64],
        closed: bool,
        free_side: Side,
    ) -> Result<Self, ContactError> {
        check_input(points, fillets, closed)?;
        let count = points.len();
        let mut points = points.to_vec();
        let mut fillets = fillets.to_vec();
        // Walking the other way round exchanges the sides; errors still count as the user does.
        let reversed = free_side == Side::Right;
        if reversed {
            points.reverse();
            fillets.reverse();
        }
        let given = |index: usize| if reversed { count - 1 - index } else { index };

        let edges = if closed { count } else { count - 1 };
        let mut tangents = Vec::with_capacity(edges);
        let mut lengths = Vec::with_capacity(edges);
        for edge in 0..edges {
            let [from, to] = [points[edge], points[(edge + 1) % count]];
            let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
            let length = dx.hypot(dy);
            // Subtraction of distinct points is exact or close to it, but a direction needs digits.
            let scale = from.iter().chain(&to).fold(0.0_f64, |m, c| m.max(c.abs()));
            if length <= 1e3 * f64::EPSILON * scale {
                let first = if reversed { (edge + 1) % count } else { edge };
                let [x, y] = points[first];
                let index = given(first);
                return Err(ContactError::CoincidentPoints { index, x, y });
            }
            tangents.push([dx / length, dy / length]);
            lengths.push(length);
        }

        let mut corners = Vec::with_capacity(count);
        for index in 0..count {
            if !closed && (index == 0 || index == count - 1) {
                corners.push(Corner {
                    turn: 0.0,
                    radius: 0.0,
                    cut: 0.0,
                });
                continue;
            }
            let before = tangents[(index + edges - 1) % edges];
            let after = tangents[index];
            let turn = f64::atan2(
                before[0] * after[1] - before[1] * after[0],
                before[0] * after[0] + before[1] * after[1],
            );
            if turn.abs() > std::f64::consts::PI - SMALLEST_CORNER {
                let [x, y] = points[index];
                let index = given(index);
                return Err(ContactError::DoublesBack { index, x, y });
            }
            // A fillet on a straight line is that line.
            let radius = if turn == 0.0 { 0.0 } else { fillets[index] };
            let cut = radius * (0.5 * turn.abs()).tan();
            corners.push(Corner { turn, radius, cut });
        }

        for edge in 0..edges {
            let next = (edge + 1) % count;
            let needed = corners[edge].cut + corners[next].cut;
            let available = lengths[edge];
            if needed > available * (1.0 + LENGTH_ROUNDING) {
                let index = given(if reversed { next } else { edge });
                return Err(ContactError::FilletTooLarge {
                    index,
                    needed,
                    available,
                });
            }
            lengths[edge] = available.max(needed);
        }
        Ok(Self {
            points,
            tangents,
            lengths,
            corners,
            closed,
        })
    }
}

fn check_input(points: &[[f64; 2]], fillets: &[f64], closed: bool) -> Result<(), ContactError> {
    let needed = if closed { 3 } else { 2 };
    let count = points.len();
    if count < needed {
        return Err(ContactError::TooFewPoints { count, needed });
    }
    if fillets.len() != count {
        return Err(ContactError::FilletCount {
            fillets: fillets.len(),
            points: count,
        });
    }
    for &value in points.iter().flatten() {
        if !value.is_finite() {
            return Err(ContactError::NotFinite {
                what: "a coordinate of a chain",
                value,
            });
        }
    }
    for (index, &radius) in fillets.iter().enumerate() {
        if !radius.is_finite() {
            return Err(ContactError::NotFinite {
                what: "a fillet radius",
                value: radius,
            });
        }
        if radius < 0.0 {
            return Err(ContactError::NegativeFillet { index, radius });
        }
        if radius > 0.0 && !closed && (index == 0 || index == count - 1) {
            return Err(ContactError::EndFillet { index, radius });
        }
    }
    Ok(())
}

/// The arc at a corner of a path.
pub(crate) struct Arc {
    /// Its centre, m.
    pub(crate) centre: [f64; 2],
    /// Unit vector from the centre to where the arc begins.
    pub(crate) from: [f64; 2],
    /// Unit vector from the centre to where the arc ends.
    pub(crate) to: [f64; 2],
}

impl Path {
    /// Number of edges.
    pub(crate) fn edges(&self) -> usize {
        self.tangents.len()
    }

    /// Where the straight part of an edge begins and how long it is (zero if fillets take all).
    pub(crate) fn straight(&self, edge: usize) -> ([f64; 2], f64) {
        let next = (edge + 1) % self.points.len();
        let [x, y] = self.points[edge];
        let [tx, ty] = self.tangents[edge];
        let cut = self.corners[edge].cut;
        let length = self.lengths[edge] - cut - self.corners[next].cut;
        ([x + cut * tx, y + cut * ty], length.max(0.0))
    }

    /// The arc of the corner at which an edge begins, if that corner is rounded.
    pub(crate) fn arc_before(&self, edge: usize) -> Option<Arc> {
        let corner = &self.corners[edge];
        if corner.radius == 0.0 {
            return None;
        }
        let before = self.tangents[(edge + self.edges() - 1) % self.edges()];
        let after = self.tangents[edge];
        // The centre lies on the side to which the chain turns.
        let side = corner.turn.signum();
        let outward = |[tx, ty]: [f64; 2]| [side * ty, -side * tx];
        let [px, py] = self.points[edge];
        let from = outward(before);
        let centre = [
            px - corner.cut * before[0] - corner.radius * from[0],
            py - corner.cut * before[1] - corner.radius * from[1],
        ];
        Some(Arc {
            centre,
            from,
            to: outward(after),
        })
    }

    /// The chain as a polyline, arcs cut into pieces of at most `step` rad, without the extension
    /// of an open chain. A closed chain ends with its first point.
    pub(crate) fn polyline(&self, step: f64) -> Vec<[f64; 2]> {
        let mut line = Vec::with_capacity(self.points.len() + 1);
        let arc_points = |edge: usize, line: &mut Vec<[f64; 2]>| {
            let Some(arc) = self.arc_before(edge) else {
                line.push(self.points[edge]);
                return;
            };
            let Corner { turn, radius, .. } = self.corners[edge];
            let pieces = (turn.abs() / step).ceil().max(1.0);
            for piece in 0..=pieces as usize {
                let (sin, cos) = (turn * piece as f64 / pieces).sin_cos();
                let [fx, fy] = arc.from;
                line.push([
                    arc.centre[0] + radius * (cos * fx - sin * fy),
                    arc.centre[1] + radius * (sin * fx + cos * fy),
                ]);
            }
        };
        for edge in 0..self.edges() {
            arc_points(edge, &mut line);
        }
        if self.closed {
            line.push(line[0]);
        } else {
            line.push(self.points[self.points.len() - 1]);
        }
        line
    }
}
