//! Which points and particles make several steps within one step of the others.

use std::ops::Range;

use jstsph_tensor::lanes::TILE;

use crate::parallel;
use crate::reference::BodyReference;

/// A set of whole tiles of the points or particles of a body.
#[derive(Clone, Debug)]
pub(crate) struct Tiles {
    chosen: Vec<bool>,
    items: usize,
}

impl Tiles {
    fn new(items: usize) -> Self {
        Self {
            chosen: vec![false; items.div_ceil(TILE)],
            items,
        }
    }

    fn add(&mut self, item: usize) {
        self.chosen[item / TILE] = true;
    }

    #[inline]
    pub(crate) fn contains(&self, item: usize) -> bool {
        self.chosen[item / TILE]
    }

    /// Number of items in the set.
    pub(crate) fn count(&self) -> usize {
        let tiles = self
            .chosen
            .iter()
            .enumerate()
            .filter(|(_, chosen)| **chosen);
        tiles
            .map(|(tile, _)| TILE.min(self.items - tile * TILE))
            .sum()
    }

    /// The items of `within` that are in the set (or are not, when `inside` is false) as runs of
    /// neighbours; `within` begins with a tile.
    pub(crate) fn runs(
        &self,
        within: Range<usize>,
        inside: bool,
    ) -> impl Iterator<Item = Range<usize>> + '_ {
        debug_assert_eq!(within.start % TILE, 0);
        let last = within.end.div_ceil(TILE);
        let mut tile = within.start / TILE;
        std::iter::from_fn(move || {
            while tile < last && self.chosen[tile] != inside {
                tile += 1;
            }
            if tile == last {
                return None;
            }
            let first = tile;
            while tile < last && self.chosen[tile] == inside {
                tile += 1;
            }
            Some(first * TILE..(tile * TILE).min(within.end))
        })
    }

    /// Calls `action(first, run)` for runs of those of `values` that are in the set (or are not).
    pub(crate) fn for_each_run<T: Send>(
        &self,
        inside: bool,
        values: &mut [T],
        action: impl Fn(usize, &mut [T]) + Sync,
    ) {
        parallel::for_each_run(values, |offset, values| {
            for run in self.runs(offset..offset + values.len(), inside) {
                action(run.start, &mut values[run.start - offset..run.end - offset]);
            }
        });
    }

    /// The same with three arrays.
    pub(crate) fn for_each_chunk<A: Send, B: Send, C: Send>(
        &self,
        inside: bool,
        (first, second, third): (&mut [A], &mut [B], &mut [C]),
        action: impl Fn(usize, &mut [A], &mut [B], &mut [C]) + Sync,
    ) {
        parallel::for_each_chunk(first, second, third, |offset, first, second, third| {
            for run in self.runs(offset..offset + first.len(), inside) {
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

/// The groups of one body; indices are those of the body.
///
/// *Fine* points make sub-steps: those of whole tiles, so that all loops run over runs of neighbours.
/// J of a particle is fine when all its points are. Particles that a fine point sees move in
/// sub-steps: whole tiles again.
#[derive(Clone, Debug)]
pub(crate) struct Groups {
    pub(crate) fine: Tiles,
    pub(crate) moving: Tiles,
    pub(crate) fine_jacobian: Vec<bool>,
}

impl Groups {
    /// Nothing is fine.
    pub(crate) fn new(body: &BodyReference) -> Self {
        Self {
            fine: Tiles::new(body.points.len()),
            moving: Tiles::new(body.particles.len()),
            fine_jacobian: vec![false; body.particles.len()],
        }
    }

    /// Makes the tiles fine that hold a point of a particle one of whose points is `critical`.
    pub(crate) fn choose(&mut self, body: &BodyReference, critical: impl Fn(usize) -> bool) {
        self.fine.chosen.fill(false);
        for a in 0..body.particles.len() {
            let (points, _) = body.shares.of(a);
            if points.iter().any(|q| critical(*q as usize)) {
                points.iter().for_each(|q| self.fine.add(*q as usize));
            }
        }
        self.complete(body);
    }

    /// What follows from the fine points.
    fn complete(&mut self, body: &BodyReference) {
        self.moving.chosen.fill(false);
        for q in self.fine.runs(0..body.points.len(), true).flatten() {
            let row = body.gradient.row(q);
            row.indices().for_each(|a| self.moving.add(a));
        }
        for (a, fine) in self.fine_jacobian.iter_mut().enumerate() {
            let (points, _) = body.shares.of(a);
            *fine = points.iter().all(|q| self.fine.contains(*q as usize));
        }
    }

    /// One number per tile of points, for restart files.
    pub(crate) fn saved(&self) -> impl Iterator<Item = f64> + '_ {
        self.fine.chosen.iter().map(|chosen| f64::from(*chosen))
    }

    /// Length of [`saved`](Self::saved).
    pub(crate) fn tiles(&self) -> usize {
        self.fine.chosen.len()
    }

    pub(crate) fn restore(&mut self, body: &BodyReference, saved: &[f64]) {
        for (chosen, saved) in self.fine.chosen.iter_mut().zip(saved) {
            *chosen = *saved != 0.0;
        }
        self.complete(body);
    }
}

/// The fine or the other points and particles of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part<'a> {
    pub(crate) groups: &'a Groups,
    pub(crate) fine: bool,
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
                if self.groups.fine_jacobian[first + k] == self.fine {
                    action(first + k, value);
                }
            }
        };
        if self.fine {
            // A particle with fine points moves in sub-steps.
            self.groups.moving.for_each_run(true, values, of_run);
        } else {
            parallel::for_each_run(values, of_run);
        }
    }
}
