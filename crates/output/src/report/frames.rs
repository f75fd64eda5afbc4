//! Which frames and fields a report carries, and how they are packed.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::encode::{Planes, Width};
use super::{Report, ReportField};
use crate::error::require_length;
use crate::{Collection, OutputError, StoredCells, StoredFrame, read_vtu};

/// Characters that all frames together may take: with curves, case and program a report stays
/// below 15 MB.
const BUDGET: usize = 11_000_000;

/// Frames that a film needs; before there are fewer, digits and then components are left out.
const FLUENT: usize = 24;

/// What the page knows about its frames.
#[derive(Debug, Serialize)]
pub(super) struct FrameIndex {
    pub(super) particles: usize,
    /// Frames of the run; the report has `kept.len()` of them.
    pub(super) total: usize,
    pub(super) is_quantised: bool,
    pub(super) axes: usize,
    pub(super) fields: Vec<FieldEntry>,
    pub(super) kept: Vec<KeptFrame>,
    /// Extremes of the undeformed positions, along each axis.
    pub(super) reference: Vec<[f64; 2]>,
    /// Whether quadrilaterals between particles are there: cells, or faces of a solid.
    pub(super) has_faces: bool,
}

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
enum Source {
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

/// The frames as text.
#[derive(Debug)]
pub(super) struct PackedFrames {
    pub(super) index: FrameIndex,
    /// Name and content of each piece, in the order of the frames; the undeformed positions and
    /// the faces after them.
    pub(super) pieces: Vec<(String, String)>,
}

/// Reads the frames of a run and packs as many as fit.
pub(super) fn pack(folder: &Path, report: &Report<'_>) -> Result<PackedFrames, OutputError> {
    let files = files(folder)?;
    let Some((_, last)) = files.last() else {
        return Err(OutputError::NothingToDraw {
            title: "report".to_owned(),
            reason: "the folder has no frames",
        });
    };
    let last = read_vtu(last)?;
    let plan = Plan::choose(report, &last, files.len(), BUDGET)?;
    let mut packed = PackedFrames {
        index: FrameIndex {
            particles: last.positions.len(),
            total: files.len(),
            is_quantised: plan.width == Width::U16,
            axes: plan.axes,
            fields: plan.entries(),
            kept: Vec::with_capacity(plan.frames),
            reference: Vec::new(),
            has_faces: false,
        },
        pieces: Vec::new(),
    };
    for number in chosen(files.len(), plan.frames) {
        let frame = read_vtu(&files[number].1)?;
        require_length("positions", frame.positions.len(), last.positions.len())?;
        let (kept, text) = plan.frame(&frame, number)?;
        packed
            .pieces
            .push((format!("frame-{}", packed.index.kept.len()), text));
        packed.index.kept.push(kept);
    }
    if let Some(Reference { ranges, text }) = plan.reference(&last)? {
        packed.index.reference = ranges;
        packed.pieces.push(("reference".to_owned(), text));
    }
    let faces = faces(&last.cells, last.positions.len());
    if !faces.is_empty() {
        let mut planes = Planes::default();
        planes.push_indices(faces.iter().flatten().copied());
        packed.index.has_faces = true;
        packed.pieces.push(("faces".to_owned(), text(planes)?));
    }
    Ok(packed)
}

fn files(folder: &Path) -> Result<Vec<(f64, PathBuf)>, OutputError> {
    let folder = folder.join("frames");
    let collection = Collection::read(&folder.join("frames.pvd"))?;
    let entries = collection.entries().iter();
    Ok(entries
        .map(|(time, file)| (*time, folder.join(file)))
        .collect())
}

/// Frames at equal distances, the first and the last among them.
fn chosen(total: usize, frames: usize) -> Vec<usize> {
    match frames {
        0 | 1 => vec![total - 1],
        _ if frames >= total => (0..total).collect(),
        _ => (0..frames)
            .map(|i| (i * (total - 1) + (frames - 1) / 2) / (frames - 1))
            .collect(),
    }
}

/// What is kept of a frame.
struct Plan<'a> {
    fields: Vec<(&'a ReportField, Source)>,
    axes: usize,
    width: Width,
    frames: usize,
}

impl<'a> Plan<'a> {
    /// The most that fits, measured on the last frame, which compresses worst.
    fn choose(
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
        &self,
        last: &StoredFrame,
        total: usize,
        budget: usize,
    ) -> Result<usize, OutputError> {
        let (_, text) = self.frame(last, 0)?;
        Ok((budget / text.len().max(1)).clamp(1, total))
    }

    fn entries(&self) -> Vec<FieldEntry> {
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

    fn frame(
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
    fn reference(&self, frame: &StoredFrame) -> Result<Option<Reference>, OutputError> {
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
struct Reference {
    ranges: Vec<[f64; 2]>,
    text: String,
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

/// Cells of a plane body, outer faces of a solid; none unless every particle is the corner of a
/// cell, because the full cells of a round body alone would show another shape.
fn faces(cells: &StoredCells, particles: usize) -> Vec<[u32; 4]> {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a frame of 2^32 particles does not fit into a report"
    )]
    let short = |face: [usize; 4]| face.map(|corner| corner as u32);
    let is_covered = |corners: &mut dyn Iterator<Item = usize>| {
        let mut is_corner = vec![false; particles];
        corners.for_each(|corner| is_corner[corner] = true);
        is_corner.iter().all(|known| *known)
    };
    match cells {
        StoredCells::Quads(quads) if is_covered(&mut quads.iter().flatten().copied()) => {
            quads.iter().map(|quad| short(*quad)).collect()
        }
        StoredCells::Hexahedra(cells) if is_covered(&mut cells.iter().flatten().copied()) => {
            let sides = [
                [0, 3, 2, 1],
                [4, 5, 6, 7],
                [0, 1, 5, 4],
                [1, 2, 6, 5],
                [2, 3, 7, 6],
                [3, 0, 4, 7],
            ];
            let all = cells
                .iter()
                .flat_map(|cell| sides.map(|side| side.map(|corner| cell[corner])));
            let sorted = |face: &[usize; 4]| {
                let mut key = *face;
                key.sort_unstable();
                key
            };
            let mut count = std::collections::HashMap::new();
            for face in all.clone() {
                *count.entry(sorted(&face)).or_insert(0_u32) += 1;
            }
            all.filter(|face| count[&sorted(face)] == 1)
                .map(short)
                .collect()
        }
        _ => Vec::new(),
    }
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

fn text(planes: Planes) -> Result<String, OutputError> {
    planes.finish().map_err(OutputError::io(
        "compress frames for",
        Path::new("report.html"),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::Quantity;
    use jstsph_tensor::Vec3;

    #[test]
    fn frames_are_thinned_evenly_between_the_first_and_the_last() {
        assert_eq!(chosen(5, 9), [0, 1, 2, 3, 4]);
        assert_eq!(chosen(9, 5), [0, 2, 4, 6, 8]);
        assert_eq!(chosen(10, 4), [0, 3, 6, 9]);
        assert_eq!(chosen(10, 1), [9]);
        let many = chosen(1000, 37);
        assert_eq!((many[0], many[36], many.len()), (0, 999, 37));
        assert!(
            many.windows(2)
                .all(|pair| (27..=28).contains(&(pair[1] - pair[0])))
        );
    }

    fn frame(particles: u32) -> StoredFrame {
        // Digits without a pattern that could be compressed: murmur3's finaliser of a counter.
        let mut count = 0_u32;
        let mut noise = || {
            count += 1;
            let mut word = count.wrapping_mul(0x9e37_79b9);
            word = (word ^ word >> 16).wrapping_mul(0x85eb_ca6b);
            word = (word ^ word >> 13).wrapping_mul(0xc2b2_ae35);
            f64::from(word ^ word >> 16) / f64::from(u32::MAX)
        };
        let mut vectors = || -> Vec<Vec3> {
            let vector = |_| Vec3::new(noise(), noise(), 0.0);
            (0..particles).map(vector).collect()
        };
        let (positions, velocity, pressure) = (vectors(), vectors(), vectors());
        let pressure = pressure.iter().map(|vector| vector.x).collect();
        StoredFrame {
            positions,
            scalars: vec![("pressure".to_owned(), pressure)],
            vectors: vec![("velocity".to_owned(), velocity)],
            ..StoredFrame::default()
        }
    }

    fn report() -> Report<'static> {
        let field = |name: &str, is_component| ReportField {
            name: name.to_owned(),
            quantity: Quantity::new(name, ""),
            is_component,
        };
        Report {
            fields: vec![
                field("pressure", false),
                field("velocity", false),
                field("velocity_x", true),
                field("velocity_y", true),
                field("heat", false),
            ],
            ..Report::default()
        }
    }

    #[test]
    fn digits_go_before_components_and_components_before_frames() {
        let (report, frame) = (report(), frame(1000));
        let plan = |budget| Plan::choose(&report, &frame, 100, budget).unwrap();
        let whole = plan(usize::MAX);
        assert_eq!((whole.width, whole.frames), (Width::F32, 100));
        // Unknown fields are left out; a magnitude refers to its components.
        assert_eq!(whole.fields.len(), 4);
        assert_eq!(whole.fields[1].1, Source::Magnitude(vec![2, 3]));
        let size = whole.frame(&frame, 0).unwrap().1.len();
        assert_eq!(plan(FLUENT * size).width, Width::F32);
        let short = plan(FLUENT * size - 1);
        assert_eq!((short.width, short.fields.len()), (Width::U16, 4));
        let least = plan(3 * size);
        assert_eq!((least.width, least.fields.len()), (Width::U16, 1));
        assert!(least.frames > 3 && least.frames < FLUENT);
    }

    #[test]
    fn a_solid_shows_its_outer_faces() {
        let cells = |corners: &[[usize; 8]]| StoredCells::Hexahedra(corners.to_vec());
        let one = cells(&[[0, 1, 2, 3, 4, 5, 6, 7]]);
        assert_eq!(faces(&one, 8).len(), 6);
        let two = cells(&[[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11]]);
        assert_eq!(faces(&two, 12).len(), 10);
        assert!(!faces(&two, 12).contains(&[4, 5, 6, 7]));
        // A particle that is no corner.
        assert!(faces(&two, 13).is_empty());
    }
}
