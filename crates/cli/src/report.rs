//! `jstsph report`: one HTML file with the numbers, curves and an interactive view of a run.

use std::path::Path;

use jstsph_case::Case;
use jstsph_geometry::Dimension;
use jstsph_output::report::{Report, ReportField, ReportObstacle};
use jstsph_output::{Collection, ResultsFolder, StoredFrame, Table, read_table, read_vtu};
use jstsph_tensor::Vec3;

use crate::arguments::ReportOptions;
use crate::console::Console;
use crate::error::CliError;
use crate::plot::body::{Sight, box_of};
use crate::plot::history::History;
use crate::plot::{field, heading, lines};

/// Fields that people look at first.
const FIRST: [&str; 3] = ["equivalent_plastic_strain", "von_mises_stress", "pressure"];

/// Writes the report of a results folder.
pub(crate) fn run(options: &ReportOptions, console: &mut Console<'_>) -> Result<u8, CliError> {
    let results = &options.results;
    let case = results.join("case.toml");
    if !case.is_file() {
        let path = results.clone();
        return Err(CliError::NoResults { path });
    }
    let case = jstsph_case::load(&case, &[])?;
    let path = match &options.output {
        Some(path) => path.clone(),
        None => results.join(ResultsFolder::REPORT),
    };
    let collection = Collection::read(&results.join("frames").join("frames.pvd"));
    let collection = collection.map_err(CliError::Picture)?;
    let Some((_, last)) = collection.entries().last() else {
        let path = results.clone();
        return Err(CliError::NoFrames { path });
    };
    let last = read_vtu(&results.join("frames").join(last)).map_err(CliError::Picture)?;
    let particles = case.particles();
    if last.positions.len() != particles {
        return Err(CliError::ForeignFrame {
            found: last.positions.len(),
            expected: particles,
        });
    }
    let times: Vec<f64> = collection.entries().iter().map(|(time, _)| *time).collect();
    let table = table(results)?;
    let report = report(&case, &last, &times, &table)?;
    let size = report.write(results, &path).map_err(CliError::Picture)?;
    let mut frames = if size.frames < size.total_frames {
        format!("{} of {} frames", size.frames, size.total_frames)
    } else {
        format!("{} frames", size.frames)
    };
    if size.is_quantised {
        frames += ", fields rounded to 16 bits";
    }
    if size.particles < size.total_particles {
        frames += &format!(", {} of {} particles", size.particles, size.total_particles);
    }
    let megabytes = size.bytes as f64 / 1e6;
    console.print(format_args!(
        "wrote {} ({megabytes:.1} MB, {frames}); open it in a browser\n",
        path.display()
    ));
    Ok(0)
}

/// The history of a run; without rows if it has none.
fn table(results: &Path) -> Result<Table, CliError> {
    let path = results.join("history.csv");
    if !path.is_file() {
        return Ok(Table::default());
    }
    read_table(&path).map_err(CliError::Picture)
}

fn report<'a>(
    case: &'a Case,
    last: &StoredFrame,
    times: &[f64],
    table: &Table,
) -> Result<Report<'a>, CliError> {
    let is_solid = case.model.dimension == Dimension::Solid;
    let history = History::new(case, table);
    let bodies = case.model.bodies.iter();
    let spacing = bodies
        .map(|body| body.body.spacing)
        .fold(f64::INFINITY, f64::min);
    Ok(Report {
        case: &case.name,
        heading: heading(case),
        is_solid,
        spacing,
        fields: fields(last, is_solid),
        undeformed: lines::undeformed(case, sight(is_solid)),
        obstacles: obstacles(case, last, times),
        diagrams: if table.rows.is_empty() {
            Vec::new()
        } else {
            history.diagrams()?
        },
        energy_unit: history.per_thickness("J"),
        probe_units: table
            .columns
            .iter()
            .map(|name| (name.clone(), history.unit(name)))
            .collect(),
    })
}

fn sight(is_solid: bool) -> Sight {
    Sight {
        plane: (!is_solid).then_some([0, 1, 2]),
        is_cut: false,
    }
}

/// All scalars, vectors with their magnitudes and components, and the six (in plane strain four)
/// different components of the stress.
fn fields(frame: &StoredFrame, is_solid: bool) -> Vec<ReportField> {
    let scalars = frame.scalars.iter().map(|(name, _)| name.as_str());
    let mut scalars: Vec<&str> = scalars.collect();
    scalars.sort_by_key(|name| {
        FIRST
            .iter()
            .position(|first| first == name)
            .unwrap_or(FIRST.len())
    });
    let mut names: Vec<(String, bool)> = scalars
        .iter()
        .map(|name| ((*name).to_owned(), false))
        .collect();
    let axes: &[&str] = if is_solid {
        &["x", "y", "z"]
    } else {
        &["x", "y"]
    };
    for (vector, _) in &frame.vectors {
        names.push((vector.clone(), false));
        names.extend(axes.iter().map(|axis| (format!("{vector}_{axis}"), true)));
    }
    let components: &[&str] = if is_solid {
        &["xx", "yy", "zz", "xy", "yz", "xz"]
    } else {
        &["xx", "yy", "zz", "xy"]
    };
    let stress = components
        .iter()
        .map(|c| (format!("cauchy_stress_{c}"), true));
    names.extend(stress.filter(|_| frame.tensor("cauchy_stress").is_some()));
    let names = names.into_iter();
    names
        .map(|(name, is_component)| ReportField {
            quantity: field::quantity(frame, &name),
            name,
            is_component,
        })
        .collect()
}

fn obstacles(case: &Case, last: &StoredFrame, times: &[f64]) -> Vec<ReportObstacle> {
    let sight = sight(case.model.dimension == Dimension::Solid);
    let bodies = case.model.bodies.iter();
    let reference = bodies.flat_map(|body| body.body.positions.iter());
    let corners = box_of(reference.chain(last.positions.iter()));
    let middle = 0.5 * (corners.0 + corners.1);
    let named = case.model.obstacles.iter();
    named
        .map(|obstacle| ReportObstacle {
            name: obstacle.obstacle.name.clone(),
            walls: lines::walls_of(obstacle, sight, &middle, corners, &Vec3::zeros()),
            displacements: if obstacle.velocity.is_some() {
                let moved = times
                    .iter()
                    .map(|time| lines::displacement(obstacle, *time));
                moved.collect::<Vec<Vec3>>()
            } else {
                Vec::new()
            },
        })
        .collect()
}
