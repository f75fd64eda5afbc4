//! Where everything goes in a picture of bodies side by side and in rows.

use super::axis::{
    Axes, BELOW, HALF_HEIGHT, LABEL_SIZE, Ruler, TICK_SIZE, TITLE, TITLE_SIZE, draw_title,
};
use super::canvas::{Anchor, Canvas, INK, Rect, Stroke};
use super::colorbar::{self, ColourBar};
use super::{Axis, View, text};

/// Largest area of one body; the body fills one of the two.
const LARGEST: [f64; 2] = [580.0, 470.0];
/// Largest width of several bodies with the gaps between them.
const LARGEST_ROW: f64 = 1000.0;
/// Largest height of several rows with the gaps between them.
const LARGEST_COLUMN: f64 = 900.0;
/// Limits of the plot area's width over its height.
const ASPECT: [f64; 2] = [0.4, 4.0];
const MARGIN: f64 = 12.0;
/// Distance of two panels.
const GAP: f64 = 22.0;
/// Space of a panel's title below a heading.
const PANEL_TITLE: f64 = LABEL_SIZE + 9.0;
/// Height of the strip below an oblique view with the axes' directions and the scale bar.
const DIRECTIONS: f64 = 60.0;

/// Panels of one size in one or more rows, with a common scale.
pub(super) struct Panels<'a> {
    pub(super) size: [f64; 2],
    heading: &'a str,
    titles: &'a [&'a str],
    /// Panels in a row.
    columns: usize,
    /// From a panel to the one below it.
    pitch: f64,
    view: View,
    /// Lower left corner of every panel, m.
    origin: [f64; 2],
    pixels_per_metre: f64,
    /// Shown length units per metre, and the unit's name.
    unit: (f64, &'static str),
    first: Rect,
}

/// One of the panels.
pub(super) struct Panel {
    pub(super) frame: Rect,
    pub(super) pixels_per_metre: f64,
    origin: [f64; 2],
}

impl Panel {
    /// Place of a point in the plane of view, m.
    pub(super) fn place(&self, point: [f64; 2]) -> [f64; 2] {
        [
            self.frame.left + (point[0] - self.origin[0]) * self.pixels_per_metre,
            self.frame.bottom - (point[1] - self.origin[1]) * self.pixels_per_metre,
        ]
    }
}

impl<'a> Panels<'a> {
    /// Lays out one panel per title in rows of so many, each showing the window (m).
    pub(super) fn new(
        heading: &'a str,
        titles: &'a [&'a str],
        columns: usize,
        view: View,
        window: [[f64; 2]; 2],
        bar: &ColourBar,
    ) -> Self {
        let [lower, upper] = window;
        let mut extent: [f64; 2] = std::array::from_fn(|i| (upper[i] - lower[i]).max(1e-12));
        let middle: [f64; 2] = std::array::from_fn(|i| 0.5 * (upper[i] + lower[i]));
        let aspect = extent[0] / extent[1];
        if aspect < ASPECT[0] {
            extent[0] = ASPECT[0] * extent[1];
        } else if aspect > ASPECT[1] {
            extent[1] = extent[0] / ASPECT[1];
        }
        let columns = columns.clamp(1, titles.len());
        let rows = titles.len().div_ceil(columns) as f64;
        let count = columns as f64;
        let widest = LARGEST[0].min((LARGEST_ROW - GAP * (count - 1.0)) / count);
        let highest = LARGEST[1].min((LARGEST_COLUMN - PANEL_TITLE * (rows - 1.0)) / rows);
        let pixels_per_metre = (widest / extent[0]).min(highest / extent[1]);
        let [width, height] = extent.map(|e| e * pixels_per_metre);
        let origin = std::array::from_fn(|i| middle[i] - 0.5 * extent[i]);

        let largest = extent[0].max(extent[1]);
        let unit = if largest < 2e-4 {
            (1e6, "µm")
        } else if largest < 1.0 {
            (1e3, "mm")
        } else {
            (1.0, "m")
        };
        let has_titles = titles.iter().any(|title| !title.is_empty());
        let above = match (heading.is_empty(), has_titles) {
            (true, false) => 0.0,
            (true, true) | (false, false) => TITLE,
            (false, true) => TITLE + PANEL_TITLE,
        };
        let mut panels = Self {
            size: [0.0; 2],
            heading,
            titles,
            columns,
            pitch: height + if has_titles { PANEL_TITLE + 8.0 } else { GAP },
            view,
            origin,
            pixels_per_metre,
            unit,
            first: Rect {
                left: MARGIN,
                top: MARGIN + above,
                right: MARGIN + width,
                bottom: MARGIN + above + height,
            },
        };
        let (left, below) = match view.plane() {
            Some(_) => (panels.axes(["", ""]).left_space(height), BELOW),
            None => (0.0, DIRECTIONS),
        };
        let row = count * width + (count - 1.0) * GAP;
        let content = 2.0 * MARGIN + left + row + colorbar::GAP + bar.space();
        let title_size = if heading.is_empty() {
            TITLE_SIZE
        } else {
            LABEL_SIZE
        };
        let widest = titles
            .iter()
            .map(|title| text::width(title, title_size))
            .chain([text::width(heading, TITLE_SIZE)])
            .fold(0.0, f64::max)
            + 2.0 * MARGIN;
        // What is narrower than its heading stands in the middle.
        let shift = left + 0.5 * (widest - content).max(0.0);
        panels.first.left += shift;
        panels.first.right += shift;
        let last = panels.last_frame().bottom;
        panels.size = [content.max(widest), last + below + MARGIN];
        panels
    }

    pub(super) fn panel(&self, number: usize) -> Panel {
        let shift = (number % self.columns) as f64 * (self.first.width() + GAP);
        let drop = (number / self.columns) as f64 * self.pitch;
        Panel {
            frame: Rect {
                left: self.first.left + shift,
                right: self.first.right + shift,
                top: self.first.top + drop,
                bottom: self.first.bottom + drop,
            },
            pixels_per_metre: self.pixels_per_metre,
            origin: self.origin,
        }
    }

    fn last_frame(&self) -> Rect {
        self.panel(self.titles.len() - 1).frame
    }

    /// All panels together, beside which the colour bar stands.
    pub(super) fn whole_frame(&self) -> Rect {
        Rect {
            right: self.panel(self.columns - 1).frame.right,
            bottom: self.last_frame().bottom,
            ..self.first
        }
    }

    /// Draws what is around and above the bodies: axes, titles, scale.
    pub(super) fn draw(&self, canvas: &mut Canvas) {
        for (number, title) in self.titles.iter().enumerate() {
            let frame = self.panel(number).frame;
            if let Some(plane) = self.view.plane() {
                let labels = plane.map(|axis| format!("{} ({})", axis.name(), self.unit.1));
                let axes = Axes {
                    has_y_labels: number % self.columns == 0,
                    has_x_labels: number + self.columns >= self.titles.len(),
                    ..self.axes([&labels[0], &labels[1]])
                };
                axes.draw_above(canvas, &frame);
            }
            if self.heading.is_empty() {
                draw_title(canvas, &frame, title);
            } else {
                let middle = 0.5 * (frame.left + frame.right);
                canvas.text([middle, frame.top - 8.0], LABEL_SIZE, Anchor::Middle, title);
            }
        }
        let has_titles = self.titles.iter().any(|title| !title.is_empty());
        if !self.heading.is_empty() {
            let row = Rect {
                top: self.first.top - if has_titles { PANEL_TITLE } else { 0.0 },
                right: self.whole_frame().right,
                ..self.first
            };
            draw_title(canvas, &row, self.heading);
        }
        if self.view.plane().is_none() {
            self.draw_directions(canvas);
            self.draw_scale_bar(canvas);
        }
    }

    fn axes<'b>(&self, labels: [&'b str; 2]) -> Axes<'b> {
        let extent = [self.first.width(), self.first.height()];
        let rulers = std::array::from_fn(|i| {
            let lower = self.origin[i] * self.unit.0;
            Ruler::linear(
                lower,
                lower + extent[i] / self.pixels_per_metre * self.unit.0,
            )
        });
        Axes {
            rulers,
            labels,
            grid: false,
            has_y_labels: true,
            has_x_labels: true,
        }
    }

    fn draw_directions(&self, canvas: &mut Canvas) {
        let [right, up, _] = self.view.frame();
        let corner = [
            self.first.left + 34.0,
            self.first.bottom + DIRECTIONS - 22.0,
        ];
        for axis in [Axis::X, Axis::Y, Axis::Z] {
            let direction = axis.direction();
            let toward = [right.dot(&direction), -up.dot(&direction)];
            let tip = std::array::from_fn(|i| corner[i] + 24.0 * toward[i]);
            canvas.line(corner, tip, Stroke::solid(INK, 1.3));
            let at = [
                corner[0] + 33.0 * toward[0],
                corner[1] + 33.0 * toward[1] + HALF_HEIGHT * TICK_SIZE,
            ];
            canvas.text(at, TICK_SIZE, Anchor::Middle, axis.name());
        }
    }

    fn draw_scale_bar(&self, canvas: &mut Canvas) {
        let frame = self.whole_frame();
        let shown = frame.width() / self.pixels_per_metre * self.unit.0;
        // The longest round length within a quarter of the picture.
        let power = 10_f64.powf((0.25 * shown).log10().floor());
        let length = [5.0, 2.0, 1.0]
            .map(|multiple| multiple * power)
            .into_iter()
            .find(|length| *length <= 0.25 * shown)
            .unwrap_or(power);
        let pixels = length / self.unit.0 * self.pixels_per_metre;
        let (right, y) = (frame.right - 8.0, frame.bottom + DIRECTIONS - 22.0);
        let stroke = Stroke::solid(INK, 2.0);
        canvas.line([right - pixels, y], [right, y], stroke);
        let at = [right - 0.5 * pixels, y - 7.0];
        let label = format!("{length} {}", self.unit.1);
        canvas.text(at, TICK_SIZE, Anchor::Middle, &label);
    }
}

#[cfg(test)]
mod tests {
    use super::super::ParticlePlot;
    use super::*;
    use jstsph_tensor::Vec3;

    #[test]
    fn rows_stand_below_each_other_within_the_picture() {
        let positions = [Vec3::zeros(), Vec3::new(1.0, 1.0, 0.0)];
        let plot = ParticlePlot::new(&positions, &[0.0, 1.0], "q", "", 0.1);
        let bar = ColourBar::new(&plot, [0.0, 1.0].into_iter());
        let titles = ["a", "b", "c", "d", "e"];
        let window = [[0.0, 0.0], [1.0, 1.0]];
        let panels = Panels::new("rows", &titles, 2, View::Xy, window, &bar);
        let frame = |number: usize| panels.panel(number).frame;
        assert_eq!(frame(0).left, frame(2).left);
        assert_eq!(frame(1).left, frame(3).left);
        assert_eq!(frame(2).top, frame(3).top);
        assert!(frame(2).top - frame(0).bottom >= PANEL_TITLE);
        assert_eq!(panels.whole_frame().right, frame(1).right);
        assert!(panels.size[1] > frame(4).bottom + BELOW);
        assert!(frame(4).bottom - frame(0).top <= LARGEST_COLUMN + 30.0);
    }
}
