//! From single lines to connected ones.

use crate::{Contour, GeometryError};

/// Part of the tolerance below which a piece is left out: what is left of it is rounding.
const ROUNDING: f64 = 1e-6;

/// Joins open lines whose ends lie within the tolerance (m) of each other.
pub(super) fn join(lines: Vec<Contour>, tolerance: f64) -> Result<Vec<Contour>, GeometryError> {
    let (mut joined, open): (Vec<_>, Vec<_>) = lines.into_iter().partition(|line| line.is_closed());
    // Lines that are as short as a gap are part of it.
    let open: Vec<Contour> = open
        .into_iter()
        .filter(|line| {
            let points = line.polyline(1.0);
            points.iter().any(|p| distance(p, &points[0]) > tolerance)
        })
        .collect();
    let partners = partners(&open, tolerance)?;
    let mut is_used = vec![false; open.len()];
    // What has free ends begins at one; the rest is closed and begins anywhere.
    let free = (0..2 * open.len()).filter(|end| partners[*end].is_none());
    for first in free.chain(0..2 * open.len()) {
        if is_used[first / 2] {
            continue;
        }
        let (mut points, mut bulges): (Vec<[f64; 2]>, Vec<f64>) = (Vec::new(), Vec::new());
        let mut end = first;
        let closed = loop {
            is_used[end / 2] = true;
            let (mut line, mut bent) = open[end / 2].clone().into_parts();
            if end % 2 == 1 {
                line.reverse();
                bent.reverse();
                bent.iter_mut().for_each(|bulge| *bulge = -*bulge);
            }
            // The place where two lines meet is the end of the first.
            let known = usize::from(!points.is_empty());
            points.extend(&line[known..]);
            bulges.extend(bent);
            match partners[end ^ 1] {
                None => break false,
                Some(next) if next == first => break true,
                Some(next) => end = next,
            }
        };
        if closed {
            points.pop();
        }
        joined.push(Contour::new(points, bulges, closed)?);
    }
    joined
        .into_iter()
        .map(|line| without_stubs(line, ROUNDING * tolerance))
        .filter(|line| line.as_ref().is_ok_and(|line| !line.bulges().is_empty()) || line.is_err())
        .collect()
}

fn distance(a: &[f64; 2], b: &[f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The end that meets each end: 2k is the begin of line k, 2k + 1 its end.
fn partners(open: &[Contour], tolerance: f64) -> Result<Vec<Option<usize>>, GeometryError> {
    let place = |end: usize| {
        let points = open[end / 2].points();
        points[if end.is_multiple_of(2) {
            0
        } else {
            points.len() - 1
        }]
    };
    let mut order: Vec<usize> = (0..2 * open.len()).collect();
    order.sort_by(|&a, &b| place(a)[0].total_cmp(&place(b)[0]));
    let mut met: Vec<Vec<usize>> = vec![Vec::new(); order.len()];
    for (number, &end) in order.iter().enumerate() {
        let reach = place(end)[0] + tolerance;
        let near = order[number + 1..]
            .iter()
            .take_while(|&&other| place(other)[0] <= reach);
        for &other in near {
            if distance(&place(end), &place(other)) <= tolerance {
                met[end].push(other);
                met[other].push(end);
            }
        }
    }
    if let Some(end) = (0..met.len()).find(|&end| met[end].len() > 1) {
        return Err(GeometryError::BranchingContour {
            count: met[end].len() + 1,
            at: place(end),
            tolerance,
        });
    }
    Ok(met.iter().map(|others| others.first().copied()).collect())
}

/// Without pieces of almost no length.
fn without_stubs(line: Contour, shortest: f64) -> Result<Contour, GeometryError> {
    let closed = line.is_closed();
    let (mut points, mut bulges) = (Vec::new(), Vec::new());
    for (from, to, bulge) in line.pieces() {
        if distance(&from, &to) > shortest {
            points.push(from);
            bulges.push(bulge);
        }
    }
    if !closed {
        points.extend(line.points().last());
    }
    Contour::new(points, bulges, closed)
}
