//! Which fields a report carries, in how many digits, and how a frame becomes text.

use std::path::Path;

use serde::Serialize;

use super::encode::{Planes, Width};
use super::{Report, ReportField};
use crate::{OutputError, StoredFrame};

/// Frames that a film needs; before there are fewer, digits and then components are left out.
pub(super) const FLUENT: usize = 24;

/// A field that can be chosen.
#[derive(Debug, Serialize)]
pub(super) struct FieldEntry {
    name: String,
    label: String,
    unit: String,
    source: Source,
}

/// Where the values of a field are.
#[derive(Debug, Serialize, Clone, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub(super) enum Source {
    /// Among the arrays of a frame, at the place of the stored fields.
    Stored,
    /// Square root of the sum of squares of other fields, by their places in the list.
    Magnitude(Vec<usize>),
    /// Position minus undeformed position along an axis.
    Displacement(usize),
}

/// A frame of the report.
#[derive(Debug, Serialize)]
pub(super) struct KeptFrame {
    pub(super) time: f64,
    step: u64,
    /// Place among the frames of the run.
    pub(super) number: usize,
    positions: Vec<[f64; 2]>,
    fields: Vec<[f64; 2]>,
}

/// What is kept of a frame.
pub(super) struct Plan<'a> {
    pub(super) fields: Vec<(&'a ReportField, Source)>,
    pub(super) axes: usize,
    pub(super) width: Width,
    pub(super) frames: usize,
    /// Characters of the last frame.
    pub(super) frame_length: usize,
}

impl<'a> Plan<'a> {
    /// The most that fits, measured on the last frame, which compresses worst.
    pub(super) fn choose(
        report: &'a Report<'_>,
        last: &StoredFrame,
        total: usize,
        budget: usize,
    ) -> Result<Self, OutputError> {
        let axes = if report.is_solid { 3 } else { 2 };
        let mut plan = Self {
            fields: sources(&report.fields, last, axes),
            axes,
            width: Width::F32,
            frames: total,
            frame_length: 0,
        };
        let enough = total.min(FLUENT);
        plan.frames = plan.affordable(last, total, budget)?;
        if plan.frames < enough {
            plan.width = Width::U16;
            plan.frames = plan.affordable(last, total, budget)?;
        }
        if plan.frames < enough {
            plan.fields
                .retain(|(field, source)| !field.is_component && *source == Source::Stored);
            plan.frames = plan.affordable(last, total, budget)?;
        }
        Ok(plan)
    }

    fn affordable(
        &mut self,
        last: &StoredFrame,
        total: usize,
        budget: usize,
    ) -> Result<usize, OutputError> {
        self.frame_length = self.frame(last, 0)?.1.len();
        Ok((budget / self.frame_length.max(1)).clamp(1, total))
    }

    pub(super) fn entries(&self) -> Vec<FieldEntry> {
        let fields = self.fields.iter();
        fields
            .map(|(field, source)| FieldEntry {
                name: field.name.clone(),
                label: field.quantity.name.clone(),
                unit: field.quantity.unit.clone(),
                source: source.clone(),
            })
            .collect()
    }

    pub(super) fn frame(
        &self,
        frame: &StoredFrame,
        number: usize,
    ) -> Result<(KeptFrame, String), OutputError> {
        let mut planes = Planes::default();
        let mut kept = KeptFrame {
            time: frame.time,
            step: frame.step,
            number,
            positions: Vec::with_capacity(self.axes),
            fields: Vec::with_capacity(self.fields.len()),
        };
        for axis in 0..self.axes {
            let values: Vec<f64> = frame.positions.iter().map(|x| x[axis]).collect();
            let range = range(&values);
            planes.push(&values, range, self.width);
            kept.positions.push(range);
        }
        for (field, source) in &self.fields {
            let values = frame
                .values(&field.name)
                .ok_or_else(|| missing(field, frame))?;
            let range = range(&values);
            if *source == Source::Stored {
                planes.push(&values, range, self.width);
            }
            kept.fields.push(range);
        }
        Ok((kept, text(planes)?))
    }

    /// Undeformed positions and their extremes, if a displacement is among the fields.
    pub(super) fn reference(&self, frame: &StoredFrame) -> Result<Option<Reference>, OutputError> {
        let is_displacement = |source: &Source| matches!(source, Source::Displacement(_));
        let Some(displacement) = frame.vector("displacement") else {
            return Ok(None);
        };
        if !self
            .fields
            .iter()
            .any(|(_, source)| is_displacement(source))
        {
            return Ok(None);
        }
        let mut planes = Planes::default();
        let mut ranges = Vec::with_capacity(self.axes);
        for axis in 0..self.axes {
            let pairs = frame.positions.iter().zip(displacement);
            let values: Vec<f64> = pairs.map(|(x, u)| x[axis] - u[axis]).collect();
            let range = range(&values);
            planes.push(&values, range, self.width);
            ranges.push(range);
        }
        let text = text(planes)?;
        Ok(Some(Reference { ranges, text }))
    }
}

/// The undeformed positions as text.
pub(super) struct Reference {
    pub(super) ranges: Vec<[f64; 2]>,
    pub(super) text: String,
}

/// Where the values of the fields come from that a frame has.
fn sources<'a>(
    fields: &'a [ReportField],
    frame: &StoredFrame,
    axes: usize,
) -> Vec<(&'a ReportField, Source)> {
    let known: Vec<&ReportField> = fields
        .iter()
        .filter(|field| frame.values(&field.name).is_some())
        .collect();
    let place = |name: &str| known.iter().position(|field| field.name == name);
    let suffixes = ["x", "y", "z"];
    let source = |field: &ReportField| {
        if frame.vector(&field.name).is_some() {
            let parts = suffixes[..axes].iter();
            let places: Option<Vec<usize>> = parts
                .map(|suffix| place(&format!("{}_{suffix}", field.name)))
                .collect();
            return places.map_or(Source::Stored, Source::Magnitude);
        }
        let axis = field.name.strip_prefix("displacement_");
        let axis = axis.and_then(|suffix| suffixes.iter().position(|other| *other == suffix));
        match axis.filter(|axis| *axis < axes && frame.vector("displacement").is_some()) {
            Some(axis) => Source::Displacement(axis),
            None => Source::Stored,
        }
    };
    known.iter().map(|field| (*field, source(field))).collect()
}

/// Least and most value.
fn range(values: &[f64]) -> [f64; 2] {
    let ends = values
        .iter()
        .fold([f64::MAX, f64::MIN], |[low, high], value| {
            [low.min(*value), high.max(*value)]
        });
    if values.is_empty() { [0.0, 0.0] } else { ends }
}

fn missing(field: &ReportField, frame: &StoredFrame) -> OutputError {
    OutputError::NoColumn {
        column: field.name.clone(),
        columns: frame.value_names(),
    }
}

/// Arrays as text.
pub(super) fn text(planes: Planes) -> Result<String, OutputError> {
    planes.finish().map_err(OutputError::io(
        "compress frames for",
        Path::new("report.html"),
    ))
}
