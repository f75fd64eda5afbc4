//! One point per run: a column of `history.csv` at one time against a number of `summary.json`.

use jstsph_output::plot::{LinePlot, Quantity, Series, SeriesStyle};
use jstsph_output::{OutputError, Summary};

use super::curves::Told;
use super::history::{History, shown};
use super::moment;
use crate::error::CliError;

/// A diagram for every column; runs of one label are one curve.
pub(super) fn diagrams(
    runs: &[Told<'_>],
    summaries: &[Summary],
    names: &[&str],
    against: &str,
    at: Option<f64>,
) -> Result<Vec<LinePlot>, CliError> {
    names
        .iter()
        .map(|name| {
            let first = History::new(runs[0].case, runs[0].table);
            let mut label = shown(name);
            if let Some(time) = at {
                let (number, unit) = moment(time);
                label = format!("{label} at {number} {unit}");
            }
            let mut plot = LinePlot {
                x: Quantity::new(against.replace(['_', '.'], " "), unit(against)),
                y: Quantity::new(label, first.unit(name)),
                ..LinePlot::default()
            };
            for (run, summary) in runs.iter().zip(summaries) {
                let history = History::new(run.case, run.table);
                let point = (number(summary, against)?, value(&history, name, at)?);
                if !point.1.is_finite() {
                    continue;
                }
                match plot.series.iter_mut().find(|s| s.label == run.label) {
                    Some(series) => series.points.push(point),
                    None => plot.series.push(Series {
                        label: run.label.to_owned(),
                        points: vec![point],
                        style: SeriesStyle::LineWithMarkers,
                        ..Series::default()
                    }),
                }
            }
            for series in &mut plot.series {
                series.points.sort_by(|a, b| a.0.total_cmp(&b.0));
            }
            Ok(plot)
        })
        .collect()
}

/// The value of the row nearest to a time, or the last value there is.
fn value(history: &History<'_>, name: &str, at: Option<f64>) -> Result<f64, CliError> {
    history.known(name)?;
    let times = history.column("time")?;
    let values = history.column(name)?;
    let finite = |row: &usize| values[*row].is_finite();
    let rows = 0..times.len();
    let row = match at {
        Some(at) => rows.min_by(|a, b| (times[*a] - at).abs().total_cmp(&(times[*b] - at).abs())),
        None => rows.rev().find(finite),
    };
    Ok(row.map_or(f64::NAN, |row| values[row]))
}

/// A number of `summary.json` by its path, such as `particles` or `energies.plastic`.
fn number(summary: &Summary, path: &str) -> Result<f64, CliError> {
    let json = serde_json::to_value(summary).unwrap_or_default();
    let found = json.pointer(&format!("/{}", path.replace('.', "/")));
    match found.and_then(serde_json::Value::as_f64) {
        Some(number) => Ok(number),
        None => Err(CliError::UnknownName {
            what: "number in summary.json",
            name: path.to_owned(),
            allowed: paths(&json),
        }),
    }
}

/// Paths of all numbers.
fn paths(json: &serde_json::Value) -> Vec<String> {
    let mut paths = Vec::new();
    for (name, value) in json.as_object().into_iter().flatten() {
        if value.is_number() {
            paths.push(name.clone());
        }
        let inner = value.as_object().into_iter().flatten();
        let numbers = inner.filter(|(_, value)| value.is_number());
        paths.extend(numbers.map(|(key, _)| format!("{name}.{key}")));
    }
    paths
}

/// SI unit of a number in `summary.json` that is worth an axis.
fn unit(path: &str) -> &'static str {
    match path {
        "wall_seconds" | "simulated_time" => "s",
        _ => "",
    }
}

/// The numbers of every run.
pub(super) fn summaries(folders: &[std::path::PathBuf]) -> Result<Vec<Summary>, CliError> {
    let read = |folder: &std::path::PathBuf| Summary::read(folder);
    let summaries = folders.iter().map(read);
    summaries
        .collect::<Result<_, OutputError>>()
        .map_err(CliError::Picture)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::testing::block;
    use jstsph_output::{Status, Table};

    fn summary(particles: u64) -> Summary {
        let mut summary = Summary::new("a", Status::Completed);
        summary.particles = particles;
        summary
    }

    #[test]
    fn runs_of_one_label_become_a_curve_over_a_number_of_the_summary() {
        let case = block("");
        let table = |value: f64| Table {
            columns: ["time", "plastic_energy"].map(str::to_owned).to_vec(),
            rows: vec![vec![0.0, 0.0], vec![0.5e-3, value], vec![1e-3, 2.0 * value]],
        };
        let (fine, coarse) = (table(3.0), table(1.0));
        let told = |table| Told {
            case: &case,
            table,
            label: "scheme",
        };
        let runs = [told(&fine), told(&coarse)];
        let summaries = [summary(100), summary(10)];
        let draw = |at, against| diagrams(&runs, &summaries, &["plastic_energy"], against, at);
        let plots = draw(Some(0.52e-3), "particles").unwrap();
        assert_eq!(plots[0].series.len(), 1);
        assert_eq!(plots[0].series[0].points, [(10.0, 1.0), (100.0, 3.0)]);
        assert_eq!(plots[0].y, Quantity::new("plastic energy at 520 µs", "J/m"));
        let last = draw(None, "particles").unwrap();
        assert_eq!(last[0].series[0].points[1], (100.0, 6.0));
        let message = draw(None, "particle").unwrap_err().to_string();
        assert!(message.contains("did you mean `particles`"), "{message}");
        assert!(message.contains("energies.plastic"), "{message}");
    }
}
