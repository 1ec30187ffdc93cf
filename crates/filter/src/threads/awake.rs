//! A thread pool that stays awake between short parallel loops: [`keep_threads_awake`].

use std::cell::RefCell;
use std::hint::spin_loop;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use crate::threads::pace::Help;
use crate::threads::parallel::lock;

/// Number of times that a thread looks for work before it sleeps: some 100 to 250 µs. That is
/// longer than a filter mostly takes between two parallel loops, and than it takes to wake a
/// thread.
const LOOKS: u32 = 1 << 12;

/// Sleep after which a thread looks for work once, uncalled. So work that woke no thread does not
/// wait for ever.
const NAP: Duration = Duration::from_millis(20);

/// Runs `body` on the current pool while the pool's other threads wait for the parallel loops of
/// its filter.
///
/// Waking a sleeping thread takes as long as a filter step of some hundred particles. So the
/// threads stay awake for 0.1 to 0.3 ms after a loop that they were a help with, then they sleep
/// until the next. No result depends on this. Other work than a filter's loops finds them only
/// while they are awake or after some 20 ms, so `body` should have the pool to itself and be little
/// else than a filter.
///
/// ```
/// assert_eq!(stickslip_filter::keep_threads_awake(|| 6 * 7), 42);
/// ```
pub fn keep_threads_awake<T: Send>(body: impl FnOnce() -> T + Send) -> T {
    let Some(own_thread) = rayon::current_thread_index() else {
        return rayon::scope(|_| keep_threads_awake(body));
    };
    if rayon::current_num_threads() == 1 || CREW.with_borrow(Option::is_some) {
        return body();
    }
    let crew = Arc::new(Crew::default());
    let job = Arc::clone(&crew);
    rayon::spawn_broadcast(move |worker| {
        // the thread of `body` may take this job while it waits for others at the end of a loop:
        // waiting there until `body` has finished would never end
        if worker.index() != own_thread {
            job.help_until_finished();
        }
    });
    let _calling = Calling::new(crew);
    body()
}

thread_local! {
    /// The threads that wait for the loops of this one.
    static CREW: RefCell<Option<Arc<Crew>>> = const { RefCell::new(None) };
}

/// Wakes up to so many threads that sleep; there is work in the pool for them.
pub(crate) fn call(threads: usize) {
    with_crew(|crew| crew.call(threads));
}

/// Has the threads wait for the next loop awake if they were useful in the last.
pub(crate) fn learn(help: Help) {
    with_crew(|crew| crew.useless.store(help != Help::Useful, Ordering::Relaxed));
}

fn with_crew(body: impl FnOnce(&Crew)) {
    CREW.with_borrow(|crew| crew.as_deref().map(body));
}

/// The threads of a pool that wait for the loops of one of them.
#[derive(Default)]
struct Crew {
    finished: AtomicBool,
    /// True if the threads were no use in the last loop.
    useless: AtomicBool,
    asleep: AtomicUsize,
    /// Number of times that they have been called.
    calls: Mutex<u64>,
    called: Condvar,
}

impl Crew {
    fn call(&self, threads: usize) {
        let asleep = self.asleep.load(Ordering::SeqCst);
        if asleep > 0 {
            *lock(&self.calls) += 1;
            (0..asleep.min(threads)).for_each(|_| self.called.notify_one());
        }
    }

    fn finish(&self) {
        self.finished.store(true, Ordering::SeqCst);
        *lock(&self.calls) += 1;
        self.called.notify_all();
    }

    /// Runs the pool's jobs as they come.
    fn help_until_finished(&self) {
        while !self.finished.load(Ordering::SeqCst) {
            if !self.found_work() {
                self.sleep_until_called();
            }
        }
    }

    /// Looks for a job, once or for a short time, and runs it.
    fn found_work(&self) -> bool {
        for _ in 0..LOOKS {
            if rayon::yield_now() == Some(rayon::Yield::Executed) {
                return true;
            }
            if self.useless.load(Ordering::Relaxed) || self.finished.load(Ordering::Relaxed) {
                return false;
            }
            spin_loop();
        }
        false
    }

    /// A loop that begins while the thread falls asleep does not call it, and does without it.
    fn sleep_until_called(&self) {
        let calls = lock(&self.calls);
        let before = *calls;
        self.asleep.fetch_add(1, Ordering::SeqCst);
        let uncalled = |calls: &mut u64| *calls == before && !self.finished.load(Ordering::SeqCst);
        let called = self.called.wait_timeout_while(calls, NAP, uncalled);
        drop(called.unwrap_or_else(PoisonError::into_inner));
        self.asleep.fetch_sub(1, Ordering::SeqCst);
    }
}

/// While it lives, the loops of this thread call a crew; the crew finishes with it, also by a
/// panic.
struct Calling;

impl Calling {
    fn new(crew: Arc<Crew>) -> Self {
        CREW.set(Some(crew));
        Self
    }
}

impl Drop for Calling {
    fn drop(&mut self) {
        if let Some(crew) = CREW.take() {
            crew.finish();
        }
    }
}
