//! Polylines of surfaces, for pictures.

use std::f64::consts::TAU;

use jstsph_tensor::Vec3;

use crate::{Chain, solid};

/// Straight pieces of a drawn circle.
const CIRCLE_PIECES: usize = 48;

/// A chain in the plane z = 0, its open ends extended to the border of the bounds.
pub(crate) fn chain(chain: &Chain, bounds: &[Vec3; 2]) -> Vec<Vec3> {
    let (polyline, directions) = chain.drawing();
    let mut line: Vec<Vec3> = polyline
        .iter()
        .map(|&[x, y]| Vec3::new(x, y, 0.0))
        .collect();
    if let Some([before, after]) = directions {
        let (first, last) = (line[0], line[line.len() - 1]);
        if let Some(point) = leave(&first, before, bounds) {
            line.insert(0, point);
        }
        line.extend(leave(&last, after, bounds));
    }
    line
}

/// Where a ray in the x-y plane leaves the bounds, if it meets them ahead of its start.
fn leave(start: &Vec3, direction: [f64; 2], bounds: &[Vec3; 2]) -> Option<Vec3> {
    let (mut enter, mut exit) = (0.0_f64, f64::INFINITY);
    for axis in 0..2 {
        let to_min = bounds[0][axis] - start[axis];
        let to_max = bounds[1][axis] - start[axis];
        if direction[axis] == 0.0 {
            if to_min > 0.0 || to_max < 0.0 {
                return None;
            }
        } else {
            let (a, b) = (to_min / direction[axis], to_max / direction[axis]);
            enter = enter.max(a.min(b));
            exit = exit.min(a.max(b));
        }
    }
    (exit > enter).then(|| start + exit * Vec3::new(direction[0], direction[1], 0.0))
}

/// The polygon in which a plane cuts the bounds; a line if they are flat. Empty if it misses them.
pub(crate) fn plane(point: &Vec3, normal: &Vec3, bounds: &[Vec3; 2]) -> Vec<Vec<Vec3>> {
    let extent = (bounds[1] - bounds[0]).norm();
    let mut corners: Vec<Vec3> = Vec::new();
    for axis in 0..3 {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        for edge in 0..4 {
            let mut from = bounds[0];
            from[u] = bounds[edge & 1][u];
            from[v] = bounds[edge >> 1][v];
            let mut to = from;
            to[axis] = bounds[1][axis];
            let (a, b) = ((from - point).dot(normal), (to - point).dot(normal));
            if a * b > 0.0 || a == b {
                continue;
            }
            let cut = from + (a / (a - b)) * (to - from);
            // Cuts through a corner of the box are found on three edges.
            if corners
                .iter()
                .all(|other| (other - cut).norm() > 1e-9 * extent)
            {
                corners.push(cut);
            }
        }
    }
    if corners.len() < 2 {
        return Vec::new();
    }
    let middle = corners.iter().sum::<Vec3>() / corners.len() as f64;
    let e1 = solid::across(normal);
    let e2 = normal.cross(&e1);
    let angle = |corner: &Vec3| (corner - middle).dot(&e2).atan2((corner - middle).dot(&e1));
    corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    if corners.len() > 2 {
        corners.push(corners[0]);
    }
    vec![corners]
}

/// Three great circles.
pub(crate) fn sphere(centre: &Vec3, radius: f64) -> Vec<Vec<Vec3>> {
    [Vec3::x(), Vec3::y(), Vec3::z()]
        .iter()
        .map(|axis| circle(centre, axis, radius))
        .collect()
}

/// Two circles and four lines.
pub(crate) fn cylinder(
    point: &Vec3,
    axis: &Vec3,
    radius: f64,
    half_length: Option<f64>,
    bounds: &[Vec3; 2],
) -> Vec<Vec<Vec3>> {
    let (low, high) = match half_length {
        Some(half) => (-half, half),
        None => {
            // The corners of the bounds along the axis.
            let along = |pick: fn(f64, f64) -> f64| -> f64 {
                let part = |i: usize| {
                    let ends = [bounds[0][i] - point[i], bounds[1][i] - point[i]];
                    pick(ends[0] * axis[i], ends[1] * axis[i])
                };
                part(0) + part(1) + part(2)
            };
            (along(f64::min), along(f64::max))
        }
    };
    let [bottom, top] = [low, high].map(|end| circle(&(point + end * axis), axis, radius));
    let line = |quarter: usize| {
        let index = quarter * CIRCLE_PIECES / 4;
        vec![bottom[index], top[index]]
    };
    let lines = [line(0), line(1), line(2), line(3)];
    [bottom, top].into_iter().chain(lines).collect()
}

fn circle(centre: &Vec3, axis: &Vec3, radius: f64) -> Vec<Vec3> {
    let e1 = solid::across(axis);
    let e2 = axis.cross(&e1);
    (0..=CIRCLE_PIECES)
        .map(|piece| {
            // The last point is the first, to the bit.
            let (sin, cos) =
                (TAU * (piece % CIRCLE_PIECES) as f64 / CIRCLE_PIECES as f64).sin_cos();
            centre + radius * (cos * e1 + sin * e2)
        })
        .collect()
}

/// Bottom, top, and the four edges between them.
pub(crate) fn cuboid(min: &Vec3, max: &Vec3) -> Vec<Vec<Vec3>> {
    let corner = |index: usize, z: f64| {
        let x = if index == 1 || index == 2 {
            max.x
        } else {
            min.x
        };
        let y = if index == 2 || index == 3 {
            max.y
        } else {
            min.y
        };
        Vec3::new(x, y, z)
    };
    let ring = |z: f64| (0..=4).map(|index| corner(index % 4, z)).collect();
    let mut lines = vec![ring(min.z), ring(max.z)];
    lines.extend((0..4).map(|index| vec![corner(index, min.z), corner(index, max.z)]));
    lines
}

#[cfg(test)]
mod tests;
