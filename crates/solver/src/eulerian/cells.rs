//! Neighbours of moving points by a cell list, in buffers that are used again.

use jstsph_tensor::Vec3;

/// Points sorted into cubic cells as wide as the search radius, and the neighbours found with them.
///
/// A kd-tree has to be built anew in every step and searched in random order; sorting into cells is
/// linear and its memory stays. Cells are hashed into as many buckets as there are points, so that a
/// body may spread without limit.
#[derive(Clone, Debug)]
pub(super) struct CellList {
    radius: f64,
    dimension: usize,
    /// First entry of every bucket in `sorted`.
    starts: Vec<u32>,
    sorted: Vec<u32>,
    offsets: Vec<usize>,
    neighbours: Vec<u32>,
    row: Vec<u32>,
}

impl CellList {
    pub(super) fn new(radius: f64, dimension: usize) -> Self {
        Self {
            radius,
            dimension,
            starts: Vec::new(),
            sorted: Vec::new(),
            offsets: Vec::new(),
            neighbours: Vec::new(),
            row: Vec::new(),
        }
    }

    /// Offset of the first neighbour of a point, and its neighbours in ascending order.
    pub(super) fn row(&self, point: usize) -> (usize, &[u32]) {
        let range = self.offsets[point]..self.offsets[point + 1];
        (range.start, &self.neighbours[range])
    }

    fn cell(&self, x: &Vec3) -> [i64; 3] {
        [x.x, x.y, x.z].map(|c| (c / self.radius).floor() as i64)
    }

    fn bucket(&self, cell: [i64; 3], buckets: usize) -> usize {
        let [i, j, k] = cell.map(|c| c as u64);
        let hash =
            i.wrapping_mul(73_856_093) ^ j.wrapping_mul(19_349_663) ^ k.wrapping_mul(83_492_791);
        (hash % buckets as u64) as usize
    }

    /// Finds all neighbours closer than the radius.
    pub(super) fn rebuild(&mut self, positions: &[Vec3]) {
        let buckets = positions.len().max(1);
        self.sort(positions, buckets);
        self.offsets.clear();
        self.offsets.push(0);
        self.neighbours.clear();
        let layers = if self.dimension == 2 { 0..=0 } else { -1..=1 };
        let reach = self.radius * self.radius;
        for (a, x) in positions.iter().enumerate() {
            let [i, j, k] = self.cell(x);
            self.row.clear();
            for dk in layers.clone() {
                for dj in -1..=1 {
                    for di in -1..=1 {
                        let cell = [i + di, j + dj, k + dk];
                        let bucket = self.bucket(cell, buckets);
                        let range = self.starts[bucket]..self.starts[bucket + 1];
                        for &b in &self.sorted[range.start as usize..range.end as usize] {
                            let y = &positions[b as usize];
                            // Different cells may share a bucket: each point counts in its own.
                            if b as usize != a
                                && (y - x).norm_squared() < reach
                                && self.cell(y) == cell
                            {
                                self.row.push(b);
                            }
                        }
                    }
                }
            }
            self.row.sort_unstable();
            self.neighbours.extend_from_slice(&self.row);
            self.offsets.push(self.neighbours.len());
        }
    }

    /// Counting sort of the points by bucket.
    fn sort(&mut self, positions: &[Vec3], buckets: usize) {
        self.starts.clear();
        self.starts.resize(buckets + 2, 0);
        for x in positions {
            let bucket = self.bucket(self.cell(x), buckets);
            self.starts[bucket + 2] += 1;
        }
        for bucket in 2..self.starts.len() {
            self.starts[bucket] += self.starts[bucket - 1];
        }
        self.sorted.clear();
        self.sorted.resize(positions.len(), 0);
        for (a, x) in positions.iter().enumerate() {
            let bucket = self.bucket(self.cell(x), buckets);
            let place = &mut self.starts[bucket + 1];
            self.sorted[*place as usize] = a as u32;
            *place += 1;
        }
        self.starts.pop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    fn check(positions: &[Vec3], list: &CellList, radius: f64) {
        for (a, x) in positions.iter().enumerate() {
            let expected: Vec<u32> = (0..positions.len() as u32)
                .filter(|b| *b as usize != a && (positions[*b as usize] - x).norm() < radius)
                .collect();
            assert_eq!(list.row(a).1, expected, "particle {a}");
        }
    }

    #[test]
    fn finds_what_comparing_all_pairs_finds() {
        let mut random = Random(5);
        for dimension in [2, 3] {
            let mut list = CellList::new(0.3, dimension);
            for scale in [0.4, 1.0, 5.0] {
                let positions: Vec<Vec3> = (0..300)
                    .map(|_| {
                        let mut x = random.vector() * scale;
                        if dimension == 2 {
                            x.z = 0.0;
                        }
                        x
                    })
                    .collect();
                // The same buffers again, for bodies of another extent.
                list.rebuild(&positions);
                check(&positions, &list, 0.3);
            }
        }
    }
}
