//! Loops over many items and sums over one fixed tree: the same bits on any number of threads.

use std::hint::spin_loop;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Ranges of at most this many leaves are summed by one thread.
const SERIAL_LEAVES: usize = 16;

/// Times that a thread looks whether the others are done before it lets the pool decide what it
/// does.
const SPINS: u32 = 1 << 13;

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
        Self {
            pieces: (0..rayon::current_num_threads())
                .map(|_| Mutex::new(make()))
                .collect(),
        }
    }

    /// Lends the thread's piece to `body`, which must not wait for other tasks: its thread might
    /// take one up that needs the piece.
    pub fn lend<T>(&self, body: impl FnOnce(&mut S) -> T) -> T {
        let worker = rayon::current_thread_index().unwrap_or(0);
        let piece = &self.pieces[worker % self.pieces.len()];
        body(&mut locked(piece))
    }
}

/// Runs `body` on all items, which the threads take one after the other, from both ends: in the
/// next loop a thread mostly finds those again that it has in its cache.
pub(crate) fn for_all<I>(
    items: impl ExactSizeIterator<Item = I> + DoubleEndedIterator + Send,
    body: impl Fn(I) + Sync,
) {
    let count = items.len();
    if !shared(count) {
        return items.for_each(body);
    }
    let (items, left) = (Mutex::new(items), AtomicUsize::new(count));
    let next = |end| {
        let mut items = locked(&items);
        if end == End::Front {
            items.next()
        } else {
            items.next_back()
        }
    };
    on_threads(
        count.min(rayon::current_num_threads()),
        End::Front,
        &|end| {
            while let Some(item) = next(end) {
                body(item);
                left.fetch_sub(1, Ordering::Release);
            }
            wait_shortly(&left);
        },
    );
}

/// Where a thread takes its items.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    Front,
    Back,
}

/// Calls `work` so many times, on as many threads as have nothing else to do; the calling thread's
/// end is `end`.
fn on_threads(times: usize, end: End, work: &(impl Fn(End) + Sync)) {
    if times < 2 {
        return work(end);
    }
    rayon::join(
        || on_threads(times / 2, end, work),
        || on_threads(times - times / 2, End::Back, work),
    );
}

/// Waits until nothing is left, if that is soon: a thread that the pool sends to sleep meanwhile
/// takes longer to wake up than a filter step of some hundred particles.
fn wait_shortly(left: &AtomicUsize) {
    for _ in 0..SPINS {
        if left.load(Ordering::Acquire) == 0 {
            return;
        }
        spin_loop();
    }
}

fn locked<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}

/// `leaf(start)` combined with ... combined with `leaf(end - 1)` over the balanced binary tree of
/// the range.
///
/// The tree is a function of the range alone, and nothing is allocated. The range must not be
/// empty.
pub(crate) fn tree_reduce<A: Send>(
    range: Range<usize>,
    leaf: &(impl Fn(usize) -> A + Sync),
    combine: &(impl Fn(A, A) -> A + Sync),
) -> A {
    assert!(!range.is_empty(), "nothing to reduce");
    if range.len() == 1 {
        return leaf(range.start);
    }
    let middle = range.start + range.len() / 2;
    let (left, right) = (range.start..middle, middle..range.end);
    if range.len() > SERIAL_LEAVES && shared(2) {
        let (a, b) = rayon::join(
            || tree_reduce(left, leaf, combine),
            || tree_reduce(right, leaf, combine),
        );
        combine(a, b)
    } else {
        combine(
            tree_reduce(left, leaf, combine),
            tree_reduce(right, leaf, combine),
        )
    }
}
