//! Experiments behind the tables of the documentation, each with a program in `src/bin/`. Only
//! these programs, tests and benchmarks use this crate.
//!
//! - [`CalibrationRun`]: coverage of the filter's intervals, for truths drawn from the prior.
//! - [`Ingredient`]: the robust model without one of its parts.
//! - [`Agreement`]: few particles against very many.
//! - [`ClosedLoop`]: random scenes that the particle filter follows, every step judged.
//! - [`recorded_cases`]: recorded experiments, and how they are run.
//! - [`harvest`]: every step of such a run, judged; [`survey_steps`]: a sample of them as hard
//!   problems.
//! - [`PoseNoise`], [`PolygonCone`]: two methods that the paper argues against.

mod calibration;
mod closed_loop;
mod harvest;
mod ingredient;
mod recorded_case;
mod reference;
mod rivals;

pub use calibration::{
    CalibrationOptions, CalibrationRun, Observed, Placed, QUANTITIES, RankTally, Tally, TruthSource,
};
pub use closed_loop::{
    ClosedLoop, Existence, LoopTally, NotedStep, NotedSteps, PusherPoses, SceneKind, SceneRun,
    StepAddress,
};
pub use harvest::{Harvest, HarvestOptions, HarvestedStep, MOST_PARTICLES, harvest, survey_steps};
pub use ingredient::Ingredient;
pub use recorded_case::{RecordedCase, RecordedError, recorded_cases};
pub use reference::Agreement;
pub use rivals::{
    ConeRollout, Lcp, LemkeEnd, OverlapCount, PolygonCone, PolygonStep, PoseNoise, PoseNoiseRun,
};
