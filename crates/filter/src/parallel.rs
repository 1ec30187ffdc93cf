//! Loops over equal chunks and sums over one fixed tree: the same bits on any number of threads.

use std::ops::Range;

use rayon::prelude::*;

/// Ranges of at most this many leaves are summed by one thread.
const SERIAL_LEAVES: usize = 16;

/// Whether more than one thread can share `tasks` pieces of work.
pub(crate) fn shared(tasks: usize) -> bool {
    tasks > 1 && rayon::current_num_threads() > 1
}

/// Runs `body(index, chunk, item)` over `chunk`-sized pieces of `data` (the last may be short), each with its item.
pub(crate) fn for_each_chunk<T: Send, E: Send>(
    data: &mut [T],
    chunk: usize,
    items: &mut [E],
    body: impl Fn(usize, &mut [T], &mut E) + Sync,
) {
    assert_eq!(data.len().div_ceil(chunk), items.len());
    if shared(items.len()) {
        data.par_chunks_mut(chunk).zip(items).enumerate().for_each(|(i, (c, e))| body(i, c, e));
    } else {
        data.chunks_mut(chunk).zip(items).enumerate().for_each(|(i, (c, e))| body(i, c, e));
    }
}

/// Runs `body(index, chunk)` over `chunk`-sized pieces of `data`; each thread takes at least `grain` of them.
pub(crate) fn for_each<T: Send>(data: &mut [T], chunk: usize, grain: usize, body: impl Fn(usize, &mut [T]) + Sync) {
    if shared(data.len().div_ceil(chunk).div_ceil(grain)) {
        data.par_chunks_mut(chunk).with_min_len(grain).enumerate().for_each(|(i, c)| body(i, c));
    } else {
        data.chunks_mut(chunk).enumerate().for_each(|(i, c)| body(i, c));
    }
}

/// `leaf(start)` combined with ... combined with `leaf(end - 1)` over the balanced binary tree of the range.
///
/// The tree is a function of the range alone, and nothing is allocated. The range must not be empty.
pub(crate) fn tree_reduce<A: Send>(range: Range<usize>, leaf: &(impl Fn(usize) -> A + Sync), combine: &(impl Fn(A, A) -> A + Sync)) -> A {
    assert!(!range.is_empty(), "nothing to reduce");
    if range.len() == 1 {
        return leaf(range.start);
    }
    let middle = range.start + range.len() / 2;
    let (left, right) = (range.start..middle, middle..range.end);
    if range.len() > SERIAL_LEAVES && shared(2) {
        let (a, b) = rayon::join(|| tree_reduce(left, leaf, combine), || tree_reduce(right, leaf, combine));
        combine(a, b)
    } else {
        combine(tree_reduce(left, leaf, combine), tree_reduce(right, leaf, combine))
    }
}
