//! B and its transpose for many points or particles at once: eight parts of every line of particles side
//! by side, so that the values which eight equal stencils need stand next to each other.

use std::cmp::Reverse;
use std::collections::HashMap;
use std::ops::Range;

use jstsph_tensor::Vec3;

use crate::gradient::GradientOperator;
use crate::rows::Rows;

mod passes;
#[cfg(test)]
mod tests;

/// Lanes: parts that a line is cut into.
const WIDTH: usize = 8;

/// Items of a piece of work, about.
const ITEMS_OF_PIECE: usize = 256;

/// Coordinates are the same when they differ by less than about this fraction of the spacing.
const TOLERANCE: f64 = 1e-3;

/// What a block of eight costs, and what it costs to bring an item into its lane and back, if a row by
/// itself costs one.
const COST_OF_BLOCK: f64 = 2.0;
const COST_OF_LANE: f64 = 0.15;

/// Fraction of the cost of single rows below which lines are worth it.
const WORTHWHILE: f64 = 0.7;

/// A slot without an item.
const EMPTY: u32 = u32::MAX;

/// A number for each part of a line, for each of N components: what vector loads want.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct LaneRow<const N: usize>(pub [[f64; WIDTH]; N]);

impl<const N: usize> LaneRow<N> {
    /// All zero.
    pub const ZERO: Self = Self([[0.0; WIDTH]; N]);

    /// What is at a slot of [`Lines::slots`], one of those that are not alone.
    ///
    /// # Panics
    /// If there is no such slot: a bug in the caller.
    #[inline]
    #[must_use]
    pub fn at(rows: &[Self], slot: u32) -> [f64; N] {
        let (row, lane) = (&rows[slot as usize / WIDTH], slot as usize % WIDTH);
        std::array::from_fn(|k| row.0[k][lane])
    }
}

/// A [`GradientOperator`] of a lattice, or of another body with lines of evenly spaced particles, on
/// vectors.
///
/// Every line along an axis is cut into eight parts of the same length, which stand side by side: a
/// [`LaneRow`] holds the components of the first particle of each part, the next one those of the second, and
/// so on. Away from the ends of the line the stencils of the eight are the same, moved on by whole parts, so that
/// eight sums are made at once by loads of whole aligned rows and without a gather. A few rows before and
/// after each line repeat the neighbouring parts. Points and particles whose stencils are others, at the ends
/// of lines for example, are *alone*: their sums are left to [`GradientOperator`].
///
/// Every sum has the terms of the row in their order, and so the bits of
/// [`GradientOperator::scaled_gradients`] and [`GradientOperator::divergences`].
#[derive(Clone, Debug)]
pub struct LineOperator {
    points: Side,
    particles: Side,
}

/// Points or particles in their lines, and the sums that go to them.
#[derive(Clone, Debug)]
struct Side {
    parts: Parts,
    lines: usize,
    /// The item in each slot: line by line, row by row, lane by lane; without the repeated rows.
    items: Vec<u32>,
    /// Row and lane, as `8 row + lane` with the repeated rows counted, of the items that have a sum here.
    slots: Vec<u32>,
    /// The sums of each row of slots; empty where no item has one.
    sums: Rows<[f64; 3]>,
    lines_of_piece: usize,
}

/// How lines are cut.
#[derive(Clone, Copy, Debug)]
struct Parts {
    /// Rows of a part.
    length: usize,
    /// Rows before and after it that repeat its neighbours.
    repeated: usize,
}

impl Parts {
    fn rows_of_line(self) -> usize {
        self.length + 2 * self.repeated
    }
}

/// Where items are: line and level along it.
#[derive(Clone, Debug)]
struct Places {
    line: Vec<u32>,
    level: Vec<u32>,
    lines: usize,
}

/// The evenly spaced levels of particles along an axis.
#[derive(Clone, Copy, Debug)]
struct Levels {
    axis: usize,
    first: f64,
    spacing: f64,
    count: usize,
}

impl LineOperator {
    /// In place of a slot: the item has no sum in the lines.
    pub const ALONE: u32 = u32::MAX;

    /// The operator between particles at `positions` and points at `points`, along the axis with the longest
    /// lines that is worth it; nothing where none is. `spacing` is the distance of neighbours.
    ///
    /// # Panics
    /// If there are not as many positions as particles or points.
    #[must_use]
    pub fn new(
        operator: &GradientOperator,
        positions: &[Vec3],
        points: &[Vec3],
        spacing: f64,
    ) -> Option<Self> {
        assert_eq!(positions.len(), operator.particles(), "one position each");
        assert_eq!(points.len(), operator.points(), "one position each");
        let items = (positions.len() + points.len()) as f64;
        let axes = 0..if operator.plane { 2 } else { 3 };
        let mut levels: Vec<Levels> = axes
            .filter_map(|axis| Levels::new(positions, spacing, axis))
            .collect();
        levels.sort_by_key(|levels| Reverse(levels.count));
        levels.into_iter().find_map(|levels| {
            Self::along(operator, levels, [positions, points], spacing)
                .filter(|lines| lines.points.cost() + lines.particles.cost() < WORTHWHILE * items)
        })
    }

    fn along(
        operator: &GradientOperator,
        levels: Levels,
        [positions, points]: [&[Vec3]; 2],
        spacing: f64,
    ) -> Option<Self> {
        let particles = levels.places(positions, spacing);
        let points = levels.places(points, spacing);
        let reach = |q: usize| {
            let entries = operator.rows.row(q).indices();
            let distances = entries.map(|c| points.level[q].abs_diff(particles.level[c]));
            distances.max().unwrap_or(0)
        };
        let repeated = (0..operator.points()).map(reach).max()? as usize;
        let length = levels.count.div_ceil(WIDTH);
        // What is repeated must be that of the next part alone.
        if length < repeated {
            return None;
        }
        let parts = Parts { length, repeated };
        Some(Self {
            points: Side::new(parts, &operator.rows, operator.scale, [&points, &particles]),
            particles: Side::new(
                parts,
                &operator.columns,
                operator.scale,
                [&particles, &points],
            ),
        })
    }

    /// The evaluation points.
    #[must_use]
    pub fn points(&self) -> Lines<'_> {
        Lines(&self.points)
    }

    /// The particles.
    #[must_use]
    pub fn particles(&self) -> Lines<'_> {
        Lines(&self.particles)
    }
}

impl Levels {
    /// The levels of bodies that have some: evenly spaced, and enough for all lanes.
    fn new(positions: &[Vec3], spacing: f64, axis: usize) -> Option<Self> {
        let mut coordinates: Vec<f64> = positions.iter().map(|x| x[axis]).collect();
        coordinates.sort_by(f64::total_cmp);
        coordinates.dedup_by(|a, b| (*a - *b).abs() < TOLERANCE * spacing);
        let (first, last) = (*coordinates.first()?, *coordinates.last()?);
        let count = coordinates.len();
        if count < 2 * WIDTH {
            return None;
        }
        let levels = Self {
            axis,
            first,
            spacing: (last - first) / (count - 1) as f64,
            count,
        };
        let even = |(k, x): (usize, &f64)| (levels.level(*x) - k as f64).abs() < 10.0 * TOLERANCE;
        coordinates.iter().enumerate().all(even).then_some(levels)
    }

    fn level(&self, coordinate: f64) -> f64 {
        (coordinate - self.first) / self.spacing
    }

    /// Lines in the order of their first items; items between two levels have lines of their own, and
    /// the lower level.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "levels and cells of a body"
    )]
    fn places(&self, positions: &[Vec3], spacing: f64) -> Places {
        let (u, v) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let quantum = TOLERANCE * spacing;
        let mut known: HashMap<[i64; 3], u32> = HashMap::new();
        let (mut line, mut level) = (Vec::new(), Vec::new());
        for x in positions {
            let place = self.level(x[self.axis]);
            let lower = (place + 0.25).floor();
            let key = [
                (x[u] / quantum).round() as i64,
                (x[v] / quantum).round() as i64,
                ((place - lower) / (100.0 * TOLERANCE)).round() as i64,
            ];
            let next = known.len() as u32;
            line.push(*known.entry(key).or_insert(next));
            level.push(lower.clamp(0.0, (self.count - 1) as f64) as u32);
        }
        Places {
            line,
            level,
            lines: known.len(),
        }
    }
}

impl Side {
    /// The sums that go to items at `own` from what is at `others`, by their rows.
    #[expect(clippy::cast_possible_truncation, reason = "fewer slots than u32::MAX")]
    fn new(parts: Parts, rows: &Rows<[f64; 3]>, scale: f64, [own, others]: [&Places; 2]) -> Self {
        let Parts { length, repeated } = parts;
        let mut items = vec![EMPTY; own.lines * length * WIDTH];
        for (item, (&line, &level)) in own.line.iter().zip(&own.level).enumerate() {
            let (lane, row) = (level as usize / length, level as usize % length);
            items[(line as usize * length + row) * WIDTH + lane] = item as u32;
        }
        // The row in which an entry of an item stands; all lanes of a sum must agree on it.
        let row_of = |item: usize, entry: usize| {
            let row = (repeated + own.level[item] as usize % length) as u32;
            let line = others.line[entry] * parts.rows_of_line() as u32;
            line + row + others.level[entry] - own.level[item]
        };
        let agree = |one: usize, other: usize| {
            rows.weights_of(one) == rows.weights_of(other) && {
                let (a, b) = (rows.row(one).indices(), rows.row(other).indices());
                a.zip(b).all(|(a, b)| row_of(one, a) == row_of(other, b))
            }
        };
        let mut slots = vec![LineOperator::ALONE; own.line.len()];
        let blocks = own.lines * length;
        // In the order of the entries that the single rows have: the sums then have the same bits.
        let sums = Rows::build(blocks, scale, |block, entries| {
            let lanes = &items[block * WIDTH..][..WIDTH];
            // The stencil of the middle of the line.
            let from_the_middle = [4, 3, 5, 2, 6, 1, 7, 0];
            let chosen = from_the_middle.map(|lane| lanes[lane]);
            let Some(&chosen) = chosen.iter().find(|item| **item != EMPTY) else {
                return;
            };
            let chosen = chosen as usize;
            let mut together = 0;
            let row = block / length * parts.rows_of_line() + repeated + block % length;
            for (lane, &item) in lanes.iter().enumerate() {
                if item != EMPTY && agree(chosen, item as usize) {
                    slots[item as usize] = (row * WIDTH + lane) as u32;
                    together += 1;
                }
            }
            if together as f64 > COST_OF_BLOCK {
                let row = rows.row(chosen);
                entries.extend(row.entries().map(|(c, w)| (row_of(chosen, c), *w)));
            } else {
                for &item in lanes.iter().filter(|item| **item != EMPTY) {
                    slots[item as usize] = LineOperator::ALONE;
                }
            }
        });
        Self {
            parts,
            lines: own.lines,
            items,
            slots,
            sums,
            lines_of_piece: ITEMS_OF_PIECE.div_ceil(length * WIDTH),
        }
    }

    /// In units of single rows.
    fn cost(&self) -> f64 {
        let blocks = (0..self.sums.len()).filter(|b| !self.sums.row(*b).is_empty());
        let alone = self.slots.iter().filter(|s| **s == LineOperator::ALONE);
        let lanes = self.lines * self.parts.length * WIDTH;
        COST_OF_BLOCK * blocks.count() as f64 + alone.count() as f64 + COST_OF_LANE * lanes as f64
    }

    /// Lines of a piece.
    fn of_piece(&self, piece: usize) -> Range<usize> {
        let first = piece * self.lines_of_piece;
        first..(first + self.lines_of_piece).min(self.lines)
    }
}

/// The points or the particles of a [`LineOperator`] in their lines.
#[derive(Clone, Copy, Debug)]
pub struct Lines<'a>(&'a Side);

impl<'a> Lines<'a> {
    /// Rows of a field.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.0.lines * self.0.parts.rows_of_line()
    }

    /// Rows of a piece, all but the last.
    #[must_use]
    pub fn rows_of_piece(&self) -> usize {
        self.0.lines_of_piece * self.0.parts.rows_of_line()
    }

    /// Where the sum of each item stands, as 8 row + lane; [`LineOperator::ALONE`] for those that have none.
    #[must_use]
    pub fn slots(&self) -> &'a [u32] {
        &self.0.slots
    }
}
