//! Numbers read off a finished run.

use std::path::{Path, PathBuf};

use jstsph_case::Case;
use jstsph_output::{Collection, OutputError, StoredFrame, Summary, Table, read_table, read_vtu};
use serde::Deserialize;

use super::frame::{Axis, Statistic, front, in_box, inverted};
use super::series::{Extreme, Series};
use super::study::{si, si_list, si_range};
use super::unfilled;

/// How a number is read off a run; all in SI units.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub(super) enum Measure {
    /// Last value of a probe.
    Probe(String),
    /// A number of `summary.json` by its path, such as `energies.plastic`.
    Summary(String),
    /// A column of `history.csv` at the row nearest to a time.
    Column {
        name: String,
        #[serde(deserialize_with = "si")]
        at: f64,
    },
    /// Slope of a column between half a window before and half a window after a time.
    Rate {
        name: String,
        #[serde(deserialize_with = "si")]
        at: f64,
        #[serde(deserialize_with = "si")]
        window: f64,
    },
    /// Mean of the magnitudes of a column between two times.
    Mean {
        name: String,
        #[serde(deserialize_with = "si_range")]
        between: [f64; 2],
    },
    /// Time at which the running mean of a column over a window is largest between two times.
    TimeOfMaximum {
        name: String,
        #[serde(deserialize_with = "si_range")]
        between: [f64; 2],
        #[serde(deserialize_with = "si")]
        window: f64,
    },
    /// First time at which a column exceeds a part of its largest value.
    TimeAbove { name: String, part: f64 },
    /// The values of a probe along a line of points at the row nearest to a time.
    Line {
        probe: String,
        #[serde(deserialize_with = "si")]
        at: f64,
    },
    /// A statistic of a scalar field over the particles, or those in a box, at the frames nearest
    /// to some times.
    Field {
        field: String,
        of: Statistic,
        #[serde(deserialize_with = "si_list")]
        at: Vec<f64>,
        #[serde(default = "everywhere", deserialize_with = "si_range")]
        x: [f64; 2],
        #[serde(default = "everywhere", deserialize_with = "si_range")]
        y: [f64; 2],
    },
    /// Largest coordinate, in the undeformed body, at which a scalar field exceeds a value, at the
    /// frames nearest to some times.
    Front {
        field: String,
        above: f64,
        axis: Axis,
        #[serde(deserialize_with = "si_list")]
        at: Vec<f64>,
    },
    /// Number of lattice cells turned inside out at the frame nearest to a time.
    InvertedCells {
        #[serde(deserialize_with = "si")]
        at: f64,
    },
    /// Part of a box, without what is inside the first obstacle, that no cell of a plane body
    /// covers at the frame nearest to a time.
    Unfilled {
        #[serde(deserialize_with = "si")]
        at: f64,
        #[serde(deserialize_with = "si_range")]
        x: [f64; 2],
        #[serde(deserialize_with = "si_range")]
        y: [f64; 2],
    },
    /// One number over another.
    Ratio { of: Box<Self>, over: Box<Self> },
}

fn everywhere() -> [f64; 2] {
    [f64::NEG_INFINITY, f64::INFINITY]
}

/// Why a run has no number.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(super) enum MeasureError {
    /// Of a column, probe, field or path.
    #[error("the run has no {what} `{name}`")]
    Missing { what: &'static str, name: String },
    /// The run ended before, or the column is empty then.
    #[error("the run has no value at t = {time:.4e} s (it ended at {end:.4e} s)")]
    NoValue { time: f64, end: f64 },
    /// Nothing where one looks.
    #[error("no particle is in the box")]
    NoParticle,
    /// Files of the run.
    #[error(transparent)]
    Files(#[from] OutputError),
}

/// A finished run as it stands in its folder.
pub(super) struct Results {
    pub(super) case: Case,
    pub(super) folder: PathBuf,
    pub(super) summary: Summary,
    history: Table,
}

impl Results {
    /// Reads what a run of a case has written.
    ///
    /// # Errors
    /// [`OutputError`] for files that are missing or damaged.
    pub(super) fn open(case: Case, folder: &Path) -> Result<Self, OutputError> {
        Ok(Self {
            case,
            folder: folder.to_path_buf(),
            summary: Summary::read(folder)?,
            history: read_table(&folder.join("history.csv"))?,
        })
    }

    fn series(&self, name: &str) -> Result<Series, MeasureError> {
        let column = |name: &str| {
            self.history
                .column(name)
                .ok_or_else(|| MeasureError::Missing {
                    what: "column",
                    name: name.to_owned(),
                })
        };
        Ok(Series {
            times: column("time")?,
            values: column(name)?,
        })
    }

    /// The frame nearest to a time, which must not be after the end of the run.
    fn frame(&self, time: f64) -> Result<StoredFrame, MeasureError> {
        let folder = self.folder.join("frames");
        let collection = Collection::read(&folder.join("frames.pvd"))?;
        let entries = collection.entries();
        let end = entries.last().map_or(0.0, |(time, _)| *time);
        let distance = |entry: &&(f64, String)| (entry.0 - time).abs();
        let nearest = entries
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .filter(|_| time <= end * (1.0 + 1e-6))
            .ok_or(MeasureError::NoValue { time, end })?;
        Ok(read_vtu(&folder.join(&nearest.1))?)
    }
}

impl Measure {
    /// One number, or several for a line of points.
    ///
    /// # Errors
    /// [`MeasureError`] when the run has no such number.
    pub(super) fn evaluate(&self, results: &Results) -> Result<Vec<f64>, MeasureError> {
        let value =
            match self {
                Self::Probe(name) => {
                    results.summary.probes.get(name).copied().ok_or_else(|| {
                        MeasureError::Missing {
                            what: "probe",
                            name: name.clone(),
                        }
                    })?
                }
                Self::Summary(path) => summary_value(&results.summary, path)?,
                Self::Column { name, at } => results.series(name)?.at(*at)?,
                Self::Rate { name, at, window } => {
                    let series = results.series(name)?;
                    let half = 0.5 * window;
                    (series.at(at + half)? - series.at(at - half)?) / window
                }
                Self::Mean { name, between } => {
                    results.series(name)?.within(*between)?.mean_magnitude()
                }
                Self::TimeOfMaximum {
                    name,
                    between,
                    window,
                } => {
                    // The mean at the ends of the range needs rows beyond it.
                    let Extreme { time, .. } = results
                        .series(name)?
                        .smooth(*window)
                        .within(*between)?
                        .largest();
                    time
                }
                Self::TimeAbove { name, part } => results.series(name)?.time_above(*part)?,
                Self::Line { probe, at } => return line(results, probe, *at),
                Self::Field {
                    field,
                    of,
                    at,
                    x,
                    y,
                } => {
                    let values = at.iter().map(|time| {
                        let frame = results.frame(*time)?;
                        of.over(in_box(&frame, field, *x, *y)?)
                    });
                    return values.collect();
                }
                Self::Front {
                    field,
                    above,
                    axis,
                    at,
                } => {
                    let values = at
                        .iter()
                        .map(|time| front(&results.frame(*time)?, field, *above, *axis));
                    return values.collect();
                }
                Self::InvertedCells { at } => inverted(&results.frame(*at)?),
                Self::Unfilled { at, x, y } => {
                    let obstacle = results.case.model.obstacles.first();
                    let surface = obstacle.map(|obstacle| &obstacle.obstacle.surface);
                    let is_free = |point: &jstsph_tensor::Vec3| {
                        surface.is_none_or(|surface| surface.gap(point).distance >= 0.0)
                    };
                    unfilled::part(&results.frame(*at)?, *x, *y, is_free)
                }
                Self::Ratio { of, over } => {
                    let (of, over) = (of.evaluate(results)?, over.evaluate(results)?);
                    return Ok(of.iter().zip(&over).map(|(a, b)| a / b).collect());
                }
            };
        Ok(vec![value])
    }
}

fn summary_value(summary: &Summary, path: &str) -> Result<f64, MeasureError> {
    let json = serde_json::to_value(summary).ok();
    let pointer = format!("/{}", path.replace('.', "/"));
    let number = json
        .as_ref()
        .and_then(|json| json.pointer(&pointer)?.as_f64());
    number.ok_or_else(|| MeasureError::Missing {
        what: "number in summary.json",
        name: path.to_owned(),
    })
}

fn line(results: &Results, probe: &str, at: f64) -> Result<Vec<f64>, MeasureError> {
    let columns = (1..).map(|number| format!("{probe}_{number}"));
    let values: Vec<f64> = columns
        .map_while(|column| results.series(&column).ok())
        .map(|series| series.at(at).unwrap_or(f64::NAN))
        .collect();
    if values.is_empty() {
        return Err(MeasureError::Missing {
            what: "line of points",
            name: probe.to_owned(),
        });
    }
    if values.iter().all(|value| value.is_nan()) {
        let end = results.summary.simulated_time;
        return Err(MeasureError::NoValue { time: at, end });
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use jstsph_output::Status;

    #[test]
    fn numbers_of_the_summary_are_found_by_their_path() {
        let mut summary = Summary::new("a", Status::Completed);
        summary.energies.plastic = 2.5;
        summary.particles = 7;
        assert_eq!(summary_value(&summary, "energies.plastic").unwrap(), 2.5);
        assert_eq!(summary_value(&summary, "particles").unwrap(), 7.0);
        let message = summary_value(&summary, "energies.plastik").unwrap_err();
        assert!(message.to_string().contains("energies.plastik"));
    }
}
