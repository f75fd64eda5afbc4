//! Table and plot of a sweep.

use std::fmt::Write as _;
use std::path::Path;

use jstsph_case::Case;
use jstsph_output::plot::{Figure, LinePlot, Quantity, Scale, Series, SeriesStyle};
use jstsph_output::{Status, Summary, Table, atomic_write};
use jstsph_solver::Simulation;

use super::vary::Varied;
use crate::error::CliError;
use crate::plot::history::History;

/// Ratio of largest and smallest value from which an axis is logarithmic.
const WIDE: f64 = 30.0;

/// One run of a sweep.
#[derive(Debug, Clone)]
pub(super) struct Row {
    /// Number of the value of each key.
    pub(super) combination: Vec<usize>,
    /// `completed`, `failed`, `interrupted` or `not run`.
    pub(super) status: &'static str,
    /// Why it is not completed.
    pub(super) note: String,
    /// Folder below that of the sweep.
    pub(super) folder: String,
    pub(super) summary: Option<Summary>,
}

impl Row {
    pub(super) fn is_completed(&self) -> bool {
        let status = self.summary.as_ref().map(|summary| summary.status);
        status == Some(Status::Completed)
    }
}

/// Probes of a case by column.
pub(super) fn probes(case: &Case) -> Vec<String> {
    case.probes
        .iter()
        .flat_map(Simulation::probe_columns)
        .collect()
}

/// Names and values of the columns after the parameters.
fn numbers(summary: &Summary, probes: &[String]) -> Vec<(String, f64)> {
    let energies = &summary.energies;
    let extremes = &summary.extremes;
    #[expect(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
    let mut found = vec![
        ("particles".to_owned(), summary.particles as f64),
        ("steps".to_owned(), summary.steps as f64),
        ("simulated_time".to_owned(), summary.simulated_time),
        ("wall_seconds".to_owned(), summary.wall_seconds),
        ("energy_balance".to_owned(), energies.balance),
        ("kinetic_energy".to_owned(), energies.kinetic),
        ("elastic_energy".to_owned(), energies.elastic),
        ("plastic_energy".to_owned(), energies.plastic),
        ("numerical_energy".to_owned(), energies.numerical),
        (
            "largest_plastic_strain".to_owned(),
            extremes.equivalent_plastic_strain,
        ),
        ("smallest_jacobian".to_owned(), extremes.jacobian_min),
    ];
    let value = |name: &String| summary.probes.get(name).copied().unwrap_or(f64::NAN);
    let taken: Vec<String> = found.iter().map(|(name, _)| name.clone()).collect();
    for name in probes {
        let column = if taken.contains(name) {
            format!("probe_{name}")
        } else {
            name.clone()
        };
        found.push((column, value(name)));
    }
    found
}

/// Writes `sweep.csv`: one line per run, numbers in SI units, empty where there is none.
pub(super) fn write_csv(
    path: &Path,
    varied: &[Varied],
    probes: &[String],
    rows: &[Row],
) -> Result<(), CliError> {
    let names = numbers(&Summary::new("", Status::Completed), probes);
    let mut text = String::new();
    let keys = varied.iter().map(|varied| varied.name.as_str());
    let header = keys
        .chain(["status"])
        .chain(names.iter().map(|(name, _)| name.as_str()))
        .chain(["folder", "note"]);
    line(&mut text, header);
    for row in rows {
        let values = varied
            .iter()
            .zip(&row.combination)
            .map(|(varied, at)| varied.values[*at].trim_matches('"').to_owned());
        let numbers = match &row.summary {
            Some(summary) => numbers(summary, probes)
                .iter()
                .map(|(_, value)| shown(*value))
                .collect(),
            None => vec![String::new(); names.len()],
        };
        let cells: Vec<String> = values
            .chain([row.status.to_owned()])
            .chain(numbers)
            .chain([row.folder.clone(), row.note.clone()])
            .collect();
        line(&mut text, cells.iter().map(String::as_str));
    }
    atomic_write(path, |writer| writer.write_all(text.as_bytes())).map_err(CliError::Page)
}

fn shown(value: f64) -> String {
    if value.is_finite() {
        format!("{value}")
    } else {
        String::new()
    }
}

fn line<'a>(text: &mut String, cells: impl Iterator<Item = &'a str>) {
    let quoted: Vec<String> = cells
        .map(|cell| {
            if cell.contains([',', '"', '\n']) {
                format!("\"{}\"", cell.replace('"', "\"\""))
            } else {
                cell.to_owned()
            }
        })
        .collect();
    let _ = writeln!(text, "{}", quoted.join(","));
}

/// The table for people: parameters, state, steps, time, balance and probes.
pub(super) fn printed(varied: &[Varied], probes: &[String], rows: &[Row]) -> String {
    let mut cells: Vec<Vec<String>> = vec![
        varied
            .iter()
            .map(|varied| varied.name.clone())
            .chain(["status", "steps", "wall s", "balance %"].map(str::to_owned))
            .chain(probes.iter().cloned())
            .collect(),
    ];
    for row in rows {
        let mut line: Vec<String> = varied
            .iter()
            .zip(&row.combination)
            .map(|(varied, at)| varied.values[*at].clone())
            .collect();
        line.push(row.status.to_owned());
        if let Some(summary) = &row.summary {
            line.push(summary.steps.to_string());
            line.push(format!("{:.1}", summary.wall_seconds));
            line.push(format!("{:+.3}", 100.0 * summary.energies.balance));
            line.extend(probes.iter().map(|name| {
                let value = summary.probes.get(name).copied().unwrap_or(f64::NAN);
                if value.is_finite() {
                    format!("{value:.5e}")
                } else {
                    "-".to_owned()
                }
            }));
        } else {
            line.push(row.note.clone());
        }
        cells.push(line);
    }
    let width = |column: usize| {
        let wide = cells.iter().filter(|line| line.len() > column + 1);
        wide.map(|line| line[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..cells[0].len()).map(width).collect();
    let mut text = String::new();
    for line in &cells {
        let padded: Vec<String> = line
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{cell:<width$}"))
            .collect();
        let _ = writeln!(text, "  {}", padded.join("  ").trim_end());
    }
    text
}

/// A probe against the first key, a curve for each combination of the others; `None` when no run
/// has a value.
pub(super) fn figure(
    case: &Case,
    varied: &[Varied],
    probe: &str,
    rows: &[Row],
) -> Result<Option<Figure>, CliError> {
    let first = &varied[0];
    let places = places(first, rows);
    let mut series: Vec<Series> = Vec::new();
    for row in rows.iter().filter(|row| row.is_completed()) {
        let value = row
            .summary
            .as_ref()
            .and_then(|found| found.probes.get(probe));
        let (Some(value), place) = (value, places.values[row.combination[0]]) else {
            continue;
        };
        if !value.is_finite() || !place.is_finite() {
            continue;
        }
        let label = label(varied, &row.combination, probe);
        match series.iter_mut().find(|series| series.label == label) {
            Some(series) => series.points.push((place, *value)),
            None => series.push(Series {
                label,
                points: vec![(place, *value)],
                style: SeriesStyle::LineWithMarkers,
                ..Series::default()
            }),
        }
    }
    if series.is_empty() {
        return Ok(None);
    }
    for series in &mut series {
        series.points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    let table = Table {
        columns: Vec::new(),
        rows: Vec::new(),
    };
    let history = History::new(case, &table);
    let finite = || places.values.iter().copied().filter(|x| x.is_finite());
    let lowest = finite().fold(f64::INFINITY, f64::min);
    let highest = finite().fold(0.0, f64::max);
    let plot = LinePlot {
        title: crate::plot::heading(case).to_owned(),
        x: Quantity::new(places.name, places.unit),
        y: Quantity::new(probe.replace('_', " "), history.unit(probe)),
        x_scale: if lowest > 0.0 && highest > WIDE * lowest {
            Scale::Logarithmic
        } else {
            Scale::Linear
        },
        series,
        ..LinePlot::default()
    };
    Figure::lines(&plot).map(Some).map_err(CliError::Picture)
}

/// Places of the values of a key along the axis.
struct Places {
    name: String,
    unit: String,
    values: Vec<f64>,
}

/// Numbers stand at their value, lattices at their number of particles, anything else at its number
/// in the list.
#[expect(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
fn places(first: &Varied, rows: &[Row]) -> Places {
    if let Some(values) = first.numbers() {
        return Places {
            name: first.name.clone(),
            unit: first.unit(),
            values,
        };
    }
    let particles: Vec<f64> = (0..first.values.len())
        .map(|at| {
            rows.iter()
                .filter(|row| row.combination[0] == at)
                .find_map(|row| row.summary.as_ref())
                .map_or(f64::NAN, |summary| summary.particles as f64)
        })
        .collect();
    let mut sorted: Vec<f64> = particles
        .iter()
        .copied()
        .filter(|n| n.is_finite())
        .collect();
    sorted.sort_by(f64::total_cmp);
    if sorted.windows(2).all(|pair| pair[0] < pair[1]) {
        return Places {
            name: "particles".to_owned(),
            unit: String::new(),
            values: particles,
        };
    }
    Places {
        name: format!("{} (1: {}, ...)", first.name, first.values[0]),
        unit: String::new(),
        values: (1..=first.values.len())
            .map(|number| number as f64)
            .collect(),
    }
}

/// Values of the keys after the first; the probe itself when there are none.
fn label(varied: &[Varied], combination: &[usize], probe: &str) -> String {
    let others: Vec<String> = varied
        .iter()
        .zip(combination)
        .skip(1)
        .map(|(varied, at)| format!("{} = {}", varied.name, varied.values[*at]))
        .collect();
    if others.is_empty() {
        probe.replace('_', " ")
    } else {
        others.join(", ")
    }
}
