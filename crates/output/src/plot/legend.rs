//! Names of curves beside a diagram.

use super::axis::{HALF_HEIGHT, TICK_SIZE};
use super::canvas::{Anchor, Canvas, Rect};
use super::lines::draw_series;
use super::{LinePlot, SeriesStyle, text};

/// Length of a key.
const KEY: f64 = 24.0;
/// Height of a row.
pub(super) const ROW: f64 = 20.0;
/// Space where there is no legend.
const MARGIN: f64 = 12.0;

/// One curve with an empty or only label needs no legend.
fn has_legend(plot: &LinePlot) -> bool {
    plot.series.len() > 1
}

/// Space right of the plot.
pub(super) fn width(plot: &LinePlot) -> f64 {
    if !has_legend(plot) {
        return MARGIN;
    }
    let widest = plot
        .series
        .iter()
        .map(|series| text::width(&series.label, TICK_SIZE))
        .fold(0.0, f64::max);
    14.0 + KEY + 7.0 + widest
}

/// Draws the names of the curves.
pub(super) fn draw(canvas: &mut Canvas, plot: &LinePlot, frame: &Rect) {
    if !has_legend(plot) {
        return;
    }
    let left = frame.right + 14.0;
    for (index, series) in plot.series.iter().enumerate() {
        let y = frame.top + ROW * (index as f64 + 0.5);
        let key = Rect {
            left,
            right: left + KEY,
            top: y - 1.0,
            bottom: y + 1.0,
        };
        let ends = [[key.left, y], [key.right, y]];
        let colour = series.colour(index);
        match series.style {
            SeriesStyle::Line
            | SeriesStyle::Dashed
            | SeriesStyle::Dotted
            | SeriesStyle::DashDotted => {
                draw_series(canvas, &key, series.style, colour, &ends);
            }
            SeriesStyle::Markers | SeriesStyle::LineWithMarkers => {
                if series.style == SeriesStyle::LineWithMarkers {
                    draw_series(canvas, &key, SeriesStyle::Line, colour, &ends);
                }
                let middle = [[0.5 * (key.left + key.right), y]];
                draw_series(canvas, &key, SeriesStyle::Markers, colour, &middle);
            }
        }
        let at = [key.right + 7.0, y + HALF_HEIGHT * TICK_SIZE];
        canvas.text(at, TICK_SIZE, Anchor::Start, &series.label);
    }
}
