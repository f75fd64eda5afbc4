//! Which frames to draw.

use std::path::Path;

use jstsph_case::units::{Measure, UnitError, parse_quantity};
use jstsph_output::{Collection, StoredFrame, read_vtu};

use super::moment;
use crate::error::CliError;
use crate::verdict::seconds;

/// A frame to draw.
pub(super) struct Chosen {
    pub(super) frame: StoredFrame,
}

impl Chosen {
    /// `t = 40 ms`
    pub(super) fn title(&self) -> String {
        let (number, unit) = moment(self.frame.time);
        format!("t = {number} {unit}")
    }

    /// The time as part of a file name.
    pub(super) fn name(&self) -> String {
        let (number, unit) = moment(self.frame.time);
        format!("{number}{}", unit.replace('µ', "u"))
    }
}

/// Reads the frames nearest to the times asked for; the last one if none is.
pub(super) fn choose(results: &Path, times: &[String]) -> Result<Vec<Chosen>, CliError> {
    let folder = results.join("frames");
    let collection = Collection::read(&folder.join("frames.pvd")).map_err(CliError::Picture)?;
    let entries = collection.entries();
    if entries.is_empty() {
        return Err(CliError::NoFrames {
            path: results.to_path_buf(),
        });
    }
    let stored: Vec<f64> = entries.iter().map(|(time, _)| *time).collect();
    let last = vec!["last".to_owned()];
    let times = if times.is_empty() { &last } else { times };
    let mut chosen: Vec<Chosen> = Vec::new();
    for text in times {
        let (_, file) = &entries[nearest(text, &stored)?];
        let path = folder.join(file);
        let frame = read_vtu(&path).map_err(CliError::Picture)?;
        chosen.push(Chosen { frame });
    }
    Ok(chosen)
}

/// Reads every frame.
pub(super) fn all(results: &Path) -> Result<Vec<Chosen>, CliError> {
    let folder = results.join("frames");
    let collection = Collection::read(&folder.join("frames.pvd")).map_err(CliError::Picture)?;
    let read = |file: &_| read_vtu(&folder.join(file)).map_err(CliError::Picture);
    let frames = collection.entries().iter().map(|(_, file)| read(file));
    let chosen = frames.map(|frame| frame.map(|frame| Chosen { frame }));
    let chosen = chosen.collect::<Result<Vec<_>, _>>()?;
    if chosen.is_empty() {
        return Err(CliError::NoFrames {
            path: results.to_path_buf(),
        });
    }
    Ok(chosen)
}

/// Index of the frame that a text such as `40 ms`, `0.04`, `first` or `last` means.
fn nearest(text: &str, stored: &[f64]) -> Result<usize, CliError> {
    let (first, last) = (stored[0], stored[stored.len() - 1]);
    let bad = |reason: String| CliError::BadTime {
        text: text.to_owned(),
        reason,
        count: stored.len(),
        first: seconds(first),
        last: seconds(last),
    };
    let time = match text.trim() {
        "first" => first,
        "last" => last,
        other => match parse_quantity(other) {
            Ok((time, Measure::TIME)) => time,
            Ok((_, measure)) => return Err(bad(format!("it is {}", measure.description()))),
            Err(UnitError::NoUnit { number, .. }) => {
                number.parse().map_err(|_| bad("it is no number".into()))?
            }
            Err(error) => return Err(bad(error.to_string())),
        },
    };
    // Frames are written at the first step past a multiple of the interval: the last one may be a
    // little before the time that a user means.
    let slack = 0.01 * (last - first) / (stored.len().max(2) - 1) as f64;
    if time < first - slack || time > last + slack {
        return Err(bad("the run has no frame then".to_owned()));
    }
    let distance = |index: &usize| (stored[*index] - time).abs();
    let by_distance = |a: &usize, b: &usize| distance(a).total_cmp(&distance(b));
    Ok((0..stored.len()).min_by(by_distance).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_frame_is_taken_and_others_refused_with_the_range() {
        let stored = [0.0, 1.001e-3, 2.002e-3, 2.5e-3];
        for (text, index) in [
            ("first", 0),
            ("last", 3),
            ("1 ms", 1),
            ("0.0018", 2),
            ("2501 us", 3),
        ] {
            assert_eq!(nearest(text, &stored).unwrap(), index, "{text}");
        }
        for (text, reason) in [
            ("3 ms", "the run has no frame then"),
            ("3 mm", "it is a length"),
            ("soon", "does not start with a number"),
            ("-1 ms", "the run has no frame then"),
        ] {
            let message = nearest(text, &stored).unwrap_err().to_string();
            assert!(message.contains(reason), "{message}");
            assert!(
                message.contains("4 frames from 0.0000 s to 2.5000 ms"),
                "{message}"
            );
        }
    }
}
