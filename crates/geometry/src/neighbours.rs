//! Neighbour lists within a radius.

use jstsph_tensor::Vec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};

/// Relative enlargement of the squared search radius. A lattice neighbour at exactly the radius is
/// otherwise found or missed by round-off (a few 1e-16), differently for mirror images.
const RADIUS_PADDING: f64 = 1e-9;

/// Rows of indices in compressed form: row i is `indices[offsets[i]..offsets[i + 1]]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Csr {
    /// Start of each row and the end of the last: one more entry than rows.
    pub offsets: Vec<usize>,
    /// The rows one after the other, each in ascending order.
    pub indices: Vec<u32>,
}

impl Csr {
    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Indices of row `i`, ascending.
    ///
    /// # Panics
    /// If there is no such row.
    #[inline]
    #[must_use]
    pub fn row(&self, i: usize) -> &[u32] {
        &self.indices[self.offsets[i]..self.offsets[i + 1]]
    }

    /// The lists the other way round: row c of the result holds, ascending, the rows that name c.
    ///
    /// # Panics
    /// If an index is not below `columns`.
    #[must_use]
    pub fn transposed(&self, columns: usize) -> Self {
        let mut offsets = vec![0; columns + 1];
        for &column in &self.indices {
            offsets[column as usize + 1] += 1;
        }
        for column in 0..columns {
            offsets[column + 1] += offsets[column];
        }
        let mut next = offsets.clone();
        let mut indices = vec![0; self.indices.len()];
        for row in 0..self.rows() {
            for &column in self.row(row) {
                let place = &mut next[column as usize];
                indices[*place] = row as u32;
                *place += 1;
            }
        }
        Self { offsets, indices }
    }
}

/// Neighbours of every position within `radius` (m), itself excluded.
///
/// All pairs with |x_a − x_b|² ≤ radius² (1 + 1e-9): pairs at exactly the radius are *included*,
/// whatever the round-off of their coordinates (a kernel of that support gives them zero weight).
/// Other particles at the same place are neighbours. Rows are ascending and the relation is
/// symmetric; the result depends on nothing but the arguments.
///
/// # Panics
/// If a coordinate is not finite, the radius is NaN or negative, or there are 2³² positions.
#[must_use]
pub fn neighbours(positions: &[Vec3], radius: f64) -> Csr {
    search(positions, positions, radius, |query, found| query != found)
}

/// Positions within `radius` (m) of every query point, coincident ones included; the boundary is
/// treated as in [`neighbours`]. Row q lists indices into `positions`.
///
/// # Panics
/// As [`neighbours`].
#[must_use]
pub fn neighbours_of(queries: &[Vec3], positions: &[Vec3], radius: f64) -> Csr {
    search(queries, positions, radius, |_, _| true)
}

/// Searches one after another in the same positions, for work that needs no list of all.
pub struct NeighbourSearch {
    points: Vec<[f64; 3]>,
    /// None without positions.
    tree: Option<ImmutableKdTree<f64, 3>>,
    squared_radius: f64,
}

impl NeighbourSearch {
    /// Prepares searches within `radius` (m) of anything, as in [`neighbours`].
    ///
    /// # Panics
    /// As [`neighbours`].
    #[must_use]
    pub fn new(positions: &[Vec3], radius: f64) -> Self {
        assert!(
            radius >= 0.0,
            "search radius is {radius} m, must not be negative"
        );
        assert_finite(positions);
        let points: Vec<[f64; 3]> = positions.iter().map(|x| (*x).into()).collect();
        // The only failure of an immutable tree is an index that does not fit 32 bits.
        let tree = (!points.is_empty()).then(|| {
            ImmutableKdTree::<f64, 3>::new_from_slice(&points).expect("fewer than 2^32 positions")
        });
        Self {
            points,
            tree,
            squared_radius: radius * radius * (1.0 + RADIUS_PADDING),
        }
    }

    /// Replaces `found` by the positions within the radius of a point, ascending.
    pub fn near(&self, point: &Vec3, found: &mut Vec<u32>) {
        found.clear();
        self.append((*point).into(), |_| true, found);
    }

    /// Replaces `found` by the positions within the radius of position `index`, without itself,
    /// ascending.
    ///
    /// # Panics
    /// If there is no such position.
    pub fn around(&self, index: usize, found: &mut Vec<u32>) {
        found.clear();
        self.append(self.points[index], |item| item as usize != index, found);
    }

    fn append(&self, point: [f64; 3], keep: impl Fn(u32) -> bool, found: &mut Vec<u32>) {
        let Some(tree) = &self.tree else { return };
        let start = found.len();
        tree.query(&point)
            .within::<SquaredEuclidean<f64>>(self.squared_radius)
            .unsorted()
            .visit(|neighbour| {
                if keep(neighbour.item) {
                    found.push(neighbour.item);
                }
            });
        found[start..].sort_unstable();
    }
}

fn assert_finite(positions: &[Vec3]) {
    for (i, x) in positions.iter().enumerate() {
        assert!(
            x.iter().all(|c| c.is_finite()),
            "position {i} of a neighbour search is not finite: ({}, {}, {})",
            x.x,
            x.y,
            x.z
        );
    }
}

fn search(
    queries: &[Vec3],
    positions: &[Vec3],
    radius: f64,
    keep: impl Fn(usize, usize) -> bool,
) -> Csr {
    let search = NeighbourSearch::new(positions, radius);
    assert_finite(queries);
    let mut csr = Csr {
        offsets: Vec::with_capacity(queries.len() + 1),
        indices: Vec::new(),
    };
    csr.offsets.push(0);
    for (query, x) in queries.iter().enumerate() {
        let keep = |item: u32| keep(query, item as usize);
        search.append((*x).into(), keep, &mut csr.indices);
        csr.offsets.push(csr.indices.len());
    }
    csr
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(n: usize) -> Vec<Vec3> {
        (0..n)
            .map(|i| Vec3::new(0.1 * i as f64, 0.0, 0.0))
            .collect()
    }

    #[test]
    fn neighbours_at_exactly_the_radius_are_included() {
        // 0.1 i differs from its neighbours' distances by round-off either way.
        let lists = neighbours(&line(100), 0.2);
        for i in 2..98 {
            let i32 = i as u32;
            assert_eq!(lists.row(i), [i32 - 2, i32 - 1, i32 + 1, i32 + 2]);
        }
    }

    #[test]
    fn rectangular_search_includes_coincident_points_and_can_be_transposed() {
        let queries = [
            Vec3::new(0.1, 0.0, 0.0),
            Vec3::new(0.35, 0.0, 0.0),
            Vec3::new(9.0, 0.0, 0.0),
        ];
        let lists = neighbours_of(&queries, &line(5), 0.06);
        assert_eq!(
            (lists.row(0), lists.row(1), lists.row(2)),
            (&[1][..], &[3, 4][..], &[][..])
        );
        let back = lists.transposed(5);
        assert_eq!(back.offsets, [0, 0, 1, 1, 2, 3]);
        assert_eq!(back.indices, [0, 1, 1]);
        assert_eq!(back.transposed(3), lists);
    }

    #[test]
    fn empty_sets_give_empty_rows() {
        assert_eq!(neighbours(&[], 1.0).rows(), 0);
        assert_eq!(neighbours_of(&line(2), &[], 1.0).offsets, [0, 0, 0]);
    }
}
