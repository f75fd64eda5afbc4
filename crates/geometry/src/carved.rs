//! Any shape carved out of the cubic lattice of its bounding box.
//!
//! The lattice points in the shape are the nodes. A cell that lies in the shape with all its edges
//! gives each edge an equal part of its volume; what the shape leaves of any other cell is sampled
//! along lines, each piece goes to the nearest bond, and all of these are scaled so that the total
//! is the volume of the shape.

use std::sync::Arc;

use jstsph_tensor::Vec3;

use crate::body::{Body, Bonds};
use crate::chords::{chords, contains};
use crate::exposed;
use crate::grid::{Grid, between};
use crate::surface::carved_surface;
use crate::{Cells, Dimension, GeometryError, Shape};

/// How far outside a lattice point may lie and still be a node, in spacings: above the rounding of
/// coordinates that were given with single precision.
const TOLERANCE: f64 = 1e-4;

/// Sampling lines per cell and direction.
pub(crate) const SAMPLES: [usize; 2] = [32, 8];

/// Part of a cell by which a full one may fall short because of rounding.
const FULL: f64 = 1e-9;

/// Largest accepted part of the volume that is too far from every bond, percent.
const LOST_PERCENT: f64 = 2.0;

/// The lattice and what of it lies in the shape.
pub(crate) struct Lattice<'a> {
    pub(crate) shape: &'a Shape,
    pub(crate) dimension: Dimension,
    low: Vec3,
    high: Vec3,
    /// Points along each axis.
    pub(crate) counts: [usize; 3],
    /// Distances of the points, m; 1 m thickness in plane strain.
    pub(crate) steps: [f64; 3],
    /// How far outside a place may lie and still count as inside, m.
    tolerance: f64,
    /// Whether the bond from a point along an axis exists: both ends and the middle are inside.
    bonds: [Vec<bool>; 3],
    /// Whether a point has a bond.
    is_node: Vec<bool>,
}

/// Builds the body; counts are at least 2 along each axis that the dimension has.
pub(crate) fn build(
    shape: Shape,
    counts: [usize; 3],
    dimension: Dimension,
) -> Result<Body, GeometryError> {
    let lattice = Lattice::new(&shape, counts, dimension);
    let spacing = lattice.spacing();
    let cell: f64 = lattice.steps.iter().product();
    let volumes = lattice.bond_volumes(cell)?;
    let has_volume = |point: [usize; 3]| {
        let ends = (0..dimension.count()).flat_map(|axis| {
            let upper = Some(volumes[axis][lattice.flat(point)]);
            let lower = lattice
                .moved(point, axis, -1)
                .map(|below| volumes[axis][lattice.flat(below)]);
            [upper, lower]
        });
        ends.flatten().any(|volume| volume > 0.0)
    };
    let grid = Grid::new(counts, dimension, |point| {
        lattice.is_node[lattice.flat(point)] && has_volume(point)
    });
    let positions: Vec<Vec3> = grid
        .points()
        .iter()
        .map(|&point| lattice.place(point))
        .collect();
    let bonds = grid.bonds(|point, axis| volumes[axis][lattice.flat(point)]);
    let bonds = with_volume(&bonds);
    let node_volumes = crate::clipped::node_volumes(&bonds, positions.len());
    let cells = match grid.cells() {
        Cells::Quads(all) => Cells::Quads(lattice.inside(all, &positions)),
        Cells::Hexes(all) => Cells::Hexes(lattice.inside(all, &positions)),
    };
    let is_cell = lattice.full_cells(&grid);
    let boundary = exposed::boundary(&lattice, &grid, &is_cell);
    let faces = exposed::faces(&lattice, &grid, &is_cell, &positions);
    let surface = Some(carved_surface(&lattice, &grid, &positions));
    Ok(Body {
        dimension,
        volumes: node_volumes,
        weights: vec![cell; positions.len()],
        spacing,
        support_spacing: spacing,
        bonds,
        cells,
        boundary,
        surface,
        faces,
        positions: positions.into(),
        shape,
    })
}

/// The bonds that have a volume; between two faces of a slot there is none.
fn with_volume(bonds: &Bonds) -> Bonds {
    let kept: Vec<usize> = (0..bonds.ends.len())
        .filter(|&bond| bonds.volumes[bond] > 0.0)
        .collect();
    Bonds {
        ends: Arc::new(kept.iter().map(|&bond| bonds.ends[bond]).collect()),
        directions: kept.iter().map(|&bond| bonds.directions[bond]).collect(),
        volumes: Arc::new(kept.iter().map(|&bond| bonds.volumes[bond]).collect()),
    }
}

impl<'a> Lattice<'a> {
    fn new(shape: &'a Shape, counts: [usize; 3], dimension: Dimension) -> Self {
        let axes = dimension.count();
        let (low, high) = shape.bounds();
        let steps: [f64; 3] = std::array::from_fn(|i| {
            if i < axes {
                (high[i] - low[i]) / (counts[i] - 1) as f64
            } else {
                1.0
            }
        });
        let points = counts.iter().product();
        let mut lattice = Self {
            shape,
            dimension,
            low,
            high,
            counts,
            steps,
            tolerance: 0.0,
            bonds: [const { Vec::new() }; 3],
            is_node: vec![false; points],
        };
        lattice.tolerance = TOLERANCE * lattice.spacing();
        let is_inside: Vec<bool> = lattice
            .points()
            .map(|point| lattice.contains(&lattice.place(point)))
            .collect();
        for axis in 0..axes {
            let mut exists = vec![false; points];
            for point in lattice.points() {
                let Some(next) = lattice.moved(point, axis, 1) else {
                    continue;
                };
                let (from, to) = (lattice.flat(point), lattice.flat(next));
                let middle = || 0.5 * (lattice.place(point) + lattice.place(next));
                if is_inside[from] && is_inside[to] && lattice.contains(&middle()) {
                    exists[from] = true;
                    lattice.is_node[from] = true;
                    lattice.is_node[to] = true;
                }
            }
            lattice.bonds[axis] = exists;
        }
        lattice
    }

    /// Smallest distance of two points, m.
    pub(crate) fn spacing(&self) -> f64 {
        let steps = self.steps[..self.dimension.count()].iter().copied();
        steps.fold(f64::INFINITY, f64::min)
    }

    pub(crate) fn contains(&self, x: &Vec3) -> bool {
        contains(self.shape, x, self.tolerance)
    }

    fn points(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [nx, ny, nz] = self.counts;
        (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
    }

    pub(crate) fn flat(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.counts[1] + j) * self.counts[0] + i
    }

    /// The point some steps further along an axis, if there is one.
    pub(crate) fn moved(
        &self,
        mut point: [usize; 3],
        axis: usize,
        steps: isize,
    ) -> Option<[usize; 3]> {
        point[axis] = point[axis].checked_add_signed(steps)?;
        (point[axis] < self.counts[axis]).then_some(point)
    }

    /// Position of a point; exact on the bounding box.
    pub(crate) fn place(&self, point: [usize; 3]) -> Vec3 {
        Vec3::from_fn(|i, _| {
            if i < self.dimension.count() {
                between(self.low[i], self.high[i], point[i], self.counts[i])
            } else {
                0.0
            }
        })
    }

    /// Number of cells along each axis.
    pub(crate) fn cell_counts(&self) -> [usize; 3] {
        self.counts.map(|count| (count - 1).max(1))
    }

    /// Points at the corners of the cell above a point.
    pub(crate) fn corners(&self, cell: [usize; 3]) -> Vec<[usize; 3]> {
        let axes = self.dimension.count();
        (0..1_usize << axes)
            .map(|corner| std::array::from_fn(|axis| cell[axis] + ((corner >> axis) & 1)))
            .collect()
    }

    /// Whether each cell has all its corners and its middle in the body, in the order of
    /// [`Self::flat`] of their lowest corner.
    fn full_cells(&self, grid: &Grid) -> Vec<bool> {
        let mut is_node = vec![false; self.is_node.len()];
        for &point in grid.points() {
            is_node[self.flat(point)] = true;
        }
        let mut is_cell = vec![false; self.is_node.len()];
        let [nx, ny, nz] = self.cell_counts();
        for (i, j, k) in triples(nx, ny, nz) {
            let corners = self.corners([i, j, k]);
            let middle = corners.iter().map(|&c| self.place(c)).sum::<Vec3>();
            is_cell[self.flat([i, j, k])] = corners.iter().all(|&c| is_node[self.flat(c)])
                && self.contains(&(middle / corners.len() as f64));
        }
        is_cell
    }

    /// The cells whose middle is inside.
    fn inside<const N: usize>(&self, cells: Vec<[u32; N]>, positions: &[Vec3]) -> Vec<[u32; N]> {
        let middle = |cell: &[u32; N]| {
            let sum: Vec3 = cell.iter().map(|&node| positions[node as usize]).sum();
            sum / N as f64
        };
        let is_inside = |cell: &[u32; N]| self.contains(&middle(cell));
        cells.into_iter().filter(is_inside).collect()
    }

    /// Volumes of the bonds from each point along each axis.
    fn bond_volumes(&self, cell_volume: f64) -> Result<[Vec<f64>; 3], GeometryError> {
        let table = || [const { Vec::new() }; 3].map(|_: Vec<f64>| vec![0.0; self.is_node.len()]);
        let (mut full, mut clipped) = (table(), table());
        let (mut full_sum, mut clipped_sum, mut lost) = (0.0, 0.0, 0.0);
        let [nx, ny, nz] = self.cell_counts();
        let mut row: Vec<Vec<(Vec3, f64)>> = vec![Vec::new(); nx];
        for (k, j) in (0..nz).flat_map(|k| (0..ny).map(move |j| (k, j))) {
            self.sample_row(j, k, cell_volume, &mut row);
            for (i, samples) in row.iter_mut().enumerate() {
                let covered: f64 = samples.iter().map(|(_, volume)| volume).sum();
                let edges = self.edges([i, j, k]);
                if covered >= (1.0 - FULL) * cell_volume
                    && edges.iter().all(|&(axis, at)| self.bonds[axis][at])
                {
                    full_sum += cell_volume;
                    for &(axis, at) in &edges {
                        full[axis][at] += cell_volume / edges.len() as f64;
                    }
                } else if covered > 0.0 {
                    let shared = self.share([i, j, k], samples, &mut clipped);
                    clipped_sum += shared;
                    lost += covered - shared;
                }
                samples.clear();
            }
        }
        let volume = self.shape.volume(self.dimension);
        let lost_percent = 100.0 * lost / volume;
        if lost_percent > LOST_PERCENT || full_sum + clipped_sum == 0.0 {
            return Err(GeometryError::Unresolved {
                shape: self.shape.name(),
                lost_percent,
                limit_percent: LOST_PERCENT,
                spacing: self.spacing(),
            });
        }
        // Full cells are exact; what was sampled makes up the rest.
        let scale = if clipped_sum > 0.0 {
            (volume - full_sum) / clipped_sum
        } else {
            1.0
        };
        for (full, clipped) in full.iter_mut().zip(&clipped) {
            for (full, clipped) in full.iter_mut().zip(clipped) {
                *full += scale * clipped;
            }
        }
        Ok(full)
    }

    /// Axis and lower end of the edges of a cell.
    fn edges(&self, cell: [usize; 3]) -> Vec<(usize, usize)> {
        let axes = self.dimension.count();
        let corners = self.corners(cell);
        (0..axes)
            .flat_map(|axis| {
                let lower = corners.iter().filter(move |c| c[axis] == cell[axis]);
                lower.map(move |&c| (axis, c))
            })
            .map(|(axis, corner)| (axis, self.flat(corner)))
            .collect()
    }

    /// Pieces of the shape in the cells of one row along x: middle and volume.
    fn sample_row(&self, j: usize, k: usize, cell_volume: f64, row: &mut [Vec<(Vec3, f64)>]) {
        let samples = SAMPLES[self.dimension.count() - 2];
        let layers = match self.dimension {
            Dimension::PlaneStrain => 1,
            Dimension::Solid => samples,
        };
        let line_share = cell_volume / (samples * layers) as f64;
        let part = |s: usize, of: usize| (2 * s + 1) as f64 / (2 * of) as f64;
        let count = row.len() * samples;
        for (t, s) in (0..layers).flat_map(|t| (0..samples).map(move |s| (t, s))) {
            let y = self.low.y + (j as f64 + part(s, samples)) * self.steps[1];
            let z = match self.dimension {
                Dimension::PlaneStrain => 0.0,
                Dimension::Solid => self.low.z + (k as f64 + part(t, layers)) * self.steps[2],
            };
            for chord in chords(self.shape, y, z, self.dimension) {
                // In units of the pieces; rounding must not reach into the next one.
                let [from, to] = chord.map(|x| {
                    let place = (x - self.low.x) / self.steps[0] * samples as f64;
                    let near = place.round();
                    let place = if (place - near).abs() < 1e-9 * count as f64 {
                        near
                    } else {
                        place
                    };
                    place.clamp(0.0, count as f64)
                });
                for piece in from.floor() as usize..to.ceil() as usize {
                    let (start, end) = (from.max(piece as f64), to.min((piece + 1) as f64));
                    if start < end {
                        let middle = 0.5 * (start + end) / samples as f64;
                        let x = self.low.x + middle * self.steps[0];
                        let volume = line_share * (end - start) / samples as f64;
                        row[piece / samples].push((Vec3::new(x, y, z), volume));
                    }
                }
            }
        }
    }

    /// Gives samples of a cell to the nearest bonds, in equal parts if several are nearest, and
    /// returns how much found one.
    fn share(&self, cell: [usize; 3], samples: &[(Vec3, f64)], volumes: &mut [Vec<f64>; 3]) -> f64 {
        let candidates = self.candidates(cell);
        if candidates.is_empty() {
            return 0.0;
        }
        let tie = 1e-9 * self.spacing().powi(2);
        let mut shared = 0.0;
        for (x, volume) in samples {
            let squares = candidates
                .iter()
                .map(|(_, _, middle)| (middle - x).norm_squared());
            let nearest = squares.clone().fold(f64::INFINITY, f64::min);
            let is_nearest = |square: f64| square <= nearest + tie;
            let count = squares.clone().filter(|&square| is_nearest(square)).count();
            for ((axis, at, _), square) in candidates.iter().zip(squares) {
                if is_nearest(square) {
                    volumes[*axis][*at] += volume / count as f64;
                }
            }
            shared += volume;
        }
        shared
    }

    /// Bonds at this cell and its neighbours that can be the nearest to a place in it: axis, lower
    /// end, middle.
    fn candidates(&self, cell: [usize; 3]) -> Vec<(usize, usize, Vec3)> {
        let axes = self.dimension.count();
        let range = |axis: usize| {
            let last = if axis < axes { cell[axis] + 2 } else { 0 };
            cell[axis].saturating_sub(1)..=last.min(self.counts[axis] - 1)
        };
        let mut found = Vec::new();
        for k in range(2) {
            for j in range(1) {
                for i in range(0) {
                    let at = self.flat([i, j, k]);
                    for axis in 0..axes {
                        if self.bonds[axis][at] {
                            let mut middle = self.place([i, j, k]);
                            middle[axis] += 0.5 * self.steps[axis];
                            found.push((axis, at, middle));
                        }
                    }
                }
            }
        }
        let (low, mut high) = (self.place(cell), self.place(cell));
        for axis in 0..axes {
            high[axis] += self.steps[axis];
        }
        let nearest = |x: &Vec3| (low - x).sup(&(x - high)).sup(&Vec3::zeros()).norm();
        let farthest = |x: &Vec3| (x - low).abs().sup(&(x - high).abs()).norm();
        let bound = found
            .iter()
            .map(|(_, _, middle)| farthest(middle))
            .fold(f64::INFINITY, f64::min);
        found.retain(|(_, _, middle)| nearest(middle) <= bound);
        found
    }
}

/// All triples below three counts, the first fastest.
pub(crate) fn triples(
    nx: usize,
    ny: usize,
    nz: usize,
) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (i, j, k))))
}
