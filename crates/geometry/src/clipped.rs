//! Discs and cylinders cut out of a cubic lattice.

use jstsph_tensor::Vec3;

use crate::body::{Body, Bonds, Round};
use crate::face::{Face, FaceArea, FaceKind};
use crate::grid::{Grid, between, share};
use crate::section::Section;
use crate::{Dimension, Shape};

/// Builds the body from `n` intervals per radius and a number of layers (1 for a disc).
///
/// The section is the same at every height, so that the geometry is worked out once per section
/// and the cost per layer is that of writing the nodes down.
pub(crate) fn build(shape: Shape, round: &Round, n: usize, layers: usize) -> Body {
    let dimension = round.dimension();
    let [first, second, along] = round.axes;
    let section = Section::new(n);
    let mut counts = [2 * n + 1; 3];
    counts[along] = layers;
    let in_section = |point: [usize; 3]| {
        let shift = |i: usize| i as i64 - n as i64;
        (shift(point[first]), shift(point[second]))
    };
    let grid = Grid::new(counts, dimension, |point| {
        let (i, j) = in_section(point);
        section.has_node(i, j)
    });

    let step = round.radius / n as f64;
    let layer = round.layer_spacing(layers);
    let cell = step * step * layer;
    let positions: Vec<Vec3> = grid
        .points()
        .iter()
        .map(|&point| {
            let (i, j) = in_section(point);
            // The product first, so that nodes on the circle's axes lie at the radius exactly.
            let across = |i: i64| round.radius * i as f64 / n as f64;
            let height = round
                .height
                .map_or(0.0, |height| between(0.0, height, point[along], layers));
            round.origin + round.vector(across(i), across(j), height)
        })
        .collect();

    let bonds = grid.bonds(|point, axis| {
        let (i, j) = in_section(point);
        let place = section.index(i, j);
        if axis == along {
            return cell * section.axial[place];
        }
        let table = usize::from(axis == second);
        match dimension {
            Dimension::PlaneStrain => cell * section.planar[table][place],
            // Two slabs meet in an inner layer, one ends in an outer layer.
            Dimension::Solid => {
                cell * section.level[table][place] * 2.0 * share(point[along], layers)
            }
        }
    });
    let volumes = node_volumes(&bonds, positions.len());

    let spacing = match dimension {
        Dimension::PlaneStrain => step,
        Dimension::Solid => step.min(layer),
    };
    Body {
        dimension,
        volumes,
        weights: vec![cell; positions.len()],
        spacing,
        support_spacing: spacing,
        bonds,
        cells: grid.cells(),
        boundary: grid.boundary(),
        surface: None,
        faces: Faces {
            section: &section,
            round,
            n,
            layers,
        }
        .all(&grid, &positions),
        positions: positions.into(),
        shape,
    }
}

/// V_a = ½ Σ V_q over the node's bonds, so that both quadratures share masses.
pub(crate) fn node_volumes(bonds: &Bonds, nodes: usize) -> Vec<f64> {
    let mut volumes = vec![0.0; nodes];
    for (ends, volume) in bonds.ends.iter().zip(bonds.volumes.iter()) {
        for &end in ends {
            volumes[end as usize] += 0.5 * volume;
        }
    }
    volumes
}

struct Faces<'a> {
    section: &'a Section,
    round: &'a Round,
    n: usize,
    layers: usize,
}

impl Faces<'_> {
    fn all(&self, grid: &Grid, positions: &[Vec3]) -> Vec<Face> {
        let step = self.round.radius / self.n as f64;
        let side = self.round.radius * self.round.layer_spacing(self.layers);
        let mut rim = vec![None; (2 * self.n + 1).pow(2)];
        for ((i, j), middle, angle) in self.section.rim() {
            let normal = self.round.vector(middle.cos(), middle.sin(), 0.0);
            rim[self.section.index(i, j)] = Some((angle, normal));
        }
        let [first, second, along] = self.round.axes;
        let last = self.layers - 1;
        let (mut base, mut top, mut round) = (Vec::new(), Vec::new(), Vec::new());
        let (mut rim_base, mut rim_top) = (Vec::new(), Vec::new());
        let axis = self.round.vector(0.0, 0.0, 1.0);
        let centre = self
            .round
            .vector(1.0, 1.0, 0.0)
            .component_mul(&self.round.origin);
        for (node, (point, position)) in grid.points().iter().zip(positions).enumerate() {
            let node = node as u32;
            let (i, j) = (
                point[first] as i64 - self.n as i64,
                point[second] as i64 - self.n as i64,
            );
            let (at_base, at_top) = (point[along] == 0, point[along] == last);
            let end = |direction| FaceArea {
                node,
                area: step * step * self.section.node_area(i, j),
                normal: self.round.vector(0.0, 0.0, direction),
                point: *position,
            };
            if at_base {
                base.push(end(-1.0));
            }
            if at_top {
                top.push(end(1.0));
            }
            if let Some((angle, normal)) = rim[self.section.index(i, j)] {
                let part = match self.round.height {
                    Some(_) => share(point[along], self.layers),
                    None => 1.0,
                };
                round.push(FaceArea {
                    node,
                    area: angle * side * part,
                    normal,
                    point: centre + normal * self.round.radius + axis.component_mul(position),
                });
            }
            // Only nodes on the circle itself, so that their mean radius is the body's: four or
            // more, on the axes of the section.
            if i * i + j * j == (self.n * self.n) as i64 {
                if at_base {
                    rim_base.push(node);
                }
                if at_top {
                    rim_top.push(node);
                }
            }
        }
        round_faces(
            self.round,
            RoundFaces {
                base,
                top,
                round,
                rim_base,
                rim_top,
            },
        )
    }
}

/// Parts of the surface of a disc or cylinder; a disc has only `round`.
pub(crate) struct RoundFaces {
    pub(crate) base: Vec<FaceArea>,
    pub(crate) top: Vec<FaceArea>,
    pub(crate) round: Vec<FaceArea>,
    pub(crate) rim_base: Vec<u32>,
    pub(crate) rim_top: Vec<u32>,
}

/// Names the parts.
pub(crate) fn round_faces(round: &Round, parts: RoundFaces) -> Vec<Face> {
    let surface = |name, areas| Face {
        name,
        kind: FaceKind::Surface(areas),
    };
    let edge = |name, nodes| Face {
        name,
        kind: FaceKind::Edge {
            nodes,
            instead: "side",
        },
    };
    if round.height.is_none() {
        return vec![surface("rim", parts.round)];
    }
    vec![
        surface("base", parts.base),
        surface("top", parts.top),
        surface("side", parts.round),
        edge("rim_base", parts.rim_base),
        edge("rim_top", parts.rim_top),
    ]
}
