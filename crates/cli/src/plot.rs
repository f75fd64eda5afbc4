//! `jstsph plot`, and the pictures at the end of a run.

mod against;
pub(crate) mod body;
mod curves;
mod derived;
pub(crate) mod diagrams;
pub(crate) mod field;
mod frames;
pub(crate) mod history;
pub(crate) mod lines;
mod probes;
mod setup;
#[cfg(test)]
mod testing;

use std::path::{Path, PathBuf};

use jstsph_case::Case;
use jstsph_output::plot::{Figure, Movie};
use jstsph_output::read_table;

use crate::arguments::{CurveLook, Look, PlotOptions, ViewName};
use crate::console::Console;
use crate::error::CliError;
use body::Drawn;
use curves::{Told, Wanted};

/// The field of the picture at the end of a run.
const FIELD: &str = "equivalent_plastic_strain";

/// Characters of a run's name over a panel.
const LONGEST_LABEL: usize = 26;

/// Draws one picture of a results folder, or of several to compare.
pub(crate) fn run(options: &PlotOptions, console: &mut Console<'_>) -> Result<u8, CliError> {
    if let Some(path) = &options.output {
        format(path)?;
    }
    let labels = labels(options)?;
    let cases = options
        .results
        .iter()
        .map(|folder| read_case(folder))
        .collect::<Result<Vec<_>, _>>()?;
    let field = options.field.as_deref().unwrap_or(FIELD);
    if let Some(path) = &options.animate {
        let movie = movie(path)?;
        if cases.len() > 1 {
            return Err(CliError::MovieRuns { count: cases.len() });
        }
        let chosen = frames::all(&options.results[0])?;
        let drawn = Drawn {
            case: &cases[0],
            chosen: &chosen,
            label: "",
        };
        body::animation(drawn, field, &options.look)?
            .save(movie, path)
            .map_err(CliError::Picture)?;
        console.print(format_args!("wrote {}\n", path.display()));
        return Ok(0);
    }
    let (figure, name) = match &options.history {
        Some(what) => {
            let tables = options
                .results
                .iter()
                .map(|folder| read_table(&folder.join("history.csv")).map_err(CliError::Picture))
                .collect::<Result<Vec<_>, _>>()?;
            let runs: Vec<Told<'_>> = (0..cases.len())
                .map(|run| Told {
                    case: &cases[run],
                    table: &tables[run],
                    label: &labels[run],
                })
                .collect();
            let wanted = Wanted {
                what,
                look: &options.curves,
                title: options.title.as_deref(),
                folders: &options.results,
            };
            curves::figure(&runs, wanted)?
        }
        None => {
            let chosen = options
                .results
                .iter()
                .map(|folder| frames::choose(folder, &options.times))
                .collect::<Result<Vec<_>, _>>()?;
            let names: Vec<String> = chosen[0].iter().map(|frame| frame.name()).collect();
            let runs: Vec<Drawn<'_>> = (0..cases.len())
                .map(|run| Drawn {
                    case: &cases[run],
                    chosen: &chosen[run],
                    label: &labels[run],
                })
                .collect();
            let figure = body::figure(&runs, field, &options.look, options.title.as_deref())?;
            (figure, format!("{field}-{}.png", names.join("-")))
        }
    };
    let path = options
        .output
        .clone()
        .unwrap_or_else(|| options.results[0].join(name));
    match (options.dpi, format(&path)?) {
        (Some(dpi), Format::Png) => figure.save_png_at(&path, dpi).map_err(CliError::Picture)?,
        _ => save(&figure, &path)?,
    }
    console.print(format_args!("wrote {}\n", path.display()));
    Ok(0)
}

/// Names of the runs: those that were given, or the folders.
fn labels(options: &PlotOptions) -> Result<Vec<String>, CliError> {
    let (given, runs) = (options.labels.len(), options.results.len());
    match given {
        0 => Ok(folder_labels(&options.results)),
        _ if given == runs => Ok(options.labels.clone()),
        _ => Err(CliError::Labels { given, runs }),
    }
}

/// Names of runs by which they can be told apart; none for a single one.
fn folder_labels(folders: &[PathBuf]) -> Vec<String> {
    if folders.len() == 1 {
        return vec![String::new()];
    }
    let last = |folder: &PathBuf| {
        folder.file_name().map_or_else(
            || folder.display().to_string(),
            |name| name.to_string_lossy().into_owned(),
        )
    };
    let short: Vec<String> = folders.iter().map(last).collect();
    let is_clear = (1..short.len()).all(|at| !short[..at].contains(&short[at]));
    let names = if is_clear {
        differences(&short)
    } else {
        folders
            .iter()
            .map(|folder| folder.display().to_string())
            .collect()
    };
    names.iter().map(|name| shortened(name)).collect()
}

/// Folders of a sweep are called KEY=VALUE,KEY=VALUE: what is the same in all of them goes.
fn differences(names: &[String]) -> Vec<String> {
    let split: Vec<Vec<&str>> = names.iter().map(|name| name.split(',').collect()).collect();
    let first = &split[0];
    let is_sweep = split
        .iter()
        .all(|parts| parts.len() == first.len() && parts.iter().all(|part| part.contains('=')));
    if !is_sweep {
        return names.to_vec();
    }
    let key = |part: &str| part.split_once('=').map(|(key, _)| key.to_owned());
    let same_key =
        (0..first.len()).all(|at| split.iter().all(|parts| key(parts[at]) == key(first[at])));
    split
        .iter()
        .map(|parts| {
            let differing = (0..parts.len())
                .filter(|at| split.iter().any(|other| other[*at] != parts[*at]))
                .map(|at| match parts[at].split_once('=') {
                    Some((_, value)) if same_key => value,
                    _ => parts[at],
                });
            differing.collect::<Vec<_>>().join(", ")
        })
        .collect()
}

/// At most so long that it fits over a panel; the end of a name tells more than its beginning.
fn shortened(name: &str) -> String {
    let count = name.chars().count();
    if count <= LONGEST_LABEL {
        return name.to_owned();
    }
    let kept: String = name.chars().skip(count - LONGEST_LABEL + 1).collect();
    format!("…{kept}")
}

fn read_case(results: &Path) -> Result<Case, CliError> {
    let case = results.join("case.toml");
    if !case.is_file() {
        return Err(CliError::NoResults {
            path: results.to_path_buf(),
        });
    }
    Ok(jstsph_case::load(&case, &[])?)
}

/// Draws the last frame and the energies of a run that has just ended.
pub(crate) fn after_run(case: &Case, results: &Path) -> Result<Vec<PathBuf>, CliError> {
    let mut written = Vec::new();
    let chosen = frames::choose(results, &[])?;
    // The frames may have been told to leave it out.
    let names = chosen[0].frame.value_names();
    let field = match names.iter().find(|name| *name == FIELD) {
        Some(name) => name.as_str(),
        None => names.first().map_or(FIELD, String::as_str),
    };
    let body = one_body(case, results, field, &[], &Look::default())?;
    let energies = one_history(case, results, "energies")?;
    for (figure, name) in [(body, "final.png"), (energies, "energies.png")] {
        let path = results.join(name);
        save(&figure, &path)?;
        written.push(path);
    }
    Ok(written)
}

fn one_body(
    case: &Case,
    results: &Path,
    field: &str,
    times: &[String],
    look: &Look,
) -> Result<Figure, CliError> {
    let chosen = frames::choose(results, times)?;
    let drawn = Drawn {
        case,
        chosen: &chosen,
        label: "",
    };
    body::figure(&[drawn], field, look, None)
}

fn one_history(case: &Case, results: &Path, what: &str) -> Result<Figure, CliError> {
    let table = read_table(&results.join("history.csv")).map_err(CliError::Picture)?;
    let told = Told {
        case,
        table: &table,
        label: "",
    };
    let wanted = Wanted {
        what,
        look: &CurveLook::default(),
        title: None,
        folders: &[],
    };
    curves::figure(&[told], wanted).map(|(figure, _)| figure)
}

/// Draws the set-up of a case.
pub(crate) fn before_run(case: &Case, view: Option<ViewName>, path: &Path) -> Result<(), CliError> {
    format(path)?;
    save(&setup::figure(case, view)?, path)
}

/// Draws a body at several times side by side into a file.
pub(crate) fn draw_body(
    results: &Path,
    field: &str,
    times: &[String],
    look: &Look,
    path: &Path,
) -> Result<(), CliError> {
    let case = read_case(results)?;
    save(&one_body(&case, results, field, times, look)?, path)
}

/// Draws curves of `history.csv` into a file; `what` as in `--history`.
pub(crate) fn draw_history(results: &Path, what: &str, path: &Path) -> Result<(), CliError> {
    let case = read_case(results)?;
    save(&one_history(&case, results, what)?, path)
}

/// How a picture is written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Png,
    Svg,
}

fn format(path: &Path) -> Result<Format, CliError> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("png") => Ok(Format::Png),
        Some("svg") => Ok(Format::Svg),
        _ => Err(CliError::PictureFormat {
            path: path.to_path_buf(),
        }),
    }
}

fn movie(path: &Path) -> Result<Movie, CliError> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("gif") => Ok(Movie::Gif),
        Some("png" | "apng") => Ok(Movie::Apng),
        _ => Err(CliError::MovieFormat {
            path: path.to_path_buf(),
        }),
    }
}

pub(crate) fn save(figure: &Figure, path: &Path) -> Result<(), CliError> {
    let result = match format(path)? {
        Format::Png => figure.save_png(path),
        Format::Svg => figure.save_svg(path),
    };
    result.map_err(CliError::Picture)
}

/// The title of a figure: what the case is.
pub(crate) fn heading(case: &Case) -> &str {
    if case.title.is_empty() {
        &case.name
    } else {
        &case.title
    }
}

/// A time with three digits and a unit that makes it readable.
fn moment(time: f64) -> (String, &'static str) {
    let (scale, unit) = match time.abs() {
        t if t == 0.0 || t >= 0.9995 => (1.0, "s"),
        t if t >= 0.9995e-3 => (1e3, "ms"),
        t if t >= 0.9995e-6 => (1e6, "µs"),
        _ => (1e9, "ns"),
    };
    let value = time * scale;
    let decimals = match value.abs() {
        v if v >= 99.95 => 0,
        v if v >= 9.995 => 1,
        _ => 2,
    };
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    };
    (text, unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_a_sweep_are_called_by_what_differs() {
        let folders = |names: [&str; 2]| names.map(PathBuf::from);
        assert_eq!(
            folder_labels(&folders(["s/n=3,cfl=0.9", "s/n=2,cfl=0.9"])),
            ["3", "2"]
        );
        assert_eq!(folder_labels(&folders(["a/x", "b/x"])), ["a/x", "b/x"]);
        assert_eq!(folder_labels(&folders(["a/x", "a/y"])), ["x", "y"]);
        let long = "a-name-that-is-longer-than-a-panel";
        let label = &folder_labels(&folders([long, "x"]))[0];
        assert!(label.starts_with('…') && label.ends_with("longer-than-a-panel"));
        assert_eq!(label.chars().count(), LONGEST_LABEL);
    }

    #[test]
    fn moments_are_short_and_keep_three_digits() {
        let shown = |time| {
            let (number, unit) = moment(time);
            format!("{number} {unit}")
        };
        for (time, text) in [
            (0.0, "0 s"),
            (0.040_000_04, "40 ms"),
            (80e-6, "80 µs"),
            (5.003e-4, "500 µs"),
            (1.234e-3, "1.23 ms"),
            (0.999_99, "1 s"),
            (120.0, "120 s"),
        ] {
            assert_eq!(shown(time), text);
        }
    }
}
