//! A body coloured by a field.

use jstsph_tensor::Vec3;

use super::axis::{Axes, BELOW, HALF_HEIGHT, Ruler, TICK_SIZE, TITLE, TITLE_SIZE, draw_title};
use super::canvas::{Anchor, Canvas, INK, PAPER, Rect, STEEL, Stroke, mix};
use super::colorbar::{self, ColourBar};
use super::hidden::visible;
use super::{Axis, ColourMap, Quantity, Section, View, clip, text};
use crate::OutputError;
use crate::error::{require_finite, require_length};

/// Largest plot area; the body fills one of the two.
const LARGEST: [f64; 2] = [580.0, 470.0];
/// Limits of the plot area's width over its height.
const ASPECT: [f64; 2] = [0.4, 4.0];
const MARGIN: f64 = 12.0;
/// Height of the strip below an oblique view with the axes' directions and the scale bar.
const DIRECTIONS: f64 = 60.0;

/// What to draw of a body, all lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub struct ParticlePlot<'a> {
    /// Title; empty for none.
    pub title: String,
    /// Current positions.
    pub positions: &'a [Vec3],
    /// The field, one value per particle, SI unit.
    pub values: &'a [f64],
    /// Name and unit of the field.
    pub quantity: Quantity,
    /// Distance between particles in the undeformed body: the size of the dots.
    pub spacing: f64,
    /// Direction of view.
    pub view: View,
    /// Shows only the particles in a slab.
    pub section: Option<Section>,
    /// Quadrilaterals to fill instead of drawing dots, by particle; those with a corner outside
    /// the section are left out.
    pub cells: &'a [[usize; 4]],
    /// Lines of obstacles; cut off at the edge of the picture.
    pub obstacles: Vec<Vec<Vec3>>,
    /// Colours.
    pub colours: ColourMap,
    /// Field values of the first and the last colour; the field's own extremes by default. Values
    /// outside take the end colours, and the colour bar gets a pointed end.
    pub range: Option<(f64, f64)>,
    /// Lower left and upper right corner of the picture in the plane of view, for a series of
    /// pictures that must match; the body's own extent by default.
    pub window: Option<[[f64; 2]; 2]>,
}

impl<'a> ParticlePlot<'a> {
    /// A plot in the x-y plane with all choices left open.
    pub fn new(
        positions: &'a [Vec3],
        values: &'a [f64],
        name: impl Into<String>,
        unit: impl Into<String>,
        spacing: f64,
    ) -> Self {
        Self {
            title: String::new(),
            positions,
            values,
            quantity: Quantity::new(name, unit),
            spacing,
            view: View::default(),
            section: None,
            cells: &[],
            obstacles: Vec::new(),
            colours: ColourMap::default(),
            range: None,
            window: None,
        }
    }

    fn nothing(&self, reason: &'static str) -> OutputError {
        OutputError::NothingToDraw {
            title: self.title.clone(),
            reason,
        }
    }

    fn check(&self) -> Result<(), OutputError> {
        let particles = self.positions.len();
        require_length(&self.quantity.name, self.values.len(), particles)?;
        require_finite(&self.quantity.name, self.values.iter().copied())?;
        require_finite("spacing", [self.spacing])?;
        let norms = self.positions.iter().map(Vec3::norm);
        require_finite("position", norms)?;
        for (cell, corners) in self.cells.iter().enumerate() {
            if let Some(&point) = corners.iter().find(|&&point| point >= particles) {
                return Err(OutputError::CellPoint {
                    cell,
                    point,
                    points: particles,
                });
            }
        }
        Ok(())
    }
}

/// A particle in the plane of view.
struct Dot {
    place: [f64; 2],
    depth: f64,
    value: f64,
}

pub(crate) fn draw(plot: &ParticlePlot) -> Result<Canvas, OutputError> {
    plot.check()?;
    let [right, up, toward] = plot.view.frame();
    let project = |x: &Vec3| [right.dot(x), up.dot(x)];
    let is_shown = |x: &Vec3| plot.section.is_none_or(|section| section.contains(x));
    let dots: Vec<Dot> = plot
        .positions
        .iter()
        .zip(plot.values)
        .filter(|(x, _)| is_shown(x))
        .map(|(x, &value)| Dot {
            place: project(x),
            depth: toward.dot(x),
            value,
        })
        .collect();
    if dots.is_empty() {
        return Err(plot.nothing("no particle lies in the section"));
    }

    let window = window(plot, &dots);
    let bar = ColourBar::new(plot, dots.iter().map(|dot| dot.value));
    let layout = Layout::new(plot, window, &bar);
    let mut canvas = Canvas::new(layout.size[0], layout.size[1]);
    let place = |point: [f64; 2]| layout.place(point);

    if plot.cells.is_empty() {
        draw_dots(&mut canvas, plot, dots, &layout, &bar);
    } else {
        let mut cells: Vec<_> = plot
            .cells
            .iter()
            .filter(|cell| cell.iter().all(|&a| is_shown(&plot.positions[a])))
            .map(|cell| {
                let depth: f64 = cell.iter().map(|&a| toward.dot(&plot.positions[a])).sum();
                (depth, cell)
            })
            .collect();
        cells.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, cell) in cells {
            let value = 0.25 * cell.iter().map(|&a| plot.values[a]).sum::<f64>();
            let colour = bar.colour(value);
            let corners = cell.map(|a| place(project(&plot.positions[a])));
            // The thin outline of the same colour hides the seams between cells.
            let outline = Some(Stroke::solid(mix(colour, INK, 0.12), 0.5));
            canvas.polygon(corners.to_vec(), colour, outline);
        }
    }
    for obstacle in &plot.obstacles {
        let line: Vec<[f64; 2]> = obstacle.iter().map(|x| place(project(x))).collect();
        for part in clip::polyline(&line, &layout.frame) {
            canvas.polyline(part, Stroke::solid(STEEL, 2.0));
        }
    }
    layout.draw_scale(&mut canvas, plot);
    bar.draw(&mut canvas, &layout.frame);
    draw_title(&mut canvas, &layout.frame, &plot.title);
    Ok(canvas)
}

fn draw_dots(
    canvas: &mut Canvas,
    plot: &ParticlePlot,
    mut dots: Vec<Dot>,
    layout: &Layout,
    bar: &ColourBar,
) {
    let nearest = dots.iter().map(|d| d.depth).fold(f64::MIN, f64::max);
    let farthest = dots.iter().map(|d| d.depth).fold(f64::MAX, f64::min);
    let is_deep = nearest - farthest > 1.5 * plot.spacing;
    let radius = (0.52 * plot.spacing * layout.pixels_per_metre).max(0.7);
    // Stable, so that particles of one layer keep their order and pictures are reproducible.
    dots.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    dots.reverse();
    let centres: Vec<[f64; 2]> = dots.iter().map(|dot| layout.place(dot.place)).collect();
    let is_visible = visible(&centres, radius, &layout.frame);
    for ((dot, centre), is_visible) in dots.iter().zip(centres).zip(is_visible).rev() {
        if !is_visible || !layout.frame.contains(centre) {
            continue;
        }
        let colour = bar.colour(dot.value);
        if is_deep {
            // A rim and a highlight make balls of the dots, so that depth can be seen.
            let rim = Stroke::solid(mix(colour, INK, 0.45), (0.14 * radius).clamp(0.25, 1.0));
            canvas.circle(centre, radius, colour, Some(rim));
            if radius > 2.0 {
                let spot = [centre[0] - 0.3 * radius, centre[1] - 0.32 * radius];
                canvas.circle(spot, 0.3 * radius, mix(colour, PAPER, 0.4), None);
            }
        } else {
            canvas.circle(centre, radius, colour, None);
        }
    }
}

/// What the picture shows of the plane of view, m.
fn window(plot: &ParticlePlot, dots: &[Dot]) -> [[f64; 2]; 2] {
    if let Some(window) = plot.window {
        return window;
    }
    let mut lower = [f64::MAX; 2];
    let mut upper = [f64::MIN; 2];
    for dot in dots {
        for i in 0..2 {
            lower[i] = lower[i].min(dot.place[i]);
            upper[i] = upper[i].max(dot.place[i]);
        }
    }
    let extent = (upper[0] - lower[0]).max(upper[1] - lower[1]);
    let margin = plot.spacing + 0.04 * extent;
    [lower.map(|x| x - margin), upper.map(|x| x + margin)]
}

/// Where everything goes.
struct Layout {
    size: [f64; 2],
    frame: Rect,
    /// Lower left corner of the frame, m.
    origin: [f64; 2],
    pixels_per_metre: f64,
    /// Shown length units per metre, and the unit's name.
    unit: (f64, &'static str),
}

impl Layout {
    fn new(plot: &ParticlePlot, window: [[f64; 2]; 2], bar: &ColourBar) -> Self {
        let [lower, upper] = window;
        let mut extent: [f64; 2] = std::array::from_fn(|i| (upper[i] - lower[i]).max(1e-12));
        let middle: [f64; 2] = std::array::from_fn(|i| 0.5 * (upper[i] + lower[i]));
        let aspect = extent[0] / extent[1];
        if aspect < ASPECT[0] {
            extent[0] = ASPECT[0] * extent[1];
        } else if aspect > ASPECT[1] {
            extent[1] = extent[0] / ASPECT[1];
        }
        let pixels_per_metre = (LARGEST[0] / extent[0]).min(LARGEST[1] / extent[1]);
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
        let mut layout = Self {
            size: [0.0; 2],
            frame: Rect {
                left: MARGIN,
                top: MARGIN + if plot.title.is_empty() { 0.0 } else { TITLE },
                right: 0.0,
                bottom: 0.0,
            },
            origin,
            pixels_per_metre,
            unit,
        };
        layout.frame.right = layout.frame.left + width;
        layout.frame.bottom = layout.frame.top + height;
        let mut below = DIRECTIONS;
        if plot.view.plane().is_some() {
            let left = layout.axes(["", ""]).left_space(height);
            layout.frame.left += left;
            layout.frame.right += left;
            below = BELOW;
        }
        let title = text::width(&plot.title, TITLE_SIZE) + 2.0 * MARGIN;
        layout.size = [
            (layout.frame.right + colorbar::GAP + bar.space() + MARGIN).max(title),
            layout.frame.bottom + below + MARGIN,
        ];
        layout
    }

    fn place(&self, point: [f64; 2]) -> [f64; 2] {
        [
            self.frame.left + (point[0] - self.origin[0]) * self.pixels_per_metre,
            self.frame.bottom - (point[1] - self.origin[1]) * self.pixels_per_metre,
        ]
    }

    fn axes<'a>(&self, labels: [&'a str; 2]) -> Axes<'a> {
        let extent = [self.frame.width(), self.frame.height()];
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
        }
    }

    /// Axes in a plane of coordinates; a scale bar and the directions of the axes otherwise.
    fn draw_scale(&self, canvas: &mut Canvas, plot: &ParticlePlot) {
        if let Some(plane) = plot.view.plane() {
            let labels = plane.map(|axis| format!("{} ({})", axis.name(), self.unit.1));
            let axes = self.axes([&labels[0], &labels[1]]);
            axes.draw_above(canvas, &self.frame);
            return;
        }
        self.draw_scale_bar(canvas);
        let [right, up, _] = plot.view.frame();
        let corner = [
            self.frame.left + 34.0,
            self.frame.bottom + DIRECTIONS - 22.0,
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
        let shown = self.frame.width() / self.pixels_per_metre * self.unit.0;
        // The longest round length within a quarter of the picture.
        let power = 10_f64.powf((0.25 * shown).log10().floor());
        let length = [5.0, 2.0, 1.0]
            .map(|multiple| multiple * power)
            .into_iter()
            .find(|length| *length <= 0.25 * shown)
            .unwrap_or(power);
        let pixels = length / self.unit.0 * self.pixels_per_metre;
        let (right, y) = (
            self.frame.right - 8.0,
            self.frame.bottom + DIRECTIONS - 22.0,
        );
        let stroke = Stroke::solid(INK, 2.0);
        canvas.line([right - pixels, y], [right, y], stroke);
        let at = [right - 0.5 * pixels, y - 7.0];
        let label = format!("{length} {}", self.unit.1);
        canvas.text(at, TICK_SIZE, Anchor::Middle, &label);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::canvas::{Colour, Shape};

    fn circles(canvas: &Canvas) -> Vec<([f64; 2], f64, Colour)> {
        canvas
            .shapes
            .iter()
            .filter_map(|shape| match shape {
                Shape::Circle {
                    centre,
                    radius,
                    fill,
                    ..
                } => Some((*centre, *radius, *fill)),
                _ => None,
            })
            .collect()
    }

    #[test]
    fn both_directions_have_the_same_scale_and_values_their_colours() {
        let positions = [
            Vec3::zeros(),
            Vec3::new(3e-3, 0.0, 0.0),
            Vec3::new(0.0, 2e-3, 0.0),
        ];
        let plot = ParticlePlot::new(&positions, &[0.0, 5.0, 10.0], "q", "", 1e-3);
        let canvas = draw(&plot).unwrap();
        let [a, b, c] = circles(&canvas)[..] else {
            panic!("three dots")
        };
        let (across, up) = (b.0[0] - a.0[0], a.0[1] - c.0[1]);
        assert!((across / 3.0 - up / 2.0).abs() < 1e-9, "{across} {up}");
        assert!((a.1 - 0.52 * across / 3.0).abs() < 1e-9);
        assert_eq!([a.2, b.2, c.2], [0.0, 0.5, 1.0].map(|x| plot.colours.at(x)));
    }

    #[test]
    fn nearer_particles_are_drawn_later() {
        let positions = [Vec3::new(0.0, -1.0, 0.0), Vec3::new(0.0, 1.0, 0.5)];
        let plot = ParticlePlot {
            view: View::Xz,
            ..ParticlePlot::new(&positions, &[1.0, 2.0], "q", "", 0.1)
        };
        let canvas = draw(&plot).unwrap();
        // Seen along +y the particle at y = -1 is nearer.
        let fills: Vec<Colour> = circles(&canvas)
            .iter()
            .map(|c| c.2)
            .filter(|fill| [plot.colours.at(0.0), plot.colours.at(1.0)].contains(fill))
            .collect();
        assert_eq!(fills, [plot.colours.at(1.0), plot.colours.at(0.0)]);
    }

    #[test]
    fn a_section_shows_its_particles_and_cells_only() {
        let positions: Vec<Vec3> = (0..8)
            .map(|i| Vec3::new(f64::from(i % 2), f64::from(i / 2 % 2), f64::from(i / 4)))
            .collect();
        let values = [1.0; 8];
        let mut plot = ParticlePlot {
            section: Some(Section {
                axis: Axis::Z,
                at: 0.0,
                thickness: 1.0,
            }),
            ..ParticlePlot::new(&positions, &values, "q", "", 1.0)
        };
        assert_eq!(circles(&draw(&plot).unwrap()).len(), 4);
        let cells = [[0, 1, 3, 2], [0, 1, 5, 4]];
        plot.cells = &cells;
        let middle = plot.colours.at(0.5);
        let canvas = draw(&plot).unwrap();
        let filled = canvas.shapes.iter().filter(|shape| {
            matches!(shape, Shape::Polygon { fill, outline: Some(_), .. } if *fill == middle)
        });
        assert_eq!(filled.count(), 1);
        plot.section = Some(Section {
            axis: Axis::Z,
            at: 9.0,
            thickness: 1.0,
        });
        assert!(matches!(
            draw(&plot),
            Err(OutputError::NothingToDraw { .. })
        ));
    }

    #[test]
    fn bad_fields_are_refused() {
        let positions = [Vec3::zeros(), Vec3::x()];
        let draw = |values: &[f64]| {
            draw(&ParticlePlot::new(
                &positions, values, "pressure", "Pa", 0.5,
            ))
            .unwrap_err()
        };
        assert!(matches!(
            draw(&[1.0]),
            OutputError::FieldLength { found: 1, .. }
        ));
        assert!(matches!(
            draw(&[1.0, f64::NAN]),
            OutputError::NotFinite { index: 1, .. }
        ));
    }
}
