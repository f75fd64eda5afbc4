//! The relation of values to colours, and its legend.

use super::axis::{HALF_HEIGHT, LABEL_SIZE, Ruler, TICK, TICK_SIZE};
use super::canvas::{Anchor, Canvas, Colour, INK, Rect, Stroke};
use super::{ColourMap, Group, ParticlePlot, groups, text};

const WIDTH: f64 = 15.0;
/// Distance between plot and bar.
pub(super) const GAP: f64 = 16.0;

/// The relation of values to colours, and its legend.
pub(super) struct ColourBar {
    colours: ColourMap,
    lower: f64,
    upper: f64,
    /// Whether values lie beyond the lower and the upper end.
    is_exceeded: [bool; 2],
    factor: f64,
    label: String,
    /// Takes the place of the bar, if there are any.
    groups: Vec<Group>,
}

impl ColourBar {
    pub(super) fn new(plot: &ParticlePlot, values: impl Iterator<Item = f64>) -> Self {
        let (least, most) = values.fold((f64::MAX, f64::MIN), |(least, most), value| {
            (least.min(value), most.max(value))
        });
        let (mut lower, mut upper) = plot.range.unwrap_or_else(|| {
            if plot.colours.is_diverging() {
                let largest = least.abs().max(most.abs());
                (-largest, largest)
            } else {
                (least, most)
            }
        });
        // A constant field still needs an interval; round-off about a constant is not a pattern.
        let magnitude = lower.abs().max(upper.abs());
        if upper - lower <= 1e-9 * magnitude || magnitude == 0.0 {
            (lower, upper) = if magnitude == 0.0 {
                (0.0, 1.0)
            } else {
                (lower - 0.1 * magnitude, upper + 0.1 * magnitude)
            };
        }
        let (factor, label) = plot.quantity.shown(lower.abs().max(upper.abs()));
        let slack = 1e-9 * (upper - lower);
        Self {
            colours: plot.colours,
            lower,
            upper,
            is_exceeded: [least < lower - slack, most > upper + slack],
            factor,
            label,
            groups: plot.groups.to_vec(),
        }
    }

    pub(super) fn colour(&self, value: f64) -> Colour {
        if !self.groups.is_empty() {
            return groups::colour(value);
        }
        let place = (value - self.lower) / (self.upper - self.lower);
        self.colours.at(place)
    }

    /// Part of the bar that a difference of values takes.
    pub(super) fn share(&self, difference: f64) -> f64 {
        difference / (self.upper - self.lower)
    }

    fn ruler(&self) -> Ruler {
        Ruler::linear(self.lower * self.factor, self.upper * self.factor)
    }

    /// Width with tick labels and label.
    pub(super) fn space(&self) -> f64 {
        if !self.groups.is_empty() {
            return groups::space(&self.groups);
        }
        // The height, and with it the number of ticks, is not known yet: up to eight fit.
        let widest = [2.0, 3.0, 4.0, 6.0, 8.0]
            .iter()
            .flat_map(|count| self.ruler().ticks(*count))
            .map(|tick| text::width(&tick.label, TICK_SIZE))
            .fold(0.0, f64::max);
        WIDTH + TICK + 3.0 + widest + 9.0 + LABEL_SIZE
    }

    /// Draws the bar beside the plot.
    pub(super) fn draw(&self, canvas: &mut Canvas, frame: &Rect) {
        if !self.groups.is_empty() {
            return groups::draw(canvas, &self.groups, frame.right + GAP, frame);
        }
        let middle = 0.5 * (frame.top + frame.bottom);
        let height = frame.height().min(330.0);
        let left = frame.right + GAP;
        let bar = Rect {
            left,
            right: left + WIDTH,
            top: middle - 0.5 * height,
            bottom: middle + 0.5 * height,
        };
        let centre = 0.5 * (bar.left + bar.right);
        // Each strip reaches to the top, so that no seams show between them.
        const STRIPS: usize = 128;
        for i in 0..STRIPS {
            let share = i as f64 / STRIPS as f64;
            let strip = Rect {
                bottom: bar.bottom - share * height,
                ..bar
            };
            let colour = self.colours.at((i as f64 + 0.5) / STRIPS as f64);
            canvas.polygon(strip.corners(), colour, None);
        }
        let stroke = Stroke::solid(INK, 0.9);
        canvas.polyline(bar.outline(), stroke);
        let ends = [(bar.bottom, 9.0, 0.0), (bar.top, -9.0, 1.0)];
        for ((y, tip, place), is_exceeded) in ends.into_iter().zip(self.is_exceeded) {
            if is_exceeded {
                let corners = vec![[bar.left, y], [bar.right, y], [centre, y + tip]];
                canvas.polygon(corners, self.colours.at(place), Some(stroke));
            }
        }
        let ruler = self.ruler();
        for tick in ruler.ticks(height / 42.0) {
            let y = bar.bottom - ruler.place(tick.value) * height;
            canvas.line([bar.right, y], [bar.right + TICK, y], stroke);
            let at = [bar.right + TICK + 3.0, y + HALF_HEIGHT * TICK_SIZE];
            canvas.text(at, TICK_SIZE, Anchor::Start, &tick.label);
        }
        let x = bar.left + self.space() - 0.2 * LABEL_SIZE;
        canvas.upward_text([x, middle], LABEL_SIZE, &self.label);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jstsph_tensor::Vec3;

    #[test]
    fn values_beyond_the_range_are_told() {
        let positions = [Vec3::zeros(), Vec3::x()];
        let mut plot = ParticlePlot::new(&positions, &[-3.0, 1.0], "q", "Pa", 0.5);
        let bar = |plot: &ParticlePlot| ColourBar::new(plot, plot.values.iter().copied());
        assert_eq!(bar(&plot).is_exceeded, [false, false]);
        plot.range = Some((0.0, 1.0));
        assert_eq!(bar(&plot).is_exceeded, [true, false]);
        plot.range = None;
        plot.colours = ColourMap::CoolWarm;
        let diverging = bar(&plot);
        assert_eq!((diverging.lower, diverging.upper), (-3.0, 3.0));
        let constant = ParticlePlot::new(&positions, &[2.0, 2.0], "q", "Pa", 0.5);
        assert!(bar(&constant).lower < 2.0 && bar(&constant).upper > 2.0);
    }
}
