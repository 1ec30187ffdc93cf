//! Arguments of `stickslip fit`.

use std::path::PathBuf;

use clap::Args;

use crate::arg_values::{ForceArgs, ThreadArgs};
use crate::compare::SceneArgs;
use crate::topic_args::TopicArgs;

/// Arguments of `stickslip fit`.
#[derive(Debug, Args)]
pub struct FitArgs {
    /// Experiment folders (scene.toml, a log), or folders of such folders; each object is fitted on
    /// its own
    #[arg(required = true, value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// Free parameters, of mu_s, mu_p, mu_f, tripod_radius, centre_of_friction, support,
    /// outline_scale, outline_offset, pusher_offset, latency [default: mu_p, and what the scene
    /// leaves open of the support]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub free: Vec<String>,
    /// Folder for scene.toml and fit.json, or for a folder of each object with these
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// File for a report (HTML)
    #[arg(long, value_name = "HTML")]
    pub report: Option<PathBuf>,
    /// Parts of the cross-validation, 0: none [default: 4; 2 below 8 pushes, 0 below 4]
    #[arg(long, value_name = "K")]
    pub folds: Option<usize>,
    /// Folders of pushes that are predicted by the fit and not used for it
    #[arg(long, value_name = "DIR", num_args = 1..)]
    pub test: Vec<PathBuf>,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Scenes of the logs
    #[command(flatten)]
    pub scenes: SceneArgs,
    /// Topics of the MCAP logs
    #[command(flatten)]
    pub topics: TopicArgs,
    /// Choice to fit wrong input
    #[command(flatten)]
    pub force: ForceArgs,
    /// How many threads
    #[command(flatten)]
    pub threads: ThreadArgs,
    /// Print the content of fit.json, of several objects as a list
    #[arg(long)]
    pub json: bool,
}
