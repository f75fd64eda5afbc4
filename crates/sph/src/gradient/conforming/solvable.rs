//! What of a defect the rows can make good.

use jstsph_tensor::{Mat3, Vec3};

use super::Fit;

/// Singular values below this part of the largest count as zero: the boundary of a group lies in a plane
/// or on a line.
const RANK_TOLERANCE: f64 = 1e-9;

/// Takes from the defect what no change of the rows can meet.
///
/// Every row keeps constants and linears exact, so that over a connected group of rows Σ_c d_c and
/// Σ_c X_c ⊗ d_c cannot change: a defect d has a solution only if both vanish. Each group gives up the part
/// w_c (a + M (X_c − X̄)) that makes them vanish, with w the size of the wanted vector: the surface is moved
/// a little, nothing else is. `weights` is zero away from the boundary; groups without any are left as they
/// are.
pub(super) fn make_solvable(
    defect: &mut [Vec3],
    weights: &[f64],
    rows: &[Fit<'_>],
    positions: &[Vec3],
    plane: bool,
) {
    for group in groups(rows, defect.len()) {
        let total: f64 = group.iter().map(|&c| weights[c]).sum();
        if total <= 0.0 {
            continue;
        }
        let weighted = group.iter().map(|&c| positions[c] * weights[c]);
        let middle = weighted.sum::<Vec3>() / total;
        let sum: Vec3 = group.iter().map(|&c| defect[c]).sum();
        let (mut moment, mut spread) = (Mat3::zeros(), Mat3::zeros());
        for &c in &group {
            let arm = positions[c] - middle;
            moment += defect[c] * arm.transpose();
            spread += arm * arm.transpose() * weights[c];
        }
        if plane {
            moment *= Mat3::from_diagonal(&Vec3::new(1.0, 1.0, 0.0));
        }
        let tolerance = RANK_TOLERANCE * spread.norm();
        let inverse = spread
            .pseudo_inverse(tolerance)
            .unwrap_or_else(|_| Mat3::zeros());
        let (constant, slope) = (sum / total, moment * inverse);
        for &c in &group {
            defect[c] -= (constant + slope * (positions[c] - middle)) * weights[c];
        }
    }
}

/// Particles that share rows, directly or through others, in ascending order.
fn groups(rows: &[Fit<'_>], particles: usize) -> Vec<Vec<usize>> {
    let mut parent: Vec<u32> = (0..particles as u32).collect();
    fn root(parent: &mut [u32], mut c: u32) -> u32 {
        while parent[c as usize] != c {
            parent[c as usize] = parent[parent[c as usize] as usize];
            c = parent[c as usize];
        }
        c
    }
    let mut is_reached = vec![false; particles];
    for row in rows {
        if row.row.is_empty() {
            continue;
        }
        let first = root(&mut parent, row.row.first as u32);
        let mut lowest = first;
        for c in row.row.indices() {
            is_reached[c] = true;
            let other = root(&mut parent, c as u32);
            let low = lowest.min(other);
            parent[lowest as usize] = low;
            parent[other as usize] = low;
            lowest = low;
        }
    }
    let mut number = vec![usize::MAX; particles];
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for c in (0..particles).filter(|&c| is_reached[c]) {
        let top = root(&mut parent, c as u32) as usize;
        if number[top] == usize::MAX {
            number[top] = groups.len();
            groups.push(Vec::new());
        }
        groups[number[top]].push(c);
    }
    groups
}
