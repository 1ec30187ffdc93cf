//! The command line: [`Program`].

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use stickslip::{FilterModel, Method, Occlusion, RunOptions, TactileUse, Tracking};
use stickslip_evaluation::Variant;

use crate::arg_values::{Rows, ThreadArgs, particles, positive};
use crate::camera_args::{CalibrateArgs, RenderArgs, TrackArgs};
use crate::fit_args::FitArgs;
use crate::given::GivenArgs;
use crate::live_args::LiveArgs;
use crate::print_args::PrintArgs;
use crate::simulation_args::{ReproduceArgs, SimulateArgs};
use crate::topic_args::TopicArgs;

/// Tracks a pushed object through contact and visual occlusion and adapts the friction that governs
/// it.
#[derive(Debug, Parser)]
#[command(name = "stickslip", version, max_term_width = 120)]
pub struct Program {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run the embedded experiments through every method: tables, figures, a report
    Demo(DemoArgs),
    /// Estimate the object's pose and the friction over one recorded experiment
    Filter(FilterArgs),
    /// Run every method on experiment folders and compare their errors
    Compare(CompareArgs),
    /// Learn from many pushes what a scene cannot know: friction, tripod radius; with its spread
    Fit(FitArgs),
    /// Simulate an experiment: a folder with scene, log and truth
    Simulate(SimulateArgs),
    /// Repeat the paper's evaluation: its tables and figures, ours beside the paper's numbers
    Reproduce(ReproduceArgs),
    /// Write a scene to begin with, every key explained, and its JSON schema for editors
    New(NewArgs),
    /// Draw tags and the calibration board to scale, with a ruler, as PDF or SVG to be printed
    Print(PrintArgs),
    /// Look into a ROS 2 bag: topics, types, rates, gaps, which would do, and what to type next
    Info(InfoArgs),
    /// Find what is wrong with a scene and a log: units, degrees, frames, latency, overlaps,
    /// swapped sensors
    Check(CheckArgs),
    /// Estimate row by row: JSON lines on standard input, an estimate for each on standard output
    Live(LiveArgs),
    /// Calibrate a camera from frames of a tag board
    Calibrate(CalibrateArgs),
    /// Track object and pusher through camera frames by their tags, into a log
    Track(TrackArgs),
    /// Render camera frames of an experiment, with a calibration recording
    Render(RenderArgs),
}

/// Arguments of `stickslip new`.
#[derive(Debug, Args)]
pub struct NewArgs {
    /// The folder of the experiment, where scene.toml and scene.schema.json are written
    pub folder: PathBuf,
    /// Take the object's outline from this drawing, seen from above: a closed line in SVG or DXF
    #[arg(long, value_name = "DRAWING")]
    pub outline: Option<PathBuf>,
    /// Metres that one unit of the drawing is, 0.001 for millimetres [default: as the drawing says]
    #[arg(long, value_name = "M", value_parser = positive, requires = "outline")]
    pub scale: Option<f64>,
    /// How far the outline may lie from the drawing's curves, in metres
    #[arg(long, value_name = "M", value_parser = positive, default_value_t = 2e-5, requires = "outline")]
    pub tolerance: f64,
}

/// Arguments of `stickslip demo`.
#[derive(Debug, Args)]
pub struct DemoArgs {
    /// Write report.html and the figures into this folder
    #[arg(long, value_name = "DIR", default_value = "stickslip-demo")]
    pub out: PathBuf,
    /// Number of particles
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = particles)]
    pub particles: usize,
    /// How many threads
    #[command(flatten)]
    pub threads: ThreadArgs,
}

/// Arguments of `stickslip filter`.
#[derive(Debug, Args)]
pub struct FilterArgs {
    /// The log and the scene
    #[command(flatten)]
    pub given: GivenArgs,
    /// Topics of an MCAP log
    #[command(flatten)]
    pub topics: TopicArgs,
    /// How to estimate
    #[arg(long, value_enum, default_value_t = MethodName::Particle)]
    pub method: MethodName,
    /// Ignore the tactile readings
    #[arg(long)]
    pub no_tactile: bool,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Split every step into N substeps, instead of by its length
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub substeps: Option<u32>,
    /// Score against this motion, instead of truth.csv beside the log or the log's own poses
    #[arg(long, value_name = "CSV")]
    pub truth: Option<PathBuf>,
    /// Weight of an angle in the scores, as a radius [default: the radius of gyration]
    #[arg(long, value_name = "M", value_parser = positive)]
    pub virtual_radius: Option<f64>,
    /// Write estimate.csv into this folder
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// With --out, write estimate.mcap too, for viewers of ROS 2
    #[arg(long, requires = "out")]
    pub mcap: bool,
    /// With --out, write estimate.tum too, for evo
    #[arg(long, requires = "out")]
    pub tum: bool,
    /// Write a report with figures and a playback into this HTML file
    #[arg(long, value_name = "HTML")]
    pub report: Option<PathBuf>,
    /// Options shared with `compare`
    #[command(flatten)]
    pub shared: SharedArgs,
}

/// Arguments of `stickslip compare`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// Experiment folders (scene.toml, log.csv, log.mcap or a bag, and what is known of the truth),
    /// or folders of such folders
    #[arg(required = true, value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// Run the particle filter with the seeds 0 to K - 1 and take the median of each score
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub seeds: u64,
    /// Name of the scene file in each folder
    #[arg(long, value_name = "FILE", default_value = "scene.toml")]
    pub scene_name: String,
    /// One scene for all logs, or a folder with scene.toml, instead of the scene in each folder;
    /// then DIR may be a log by any name, too
    #[arg(long, conflicts_with = "scene_name")]
    pub scene: Option<PathBuf>,
    /// Topics of the MCAP logs
    #[command(flatten)]
    pub topics: TopicArgs,
    /// Write a report with all tables into this HTML file
    #[arg(long, value_name = "HTML")]
    pub report: Option<PathBuf>,
    /// Options shared with `filter`
    #[command(flatten)]
    pub shared: SharedArgs,
}

/// Arguments of `stickslip check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// The log and the scene
    #[command(flatten)]
    pub given: GivenArgs,
    /// Topics of an MCAP log
    #[command(flatten)]
    pub topics: TopicArgs,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `stickslip info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// The folder of a bag, or an MCAP file
    pub bag: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Options of every command that runs methods.
#[derive(Debug, Args)]
pub struct SharedArgs {
    /// Number of particles
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = particles)]
    pub particles: usize,
    /// Hide the camera's object poses of the rows FROM to TO (excluded; to the end without TO) and
    /// still score on them
    #[arg(long, value_name = "FROM[:TO]", conflicts_with = "occlude_middle")]
    pub occlude: Option<Rows>,
    /// Hide the camera's object poses for SECONDS about the middle of the log
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    pub occlude_middle: Option<f64>,
    /// Model of the particle filter
    #[arg(long, value_enum, default_value_t = ModelName::Robust)]
    pub model: ModelName,
    /// The old name of `--model`
    #[command(flatten)]
    pub renamed: RenamedArgs,
    /// Track the pusher from the rows up to each one only, as live
    #[arg(long)]
    pub causal: bool,
    /// How many threads
    #[command(flatten)]
    pub threads: ThreadArgs,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// How to estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// Particle filter over contact dynamics
    Particle,
    /// Constant-velocity Kalman filter that knows nothing of contact
    Kalman,
    /// The same, at rest from the first tactile contact in the dark on
    KalmanStops,
    /// The same, which in the dark moves with the pusher as if glued to it
    WithPusher,
    /// Extended Kalman filter over contact dynamics; it does not feel touch
    ExtendedKalman,
    /// Simulation with the nominal friction, blind after the first pose
    Nominal,
}

/// Refuses `--mode`, the old name of `--model`.
#[derive(Debug, Args)]
pub struct RenamedArgs {
    /// The old name
    #[arg(long, hide = true, value_name = "NAME", value_parser = refuse_mode)]
    mode: Option<String>,
}

fn refuse_mode(_: &str) -> Result<String, String> {
    Err(
        "`--mode` is called `--model`: `--model robust` (formerly contact) or `--model paper`"
            .to_owned(),
    )
}

/// Model of the particle filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ModelName {
    /// Friction, frame offsets, support feet and latency are unknown; sensors may fail
    /// (`[uncertainty]` in the scene)
    Robust,
    /// As published by Zhang & Trinkle (ICRA 2012)
    Paper,
}

impl ModelName {
    /// As on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Robust => "robust",
            Self::Paper => "paper",
        }
    }
}

impl From<ModelName> for FilterModel {
    fn from(name: ModelName) -> Self {
        match name {
            ModelName::Robust => Self::Robust,
            ModelName::Paper => Self::Paper,
        }
    }
}

impl SharedArgs {
    /// What the options hide.
    pub fn occlusion(&self) -> Occlusion {
        match (self.occlude, self.occlude_middle) {
            (Some(rows), _) => Occlusion::Rows {
                from: rows.from,
                to: rows.to,
            },
            (None, Some(seconds)) => Occlusion::Middle { seconds },
            (None, None) => Occlusion::None,
        }
    }

    /// How the pusher is tracked.
    pub fn tracking(&self) -> Tracking {
        if self.causal {
            Tracking::Causal
        } else {
            Tracking::Smoothed
        }
    }
}

impl FilterArgs {
    /// What runs.
    pub fn variant(&self) -> Variant {
        Variant::of(self.method.into(), self.tactile())
    }

    fn tactile(&self) -> TactileUse {
        if self.no_tactile {
            TactileUse::Ignored
        } else {
            TactileUse::Used
        }
    }

    /// Options of the run.
    pub fn run_options(&self) -> RunOptions {
        RunOptions {
            method: self.method.into(),
            model: self.shared.model.into(),
            particles: self.shared.particles,
            seed: self.seed,
            tactile: self.tactile(),
            tracking: self.shared.tracking(),
            substeps: self.substeps,
            occlusion: self.shared.occlusion(),
            ..RunOptions::default()
        }
    }
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::Particle => Self::Particle,
            MethodName::Kalman => Self::Kalman,
            MethodName::KalmanStops => Self::KalmanStops,
            MethodName::WithPusher => Self::WithPusher,
            MethodName::ExtendedKalman => Self::ExtendedKalman,
            MethodName::Nominal => Self::Nominal,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn command_line_is_consistent() {
        use clap::CommandFactory;
        Program::command().debug_assert();
    }
}
