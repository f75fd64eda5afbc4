//! Boxes and rectangles on a cubic lattice.

use jstsph_tensor::Vec3;

use crate::face::{Face, FaceArea, FaceKind};
use crate::grid::{Grid, between, share};
use crate::{Body, Dimension, Shape};

/// Builds the body; counts are at least 2 along each axis that the dimension has.
pub(crate) fn build(shape: Shape, counts: [usize; 3], dimension: Dimension) -> Body {
    let axes = dimension.count();
    let (min, max) = shape.bounds();
    // Plane strain: one layer of 1 m thickness.
    let steps: [f64; 3] = std::array::from_fn(|i| {
        if i < axes {
            (max[i] - min[i]) / (counts[i] - 1) as f64
        } else {
            1.0
        }
    });
    let cell: f64 = steps.iter().product();
    let part = |point: [usize; 3], axis: usize| {
        if axis < axes {
            share(point[axis], counts[axis])
        } else {
            1.0
        }
    };

    let grid = Grid::new(counts, dimension, |_| true);
    let points = grid.points();
    let positions: Vec<Vec3> = points
        .iter()
        .map(|point| {
            Vec3::from_fn(|i, _| {
                if i < axes {
                    between(min[i], max[i], point[i], counts[i])
                } else {
                    0.0
                }
            })
        })
        .collect();
    let volumes = points
        .iter()
        .map(|&point| cell * (0..axes).map(|axis| part(point, axis)).product::<f64>())
        .collect();
    // A bond inside has all its 2^(d−1) cells, each giving one of its d 2^(d−1) edges an equal
    // part: 1/d of a cell in all, and the fraction of the cells that exist near the boundary.
    let bonds = grid.bonds(|point, along| {
        let across = (0..axes).filter(|&axis| axis != along);
        cell / axes as f64 * across.map(|axis| part(point, axis)).product::<f64>()
    });

    let faces = shape.faces(dimension).iter().map(|&name| {
        let (axis, upper) = match (name, dimension) {
            ("left", _) => (0, false),
            ("right", _) => (0, true),
            ("front", _) | ("bottom", Dimension::PlaneStrain) => (1, false),
            ("back", _) | ("top", Dimension::PlaneStrain) => (1, true),
            ("bottom", Dimension::Solid) => (2, false),
            _ => (2, true),
        };
        let mut normal = Vec3::zeros();
        normal[axis] = if upper { 1.0 } else { -1.0 };
        let level = if upper { counts[axis] - 1 } else { 0 };
        let full: f64 = (0..3).filter(|&i| i != axis).map(|i| steps[i]).product();
        let areas = points
            .iter()
            .enumerate()
            .filter(|(_, point)| point[axis] == level)
            .map(|(node, &point)| {
                let across = (0..axes).filter(|&i| i != axis);
                FaceArea {
                    node: node as u32,
                    area: full * across.map(|i| part(point, i)).product::<f64>(),
                    normal,
                    point: positions[node],
                }
            })
            .collect();
        Face {
            name,
            kind: FaceKind::Surface(areas),
        }
    });

    let spacing = steps[..axes].iter().copied().fold(f64::INFINITY, f64::min);
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
        faces: faces.collect(),
        positions: positions.into(),
        shape,
    }
}
