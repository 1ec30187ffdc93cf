//! Threads that help with short parallel loops, without any result that depends on them.
//!
//! ```text
//!  particles, weights
//!        │ for_each, tree_reduce
//!        ▼
//!    parallel ── asks pace:   is help worth asking for at this place?
//!        │
//!        ├────── wakes awake: threads that wait for the filter's loops, asleep or spinning
//!        │
//!        ├─ calling thread ─ items from the front ─┐
//!        │                                         ├─ helpers: who is inside, who was useful,
//!        ├─ other threads ── items from the back ──┘           wait until all are gone
//!        ▼
//!    Help: useful, none or late ── pace and awake learn from it for the next loop
//! ```

pub(crate) mod awake;
mod helpers;
mod pace;
pub(crate) mod parallel;
