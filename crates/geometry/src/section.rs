//! The circular section of a disc or cylinder on a square lattice.
//!
//! All lengths here are in units of the lattice spacing; the circle has the whole number n as its
//! radius, its centre is a node, and nodes are the lattice points with i² + j² ≤ n².

use std::f64::consts::PI;

/// Samples per unit length when the part of a clipped cell inside the circle is measured. A power
/// of two: coordinates and distances are then exact, so that ties are seen as such and the result
/// has all mirror symmetries of the lattice.
const SAMPLES: i64 = 32;

/// How the area of the section is shared out among bonds.
///
/// A table is indexed by [`Section::index`] of the lower end of a bond.
pub(crate) struct Section {
    radius: i64,
    /// Plane strain: area of the bonds along the first and second direction. The sum is πn².
    pub(crate) planar: [Vec<f64>; 2],
    /// Slab of height 1 between two layers: volume that a bond in one of the two layers gets from
    /// this slab.
    pub(crate) level: [Vec<f64>; 2],
    /// The same slab: volume of the bond that joins the layers at a node. Twice the sum of `level`
    /// and the sum of `axial` add up to πn².
    pub(crate) axial: Vec<f64>,
}

impl Section {
    /// Shares out the section of radius `n` (at least 1) spacings.
    pub(crate) fn new(n: usize) -> Self {
        let radius = n as i64;
        let table = || vec![0.0; (2 * n + 1) * (2 * n + 1)];
        let mut section = Self {
            radius,
            planar: [table(), table()],
            level: [table(), table()],
            axial: table(),
        };
        let mut clipped = Vec::new();
        let mut full_cells = 0;
        for j in -radius..radius {
            for i in -radius..radius {
                let corners = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)];
                if corners.iter().all(|&(i, j)| section.has_node(i, j)) {
                    full_cells += 1;
                    section.add_full_cell(i, j);
                } else {
                    section.sample_cell(i, j, &mut clipped);
                }
            }
        }
        // The circle's area is met exactly by scaling what was sampled; full cells are exact.
        let sample = (PI * (radius * radius) as f64 - f64::from(full_cells)) / clipped.len() as f64;
        for (x, y) in clipped {
            section.add_sample(x, y, sample);
        }
        section
    }

    /// Whether lattice point (i, j), counted from the centre, is a node.
    pub(crate) fn has_node(&self, i: i64, j: i64) -> bool {
        i * i + j * j <= self.radius * self.radius
    }

    /// Place of lattice point (i, j), counted from the centre, in a table.
    pub(crate) fn index(&self, i: i64, j: i64) -> usize {
        ((j + self.radius) * (2 * self.radius + 1) + i + self.radius) as usize
    }

    /// Area that belongs to a node: half of each of its bonds in the plane.
    pub(crate) fn node_area(&self, i: i64, j: i64) -> f64 {
        let [first, second] = &self.planar;
        let mut sum = first[self.index(i, j)] + second[self.index(i, j)];
        if i > -self.radius {
            sum += first[self.index(i - 1, j)];
        }
        if j > -self.radius {
            sum += second[self.index(i, j - 1)];
        }
        0.5 * sum
    }

    /// Nodes (i, j) that lack a neighbour in the section, with the part of the rim that belongs to
    /// each: (angle of its middle, its angle), counter-clockwise. The parts divide the rim midway
    /// between the nodes' directions, which are all different.
    pub(crate) fn rim(&self) -> Vec<((i64, i64), f64, f64)> {
        let mut nodes = Vec::new();
        for j in -self.radius..=self.radius {
            for i in -self.radius..=self.radius {
                let inner = [(i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)]
                    .iter()
                    .all(|&(i, j)| self.has_node(i, j));
                if self.has_node(i, j) && !inner {
                    nodes.push(((i, j), (j as f64).atan2(i as f64)));
                }
            }
        }
        nodes.sort_by(|(_, a), (_, b)| a.total_cmp(b));
        let count = nodes.len();
        (0..count)
            .map(|k| {
                let (node, angle) = nodes[k];
                let before = (angle - nodes[(k + count - 1) % count].1).rem_euclid(2.0 * PI);
                let after = (nodes[(k + 1) % count].1 - angle).rem_euclid(2.0 * PI);
                (
                    node,
                    angle + 0.25 * (after - before),
                    0.5 * (before + after),
                )
            })
            .collect()
    }

    /// A quarter of the cell to each of its edges; of the slab above it a twelfth.
    fn add_full_cell(&mut self, i: i64, j: i64) {
        for step in 0..2 {
            let along_first = self.index(i, j + step);
            let along_second = self.index(i + step, j);
            for (axis, edge) in [along_first, along_second].into_iter().enumerate() {
                self.planar[axis][edge] += 1.0 / 4.0;
                self.level[axis][edge] += 1.0 / 12.0;
            }
            for other in 0..2 {
                let corner = self.index(i + step, j + other);
                self.axial[corner] += 1.0 / 12.0;
            }
        }
    }

    /// Midpoints of the subcells of a cell that lie inside the circle.
    fn sample_cell(&self, i: i64, j: i64, inside: &mut Vec<(f64, f64)>) {
        let scale = 2 * SAMPLES;
        for t in 0..SAMPLES {
            for s in 0..SAMPLES {
                let (x, y) = (scale * i + 2 * s + 1, scale * j + 2 * t + 1);
                if x * x + y * y <= (scale * self.radius).pow(2) {
                    inside.push((x as f64 / scale as f64, y as f64 / scale as f64));
                }
            }
        }
    }

    /// Gives the area around (x, y) to the nearest bonds, in equal parts if several are nearest.
    fn add_sample(&mut self, x: f64, y: f64, area: f64) {
        // A sample has a node at a corner of its cell, and that node a bond: two cells reach.
        let (i, j) = (x.floor() as i64, y.floor() as i64);
        let mut node = Nearest::new();
        let mut bond = Nearest::new();
        for b in j - 2..=j + 3 {
            for a in i - 2..=i + 3 {
                if !self.has_node(a, b) {
                    continue;
                }
                let (dx, dy) = (a as f64 - x, b as f64 - y);
                let place = self.index(a, b);
                node.offer(dx * dx + dy * dy, place);
                if self.has_node(a + 1, b) {
                    bond.offer((dx + 0.5).powi(2) + dy * dy, 2 * place);
                }
                if self.has_node(a, b + 1) {
                    bond.offer(dx * dx + (dy + 0.5).powi(2), 2 * place + 1);
                }
            }
        }
        for place in bond.places() {
            self.planar[place % 2][place / 2] += area / bond.count as f64;
        }
        // At height z ≤ ½ above a layer its bonds are at z² + (distance of the bond)², the axial
        // ones at (½ − z)² + (distance of the node)²: the former win below this height.
        let height = (node.distance - bond.distance + 0.25).clamp(0.0, 0.5);
        for place in bond.places() {
            self.level[place % 2][place / 2] += area * height / bond.count as f64;
        }
        for place in node.places() {
            self.axial[place] += area * (1.0 - 2.0 * height) / node.count as f64;
        }
    }
}

/// The places at the smallest distance so far.
struct Nearest {
    distance: f64,
    found: [usize; 8],
    count: usize,
}

impl Nearest {
    fn new() -> Self {
        Self {
            distance: f64::INFINITY,
            found: [0; 8],
            count: 0,
        }
    }

    /// Exact comparison: see [`SAMPLES`]. At most four lattice nodes or bonds are equally near.
    fn offer(&mut self, distance: f64, place: usize) {
        if distance < self.distance {
            (self.distance, self.count) = (distance, 0);
        }
        if distance == self.distance {
            self.found[self.count] = place;
            self.count += 1;
        }
    }

    fn places(&self) -> impl Iterator<Item = usize> + use<> {
        self.found.into_iter().take(self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(table: &[f64]) -> f64 {
        table.iter().sum()
    }

    #[test]
    fn both_ways_of_sharing_give_the_area_of_the_circle() {
        for n in [1, 2, 5, 9, 40] {
            let section = Section::new(n);
            let area = PI * (n * n) as f64;
            let planar = sum(&section.planar[0]) + sum(&section.planar[1]);
            let slab =
                2.0 * (sum(&section.level[0]) + sum(&section.level[1])) + sum(&section.axial);
            assert!((planar / area - 1.0).abs() < 1e-13, "n = {n}: {planar}");
            assert!((slab / area - 1.0).abs() < 1e-13, "n = {n}: {slab}");
        }
    }

    #[test]
    fn only_nodes_and_bonds_of_the_section_get_a_share() {
        let section = Section::new(5);
        for j in -5..=5_i64 {
            for i in -5..=5_i64 {
                let index = section.index(i, j);
                let node = section.has_node(i, j);
                assert_eq!(section.axial[index] > 0.0, node, "({i}, {j})");
                assert_eq!(
                    section.planar[0][index] > 0.0,
                    node && section.has_node(i + 1, j)
                );
                assert_eq!(
                    section.planar[1][index] > 0.0,
                    node && section.has_node(i, j + 1)
                );
            }
        }
    }

    #[test]
    fn sampling_agrees_with_the_exact_share_of_full_cells() {
        // Sharing a full cell by samples must reproduce the quarters and twelfths that are exact.
        let mut section = Section::new(9);
        for table in section.planar.iter_mut().chain(&mut section.level) {
            table.fill(0.0);
        }
        section.axial.fill(0.0);
        let mut samples = Vec::new();
        section.sample_cell(1, 2, &mut samples);
        for &(x, y) in &samples {
            section.add_sample(x, y, 1.0 / samples.len() as f64);
        }
        let (edge, corner) = (section.index(1, 2), section.index(2, 3));
        assert!((section.planar[0][edge] - 0.25).abs() < 1e-12);
        // Midpoint rule in the plane, exact in height: 1/SAMPLES² accuracy.
        assert!((section.level[1][edge] - 1.0 / 12.0).abs() < 1e-3);
        assert!((section.axial[corner] - 1.0 / 12.0).abs() < 1e-3);
    }

    #[test]
    fn the_rim_closes_and_has_no_resultant() {
        for n in [1, 5, 9, 16] {
            let rim = Section::new(n).rim();
            assert!((rim.iter().map(|r| r.2).sum::<f64>() - 2.0 * PI).abs() < 1e-12);
            assert!(rim.iter().all(|r| r.2 > 1e-3));
            let x: f64 = rim.iter().map(|r| r.2 * r.1.cos()).sum();
            assert!(x.abs() < 1e-12, "n = {n}: {x}");
        }
    }
}
