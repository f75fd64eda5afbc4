//! Curves of one run, or of several in the same diagrams.

use std::path::PathBuf;

use jstsph_case::Case;
use jstsph_output::Table;
use jstsph_output::plot::{Figure, LinePlot, Scale, SeriesStyle};

use super::history::History;
use super::{against, derived, heading};
use crate::arguments::{CurveLook, LogAxes};
use crate::error::CliError;

/// Looks of the curves of several runs that have one colour per column.
const STYLES: [SeriesStyle; 4] = [
    SeriesStyle::Line,
    SeriesStyle::Dashed,
    SeriesStyle::Dotted,
    SeriesStyle::DashDotted,
];

/// The history of a run to draw.
#[derive(Clone, Copy)]
pub(super) struct Told<'a> {
    pub(super) case: &'a Case,
    pub(super) table: &'a Table,
    /// Name of the run in legends; empty when there is only one.
    pub(super) label: &'a str,
}

/// What of the runs is drawn how.
#[derive(Clone, Copy)]
pub(super) struct Wanted<'a> {
    /// A named set of columns, or columns by name separated by commas.
    pub(super) what: &'a str,
    pub(super) look: &'a CurveLook,
    /// Title; what the cases are unless given.
    pub(super) title: Option<&'a str>,
    /// Folders of the runs, for what is not in their histories.
    pub(super) folders: &'a [PathBuf],
}

/// Draws curves of one run or several. Also gives the name of the file.
pub(super) fn figure(runs: &[Told<'_>], wanted: Wanted<'_>) -> Result<(Figure, String), CliError> {
    let Wanted { what, look, .. } = wanted;
    let names: Vec<&str> = what.split(',').map(str::trim).collect();
    let over = look.over.as_deref();
    let columns: Vec<&str> = names.iter().copied().chain(over).collect();
    let tables: Vec<Table> = runs
        .iter()
        .map(|run| derived::derived(run.table, &columns, look.smooth))
        .collect();
    let runs: Vec<Told<'_>> = runs
        .iter()
        .zip(&tables)
        .map(|(run, table)| Told { table, ..*run })
        .collect();
    let mut plots = match &look.against {
        Some(number) => {
            let summaries = against::summaries(wanted.folders)?;
            against::diagrams(&runs, &summaries, &names, number, look.at)?
        }
        None => together(&runs, what, &names, look)?,
    };
    for plot in &mut plots {
        set_scales(plot, look.log);
    }
    let first = heading(runs[0].case);
    let is_one = runs.iter().all(|run| heading(run.case) == first);
    let title = wanted.title.unwrap_or(if is_one { first } else { "" });
    let figure = Figure::stack(title, &plots).map_err(CliError::Picture)?;
    let name = what.trim().replace([',', ' ', '(', ')'], "-");
    Ok((figure, format!("{name}.png")))
}

/// The diagrams of all runs, those with the same axes put together.
fn together(
    runs: &[Told<'_>],
    what: &str,
    names: &[&str],
    look: &CurveLook,
) -> Result<Vec<LinePlot>, CliError> {
    let mut each = Vec::with_capacity(runs.len());
    for run in runs {
        each.push(diagrams(run, what, names, look)?);
    }
    if runs.len() == 1 && runs[0].label.is_empty() {
        return Ok(each.swap_remove(0));
    }
    // The name of the run alone tells which is which when each has one and the same curve.
    let is_single = |of: &LinePlot| {
        let same = each.iter().flatten();
        let mut same = same.filter(|plot| plot.x == of.x && plot.y == of.y);
        same.all(|plot| plot.series.len() == 1 && plot.series[0].label == of.series[0].label)
    };
    let singles: Vec<LinePlot> = each
        .iter()
        .flatten()
        .filter(|p| is_single(p))
        .cloned()
        .collect();
    let mut plots: Vec<LinePlot> = Vec::new();
    for (number, (run, diagrams)) in runs.iter().zip(each).enumerate() {
        for mut plot in diagrams {
            let single = singles.iter().any(|s| s.x == plot.x && s.y == plot.y);
            let is_plain = plot.series.iter().all(|s| s.style == SeriesStyle::Line);
            for (place, series) in plot.series.iter_mut().enumerate() {
                if single {
                    if series.label != plot.y.name {
                        plot.title.clone_from(&series.label);
                    }
                    run.label.clone_into(&mut series.label);
                    continue;
                }
                series.label = format!("{}: {}", run.label, series.label);
                if is_plain && runs.len() <= STYLES.len() {
                    series.colour = Some(place);
                    series.style = STYLES[number];
                }
            }
            match plots.iter_mut().find(|p| p.y == plot.y && p.x == plot.x) {
                Some(other) => other.series.extend(plot.series),
                None => plots.push(plot),
            }
        }
    }
    Ok(plots)
}

fn diagrams(
    run: &Told<'_>,
    what: &str,
    names: &[&str],
    look: &CurveLook,
) -> Result<Vec<LinePlot>, CliError> {
    let history = History {
        over: look.over.as_deref(),
        at: look.at,
        ..History::new(run.case, run.table)
    };
    if let Some(over) = history.over {
        history.known(over)?;
    }
    Ok(match what.trim() {
        "energies" => vec![history.energies()?],
        "balance" => vec![history.balance()?],
        "time_step" => vec![history.time_step()?],
        "probes" => history.probes()?,
        _ => history.named(names)?,
    })
}

/// Chooses the scales; what a logarithmic axis cannot show is left out.
fn set_scales(plot: &mut LinePlot, log: Option<LogAxes>) {
    let (x, y) = match log {
        None => return,
        Some(LogAxes::X) => (true, false),
        Some(LogAxes::Y) => (false, true),
        Some(LogAxes::Xy) => (true, true),
    };
    let scale = |is_log| {
        if is_log {
            Scale::Logarithmic
        } else {
            Scale::Linear
        }
    };
    (plot.x_scale, plot.y_scale) = (scale(x), scale(y));
    for series in &mut plot.series {
        series
            .points
            .retain(|point| (!x || point.0 > 0.0) && (!y || point.1 > 0.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::testing::block;

    const TABLES: &str = r#"
[[probe]]
name = "height"
extent = { where = "block", axis = "y" }
[[probe]]
name = "cut"
line = { from = [0, 0], to = [0.004, 0], count = 2, field = "pressure" }
"#;

    fn table(factor: f64) -> Table {
        let columns = [
            "time",
            "kinetic_energy",
            "plastic_energy",
            "height",
            "cut_1",
            "cut_2",
        ];
        let row = |i: u32| {
            let t = f64::from(i) * 1e-4;
            vec![
                t,
                5.0 - factor,
                factor * t,
                6e-3 - t,
                factor + t,
                factor - t,
            ]
        };
        Table {
            columns: columns.map(str::to_owned).to_vec(),
            rows: (0..4).map(row).collect(),
        }
    }

    fn plots(what: &str, look: &CurveLook, labels: &[&str]) -> Result<Vec<LinePlot>, CliError> {
        let case = block(TABLES);
        let names: Vec<&str> = what.split(',').collect();
        let of = |run: usize| derived::derived(&table(run as f64 + 1.0), &names, look.smooth);
        let tables: Vec<Table> = (0..labels.len()).map(of).collect();
        let told = labels.iter().zip(&tables).map(|(label, table)| Told {
            case: &case,
            table,
            label,
        });
        together(&told.collect::<Vec<_>>(), what, &names, look)
    }

    #[test]
    fn one_curve_per_run_has_its_name_and_several_its_dashes() {
        let look = CurveLook::default();
        let one = &plots("plastic_energy", &look, &["a", "b"]).unwrap()[0].series;
        assert_eq!([&one[0].label, &one[1].label], ["a", "b"]);
        assert_eq!((one[1].style, one[1].colour), (SeriesStyle::Line, None));
        let two = &plots("kinetic_energy,plastic_energy", &look, &["a", "b"]).unwrap()[0].series;
        assert_eq!(two[3].label, "b: plastic energy");
        assert_eq!(
            (two[3].style, two[3].colour),
            (SeriesStyle::Dashed, Some(1))
        );
        assert_eq!((two[1].style, two[1].colour), (SeriesStyle::Line, Some(1)));
    }

    #[test]
    fn columns_rates_and_profiles_are_drawn_over_what_is_asked_for() {
        let over = CurveLook {
            over: Some("height".to_owned()),
            ..CurveLook::default()
        };
        let plot = &plots("rate(plastic_energy)", &over, &[""]).unwrap()[0];
        assert_eq!(
            (plot.x.name.as_str(), plot.x.unit.as_str()),
            ("height", "m")
        );
        assert_eq!(
            (plot.y.name.as_str(), plot.y.unit.as_str()),
            ("rate of plastic energy", "W/m")
        );
        let (x, y) = plot.series[0].points[3];
        assert!(
            (x - 5.7e-3).abs() < 1e-12 && (y - 1.0).abs() < 1e-9,
            "{x} {y}"
        );
        let at = CurveLook {
            at: Some(1.1e-4),
            ..CurveLook::default()
        };
        let profile = &plots("cut", &at, &["a", "b"]).unwrap()[0];
        assert_eq!(profile.title, "cut, t = 100 µs");
        assert_eq!(profile.series[1].label, "b");
        assert!((profile.series[1].points[0].1 - 2.0001).abs() < 1e-12);
        assert!(plots("hight", &over, &[""]).is_err());
    }

    #[test]
    fn logarithmic_axes_leave_out_what_is_not_positive() {
        let mut plot = plots("plastic_energy", &CurveLook::default(), &[""])
            .unwrap()
            .remove(0);
        set_scales(&mut plot, Some(LogAxes::Y));
        assert_eq!(plot.series[0].points.len(), 3);
        assert_eq!(
            (plot.x_scale, plot.y_scale),
            (Scale::Linear, Scale::Logarithmic)
        );
    }
}
