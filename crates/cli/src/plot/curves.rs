//! Curves of one run, or of several in the same diagrams.

use jstsph_case::Case;
use jstsph_output::Table;
use jstsph_output::plot::{Figure, LinePlot};

use super::heading;
use super::history::History;
use crate::error::CliError;

/// The history of a run to draw.
pub(super) struct Told<'a> {
    pub(super) case: &'a Case,
    pub(super) table: &'a Table,
    /// Name of the run in legends; empty when there is only one.
    pub(super) label: &'a str,
}

/// Draws a named set of columns, or columns by name separated by commas, of one run or several.
/// Also gives the name of the file.
pub(super) fn figure(runs: &[Told<'_>], what: &str) -> Result<(Figure, String), CliError> {
    let mut plots: Vec<LinePlot> = Vec::new();
    for run in runs {
        for mut plot in diagrams(run, what)? {
            if !run.label.is_empty() {
                for series in &mut plot.series {
                    series.label = format!("{}: {}", run.label, series.label);
                }
            }
            match plots
                .iter_mut()
                .find(|other| other.y == plot.y && other.x == plot.x)
            {
                Some(other) => other.series.extend(plot.series),
                None => plots.push(plot),
            }
        }
    }
    let first = heading(runs[0].case);
    let is_one = runs.iter().all(|run| heading(run.case) == first);
    let figure =
        Figure::stack(if is_one { first } else { "" }, &plots).map_err(CliError::Picture)?;
    let name = what.trim().replace([',', ' '], "-");
    Ok((figure, format!("{name}.png")))
}

fn diagrams(run: &Told<'_>, what: &str) -> Result<Vec<LinePlot>, CliError> {
    let history = History {
        case: run.case,
        table: run.table,
    };
    Ok(match what.trim() {
        "energies" => vec![history.energies()?],
        "balance" => vec![history.balance()?],
        "time_step" => vec![history.time_step()?],
        "probes" => history.probes()?,
        columns => {
            let names: Vec<&str> = columns.split(',').map(str::trim).collect();
            for name in &names {
                history.known(name)?;
            }
            history.by_unit(&names)?
        }
    })
}
