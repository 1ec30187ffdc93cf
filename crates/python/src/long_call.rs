//! Calls that may last long: [`long_call`] runs them on threads, ends them at Ctrl-C and shows
//! their progress by a [`Watch`].

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::Duration;

use pyo3::prelude::*;

use crate::threads::Threads;

/// Time between two looks at signals and progress.
const TICK: Duration = Duration::from_millis(50);

/// Progress of the work of a call, and whether the call was interrupted.
#[derive(Debug, Default)]
pub struct Watch {
    interrupted: AtomicBool,
    done: AtomicU64,
    total: AtomicU64,
}

/// Payload of the unwinding that ends interrupted work.
struct Interrupted;

impl Watch {
    /// Ends the work, by unwinding, if the call was interrupted.
    pub fn check(&self) {
        if self.interrupted.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Interrupted));
        }
    }

    /// Shows that so much is done of a total, and checks.
    pub fn show(&self, done: u64, total: u64) {
        self.total.store(total, Ordering::Relaxed);
        self.done.store(done, Ordering::Relaxed);
        self.check();
    }

    /// Shows that so much more is done, and checks.
    pub fn add(&self, done: u64) {
        self.done.fetch_add(done, Ordering::Relaxed);
        self.check();
    }
}

/// Runs `work` on threads, without the interpreter's lock. Meanwhile this thread handles signals
/// and calls `progress` with what is done and the total. An exception of either ends the work.
pub fn long_call<T: Send>(
    py: Python<'_>,
    threads: Threads,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&Watch) -> T + Send,
) -> PyResult<T> {
    let pool = threads.pool()?;
    let watch = Watch::default();
    let (outcome, failure) = py.detach(|| {
        let (sender, receiver) = sync_channel(1);
        pool.in_place_scope(|scope| {
            scope.spawn(|_| {
                // the receiver waits for it
                let _ = sender.send(catch_unwind(AssertUnwindSafe(|| work(&watch))));
            });
            let mut failure = None;
            loop {
                match receiver.recv_timeout(TICK) {
                    Ok(outcome) => return (outcome, failure),
                    Err(RecvTimeoutError::Timeout) if failure.is_none() => {
                        failure = look(&watch, progress.as_ref()).err();
                        let interrupted = failure.is_some();
                        watch.interrupted.store(interrupted, Ordering::Relaxed);
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => unreachable!("the work sends its end"),
                }
            }
        })
    });
    match (failure, outcome) {
        (Some(failure), _) => Err(failure),
        (None, Err(panic)) => resume_unwind(panic),
        (None, Ok(result)) => {
            let total = watch.total.load(Ordering::Relaxed);
            if let Some(progress) = progress.filter(|_| total > 0) {
                progress.call1(py, (total, total))?;
            }
            Ok(result)
        }
    }
}

/// Handles signals and shows progress; the exception of one of them.
fn look(watch: &Watch, progress: Option<&Py<PyAny>>) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        let total = watch.total.load(Ordering::Relaxed);
        if let Some(progress) = progress.filter(|_| total > 0) {
            progress.call1(py, (watch.done.load(Ordering::Relaxed), total))?;
        }
        Ok(())
    })
}
