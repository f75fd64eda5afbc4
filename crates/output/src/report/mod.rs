//! A report: one HTML file with the numbers, curves and an interactive view of a run.
//!
//! The file needs neither network nor other files: style, program and data are in it. The page is
//! written in `report.html`, `report.css` and the `.js` files beside this one.

mod encode;
mod frames;
mod page;
mod plan;
mod thin;

use std::path::Path;

use jstsph_tensor::Vec3;

use crate::json::read_json;
use crate::plot::{LinePlot, Quantity, Wall};
use crate::record::RECORD;
use crate::summary::SUMMARY;
use crate::{OutputError, RunRecord, Summary, atomic_write};

/// What a report shows beyond what the files of a results folder say by themselves.
#[derive(Debug, Clone, Default)]
pub struct Report<'a> {
    /// Name of the case.
    pub case: &'a str,
    /// What the case is, in one line.
    pub heading: &'a str,
    /// Whether the third dimension is one; else the z of all vectors is left out.
    pub is_solid: bool,
    /// Initial distance of particles, m: their size in the view.
    pub spacing: f64,
    /// Fields to choose from, in this order; those that the frames do not have are left out.
    pub fields: Vec<ReportField>,
    /// Undeformed bodies as lines, m.
    pub undeformed: Vec<Vec<Vec3>>,
    /// What is around the bodies.
    pub obstacles: Vec<ReportObstacle>,
    /// Diagrams with their titles.
    pub diagrams: Vec<LinePlot>,
    /// SI unit of energies.
    pub energy_unit: String,
    /// SI units of the probes, by name; empty for pure numbers.
    pub probe_units: Vec<(String, String)>,
}

/// A field of the particles.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportField {
    /// Name as [`StoredFrame::values`](crate::StoredFrame::values) takes it.
    pub name: String,
    /// Name and SI unit as shown.
    pub quantity: Quantity,
    /// Whether it is a part of a vector or tensor, the first to be left out of a report that
    /// would become too large.
    pub is_component: bool,
}

/// A rigid obstacle.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReportObstacle {
    /// Its name.
    pub name: String,
    /// Its outlines at the start, m.
    pub walls: Vec<Wall>,
    /// How far it has moved, m, at the time of each frame of the run; empty if it rests.
    pub displacements: Vec<Vec3>,
}

/// What a report that was written holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReportSize {
    /// Size of the file.
    pub bytes: usize,
    /// Frames in it.
    pub frames: usize,
    /// Frames of the run.
    pub total_frames: usize,
    /// Whether fields have 16 bits instead of 32, to keep the file small.
    pub is_quantised: bool,
    /// Particles in it.
    pub particles: usize,
    /// Particles of the run.
    pub total_particles: usize,
}

impl Report<'_> {
    /// Writes the report of the results folder `folder` to `path`, atomically.
    ///
    /// Frames, `case.toml` and, where they exist, `case.original.toml`, `summary.json`, `run.json` and
    /// `run.log` are read from the folder. The file stays below 15 MB as long as its curves do: where
    /// needed fields are rounded to 16 bits, then components of vectors and tensors are
    /// left out, then frames, and when not one frame fits, particles: an even sample stays, and
    /// the outer faces of a solid if there is room for them.
    ///
    /// # Errors
    /// [`OutputError::NothingToDraw`] without frames; [`OutputError::Io`], [`OutputError::Json`],
    /// [`OutputError::Collection`], [`OutputError::Frame`] for what cannot be read or written;
    /// [`OutputError::FieldLength`] for frames of different runs.
    pub fn write(&self, folder: &Path, path: &Path) -> Result<ReportSize, OutputError> {
        let packed = frames::pack(folder, self)?;
        let files = Files {
            summary: optional(folder, SUMMARY, |_| Summary::read(folder))?,
            record: optional(folder, RECORD, read_json)?,
            case: optional(folder, "case.toml", read_text)?.unwrap_or_default(),
            original: optional(folder, "case.original.toml", read_text)?.unwrap_or_default(),
            log: optional(folder, "run.log", read_text)?.unwrap_or_default(),
        };
        let text = page::page(self, &packed, &files)
            .map_err(|error| OutputError::io("write", path)(error.into()))?;
        atomic_write(path, |writer| writer.write_all(text.as_bytes()))?;
        Ok(ReportSize {
            bytes: text.len(),
            frames: packed.index.kept.len(),
            total_frames: packed.index.total,
            is_quantised: packed.index.is_quantised,
            particles: packed.index.particles,
            total_particles: packed.index.total_particles,
        })
    }
}

/// Files of the results folder as they are.
struct Files {
    summary: Option<Summary>,
    record: Option<RunRecord>,
    case: String,
    original: String,
    log: String,
}

/// A file that a run under way, or one that was killed, may not have.
fn optional<T>(
    folder: &Path,
    name: &str,
    read: impl FnOnce(&Path) -> Result<T, OutputError>,
) -> Result<Option<T>, OutputError> {
    let path = folder.join(name);
    path.is_file().then(|| read(&path)).transpose()
}

/// A log that was cut in the middle of a character is still worth reading.
fn read_text(path: &Path) -> Result<String, OutputError> {
    let bytes = std::fs::read(path).map_err(OutputError::io("read", path))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
