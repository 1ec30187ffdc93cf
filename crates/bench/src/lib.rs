//! What the benchmarks share: scenes, batches of particles, clocks and the file of results.
//!
//! `cargo bench -p stickslip-bench --bench timing_scene` and its neighbours print what they measure
//! and append it to `bench/results/<machine>-<date>.csv`. They measure one thread unless they say
//! otherwise, after a warm-up, medians of several rounds.

mod batch;
mod course;
mod instruction_sets;
mod machine;
mod quantile;
mod results;
mod scenes;
mod tally;

pub use batch::{Batch, BlockOf64, LANES};
pub use course::{Case, Course, Summary, measure};
pub use instruction_sets::instruction_sets;
pub use machine::{date, processor};
pub use quantile::{median, quantile};
pub use results::Results;
pub use scenes::{
    FRAME, FRAMES, MOVING, PHASES, pushed_object, scattered, timing_input, timing_scene,
};
pub use tally::Tally;
