//! The command line: [`Program`].

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, Parser, Subcommand, ValueEnum};
use stickslip::{Method, Occlusion, RunOptions, TactileUse, Tracking};

use crate::camera_args::{CalibrateArgs, RenderArgs, TrackArgs};
use crate::contest::Rival;
use crate::paper::PaperExperiment;
use crate::topic_args::TopicArgs;

/// Tracks a pushed object through contact and visual occlusion and learns the friction that governs
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
    /// Simulate an experiment: a folder with scene, log and truth
    Simulate(SimulateArgs),
    /// Repeat the paper's evaluation: its tables and figures, ours beside the paper's numbers
    Reproduce(ReproduceArgs),
    /// Find what is wrong with a scene and a log: units, degrees, frames, latency, overlaps,
    /// swapped sensors
    Check(CheckArgs),
    /// Calibrate a camera from frames of a tag board
    Calibrate(CalibrateArgs),
    /// Track object and pusher through camera frames by their tags, into a log
    Track(TrackArgs),
    /// Render camera frames of an experiment, with a calibration recording
    Render(RenderArgs),
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
    /// Threads [default: one per processor]; results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

/// Arguments of `stickslip filter`.
#[derive(Debug, Args)]
pub struct FilterArgs {
    /// The recorded experiment (log.csv, or an MCAP recording of ROS 2 messages, log.mcap)
    pub log: PathBuf,
    /// What is known before the experiment (scene.toml)
    #[arg(long)]
    pub scene: PathBuf,
    /// Topics of an MCAP log
    #[command(flatten)]
    pub topics: TopicArgs,
    /// How to estimate
    #[arg(long, value_enum, default_value_t = MethodName::Particle)]
    pub method: MethodName,
    /// Rules of the particle filter
    #[arg(long, value_enum, default_value_t = Mode::Paper)]
    pub mode: Mode,
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
    /// Experiment folders (scene.toml, log.csv or log.mcap, and what is known of the truth), or
    /// folders of such folders
    #[arg(required = true, value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// Run the particle filter with the seeds 0 to K - 1 and take the median of each score
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub seeds: u64,
    /// Name of the scene file in each folder
    #[arg(long, value_name = "FILE", default_value = "scene.toml")]
    pub scene_name: String,
    /// Write a report with all tables into this HTML file
    #[arg(long, value_name = "HTML")]
    pub report: Option<PathBuf>,
    /// Options shared with `filter`
    #[command(flatten)]
    pub shared: SharedArgs,
}

/// Arguments of `stickslip simulate`.
#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// Bodies, nominal friction and how all begins (scene.toml with a table `start`)
    #[arg(required_unless_present = "paper", conflicts_with = "paper")]
    pub scene: Option<PathBuf>,
    /// One of the paper's experiments in place of a scene
    #[arg(long, value_enum, ignore_case = true, value_name = "NAME", conflicts_with_all = ["truth", "friction_error"])]
    pub paper: Option<PaperExperiment>,
    /// Write scene.toml, log.csv, truth.csv and truth.json into this folder
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// What moves the object
    #[arg(long, value_enum, default_value_t = Physics::Testbed)]
    pub physics: Physics,
    /// Seed of all random numbers: of the rig's as of the sensors'
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Camera frames per second
    #[arg(long, value_name = "HZ", default_value_t = 30.0, value_parser = positive)]
    pub rate: f64,
    /// Take mu_s, mu_p, mu_f and occlude_from from this file (truth.json) [default: the scene's
    /// friction]
    #[arg(long, value_name = "JSON")]
    pub truth: Option<PathBuf>,
    /// Draw the true friction within this share of the scene's, as 0.4
    #[arg(long, value_name = "SHARE", conflicts_with = "truth", value_parser = share)]
    pub friction_error: Option<f64>,
}

/// Arguments of `stickslip reproduce`.
#[derive(Debug, Args)]
pub struct ReproduceArgs {
    /// Write reproduce.json, Figures 2 to 7 as SVG and PNG, and report.html into this folder
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of seeds: of rigs, sensors and filters [default: 20]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub seeds: Option<u64>,
    /// Render camera frames and track them, instead of measuring poses with the paper's noise
    #[arg(long)]
    pub from_frames: bool,
    /// Number of particles
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = particles)]
    pub particles: usize,
    /// Threads [default: one per processor]; results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `stickslip check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// What is known before the experiment (scene.toml)
    pub scene: PathBuf,
    /// The recorded experiment (log.csv, or an MCAP recording of ROS 2 messages, log.mcap)
    pub log: PathBuf,
    /// Topics of an MCAP log
    #[command(flatten)]
    pub topics: TopicArgs,
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
    /// Track the pusher from the rows up to each one only, as live
    #[arg(long)]
    pub causal: bool,
    /// Threads [default: one per processor]; results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
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
    /// Simulation with the nominal friction, blind after the first pose
    Nominal,
}

/// Rules of the particle filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// As published
    Paper,
    /// Proposals that meet the contacts (not there yet)
    Contact,
}

/// What moves the object of a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Physics {
    /// A rig with compliant contacts, uneven friction and a drive that lags and stalls
    Testbed,
    /// The filter's own contact dynamics, without noise
    Model,
}

impl Physics {
    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Testbed => "testbed",
            Self::Model => "model",
        }
    }
}

/// A range of log rows, `FROM[:TO]`; `FROM:` also runs to the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rows {
    /// First row.
    pub from: usize,
    /// First row after them; `None`: to the end.
    pub to: Option<usize>,
}

impl FromStr for Rows {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let row = |part: &str| {
            part.parse::<usize>()
                .map_err(|_| format!("`{part}` is not a row number from 0 up"))
        };
        let (from, to) = match text.split_once(':') {
            Some((from, "")) => (row(from)?, None),
            Some((from, to)) => (row(from)?, Some(row(to)?)),
            None => (row(text)?, None),
        };
        if to.is_some_and(|to| to <= from) {
            Err("TO must come after FROM".to_owned())
        } else {
            Ok(Self { from, to })
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

    /// Threads with the requested number of workers.
    pub fn pool(&self) -> anyhow::Result<rayon::ThreadPool> {
        let threads = self.threads.map_or(0, usize::from);
        Ok(rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?)
    }
}

impl FilterArgs {
    /// Options of the run.
    pub fn run_options(&self) -> RunOptions {
        RunOptions {
            method: self.method.into(),
            particles: self.shared.particles,
            seed: self.seed,
            tactile: if self.no_tactile {
                TactileUse::Ignored
            } else {
                TactileUse::Used
            },
            tracking: self.shared.tracking(),
            substeps: self.substeps,
            occlusion: self.shared.occlusion(),
        }
    }
}

impl MethodName {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Particle => "particle filter",
            Self::Kalman => "Kalman filter",
            Self::Nominal => "nominal simulation",
        }
    }
}

impl MethodName {
    /// Colour in figures, as in comparisons.
    pub fn colour(self) -> stickslip_report::Colour {
        match self {
            Self::Particle => Rival::Particle,
            Self::Kalman => Rival::Kalman,
            Self::Nominal => Rival::Nominal,
        }
        .colour()
    }
}

impl From<MethodName> for Method {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::Particle => Self::Particle,
            MethodName::Kalman => Self::Kalman,
            MethodName::Nominal => Self::Nominal,
        }
    }
}

/// A positive number.
pub fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err("must be positive".to_owned())
    }
}

fn share(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (0.0..=1.0).contains(&value) {
        Ok(value)
    } else {
        Err("must be from 0 to 1".to_owned())
    }
}

fn particles(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) | Err(_) => Err("must be a whole number from 1 up".to_owned()),
        Ok(count) => Ok(count),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_parse_from_and_to() {
        assert_eq!("3".parse(), Ok(Rows { from: 3, to: None }));
        assert_eq!("3:".parse(), Ok(Rows { from: 3, to: None }));
        assert_eq!(
            "3:7".parse(),
            Ok(Rows {
                from: 3,
                to: Some(7)
            })
        );
        for bad in ["", "x", "7:3", "3:3", ":3", "-1"] {
            assert!(bad.parse::<Rows>().is_err(), "{bad}");
        }
    }

    #[test]
    fn command_line_is_consistent() {
        use clap::CommandFactory;
        Program::command().debug_assert();
    }
}
