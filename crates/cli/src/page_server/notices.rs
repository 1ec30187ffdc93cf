//! Messages to the pages that are open: [`Notices`].

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Least time between two rows that are shown: 30 a second are seen.
const PERIOD: Duration = Duration::from_millis(33);

/// Time between checks of a page to which nothing is sent: it may be gone.
const LOOK: Duration = Duration::from_secs(1);

/// The newest message to all pages.
#[derive(Default)]
pub struct Notices {
    newest: Mutex<Newest>,
    changed: Condvar,
}

/// The newest message, its number, and when it came.
#[derive(Default)]
struct Newest {
    number: u64,
    text: Arc<str>,
    came: Option<Instant>,
}

impl Notices {
    /// Returns true if a message should be shown now: the last one was some time ago. It is shown
    /// without a page, too, so that one that is opened while the source is silent has something to
    /// show.
    pub fn wants(&self) -> bool {
        let came = lock(&self.newest).came;
        came.is_none_or(|came| came.elapsed() >= PERIOD)
    }

    /// Shows a message to all pages that are open; those that are busy drop the one before.
    pub fn show(&self, text: String) {
        let mut newest = lock(&self.newest);
        newest.number += 1;
        newest.text = text.into();
        newest.came = Some(Instant::now());
        self.changed.notify_all();
    }

    /// The newest message once it is another than that of number `seen`, or after a while; its
    /// number, and its age.
    pub fn after(&self, seen: u64) -> (u64, Arc<str>, Duration) {
        let waited = self
            .changed
            .wait_timeout_while(lock(&self.newest), LOOK, |newest| newest.number == seen);
        let (newest, _) = waited.unwrap_or_else(PoisonError::into_inner);
        let age = newest.came.map_or(Duration::ZERO, |came| came.elapsed());
        (newest.number, newest.text.clone(), age)
    }
}

/// Locks what no panic leaves half done.
pub fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}
