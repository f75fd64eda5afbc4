//! Sparse rows whose weights are shared between rows that are equal.
//!
//! On a lattice all inner points of one kind have the same stencil. Rows store an index per entry
//! and refer to a weight list; equal lists are stored once, so that the weights of the inner
//! points stay in the first cache level and only four bytes per entry stream from memory.

use std::collections::HashMap;

/// Two weights are taken as equal when they differ by less than this fraction of the largest one:
/// four orders above the round-off of the moment matrices, eight below any effect on a result.
const SHARING_TOLERANCE: f64 = 1e-11;

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

/// Rows of (index, weight) entries, indices ascending within a row.
#[derive(Clone, Debug)]
pub(crate) struct Rows<W> {
    offsets: Vec<u32>,
    indices: Vec<u32>,
    weight_starts: Vec<u32>,
    weights: Vec<W>,
}

impl<W: Weight> Rows<W> {
    /// Builds the rows one after another, in the order of the rows, sharing equal weight lists.
    /// `scale` is the largest weight, to which the sharing tolerance is relative.
    pub(crate) fn build(
        rows: usize,
        scale: f64,
        mut row: impl FnMut(usize, &mut Vec<(u32, W)>),
    ) -> Self {
        let mut result = Self {
            offsets: Vec::with_capacity(rows + 1),
            indices: Vec::new(),
            weight_starts: Vec::with_capacity(rows),
            weights: Vec::new(),
        };
        result.offsets.push(0);
        let quantum = SHARING_TOLERANCE * scale;
        let mut known: HashMap<Vec<i64>, u32> = HashMap::new();
        let (mut entries, mut key) = (Vec::new(), Vec::new());
        for i in 0..rows {
            entries.clear();
            row(i, &mut entries);
            key.clear();
            for (index, weight) in &entries {
                result.indices.push(*index);
                key.extend(
                    (0..W::COMPONENTS).map(|c| (weight.component(c) / quantum).round() as i64),
                );
            }
            let start = match known.get(&key) {
                Some(start) => *start,
                None => {
                    let start = result.weights.len() as u32;
                    result
                        .weights
                        .extend(entries.iter().map(|(_, weight)| *weight));
                    known.insert(key.clone(), start);
                    start
                }
            };
            result.weight_starts.push(start);
            result.offsets.push(result.indices.len() as u32);
        }
        result.weights.shrink_to_fit();
        result.indices.shrink_to_fit();
        result
    }

    /// The transposed rows, one per index below `columns`.
    pub(crate) fn transposed(&self, columns: usize, scale: f64) -> Self {
        let mut lists: Vec<u32> = vec![0; columns + 1];
        for &index in &self.indices {
            lists[index as usize + 1] += 1;
        }
        for c in 0..columns {
            lists[c + 1] += lists[c];
        }
        let mut next = lists.clone();
        let mut sources = vec![(0u32, 0u32); self.indices.len()];
        for i in 0..self.len() {
            let start = self.offsets[i] as usize;
            for (k, &index) in self.indices[start..self.offsets[i + 1] as usize]
                .iter()
                .enumerate()
            {
                let slot = &mut next[index as usize];
                sources[*slot as usize] = (i as u32, self.weight_starts[i] + k as u32);
                *slot += 1;
            }
        }
        Self::build(columns, scale, |c, entries| {
            entries.extend(
                sources[lists[c] as usize..lists[c + 1] as usize]
                    .iter()
                    .map(|&(i, w)| (i, self.weights[w as usize])),
            );
        })
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.weight_starts.len()
    }

    /// Number of entries of all rows.
    pub(crate) fn entry_count(&self) -> usize {
        self.indices.len()
    }

    /// Number of stored weights: far below `entry_count` on a lattice.
    pub(crate) fn stored_weights(&self) -> usize {
        self.weights.len()
    }

    /// Indices and weights of one row.
    #[inline(always)]
    pub(crate) fn row(&self, i: usize) -> (&[u32], &[W]) {
        let (start, end) = (self.offsets[i] as usize, self.offsets[i + 1] as usize);
        let weights = self.weight_starts[i] as usize;
        (
            &self.indices[start..end],
            &self.weights[weights..weights + (end - start)],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let transposed = rows.transposed(5, 2.0);
        assert_eq!(transposed.len(), 5);
        assert_eq!(transposed.row(0), (&[0u32][..], &[2.0][..]));
        assert_eq!(transposed.row(2), (&[1u32, 2][..], &[1.0, 2.0][..]));
        assert_eq!(transposed.row(4), (&[3u32][..], &[0.5][..]));
    }

    #[test]
    fn rows_that_differ_keep_their_own_weights() {
        let rows = Rows::<[f64; 3]>::build(2, 1.0, |i, entries| {
            entries.push((0, [1.0, 0.0, 1e-9 * i as f64]));
        });
        assert_eq!(rows.row(0).1[0][2], 0.0);
        assert_eq!(rows.row(1).1[0][2], 1e-9);
    }
}
