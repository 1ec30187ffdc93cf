//! Loops over equal chunks and sums over one fixed tree: the same bits on any number of threads.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

/// Ranges of at most this many leaves are summed by one thread.
const SERIAL_LEAVES: usize = 16;

/// Whether more than one thread can share `tasks` pieces of work.
pub(crate) fn shared(tasks: usize) -> bool {
    tasks > 1 && rayon::current_num_threads() > 1
}

/// Working memory for the threads of a pool, one piece each.
pub(crate) struct PerThread<S> {
    pieces: Vec<Mutex<S>>,
}

impl<S> PerThread<S> {
    /// As many pieces as the current pool has threads.
    pub fn new(make: impl Fn() -> S) -> Self {
        Self { pieces: (0..rayon::current_num_threads()).map(|_| Mutex::new(make())).collect() }
    }

    /// Lends the thread's piece to `body`, which must not wait for other tasks: its thread might take one up that needs the piece.
    pub fn lend<T>(&self, body: impl FnOnce(&mut S) -> T) -> T {
        let worker = rayon::current_thread_index().unwrap_or(0);
        let piece = &self.pieces[worker % self.pieces.len()];
        body(&mut piece.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Runs `body(index, chunk)` over `chunk`-sized pieces of `data` (the last may be short); each thread takes at least `grain` of them.
pub(crate) fn for_each<T: Send>(data: &mut [T], chunk: usize, grain: usize, body: impl Fn(usize, &mut [T]) + Sync) {
    if shared(data.len().div_ceil(chunk).div_ceil(grain)) {
        data.par_chunks_mut(chunk).with_min_len(grain).enumerate().for_each(|(i, c)| body(i, c));
    } else {
        data.chunks_mut(chunk).enumerate().for_each(|(i, c)| body(i, c));
    }
}

/// Runs `body(index, piece of a, piece of b)` over both arrays cut into pieces of the lengths `pieces` (the last may be short).
pub(crate) fn for_each_pair<A: Send, B: Send>(
    a: &mut [A],
    b: &mut [B],
    pieces: [usize; 2],
    body: impl Fn(usize, &mut [A], &mut [B]) + Sync,
) {
    if shared(a.len().div_ceil(pieces[0])) {
        let both = a.par_chunks_mut(pieces[0]).zip(b.par_chunks_mut(pieces[1]));
        both.enumerate().for_each(|(i, (a, b))| body(i, a, b));
    } else {
        let both = a.chunks_mut(pieces[0]).zip(b.chunks_mut(pieces[1]));
        both.enumerate().for_each(|(i, (a, b))| body(i, a, b));
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
