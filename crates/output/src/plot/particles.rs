//! Bodies coloured by a field: what to draw.

use jstsph_tensor::Vec3;

use super::canvas::{Canvas, Dash, INK, PAPER, Stroke, mix};
use super::colorbar::ColourBar;
use super::extent::window;
use super::hidden::visible;
use super::panels::{Panel, Panels};
use super::{ColourMap, Group, Quantity, Section, View, Wall, cells, walls};
use crate::OutputError;
use crate::error::{require_finite, require_length};

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
    /// Quadrilaterals to fill, by particle, the field interpolated between their corners; those
    /// with a corner outside the section are left out. Particles of no cell are drawn as dots.
    pub cells: &'a [[usize; 4]],
    /// Lines of obstacles; cut off at the edge of the picture.
    pub walls: Vec<Wall>,
    /// Lines of the undeformed body, drawn light and dashed; left out where the body has moved so
    /// far that they would more than double the area of the picture.
    pub undeformed: Vec<Vec<Vec3>>,
    /// Names of the groups whose numbers the values are; empty for a field.
    pub groups: &'a [Group],
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
            walls: Vec::new(),
            undeformed: Vec::new(),
            groups: &[],
            colours: ColourMap::default(),
            range: None,
            window: None,
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

    fn is_shown(&self, particle: usize) -> bool {
        self.section
            .is_none_or(|section| section.contains(&self.positions[particle]))
    }

    pub(super) fn project(&self, x: &Vec3) -> [f64; 2] {
        let [right, up, _] = self.view.frame();
        [right.dot(x), up.dot(x)]
    }

    pub(super) fn depth(&self, x: &Vec3) -> f64 {
        self.view.frame()[2].dot(x)
    }
}

/// A particle in the plane of view.
#[derive(Clone, Copy)]
pub(super) struct Dot {
    particle: usize,
    pub(super) place: [f64; 2],
    depth: f64,
}

/// Draws plots in rows of so many, with a common scale, window and colour bar.
pub(crate) fn draw(
    heading: &str,
    columns: usize,
    plots: &[ParticlePlot],
) -> Result<Canvas, OutputError> {
    let common = Common::new(heading, plots)?;
    Ok(common.draw(heading, columns, plots, &common.dots))
}

/// Draws plots one by one, with the scale, window and colour bar that they have in common.
pub(crate) fn sequence(heading: &str, plots: &[ParticlePlot]) -> Result<Vec<Canvas>, OutputError> {
    let common = Common::new(heading, plots)?;
    let each = plots.iter().zip(&common.dots);
    Ok(each
        .map(|(plot, dots)| {
            let (plot, dots) = (std::slice::from_ref(plot), std::slice::from_ref(dots));
            common.draw(heading, 1, plot, dots)
        })
        .collect())
}

/// What several plots have in common, and the particles that they show.
struct Common {
    dots: Vec<Vec<Dot>>,
    window: [[f64; 2]; 2],
    shows_undeformed: bool,
    bar: ColourBar,
}

impl Common {
    fn new(heading: &str, plots: &[ParticlePlot]) -> Result<Self, OutputError> {
        let nothing = |title: &str, reason| OutputError::NothingToDraw {
            title: title.to_owned(),
            reason,
        };
        let first = plots
            .first()
            .ok_or_else(|| nothing(heading, "no plot was given"))?;
        let mut dots = Vec::with_capacity(plots.len());
        for plot in plots {
            plot.check()?;
            let shown: Vec<Dot> = (0..plot.positions.len())
                .filter(|&particle| plot.is_shown(particle))
                .map(|particle| Dot {
                    particle,
                    place: plot.project(&plot.positions[particle]),
                    depth: plot.depth(&plot.positions[particle]),
                })
                .collect();
            if shown.is_empty() {
                return Err(nothing(&plot.title, "no particle lies in the section"));
            }
            dots.push(shown);
        }
        let (window, shows_undeformed) = window(plots, &dots);
        let values = plots
            .iter()
            .zip(&dots)
            .flat_map(|(plot, dots)| dots.iter().map(|dot| plot.values[dot.particle]));
        let bar = ColourBar::new(first, values);
        Ok(Self {
            dots,
            window,
            shows_undeformed,
            bar,
        })
    }

    fn draw(
        &self,
        heading: &str,
        columns: usize,
        plots: &[ParticlePlot],
        dots: &[Vec<Dot>],
    ) -> Canvas {
        let titles: Vec<&str> = plots.iter().map(|plot| plot.title.as_str()).collect();
        let (view, bar) = (plots[0].view, &self.bar);
        let panels = Panels::new(heading, &titles, columns, view, self.window, bar);
        let mut canvas = Canvas::new(panels.size[0], panels.size[1]);
        for (number, (plot, dots)) in plots.iter().zip(dots).enumerate() {
            let panel = panels.panel(number);
            let is_flat = plot.view.plane().is_some();
            if !is_flat {
                walls::draw(&mut canvas, plot, &panel);
            }
            let cells = draw_body(&mut canvas, plot, dots.clone(), &panel, &self.bar);
            if self.shows_undeformed {
                for line in &plot.undeformed {
                    walls::draw_line(&mut canvas, plot, line, &panel, UNDEFORMED);
                }
            }
            if is_flat {
                // Above the undeformed body, which often has edges in common with both.
                for line in cells::outline(&cells) {
                    let line: Vec<Vec3> = line.iter().map(|&a| plot.positions[a]).collect();
                    walls::draw_line(&mut canvas, plot, &line, &panel, Stroke::solid(INK, 1.0));
                }
                walls::draw(&mut canvas, plot, &panel);
            }
        }
        panels.draw(&mut canvas);
        self.bar.draw(&mut canvas, &panels.whole_frame());
        canvas
    }
}

const UNDEFORMED: Stroke = Stroke {
    colour: [138, 143, 150],
    width: 1.0,
    dash: Dash::Dashes,
};

/// Draws cells and dots, and returns the cells that are shown.
fn draw_body(
    canvas: &mut Canvas,
    plot: &ParticlePlot,
    mut dots: Vec<Dot>,
    panel: &Panel,
    bar: &ColourBar,
) -> Vec<[usize; 4]> {
    let shown = plot
        .cells
        .iter()
        .filter(|cell| cell.iter().all(|&a| plot.is_shown(a)));
    let cells: Vec<[usize; 4]> = shown.copied().collect();
    let mut is_in_cell = vec![false; plot.positions.len()];
    for &corner in cells.iter().flatten() {
        is_in_cell[corner] = true;
    }
    dots.retain(|dot| !is_in_cell[dot.particle]);
    draw_dots(canvas, plot, dots, panel, bar);
    cells::draw(canvas, plot, &cells, panel, bar);
    cells
}

fn draw_dots(
    canvas: &mut Canvas,
    plot: &ParticlePlot,
    mut dots: Vec<Dot>,
    panel: &Panel,
    bar: &ColourBar,
) {
    let nearest = dots.iter().map(|d| d.depth).fold(f64::MIN, f64::max);
    let farthest = dots.iter().map(|d| d.depth).fold(f64::MAX, f64::min);
    let is_deep = nearest - farthest > 1.5 * plot.spacing;
    let radius = (0.52 * plot.spacing * panel.pixels_per_metre).max(0.7);
    // Stable, so that particles of one layer keep their order and pictures are reproducible.
    dots.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    dots.reverse();
    let centres: Vec<[f64; 2]> = dots.iter().map(|dot| panel.place(dot.place)).collect();
    let is_visible = visible(&centres, radius, &panel.frame);
    for ((dot, centre), is_visible) in dots.iter().zip(centres).zip(is_visible).rev() {
        if !is_visible || !panel.frame.contains(centre) {
            continue;
        }
        let colour = bar.colour(plot.values[dot.particle]);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::Axis;
    use crate::plot::canvas::{Colour, Shape};

    fn draw(plot: &ParticlePlot) -> Result<Canvas, OutputError> {
        super::draw("", 1, std::slice::from_ref(plot))
    }

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
        let filled = canvas
            .shapes
            .iter()
            .filter(|shape| matches!(shape, Shape::Patch { fill, .. } if *fill == middle));
        // Of one cell: what is below its pieces, and one piece.
        assert_eq!(filled.count(), 2);
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

    #[test]
    fn particles_of_no_cell_are_dots() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0]];
        let positions = square.map(|[x, y]| Vec3::new(x, y, 0.0));
        let plot = ParticlePlot {
            cells: &[[0, 1, 2, 3]],
            ..ParticlePlot::new(&positions, &[0.0, 1.0, 2.0, 3.0, 9.0], "q", "", 1.0)
        };
        let canvas = draw(&plot).unwrap();
        let dots = circles(&canvas);
        assert_eq!(dots.len(), 1);
        assert_eq!(dots[0].2, plot.colours.at(1.0));
        let patches = canvas
            .shapes
            .iter()
            .filter(|shape| matches!(shape, Shape::Patch { .. }));
        // The cell is cut into many pieces of different colours.
        assert!(patches.count() > 100);
    }

    #[test]
    fn panels_share_scale_and_colours() {
        let small = [Vec3::zeros(), Vec3::new(1.0, 1.0, 0.0)];
        let large = [Vec3::zeros(), Vec3::new(2.0, 1.0, 0.0)];
        let plots = [
            ParticlePlot::new(&small, &[0.0, 1.0], "q", "", 0.1),
            ParticlePlot::new(&large, &[0.0, 4.0], "q", "", 0.1),
        ];
        let canvas = super::draw("heading", 2, &plots).unwrap();
        let [a, b, c, d] = circles(&canvas)[..] else {
            panic!("four dots")
        };
        let (first, second) = (b.0[0] - a.0[0], d.0[0] - c.0[0]);
        assert!((second - 2.0 * first).abs() < 1e-9, "{first} {second}");
        assert_eq!(a.0[1], c.0[1]);
        assert_eq!(b.2, plots[0].colours.at(0.25));
        assert_eq!(d.2, plots[0].colours.at(1.0));
        assert!(matches!(
            super::draw("none", 1, &[]),
            Err(OutputError::NothingToDraw { .. })
        ));
    }

    #[test]
    fn the_undeformed_body_is_shown_unless_it_is_far_away() {
        let positions = [Vec3::zeros(), Vec3::new(1.0, 1.0, 0.0)];
        let dashed = |shift: f64| {
            let plot = ParticlePlot {
                undeformed: vec![vec![
                    Vec3::new(0.0, shift, 0.0),
                    Vec3::new(1.0, shift + 1.0, 0.0),
                ]],
                ..ParticlePlot::new(&positions, &[0.0, 1.0], "q", "", 0.1)
            };
            let canvas = draw(&plot).unwrap();
            let lines = canvas.shapes.iter();
            lines
                .filter(|shape| matches!(shape, Shape::Polyline { stroke, .. } if stroke.dash == Dash::Dashes))
                .count()
        };
        assert_eq!(dashed(0.5), 1);
        assert_eq!(dashed(5.0), 0);
    }
}
