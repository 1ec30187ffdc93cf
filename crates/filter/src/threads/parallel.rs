//! Parallel loops, and reductions over a fixed tree: the same bits on any number of threads.
//!
//! A loop is done by the thread that calls it; others help where they have time. Whoever is free
//! takes the next piece, so that a thread which the system does not run delays the loop by the
//! piece in its hands and by nothing else. The calling thread waits awake for about as long as a
//! piece takes, then it sleeps. When it asks for help at all is [`pace`]'s affair.

use std::ops::Range;
use std::panic::Location;
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use crate::threads::awake;
use crate::threads::helpers::Helpers;
use crate::threads::pace;

/// Ranges of at most this many leaves are reduced by one thread.
const SERIAL_LEAVES: usize = 16;

/// Working memory for the pieces of a loop that are in hand at the same time.
pub(crate) struct PerThread<S> {
    slots: Vec<Mutex<S>>,
}

impl<S> PerThread<S> {
    /// For loops of so many `pieces` on the current pool.
    pub fn new(pieces: usize, make: impl Fn() -> S) -> Self {
        let slots = 0..rayon::current_num_threads().min(pieces).max(1);
        Self {
            slots: slots.map(|_| Mutex::new(make())).collect(),
        }
    }

    /// Runs `body` with a slot that is free, mostly always the same for a thread. `body` must not
    /// block on rayon: the thread could steal a task that waits for the same slot (deadlock).
    pub fn with<T>(&self, body: impl FnOnce(&mut S) -> T) -> T {
        let (before, from) = self.slots.split_at(own_slot(self.slots.len()));
        let free = from.iter().chain(before).find_map(try_lock);
        // on a larger pool than that of `new` there may be none
        body(&mut free.unwrap_or_else(|| lock(&self.slots[own_slot(self.slots.len())])))
    }
}

impl<S: Clone> Clone for PerThread<S> {
    fn clone(&self) -> Self {
        let slots = self.slots.iter().map(|slot| Mutex::new(lock(slot).clone()));
        Self {
            slots: slots.collect(),
        }
    }
}

/// Slot that the calling thread tries first.
fn own_slot(slots: usize) -> usize {
    rayon::current_thread_index().unwrap_or(0) % slots
}

/// Runs `body` on all items. The threads take them one by one, the calling thread from the front
/// and the others from the back, so that in the next loop a thread mostly gets the items that are
/// still in its cache.
#[track_caller]
pub(crate) fn for_each<I>(
    items: impl ExactSizeIterator<Item = I> + DoubleEndedIterator + Send,
    body: impl Fn(I) + Sync,
) {
    let count = items.len();
    let helping_threads = count.min(rayon::current_num_threads()).saturating_sub(1);
    let place = Location::caller();
    if helping_threads == 0 || !pace::asks_for_help(place, count) {
        return items.for_each(body);
    }
    let (items, helpers) = (Mutex::new(items), Helpers::default());
    let own_work = || {
        awake::call(helping_threads);
        loop {
            let item = lock(&items).next();
            helpers.caller_goes_on();
            match item {
                Some(item) => body(item),
                None => break,
            }
        }
        helpers.wait_until_gone();
    };
    let help = || {
        let _inside = helpers.enter();
        loop {
            let item = lock(&items).next_back();
            match item {
                Some(item) => helpers.beside_caller(|| body(item)),
                None => break,
            }
        }
    };
    with_help(helping_threads, &own_work, &help);
    let brought = helpers.brought();
    awake::learn(brought);
    pace::learn(place, count, brought);
}

/// Calls `own_work`, and with it `help` so many times, each on another thread if one is free.
fn with_help(times: usize, own_work: &(impl Fn() + Sync), help: &(impl Fn() + Sync)) {
    if times == 0 {
        return own_work();
    }
    rayon::join(|| with_help(times - 1, own_work, help), help);
}

pub(crate) fn lock<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}

fn try_lock<T>(value: &Mutex<T>) -> Option<MutexGuard<'_, T>> {
    match value.try_lock() {
        Ok(guard) => Some(guard),
        Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
        Err(TryLockError::WouldBlock) => None,
    }
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
    if range.len() > SERIAL_LEAVES && rayon::current_num_threads() > 1 {
        let (a, b) = rayon::join(left, right);
        combine(a, b)
    } else {
        combine(left(), right())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Duration;

    use super::*;
    use crate::keep_threads_awake;

    /// Number of times that `body` is run on each item of many loops on three threads.
    fn times_run(body: impl Fn(usize) + Sync) -> Vec<usize> {
        let times: Vec<AtomicUsize> = (0..10).map(|_| AtomicUsize::new(0)).collect();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
        pool.unwrap().install(|| {
            keep_threads_awake(|| {
                for _ in 0..200 {
                    for_each(0..times.len(), |item| {
                        times[item].fetch_add(1, Ordering::Relaxed);
                        body(item);
                    });
                }
            })
        });
        times.into_iter().map(AtomicUsize::into_inner).collect()
    }

    #[test]
    fn for_each_runs_every_item_once() {
        assert_eq!(times_run(|_| ()), [200; 10]);
    }

    #[test]
    fn for_each_waits_for_a_thread_that_is_late() {
        let done = AtomicUsize::new(0);
        let caller = Mutex::new(None);
        let late = |_| {
            // the first item is the calling thread's
            let here = rayon::current_thread_index();
            if *lock(&caller).get_or_insert(here) != here {
                std::thread::sleep(Duration::from_millis(3));
            }
            done.fetch_add(1, Ordering::Relaxed);
        };
        assert_eq!(times_run(late), [200; 10]);
        assert_eq!(done.into_inner(), 2000);
    }

    #[test]
    fn for_each_passes_on_a_panic_of_any_item() {
        for bad in [0, 9] {
            let run = || times_run(|item| assert_ne!(item, bad, "on purpose"));
            assert!(std::panic::catch_unwind(run).is_err());
        }
    }

    #[test]
    fn with_gives_slots_that_nobody_else_has() {
        let slots = PerThread::new(3, || 0);
        slots.with(|outer| {
            *outer += 1;
            assert_eq!(slots.slots.len(), rayon::current_num_threads().min(3));
            if slots.slots.len() > 1 {
                assert_eq!(slots.with(|inner| *inner), 0);
            }
        });
    }
}
