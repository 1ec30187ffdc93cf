//! Arguments of `stickslip live`: [`LiveArgs`].

use std::path::PathBuf;

use clap::Args;
use stickslip::TactileUse;

use crate::arg_values::{ThreadArgs, particles, positive};
use crate::args::{ModelName, RenamedArgs};

/// Arguments of `stickslip live`.
#[derive(Debug, Args)]
pub struct LiveArgs {
    /// Scene (scene.toml), or its folder
    pub scene: PathBuf,
    /// Number of particles
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = particles)]
    pub particles: usize,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Model of the particle filter
    #[arg(long, value_enum, default_value_t = ModelName::Robust)]
    pub model: ModelName,
    /// The old name of `--model`
    #[command(flatten)]
    pub renamed: RenamedArgs,
    /// Ignore the touch sensors
    #[arg(long)]
    pub no_tactile: bool,
    /// Largest delay of a row behind the latest one
    #[arg(long, value_name = "SECONDS", default_value_t = 0.2)]
    pub late: f64,
    /// Deadline of each answer after its row; reduces the particles to meet it [default: none]
    #[arg(long, value_name = "MS", value_parser = positive)]
    pub deadline_ms: Option<f64>,
    /// New file for the rows, .mcap or .csv
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Serve a live page on this machine and print its address [PORT default: a free one]
    #[arg(long, value_name = "PORT", num_args = 0..=1, require_equals = true, default_missing_value = "0")]
    pub page: Option<u16>,
    /// How many threads
    #[command(flatten)]
    pub threads: ThreadArgs,
}

impl LiveArgs {
    /// Use of tactile readings.
    pub fn tactile(&self) -> TactileUse {
        if self.no_tactile {
            TactileUse::Ignored
        } else {
            TactileUse::Used
        }
    }
}
