//! Numbering of the nodes of a cubic lattice, some of whose points may be left out.

use crate::{Bonds, Cells, Dimension};

const ABSENT: u32 = u32::MAX;

/// The nodes of a body on a cubic lattice.
///
/// Nodes are numbered line by line: the axis with the fewest lattice points runs fastest and the
/// one with the most slowest (of equals, x runs fastest). Neighbours are then near in memory, and
/// away from the boundary equal stencils have equal index offsets.
pub(crate) struct Grid {
    counts: [usize; 3],
    strides: [usize; 3],
    node: Vec<u32>,
    points: Vec<[usize; 3]>,
    dimension: Dimension,
}

impl Grid {
    /// Numbers the points of a lattice of `counts` points for which `contains` holds.
    pub(crate) fn new(
        counts: [usize; 3],
        dimension: Dimension,
        contains: impl Fn([usize; 3]) -> bool,
    ) -> Self {
        let mut axes = [0, 1, 2];
        axes.sort_by_key(|&axis| (counts[axis], axis));
        let [fast, middle, slow] = axes;
        let mut strides = [0; 3];
        strides[fast] = 1;
        strides[middle] = counts[fast];
        strides[slow] = counts[fast] * counts[middle];
        let mut grid = Self {
            counts,
            strides,
            node: vec![ABSENT; counts.iter().product()],
            points: Vec::new(),
            dimension,
        };
        let mut point = [0; 3];
        for k in 0..counts[slow] {
            point[slow] = k;
            for j in 0..counts[middle] {
                point[middle] = j;
                for i in 0..counts[fast] {
                    point[fast] = i;
                    if contains(point) {
                        let flat = grid.flat(point);
                        grid.node[flat] = grid.points.len() as u32;
                        grid.points.push(point);
                    }
                }
            }
        }
        grid
    }

    /// Lattice points of the nodes, in their order.
    pub(crate) fn points(&self) -> &[[usize; 3]] {
        &self.points
    }

    fn flat(&self, point: [usize; 3]) -> usize {
        (0..3).map(|axis| point[axis] * self.strides[axis]).sum()
    }

    /// The node one step further along `axis`.
    fn next(&self, mut point: [usize; 3], axis: usize) -> Option<u32> {
        point[axis] += 1;
        if point[axis] == self.counts[axis] {
            return None;
        }
        let node = self.node[self.flat(point)];
        (node != ABSENT).then_some(node)
    }

    /// Bonds in the order of their lower node, then of the axes. `volume` gives the volume of the
    /// bond from a lattice point along an axis.
    pub(crate) fn bonds(&self, volume: impl Fn([usize; 3], usize) -> f64) -> Bonds {
        let axes = self.dimension.count();
        let (mut ends, mut directions, mut volumes) = (
            Vec::with_capacity(axes * self.points.len()),
            Vec::with_capacity(axes * self.points.len()),
            Vec::with_capacity(axes * self.points.len()),
        );
        for (node, &point) in self.points.iter().enumerate() {
            for axis in 0..axes {
                if let Some(other) = self.next(point, axis) {
                    ends.push([node as u32, other]);
                    directions.push(axis as u8);
                    volumes.push(volume(point, axis));
                }
            }
        }
        Bonds {
            ends: ends.into(),
            directions,
            volumes: volumes.into(),
        }
    }

    /// Cells all of whose corners are nodes, in the order of their lowest corner.
    pub(crate) fn cells(&self) -> Cells {
        match self.dimension {
            Dimension::PlaneStrain => Cells::Quads(
                self.points
                    .iter()
                    .filter_map(|&point| self.quad(point))
                    .collect(),
            ),
            Dimension::Solid => Cells::Hexes(
                self.points
                    .iter()
                    .filter_map(|&point| {
                        let mut above = point;
                        above[2] += 1;
                        if above[2] == self.counts[2] {
                            return None;
                        }
                        let ([a, b, c, d], [e, f, g, h]) = (self.quad(point)?, self.quad(above)?);
                        Some([a, b, c, d, e, f, g, h])
                    })
                    .collect(),
            ),
        }
    }

    /// Corners of the square above `point` in the xy plane, counter-clockwise.
    fn quad(&self, point: [usize; 3]) -> Option<[u32; 4]> {
        let [i, j, k] = point;
        let first = self.node[self.flat(point)];
        if first == ABSENT {
            return None;
        }
        let second = self.next(point, 0)?;
        let third = self.next([i + 1, j, k], 1)?;
        Some([first, second, third, self.next(point, 1)?])
    }

    /// Whether each node lacks a lattice neighbour.
    pub(crate) fn boundary(&self) -> Vec<bool> {
        let mut neighbours = vec![0_u8; self.points.len()];
        for (node, &point) in self.points.iter().enumerate() {
            for axis in 0..self.dimension.count() {
                if let Some(other) = self.next(point, axis) {
                    neighbours[node] += 1;
                    neighbours[other as usize] += 1;
                }
            }
        }
        let all = 2 * self.dimension.count() as u8;
        neighbours.into_iter().map(|count| count < all).collect()
    }
}

/// Position of point `index` of `count` equally spaced ones: exact at both ends, and symmetric
/// about the middle when the ends are.
pub(crate) fn between(low: f64, high: f64, index: usize, count: usize) -> f64 {
    let last = count - 1;
    if index == 0 {
        low
    } else if index == last {
        high
    } else {
        (low * (last - index) as f64 + high * index as f64) / last as f64
    }
}

/// Share of an interval that belongs to point `index` of `count`: half at the ends.
pub(crate) fn share(index: usize, count: usize) -> f64 {
    if index == 0 || index + 1 == count {
        0.5
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_axis_runs_slowest() {
        let grid = Grid::new([4, 2, 3], Dimension::Solid, |_| true);
        assert_eq!(
            grid.points()[..4],
            [[0, 0, 0], [0, 1, 0], [0, 0, 1], [0, 1, 1]]
        );
        assert_eq!(grid.points()[6], [1, 0, 0]);
        assert_eq!(grid.points().len(), 24);
    }

    #[test]
    fn a_missing_corner_removes_cells_and_bonds() {
        let whole = Grid::new([3, 3, 1], Dimension::PlaneStrain, |_| true);
        let cut = Grid::new([3, 3, 1], Dimension::PlaneStrain, |p| p != [2, 2, 0]);
        let bonds = |grid: &Grid| grid.bonds(|_, _| 0.0).ends.len();
        assert_eq!((bonds(&whole), bonds(&cut)), (12, 10));
        assert_eq!((whole.cells().len(), cut.cells().len()), (4, 3));
        assert_eq!(whole.boundary().iter().filter(|&&b| !b).count(), 1);
    }

    #[test]
    fn interpolated_ends_are_exact_and_points_symmetric() {
        assert_eq!(between(0.1, 0.7, 49, 50), 0.7);
        for i in 0..50 {
            assert_eq!(between(-0.3, 0.3, i, 50), -between(-0.3, 0.3, 49 - i, 50));
        }
    }
}
