//! Curves over a common axis.

use super::axis::{Axes, BELOW, LABEL_SIZE, Ruler, Scale, TITLE, TITLE_SIZE, draw_title};
use super::canvas::{Canvas, Colour, Dash, PAPER, Rect, Stroke};
use super::{Quantity, clip, legend, text};
use crate::{OutputError, Table};

const PLOT: [f64; 2] = [520.0, 330.0];
/// Height of one of several diagrams.
const LOW: f64 = 200.0;
const MARGIN: f64 = 12.0;
/// Most points of a curve that are drawn: four per pixel of the plot.
const MOST_POINTS: usize = 2_080;

/// Colours that readers with any colour vision can tell apart (M. Okabe and K. Ito 2008), the
/// yellow replaced by a brown that shows on white.
const COLOURS: [Colour; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [60, 60, 60],
    [140, 86, 75],
];

/// The look of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SeriesStyle {
    /// A full line.
    #[default]
    Line,
    /// A dashed line, for references.
    Dashed,
    /// A dotted line.
    Dotted,
    /// A line of dashes and dots.
    DashDotted,
    /// Markers only, for measurements.
    Markers,
    /// A line with a marker at each point, for few points.
    LineWithMarkers,
}

/// A curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Name in the legend.
    pub label: String,
    /// Points in SI units.
    pub points: Vec<(f64, f64)>,
    /// Look.
    pub style: SeriesStyle,
    /// Number of its colour, for curves that belong together; its place among the curves unless
    /// given. Colours go round after eight.
    pub colour: Option<usize>,
}

impl Series {
    /// Colour of the curve that is the `index`th of its diagram.
    pub(super) fn colour(&self, index: usize) -> Colour {
        colour(self.colour.unwrap_or(index))
    }
}

/// What to draw over which axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LinePlot {
    /// Title; empty for none.
    pub title: String,
    /// What the horizontal axis shows.
    pub x: Quantity,
    /// What the vertical axis shows.
    pub y: Quantity,
    /// Horizontal scale.
    pub x_scale: Scale,
    /// Vertical scale.
    pub y_scale: Scale,
    /// The curves.
    pub series: Vec<Series>,
}

impl LinePlot {
    /// Columns of a table over one of its columns, as full lines named after the columns with
    /// spaces for underscores.
    ///
    /// # Errors
    /// [`OutputError::NoColumn`].
    pub fn from_table(
        table: &Table,
        x: (&str, Quantity),
        y: (&[&str], Quantity),
    ) -> Result<Self, OutputError> {
        let column = |name: &str| {
            table.column(name).ok_or_else(|| OutputError::NoColumn {
                column: name.to_owned(),
                columns: table.columns.clone(),
            })
        };
        let abscissa = column(x.0)?;
        let series = y.0.iter().map(|name| {
            let values = column(name)?;
            Ok(Series {
                label: name.replace('_', " "),
                points: abscissa.iter().copied().zip(values).collect(),
                ..Series::default()
            })
        });
        Ok(Self {
            x: x.1,
            y: y.1,
            series: series.collect::<Result<_, OutputError>>()?,
            ..Self::default()
        })
    }

    fn check(&self) -> Result<(), OutputError> {
        if self.series.iter().all(|series| series.points.is_empty()) {
            return Err(OutputError::NothingToDraw {
                title: self.title.clone(),
                reason: "no series has a point",
            });
        }
        for series in &self.series {
            for (index, &(x, y)) in series.points.iter().enumerate() {
                for (value, scale) in [(x, self.x_scale), (y, self.y_scale)] {
                    if !value.is_finite() {
                        return Err(OutputError::NotFinite {
                            field: series.label.clone(),
                            index,
                            value,
                        });
                    }
                    if scale == Scale::Logarithmic && value <= 0.0 {
                        return Err(OutputError::NotPositive {
                            series: series.label.clone(),
                            index,
                            value,
                        });
                    }
                }
            }
        }
        Ok(())
    }

    fn has_markers(&self) -> bool {
        let marked = [SeriesStyle::Markers, SeriesStyle::LineWithMarkers];
        self.series.iter().any(|s| marked.contains(&s.style))
    }
}

/// A diagram that is not yet placed.
struct Diagram<'a> {
    plot: &'a LinePlot,
    rulers: [Ruler; 2],
    /// Shown value over SI value, along both axes.
    factors: [f64; 2],
    labels: [String; 2],
    height: f64,
}

impl<'a> Diagram<'a> {
    fn new(plot: &'a LinePlot, height: f64) -> Result<Self, OutputError> {
        plot.check()?;
        let points = || plot.series.iter().flat_map(|series| &series.points);
        let x_room = if plot.has_markers() { 0.04 } else { 0.0 };
        let (x, x_factor, x_label) =
            ruler(points().map(|point| point.0), plot.x_scale, &plot.x, x_room);
        let (y, y_factor, y_label) =
            ruler(points().map(|point| point.1), plot.y_scale, &plot.y, 0.05);
        Ok(Self {
            plot,
            rulers: [x, y],
            factors: [x_factor, y_factor],
            // A long legend needs its space, and so does a long name of the axis.
            height: height
                .max(legend::ROW * plot.series.len() as f64)
                .max(text::width(&y_label, LABEL_SIZE)),
            labels: [x_label, y_label],
        })
    }

    fn axes(&self) -> Axes<'_> {
        Axes {
            rulers: self.rulers,
            labels: [&self.labels[0], &self.labels[1]],
            grid: true,
            has_y_labels: true,
            has_x_labels: true,
        }
    }

    fn above(&self) -> f64 {
        if self.plot.title.is_empty() {
            0.0
        } else {
            TITLE
        }
    }

    fn draw(&self, canvas: &mut Canvas, frame: &Rect) {
        let axes = self.axes();
        axes.draw_below(canvas, frame);
        for (index, series) in self.plot.series.iter().enumerate() {
            let places: Vec<[f64; 2]> = series
                .points
                .iter()
                .map(|&(x, y)| axes.place(frame, [x * self.factors[0], y * self.factors[1]]))
                .collect();
            draw_series(canvas, frame, series.style, series.colour(index), &places);
        }
        axes.draw_above(canvas, frame);
        legend::draw(canvas, self.plot, frame);
        draw_title(canvas, frame, &self.plot.title);
    }
}

/// Draws diagrams one above the other, their vertical axes in one line.
pub(crate) fn draw(heading: &str, plots: &[LinePlot]) -> Result<Canvas, OutputError> {
    if plots.is_empty() {
        return Err(OutputError::NothingToDraw {
            title: heading.to_owned(),
            reason: "no plot was given",
        });
    }
    let height = if plots.len() == 1 { PLOT[1] } else { LOW };
    let diagrams = plots
        .iter()
        .map(|plot| Diagram::new(plot, height))
        .collect::<Result<Vec<_>, _>>()?;
    let widest = |of: &dyn Fn(&Diagram) -> f64| diagrams.iter().map(of).fold(0.0, f64::max);
    let left = MARGIN + widest(&|diagram| diagram.axes().left_space(diagram.height));
    let right = left + PLOT[0];
    let legend = widest(&|diagram| legend::width(diagram.plot));
    let title = widest(&|diagram| text::width(&diagram.plot.title, TITLE_SIZE))
        .max(text::width(heading, TITLE_SIZE));

    let mut top = MARGIN + if heading.is_empty() { 0.0 } else { TITLE };
    let mut frames = Vec::with_capacity(diagrams.len());
    for diagram in &diagrams {
        top += diagram.above();
        let frame = Rect {
            left,
            top,
            right,
            bottom: top + diagram.height,
        };
        top = frame.bottom + BELOW + MARGIN;
        frames.push(frame);
    }
    let mut canvas = Canvas::new((right + legend + MARGIN).max(title + 2.0 * MARGIN), top);
    for (diagram, frame) in diagrams.iter().zip(&frames) {
        diagram.draw(&mut canvas, frame);
    }
    if !heading.is_empty() {
        let row = Rect {
            top: MARGIN + TITLE,
            ..frames[0]
        };
        draw_title(&mut canvas, &row, heading);
    }
    Ok(canvas)
}

/// The axis that shows all values, the factor from values to it, and its label.
fn ruler(
    values: impl Iterator<Item = f64>,
    scale: Scale,
    quantity: &Quantity,
    room: f64,
) -> (Ruler, f64, String) {
    let (mut lower, mut upper) = values.fold((f64::MAX, f64::MIN), |(lower, upper), value| {
        (lower.min(value), upper.max(value))
    });
    if scale == Scale::Logarithmic {
        // Decades tell the unit well enough; a constant gets one decade on each side.
        let margin = if lower == upper {
            10.0
        } else {
            (upper / lower).powf(room)
        };
        let ruler = Ruler {
            lower: lower / margin,
            upper: upper * margin,
            scale,
        };
        return (ruler, 1.0, quantity.plain());
    }
    let magnitude = lower.abs().max(upper.abs());
    let (factor, label) = quantity.shown(magnitude);
    if upper - lower <= 1e-12 * magnitude {
        let half = if magnitude == 0.0 {
            1.0
        } else {
            0.1 * magnitude
        };
        (lower, upper) = (lower - half, upper + half);
    }
    let margin = room * (upper - lower);
    // Zero is shown when it is near, and is then a sharp end.
    let near_zero = lower >= 0.0 && lower < 0.3 * upper && room > 0.0;
    lower = if near_zero { 0.0 } else { lower - margin };
    let ruler = Ruler::linear(lower * factor, (upper + margin) * factor);
    (ruler, factor, label)
}

/// Draws a curve.
pub(super) fn draw_series(
    canvas: &mut Canvas,
    frame: &Rect,
    style: SeriesStyle,
    colour: Colour,
    places: &[[f64; 2]],
) {
    if style != SeriesStyle::Markers {
        let stroke = Stroke {
            dash: match style {
                SeriesStyle::Dashed => Dash::Dashes,
                SeriesStyle::Dotted => Dash::Dots,
                SeriesStyle::DashDotted => Dash::DashesAndDots,
                _ => Dash::None,
            },
            ..Stroke::solid(colour, 1.6)
        };
        for part in clip::polyline(&thin(places), frame) {
            canvas.polyline(part, stroke);
        }
    }
    if style == SeriesStyle::Markers || style == SeriesStyle::LineWithMarkers || places.len() == 1 {
        for &centre in places {
            canvas.circle(centre, 3.4, colour, Some(Stroke::solid(PAPER, 0.8)));
        }
    }
}

/// A long curve without the points that no eye could see: of each of many equal runs the lowest
/// and the highest point are kept, and the two ends.
fn thin(places: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if places.len() <= MOST_POINTS {
        return places.to_vec();
    }
    let run = places.len().div_ceil(MOST_POINTS / 2);
    let mut thinned = vec![places[0]];
    for (chunk, start) in places.chunks(run).zip((0..).step_by(run)) {
        let by_height = |&a: &usize, &b: &usize| chunk[a][1].total_cmp(&chunk[b][1]);
        let lowest = (0..chunk.len()).min_by(by_height).unwrap_or(0);
        let highest = (0..chunk.len()).max_by(by_height).unwrap_or(0);
        let [first, second] = [lowest.min(highest), lowest.max(highest)];
        thinned.push(places[start + first]);
        thinned.push(places[start + second]);
    }
    thinned.push(places[places.len() - 1]);
    thinned
}

/// Colour of a curve by its number.
pub(super) fn colour(index: usize) -> Colour {
    COLOURS[index % COLOURS.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::canvas::Shape;

    fn draw(plot: &LinePlot) -> Result<Canvas, OutputError> {
        super::draw("", std::slice::from_ref(plot))
    }

    fn series(points: &[(f64, f64)]) -> Series {
        Series {
            label: "s".to_owned(),
            points: points.to_vec(),
            ..Series::default()
        }
    }

    fn texts(canvas: &Canvas) -> Vec<&str> {
        canvas
            .shapes
            .iter()
            .filter_map(|shape| match shape {
                Shape::Text { content, .. } => Some(content.as_str()),
                _ => None,
            })
            .collect()
    }

    #[test]
    fn a_curve_is_drawn_from_corner_to_corner_in_shown_units() {
        let plot = LinePlot {
            x: Quantity::new("time", "s"),
            y: Quantity::new("energy", "J"),
            series: vec![series(&[(0.0, 0.0), (8e-5, 2e3)])],
            ..LinePlot::default()
        };
        let canvas = draw(&plot).unwrap();
        let texts = texts(&canvas);
        assert!(
            texts.contains(&"time (µs)") && texts.contains(&"energy (kJ)"),
            "{texts:?}"
        );
        assert!(texts.contains(&"80"), "{texts:?}");
        let curve = canvas.shapes.iter().find_map(|shape| match shape {
            Shape::Polyline { points, stroke } if stroke.colour == COLOURS[0] => Some(points),
            _ => None,
        });
        let curve = curve.unwrap();
        assert!((curve[1][0] - curve[0][0] - PLOT[0]).abs() < 1e-9);
        // Five per cent of room above, and the axis starts at zero.
        assert!((curve[0][1] - curve[1][1] - PLOT[1] / 1.05).abs() < 1e-9);
    }

    #[test]
    fn thinning_keeps_ends_and_peaks() {
        let mut places: Vec<[f64; 2]> = (0..100_000).map(|i| [f64::from(i), 0.0]).collect();
        places[31_337][1] = 7.0;
        places[31_338][1] = -5.0;
        let thinned = thin(&places);
        assert!(thinned.len() < MOST_POINTS + 10);
        for kept in [0, 31_337, 31_338, 99_999] {
            assert!(thinned.contains(&places[kept]), "{kept}");
        }
        assert!(thinned.windows(2).all(|pair| pair[0][0] <= pair[1][0]));
    }

    #[test]
    fn what_cannot_be_shown_is_an_error() {
        let plot = |points: &[(f64, f64)], y_scale| LinePlot {
            y_scale,
            series: vec![series(points)],
            ..LinePlot::default()
        };
        assert!(matches!(
            draw(&plot(&[], Scale::Linear)),
            Err(OutputError::NothingToDraw { .. })
        ));
        assert!(matches!(
            draw(&plot(&[(0.0, 1.0), (1.0, 0.0)], Scale::Logarithmic)),
            Err(OutputError::NotPositive { index: 1, .. })
        ));
        assert!(matches!(
            draw(&plot(&[(f64::NAN, 1.0)], Scale::Linear)),
            Err(OutputError::NotFinite { index: 0, .. })
        ));
        assert!(draw(&plot(&[(0.0, 3.0), (1.0, 3.0)], Scale::Linear)).is_ok());
        assert!(draw(&plot(&[(0.0, 3.0), (1.0, 3.0)], Scale::Logarithmic)).is_ok());
    }

    #[test]
    fn stacked_diagrams_share_their_vertical_axis() {
        let plot = |label: &str, largest: f64| LinePlot {
            y: Quantity::new(label, "m"),
            series: vec![series(&[(0.0, 0.0), (1.0, largest)])],
            ..LinePlot::default()
        };
        let plots = [plot("first", 1.0), plot("second", 123.0)];
        let canvas = super::draw("both", &plots).unwrap();
        assert!(texts(&canvas).contains(&"both"));
        let starts: Vec<[f64; 2]> = canvas
            .shapes
            .iter()
            .filter_map(|shape| match shape {
                Shape::Polyline { points, stroke } if stroke.colour == COLOURS[0] => {
                    Some(points[0])
                }
                _ => None,
            })
            .collect();
        assert_eq!(starts.len(), 2);
        assert_eq!(starts[0][0], starts[1][0]);
        assert!(starts[1][1] - starts[0][1] > LOW, "{starts:?}");
    }

    #[test]
    fn columns_of_a_table_become_curves() {
        let table = Table {
            columns: ["time", "kinetic_energy"].map(str::to_owned).to_vec(),
            rows: vec![vec![0.0, 5.0], vec![1.0, 4.0]],
        };
        let time = || ("time", Quantity::new("time", "s"));
        let energy = || Quantity::new("energy", "J");
        let plot = LinePlot::from_table(&table, time(), (&["kinetic_energy"], energy())).unwrap();
        assert_eq!(plot.series[0].label, "kinetic energy");
        assert_eq!(plot.series[0].points, [(0.0, 5.0), (1.0, 4.0)]);
        let error = LinePlot::from_table(&table, time(), (&["heat"], energy())).unwrap_err();
        assert_eq!(
            error.to_string(),
            "there is no column `heat`; the columns are time, kinetic_energy"
        );
    }
}
