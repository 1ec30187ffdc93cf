//! A thread pool that stays awake between short parallel loops: [`keep_threads_awake`].

use std::hint::spin_loop;
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs `body` on the current pool while the pool's other threads poll for work instead of going to
/// sleep.
///
/// Waking a sleeping thread takes as long as a filter step of some hundred particles. No result
/// depends on this. It keeps all the pool's processors busy for as long as `body` runs, so `body`
/// should have the pool to itself.
///
/// ```
/// assert_eq!(stickslip_filter::keep_threads_awake(|| 6 * 7), 42);
/// ```
pub fn keep_threads_awake<T: Send>(body: impl FnOnce() -> T + Send) -> T {
    let finished = AtomicBool::new(false);
    rayon::scope(|scope| {
        let (own_thread, finished) = (rayon::current_thread_index(), &finished);
        scope.spawn_broadcast(move |_, worker| {
            // the thread of `body` may take this job while it waits for others at the end of a loop:
            // polling there until `body` has finished would never end
            if Some(worker.index()) != own_thread {
                poll_for_work(finished);
            }
        });
        let _finished = SetOnDrop(finished);
        body()
    })
}

/// Runs the pool's jobs as they come, until `finished`.
fn poll_for_work(finished: &AtomicBool) {
    while !finished.load(Ordering::Acquire) {
        if rayon::yield_now() != Some(rayon::Yield::Executed) {
            spin_loop();
        }
    }
}

/// Sets the flag when dropped, also by a panic.
struct SetOnDrop<'a>(&'a AtomicBool);

impl Drop for SetOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}
