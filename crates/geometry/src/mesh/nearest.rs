//! One triangle: its nearest point, and where a line crosses it.

use jstsph_tensor::Vec3;

/// What of a triangle is nearest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Feature {
    Face,
    /// Edge a–b, b–c or c–a.
    Edge(usize),
    Corner(usize),
}

/// Nearest point of a triangle and where on it that lies.
///
/// Source: C. Ericson, Real-Time Collision Detection, 2005, Sect. 5.1.5.
pub(super) fn on_triangle(x: &Vec3, [a, b, c]: [Vec3; 3]) -> (Vec3, Feature) {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(&(x - a)), ac.dot(&(x - a)));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, Feature::Corner(0));
    }
    let (d3, d4) = (ab.dot(&(x - b)), ac.dot(&(x - b)));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, Feature::Corner(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + d1 / (d1 - d3) * ab, Feature::Edge(0));
    }
    let (d5, d6) = (ab.dot(&(x - c)), ac.dot(&(x - c)));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, Feature::Corner(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + d2 / (d2 - d6) * ac, Feature::Edge(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let part = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return (b + part * (c - b), Feature::Edge(1));
    }
    let sum = va + vb + vc;
    (a + vb / sum * ab + vc / sum * ac, Feature::Face)
}

/// Where the line along x through (·, y, z) crosses a triangle.
///
/// A line through an edge or corner belongs to one of the triangles there, as if it were moved a
/// little towards +y, and less towards +z: lines enter a closed surface as often as they leave it.
pub(super) fn crossing(points: &[Vec3], corners: [u32; 3], y: f64, z: f64) -> Option<f64> {
    let mut sides = [0.0; 3];
    let mut positive = 0;
    for side in 0..3 {
        let (from, to) = (corners[(side + 1) % 3], corners[(side + 2) % 3]);
        // Always computed from the lower to the higher point: triangles at an edge agree.
        let (low, high) = (from.min(to), from.max(to));
        let (a, b) = (points[low as usize], points[high as usize]);
        let (dy, dz) = (b.y - a.y, b.z - a.z);
        let area = dy * (z - a.z) - dz * (y - a.y);
        let is_left = [area, -dz, dy]
            .into_iter()
            .find(|&value| value != 0.0)
            .is_some_and(|value| value > 0.0);
        let is_swapped = from > to;
        sides[side] = if is_swapped { -area } else { area };
        positive += usize::from(is_left != is_swapped);
    }
    let sum: f64 = sides.iter().sum();
    if (positive != 0 && positive != 3) || sum == 0.0 {
        return None;
    }
    let terms = (0..3).map(|i| sides[i] / sum * points[corners[i] as usize].x);
    Some(terms.sum())
}
