//! The command line: [`Program`].

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use stickslip::{FilterModel, Method, Occlusion, RunOptions, TactileUse, Tracking};
use stickslip_evaluation::Variant;

use crate::arg_values::{ForceArgs, Rows, ThreadArgs, particles, positive};
use crate::camera::{self, CalibrateArgs, PrintArgs, RenderArgs, TrackArgs};
use crate::compare::SceneArgs;
use crate::fit_args::FitArgs;
use crate::given::GivenArgs;
use crate::live_args::LiveArgs;
use crate::simulation_args::{ReproduceArgs, SimulateArgs};
use crate::topic_args::TopicArgs;

/// Estimates pose and friction of a pushed object, through contact and with the camera off.
#[derive(Debug, Parser)]
#[command(name = "stickslip", version, max_term_width = 120, after_help = camera::NOTE)]
pub struct Program {
    /// The command.
    #[command(subcommand)]
    pub command: Command,
}

/// The command.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run every method on the embedded experiments: tables, figures, a report
    Demo(DemoArgs),
    /// Estimate pose and friction over one recorded experiment
    Filter(FilterArgs),
    /// Run every method on experiment folders and compare their errors
    Compare(CompareArgs),
    /// Fit friction and geometry to many pushes, with spreads
    Fit(FitArgs),
    /// Simulate an experiment: scene, log and truth
    Simulate(SimulateArgs),
    /// Repeat the paper's evaluation: tables and figures, with the paper's numbers
    Reproduce(ReproduceArgs),
    /// Write a scene with every key, its unit and default, and its JSON schema
    New(NewArgs),
    /// Draw tags or the calibration board to scale, as PDF or SVG
    Print(PrintArgs),
    /// List the topics of a ROS 2 bag, and the commands that read it
    Info(InfoArgs),
    /// Check a scene and a log: units, angles, frames, latency, overlap, sensors
    Check(CheckArgs),
    /// Estimate row by row: JSON lines in, one estimate per line out
    Live(LiveArgs),
    /// Serve a page: check logs, run the filter, change friction and occlusion by sliders
    View(ViewArgs),
    /// Calibrate a camera from frames of a tag board
    Calibrate(CalibrateArgs),
    /// Track the tags of object and pusher through camera frames, into a log
    Track(TrackArgs),
    /// Render camera frames of an experiment and of a calibration board
    Render(RenderArgs),
}

/// Arguments of `stickslip new`.
#[derive(Debug, Args)]
pub struct NewArgs {
    /// Folder for scene.toml and scene.schema.json
    pub folder: PathBuf,
    /// Drawing of the object's outline, seen from above, closed (.svg or .dxf)
    #[arg(long, value_name = "DRAWING")]
    pub outline: Option<PathBuf>,
    /// Length of a unit of the drawing in m: 0.001 for mm [default: from the drawing]
    #[arg(long, value_name = "M", value_parser = positive, requires = "outline")]
    pub scale: Option<f64>,
    /// Largest distance of the outline from the drawing's curves in m
    #[arg(long, value_name = "M", value_parser = positive, default_value_t = 2e-5, requires = "outline")]
    pub tolerance: f64,
}

/// Arguments of `stickslip demo`.
#[derive(Debug, Args)]
pub struct DemoArgs {
    /// Folder for report.html and the figures
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
    /// Log and scene
    #[command(flatten)]
    pub given: GivenArgs,
    /// Topics of an MCAP log
    #[command(flatten)]
    pub topics: TopicArgs,
    /// Method of estimation
    #[arg(long, value_enum, default_value_t = MethodName::Particle)]
    pub method: MethodName,
    /// Ignore the touch sensors
    #[arg(long)]
    pub no_tactile: bool,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Substeps of each step, 1 to 10000 [default: by the step's length]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub substeps: Option<u32>,
    /// Motion to score against [default: truth.csv next to the log, else the log's poses]
    #[arg(long, value_name = "CSV")]
    pub truth: Option<PathBuf>,
    /// Weight of angles in the pose RMSE, a radius in m [default: the radius of gyration]
    #[arg(long, value_name = "M", value_parser = positive)]
    pub virtual_radius: Option<f64>,
    /// Folder for estimate.csv and modes.csv
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// With --out, also write estimate.mcap, for ROS 2 viewers
    #[arg(long, requires = "out")]
    pub mcap: bool,
    /// With --out, also write estimate.tum, for evo
    #[arg(long, requires = "out")]
    pub tum: bool,
    /// File for a report with figures and a playback
    #[arg(long, value_name = "HTML")]
    pub report: Option<PathBuf>,
    /// Options shared with `compare`
    #[command(flatten)]
    pub shared: SharedArgs,
}

/// Arguments of `stickslip compare`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// Experiment folders (scene.toml, a log, the truth if known), or folders of such folders
    #[arg(required = true, value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// Seeds 0 to K - 1 of the particle filter, K at most 10000; scores are medians
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub seeds: u64,
    /// Scenes of the logs
    #[command(flatten)]
    pub scenes: SceneArgs,
    /// Topics of the MCAP logs
    #[command(flatten)]
    pub topics: TopicArgs,
    /// File for a report with all tables
    #[arg(long, value_name = "HTML")]
    pub report: Option<PathBuf>,
    /// Options shared with `filter`
    #[command(flatten)]
    pub shared: SharedArgs,
}

/// Arguments of `stickslip check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Log and scene
    #[command(flatten)]
    pub given: GivenArgs,
    /// Topics of an MCAP log
    #[command(flatten)]
    pub topics: TopicArgs,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `stickslip view`.
#[derive(Debug, Args)]
pub struct ViewArgs {
    /// Experiment folders (scene.toml and a log), or folders of such folders
    #[arg(value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// Port on this machine [default: a free one]
    #[arg(
        long,
        value_name = "PORT",
        default_value_t = 0,
        hide_default_value = true
    )]
    pub port: u16,
    /// How many threads
    #[command(flatten)]
    pub threads: ThreadArgs,
}

/// Arguments of `stickslip info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// Folder of a bag, or an MCAP file
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
    /// Hide object poses from row FROM until before TO [TO default: the end]; they are still scored
    #[arg(long, value_name = "FROM[:TO]", conflicts_with = "occlude_middle")]
    pub occlude: Option<Rows>,
    /// Hide object poses for SECONDS in the middle of the log; they are still scored
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    pub occlude_middle: Option<f64>,
    /// Model of the particle filter
    #[arg(long, value_enum, default_value_t = ModelName::Robust)]
    pub model: ModelName,
    /// The old name of `--model`
    #[command(flatten)]
    pub renamed: RenamedArgs,
    /// Track the pusher without later rows, as live does
    #[arg(long)]
    pub causal: bool,
    /// Choice to run wrong input
    #[command(flatten)]
    pub force: ForceArgs,
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
    /// Constant-velocity Kalman filter, without contact
    Kalman,
    /// As kalman; with the camera off it stops at the first touch
    KalmanStops,
    /// As kalman; with the camera off the object is glued to the pusher
    WithPusher,
    /// Extended Kalman filter over contact dynamics, without touch
    ExtendedKalman,
    /// Simulation with nominal friction, camera off after the first pose
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
    /// Priors on friction, frames, feet and latency ([uncertainty] in the scene); sensors may fail
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
    /// Rows that the options hide.
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

    /// Tracking of the pusher.
    pub fn tracking(&self) -> Tracking {
        if self.causal {
            Tracking::Causal
        } else {
            Tracking::Smoothed
        }
    }
}

impl FilterArgs {
    /// The method, with or without touch.
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
