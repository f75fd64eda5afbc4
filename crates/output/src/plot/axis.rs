//! Axes: where the ticks are and what they say.

use super::canvas::{Anchor, Canvas, GRID, INK, Rect, Stroke};
use super::text;
use super::unit::{exponent_of, superscript};

/// Size of tick labels, of axis labels and of titles.
pub(crate) const TICK_SIZE: f64 = 11.0;
pub(crate) const LABEL_SIZE: f64 = 12.5;
pub(crate) const TITLE_SIZE: f64 = 14.5;
/// Length of a tick and distance to its label.
pub(crate) const TICK: f64 = 4.5;
const GAP: f64 = 4.0;
/// Space an x axis takes below the plot, with its label.
pub(crate) const BELOW: f64 = TICK + GAP + TICK_SIZE + 8.0 + LABEL_SIZE;
/// Space of a title above the plot.
pub(crate) const TITLE: f64 = TITLE_SIZE + 13.0;
/// Least number of ticks that tell the scale of an axis.
const FEW: usize = 3;
/// Part of the size of a text by which its middle is above its baseline.
pub(crate) const HALF_HEIGHT: f64 = 0.36;

/// How values become places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Equal differences are equally far apart.
    #[default]
    Linear,
    /// Equal ratios are equally far apart; only for positive values.
    Logarithmic,
}

/// An axis from `lower` to `upper`, in the shown unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ruler {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) scale: Scale,
}

/// A place that is marked.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    pub(crate) value: f64,
    pub(crate) label: String,
}

impl Ruler {
    pub(crate) fn linear(lower: f64, upper: f64) -> Self {
        Self {
            lower,
            upper,
            scale: Scale::Linear,
        }
    }

    /// Place of a value, 0 at the lower end and 1 at the upper.
    pub(crate) fn place(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.lower) / (self.upper - self.lower),
            Scale::Logarithmic => (value / self.lower).ln() / (self.upper / self.lower).ln(),
        }
    }

    /// About `count` ticks at round values.
    pub(crate) fn ticks(&self, count: f64) -> Vec<Tick> {
        match self.scale {
            Scale::Linear => self.linear_ticks(count),
            Scale::Logarithmic => self.logarithmic_ticks(count),
        }
    }

    fn linear_ticks(&self, count: f64) -> Vec<Tick> {
        let rough = (self.upper - self.lower) / count.max(1.0);
        let exponent = rough.log10().floor() as i32;
        let power = 10_f64.powi(exponent);
        let step = [1.0, 2.0, 5.0, 10.0]
            .map(|multiple| multiple * power)
            .into_iter()
            .find(|step| *step >= rough * (1.0 - 1e-9))
            .unwrap_or(10.0 * power);
        let decimals = (-exponent_of(step)).max(0) as usize;
        // Ends that are ticks up to rounding count as such.
        let slack = 1e-9 * (self.upper - self.lower) / step;
        let first = (self.lower / step - slack).ceil() as i64;
        let last = (self.upper / step + slack).floor() as i64;
        (first..=last)
            .map(|i| {
                let value = i as f64 * step;
                Tick {
                    value,
                    label: minus(format!("{value:.decimals$}")),
                }
            })
            .collect()
    }

    fn logarithmic_ticks(&self, count: f64) -> Vec<Tick> {
        let (first, last) = (
            (self.lower.log10() - 1e-9).ceil() as i32,
            (self.upper.log10() + 1e-9).floor() as i32,
        );
        if last - first >= 1 {
            // Whole decades, thinned out when there are many.
            let stride = (f64::from(last - first + 1) / count).ceil().max(1.0) as usize;
            return (first..=last)
                .step_by(stride)
                .map(|exponent| Tick {
                    value: 10_f64.powi(exponent),
                    label: format!("10{}", superscript(exponent)),
                })
                .collect();
        }
        let lowest = self.lower.log10().floor() as i32;
        (lowest..=lowest + 2)
            .flat_map(|exponent| {
                [1.0, 2.0, 3.0, 5.0, 7.0].map(|multiple| {
                    let decimals = (-exponent).max(0) as usize;
                    let value = multiple * 10_f64.powi(exponent);
                    Tick {
                        value,
                        label: format!("{value:.decimals$}"),
                    }
                })
            })
            .filter(|tick| (-1e-9..=1.0 + 1e-9).contains(&self.place(tick.value)))
            .collect()
    }
}

/// A title above the plot, moved sideways where the figure would cut it.
pub(crate) fn draw_title(canvas: &mut Canvas, frame: &Rect, title: &str) {
    let half = 0.5 * text::width(title, TITLE_SIZE);
    let middle = 0.5 * (frame.left + frame.right);
    let x = middle.min(canvas.width - half - 4.0).max(half + 4.0);
    let at = [x, frame.top - 11.0];
    canvas.text(at, TITLE_SIZE, Anchor::Middle, title);
}

/// A typographic minus, and no sign before zero.
fn minus(text: String) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|b| b == b'0' || b == b'.') => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// The two axes of a plot with their labels.
pub(crate) struct Axes<'a> {
    pub(crate) rulers: [Ruler; 2],
    pub(crate) labels: [&'a str; 2],
    pub(crate) grid: bool,
    /// Whether the y axis is labelled; panels side by side share the first one's.
    pub(crate) has_y_labels: bool,
    /// Whether the x axis is labelled; panels one above the other share the last one's.
    pub(crate) has_x_labels: bool,
}

impl Axes<'_> {
    /// Space that the y axis takes left of the plot, for a plot of this height.
    pub(crate) fn left_space(&self, height: f64) -> f64 {
        let widest = self
            .y_ticks(height)
            .iter()
            .map(|tick| text::width(&tick.label, TICK_SIZE))
            .fold(0.0, f64::max);
        TICK + GAP + widest + 10.0 + LABEL_SIZE
    }

    /// Place of a point given in the shown units.
    pub(crate) fn place(&self, frame: &Rect, point: [f64; 2]) -> [f64; 2] {
        [
            frame.left + self.rulers[0].place(point[0]) * frame.width(),
            frame.bottom - self.rulers[1].place(point[1]) * frame.height(),
        ]
    }

    /// What lies below the data: the grid.
    pub(crate) fn draw_below(&self, canvas: &mut Canvas, frame: &Rect) {
        if !self.grid {
            return;
        }
        let stroke = Stroke::solid(GRID, 0.8);
        for tick in self.x_ticks(frame.width()) {
            let x = self.place(frame, [tick.value, self.rulers[1].lower])[0];
            canvas.line([x, frame.top], [x, frame.bottom], stroke);
        }
        for tick in self.y_ticks(frame.height()) {
            let y = self.place(frame, [self.rulers[0].lower, tick.value])[1];
            canvas.line([frame.left, y], [frame.right, y], stroke);
        }
    }

    /// What lies above the data: frame, ticks, labels.
    pub(crate) fn draw_above(&self, canvas: &mut Canvas, frame: &Rect) {
        let stroke = Stroke::solid(INK, 0.9);
        canvas.polyline(frame.outline(), stroke);
        for tick in self.x_ticks(frame.width()) {
            let x = self.place(frame, [tick.value, self.rulers[1].lower])[0];
            canvas.line([x, frame.bottom], [x, frame.bottom + TICK], stroke);
            if !self.has_x_labels {
                continue;
            }
            let y = frame.bottom + TICK + GAP + 0.75 * TICK_SIZE;
            canvas.text([x, y], TICK_SIZE, Anchor::Middle, &tick.label);
        }
        for tick in self.y_ticks(frame.height()) {
            let y = self.place(frame, [self.rulers[0].lower, tick.value])[1];
            canvas.line([frame.left - TICK, y], [frame.left, y], stroke);
            if !self.has_y_labels {
                continue;
            }
            let at = [frame.left - TICK - GAP, y + HALF_HEIGHT * TICK_SIZE];
            canvas.text(at, TICK_SIZE, Anchor::End, &tick.label);
        }
        let middle = 0.5 * (frame.left + frame.right);
        let y = frame.bottom + BELOW - 0.25 * LABEL_SIZE;
        if self.has_x_labels {
            canvas.text([middle, y], LABEL_SIZE, Anchor::Middle, self.labels[0]);
        }
        if !self.has_y_labels {
            return;
        }
        let x = frame.left - self.left_space(frame.height()) + 0.8 * LABEL_SIZE;
        let centre = 0.5 * (frame.top + frame.bottom);
        canvas.upward_text([x, centre], LABEL_SIZE, self.labels[1]);
    }

    fn x_ticks(&self, width: f64) -> Vec<Tick> {
        let fits = |ticks: &[Tick]| {
            let widest = ticks
                .iter()
                .map(|tick| text::width(&tick.label, TICK_SIZE))
                .fold(0.0, f64::max);
            (widest + 10.0) * (ticks.len() as f64 - 1.0) <= width
        };
        // Fewer ticks where their labels would touch.
        let mut count = width / 75.0;
        let mut ticks = self.rulers[0].ticks(count);
        while count >= 1.5 && !fits(&ticks) {
            count *= 0.7;
            ticks = self.rulers[0].ticks(count);
        }
        self.enough(0, ticks, count, fits)
    }

    fn y_ticks(&self, height: f64) -> Vec<Tick> {
        let count = height / 50.0;
        let fits = |ticks: &[Tick]| 2.0 * TICK_SIZE * ticks.len() as f64 <= height;
        self.enough(1, self.rulers[1].ticks(count), count, fits)
    }

    /// More ticks where one or two would not tell the scale, if there is room for them.
    fn enough(
        &self,
        axis: usize,
        ticks: Vec<Tick>,
        count: f64,
        fits: impl Fn(&[Tick]) -> bool,
    ) -> Vec<Tick> {
        if ticks.len() >= FEW {
            return ticks;
        }
        [1.5, 2.0, 3.0, 4.0]
            .map(|more| self.rulers[axis].ticks(count * more))
            .into_iter()
            .find(|finer| finer.len() >= FEW && fits(finer))
            .unwrap_or(ticks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ruler: Ruler, count: f64) -> Vec<String> {
        ruler.ticks(count).into_iter().map(|t| t.label).collect()
    }

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(
            labels(Ruler::linear(-0.32, 0.51), 4.0),
            ["0.0", "0.5"].map(str::to_owned).to_vec(),
        );
        assert_eq!(
            labels(Ruler::linear(-3.2, 5.1), 5.0),
            ["−2", "0", "2", "4"].map(str::to_owned).to_vec()
        );
        assert_eq!(
            labels(Ruler::linear(0.0, 0.3), 3.0),
            ["0.0", "0.1", "0.2", "0.3"].map(str::to_owned).to_vec()
        );
        assert_eq!(
            labels(Ruler::linear(1000.0, 3000.0), 2.0),
            ["1000", "2000", "3000"].map(str::to_owned).to_vec()
        );
    }

    #[test]
    fn logarithmic_ticks_are_decades_or_simple_multiples() {
        let ruler = |lower, upper| Ruler {
            lower,
            upper,
            scale: Scale::Logarithmic,
        };
        assert_eq!(
            labels(ruler(5e-4, 20.0), 6.0),
            ["10⁻³", "10⁻²", "10⁻¹", "10⁰", "10¹"]
        );
        assert_eq!(
            labels(ruler(0.015, 0.08), 6.0),
            ["0.02", "0.03", "0.05", "0.07"]
        );
        assert!((ruler(1e-2, 1e2).place(1.0) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn a_narrow_axis_about_zero_has_more_than_one_tick() {
        let axes = Axes {
            rulers: [Ruler::linear(-9.9, 9.9), Ruler::linear(0.0, 1.0)],
            labels: ["", ""],
            grid: false,
            has_y_labels: true,
            has_x_labels: true,
        };
        let labels = |width: f64| -> Vec<String> {
            let ticks = axes.x_ticks(width);
            ticks.into_iter().map(|tick| tick.label).collect()
        };
        assert_eq!(labels(240.0), ["−5", "0", "5"].map(str::to_owned).to_vec());
        assert_eq!(labels(20.0), ["0"].map(str::to_owned).to_vec());
    }
}
