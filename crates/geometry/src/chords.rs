//! Where a line along x runs inside a shape: the basis of volumes that need no other knowledge of
//! it.

use jstsph_tensor::Vec3;

use crate::{Axis, Dimension, Shape};

/// Parts of a line, ascending and disjoint, m.
pub(crate) type Chords = Vec<[f64; 2]>;

/// The parts of the line through (·, y, z) that lie in the shape; z is ignored in plane strain.
pub(crate) fn chords(shape: &Shape, y: f64, z: f64, dimension: Dimension) -> Chords {
    let within = |low: f64, value: f64, high: f64| low <= value && value <= high;
    let round = |centre: f64, radius: f64, squares: f64| {
        let half = radius * radius - squares;
        if half > 0.0 {
            vec![[centre - half.sqrt(), centre + half.sqrt()]]
        } else {
            Vec::new()
        }
    };
    match shape {
        Shape::Box { min, max } => {
            let in_z = dimension == Dimension::PlaneStrain || within(min.z, z, max.z);
            if in_z && within(min.y, y, max.y) {
                vec![[min.x, max.x]]
            } else {
                Vec::new()
            }
        }
        Shape::Disc { centre, radius } => round(centre.x, *radius, (y - centre.y).powi(2)),
        Shape::Sphere { centre, radius } => round(
            centre.x,
            *radius,
            (y - centre.y).powi(2) + (z - centre.z).powi(2),
        ),
        Shape::Cylinder {
            base,
            axis,
            radius,
            height,
        } => {
            let (dy, dz) = (y - base.y, z - base.z);
            match axis {
                Axis::X if dy.hypot(dz) <= *radius => vec![[base.x, base.x + height]],
                Axis::Y if within(0.0, dy, *height) => round(base.x, *radius, dz * dz),
                Axis::Z if within(0.0, dz, *height) => round(base.x, *radius, dy * dy),
                _ => Vec::new(),
            }
        }
        Shape::Polygon(polygon) => match polygon.extrusion() {
            Some([low, high]) if !within(low, z, high) => Vec::new(),
            _ => pairs(&polygon.crossings(y)),
        },
        Shape::Mesh(mesh) => pairs(&mesh.crossings(y, z)),
        Shape::Union(parts) => parts
            .iter()
            .map(|part| chords(part, y, z, dimension))
            .fold(Vec::new(), |all, part| union(all, &part)),
        Shape::Intersection(parts) => {
            let mut parts = parts.iter().map(|part| chords(part, y, z, dimension));
            let first = parts.next().unwrap_or_default();
            parts.fold(first, |all, part| intersection(&all, &part))
        }
        Shape::Difference(parts) => {
            let mut parts = parts.iter().map(|part| chords(part, y, z, dimension));
            let first = parts.next().unwrap_or_default();
            parts.fold(first, |all, part| without(&all, &part))
        }
    }
}

/// Entries and exits, in turn.
pub(crate) fn pairs(crossings: &[f64]) -> Chords {
    crossings
        .chunks_exact(2)
        .map(|pair| [pair[0], pair[1]])
        .filter(|[from, to]| from < to)
        .collect()
}

fn union(mut all: Chords, part: &[[f64; 2]]) -> Chords {
    all.extend_from_slice(part);
    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut joined: Chords = Vec::with_capacity(all.len());
    for [from, to] in all {
        match joined.last_mut() {
            Some(last) if from <= last[1] => last[1] = last[1].max(to),
            _ => joined.push([from, to]),
        }
    }
    joined
}

fn intersection(a: &[[f64; 2]], b: &[[f64; 2]]) -> Chords {
    let mut common = Vec::new();
    for [from, to] in a {
        for [other_from, other_to] in b {
            let (from, to) = (from.max(*other_from), to.min(*other_to));
            if from < to {
                common.push([from, to]);
            }
        }
    }
    common
}

/// What is in the first but not in the second.
pub(crate) fn without(a: &[[f64; 2]], b: &[[f64; 2]]) -> Chords {
    intersection(a, &complement(b))
}

fn complement(part: &[[f64; 2]]) -> Chords {
    let mut gaps = Vec::with_capacity(part.len() + 1);
    let mut from = f64::NEG_INFINITY;
    for [start, end] in part {
        gaps.push([from, *start]);
        from = *end;
    }
    gaps.push([from, f64::INFINITY]);
    gaps
}

/// Panels between two marks to begin with, and how often each may be halved.
const PANELS: usize = 8;
const HALVINGS: u32 = 24;

/// Panels whose Simpson and trapezoidal rules differ by less than this part of the bounding box
/// are not halved.
const ACCURACY: f64 = 1e-7;

/// Volume of any shape (area in plane strain) from its chords.
///
/// The chord length is integrated over y and z by an adaptive Simpson rule between the faces,
/// corners and poles of the parts. Exact to round-off for boxes along the axes and for plane
/// polygons; the relative error of round parts is a few 1e-6.
pub(crate) fn volume(shape: &Shape, dimension: Dimension) -> f64 {
    let (size, [along_y, along_z]) = extent(shape);
    let section = |z: f64| {
        let length = |y: f64| total(&chords(shape, y, z, dimension));
        integrate(&length, &along_y, ACCURACY * size.x * size.y)
    };
    match dimension {
        Dimension::PlaneStrain => section(0.0),
        Dimension::Solid => integrate(&section, &along_z, ACCURACY * size.x * size.y * size.z),
    }
}

/// Area of the section of the shape by the plane on which coordinate `axis` has this value (of 1 m
/// thickness in plane strain), as accurate as [`volume`].
pub(crate) fn section_area(shape: &Shape, dimension: Dimension, axis: usize, value: f64) -> f64 {
    let (size, [along_y, along_z]) = extent(shape);
    let tolerance = ACCURACY * size.y;
    let is_crossed = |y: f64, z: f64| {
        let chords = chords(shape, y, z, dimension);
        f64::from(u8::from(
            chords
                .iter()
                .any(|[from, to]| *from <= value && value <= *to),
        ))
    };
    match (axis, dimension) {
        (0, Dimension::PlaneStrain) => integrate(&|y| is_crossed(y, 0.0), &along_y, tolerance),
        (0, Dimension::Solid) => {
            let height = |z: f64| integrate(&|y| is_crossed(y, z), &along_y, tolerance);
            integrate(&height, &along_z, tolerance * size.z)
        }
        (1, Dimension::PlaneStrain) => total(&chords(shape, value, 0.0, dimension)),
        (1, Dimension::Solid) => {
            let length = |z: f64| total(&chords(shape, value, z, dimension));
            integrate(&length, &along_z, ACCURACY * size.x * size.z)
        }
        _ => {
            let length = |y: f64| total(&chords(shape, y, value, dimension));
            integrate(&length, &along_y, tolerance * size.x)
        }
    }
}

fn total(chords: &[[f64; 2]]) -> f64 {
    chords.iter().map(|[from, to]| to - from).sum()
}

/// Size of the bounding box, and the marks along y and z in it.
fn extent(shape: &Shape) -> (Vec3, [Vec<f64>; 2]) {
    let (low, high) = shape.bounds();
    let mut marks = [Vec::new(), Vec::new()];
    collect_marks(shape, &mut marks);
    for (marks, axis) in marks.iter_mut().zip([1, 2]) {
        marks.retain(|&mark| low[axis] <= mark && mark <= high[axis]);
        marks.extend([low[axis], high[axis]]);
        marks.sort_by(f64::total_cmp);
        marks.dedup();
    }
    (high - low, marks)
}

/// Integral between the first and the last mark; the function may jump at the marks.
fn integrate(function: &dyn Fn(f64) -> f64, marks: &[f64], tolerance: f64) -> f64 {
    let mut sum = 0.0;
    for ends in marks.windows(2) {
        let width = (ends[1] - ends[0]) / PANELS as f64;
        // Just inside of the marks, where the function belongs to this interval.
        let inside = |x: f64| {
            let margin = 1e-12 * (ends[1] - ends[0]);
            function(x.clamp(ends[0] + margin, ends[1] - margin))
        };
        let mut values = [inside(ends[0]), 0.0];
        for panel in 0..PANELS {
            let from = ends[0] + panel as f64 * width;
            values[1] = inside(from + width);
            let panel = Panel {
                from,
                width,
                values,
            };
            sum += panel.integrate(&inside, tolerance, HALVINGS);
            values[0] = values[1];
        }
    }
    sum
}

/// A piece of the integral with the values at its ends.
struct Panel {
    from: f64,
    width: f64,
    values: [f64; 2],
}

impl Panel {
    fn integrate(&self, function: &dyn Fn(f64) -> f64, tolerance: f64, halvings: u32) -> f64 {
        let half = 0.5 * self.width;
        let [first, last] = self.values;
        let middle = function(self.from + half);
        let bend = (first - 2.0 * middle + last).abs() * self.width;
        if bend <= tolerance || halvings == 0 {
            return (first + 4.0 * middle + last) / 6.0 * self.width;
        }
        let part = |from: f64, values: [f64; 2]| {
            let panel = Self {
                from,
                width: half,
                values,
            };
            panel.integrate(function, tolerance, halvings - 1)
        };
        part(self.from, [first, middle]) + part(self.from + half, [middle, last])
    }
}

/// Coordinates y and z at which the section of a part may change its kind.
fn collect_marks(shape: &Shape, marks: &mut [Vec<f64>; 2]) {
    match shape {
        Shape::Union(parts) | Shape::Intersection(parts) | Shape::Difference(parts) => {
            parts.iter().for_each(|part| collect_marks(part, marks));
        }
        Shape::Polygon(polygon) => {
            marks[0].extend(polygon.points().iter().map(|point| point[1]));
            marks[1].extend(polygon.extrusion().into_iter().flatten());
        }
        _ => {
            let (low, high) = shape.bounds();
            marks[0].extend([low.y, high.y]);
            marks[1].extend([low.z, high.z]);
        }
    }
}

/// Whether a place is in the shape or at most `tolerance` outside.
pub(crate) fn contains(shape: &Shape, x: &Vec3, tolerance: f64) -> bool {
    shape.signed_distance(x) <= tolerance
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn cube(min: f64, max: f64) -> Shape {
        Shape::Box {
            min: Vec3::repeat(min),
            max: Vec3::repeat(max),
        }
    }

    #[test]
    fn chords_of_combinations_follow_set_algebra() {
        let parts = || vec![cube(0.0, 2.0), cube(1.0, 3.0)];
        let at = |shape: &Shape| chords(shape, 1.5, 1.5, Dimension::Solid);
        assert_eq!(at(&Shape::Union(parts())), [[0.0, 3.0]]);
        assert_eq!(at(&Shape::Intersection(parts())), [[1.0, 2.0]]);
        assert_eq!(at(&Shape::Difference(parts())), [[0.0, 1.0]]);
        let apart = Shape::Union(vec![cube(2.0, 3.0), cube(0.0, 1.0)]);
        assert!(chords(&apart, 1.5, 1.5, Dimension::Solid).is_empty());
    }

    /// Ten times what is measured would still be far below the error of any lattice.
    const ROUND_ERROR: f64 = 5e-6;

    fn assert_volume(shape: &Shape, exact: f64) {
        let error = volume(shape, Dimension::Solid) / exact - 1.0;
        assert!(error.abs() < ROUND_ERROR, "{shape:?}: {error:e}");
    }

    #[test]
    fn volumes_of_round_parts_are_as_accurate_as_stated() {
        let ball = |x: f64| Shape::Sphere {
            centre: Vec3::new(x, 0.2, 0.3),
            radius: 1.0,
        };
        assert_volume(&ball(0.1), 4.0 / 3.0 * PI);
        // Two unit spheres at distance 1 share a lens of 5π/12.
        let lens = 5.0 / 12.0 * PI;
        let both = || vec![ball(0.0), ball(1.0)];
        assert_volume(&Shape::Intersection(both()), lens);
        assert_volume(&Shape::Union(both()), 8.0 / 3.0 * PI - lens);
        for axis in [Axis::X, Axis::Y, Axis::Z] {
            let mut base = Vec3::repeat(0.5);
            base[axis.index()] = 0.0;
            let hole = Shape::Cylinder {
                base,
                axis,
                radius: 0.3,
                height: 1.0,
            };
            let exact = PI * 0.09;
            assert_volume(&hole, exact);
            assert_volume(&Shape::Difference(vec![cube(0.0, 1.0), hole]), 1.0 - exact);
        }
    }

    #[test]
    fn volumes_of_boxes_are_exact() {
        let ell = Shape::Union(vec![
            Shape::Box {
                min: Vec3::zeros(),
                max: Vec3::new(6.0, 3.0, 3.0),
            },
            Shape::Box {
                min: Vec3::zeros(),
                max: Vec3::new(3.0, 10.0, 3.0),
            },
        ]);
        assert!((volume(&ell, Dimension::Solid) / 117.0 - 1.0).abs() < 1e-13);
    }
}
