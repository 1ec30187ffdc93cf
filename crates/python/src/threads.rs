//! The threads that work runs on: [`Threads`].

use std::num::NonZero;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::available_parallelism;

use pyo3::PyResult;
use pyo3::exceptions::PyRuntimeError;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::refused;

/// Threads that are kept for the next call.
struct Kept {
    /// The process that they run in: a forked process has none of its parent's threads.
    process: u32,
    threads: usize,
    pool: Arc<ThreadPool>,
}

static KEPT: Mutex<Option<Kept>> = Mutex::new(None);

/// A number of threads: as many as are asked for or else one per processor, at most `useful`.
#[derive(Clone, Copy, Debug)]
pub struct Threads {
    pub asked: Option<usize>,
    pub useful: usize,
}

impl Threads {
    /// The pool of these threads, which is kept for the next call.
    pub fn pool(self) -> PyResult<Arc<ThreadPool>> {
        if self.asked == Some(0) {
            return Err(refused(
                "0 threads are asked for; it must be 1 or more, or None for as many as help",
            ));
        }
        let threads = self.asked.unwrap_or_else(processors);
        pool(threads.min(self.useful).max(1))
    }
}

/// Processors of this machine.
pub fn processors() -> usize {
    available_parallelism().map_or(1, NonZero::get)
}

fn pool(threads: usize) -> PyResult<Arc<ThreadPool>> {
    let process = std::process::id();
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    match &*kept {
        Some(kept) if kept.process == process && kept.threads == threads => {
            return Ok(Arc::clone(&kept.pool));
        }
        _ => {}
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = Arc::new(pool.map_err(|error| PyRuntimeError::new_err(error.to_string()))?);
    let before = kept.replace(Kept {
        process,
        threads,
        pool: Arc::clone(&pool),
    });
    // the threads of a parent process cannot be stopped from here
    if let Some(before) = before.filter(|before| before.process != process) {
        std::mem::forget(before);
    }
    Ok(pool)
}
