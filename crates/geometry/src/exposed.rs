//! Faces and boundary of a body carved out of a lattice.

use jstsph_tensor::Vec3;

use crate::Dimension;
use crate::carved::{Lattice, triples};
use crate::chords::section_area;
use crate::face::{Face, FaceArea, FaceKind};
use crate::grid::Grid;

/// Sampling points per lattice square and direction on a face of the bounding box.
const SAMPLES: usize = 8;

/// How far below a face of the bounding box its section is taken, in spacings.
const BELOW: f64 = 1e-3;

/// Whether each node lies on the boundary: one of the cells around it is not in the body. Contains
/// the nodes of re-entrant edges, which have all their neighbours.
pub(crate) fn boundary(lattice: &Lattice<'_>, grid: &Grid, is_cell: &[bool]) -> Vec<bool> {
    let axes = lattice.dimension.count();
    let is_inner = |point: [usize; 3]| {
        (0..1_usize << axes).all(|corner| {
            let mut cell = point;
            for (axis, place) in cell.iter_mut().enumerate().take(axes) {
                match place.checked_sub((corner >> axis) & 1) {
                    Some(lower) if lower + 1 < lattice.counts[axis] => *place = lower,
                    _ => return false,
                }
            }
            is_cell[lattice.flat(cell)]
        })
    };
    grid.points()
        .iter()
        .map(|&point| !is_inner(point))
        .collect()
}

/// The faces of the bounding box and all that faces one way.
pub(crate) fn faces(
    lattice: &Lattice<'_>,
    grid: &Grid,
    is_cell: &[bool],
    positions: &[Vec3],
) -> Vec<Face> {
    let mut nodes = vec![u32::MAX; lattice.counts.iter().product()];
    for (node, &point) in grid.points().iter().enumerate() {
        nodes[lattice.flat(point)] = node as u32;
    }
    let names = lattice.shape.faces(lattice.dimension);
    names
        .iter()
        .map(|&name| {
            let side = name.strip_prefix("facing_").unwrap_or(name);
            let (axis, is_upper) = match (side, lattice.dimension) {
                ("left", _) => (0, false),
                ("right", _) => (0, true),
                ("front", _) | ("bottom", Dimension::PlaneStrain) => (1, false),
                ("back", _) | ("top", Dimension::PlaneStrain) => (1, true),
                ("bottom", Dimension::Solid) => (2, false),
                _ => (2, true),
            };
            let side = Side {
                lattice,
                nodes: &nodes,
                positions,
                axis,
                is_upper,
            };
            let areas = if name.starts_with("facing_") {
                side.facing(is_cell)
            } else {
                side.outermost()
            };
            Face {
                name,
                kind: FaceKind::Surface(side.parts(&areas)),
            }
        })
        .collect()
}

/// A direction along an axis.
struct Side<'a> {
    lattice: &'a Lattice<'a>,
    /// Node of each lattice point, if it has one.
    nodes: &'a [u32],
    /// Positions of the nodes, m.
    positions: &'a [Vec3],
    axis: usize,
    is_upper: bool,
}

impl Side<'_> {
    fn normal(&self) -> Vec3 {
        let mut normal = Vec3::zeros();
        normal[self.axis] = if self.is_upper { 1.0 } else { -1.0 };
        normal
    }

    /// Area of a lattice square (of a segment times 1 m in plane strain), m².
    fn square(&self) -> f64 {
        let steps = self.lattice.steps;
        (0..3)
            .filter(|&i| i != self.axis)
            .map(|i| steps[i])
            .product()
    }

    /// Nodes with an area or on the outermost plane, ascending.
    fn parts(&self, areas: &[Option<f64>]) -> Vec<FaceArea> {
        let mut parts: Vec<FaceArea> = areas
            .iter()
            .zip(self.nodes)
            .filter_map(|(area, &node)| {
                area.filter(|_| node != u32::MAX).map(|area| FaceArea {
                    node,
                    area,
                    normal: self.normal(),
                    point: self.positions[node as usize],
                })
            })
            .collect();
        parts.sort_by_key(|part| part.node);
        parts
    }

    /// Every side of a cell behind which there is no cell, shared among its corners.
    fn facing(&self, is_cell: &[bool]) -> Vec<Option<f64>> {
        let lattice = self.lattice;
        let mut areas = vec![None; self.nodes.len()];
        let level = usize::from(self.is_upper);
        let step = if self.is_upper { 1 } else { -1 };
        let [nx, ny, nz] = lattice.cell_counts();
        for (i, j, k) in triples(nx, ny, nz) {
            let cell = [i, j, k];
            let is_cell = |cell: [usize; 3]| is_cell[lattice.flat(cell)];
            let is_covered = lattice.moved(cell, self.axis, step).is_some_and(is_cell);
            if !is_cell(cell) || is_covered {
                continue;
            }
            let corners: Vec<[usize; 3]> = lattice
                .corners(cell)
                .into_iter()
                .filter(|corner| corner[self.axis] == cell[self.axis] + level)
                .collect();
            for &corner in &corners {
                *areas[lattice.flat(corner)].get_or_insert(0.0) +=
                    self.square() / corners.len() as f64;
            }
        }
        areas
    }

    /// The section of the shape on the outermost plane; every node there belongs to it.
    fn outermost(&self) -> Vec<Option<f64>> {
        let lattice = self.lattice;
        let axes = lattice.dimension.count();
        let level = if self.is_upper {
            lattice.counts[self.axis] - 1
        } else {
            0
        };
        let mut counts = lattice.cell_counts();
        counts[self.axis] = 1;
        let across: Vec<usize> = (0..axes).filter(|&axis| axis != self.axis).collect();
        let (mut areas, mut clipped) = (vec![None; self.nodes.len()], Vec::new());
        let mut full_area = 0.0;
        for (i, j, k) in triples(counts[0], counts[1], counts[2]) {
            let mut first = [i, j, k];
            first[self.axis] = level;
            let all: Vec<[usize; 3]> = (0..1_usize << across.len())
                .map(|corner| {
                    let mut point = first;
                    for (bit, &axis) in across.iter().enumerate() {
                        point[axis] += (corner >> bit) & 1;
                    }
                    point
                })
                .collect();
            let is_node = |point: &&[usize; 3]| self.nodes[lattice.flat(**point)] != u32::MAX;
            let corners: Vec<[usize; 3]> = all.iter().filter(is_node).copied().collect();
            for &corner in &corners {
                areas[lattice.flat(corner)].get_or_insert(0.0);
            }
            let parts = self.sample(first, &across, &corners);
            let covered: f64 = parts.iter().map(|(_, area)| area).sum();
            if covered >= (1.0 - 1e-9) * self.square() && corners.len() == all.len() {
                full_area += self.square();
                for (at, area) in parts {
                    *areas[at].get_or_insert(0.0) += area;
                }
            } else {
                clipped.extend(parts);
            }
        }
        // Full squares are exact; what was sampled makes up the rest.
        let x = lattice.place(std::array::from_fn(
            |i| if i == self.axis { level } else { 0 },
        ));
        let below = (x - BELOW * lattice.steps[self.axis] * self.normal())[self.axis];
        let exact = section_area(lattice.shape, lattice.dimension, self.axis, below);
        let sampled: f64 = clipped.iter().map(|(_, area)| area).sum();
        for (at, area) in clipped {
            *areas[at].get_or_insert(0.0) += area * ((exact - full_area) / sampled).max(0.0);
        }
        areas
    }

    /// Parts of a square that lie in the shape, each point given to the nearest of the nodes at
    /// its corners: places of the nodes and areas.
    fn sample(
        &self,
        first: [usize; 3],
        across: &[usize],
        corners: &[[usize; 3]],
    ) -> Vec<(usize, f64)> {
        let lattice = self.lattice;
        let origin = lattice.place(first) - BELOW * lattice.steps[self.axis] * self.normal();
        let points = SAMPLES.pow(across.len() as u32);
        let mut counts = vec![0.0_f64; corners.len()];
        for sample in 0..points {
            let mut x = origin;
            for (number, &axis) in across.iter().enumerate() {
                let s = (sample / SAMPLES.pow(number as u32)) % SAMPLES;
                x[axis] += (2 * s + 1) as f64 / (2 * SAMPLES) as f64 * lattice.steps[axis];
            }
            if !lattice.contains(&x) {
                continue;
            }
            let square = |corner: &[usize; 3]| (lattice.place(*corner) - x).norm_squared();
            let nearest = (0..corners.len())
                .min_by(|&a, &b| square(&corners[a]).total_cmp(&square(&corners[b])));
            if let Some(nearest) = nearest {
                counts[nearest] += 1.0;
            }
        }
        let places = corners.iter().map(|&corner| lattice.flat(corner));
        places
            .zip(counts)
            .map(|(at, count)| (at, self.square() * count / points as f64))
            .filter(|(_, area)| *area > 0.0)
            .collect()
    }
}
