//! Tools that the benchmarks share: scenes, batches of particles, clocks and the file of results.
//!
//! `cargo bench -p stickslip-bench --bench timing_scene` and its neighbours print their
//! measurements and append them to `bench/results/<machine>-<date>.csv`. They measure one thread
//! unless they say otherwise, after a warm-up, medians of several rounds.

mod batch;
mod instruction_sets;
mod machine;
mod results;
mod scene_timing;
mod scenes;
mod step_statistics;

pub use batch::{Batch, FilterBlock, LANES};
pub use instruction_sets::instruction_sets;
pub use machine::{date, processor};
pub use results::Results;
pub use scene_timing::{SceneTiming, TimedScene, TimingSummary, time_scenes};
pub use scenes::{
    FRAME, FRAMES, MOVING, PHASES, pushed_object, scattered, timing_input, timing_scene,
};
pub use step_statistics::StepStatistics;
