//! Sparse rows that share what is equal: their weights, and where their entries lie relative to the
//! first of them.
//!
//! On a lattice all inner points of one kind have the same stencil. A row is sixteen bytes: its first
//! index, and the places of its steps from there and of its weights in two lists that hold equal runs
//! once, so that the stencils of the inner points stay in the first cache levels.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Two weights are taken as equal when they differ by less than this fraction of the largest one:
/// four orders above the round-off of the moment matrices, eight below any effect on a result.
const SHARING_TOLERANCE: f64 = 1e-11;

/// Entries that a transposition sorts at once, about: what it holds beside its result.
const TRANSPOSED_AT_ONCE: usize = 1 << 22;

/// A weight: one number or a vector.
pub(crate) trait Weight: Copy + PartialEq + std::fmt::Debug {
    const COMPONENTS: usize;
    fn component(&self, i: usize) -> f64;
}

impl Weight for f64 {
    const COMPONENTS: usize = 1;
    fn component(&self, _: usize) -> f64 {
        *self
    }
}

impl Weight for [f64; 3] {
    const COMPONENTS: usize = 3;
    fn component(&self, i: usize) -> f64 {
        self[i]
    }
}

/// Rows of (index, weight) entries; indices are ascending within a row where its maker lists them so.
#[derive(Clone, Debug)]
pub(crate) struct Rows<W> {
    places: Vec<Place>,
    steps: Vec<u32>,
    weights: Vec<W>,
    entries: usize,
}

/// Where a row is.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// Its lowest index.
    first: u32,
    length: u32,
    /// Where its runs of steps and weights begin.
    steps: u32,
    weights: u32,
}

/// One row: the entries (index, weight) of a point or particle, indices ascending.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<'a, W> {
    /// The lowest index.
    pub first: usize,
    /// What is added to it to get each index; starts with zero.
    pub steps: &'a [u32],
    /// The weights.
    pub weights: &'a [W],
}

impl<'a, W> Row<'a, W> {
    /// Number of entries.
    #[must_use]
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Whether it has no entry.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// The indices, ascending.
    #[inline]
    pub fn indices(&self) -> impl ExactSizeIterator<Item = usize> + Clone + use<'a, W> {
        let first = self.first;
        self.steps.iter().map(move |step| first + *step as usize)
    }

    /// Indices and weights.
    #[inline]
    pub fn entries(&self) -> impl ExactSizeIterator<Item = (usize, &'a W)> + Clone + use<'a, W> {
        self.indices().zip(self.weights)
    }
}

/// Runs of values in one list, in which equal ones are found again.
struct Shared<T> {
    list: Vec<T>,
    /// Start and length of the runs by the hash of their key.
    known: HashMap<u64, (u32, u32)>,
}

impl<T: Copy> Shared<T> {
    fn new() -> Self {
        Self {
            list: Vec::new(),
            known: HashMap::new(),
        }
    }

    /// Start of the run with this key, which is that of `run`; `is_equal` guards against other keys with
    /// the same hash.
    fn place(&mut self, key: &impl Hash, run: &[T], is_equal: impl FnOnce(&[T]) -> bool) -> u32 {
        let mut hasher = DefaultHasher::new();
        key.hash(&mut hasher);
        let hash = hasher.finish();
        if let Some(&(start, length)) = self.known.get(&hash) {
            let (start_at, length) = (start as usize, length as usize);
            if length == run.len() && is_equal(&self.list[start_at..start_at + length]) {
                return start;
            }
        }
        let start = self.list.len() as u32;
        self.list.extend_from_slice(run);
        self.known.entry(hash).or_insert((start, run.len() as u32));
        start
    }
}

impl<W: Weight> Rows<W> {
    /// Builds the rows one after another, in the order of the rows, sharing what is equal.
    /// `scale` is the largest weight, to which the sharing tolerance is relative.
    pub(crate) fn build(
        rows: usize,
        scale: f64,
        mut row: impl FnMut(usize, &mut Vec<(u32, W)>),
    ) -> Self {
        let quantum = SHARING_TOLERANCE * scale;
        let (mut all_steps, mut all_weights) = (Shared::new(), Shared::new());
        let mut places = Vec::with_capacity(rows);
        let (mut entries, mut entry_count) = (Vec::new(), 0);
        let (mut steps, mut weights): (Vec<u32>, Vec<W>) = (Vec::new(), Vec::new());
        let mut key: Vec<i64> = Vec::new();
        for i in 0..rows {
            entries.clear();
            row(i, &mut entries);
            entry_count += entries.len();
            let first = entries.iter().map(|(index, _)| *index).min().unwrap_or(0);
            steps.clear();
            steps.extend(entries.iter().map(|(index, _)| index - first));
            let steps_at = all_steps.place(&steps, &steps, |run| run == steps);
            weights.clear();
            weights.extend(entries.iter().map(|(_, weight)| *weight));
            key.clear();
            key.extend(weights.iter().flat_map(|weight| {
                (0..W::COMPONENTS).map(|c| (weight.component(c) / quantum).round() as i64)
            }));
            let weights_at = all_weights.place(&key, &weights, |run| {
                run.iter().zip(&weights).all(|(one, other)| {
                    (0..W::COMPONENTS)
                        .all(|c| (one.component(c) - other.component(c)).abs() <= 2.0 * quantum)
                })
            });
            places.push(Place {
                first,
                length: entries.len() as u32,
                steps: steps_at,
                weights: weights_at,
            });
        }
        let (mut steps, mut weights) = (all_steps.list, all_weights.list);
        steps.shrink_to_fit();
        weights.shrink_to_fit();
        Self {
            places,
            steps,
            weights,
            entries: entry_count,
        }
    }

    /// The transposed rows, one per index below `columns`.
    pub(crate) fn transposed(&self, columns: usize, scale: f64) -> Self {
        let mut block = Block::default();
        let size = columns * TRANSPOSED_AT_ONCE / self.entries.max(1);
        let size = size.clamp(1, columns.max(1));
        Self::build(columns, scale, |c, entries| {
            if c % size == 0 {
                block.fill(self, c, size.min(columns - c));
            }
            entries.extend(
                block
                    .column(c)
                    .iter()
                    .map(|&(i, w)| (i, self.weights[w as usize])),
            );
        })
    }

    /// What rows with the same weights have in common: where these are, and how many.
    pub(crate) fn weights_of(&self, i: usize) -> (u32, u32) {
        (self.places[i].weights, self.places[i].length)
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.places.len()
    }

    /// Number of entries of all rows.
    pub(crate) fn entry_count(&self) -> usize {
        self.entries
    }

    /// Number of stored weights: far below `entry_count` on a lattice.
    pub(crate) fn stored_weights(&self) -> usize {
        self.weights.len()
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.places[..])
            + size_of_val(&self.steps[..])
            + size_of_val(&self.weights[..])
    }

    /// One row.
    #[inline(always)]
    pub(crate) fn row(&self, i: usize) -> Row<'_, W> {
        let place = self.places[i];
        let length = place.length as usize;
        let (steps, weights) = (place.steps as usize, place.weights as usize);
        Row {
            first: place.first as usize,
            steps: &self.steps[steps..steps + length],
            weights: &self.weights[weights..weights + length],
        }
    }
}

/// Some columns of a matrix given by rows.
#[derive(Default)]
struct Block {
    first: usize,
    /// Start of each column in `sources`, and the end of the last.
    starts: Vec<usize>,
    /// Row of each entry, and where its weight is.
    sources: Vec<(u32, u32)>,
}

impl Block {
    /// Gathers `count` columns from `first` on.
    fn fill<W: Weight>(&mut self, rows: &Rows<W>, first: usize, count: usize) {
        self.first = first;
        let is_near = |place: &Place| {
            let (low, length) = (place.first as usize, place.length as usize);
            let last = (length > 0).then(|| rows.steps[place.steps as usize + length - 1]);
            last.is_some_and(|last| low < first + count && low + last as usize >= first)
        };
        let entries = || {
            rows.places
                .iter()
                .enumerate()
                .filter(|(_, place)| is_near(place))
                .flat_map(|(i, place)| {
                    let indices = rows.row(i).indices().zip(place.weights..);
                    indices.map(move |(c, weight)| (c.wrapping_sub(first), i as u32, weight))
                })
                .filter(|(c, ..)| *c < count)
        };
        self.starts.clear();
        self.starts.resize(count + 2, 0);
        for (c, ..) in entries() {
            self.starts[c + 2] += 1;
        }
        for c in 0..count {
            self.starts[c + 2] += self.starts[c + 1];
        }
        // Until it is filled, the start of a column stands one place further on.
        self.sources.clear();
        self.sources.resize(self.starts[count + 1], (0, 0));
        for (c, row, weight) in entries() {
            let slot = &mut self.starts[c + 1];
            self.sources[*slot] = (row, weight);
            *slot += 1;
        }
    }

    fn column(&self, c: usize) -> &[(u32, u32)] {
        let c = c - self.first;
        &self.sources[self.starts[c]..self.starts[c + 1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed<W: Weight>(row: Row<'_, W>) -> Vec<(usize, W)> {
        row.entries()
            .map(|(index, weight)| (index, *weight))
            .collect()
    }

    #[test]
    fn equal_rows_share_their_weights_and_transposition_keeps_every_entry() {
        let rows = Rows::<f64>::build(4, 2.0, |i, entries| {
            entries.push((i as u32, 2.0));
            entries.push((
                i as u32 + 1,
                if i == 3 { 0.5 } else { 1.0 + 1e-14 * i as f64 },
            ));
        });
        assert_eq!(rows.entry_count(), 8);
        assert_eq!(rows.stored_weights(), 4);
        // One run of steps, 0 and 1, serves all rows.
        assert_eq!(rows.bytes(), 4 * 16 + 2 * 4 + 4 * 8);
        let transposed = rows.transposed(5, 2.0);
        assert_eq!(transposed.len(), 5);
        assert_eq!(listed(transposed.row(0)), [(0, 2.0)]);
        assert_eq!(listed(transposed.row(2)), [(1, 1.0), (2, 2.0)]);
        assert_eq!(listed(transposed.row(4)), [(3, 0.5)]);
    }

    #[test]
    fn rows_that_differ_keep_their_own_weights() {
        let rows = Rows::<[f64; 3]>::build(2, 1.0, |i, entries| {
            entries.push((0, [1.0, 0.0, 1e-9 * i as f64]));
        });
        assert_eq!(rows.row(0).weights[0][2], 0.0);
        assert_eq!(rows.row(1).weights[0][2], 1e-9);
    }

    #[test]
    fn columns_gathered_in_blocks_are_those_of_all_rows() {
        // Rows that jump about, one of them empty.
        let index = |i: usize, k: usize| (i * 7 + k * k * 3) % 31;
        let rows = Rows::<f64>::build(40, 1.0, |i, entries| {
            let mut indices: Vec<usize> = (0..i % 5).map(|k| index(i, k)).collect();
            indices.sort_unstable();
            indices.dedup();
            entries.extend(indices.iter().map(|&c| (c as u32, (i * 100 + c) as f64)));
        });
        let mut block = Block::default();
        for size in [1, 4, 31] {
            for first in (0..31).step_by(size) {
                let count = size.min(31 - first);
                block.fill(&rows, first, count);
                for c in first..first + count {
                    let expected: Vec<usize> = (0..40)
                        .filter(|&i| rows.row(i).indices().any(|index| index == c))
                        .collect();
                    let found = block.column(c);
                    let sources: Vec<usize> = found.iter().map(|(i, _)| *i as usize).collect();
                    assert_eq!(sources, expected, "column {c}, blocks of {size}");
                    for &(i, w) in found {
                        assert_eq!(rows.weights[w as usize], (i as usize * 100 + c) as f64);
                    }
                }
            }
        }
    }
}
