//! Which points and particles make several steps within one step of the others.

use std::ops::Range;

use jstsph_tensor::lanes::TILE;

use crate::parallel;
use crate::reference::BodyReference;

/// The largest level: its step is that of level 0 halved so many times.
pub(crate) const LARGEST_LEVEL: u8 = 6;

/// Consecutive levels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Levels {
    low: u8,
    high: u8,
}

impl Levels {
    /// One level.
    pub(crate) fn only(level: u8) -> Self {
        Self {
            low: level,
            high: level,
        }
    }

    /// A level and all finer ones.
    pub(crate) fn from(level: u8) -> Self {
        Self {
            low: level,
            high: LARGEST_LEVEL,
        }
    }

    #[inline]
    fn contains(self, level: u8) -> bool {
        (self.low..=self.high).contains(&level)
    }
}

/// A level for each whole tile of the points or particles of a body.
#[derive(Clone, Debug)]
pub(crate) struct Tiles {
    level: Vec<u8>,
    items: usize,
}

impl Tiles {
    /// All of level 0.
    pub(crate) fn new(items: usize) -> Self {
        Self {
            level: vec![0; items.div_ceil(TILE)],
            items,
        }
    }

    pub(crate) fn clear(&mut self) {
        self.level.fill(0);
    }

    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.level.copy_from_slice(&other.level);
    }

    pub(crate) fn raise(&mut self, item: usize, level: u8) {
        let own = &mut self.level[item / TILE];
        *own = (*own).max(level);
    }

    #[inline]
    pub(crate) fn level(&self, item: usize) -> u8 {
        self.level[item / TILE]
    }

    /// Number of items of some levels.
    pub(crate) fn count(&self, levels: Levels) -> usize {
        self.runs(0..self.items, levels).map(|run| run.len()).sum()
    }

    /// The items of `within` of some levels as runs of neighbours; `within` begins with a tile.
    pub(crate) fn runs(
        &self,
        within: Range<usize>,
        levels: Levels,
    ) -> impl Iterator<Item = Range<usize>> + '_ {
        debug_assert_eq!(within.start % TILE, 0);
        let last = within.end.div_ceil(TILE);
        let mut tile = within.start / TILE;
        std::iter::from_fn(move || {
            while tile < last && !levels.contains(self.level[tile]) {
                tile += 1;
            }
            if tile == last {
                return None;
            }
            let first = tile;
            while tile < last && levels.contains(self.level[tile]) {
                tile += 1;
            }
            Some(first * TILE..(tile * TILE).min(within.end))
        })
    }

    /// Calls `action(first, run)` for runs of those of `values` that have one of the levels.
    pub(crate) fn for_each_run<T: Send>(
        &self,
        levels: Levels,
        values: &mut [T],
        action: impl Fn(usize, &mut [T]) + Sync,
    ) {
        parallel::for_each_run(values, |offset, values| {
            for run in self.runs(offset..offset + values.len(), levels) {
                action(run.start, &mut values[run.start - offset..run.end - offset]);
            }
        });
    }

    /// The same with three arrays.
    pub(crate) fn for_each_chunk<A: Send, B: Send, C: Send>(
        &self,
        levels: Levels,
        (first, second, third): (&mut [A], &mut [B], &mut [C]),
        action: impl Fn(usize, &mut [A], &mut [B], &mut [C]) + Sync,
    ) {
        parallel::for_each_chunk(first, second, third, |offset, first, second, third| {
            for run in self.runs(offset..offset + first.len(), levels) {
                let here = run.start - offset..run.end - offset;
                action(
                    run.start,
                    &mut first[here.clone()],
                    &mut second[here.clone()],
                    &mut third[here],
                );
            }
        });
    }
}

/// The levels of one body; indices are those of the body. What is of level k makes steps of Δ/2^k.
///
/// Points have the level of their tile, so that all loops run over runs of neighbours. J of a particle
/// has the smallest level of its points. Particles move with the largest level of the points that see
/// them: whole tiles again.
#[derive(Clone, Debug)]
pub(crate) struct Groups {
    pub(crate) points: Tiles,
    pub(crate) moving: Tiles,
    pub(crate) jacobian: Vec<u8>,
}

impl Groups {
    /// Everything is of level 0.
    pub(crate) fn new(body: &BodyReference) -> Self {
        Self {
            points: Tiles::new(body.points.len()),
            moving: Tiles::new(body.particles.len()),
            jacobian: vec![0; body.particles.len()],
        }
    }

    /// Gives all points of a particle at least the level that any of them asks for.
    pub(crate) fn choose(&mut self, body: &BodyReference, asked: impl Fn(usize) -> u8) {
        self.points.clear();
        for a in 0..body.particles.len() {
            let (points, _) = body.shares.of(a);
            let largest = points.iter().map(|q| asked(*q as usize)).max();
            if let Some(level @ 1..) = largest {
                points
                    .iter()
                    .for_each(|q| self.points.raise(*q as usize, level));
            }
        }
        self.complete(body);
    }

    /// What follows from the levels of the points.
    fn complete(&mut self, body: &BodyReference) {
        self.moving.clear();
        let fine = self.points.runs(0..body.points.len(), Levels::from(1));
        for q in fine.flatten() {
            let level = self.points.level(q);
            let row = body.gradient.row(q);
            row.indices().for_each(|a| self.moving.raise(a, level));
        }
        for (a, level) in self.jacobian.iter_mut().enumerate() {
            let (points, _) = body.shares.of(a);
            let levels = points.iter().map(|q| self.points.level(*q as usize));
            *level = levels.min().unwrap_or(0);
        }
    }

    /// One number per tile of points, for restart files.
    pub(crate) fn saved(&self) -> impl Iterator<Item = f64> + '_ {
        self.points.level.iter().map(|level| f64::from(*level))
    }

    /// Length of [`saved`](Self::saved).
    pub(crate) fn tiles(&self) -> usize {
        self.points.level.len()
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "written by `saved`"
    )]
    pub(crate) fn restore(&mut self, body: &BodyReference, saved: &[f64]) {
        for (level, saved) in self.points.level.iter_mut().zip(saved) {
            *level = (*saved as u8).min(LARGEST_LEVEL);
        }
        self.complete(body);
    }
}

/// The points and particles of one level of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part<'a> {
    pub(crate) groups: &'a Groups,
    pub(crate) level: u8,
}

impl Part<'_> {
    /// Calls `action(a, &mut values[a])` for the particles whose J belongs to this part.
    pub(crate) fn for_each_jacobian<T: Send>(
        &self,
        values: &mut [T],
        action: impl Fn(usize, &mut T) + Sync,
    ) {
        let of_run = |first: usize, values: &mut [T]| {
            for (k, value) in values.iter_mut().enumerate() {
                if self.groups.jacobian[first + k] == self.level {
                    action(first + k, value);
                }
            }
        };
        // A particle moves with all its points.
        let levels = Levels::from(self.level);
        self.groups.moving.for_each_run(levels, values, of_run);
    }
}
