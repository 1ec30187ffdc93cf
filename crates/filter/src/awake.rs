//! A pool of threads that stays awake between short parallel loops: [`keep_threads_awake`].

use std::hint::spin_loop;
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs `body` on the current pool while the pool's other threads look for work without ever going
/// to sleep.
///
/// A filter step of some hundred particles is over in the time that a sleeping thread takes to wake
/// up. No result depends on it; it costs the pool's processors for as long as `body` runs, which
/// should therefore have the pool to itself.
///
/// ```
/// assert_eq!(stickslip_filter::keep_threads_awake(|| 6 * 7), 42);
/// ```
pub fn keep_threads_awake<T: Send>(body: impl FnOnce() -> T + Send) -> T {
    let over = AtomicBool::new(false);
    rayon::scope(|scope| {
        let (home, over) = (rayon::current_thread_index(), &over);
        scope.spawn_broadcast(move |_, worker| {
            // the thread of the body may look for work in one of the body's loops: it must come
            // back to it
            if Some(worker.index()) != home {
                attend(over);
            }
        });
        let _end = End(over);
        body()
    })
}

/// Does the pool's work as it comes, until all is over.
fn attend(over: &AtomicBool) {
    while !over.load(Ordering::Acquire) {
        if rayon::yield_now() != Some(rayon::Yield::Executed) {
            spin_loop();
        }
    }
}

/// Says that all is over when dropped, so that a panic says so too.
struct End<'a>(&'a AtomicBool);

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}
