//! Bonds and cells of concentric rings: the strips between them, cut into triangles.
//!
//! Ring m has p m nodes, so that the strip between the rings m and m + 1 consists of p sectors with m + 1
//! triangles on the outer and m on the inner ring: a triangular lattice wound round the centre, whose
//! lines are the rings, the rim among them.

use std::f64::consts::PI;

/// Sections with fewer nodes in the first ring have no cells: the one in the middle would be flat.
const LEAST_WITH_CELLS: usize = 6;

/// Bonds, cells and areas of one section.
pub(super) struct Strips {
    /// Sides of the triangles, in the order of their first node.
    pub(super) bonds: Vec<SectionBond>,
    /// Pairs of neighbouring triangles, corners counter-clockwise; none if the first ring has an odd number
    /// of nodes or fewer than six.
    pub(super) quads: Vec<[u32; 4]>,
    /// Half the area of the bonds of each node, m².
    pub(super) node_areas: Vec<f64>,
}

/// A bond of the section.
pub(super) struct SectionBond {
    /// Along a ring counter-clockwise, otherwise outwards.
    pub(super) ends: [u32; 2],
    /// What of the section belongs to it, m².
    pub(super) area: f64,
    /// 0 outwards, 1 along a ring.
    pub(super) direction: u8,
}

/// Numbers of the nodes of rings that begin with `per_ring` nodes.
struct Numbers {
    per_ring: usize,
}

impl Numbers {
    /// Node `k` of ring `m`, counted round and round.
    fn node(&self, m: usize, k: usize) -> u32 {
        match m {
            0 => 0,
            _ => (1 + self.per_ring * m * (m - 1) / 2 + k % (self.per_ring * m)) as u32,
        }
    }

    /// Triangles of the strip outside of ring `m`, counter-clockwise, each beside the one before.
    fn strip(&self, m: usize) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(self.per_ring * (2 * m + 1));
        for sector in 0..self.per_ring {
            let inner = |j| self.node(m, m * sector + j);
            let outer = |j| self.node(m + 1, (m + 1) * sector + j);
            for j in 0..=m {
                triangles.push([inner(j), outer(j), outer(j + 1)]);
                if j < m {
                    triangles.push([inner(j), outer(j + 1), inner(j + 1)]);
                }
            }
        }
        triangles
    }
}

impl Strips {
    /// `offsets` are the nodes in the order of rings, m.
    ///
    /// A third of every triangle goes to each of its sides, and what lies between the rim and the circle to
    /// the bond on the rim, so that the areas add up to the disc.
    pub(super) fn new(rings: usize, per_ring: usize, radius: f64, offsets: &[[f64; 2]]) -> Self {
        let numbers = Numbers { per_ring };
        let mut bonds = Vec::new();
        let (mut triangles, mut quads) = (Vec::new(), Vec::new());
        let has_cells = per_ring.is_multiple_of(2) && per_ring >= LEAST_WITH_CELLS;
        for m in 0..rings {
            let strip = numbers.strip(m);
            // The side that two triangles have in common begins at the first node of the second triangle and
            // ends at its second one, which is the last node of the first triangle or the one before.
            for pair in strip.chunks_exact(2).filter(|_| has_cells) {
                let [[a, b, c], [_, d, e]] = [pair[0], pair[1]];
                quads.push(if d == c { [a, b, c, e] } else { [a, b, e, c] });
            }
            let is_on_ring = |node: u32| node >= numbers.node(m + 1, 0);
            for &[a, b, c] in &strip {
                let side = |ends: [u32; 2], direction| SectionBond {
                    ends,
                    area: 0.0,
                    direction,
                };
                bonds.push(side([a, b], 0));
                if is_on_ring(c) {
                    bonds.push(side([b, c], 1));
                }
            }
            triangles.extend(strip);
        }
        bonds.sort_by_key(|bond| bond.ends);

        let place = |node: u32| offsets[node as usize];
        for triangle in &triangles {
            let [a, b, c] = triangle.map(place);
            let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
            for side in 0..3 {
                let ends = [triangle[side], triangle[(side + 1) % 3]];
                add_area(&mut bonds, ends, area / 3.0);
            }
        }
        let angle = 2.0 * PI / (per_ring * rings) as f64;
        let segment = 0.5 * radius * radius * (angle - angle.sin());
        for k in 0..per_ring * rings {
            let ends = [numbers.node(rings, k), numbers.node(rings, k + 1)];
            add_area(&mut bonds, ends, segment);
        }
        let mut node_areas = vec![0.0; offsets.len()];
        for bond in &bonds {
            for end in bond.ends {
                node_areas[end as usize] += 0.5 * bond.area;
            }
        }
        Self {
            bonds,
            quads,
            node_areas,
        }
    }
}

/// Adds to the bond between two nodes, in whichever order it has them.
fn add_area(bonds: &mut [SectionBond], ends: [u32; 2], area: f64) {
    let find = |ends: [u32; 2]| bonds.binary_search_by_key(&ends, |bond| bond.ends);
    if let Ok(found) = find(ends).or_else(|_| find([ends[1], ends[0]])) {
        bonds[found].area += area;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn offsets(rings: usize, per_ring: usize) -> Vec<[f64; 2]> {
        let mut all = vec![[0.0, 0.0]];
        for m in 1..=rings {
            let r = m as f64 / rings as f64;
            all.extend((0..m * per_ring).map(|k| {
                let angle = 2.0 * PI * k as f64 / (m * per_ring) as f64;
                [r * angle.cos(), r * angle.sin()]
            }));
        }
        all
    }

    #[test]
    fn areas_add_up_to_the_disc_and_every_bond_has_one() {
        for (rings, per_ring) in [(1, 3), (1, 6), (3, 5), (4, 6), (5, 8)] {
            let strips = Strips::new(rings, per_ring, 1.0, &offsets(rings, per_ring));
            let total: f64 = strips.bonds.iter().map(|bond| bond.area).sum();
            assert!(
                (total / PI - 1.0).abs() < 1e-14,
                "{rings} {per_ring}: {total}"
            );
            assert!(strips.bonds.iter().all(|bond| bond.area > 0.0));
            let nodes: f64 = strips.node_areas.iter().sum();
            assert!((nodes / PI - 1.0).abs() < 1e-14);
            // Euler: sides = nodes + triangles − 1.
            let nodes = strips.node_areas.len();
            assert_eq!(strips.bonds.len(), nodes + per_ring * rings * rings - 1);
            let mut ends: Vec<[u32; 2]> = strips.bonds.iter().map(|bond| bond.ends).collect();
            ends.iter_mut().for_each(|ends| ends.sort_unstable());
            ends.sort_unstable();
            assert!(
                ends.windows(2).all(|pair| pair[0] != pair[1]),
                "a bond twice"
            );
        }
    }

    #[test]
    fn six_in_the_first_ring_wind_a_triangular_lattice() {
        let strips = Strips::new(3, 6, 1.0, &offsets(3, 6));
        let mut count = vec![0; strips.node_areas.len()];
        for end in strips.bonds.iter().flat_map(|bond| bond.ends) {
            count[end as usize] += 1;
        }
        // Inside six neighbours; on the rim four, or three at the ends of a sector.
        assert!(count[..19].iter().all(|&n| n == 6), "{count:?}");
        assert_eq!(count[19..22], [3, 4, 4]);
    }

    #[test]
    fn cells_fill_the_polygon_of_the_rim_and_are_convex() {
        for (rings, per_ring) in [(1, 6), (4, 6), (3, 8), (2, 10)] {
            let places = offsets(rings, per_ring);
            let strips = Strips::new(rings, per_ring, 1.0, &places);
            assert_eq!(strips.quads.len(), per_ring * rings * rings / 2);
            let mut total = 0.0;
            for quad in &strips.quads {
                let x = quad.map(|node| places[node as usize]);
                for i in 0..4 {
                    let [a, b, c] = [x[i], x[(i + 1) % 4], x[(i + 2) % 4]];
                    let turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
                    assert!(turn > 0.0, "{per_ring}: {quad:?}");
                }
                total += 0.5 * (x[2][0] - x[0][0]) * (x[3][1] - x[1][1])
                    - 0.5 * (x[2][1] - x[0][1]) * (x[3][0] - x[1][0]);
            }
            let sides = (per_ring * rings) as f64;
            let polygon = 0.5 * sides * (2.0 * PI / sides).sin();
            assert!((total / polygon - 1.0).abs() < 1e-13, "{total} {polygon}");
        }
        assert!(Strips::new(2, 7, 1.0, &offsets(2, 7)).quads.is_empty());
    }
}
