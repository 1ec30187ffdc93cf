//! The paper's evaluation: its six experiments and two added ones, its tables as printed, and ours
//! next to them.
//!
//! A [`Replicate`] is one experiment with one seed; a [`RunSet`] has the runs of all variants on
//! it; [`Results`] compares the run sets with the paper's tables.

mod comparison;
mod noise;
mod pinned_results;
mod pinned_scene;
mod published;
mod replicate;
mod results;
mod run_set;
mod scenes;

pub use comparison::{CLEAR, Difference, Finding, Measure, PairedComparison};
pub use noise::{Noise, NoiseLevel};
pub use pinned_results::{PinnedCell, PinnedResults, PinnedRow, PinnedScores, TouchVerdicts};
pub use pinned_scene::{PinnedGroup, PinnedScene};
pub use published::{PUBLISHED, PublishedRow, PublishedTable};
pub use replicate::{Replicate, RunSettings};
pub use results::{
    BaselineComparison, Cell, OcclusionResult, Ratio, Results, ResultsRow, ResultsTable,
};
pub use run_set::RunSet;
pub use scenes::{PaperExperiment, PaperScene};
