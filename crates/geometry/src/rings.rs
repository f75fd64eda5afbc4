//! Discs and cylinders of concentric rings.

mod strips;

use std::f64::consts::PI;

use strips::Strips;

use crate::body::{Body, Bonds, Round};
use crate::clipped::{RoundFaces, round_faces};
use crate::face::FaceArea;
use crate::grid::{between, share};
use crate::{Cells, Dimension, Shape};

/// A node of the section.
struct SectionNode {
    /// Position from the centre, m.
    offset: [f64; 2],
    /// Part of the section that belongs to it, m².
    area: f64,
    /// The same if the body went on outside, m².
    full_area: f64,
    /// On the outer ring.
    outer: bool,
}

/// Builds the body; counts are checked by the caller.
pub(crate) fn build(
    shape: Shape,
    round: &Round,
    rings: usize,
    per_ring: usize,
    layers: usize,
) -> Body {
    let section = section(round.radius, rings, per_ring);
    let layer = round.layer_spacing(layers);
    let arc = 2.0 * PI * round.radius / (rings * per_ring) as f64;
    let nodes = section.len() * layers;
    let mut positions = Vec::with_capacity(nodes);
    let mut volumes = Vec::with_capacity(nodes);
    let mut weights = Vec::with_capacity(nodes);
    let mut boundary = Vec::with_capacity(nodes);
    let mut faces = RoundFaces {
        base: Vec::new(),
        top: Vec::new(),
        round: Vec::new(),
        rim_base: Vec::new(),
        rim_top: Vec::new(),
    };
    for k in 0..layers {
        let (height, part) = match round.height {
            Some(height) => (between(0.0, height, k, layers), share(k, layers)),
            None => (0.0, 1.0),
        };
        let (at_base, at_top) = (k == 0, k == layers - 1);
        let at_end = round.height.is_some() && (at_base || at_top);
        for point in &section {
            let node = positions.len() as u32;
            let [x, y] = point.offset;
            let place = round.origin + round.vector(x, y, height);
            positions.push(place);
            volumes.push(point.area * layer * part);
            weights.push(point.full_area * layer);
            boundary.push(point.outer || at_end);
            let end = |direction| FaceArea {
                node,
                area: point.area,
                normal: round.vector(0.0, 0.0, direction),
                point: place,
            };
            if at_base {
                faces.base.push(end(-1.0));
            }
            if at_top {
                faces.top.push(end(1.0));
            }
            if point.outer {
                faces.round.push(FaceArea {
                    node,
                    area: arc * layer * part,
                    normal: round.vector(x / round.radius, y / round.radius, 0.0),
                    point: place,
                });
                if at_base {
                    faces.rim_base.push(node);
                }
                if at_top {
                    faces.rim_top.push(node);
                }
            }
        }
    }
    let dimension = round.dimension();
    let offsets: Vec<[f64; 2]> = section.iter().map(|node| node.offset).collect();
    let strips = Strips::new(rings, per_ring, round.radius, &offsets);
    let width = round.radius / rings as f64;
    Body {
        dimension,
        spacing: smallest_distance(round, rings, per_ring, layers),
        support_spacing: match dimension {
            Dimension::PlaneStrain => width,
            Dimension::Solid => width.min(layer),
        },
        bonds: bonds(&strips, dimension, layers, layer),
        cells: cells(&strips, dimension, layers, offsets.len()),
        faces: round_faces(round, faces),
        positions: positions.into(),
        volumes,
        weights,
        boundary,
        surface: None,
        shape,
    }
}

/// The bonds of the section in every layer and those between layers, in the order of their first node.
///
/// A triangle of the section is the bottom of a prism, whose nine edges are bonds with a ninth of its volume
/// each.
fn bonds(strips: &Strips, dimension: Dimension, layers: usize, layer: f64) -> Bonds {
    let (mut all, mut directions, mut volumes) = (Vec::new(), Vec::new(), Vec::new());
    let mut add = |ends: [u32; 2], direction: u8, volume: f64| {
        all.push(ends);
        directions.push(direction);
        volumes.push(volume);
    };
    for k in 0..layers {
        let height = match dimension {
            Dimension::PlaneStrain => layer,
            Dimension::Solid => layer * share(k, layers) * 2.0 / 3.0,
        };
        let below = (k * strips.node_areas.len()) as u32;
        let above = below + strips.node_areas.len() as u32;
        let mut across = strips.bonds.iter().peekable();
        for (node, area) in (0u32..).zip(&strips.node_areas) {
            while let Some(bond) = across.next_if(|bond| bond.ends[0] == node) {
                let ends = bond.ends.map(|end| end + below);
                add(ends, bond.direction, bond.area * height);
            }
            if k + 1 < layers {
                add([node + below, node + above], 2, area * layer / 3.0);
            }
        }
    }
    Bonds {
        ends: all.into(),
        directions,
        volumes: volumes.into(),
    }
}

/// The cells of the section, or the prisms on them.
fn cells(strips: &Strips, dimension: Dimension, layers: usize, per_layer: usize) -> Cells {
    if dimension == Dimension::PlaneStrain {
        return Cells::Quads(strips.quads.clone());
    }
    let mut hexes = Vec::with_capacity(strips.quads.len() * (layers - 1));
    for k in 0..layers - 1 {
        for quad in &strips.quads {
            let [a, b, c, d] = quad.map(|node| node + (k * per_layer) as u32);
            let [e, f, g, h] = quad.map(|node| node + ((k + 1) * per_layer) as u32);
            hexes.push([a, b, c, d, e, f, g, h]);
        }
    }
    Cells::Hexes(hexes)
}

/// Nodes of one layer. Ring m owns the annulus between the radii (m ± ½) radius / rings, cut off
/// at the radius for the outer ring.
fn section(radius: f64, rings: usize, per_ring: usize) -> Vec<SectionNode> {
    let width = radius / rings as f64;
    let centre = PI * width * width / 4.0;
    let mut nodes = vec![SectionNode {
        offset: [0.0, 0.0],
        area: centre,
        full_area: centre,
        outer: false,
    }];
    for ring in 1..=rings {
        let count = ring * per_ring;
        let m = ring as f64;
        let outer = ring == rings;
        let full = 2.0 * PI * m * width * width / count as f64;
        let inner_half = PI * (m - 0.25) * width * width / count as f64;
        for k in 0..count {
            let angle = 2.0 * PI * k as f64 / count as f64;
            let r = radius * m / rings as f64;
            nodes.push(SectionNode {
                offset: [r * angle.cos(), r * angle.sin()],
                area: if outer { inner_half } else { full },
                full_area: full,
                outer,
            });
        }
    }
    nodes
}

/// Neighbouring rings are nearest where both start (one ring width); within a ring it is the chord.
fn smallest_distance(round: &Round, rings: usize, per_ring: usize, layers: usize) -> f64 {
    let width = round.radius / rings as f64;
    let chords = (1..=rings).map(|ring| {
        let m = ring as f64;
        2.0 * m * width * (PI / (m * per_ring as f64)).sin()
    });
    let layer = match round.height {
        Some(_) => round.layer_spacing(layers),
        None => f64::INFINITY,
    };
    chords.fold(width.min(layer), f64::min)
}

#[cfg(test)]
mod tests {
    use jstsph_tensor::Vec3;

    use super::*;

    #[test]
    fn annuli_add_up_to_the_circle() {
        for (rings, per_ring) in [(1, 3), (4, 8), (7, 6)] {
            let nodes = section(2.0, rings, per_ring);
            assert_eq!(nodes.len(), 1 + per_ring * rings * (rings + 1) / 2);
            let area: f64 = nodes.iter().map(|node| node.area).sum();
            assert!((area / (4.0 * PI) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn eight_nodes_in_the_first_ring_give_equal_weights() {
        let nodes = section(2.0, 4, 8);
        let cell = PI * 0.25 / 4.0;
        assert!(
            nodes
                .iter()
                .all(|node| (node.full_area / cell - 1.0).abs() < 1e-14)
        );
    }

    #[test]
    fn smallest_distance_is_that_of_the_nodes() {
        for per_ring in [3, 6, 8, 20] {
            let nodes = section(1.0, 3, per_ring);
            let place = |node: &SectionNode| Vec3::new(node.offset[0], node.offset[1], 0.0);
            let mut nearest = f64::INFINITY;
            for (a, first) in nodes.iter().enumerate() {
                for second in &nodes[..a] {
                    nearest = nearest.min((place(first) - place(second)).norm());
                }
            }
            let round = Round {
                axes: [0, 1, 2],
                origin: Vec3::zeros(),
                radius: 1.0,
                height: None,
            };
            let claimed = smallest_distance(&round, 3, per_ring, 1);
            assert!(
                (claimed - nearest).abs() < 1e-14,
                "{per_ring}: {claimed} {nearest}"
            );
        }
    }
}
