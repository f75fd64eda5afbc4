//! One instant of a simulation as plain slices.

use std::borrow::Cow;
use std::collections::HashSet;
use std::ops::Range;

use jstsph_tensor::{Mat3, Vec3};

use crate::error::{require_finite, require_length};
use crate::{OutputError, Values};

/// A named field with one entry per particle.
pub type Field<'a, T> = (Cow<'a, str>, Values<'a, T>);

/// The particles of one instant with any number of fields, all in SI units.
///
/// ```
/// use jstsph_output::Frame;
/// use jstsph_tensor::Vec3;
///
/// let positions = [Vec3::zeros(), Vec3::x()];
/// let frame = Frame::new(0.5, 12, &positions[..])
///     .scalar("pressure", vec![1.0e5, 2.0e5])
///     .vector("velocity", &positions[..]);
/// assert!(frame.check().is_ok());
/// ```
#[derive(Debug, Clone)]
pub struct Frame<'a> {
    /// Simulated time, s.
    pub time: f64,
    /// Number of steps done.
    pub step: u64,
    /// Current positions, m.
    pub positions: Values<'a, Vec3>,
    /// Scalar fields.
    pub scalars: Vec<Field<'a, f64>>,
    /// Vector fields.
    pub vectors: Vec<Field<'a, Vec3>>,
    /// Second-order tensor fields.
    pub tensors: Vec<Field<'a, Mat3>>,
    /// Cells of the undeformed lattice, if the body has one.
    pub lattice: Lattice<'a>,
}

/// Cells that join neighbouring particles of a lattice, for pictures of a filled body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Lattice<'a> {
    /// The body has no lattice.
    #[default]
    None,
    /// Quadrilaterals, corners in order around the cell.
    Quads(&'a [[u32; 4]]),
    /// Hexahedra: corners around the lower face, then those above them (VTK's order).
    Hexahedra(&'a [[u32; 8]]),
}

impl<'a> Frame<'a> {
    /// A frame without fields; `time` in s, `positions` in m, borrowed, owned or in pieces.
    pub fn new(time: f64, step: u64, positions: impl Into<Values<'a, Vec3>>) -> Self {
        Self {
            time,
            step,
            positions: positions.into(),
            scalars: Vec::new(),
            vectors: Vec::new(),
            tensors: Vec::new(),
            lattice: Lattice::None,
        }
    }

    /// Adds a scalar field, borrowed, owned or in pieces.
    #[must_use]
    pub fn scalar(
        mut self,
        name: impl Into<Cow<'a, str>>,
        values: impl Into<Values<'a, f64>>,
    ) -> Self {
        self.scalars.push((name.into(), values.into()));
        self
    }

    /// Adds a vector field, borrowed, owned or in pieces.
    #[must_use]
    pub fn vector(
        mut self,
        name: impl Into<Cow<'a, str>>,
        values: impl Into<Values<'a, Vec3>>,
    ) -> Self {
        self.vectors.push((name.into(), values.into()));
        self
    }

    /// Adds a tensor field, borrowed, owned or in pieces.
    #[must_use]
    pub fn tensor(
        mut self,
        name: impl Into<Cow<'a, str>>,
        values: impl Into<Values<'a, Mat3>>,
    ) -> Self {
        self.tensors.push((name.into(), values.into()));
        self
    }

    /// Sets the lattice cells.
    #[must_use]
    pub fn lattice(mut self, lattice: Lattice<'a>) -> Self {
        self.lattice = lattice;
        self
    }

    /// Checks that every field has one finite entry per particle, names differ, and cells refer to
    /// particles that exist.
    ///
    /// # Errors
    /// [`OutputError::NotFinite`], [`OutputError::FieldLength`], [`OutputError::DuplicateName`] or
    /// [`OutputError::CellPoint`], for the first offence found.
    pub fn check(&self) -> Result<(), OutputError> {
        self.check_form()?;
        check_all("position", &self.positions)?;
        for (name, values) in &self.scalars {
            check_all(name, values)?;
        }
        for (name, values) in &self.vectors {
            check_all(name, values)?;
        }
        for (name, values) in &self.tensors {
            check_all(name, values)?;
        }
        Ok(())
    }

    /// [`Self::check`] without the values of the fields.
    pub(crate) fn check_form(&self) -> Result<(), OutputError> {
        let particles = self.positions.len();
        require_finite("time", [self.time])?;
        for (name, values) in &self.scalars {
            require_length(name, values.len(), particles)?;
        }
        for (name, values) in &self.vectors {
            require_length(name, values.len(), particles)?;
        }
        for (name, values) in &self.tensors {
            require_length(name, values.len(), particles)?;
        }
        self.check_names()?;
        match self.lattice {
            Lattice::None => Ok(()),
            Lattice::Quads(cells) => check_cells(cells, particles),
            Lattice::Hexahedra(cells) => check_cells(cells, particles),
        }
    }

    fn check_names(&self) -> Result<(), OutputError> {
        let scalars = self.scalars.iter().map(|(name, _)| name);
        let vectors = self.vectors.iter().map(|(name, _)| name);
        let tensors = self.tensors.iter().map(|(name, _)| name);
        let mut seen = HashSet::new();
        for name in scalars.chain(vectors).chain(tensors) {
            if !seen.insert(name.as_ref()) {
                return Err(OutputError::DuplicateName {
                    name: name.to_string(),
                });
            }
        }
        Ok(())
    }
}

/// A quantity made of a fixed number of components.
pub(crate) trait Components: Copy + Send + Sync {
    /// Names of the components in writing order; empty for a scalar.
    const NAMES: &'static [&'static str];

    /// Appends the components, row by row for a tensor.
    fn append_to(&self, values: &mut Vec<f64>);
}

impl Components for f64 {
    const NAMES: &'static [&'static str] = &[];

    fn append_to(&self, values: &mut Vec<f64>) {
        values.push(*self);
    }
}

impl Components for Vec3 {
    const NAMES: &'static [&'static str] = &["X", "Y", "Z"];

    fn append_to(&self, values: &mut Vec<f64>) {
        values.extend_from_slice(self.as_slice());
    }
}

impl Components for Mat3 {
    const NAMES: &'static [&'static str] = &["XX", "XY", "XZ", "YX", "YY", "YZ", "ZX", "ZY", "ZZ"];

    fn append_to(&self, values: &mut Vec<f64>) {
        // nalgebra stores columns; the transpose read in storage order is row by row.
        values.extend_from_slice(self.transpose().as_slice());
    }
}

/// Some of the numbers that [`flatten`] gives, none of them beyond `largest`.
///
/// # Errors
/// [`OutputError::NotFinite`].
pub(crate) fn flatten_range<T: Components>(
    name: &str,
    values: &Values<'_, T>,
    range: Range<usize>,
    largest: f64,
) -> Result<Vec<f64>, OutputError> {
    let width = T::NAMES.len().max(1);
    let (first, last) = (range.start / width, range.end.div_ceil(width));
    let values = values.get(first..last);
    check_values(name, &values, first, largest)?;
    let mut flat = flatten(&values);
    flat.truncate(range.end - first * width);
    flat.drain(..range.start - first * width);
    Ok(flat)
}

/// All components of all particles in writing order.
pub(crate) fn flatten<T: Components>(values: &[T]) -> Vec<f64> {
    let mut flat = Vec::with_capacity(values.len() * T::NAMES.len().max(1));
    for value in values {
        value.append_to(&mut flat);
    }
    flat
}

/// Entries that are read at once.
const PIECE: usize = 1 << 13;

fn check_all<T: Components>(name: &str, values: &Values<'_, T>) -> Result<(), OutputError> {
    for first in (0..values.len()).step_by(PIECE) {
        let piece = values.get(first..values.len().min(first + PIECE));
        check_values(name, &piece, first, f64::MAX)?;
    }
    Ok(())
}

/// Checks entries of which the first has the index `first`.
fn check_values<T: Components>(
    name: &str,
    values: &[T],
    first: usize,
    largest: f64,
) -> Result<(), OutputError> {
    let mut components = Vec::with_capacity(9);
    for (index, value) in values.iter().enumerate() {
        components.clear();
        value.append_to(&mut components);
        let bad = components.iter().find(|c| c.is_nan() || c.abs() > largest);
        if let Some(&value) = bad {
            return Err(OutputError::NotFinite {
                field: name.to_owned(),
                index: first + index,
                value,
            });
        }
    }
    Ok(())
}

fn check_cells<const N: usize>(cells: &[[u32; N]], points: usize) -> Result<(), OutputError> {
    for (cell, corners) in cells.iter().enumerate() {
        if let Some(&point) = corners.iter().find(|&&point| point as usize >= points) {
            return Err(OutputError::CellPoint {
                cell,
                point: point as usize,
                points,
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_is_not_finite_is_found_with_field_and_particle() {
        let positions = [Vec3::zeros(), Vec3::x(), Vec3::y()];
        let mut stress = [Mat3::identity(); 3];
        stress[2][(1, 0)] = f64::NAN;
        let error = Frame::new(0.0, 0, &positions[..])
            .tensor("cauchy_stress", &stress[..])
            .check()
            .unwrap_err();
        assert!(
            matches!(&error, OutputError::NotFinite { field, index: 2, .. } if field == "cauchy_stress"),
            "{error}"
        );
        assert!(error.to_string().contains("NaN"), "{error}");
    }

    #[test]
    fn lengths_names_and_cells_are_checked() {
        let positions = [Vec3::zeros(), Vec3::x()];
        let short = Frame::new(0.0, 0, &positions[..]).scalar("jacobian", vec![1.0]);
        assert!(matches!(
            short.check(),
            Err(OutputError::FieldLength {
                found: 1,
                expected: 2,
                ..
            })
        ));
        let twice = Frame::new(0.0, 0, &positions[..])
            .scalar("velocity", vec![1.0, 2.0])
            .vector("velocity", &positions[..]);
        assert!(matches!(
            twice.check(),
            Err(OutputError::DuplicateName { .. })
        ));
        let cells = Frame::new(0.0, 0, &positions[..]).lattice(Lattice::Quads(&[[0, 1, 2, 0]]));
        assert!(matches!(
            cells.check(),
            Err(OutputError::CellPoint {
                cell: 0,
                point: 2,
                points: 2
            })
        ));
    }

    #[test]
    fn tensors_are_flattened_row_by_row() {
        let tensor = Mat3::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0);
        assert_eq!(
            flatten(&[tensor]),
            [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]
        );
        assert_eq!(Mat3::NAMES[1], "XY");
        assert_eq!(tensor[(0, 1)], 2.0);
    }
}
