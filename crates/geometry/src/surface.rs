//! The surface of a body in small parts, for sums over the boundary.

use std::collections::BTreeMap;

use jstsph_tensor::Vec3;

use crate::carved::{Lattice, SAMPLES};
use crate::chords::{Chords, chords, without};
use crate::face::{FaceArea, FaceKind};
use crate::grid::Grid;
use crate::{Body, Dimension};

/// The whole surface of a body in parts, each given to a node near it.
///
/// Σ A n over the parts is zero and Σ A X ⊗ n, with X the point of the part, the volume times the unit
/// tensor: to round-off on boxes, discs and cylinders; on bodies carved out of a lattice the volume is
/// that of the bars described at `carved_surface`, within some 10⁻⁴ of the body's.
#[must_use]
pub fn surface_parts(body: &Body) -> Vec<FaceArea> {
    match &body.surface {
        Some(parts) => parts.clone(),
        None => body
            .faces
            .iter()
            .filter_map(|face| match &face.kind {
                FaceKind::Surface(parts) => Some(parts),
                FaceKind::Edge { .. } => None,
            })
            .flatten()
            .copied()
            .collect(),
    }
}

/// By node and side: below and above along x, y and z.
type Sides = BTreeMap<(u32, usize), Side>;

/// What a node has of the surface that faces along one axis, up or down.
#[derive(Clone, Copy, Default)]
struct Side {
    area: f64,
    /// Σ A x, m³.
    moment: Vec3,
}

/// The surface of a carved body.
///
/// The shape is cut into bars along x, each as long as the line through its middle is inside: ends and
/// uncovered flanks of the bars are a closed surface with exact moments. What is nearest to one node and
/// faces the same way is one part, at its centroid.
pub(crate) fn carved_surface(
    lattice: &Lattice<'_>,
    grid: &Grid,
    positions: &[Vec3],
) -> Vec<FaceArea> {
    let mut nodes = vec![u32::MAX; lattice.counts.iter().product()];
    for (node, &point) in grid.points().iter().enumerate() {
        nodes[lattice.flat(point)] = node as u32;
    }
    let bars = Bars::new(
        lattice,
        Nearest {
            lattice,
            nodes,
            positions,
        },
    );
    let parts = bars
        .sides()
        .into_iter()
        .map(|((node, side), Side { area, moment })| {
            let mut normal = Vec3::zeros();
            normal[side / 2] = if side % 2 == 1 { 1.0 } else { -1.0 };
            FaceArea {
                node,
                area,
                normal,
                point: moment / area,
            }
        });
    parts.collect()
}

/// Finds the node next to a point of the surface.
struct Nearest<'a> {
    lattice: &'a Lattice<'a>,
    /// Node of each lattice point, if it has one.
    nodes: Vec<u32>,
    positions: &'a [Vec3],
}

impl Nearest<'_> {
    /// The node at the nearest lattice point, else the nearest one at most two points away; of those that
    /// lie beyond the surface only such as the body connects with it: not those across a slot.
    fn find(&self, x: &Vec3, axis: usize, outwards: f64) -> Option<u32> {
        let lattice = self.lattice;
        let is_connected = |node: u32| {
            let place = self.positions[node as usize];
            let beyond = (place[axis] - x[axis]) * outwards;
            beyond < 1e-6 * lattice.steps[axis] || lattice.contains(&((place + x) * 0.5))
        };
        let low = lattice.place([0; 3]);
        let point: [usize; 3] = std::array::from_fn(|axis| {
            if axis < lattice.dimension.count() {
                let place = (x[axis] - low[axis]) / lattice.steps[axis];
                (place.round().max(0.0) as usize).min(lattice.counts[axis] - 1)
            } else {
                0
            }
        });
        let node = self.nodes[lattice.flat(point)];
        if node != u32::MAX && is_connected(node) {
            return Some(node);
        }
        let range = |axis: usize| {
            let last = (point[axis] + 2).min(lattice.counts[axis] - 1);
            point[axis].saturating_sub(2)..=last
        };
        let (mut best, mut least) = (None, f64::INFINITY);
        for (k, j) in range(2).flat_map(|k| range(1).map(move |j| (k, j))) {
            for i in range(0) {
                let node = self.nodes[lattice.flat([i, j, k])];
                if node != u32::MAX {
                    let square = (self.positions[node as usize] - x).norm_squared();
                    if square < least && is_connected(node) {
                        (best, least) = (Some(node), square);
                    }
                }
            }
        }
        best
    }
}

/// The bars of a shape: lines along x in the middle of equal parts of every row of cells.
struct Bars<'a> {
    lattice: &'a Lattice<'a>,
    nearest: Nearest<'a>,
    /// Bars per cell and direction.
    samples: usize,
    /// Bars along y and z in the whole lattice.
    counts: [usize; 2],
    /// Lowest corner of the lattice, m.
    low: Vec3,
    /// Width of a bar along y and z, m.
    width: [f64; 2],
}

impl<'a> Bars<'a> {
    fn new(lattice: &'a Lattice<'a>, nearest: Nearest<'a>) -> Self {
        let samples = SAMPLES[lattice.dimension.count() - 2];
        let layers = match lattice.dimension {
            Dimension::PlaneStrain => 1,
            Dimension::Solid => samples,
        };
        let [_, ny, nz] = lattice.cell_counts();
        Self {
            lattice,
            nearest,
            samples,
            counts: [ny * samples, nz * layers],
            low: lattice.place([0; 3]),
            width: [
                lattice.steps[1] / samples as f64,
                lattice.steps[2] / layers as f64,
            ],
        }
    }

    /// Middle of a bar along y and z, m.
    fn middle(&self, line: usize, layer: usize) -> [f64; 2] {
        let z = match self.lattice.dimension {
            Dimension::PlaneStrain => 0.0,
            Dimension::Solid => self.low.z + (layer as f64 + 0.5) * self.width[1],
        };
        [self.low.y + (line as f64 + 0.5) * self.width[0], z]
    }

    /// The bars of one layer; nothing beyond the last.
    fn layer(&self, layer: usize) -> Vec<Chords> {
        let bar = |line| {
            let [y, z] = self.middle(line, layer);
            chords(self.lattice.shape, y, z, self.lattice.dimension)
        };
        match layer < self.counts[1] {
            true => (0..self.counts[0]).map(bar).collect(),
            false => vec![Chords::new(); self.counts[0]],
        }
    }

    /// The surface of all bars.
    fn sides(&self) -> Sides {
        let mut sides = Sides::new();
        let (nothing, mut below) = (Chords::new(), vec![Chords::new(); self.counts[0]]);
        let mut current = self.layer(0);
        let [dy, dz] = self.width;
        for layer in 0..self.counts[1] {
            let above = self.layer(layer + 1);
            for (line, own) in current.iter().enumerate() {
                let [y, z] = self.middle(line, layer);
                for [from, to] in own {
                    self.add(&mut sides, 0, dy * dz, Vec3::new(*from, y, z));
                    self.add(&mut sides, 1, dy * dz, Vec3::new(*to, y, z));
                }
                let before = line.checked_sub(1).map_or(&nothing, |line| &current[line]);
                let after = current.get(line + 1).unwrap_or(&nothing);
                let mut flank = |side: usize, other: &Chords, width: f64, at: [f64; 2]| {
                    for piece in without(own, other) {
                        self.add_along(&mut sides, side, piece, width, at);
                    }
                };
                flank(2, before, dz, [y - 0.5 * dy, z]);
                flank(3, after, dz, [y + 0.5 * dy, z]);
                if self.lattice.dimension == Dimension::Solid {
                    flank(4, &below[line], dy, [y, z - 0.5 * dz]);
                    flank(5, &above[line], dy, [y, z + 0.5 * dz]);
                }
            }
            below = std::mem::replace(&mut current, above);
        }
        sides
    }

    /// A piece of a flank, cut into pieces like those across.
    fn add_along(
        &self,
        sides: &mut Sides,
        side: usize,
        [from, to]: [f64; 2],
        width: f64,
        [y, z]: [f64; 2],
    ) {
        let step = self.lattice.steps[0] / self.samples as f64;
        let place = |x: f64| (x - self.low.x) / step;
        let (first, last) = (place(from).floor() as isize, place(to).ceil() as isize);
        for i in first..last {
            let start = from.max(self.low.x + i as f64 * step);
            let stop = to.min(self.low.x + (i + 1) as f64 * step);
            if start < stop {
                let middle = Vec3::new(0.5 * (start + stop), y, z);
                self.add(sides, side, width * (stop - start), middle);
            }
        }
    }

    /// `side` is twice the axis, and one more for what faces upwards.
    fn add(&self, sides: &mut Sides, side: usize, area: f64, x: Vec3) {
        let outwards = if side % 2 == 1 { 1.0 } else { -1.0 };
        if let Some(node) = self.nearest.find(&x, side / 2, outwards) {
            let found = sides.entry((node, side)).or_default();
            found.area += area;
            found.moment += x * area;
        }
    }
}

#[cfg(test)]
mod tests {
    use jstsph_tensor::Mat3;

    use super::*;
    use crate::{Axis, Shape, Spacing, build_body};

    fn body(shape: Shape, spacing: f64, dimension: Dimension) -> Body {
        let spacing = Spacing::Length(spacing);
        build_body(shape, crate::Lattice::Cubic { spacing }, dimension).unwrap()
    }

    /// Σ A n and Σ A X ⊗ n.
    fn moments(body: &Body) -> (Vec3, Mat3) {
        surface_parts(body)
            .iter()
            .fold((Vec3::zeros(), Mat3::zeros()), |(sum, moment), part| {
                let vector = part.normal * part.area;
                (sum + vector, moment + part.point * vector.transpose())
            })
    }

    #[test]
    fn boxes_discs_and_cylinders_have_the_moments_of_their_surface() {
        let cylinder = Shape::Cylinder {
            base: Vec3::new(0.3, 0.1, 0.0),
            axis: Axis::X,
            radius: 1.0,
            height: 2.0,
        };
        let cube = Shape::Box {
            min: Vec3::zeros(),
            max: Vec3::new(1.0, 1.5, 2.0),
        };
        for shape in [cylinder, cube] {
            let body = body(shape, 0.25, Dimension::Solid);
            let volume = body.shape.volume(body.dimension);
            let (sum, moment) = moments(&body);
            assert!(sum.norm() < 1e-12, "{sum}");
            assert!((moment - Mat3::identity() * volume).norm() < 1e-12 * volume);
        }
    }

    #[test]
    fn the_surface_of_a_carved_body_is_closed_and_bounds_its_volume() {
        let ball = |radius| Shape::Sphere {
            centre: Vec3::new(0.1, 0.2, 0.3),
            radius,
        };
        // A ball with a hole through it, whose flat ends lie between lattice planes.
        let drilled = Shape::Difference(vec![
            ball(1.0),
            Shape::Cylinder {
                base: Vec3::new(0.1, 0.2, -2.0),
                axis: Axis::Z,
                radius: 0.35,
                height: 2.4,
            },
        ]);
        for shape in [ball(1.0), drilled] {
            let body = body(shape, 0.2, Dimension::Solid);
            let volume = body.shape.volume(body.dimension);
            let (sum, moment) = moments(&body);
            assert!(sum.norm() < 1e-12, "{sum}");
            let error = (moment - Mat3::identity() * volume) / volume;
            // Off the diagonal to round-off as well; the bars miss the volume by a few 1e-4.
            assert!(error.norm() < 2e-3, "{error}");
            let spread = moment - Mat3::identity() * (moment.trace() / 3.0);
            assert!(spread.norm() < 1e-12, "{spread}");
        }
    }

    #[test]
    fn the_faces_of_a_slot_belong_to_the_two_sides_of_it() {
        let block = |x: [f64; 2], y: [f64; 2]| Shape::Box {
            min: Vec3::new(x[0], y[0], 0.0),
            max: Vec3::new(x[1], y[1], 0.0),
        };
        // A third of a spacing wide, nearer to the nodes on its left.
        let slotted = Shape::Difference(vec![
            block([0.0, 8.0], [0.0, 4.0]),
            block([4.1, 4.4], [1.0, 5.0]),
        ]);
        let body = body(slotted, 1.0, Dimension::PlaneStrain);
        for part in surface_parts(&body) {
            let node = body.positions[part.node as usize];
            if part.point.y > 1.1 && part.normal.x.abs() == 1.0 {
                let is_left = part.normal.x > 0.0 && part.point.x < 8.0;
                let is_left = is_left || part.point.x < 1e-9;
                assert_eq!(node.x < 4.2, is_left, "{} {node}", part.point);
            }
        }
    }

    #[test]
    fn parts_lie_on_the_true_surface_and_near_their_node() {
        let quarter = Shape::Intersection(vec![
            Shape::Disc {
                centre: Vec3::zeros(),
                radius: 1.0,
            },
            Shape::Box {
                min: Vec3::zeros(),
                max: Vec3::new(2.0, 2.0, 0.0),
            },
        ]);
        let body = body(quarter, 0.125, Dimension::PlaneStrain);
        let parts = surface_parts(&body);
        for part in &parts {
            let node = body.positions[part.node as usize];
            assert!((part.point - node).norm() < 1.5 * 0.125);
            let deep = -body.shape.signed_distance(&part.point);
            // The centroid of an arc over a cell lies its sagitta inside.
            assert!(deep.abs() < 0.01, "{} {deep}", part.point);
        }
        let flat: f64 = parts
            .iter()
            .filter(|part| part.point.x < 1e-9 && part.normal.x < 0.0)
            .map(|part| part.area)
            .sum();
        assert!((flat - 1.0).abs() < 1e-12, "{flat}");
    }
}
