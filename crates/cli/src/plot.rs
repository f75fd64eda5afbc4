//! `jstsph plot`, and the pictures at the end of a run.

pub(crate) mod body;
pub(crate) mod diagrams;
pub(crate) mod field;
mod frames;
pub(crate) mod history;
pub(crate) mod lines;
mod setup;

use std::path::{Path, PathBuf};

use jstsph_case::Case;
use jstsph_output::plot::Figure;
use jstsph_output::read_table;

use crate::arguments::{Look, PlotOptions, ViewName};
use crate::console::Console;
use crate::error::CliError;

/// The field of the picture at the end of a run.
const FIELD: &str = "equivalent_plastic_strain";

/// Draws one picture of a results folder.
pub(crate) fn run(options: &PlotOptions, console: &mut Console<'_>) -> Result<u8, CliError> {
    if let Some(path) = &options.output {
        format(path)?;
    }
    let case = options.results.join("case.toml");
    if !case.is_file() {
        let path = options.results.clone();
        return Err(CliError::NoResults { path });
    }
    let case = jstsph_case::load(&case, &[])?;
    let (figure, name) = match &options.history {
        Some(what) => {
            let path = options.results.join("history.csv");
            let table = read_table(&path).map_err(CliError::Picture)?;
            history::figure(&case, &table, what)?
        }
        None => {
            let field = options.field.as_deref().unwrap_or(FIELD);
            let chosen = frames::choose(&options.results, &options.times)?;
            let names: Vec<String> = chosen.iter().map(|frame| frame.name()).collect();
            let look = &options.look;
            let figure = body::figure(&case, &chosen, field, look)?;
            (figure, format!("{field}-{}.png", names.join("-")))
        }
    };
    let path = options
        .output
        .clone()
        .unwrap_or_else(|| options.results.join(name));
    save(&figure, &path)?;
    console.print(format_args!("wrote {}\n", path.display()));
    Ok(0)
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
    let body = body::figure(case, &chosen, field, &Look::default())?;
    let table = read_table(&results.join("history.csv")).map_err(CliError::Picture)?;
    let (energies, _) = history::figure(case, &table, "energies")?;
    for (figure, name) in [(body, "final.png"), (energies, "energies.png")] {
        let path = results.join(name);
        save(&figure, &path)?;
        written.push(path);
    }
    Ok(written)
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
    let case = jstsph_case::load(&results.join("case.toml"), &[])?;
    let chosen = frames::choose(results, times)?;
    save(&body::figure(&case, &chosen, field, look)?, path)
}

/// Draws curves of `history.csv` into a file; `what` as in `--history`.
pub(crate) fn draw_history(results: &Path, what: &str, path: &Path) -> Result<(), CliError> {
    let case = jstsph_case::load(&results.join("case.toml"), &[])?;
    let table = read_table(&results.join("history.csv")).map_err(CliError::Picture)?;
    save(&history::figure(&case, &table, what)?.0, path)
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
