//! A body, or several, coloured by a field, with what is around them.

use jstsph_case::Case;
use jstsph_case::units::Measure;
use jstsph_geometry::{Axis, Cells, Dimension, Shape};
use jstsph_output::OutputError;
use jstsph_output::plot::{Animation, Figure, ParticlePlot, View, Wall};
use jstsph_tensor::Vec3;

use super::frames::Chosen;
use super::{field, heading, lines};
use crate::arguments::{Look, ValueRange, ViewName};
use crate::error::CliError;

/// How near a particle must be to the middle layer to belong to it, in spacings.
const SAME_LAYER: f64 = 1e-4;

/// What the body is seen from, and whether it is cut open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sight {
    /// Axes to the right, up and along the view; `None` for the oblique view.
    pub(crate) plane: Option<[usize; 3]>,
    pub(crate) is_cut: bool,
}

impl Sight {
    /// What was asked for, or what shows most: plane strain as it is, solids cut through the
    /// middle along a plane that contains the axis of a cylinder.
    pub(super) fn new(case: &Case, look: &Look) -> Self {
        let is_solid = case.model.dimension == Dimension::Solid;
        let view = look.view.unwrap_or(if is_solid {
            match case.model.bodies[0].body.shape {
                Shape::Cylinder { axis: Axis::Y, .. } => ViewName::Xy,
                _ => ViewName::Xz,
            }
        } else {
            ViewName::Xy
        });
        Self {
            plane: match view {
                ViewName::Xy => Some([0, 1, 2]),
                ViewName::Xz => Some([0, 2, 1]),
                ViewName::Yz => Some([1, 2, 0]),
                ViewName::Oblique => None,
            },
            is_cut: is_solid && (look.section || look.view.is_none()),
        }
    }

    pub(super) fn view(self, case: &Case) -> View {
        match self.plane {
            Some([0, 1, _]) => View::Xy,
            Some([0, ..]) => View::Xz,
            Some(_) => View::Yz,
            None if case.model.dimension == Dimension::Solid => {
                View::Oblique(jstsph_output::plot::Axis::Z)
            }
            None => View::Oblique(jstsph_output::plot::Axis::Y),
        }
    }
}

impl ValueRange {
    /// The ends, if their unit is that of the field.
    fn values(&self, field: &str, unit: &str) -> Result<(f64, f64), CliError> {
        let fits = |measure: &Measure| match measure.to_string().as_str() {
            "1" => unit.is_empty(),
            other => other == unit,
        };
        match self.measures.iter().flatten().find(|m| !fits(m)) {
            None => Ok((self.from, self.to)),
            Some(measure) => Err(CliError::RangeUnit {
                field: field.to_owned(),
                found: measure.description(),
                unit: if unit.is_empty() { "1" } else { unit }.to_owned(),
            }),
        }
    }
}

/// The particles to draw, by index, and cells between them, by place in that list.
struct Shown {
    particles: Vec<usize>,
    cells: Vec<[usize; 4]>,
}

/// Frames of a run to draw.
pub(super) struct Drawn<'a> {
    pub(super) case: &'a Case,
    pub(super) chosen: &'a [Chosen],
    /// Name of the run in titles; empty when there is only one.
    pub(super) label: &'a str,
}

/// A body with what is around it at one time.
struct Picture {
    title: String,
    positions: Vec<Vec3>,
    values: Vec<f64>,
    cells: Vec<[usize; 4]>,
    walls: Vec<Wall>,
    undeformed: Vec<Vec<Vec3>>,
    spacing: f64,
}

/// Draws the chosen frames of one run, or of several, side by side; several frames of several runs
/// in a row for each run.
pub(super) fn figure(
    runs: &[Drawn<'_>],
    name: &str,
    look: &Look,
    title: Option<&str>,
) -> Result<Figure, CliError> {
    let frames = runs.iter().map(|run| run.chosen.len()).max().unwrap_or(1);
    with_plots(runs, name, look, |heading, plots| {
        let columns = if frames > 1 { frames } else { plots.len() };
        Figure::grid(title.unwrap_or(heading), columns, plots)
    })
}

/// Draws the chosen frames of a run one after the other.
pub(super) fn animation(run: Drawn<'_>, name: &str, look: &Look) -> Result<Animation, CliError> {
    with_plots(&[run], name, look, |heading, plots| {
        Animation::new(heading, plots)
    })
}

fn with_plots<T>(
    runs: &[Drawn<'_>],
    name: &str,
    look: &Look,
    draw: impl FnOnce(&str, &[ParticlePlot]) -> Result<T, OutputError>,
) -> Result<T, CliError> {
    let case = runs[0].case;
    let sight = Sight::new(case, look);
    let mut pictures = Vec::new();
    for run in runs {
        pictures.extend(self::pictures(run, sight, name)?);
    }
    let quantity = field::quantity(&runs[0].chosen[0].frame, name);
    let values = pictures.iter().flat_map(|picture| &picture.values);
    let (colours, range) = field::colours(values.copied());
    let range = match &look.range {
        Some(range) => Some(range.values(name, &quantity.unit)?),
        None => range,
    };
    let plots: Vec<ParticlePlot> = pictures
        .iter()
        .map(|picture| ParticlePlot {
            title: picture.title.clone(),
            view: sight.view(case),
            cells: &picture.cells,
            walls: picture.walls.clone(),
            undeformed: picture.undeformed.clone(),
            colours,
            range,
            ..ParticlePlot::new(
                &picture.positions,
                &picture.values,
                quantity.name.clone(),
                quantity.unit.clone(),
                picture.spacing,
            )
        })
        .collect();
    let is_one = runs.iter().all(|run| heading(run.case) == heading(case));
    draw(if is_one { heading(case) } else { "" }, &plots).map_err(CliError::Picture)
}

fn pictures(run: &Drawn<'_>, sight: Sight, name: &str) -> Result<Vec<Picture>, CliError> {
    let case = run.case;
    let bodies = &case.model.bodies;
    let reference: Vec<Vec3> = bodies
        .iter()
        .flat_map(|body| body.body.positions.iter().copied())
        .collect();
    let spacings = bodies.iter().map(|body| body.body.spacing);
    let spacing = spacings.fold(f64::INFINITY, f64::min);
    let (low, high) = box_of(reference.iter());
    let middle = 0.5 * (low + high);
    let shown = select(case, &reference, sight, &middle, spacing);

    let mut pictures = Vec::with_capacity(run.chosen.len());
    for chosen in run.chosen {
        let frame = &chosen.frame;
        if frame.positions.len() != reference.len() {
            return Err(CliError::ForeignFrame {
                found: frame.positions.len(),
                expected: reference.len(),
            });
        }
        let all = field::values(frame, name)?;
        let is_first = frame.time <= 0.0;
        pictures.push(Picture {
            title: match run.label {
                "" => chosen.title(),
                label => format!("{label}, {}", chosen.title()),
            },
            positions: shown
                .particles
                .iter()
                .map(|&a| frame.positions[a])
                .collect(),
            values: shown.particles.iter().map(|&a| all[a]).collect(),
            cells: shown.cells.clone(),
            walls: Vec::new(),
            undeformed: if is_first {
                Vec::new()
            } else {
                lines::undeformed(case, sight)
            },
            spacing,
        });
    }
    // Obstacles reach around the body in all pictures.
    let corners = box_of(pictures.iter().flat_map(|picture| &picture.positions));
    for (picture, chosen) in pictures.iter_mut().zip(run.chosen) {
        picture.walls = lines::walls(case, sight, &middle, corners, chosen.frame.time);
    }
    Ok(pictures)
}

fn select(case: &Case, reference: &[Vec3], sight: Sight, middle: &Vec3, spacing: f64) -> Shown {
    let mut shown = Shown {
        particles: Vec::new(),
        cells: Vec::new(),
    };
    let mut first = 0;
    for body in &case.model.bodies {
        let body = &body.body;
        let range = first..first + body.positions.len();
        let place = shown.particles.len();
        match (sight.plane, sight.is_cut) {
            (Some(axes), true) => {
                let normal = axes[2];
                let distance =
                    |a: &usize, from: f64| (reference[*a][normal] - from).abs() / spacing;
                let nearest = range.clone().min_by(|a, b| {
                    distance(a, middle[normal]).total_cmp(&distance(b, middle[normal]))
                });
                let at = nearest.map_or(0.0, |a| reference[a][normal]);
                let within = |limit: f64| -> Vec<usize> {
                    range.clone().filter(|a| distance(a, at) <= limit).collect()
                };
                let mut layer = within(SAME_LAYER);
                let mut cells = sheet(reference, &layer, axes, spacing);
                if !is_covered(layer.len(), &cells) {
                    cells.clear();
                    layer = within(0.5);
                }
                shown.particles.extend(layer);
                shown
                    .cells
                    .extend(cells.iter().map(|cell| cell.map(|a| place + a)));
            }
            (None, true) => {
                // The oblique view looks towards y: what is in front of the cut goes.
                let half = range
                    .clone()
                    .filter(|&a| reference[a].y >= middle.y - SAME_LAYER * spacing);
                shown.particles.extend(half);
            }
            (_, false) => {
                shown.particles.extend(range.clone());
                if let Cells::Quads(cells) = &body.cells {
                    let cells: Vec<[usize; 4]> =
                        cells.iter().map(|cell| cell.map(|a| a as usize)).collect();
                    if is_covered(range.len(), &cells) {
                        let moved = cells.iter().map(|cell| cell.map(|a| place + a));
                        shown.cells.extend(moved);
                    }
                }
            }
        }
        first = range.end;
    }
    shown
}

/// Whether every particle is the corner of a cell. Round bodies on a lattice have others, and their
/// full cells alone would show another shape: they are drawn as dots.
fn is_covered(particles: usize, cells: &[[usize; 4]]) -> bool {
    let corners: std::collections::HashSet<usize> = cells.iter().flatten().copied().collect();
    corners.len() == particles
}

/// Quadrilaterals between the particles of a layer that stand on the crossings of two sets of
/// lines, by place in the layer.
fn sheet(reference: &[Vec3], layer: &[usize], axes: [usize; 3], spacing: f64) -> Vec<[usize; 4]> {
    let lines = [axes[0], axes[1]].map(|axis| {
        let mut coordinates: Vec<f64> = layer.iter().map(|&a| reference[a][axis]).collect();
        coordinates.sort_by(f64::total_cmp);
        coordinates.dedup_by(|a, b| (*a - *b).abs() <= SAME_LAYER * spacing);
        coordinates
    });
    let line = |i: usize, coordinate: f64| {
        lines[i].partition_point(|other| *other < coordinate - SAME_LAYER * spacing)
    };
    let crossings: std::collections::HashMap<[usize; 2], usize> = layer
        .iter()
        .enumerate()
        .map(|(place, &a)| {
            let x = &reference[a];
            ([line(0, x[axes[0]]), line(1, x[axes[1]])], place)
        })
        .collect();
    (0..layer.len())
        .filter_map(|place| {
            let x = &reference[layer[place]];
            let [i, j] = [line(0, x[axes[0]]), line(1, x[axes[1]])];
            let corner = |i: usize, j: usize| crossings.get(&[i, j]).copied();
            Some([
                corner(i, j)?,
                corner(i + 1, j)?,
                corner(i + 1, j + 1)?,
                corner(i, j + 1)?,
            ])
        })
        .collect()
}

/// Lowest and highest coordinates.
pub(crate) fn box_of<'a>(points: impl Iterator<Item = &'a Vec3>) -> (Vec3, Vec3) {
    let start = (Vec3::repeat(f64::MAX), Vec3::repeat(f64::MIN));
    points.fold(start, |(low, high), x| (low.inf(x), high.sup(x)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_joins_the_points_of_a_layer_and_leaves_holes_open() {
        // Three by three points with uneven distances in the x-z plane, one corner missing.
        let mut points = Vec::new();
        for z in [0.0, 1.0, 3.0] {
            for x in [0.0, 0.5, 2.0] {
                points.push(Vec3::new(x, 7.0, z));
            }
        }
        let layer: Vec<usize> = (0..8).collect();
        let cells = sheet(&points, &layer, [0, 2, 1], 0.5);
        assert_eq!(cells, [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6]]);
        assert!(sheet(&points, &[0, 1, 2], [0, 2, 1], 0.5).is_empty());
    }

    #[test]
    fn a_cylinder_is_cut_through_its_axis() {
        let case = |shape: &str| {
            let text = format!(
                "dimension = \"3d\"\n[time]\nend = 1e-6\n[[body]]\nname = \"b\"\nshape = {shape}\n\
                 lattice = {{ per_radius = 2, layers = 4 }}\nmaterial = \"copper_taylor\"\n"
            );
            jstsph_case::parse("b", "b.toml", &text, &[]).expect("a case")
        };
        let upright = case(
            "{ cylinder = { base = [0, 0, 0], axis = \"z\", radius = 0.002, height = 0.003 } }",
        );
        let sight = Sight::new(&upright, &Look::default());
        assert_eq!(sight.plane, Some([0, 2, 1]));
        let positions = &upright.model.bodies[0].body.positions;
        let shown = select(
            &upright,
            positions,
            sight,
            &Vec3::new(0.0, 0.0, 1.5e-3),
            1e-3,
        );
        // Five points across, four layers; every gap between four of them is a cell.
        assert_eq!((shown.particles.len(), shown.cells.len()), (20, 12));
        // The lattice points on the rim are in no full cell of a cut across.
        let across = Sight {
            plane: Some([0, 1, 2]),
            is_cut: true,
        };
        let middle = Vec3::new(0.0, 0.0, 1.5e-3);
        let shown = select(&upright, positions, across, &middle, 1e-3);
        assert_eq!((shown.particles.len(), shown.cells.len()), (13, 0));
        let across = case(
            "{ cylinder = { base = [0, 0, 0], axis = \"y\", radius = 0.002, height = 0.003 } }",
        );
        assert_eq!(Sight::new(&across, &Look::default()).plane, Some([0, 1, 2]));
        let outside = Look {
            view: Some(ViewName::Xz),
            ..Look::default()
        };
        assert!(!Sight::new(&upright, &outside).is_cut);
    }
}
