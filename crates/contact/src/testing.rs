//! What the tests of several files need: chains with known answers and brute-force distances.

use proptest::prelude::*;

use crate::fillet::Path;
use crate::{Chain, Profile, Side, Surface};

/// The two walls of the equal channel angular extrusion die, 8 mm apart. Greto & Kulasegaram
/// 2019, Sect. 4.3, clear length 24 mm between the vertical channels.
pub(crate) fn ecae_die() -> Surface {
    let lower = Chain::new(
        &[[0.0, 0.08], [0.0, 0.0], [0.032, 0.0], [0.032, -0.06]],
        &[0.0, 1.5e-3, 1.0e-3, 0.0],
        false,
        Side::Left,
    );
    let upper = Chain::new(
        &[
            [0.008, 0.08],
            [0.008, 0.008],
            [0.040, 0.008],
            [0.040, -0.06],
        ],
        &[0.0, 1.0e-3, 1.5e-3, 0.0],
        false,
        Side::Right,
    );
    let profile = Profile::new(vec![lower.unwrap(), upper.unwrap()]).unwrap();
    Surface::Profile(profile)
}

/// A chain as it is given to [`Chain::new`].
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    pub(crate) points: Vec<[f64; 2]>,
    pub(crate) fillets: Vec<f64>,
    pub(crate) closed: bool,
    pub(crate) free_side: Side,
}

impl Outline {
    pub(crate) fn chain(&self) -> Chain {
        Chain::new(&self.points, &self.fillets, self.closed, self.free_side).unwrap()
    }

    /// Signed distance by going through a fine polyline; off by at most `SAMPLING_ERROR`.
    pub(crate) fn brute_force(&self, x: [f64; 2]) -> f64 {
        let path = Path::new(&self.points, &self.fillets, self.closed, self.free_side).unwrap();
        let mut line = path.polyline(0.01);
        let left = if self.closed {
            let signed_area: f64 = line
                .windows(2)
                .map(|w| w[0][0] * w[1][1] - w[0][1] * w[1][0])
                .sum();
            let inside = line.windows(2).filter(|w| crosses(w, x)).count() % 2 == 1;
            inside == (signed_area > 0.0)
        } else {
            let (first, last) = (line[0], line[line.len() - 1]);
            let [before, after] = [path.tangents[0], path.tangents[path.tangents.len() - 1]];
            line.insert(
                0,
                [first[0] - 99.0 * before[0], first[1] - 99.0 * before[1]],
            );
            line.push([last[0] + 99.0 * after[0], last[1] + 99.0 * after[1]]);
            // Our open chains are graphs over the first axis: left of one that runs to the right
            // is above it, which a vertical ray crosses an odd number of times downwards.
            let below = line
                .windows(2)
                .filter(|w| crosses(&[flip(w[0]), flip(w[1])], flip(x)));
            let above = below.count() % 2 == 0;
            above == (last[0] > first[0])
        };
        let distance = line
            .windows(2)
            .map(|w| to_segment(w[0], w[1], x))
            .fold(f64::INFINITY, f64::min);
        if left { distance } else { -distance }
    }
}

/// Sagitta of a piece of 0.01 rad of an arc of radius 1 (the largest the strategies make is 4).
pub(crate) const SAMPLING_ERROR: f64 = 4.0 * 0.01 * 0.01 / 8.0;

fn flip([x, y]: [f64; 2]) -> [f64; 2] {
    [y, x]
}

/// Whether the ray from x along +x crosses a segment.
fn crosses(segment: &[[f64; 2]], x: [f64; 2]) -> bool {
    let [a, b] = [segment[0], segment[1]];
    (a[1] > x[1]) != (b[1] > x[1]) && x[0] < a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
}

fn to_segment(a: [f64; 2], b: [f64; 2], x: [f64; 2]) -> f64 {
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    let squared = dx * dx + dy * dy;
    let part = if squared > 0.0 {
        (((x[0] - a[0]) * dx + (x[1] - a[1]) * dy) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (x[0] - a[0] - part * dx).hypot(x[1] - a[1] - part * dy)
}

/// The largest fillet radius at a corner that takes at most half of both edges, up to 4.
fn half_fillet(before: [f64; 2], at: [f64; 2], after: [f64; 2]) -> f64 {
    let [a, b] = [
        [at[0] - before[0], at[1] - before[1]],
        [after[0] - at[0], after[1] - at[1]],
    ];
    let turn = f64::atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]).abs();
    let shorter = a[0].hypot(a[1]).min(b[0].hypot(b[1]));
    (0.5 * shorter / (0.5 * turn).tan()).min(4.0)
}

/// Adds fillets, a third of them sharp, a third of the largest size.
fn with_fillets(points: Vec<[f64; 2]>, sizes: &[f64], closed: bool, free_side: Side) -> Outline {
    let count = points.len();
    let fillets = (0..count)
        .map(|i| {
            if !closed && (i == 0 || i == count - 1) {
                return 0.0;
            }
            let neighbours = [points[(i + count - 1) % count], points[(i + 1) % count]];
            let size = (3.0 * sizes[i] - 1.0).clamp(0.0, 1.0);
            size * half_fillet(neighbours[0], points[i], neighbours[1])
        })
        .collect();
    Outline {
        points,
        fillets,
        closed,
        free_side,
    }
}

fn side() -> impl Strategy<Value = Side> {
    prop_oneof![Just(Side::Left), Just(Side::Right)]
}

/// Star-shaped closed chains around the origin, radius 0.3 to 1, convex and reentrant corners, in
/// both directions, free inside or outside; up to more than two blocks of segments.
pub(crate) fn closed_outline() -> impl Strategy<Value = Outline> {
    let corners = prop::collection::vec((0.3..1.0, -0.4..0.4, 0.0..1.0), 3..24);
    (corners, any::<bool>(), side()).prop_map(|(corners, backwards, free_side)| {
        let count = corners.len() as f64;
        let mut points: Vec<[f64; 2]> = (0_u32..)
            .zip(&corners)
            .map(|(i, (radius, jitter, _))| {
                let angle: f64 = std::f64::consts::TAU * (f64::from(i) + jitter) / count;
                [radius * angle.cos(), radius * angle.sin()]
            })
            .collect();
        if backwards {
            points.reverse();
        }
        let sizes: Vec<f64> = corners.iter().map(|corner| corner.2).collect();
        with_fillets(points, &sizes, true, free_side)
    })
}

/// Open chains that are graphs over the first axis, roughly from -1 to 1, in both directions.
pub(crate) fn open_outline() -> impl Strategy<Value = Outline> {
    let corners = prop::collection::vec((-0.4..0.4, -0.5..0.5, 0.0..1.0), 2..24);
    (corners, any::<bool>(), side()).prop_map(|(corners, backwards, free_side)| {
        let spacing = 2.0 / corners.len() as f64;
        let mut points: Vec<[f64; 2]> = (0_u32..)
            .zip(&corners)
            .map(|(i, (jitter, height, _))| [(f64::from(i) + jitter) * spacing - 1.0, *height])
            .collect();
        if backwards {
            points.reverse();
        }
        let sizes: Vec<f64> = corners.iter().map(|corner| corner.2).collect();
        with_fillets(points, &sizes, false, free_side)
    })
}
