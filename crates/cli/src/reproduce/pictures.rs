//! The pictures of the page.

use std::collections::HashMap;
use std::path::Path;

use jstsph_output::plot::{Figure, LinePlot, Quantity as Axis, Scale, Series, SeriesStyle};

use super::findings::{Drawn, QuantityFinding, series};
use super::measure::Results;
use super::page::labelled;
use super::study::{Picture, Quantity};
use crate::arguments::{Look, ValueRange};
use crate::error::CliError;
use crate::plot;

/// Folder of the pictures, beside the page.
const FOLDER: &str = "pictures";

/// Draws the pictures of a quantity. One whose run is missing is left out.
///
/// # Errors
/// [`CliError`] when a picture of finished runs cannot be drawn or written.
pub(super) fn draw(
    quantity: &Quantity,
    found: &QuantityFinding,
    results: &HashMap<String, Results>,
    out: &Path,
) -> Result<Vec<Drawn>, CliError> {
    let mut drawn = Vec::new();
    for (number, picture) in quantity.pictures.iter().enumerate() {
        let file = format!("{FOLDER}/{}-{}.png", quantity.id, number + 1);
        let path = out.join(&file);
        let folder = |run: &str| results.get(run).map(|results| results.folder.as_path());
        let caption = match picture {
            Picture::Body {
                run,
                field,
                times,
                range,
                caption,
            } => {
                let Some(folder) = folder(run) else { continue };
                let range = range.map(|[from, to]| ValueRange {
                    from,
                    to,
                    measures: [None, None],
                });
                let look = Look {
                    range,
                    ..Look::default()
                };
                plot::draw_body(folder, field, times, &look, &path)?;
                caption
            }
            Picture::History {
                run,
                columns,
                caption,
            } => {
                let Some(folder) = folder(run) else { continue };
                plot::draw_history(folder, columns, &path)?;
                caption
            }
            Picture::Profile { caption } => {
                let Some(plot) = profile(quantity, found) else {
                    continue;
                };
                lines(&plot, &path)?;
                caption
            }
            Picture::Convergence { caption } => {
                let Some(plot) = convergence(quantity, found) else {
                    continue;
                };
                lines(&plot, &path)?;
                caption
            }
        };
        drawn.push(Drawn {
            file,
            caption: caption.clone(),
        });
    }
    Ok(drawn)
}

fn lines(plot: &LinePlot, path: &Path) -> Result<(), CliError> {
    let figure = Figure::lines(plot).map_err(CliError::Picture)?;
    figure.save_png(path).map_err(CliError::Picture)
}

/// One curve per run over the number of the point.
#[expect(clippy::cast_precision_loss, reason = "a handful of points")]
fn profile(quantity: &Quantity, found: &QuantityFinding) -> Option<LinePlot> {
    let curves = found.rows.iter().map(|row| {
        let points = row.values.iter().enumerate();
        Series {
            label: format!("{}, {}", row.scheme, row.particles),
            points: points
                .filter_map(|(i, v)| Some(((i + 1) as f64, (*v)?)))
                .collect(),
            style: SeriesStyle::LineWithMarkers,
            ..Series::default()
        }
    });
    let curves: Vec<Series> = curves.filter(|curve| !curve.points.is_empty()).collect();
    (!curves.is_empty()).then(|| LinePlot {
        title: quantity.title.clone(),
        x: Axis::new("point of the section", ""),
        y: Axis::new(labelled(quantity), ""),
        series: curves,
        ..LinePlot::default()
    })
}

/// One curve per scheme over the number of particles.
#[expect(clippy::cast_precision_loss, reason = "particles are far below 2^53")]
fn convergence(quantity: &Quantity, found: &QuantityFinding) -> Option<LinePlot> {
    let mut schemes: Vec<&str> = found.rows.iter().map(|row| row.scheme.as_str()).collect();
    let mut seen = std::collections::HashSet::new();
    schemes.retain(|scheme| seen.insert(*scheme));
    let curves = schemes.into_iter().map(|scheme| {
        let points = series(&found.rows, scheme).into_iter();
        Series {
            label: scheme.to_owned(),
            points: points.map(|(n, value)| (n as f64, value)).collect(),
            style: SeriesStyle::LineWithMarkers,
            ..Series::default()
        }
    });
    let curves: Vec<Series> = curves.filter(|curve| !curve.points.is_empty()).collect();
    (!curves.is_empty()).then(|| LinePlot {
        title: quantity.title.clone(),
        x: Axis::new("particles", ""),
        y: Axis::new(labelled(quantity), ""),
        x_scale: Scale::Linear,
        series: curves,
        ..LinePlot::default()
    })
}
