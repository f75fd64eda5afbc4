//! Clipping of lines to a rectangle.

use super::canvas::Rect;

/// The parts of a polyline inside a rectangle, each as long as possible.
pub(crate) fn polyline(points: &[[f64; 2]], rect: &Rect) -> Vec<Vec<[f64; 2]>> {
    let mut parts: Vec<Vec<[f64; 2]>> = Vec::new();
    for pair in points.windows(2) {
        let Some([from, to]) = segment(pair[0], pair[1], rect) else {
            continue;
        };
        match parts.last_mut() {
            Some(part) if part.last() == Some(&from) => part.push(to),
            _ => parts.push(vec![from, to]),
        }
    }
    parts
}

/// The part of a segment inside a rectangle (Liang and Barsky 1984).
fn segment(from: [f64; 2], to: [f64; 2], rect: &Rect) -> Option<[[f64; 2]; 2]> {
    let delta = [to[0] - from[0], to[1] - from[1]];
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (slope, room) in [
        (-delta[0], from[0] - rect.left),
        (delta[0], rect.right - from[0]),
        (-delta[1], from[1] - rect.top),
        (delta[1], rect.bottom - from[1]),
    ] {
        if slope == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if slope < 0.0 {
            enter = enter.max(room / slope);
        } else {
            leave = leave.min(room / slope);
        }
    }
    // Ends that need no clipping stay bit-equal, so that neighbouring segments still join.
    let at = |t: f64| match t {
        0.0 => from,
        1.0 => to,
        _ => [from[0] + t * delta[0], from[1] + t * delta[1]],
    };
    (enter <= leave).then(|| [at(enter), at(leave)])
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Rect = Rect {
        left: 0.0,
        top: 0.0,
        right: 1.0,
        bottom: 1.0,
    };

    #[test]
    fn a_line_through_the_rectangle_is_cut_on_both_sides() {
        let parts = polyline(&[[-1.0, -0.5], [2.0, 1.0]], &UNIT);
        assert_eq!(parts, [[[0.0, 0.0], [1.0, 0.5]]]);
    }

    #[test]
    fn a_polyline_that_leaves_and_returns_has_two_parts() {
        let parts = polyline(
            &[[0.5, 0.5], [0.5, 2.0], [0.25, 2.0], [0.25, 0.5], [0.1, 0.1]],
            &UNIT,
        );
        assert_eq!(
            parts,
            [
                vec![[0.5, 0.5], [0.5, 1.0]],
                vec![[0.25, 1.0], [0.25, 0.5], [0.1, 0.1]]
            ]
        );
    }

    #[test]
    fn lines_outside_vanish() {
        assert!(polyline(&[[2.0, -1.0], [2.0, 3.0]], &UNIT).is_empty());
        assert!(polyline(&[[-1.0, 0.5], [0.5, 3.0]], &UNIT).is_empty());
    }
}
