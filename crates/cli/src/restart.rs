//! A simulation's state as a restart file and back.

use std::path::{Path, PathBuf};

use jstsph_output::{OutputError, RestartArray, RestartData, RestartPieces, write_restart_pieces};
use jstsph_solver::{Saved, Simulation};
use jstsph_tensor::Vec3;
use serde_json::{Value, json};

/// What the recorder must remember beside the state.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LastRow {
    /// Time of the last row of the history, s.
    pub(crate) time: f64,
    /// Impulse each obstacle had received by then, N s.
    pub(crate) impulses: Vec<Vec3>,
}

/// Time, time step, number of steps of a state and whether it is synchronised.
type Instant = (f64, f64, u64, bool);

fn header((time, time_step, step, synchronised): Instant, resolved: &str, last: &LastRow) -> Value {
    let impulses: Vec<[f64; 3]> = last.impulses.iter().map(|v| [v.x, v.y, v.z]).collect();
    json!({
        "case": resolved,
        "time": time,
        "time_step": time_step,
        "step": step,
        "synchronised": synchronised,
        "last_row_time": last.time,
        "last_row_impulses": impulses,
    })
}

/// Writes the present state, with the contents of [`encode`] but no copy of it in memory.
pub(crate) fn write(
    folder: &Path,
    simulation: &Simulation,
    resolved: &str,
    last: &LastRow,
) -> Result<PathBuf, OutputError> {
    let step = simulation.step_count();
    let now = (
        simulation.time(),
        simulation.time_step(),
        step,
        simulation.is_synchronised(),
    );
    let arrays: Vec<RestartPieces<'_>> = simulation
        .saved_arrays()
        .into_iter()
        .map(|mut array| {
            let (name, items, width) = (std::mem::take(&mut array.name), array.items, array.width);
            RestartPieces::list(name, items, width, move |range, out| {
                array.append_to(range, out);
            })
        })
        .collect();
    write_restart_pieces(folder, step, &header(now, resolved, last), &arrays)
}

/// A restart file's contents.
pub(crate) fn encode(saved: Saved, resolved: &str, last: &LastRow) -> RestartData {
    let instant = (saved.time, saved.time_step, saved.step, saved.synchronised);
    RestartData {
        header: header(instant, resolved, last),
        arrays: saved
            .arrays
            .into_iter()
            .map(|(name, values)| RestartArray {
                name,
                shape: vec![values.len() as u64],
                values,
            })
            .collect(),
    }
}

/// The state, what the recorder remembered, and the resolved case it belongs to; `None` when the
/// header is not one that [`encode`] writes.
pub(crate) fn decode(data: RestartData) -> Option<(Saved, LastRow, String)> {
    let header = &data.header;
    let number = |name: &str| header.get(name).and_then(Value::as_f64);
    let impulses = header
        .get("last_row_impulses")?
        .as_array()?
        .iter()
        .map(|impulse| {
            let component = |axis: usize| impulse.get(axis).and_then(Value::as_f64);
            Some(Vec3::new(component(0)?, component(1)?, component(2)?))
        });
    let last = LastRow {
        time: number("last_row_time")?,
        impulses: impulses.collect::<Option<_>>()?,
    };
    let resolved = header.get("case")?.as_str()?.to_owned();
    let saved = Saved {
        time: number("time")?,
        time_step: number("time_step")?,
        step: header.get("step")?.as_u64()?,
        synchronised: header.get("synchronised")?.as_bool()?,
        arrays: data
            .arrays
            .into_iter()
            .map(|array| (array.name, array.values))
            .collect(),
    };
    Some((saved, last, resolved))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_survives_the_file_format() {
        let saved = Saved {
            time: 0.1 + 0.2,
            time_step: 1e-300,
            step: u64::MAX,
            synchronised: false,
            arrays: vec![
                ("position".to_owned(), vec![1.0, -0.0]),
                ("empty".to_owned(), Vec::new()),
            ],
        };
        let last = LastRow {
            time: 0.3,
            impulses: vec![Vec3::new(1.0, 2.0, 3.0)],
        };
        let folder = tempfile::tempdir().expect("a folder");
        jstsph_output::write_restart(folder.path(), 7, &encode(saved.clone(), "text", &last))
            .expect("written");
        let (data, warnings) = jstsph_output::read_latest_restart(folder.path()).expect("read");
        assert!(warnings.is_empty());
        assert_eq!(decode(data), Some((saved, last, "text".to_owned())));
    }
}
