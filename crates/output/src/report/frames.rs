//! Which frames and fields a report carries, and how they are packed.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::Report;
use super::encode::{Planes, Width};
use super::plan::{FieldEntry, KeptFrame, Plan, Reference, text};
use super::thin::Thinned;
use crate::error::require_length;
use crate::{Collection, OutputError, StoredCells, StoredFrame, read_vtu};

/// Characters that all frames together may take: with curves, case and program a report stays
/// below 15 MB.
const BUDGET: usize = 11_000_000;

/// The same for frames, undeformed positions and faces together.
const ALL: usize = 12_500_000;

/// Frames for which there is to be room when particles have to be left out.
const SCENES: usize = 4;

/// What the page knows about its frames.
#[derive(Debug, Serialize)]
pub(super) struct FrameIndex {
    pub(super) particles: usize,
    /// Particles of the run; if the report has fewer, their numbers are one of its pieces.
    pub(super) total_particles: usize,
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
    pack_within(folder, report, [BUDGET, ALL])
}

/// The same with limits for the frames, and for all together.
fn pack_within(
    folder: &Path,
    report: &Report<'_>,
    budgets: [usize; 2],
) -> Result<PackedFrames, OutputError> {
    let files = files(folder)?;
    let Some((_, last)) = files.last() else {
        return Err(OutputError::NothingToDraw {
            title: "report".to_owned(),
            reason: "the folder has no frames",
        });
    };
    let last = read_vtu(last)?;
    let total_particles = last.positions.len();
    let contents = Contents::choose(report, &last, files.len(), budgets)?;
    let Contents { plan, thinned, .. } = &contents;
    let mut packed = PackedFrames {
        index: FrameIndex {
            particles: thinned
                .as_ref()
                .map_or(total_particles, |t| t.particles.len()),
            total_particles,
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
        require_length("positions", frame.positions.len(), total_particles)?;
        let frame = match thinned {
            Some(thinned) => thinned.frame(&frame),
            None => frame,
        };
        let (kept, text) = plan.frame(&frame, number)?;
        packed
            .pieces
            .push((format!("frame-{}", packed.index.kept.len()), text));
        packed.index.kept.push(kept);
    }
    if let Some(Reference { ranges, text }) = contents.reference {
        packed.index.reference = ranges;
        packed.pieces.push(("reference".to_owned(), text));
    }
    if let Some(faces) = contents.faces {
        packed.index.has_faces = true;
        packed.pieces.push(("faces".to_owned(), faces));
    }
    if let Some(numbers) = contents.numbers {
        packed.pieces.push(("numbers".to_owned(), numbers));
    }
    Ok(packed)
}

/// What goes into a report beside its frames, and the plan for them.
struct Contents<'a> {
    plan: Plan<'a>,
    thinned: Option<Thinned>,
    reference: Option<Reference>,
    faces: Option<String>,
    /// Numbers of the particles, if not all are there.
    numbers: Option<String>,
}

impl<'a> Contents<'a> {
    /// All particles if one frame of them fits, else as many as leave room for a few frames.
    fn choose(
        report: &'a Report<'_>,
        last: &StoredFrame,
        total: usize,
        budgets: [usize; 2],
    ) -> Result<Self, OutputError> {
        let faces = faces(&last.cells, last.positions.len());
        let mut contents = Self::plan(report, last, total, (budgets, &faces, None))?;
        let mut count = last.positions.len();
        while contents.plan.frames == 0 {
            // What one frame and the rest take now, against what a few frames may take.
            let frame = contents.plan.frame_length;
            let needed = frame * total.min(SCENES) + contents.fixed();
            let part = (0.9 * budgets[1] as f64 / needed as f64).min(0.9);
            count = (count as f64 * part) as usize;
            let thinned = Thinned::choose(last.positions.len(), &faces, count);
            count = thinned.particles.len();
            let few = thinned.frame(last);
            let kept = thinned.faces.clone();
            contents = Self::plan(report, &few, total, (budgets, &kept, Some(thinned)))?;
        }
        Ok(contents)
    }

    /// The frames that fit beside the rest; none if not even one does.
    fn plan(
        report: &'a Report<'_>,
        last: &StoredFrame,
        total: usize,
        (budgets, faces, thinned): ([usize; 2], &[[u32; 4]], Option<Thinned>),
    ) -> Result<Self, OutputError> {
        let plan = Plan::choose(report, last, total, budgets[0])?;
        let indices = |values: Vec<u32>| {
            let mut planes = Planes::default();
            planes.push_indices(values.iter().copied());
            (!values.is_empty()).then(|| text(planes)).transpose()
        };
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a frame of 2^32 particles does not fit into memory"
        )]
        let numbers = thinned
            .iter()
            .flat_map(|t| t.particles.iter().map(|p| *p as u32));
        let mut contents = Self {
            reference: plan.reference(last)?,
            faces: indices(faces.iter().flatten().copied().collect())?,
            numbers: indices(numbers.collect())?,
            plan,
            thinned,
        };
        let left = budgets[1].saturating_sub(contents.fixed());
        let fitting = left / contents.plan.frame_length.max(1);
        contents.plan.frames = contents.plan.frames.min(fitting);
        Ok(contents)
    }

    /// Characters of what is no frame.
    fn fixed(&self) -> usize {
        let reference = self.reference.as_ref().map_or(0, |r| r.text.len());
        let others = [&self.faces, &self.numbers];
        let others = others
            .iter()
            .map(|text| text.as_ref().map_or(0, String::len));
        reference + others.sum::<usize>()
    }
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

#[cfg(test)]
mod tests {
    use super::super::plan::{FLUENT, Source};
    use super::super::{Report, ReportField};
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

    #[test]
    fn particles_go_when_not_even_one_frame_fits() {
        let mut report = report();
        report.fields.push(ReportField {
            name: "displacement_x".to_owned(),
            quantity: Quantity::new("displacement", "m"),
            is_component: true,
        });
        let mut last = frame(30_000);
        last.vectors
            .push(("displacement".to_owned(), last.positions.clone()));
        let size = |budget: usize| -> Contents<'_> {
            Contents::choose(&report, &last, 10, [budget, budget]).unwrap()
        };
        let whole = size(4_000_000);
        assert!(whole.thinned.is_none() && whole.numbers.is_none());
        assert_eq!(whole.plan.frames, 10);
        for budget in [120_000, 60_000, 9_000] {
            let few = size(budget);
            let plan = &few.plan;
            assert!(plan.frames * plan.frame_length + few.fixed() <= budget);
            assert!((SCENES - 1..10).contains(&plan.frames), "{}", plan.frames);
            let kept = few.thinned.as_ref().unwrap().particles.len();
            // Positions and one field of two bytes, which are noise, in base 64; beside them the
            // undeformed positions and the numbers.
            assert!(
                kept > budget / 60 && kept < budget / 20,
                "{kept} of {budget}"
            );
        }
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
