//! Calls that may last long: [`long_call`] runs them on threads, ends them at Ctrl-C and shows
//! their progress by a [`Watch`]. [`left_behind`] is for work that cannot be ended.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
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
    let outcome = py.detach(|| {
        let (sender, receiver) = sync_channel(1);
        // the scope ends after the work
        pool.in_place_scope(|scope| {
            scope.spawn(|_| {
                sender
                    .send(catch_unwind(AssertUnwindSafe(|| work(&watch))))
                    .ok();
            });
            let waited = wait(&receiver, || look(&watch, progress.as_ref()));
            watch.interrupted.store(waited.is_err(), Ordering::Relaxed);
            waited
        })
    })?;
    let result = outcome.unwrap_or_else(|panic| resume_unwind(panic));
    let total = watch.total.load(Ordering::Relaxed);
    if let Some(progress) = progress.filter(|_| total > 0) {
        progress.call1(py, (total, total))?;
    }
    Ok(result)
}

/// Runs `work`, which only reads, on a thread of its own. An interrupted call leaves it behind.
pub fn left_behind<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = sync_channel(1);
    // an interrupted call has dropped the receiver
    thread::spawn(move || sender.send(catch_unwind(AssertUnwindSafe(work))).ok());
    let tick = || Python::attach(|py| py.check_signals());
    let outcome = py.detach(move || wait(&receiver, tick))?;
    Ok(outcome.unwrap_or_else(|panic| resume_unwind(panic)))
}

/// Waits for an outcome; `tick` is called meanwhile, and its exception ends the wait.
fn wait<T>(receiver: &Receiver<T>, mut tick: impl FnMut() -> PyResult<()>) -> PyResult<T> {
    loop {
        match receiver.recv_timeout(TICK) {
            Ok(outcome) => return Ok(outcome),
            Err(RecvTimeoutError::Timeout) => tick()?,
            Err(RecvTimeoutError::Disconnected) => unreachable!("the work sends its end"),
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
