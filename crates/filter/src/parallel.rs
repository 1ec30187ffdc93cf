//! Parallel loops, and reductions over a fixed tree: the same bits on any number of threads.

use std::hint::spin_loop;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Ranges of at most this many leaves are reduced by one thread.
const SERIAL_LEAVES: usize = 16;

/// How often a thread without work checks whether the others are done before it returns to the
/// pool, which may put it to sleep.
const SPINS: u32 = 1 << 13;

/// Whether `tasks` would run on more than one thread.
fn is_parallel(tasks: usize) -> bool {
    tasks > 1 && rayon::current_num_threads() > 1
}

/// Working memory of every thread of a pool.
pub(crate) struct PerThread<S> {
    slots: Vec<Mutex<S>>,
}

impl<S> PerThread<S> {
    /// One slot for every thread of the current pool.
    pub fn new(make: impl Fn() -> S) -> Self {
        let threads = 0..rayon::current_num_threads();
        Self {
            slots: threads.map(|_| Mutex::new(make())).collect(),
        }
    }

    /// Runs `body` with the thread's slot. `body` must not block on rayon: the thread could steal a
    /// task that locks the same slot (deadlock).
    pub fn with<T>(&self, body: impl FnOnce(&mut S) -> T) -> T {
        let worker = rayon::current_thread_index().unwrap_or(0);
        body(&mut lock(&self.slots[worker % self.slots.len()]))
    }
}

/// Runs `body` on all items. The threads take them one by one, the calling thread from the front
/// and the others from the back, so that in the next loop a thread mostly gets the items that are
/// still in its cache.
pub(crate) fn for_each<I>(
    items: impl ExactSizeIterator<Item = I> + DoubleEndedIterator + Send,
    body: impl Fn(I) + Sync,
) {
    let count = items.len();
    if !is_parallel(count) {
        return items.for_each(body);
    }
    let (items, left) = (Mutex::new(items), AtomicUsize::new(count));
    let next = |end| {
        let mut items = lock(&items);
        match end {
            End::Front => items.next(),
            End::Back => items.next_back(),
        }
    };
    let work = |end| {
        while let Some(item) = next(end) {
            body(item);
            left.fetch_sub(1, Ordering::Release);
        }
        spin_until_none(&left);
    };
    on_threads(count.min(rayon::current_num_threads()), End::Front, &work);
}

/// From where a thread takes its items.
#[derive(Clone, Copy)]
enum End {
    Front,
    Back,
}

/// Calls `work` so many times, each on another thread if one is free; the first call, on the calling
/// thread, with `end`.
fn on_threads(times: usize, end: End, work: &(impl Fn(End) + Sync)) {
    if times < 2 {
        return work(end);
    }
    rayon::join(
        || on_threads(times / 2, end, work),
        || on_threads(times - times / 2, End::Back, work),
    );
}

/// Spins for a limited time until nothing is left: waking a thread that the pool has put to sleep
/// takes longer than a filter step of some hundred particles.
fn spin_until_none(left: &AtomicUsize) {
    for _ in 0..SPINS {
        if left.load(Ordering::Acquire) == 0 {
            return;
        }
        spin_loop();
    }
}

fn lock<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}

/// `leaf(start)` combined with ... combined with `leaf(end - 1)` over the balanced binary tree of
/// the range, which must not be empty.
///
/// The tree is a function of the range alone, and nothing is allocated.
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
    let left = || tree_reduce(range.start..middle, leaf, combine);
    let right = || tree_reduce(middle..range.end, leaf, combine);
    if range.len() > SERIAL_LEAVES && is_parallel(2) {
        let (a, b) = rayon::join(left, right);
        combine(a, b)
    } else {
        combine(left(), right())
    }
}
