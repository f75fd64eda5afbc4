//! A part of a body in which the frequency of a vibration is looked for.

use crate::local_steps::{Groups, Levels, Tiles};
use crate::parallel;
use crate::reference::BodyReference;

/// The particles that may move, the others being held, and what feels it: whole tiles.
#[derive(Clone, Debug)]
pub(crate) struct Region {
    pub(super) particles: Tiles,
    /// All points that see them.
    pub(super) points: Tiles,
    /// Ends of these points.
    pub(super) ends: Tiles,
}

impl Region {
    /// Empty.
    pub(crate) fn new(body: &BodyReference) -> Self {
        let particles = Tiles::new(body.particles.len());
        Self {
            ends: particles.clone(),
            particles,
            points: Tiles::new(body.points.len()),
        }
    }

    /// Whether everything is held.
    pub(super) fn is_empty(&self) -> bool {
        self.particles.count(Levels::from(1)) == 0
    }

    /// The particles that fine points see.
    pub(crate) fn around(&mut self, body: &BodyReference, groups: &Groups) {
        let (points, ends) = (&mut self.points, &mut self.ends);
        self.particles.copy_from(&groups.moving);
        points.clear();
        ends.clear();
        for q in 0..body.points.len() {
            let mut seen = body.gradient.row(q).indices();
            if points.level(q) == 0 && seen.any(|a| groups.moving.level(a) > 0) {
                points.raise(q, 1);
            }
        }
        for q in points.runs(0..body.points.len(), Levels::from(1)).flatten() {
            body.ends[q].iter().for_each(|a| ends.raise(*a as usize, 1));
        }
    }
}

/// Calls `action(first, run)` for runs of values: of all, or of those in some tiles.
pub(super) fn for_each_run<T: Send>(
    tiles: Option<&Tiles>,
    values: &mut [T],
    action: impl Fn(usize, &mut [T]) + Sync,
) {
    match tiles {
        Some(tiles) => tiles.for_each_run(Levels::from(1), values, action),
        None => parallel::for_each_run(values, action),
    }
}
