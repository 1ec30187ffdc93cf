//! Progress of a fit: [`Progress`].

use std::sync::atomic::{AtomicU64, Ordering};

/// Takes the number of vectors of parameters that were tried, and of the most that may be. Several
/// threads call it, many times a second. A fit is abandoned by [`std::panic::resume_unwind`] in it.
pub type Listener<'a> = dyn Fn(u64, u64) + Sync + 'a;

/// Number of vectors that a fit has tried.
pub(crate) struct Progress<'a> {
    listener: &'a Listener<'a>,
    tried: AtomicU64,
    most: u64,
}

impl<'a> Progress<'a> {
    /// A fit that tries at most so many vectors.
    pub fn new(listener: &'a Listener<'a>, most: u64) -> Self {
        Self {
            listener,
            tried: AtomicU64::new(0),
            most,
        }
    }

    /// Counts vectors.
    pub fn add(&self, vectors: usize) {
        self.tried.fetch_add(vectors as u64, Ordering::Relaxed);
    }

    /// Calls the listener.
    pub fn show(&self) {
        let tried = self.tried.load(Ordering::Relaxed);
        (self.listener)(tried.min(self.most), self.most);
    }
}
