//! The threads that work on a loop together with the one that called it: [`Helpers`].

use std::hint::spin_loop;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Duration;

use crate::threads::pace::Help;
use crate::threads::parallel::lock;

/// Number of times that the calling thread checks whether the others are done before it sleeps:
/// some 100 to 250 µs. That is longer than the last piece of a loop mostly takes, and than it takes
/// to wake a thread.
const LOOKS: u32 = 1 << 12;

/// Number of times that it waits on after the last has left the loop: the thread still has to
/// report to the pool, and a thread that waits there yields its processor.
const FAREWELL: u32 = 8;

/// A helping thread that keeps the calling one waiting for longer was not run by the system (s):
/// pieces take tens of microseconds, a time slice takes milliseconds.
const LATE: Duration = Duration::from_millis(1);

/// The helping threads of one loop.
#[derive(Default)]
pub(crate) struct Helpers {
    inside: AtomicUsize,
    /// Pieces that the calling thread has taken.
    taken_by_caller: AtomicUsize,
    useful: AtomicBool,
    late: AtomicBool,
    /// True if the calling thread sleeps until the others are gone.
    caller_asleep: Mutex<bool>,
    all_gone: Condvar,
}

impl Helpers {
    /// Comes in to help, until the value is dropped.
    pub fn enter(&self) -> impl Drop {
        self.inside.fetch_add(1, Ordering::SeqCst);
        Inside(self)
    }

    /// The calling thread takes a piece, or finds that there is none.
    pub fn caller_goes_on(&self) {
        self.taken_by_caller.fetch_add(1, Ordering::Relaxed);
    }

    /// A helping thread does a piece; that is useful if the calling thread goes on meanwhile.
    pub fn beside_caller(&self, piece: impl FnOnce()) {
        let before = self.taken_by_caller.load(Ordering::Relaxed);
        piece();
        if self.taken_by_caller.load(Ordering::Relaxed) != before {
            self.useful.store(true, Ordering::Relaxed);
        }
    }

    /// The calling thread, once no piece is left, waits until those in hand are done.
    pub fn wait_until_gone(&self) {
        for _ in 0..LOOKS {
            if self.inside.load(Ordering::Acquire) == 0 {
                return (0..FAREWELL).for_each(|_| spin_loop());
            }
            spin_loop();
        }
        let mut asleep = lock(&self.caller_asleep);
        *asleep = true;
        let inside = |_: &mut bool| self.inside.load(Ordering::Acquire) > 0;
        let waited = self.all_gone.wait_timeout_while(asleep, LATE, inside);
        let (asleep, waited) = waited.unwrap_or_else(PoisonError::into_inner);
        if waited.timed_out() {
            self.late.store(true, Ordering::Relaxed);
            drop(self.all_gone.wait_while(asleep, inside));
        }
    }

    /// Help that they brought to the loop, now that it is over.
    pub fn brought(&self) -> Help {
        if self.late.load(Ordering::Relaxed) {
            Help::Late
        } else if self.useful.load(Ordering::Relaxed) {
            Help::Useful
        } else {
            Help::None
        }
    }
}

/// One thread that helps.
struct Inside<'a>(&'a Helpers);

impl Drop for Inside<'_> {
    fn drop(&mut self) {
        let was_last = self.0.inside.fetch_sub(1, Ordering::SeqCst) == 1;
        if was_last && *lock(&self.0.caller_asleep) {
            self.0.all_gone.notify_one();
        }
    }
}
