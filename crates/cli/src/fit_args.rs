//! Arguments of `stickslip fit`.

use std::path::PathBuf;

use clap::Args;

use crate::arg_values::ThreadArgs;
use crate::compare::Scenes;
use crate::topic_args::TopicArgs;

/// Arguments of `stickslip fit`.
#[derive(Debug, Args)]
pub struct FitArgs {
    /// Experiment folders (scene.toml, log.csv or log.mcap), or folders of such folders: pushes of
    /// one object on one table
    #[arg(required = true, value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// What to learn, of mu_s, mu_p, mu_f, tripod_radius, centre_of_friction, outline_scale,
    /// outline_offset, pusher_offset, latency
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        default_value = "mu_p,tripod_radius"
    )]
    pub free: Vec<String>,
    /// Write scene.toml and fit.json into this folder
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Write a report into this HTML file
    #[arg(long, value_name = "HTML")]
    pub report: Option<PathBuf>,
    /// Deal the pushes into K parts and predict each by a fit to the others; 0: do not [default: 4,
    /// 2 for fewer than 8 pushes, 0 for fewer than 4]
    #[arg(long, value_name = "K")]
    pub folds: Option<usize>,
    /// Predict the pushes of these folders, too, blind by what the others taught
    #[arg(long, value_name = "DIR", num_args = 1..)]
    pub test: Vec<PathBuf>,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Name of the scene file in each folder
    #[arg(long, value_name = "FILE", default_value = "scene.toml")]
    pub scene_name: String,
    /// Topics of the MCAP logs
    #[command(flatten)]
    pub topics: TopicArgs,
    /// How many threads
    #[command(flatten)]
    pub threads: ThreadArgs,
    /// Print one JSON object, that of fit.json
    #[arg(long)]
    pub json: bool,
}

impl FitArgs {
    /// Which scene is that of a push.
    pub fn scenes(&self) -> Scenes<'_> {
        Scenes::Named(&self.scene_name)
    }
}
