//! Loops over particles and points, and reductions whose result does not depend on the number of
//! threads.
//!
//! Every item is computed by one call that reads shared data and writes its own slot, so loops are
//! deterministic by construction; sums and maxima run over a binary tree that depends on the
//! number of items alone. Small problems (the paper's own have hundreds of particles) stay serial.

use std::ops::Range;

use rayon::prelude::*;

/// Items per task.
pub(crate) const CHUNK: usize = 256;

/// Most chunks of a task in loops whose items may take different times, as points that flow and points
/// that do not: left to itself, rayon cuts a loop into twice as many tasks as there are threads.
const CHUNKS_OF_TASK: usize = 2;

/// Most items of a leaf of a reduction.
pub(crate) const LEAF: usize = 2 * CHUNK;

/// Below this many items a loop runs serially: a parallel call costs about as much as a hundred
/// particles.
const SERIAL_BELOW: usize = 2048;

#[inline]
fn serial(items: usize) -> bool {
    items < SERIAL_BELOW || rayon::current_num_threads() == 1
}

/// `out[i] = value(i)` for every i.
pub(crate) fn fill<T: Send>(out: &mut [T], value: impl Fn(usize) -> T + Sync) {
    for_each(out, |i, slot| *slot = value(i));
}

/// Calls `action(i, &mut items[i])` for every i.
pub(crate) fn for_each<T: Send>(items: &mut [T], action: impl Fn(usize, &mut T) + Sync) {
    if serial(items.len()) {
        items
            .iter_mut()
            .enumerate()
            .for_each(|(i, item)| action(i, item));
        return;
    }
    items
        .par_chunks_mut(CHUNK)
        .enumerate()
        .for_each(|(chunk, items)| {
            for (k, item) in items.iter_mut().enumerate() {
                action(chunk * CHUNK + k, item);
            }
        });
}

/// Calls `action(i, &mut first[i], &mut second[i])` for every i; both have the same length.
pub(crate) fn for_each_pair<A: Send, B: Send>(
    first: &mut [A],
    second: &mut [B],
    action: impl Fn(usize, &mut A, &mut B) + Sync,
) {
    debug_assert_eq!(first.len(), second.len());
    if serial(first.len()) {
        for (i, (a, b)) in first.iter_mut().zip(second).enumerate() {
            action(i, a, b);
        }
        return;
    }
    first
        .par_chunks_mut(CHUNK)
        .zip(second.par_chunks_mut(CHUNK))
        .enumerate()
        .for_each(|(chunk, (first, second))| {
            for (k, (a, b)) in first.iter_mut().zip(second).enumerate() {
                action(chunk * CHUNK + k, a, b);
            }
        });
}

/// Calls `action(i, &mut first[i], &mut second[i], &mut third[i])` for every i.
pub(crate) fn for_each_triple<A: Send, B: Send, C: Send>(
    first: &mut [A],
    second: &mut [B],
    third: &mut [C],
    action: impl Fn(usize, &mut A, &mut B, &mut C) + Sync,
) {
    debug_assert!(first.len() == second.len() && second.len() == third.len());
    if serial(first.len()) {
        for (i, ((a, b), c)) in first.iter_mut().zip(second).zip(third).enumerate() {
            action(i, a, b, c);
        }
        return;
    }
    first
        .par_chunks_mut(CHUNK)
        .zip(second.par_chunks_mut(CHUNK))
        .zip(third.par_chunks_mut(CHUNK))
        .enumerate()
        .for_each(|(chunk, ((first, second), third))| {
            for (k, ((a, b), c)) in first.iter_mut().zip(second).zip(third).enumerate() {
                action(chunk * CHUNK + k, a, b, c);
            }
        });
}

/// Calls `action(i, &mut items[i])` for every i of a few items each of which is an array about as long as the
/// simulation has `particles`.
pub(crate) fn for_each_large<T: Send>(
    particles: usize,
    items: &mut [T],
    action: impl Fn(usize, &mut T) + Sync,
) {
    if serial(particles) {
        let items = items.iter_mut().enumerate();
        items.for_each(|(i, item)| action(i, item));
        return;
    }
    let items = items.par_iter_mut().enumerate();
    items.for_each(|(i, item)| action(i, item));
}

/// Calls `action(offset, run)` on runs that together are all items, where `offset` is the index of the
/// first of them. How long they are depends on the threads: for work on single items only.
pub(crate) fn for_each_run<T: Send>(items: &mut [T], action: impl Fn(usize, &mut [T]) + Sync) {
    if serial(items.len()) {
        action(0, items);
        return;
    }
    items
        .par_chunks_mut(CHUNK)
        .enumerate()
        .with_max_len(CHUNKS_OF_TASK)
        .for_each(|(chunk, items)| action(chunk * CHUNK, items));
}

/// Calls `action(offset, first, second, third)` on runs of [`CHUNK`] items of `first` and `second`, the
/// last one shorter, where `offset` is the index of the first of them and `third` has one entry for each
/// `width` items; `width` divides [`CHUNK`].
pub(crate) fn for_each_chunk_of<A: Send, B: Send, C: Send>(
    (first, second): (&mut [A], &mut [B]),
    (third, width): (&mut [C], usize),
    action: impl Fn(usize, &mut [A], &mut [B], &mut [C]) + Sync,
) {
    debug_assert!(first.len() == second.len() && CHUNK.is_multiple_of(width));
    debug_assert_eq!(first.len().div_ceil(width), third.len());
    let entries = CHUNK / width;
    if serial(first.len()) {
        let chunks = first.chunks_mut(CHUNK).zip(second.chunks_mut(CHUNK));
        for (chunk, ((a, b), c)) in chunks.zip(third.chunks_mut(entries)).enumerate() {
            action(chunk * CHUNK, a, b, c);
        }
        return;
    }
    first
        .par_chunks_mut(CHUNK)
        .zip(second.par_chunks_mut(CHUNK))
        .zip(third.par_chunks_mut(entries))
        .enumerate()
        .with_max_len(CHUNKS_OF_TASK)
        .for_each(|(chunk, ((a, b), c))| action(chunk * CHUNK, a, b, c));
}

/// Calls `action(offset, first, second, third)` on runs of [`CHUNK`] items, the last one shorter,
/// where `offset` is the index of the first of them.
pub(crate) fn for_each_chunk<A: Send, B: Send, C: Send>(
    first: &mut [A],
    second: &mut [B],
    third: &mut [C],
    action: impl Fn(usize, &mut [A], &mut [B], &mut [C]) + Sync,
) {
    for_each_chunk_of((first, second), (third, 1), action);
}

/// Calls `action(piece, part)` for the runs of `size` entries of a list, the last one shorter; `work` is the
/// number of items in all.
pub(crate) fn for_each_piece<T: Send>(
    list: &mut [T],
    size: usize,
    work: usize,
    action: impl Fn(usize, &mut [T]) + Sync,
) {
    if serial(work) {
        for (piece, part) in list.chunks_mut(size).enumerate() {
            action(piece, part);
        }
        return;
    }
    list.par_chunks_mut(size)
        .enumerate()
        .with_max_len(CHUNKS_OF_TASK)
        .for_each(|(piece, part)| action(piece, part));
}

/// Calls `action(first, a, b, c, page)` on runs of `range` each of which lies in one page of [`CHUNK`]
/// items, where `first` is the index of the first of them. The arrays have all items.
pub(crate) fn for_each_page<A: Send, B: Send, C: Send, P: Send>(
    range: Range<usize>,
    (a, b, c): (&mut [A], &mut [B], &mut [C]),
    pages: &mut [P],
    action: impl Fn(usize, &mut [A], &mut [B], &mut [C], &mut P) + Sync,
) {
    // Up to where a page begins, then from page to page.
    let aligned = range.start.next_multiple_of(CHUNK).min(range.end);
    let head = range.start..aligned;
    if !head.is_empty() {
        let page = &mut pages[head.start / CHUNK];
        let (a, b, c) = (&mut a[head.clone()], &mut b[head.clone()], &mut c[head]);
        action(range.start, a, b, c, page);
    }
    if aligned == range.end {
        return;
    }
    let rest = aligned..range.end;
    let pages = &mut pages[aligned / CHUNK..];
    let (a, b, c) = (
        &mut a[rest.clone()],
        &mut b[rest.clone()],
        &mut c[rest.clone()],
    );
    if serial(rest.len()) {
        let runs = a.chunks_mut(CHUNK).zip(b.chunks_mut(CHUNK));
        for (k, (((a, b), c), page)) in runs.zip(c.chunks_mut(CHUNK)).zip(pages).enumerate() {
            action(aligned + k * CHUNK, a, b, c, page);
        }
        return;
    }
    a.par_chunks_mut(CHUNK)
        .zip(b.par_chunks_mut(CHUNK))
        .zip(c.par_chunks_mut(CHUNK))
        .zip(pages)
        .enumerate()
        .for_each(|(k, (((a, b), c), page))| action(aligned + k * CHUNK, a, b, c, page));
}

/// Folds `leaf(range)` over 0..items with `join`, in a fixed binary tree.
pub(crate) fn reduce<T: Send>(
    items: usize,
    leaf: &(impl Fn(std::ops::Range<usize>) -> T + Sync),
    join: &(impl Fn(T, T) -> T + Sync),
) -> T {
    fn tree<T: Send>(
        range: std::ops::Range<usize>,
        parallel: bool,
        leaf: &(impl Fn(std::ops::Range<usize>) -> T + Sync),
        join: &(impl Fn(T, T) -> T + Sync),
    ) -> T {
        if range.len() <= LEAF {
            return leaf(range);
        }
        let middle = range.start + range.len() / 2;
        let (low, high) = (range.start..middle, middle..range.end);
        if parallel {
            let (a, b) = rayon::join(
                || tree(low, parallel, leaf, join),
                || tree(high, parallel, leaf, join),
            );
            join(a, b)
        } else {
            let a = tree(low, parallel, leaf, join);
            let b = tree(high, parallel, leaf, join);
            join(a, b)
        }
    }
    tree(0..items, !serial(items), leaf, join)
}

/// Sum of `value(i)` over 0..items, in a fixed binary tree.
pub(crate) fn sum<T>(items: usize, zero: T, value: impl Fn(usize) -> T + Sync) -> T
where
    T: Copy + Send + Sync + std::ops::Add<Output = T>,
{
    reduce(
        items,
        &|range| range.fold(zero, |sum, i| sum + value(i)),
        &|a, b| a + b,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn in_pool<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
            .install(work)
    }

    #[test]
    fn sums_have_the_same_bits_for_any_number_of_threads() {
        let value = |i: usize| (i as f64 * 0.7).sin() * 10f64.powi(i as i32 % 7);
        let serial = in_pool(1, || sum(10_007, 0.0, value));
        for threads in [2, 3, 7] {
            let parallel = in_pool(threads, || sum(10_007, 0.0, value));
            assert_eq!(serial.to_bits(), parallel.to_bits(), "{threads} threads");
        }
    }

    #[test]
    fn every_slot_is_visited_once_with_its_own_index() {
        for threads in [1, 3] {
            let mut a = vec![0usize; 5001];
            let (mut b, mut c) = (a.clone(), a.clone());
            let mut pages = vec![0usize; 5001_usize.div_ceil(CHUNK)];
            // Pages are whole, cut at either end, or cut at both.
            let ranges = [0..300, 300..300, 300..310, 310..512, 512..4900, 4900..5001];
            in_pool(threads, || {
                for range in ranges {
                    let arrays = (&mut a[..], &mut b[..], &mut c[..]);
                    for_each_page(range, arrays, &mut pages, |first, a, b, c, page| {
                        *page += a.len();
                        for (k, ((a, b), c)) in a.iter_mut().zip(b).zip(c).enumerate() {
                            *a += first + k;
                            *b += 1;
                            *c += first / CHUNK;
                        }
                    });
                }
            });
            assert!(a.iter().enumerate().all(|(i, v)| *v == i));
            assert!(b.iter().all(|v| *v == 1));
            assert!(c.iter().enumerate().all(|(i, v)| *v == i / CHUNK));
            assert!(pages[..pages.len() - 1].iter().all(|v| *v == CHUNK));
            assert_eq!(pages.iter().sum::<usize>(), 5001);
        }
    }
}
