//! Which dots of a body are hidden behind others.

use super::canvas::Rect;

/// Sample points per radius: slivers narrower than a quarter of the radius do not count as seen.
const SAMPLES_PER_RADIUS: f64 = 4.0;

/// For discs of one radius, given from front to back, whether each can be seen in `frame`.
///
/// Without this a picture of a solid body would consist of particles of its inside.
///
/// # Cost
/// About fifty sample points per disc, one byte per sample point of the frame.
pub(crate) fn visible(centres: &[[f64; 2]], radius: f64, frame: &Rect) -> Vec<bool> {
    let step = radius / SAMPLES_PER_RADIUS;
    let columns = (frame.width() / step).ceil() as usize + 1;
    let rows = (frame.height() / step).ceil() as usize + 1;
    let mut is_covered = vec![false; columns * rows];
    // Indices of the samples between two coordinates; casts saturate at the lower end.
    let between = |from: f64, to: f64, count: usize| {
        let first = (from / step).ceil().max(0.0) as usize;
        let end = ((to / step).floor() + 1.0).max(0.0) as usize;
        first..end.min(count)
    };
    centres
        .iter()
        .map(|centre| {
            let (x, y) = (centre[0] - frame.left, centre[1] - frame.top);
            let mut is_seen = false;
            for row in between(y - radius, y + radius, rows) {
                let height = row as f64 * step - y;
                let half = (radius * radius - height * height).max(0.0).sqrt();
                for column in between(x - half, x + half, columns) {
                    let sample = &mut is_covered[row * columns + column];
                    is_seen |= !*sample;
                    *sample = true;
                }
            }
            is_seen
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Rect = Rect {
        left: 10.0,
        top: 20.0,
        right: 110.0,
        bottom: 120.0,
    };

    #[test]
    fn a_disc_right_behind_another_is_hidden_and_one_aside_is_not() {
        let centres = [[50.3, 60.7], [50.3, 60.7], [55.3, 60.7], [90.0, 90.0]];
        assert_eq!(visible(&centres, 5.0, &FRAME), [true, false, true, true]);
    }

    #[test]
    fn several_discs_together_hide_one() {
        let around = [[48.0, 60.0], [52.0, 60.0], [50.0, 57.0], [50.0, 63.0]];
        let mut centres = around.to_vec();
        centres.push([50.0, 60.0]);
        assert!(!visible(&centres, 5.0, &FRAME)[4]);
    }

    #[test]
    fn discs_outside_the_frame_are_not_seen() {
        let centres = [[0.0, 60.0], [50.0, 200.0], [12.0, 22.0]];
        assert_eq!(visible(&centres, 5.0, &FRAME), [false, false, true]);
    }
}
