//! Pictures for papers and reports, as PNG and SVG, without any font or program on the machine.
//!
//! [`Figure::particles`] draws a body coloured by a field, [`Figure::lines`] draws curves. Both
//! lay out a list of shapes once; the two file formats render the same list, so that they agree.
//! Text in PNG files is drawn with DejaVu Sans, which is compiled in.

mod animation;
mod axis;
mod canvas;
mod cells;
mod clip;
mod colorbar;
mod colormap;
mod extent;
mod groups;
mod hidden;
mod legend;
mod lines;
mod panels;
mod particles;
mod raster;
mod svg;
mod text;
mod unit;
mod view;
mod walls;

use std::path::Path;

use crate::{OutputError, atomic_write};
use canvas::Canvas;

pub use animation::{Animation, Movie};
pub use axis::Scale;
pub use colormap::ColourMap;
pub use groups::Group;
pub use lines::{LinePlot, Series, SeriesStyle};
pub use particles::ParticlePlot;
pub use unit::Quantity;
pub use view::{Axis, Section, View};
pub use walls::Wall;

/// Text that every picture carries near its beginning, to tell ours from others.
pub(crate) const MARK: &str = "made by jstsph";

/// Pixels per inch of a PNG file: two per CSS pixel.
const PIXELS_PER_INCH: u16 = 192;

/// A finished picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    canvas: Canvas,
}

impl Figure {
    /// A body coloured by a field.
    ///
    /// # Errors
    /// [`OutputError::NothingToDraw`] without particles to show, [`OutputError::FieldLength`],
    /// [`OutputError::NotFinite`], [`OutputError::CellPoint`].
    pub fn particles(plot: &ParticlePlot) -> Result<Self, OutputError> {
        Ok(Self {
            canvas: particles::draw("", 1, std::slice::from_ref(plot))?,
        })
    }

    /// Bodies side by side under a heading (empty for none), each with its own title, with one
    /// scale and one colour bar. View, range, window and quantity are those of the first plot.
    ///
    /// # Errors
    /// Those of [`Self::particles`].
    pub fn panels(heading: &str, plots: &[ParticlePlot]) -> Result<Self, OutputError> {
        Ok(Self {
            canvas: particles::draw(heading, plots.len(), plots)?,
        })
    }

    /// The same in rows of `columns` bodies each.
    ///
    /// # Errors
    /// Those of [`Self::particles`].
    pub fn grid(
        heading: &str,
        columns: usize,
        plots: &[ParticlePlot],
    ) -> Result<Self, OutputError> {
        Ok(Self {
            canvas: particles::draw(heading, columns, plots)?,
        })
    }

    /// Curves over a common axis.
    ///
    /// # Errors
    /// [`OutputError::NothingToDraw`] without points, [`OutputError::NotFinite`],
    /// [`OutputError::NotPositive`] for values that a logarithmic axis cannot show.
    pub fn lines(plot: &LinePlot) -> Result<Self, OutputError> {
        Ok(Self {
            canvas: lines::draw("", std::slice::from_ref(plot))?,
        })
    }

    /// Several diagrams one above the other under a heading (empty for none).
    ///
    /// # Errors
    /// Those of [`Self::lines`].
    pub fn stack(heading: &str, plots: &[LinePlot]) -> Result<Self, OutputError> {
        Ok(Self {
            canvas: lines::draw(heading, plots)?,
        })
    }

    /// Width and height in CSS pixels (1/96 inch).
    pub fn size(&self) -> (f64, f64) {
        (self.canvas.width, self.canvas.height)
    }

    /// Writes a PNG file with two pixels per CSS pixel (192 per inch), atomically.
    ///
    /// # Errors
    /// [`OutputError::Io`].
    pub fn save_png(&self, path: &Path) -> Result<(), OutputError> {
        self.save_png_at(path, PIXELS_PER_INCH)
    }

    /// The same with another number of pixels per inch: below 192 for small files, 300 and more for
    /// print. Sizes in inches, text and lines included, stay the same.
    ///
    /// # Errors
    /// [`OutputError::Io`], also for a picture too large for memory.
    pub fn save_png_at(&self, path: &Path, pixels_per_inch: u16) -> Result<(), OutputError> {
        let bytes = raster::png(&self.canvas, pixels_per_inch);
        let bytes = bytes.map_err(OutputError::io("draw", path))?;
        atomic_write(path, |writer| writer.write_all(&bytes))
    }

    /// Writes an SVG file, atomically.
    ///
    /// # Errors
    /// [`OutputError::Io`].
    pub fn save_svg(&self, path: &Path) -> Result<(), OutputError> {
        let text = self.svg();
        atomic_write(path, |writer| writer.write_all(text.as_bytes()))
    }

    /// The picture as SVG text, for embedding in a report.
    pub fn svg(&self) -> String {
        svg::svg(&self.canvas)
    }
}
