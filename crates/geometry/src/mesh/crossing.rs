//! Where a surface cuts through itself.

use jstsph_tensor::Vec3;

use super::tree::Tree;

/// Part of the diagonal of the surface that is rounding: STL files have single precision.
const ROUNDING: f64 = 1e-6;

/// Overlaps of triangles in one plane that are thinner than so many roundings are none.
const THIN: f64 = 10.0;

/// Pairs of triangles that cut through or lie on each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelfIntersection {
    /// Number of pairs.
    pub count: usize,
    /// A common point of the first pair, m.
    pub at: Vec3,
}

/// Pairs of triangles with a common point that is not on the rim of both; only those in the tree.
pub(super) fn find(
    points: &[Vec3],
    triangles: &[[u32; 3]],
    tree: &Tree,
) -> Option<SelfIntersection> {
    let (low, high) = tree.bounds();
    let rounding = ROUNDING * (high - low).norm();
    let corners = |triangle: u32| triangles[triangle as usize].map(|point| points[point as usize]);
    let mut found: Option<SelfIntersection> = None;
    for first in 0..triangles.len() as u32 {
        let a = corners(first);
        if normal(&a) == Vec3::zeros() {
            continue;
        }
        let (low, high) = (a[0].inf(&a[1]).inf(&a[2]), a[0].sup(&a[1]).sup(&a[2]));
        tree.visit_box(&low, &high, &mut |second| {
            if second <= first {
                return;
            }
            if let Some(at) = common_point(&a, &corners(second), rounding) {
                found.get_or_insert(SelfIntersection { count: 0, at }).count += 1;
            }
        });
    }
    found
}

/// Unit normal, or zero.
fn normal([a, b, c]: &[Vec3; 3]) -> Vec3 {
    let normal = (b - a).cross(&(c - a));
    normal.try_normalize(0.0).unwrap_or_default()
}

fn common_point(a: &[Vec3; 3], b: &[Vec3; 3], rounding: f64) -> Option<Vec3> {
    let (of_a, of_b) = (normal(a), normal(b));
    let heights = |points: &[Vec3; 3], plane: &[Vec3; 3], normal: &Vec3| {
        points.map(|point| (point - plane[0]).dot(normal))
    };
    let (over_a, over_b) = (heights(b, a, &of_a), heights(a, b, &of_b));
    let is_flat = |heights: &[f64; 3]| heights.iter().all(|height| height.abs() <= rounding);
    if is_flat(&over_a) && is_flat(&over_b) {
        return overlap(a, b, &of_a, rounding);
    }
    through(a, &over_b, b, &of_b, rounding).or_else(|| through(b, &over_a, a, &of_a, rounding))
}

/// Where an edge of a triangle, whose corners have these heights over the plane of another, goes
/// through that other. Edges that only touch the plane do not, so that neighbours, which share
/// corners, need no exception.
fn through(
    triangle: &[Vec3; 3],
    heights: &[f64; 3],
    other: &[Vec3; 3],
    normal: &Vec3,
    rounding: f64,
) -> Option<Vec3> {
    (0..3).find_map(|edge| {
        let next = (edge + 1) % 3;
        let (from, to) = (heights[edge], heights[next]);
        if from.min(to) >= -rounding || from.max(to) <= rounding {
            return None;
        }
        let at = triangle[edge] + (from / (from - to)) * (triangle[next] - triangle[edge]);
        let is_inside = (0..3).all(|side| {
            let (begin, end) = (other[side], other[(side + 1) % 3]);
            (end - begin).cross(&(at - begin)).dot(normal) >= 0.0
        });
        is_inside.then_some(at)
    })
}

/// The middle of what two triangles in one plane have in common, unless it is thin.
fn overlap(a: &[Vec3; 3], b: &[Vec3; 3], normal: &Vec3, rounding: f64) -> Option<Vec3> {
    let mut common = a.to_vec();
    // The other may be turned the other way round.
    let turn = (b[1] - b[0]).cross(&(b[2] - b[0])).dot(normal).signum();
    for side in 0..3 {
        let (begin, end) = (b[side], b[(side + 1) % 3]);
        let inside = |x: &Vec3| turn * (end - begin).cross(&(x - begin)).dot(normal);
        let mut left = Vec::with_capacity(common.len() + 1);
        for (place, x) in common.iter().enumerate() {
            let next = &common[(place + 1) % common.len()];
            let (here, there) = (inside(x), inside(next));
            if here >= 0.0 {
                left.push(*x);
            }
            if here * there < 0.0 {
                left.push(x + (here / (here - there)) * (next - x));
            }
        }
        common = left;
        if common.len() < 3 {
            return None;
        }
    }
    let fan = common[1..].windows(2);
    let area: f64 = fan
        .map(|pair| 0.5 * (pair[0] - common[0]).cross(&(pair[1] - common[0])).norm())
        .sum();
    let reach = |x: &Vec3| (x - common[0]).norm();
    let longest = common.iter().map(reach).fold(0.0, f64::max);
    let middle = common.iter().sum::<Vec3>() / common.len() as f64;
    (area > THIN * rounding * longest).then_some(middle)
}
