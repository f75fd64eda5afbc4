//! Result files of a jstsph run: ParaView frames, tables, summaries, restart files, pictures.
//!
//! The only crate of the workspace that writes files. It knows neither solver nor case: it takes
//! plain slices in SI units. Every file that is not a log or a growing table appears complete or not at all
//! ([`atomic_write`]), and nothing that is not finite is written as a result. Formats, columns
//! and units are described in the crate's README.
//!
//! ```
//! # fn main() -> Result<(), jstsph_output::OutputError> {
//! use jstsph_output::plot::{Figure, ParticlePlot};
//! use jstsph_output::{Frame, FrameOptions, FrameSeries, ResultsFolder};
//! use jstsph_tensor::Vec3;
//!
//! # let place = tempfile::tempdir().unwrap();
//! # let path = place.path().join("results");
//! let folder = ResultsFolder::create(&path, false)?;
//! let positions = [Vec3::zeros(), Vec3::new(1e-3, 0.0, 0.0)];
//! let pressure = [1.0e6, 2.0e6]; // Pa
//!
//! // A frame for ParaView: open frames/frames.pvd.
//! let mut frames = FrameSeries::create(&folder.frames(), FrameOptions::default());
//! frames.write(&Frame::new(0.0, 0, &positions).scalar("pressure", &pressure[..]))?;
//!
//! // A picture for a paper.
//! let plot = ParticlePlot {
//!     title: "Two particles".to_owned(),
//!     ..ParticlePlot::new(&positions, &pressure, "pressure", "Pa", 1e-3)
//! };
//! Figure::particles(&plot)?.save_svg(&folder.path().join("pressure.svg"))?;
//! folder.log("done")?;
//! # Ok(())
//! # }
//! ```

mod atomic;
mod clock;
mod component;
mod error;
mod folder;
mod frame;
mod frames;
mod history;
mod json;
mod lock;
pub mod plot;
mod record;
pub mod report;
mod restart;
mod stored;
mod summary;
mod table;
mod values;
mod vtkhdf;
mod vtu;

pub use atomic::atomic_write;
pub use clock::iso8601;
pub use error::{FrameProblem, OutputError, TableProblem};
pub use folder::ResultsFolder;
pub use frame::{Field, Frame, Lattice};
pub use frames::{Collection, FrameSeries};
pub use history::{HISTORY_COLUMNS, HistoryColumn, HistoryRow, HistoryWriter};
pub use record::{Machine, RunRecord};
pub use restart::{
    RestartArray, RestartData, RestartPieces, RestartProblem, RestartWarning, latest_restart,
    read_latest_restart, write_restart, write_restart_pieces,
};
pub use stored::{StoredCells, StoredFrame, read_vtu};
pub use summary::{Energies, Extremes, Status, Summary};
pub use table::{Table, TableWriter, read_table};
pub use values::{Pieces, Values};
pub use vtkhdf::{HAS_VTKHDF, write_vtkhdf};
pub use vtu::{CellKind, FrameOptions, Precision, write_vtu};
