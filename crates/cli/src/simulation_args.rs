//! Arguments of the commands that simulate.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use stickslip::Tracking;
use stickslip_evaluation::Physics;
use stickslip_evaluation::paper::{PaperExperiment, RunSettings};

use crate::arg_values::{ThreadArgs, particles, positive};
use crate::args::{ModelName, RenamedArgs};

/// Arguments of `stickslip simulate`.
#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// Scene with a table [start]
    #[arg(required_unless_present = "paper", conflicts_with = "paper")]
    pub scene: Option<PathBuf>,
    /// One of the paper's experiments instead of a scene
    #[arg(long, value_enum, ignore_case = true, value_name = "NAME", conflicts_with_all = ["truth", "friction_error"])]
    pub paper: Option<PaperName>,
    /// Folder for scene.toml, log.csv, truth.csv and truth.json
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Simulate N times with noise seeds from --noise-seed on; each has a folder below --out,
    /// noise-SEED
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub count: Option<u64>,
    /// Simulator
    #[arg(long, value_enum, default_value_t = PhysicsName::Testbed)]
    pub physics: PhysicsName,
    /// Seed of all random numbers, of rig and sensors
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Seed of the rig alone: its pressure, table, drive, and --friction-error [default: --seed]
    #[arg(long, value_name = "SEED")]
    pub rig_seed: Option<u64>,
    /// Seed of the sensors' noise alone [default: --seed]
    #[arg(long, value_name = "SEED")]
    pub noise_seed: Option<u64>,
    /// Camera frames per second
    #[arg(long, value_name = "HZ", default_value_t = 30.0, value_parser = positive)]
    pub rate: f64,
    /// File with mu_s, mu_p, mu_f and occlude_from (truth.json) [default: the scene's friction]
    #[arg(long, value_name = "JSON")]
    pub truth: Option<PathBuf>,
    /// Draw the true friction within this share of the scene's, 0 to 1 [default: 0]
    #[arg(long, value_name = "SHARE", conflicts_with = "truth", value_parser = share)]
    pub friction_error: Option<f64>,
}

/// Arguments of `stickslip reproduce`.
#[derive(Debug, Args)]
pub struct ReproduceArgs {
    /// Folder for the numbers as JSON, the figures and report.html
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of seeds of rig, sensors and filter, 1 to 1000 [default: 20]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub seeds: Option<u64>,
    /// Run 106 scenes in the paper's regime, and compare touch with no touch [seeds: 10]
    #[arg(long, conflicts_with = "from_frames")]
    pub pinned: bool,
    /// Force noise of the paper's model in these scenes, as filter.force_std of a scene
    #[arg(long, value_name = "SHARE", requires = "pinned", value_parser = share)]
    pub force_std: Option<f64>,
    /// Track rendered camera frames, instead of poses with the paper's noise
    #[arg(long)]
    pub from_frames: bool,
    /// Track the thumb without later rows, as live does
    #[arg(long)]
    pub causal: bool,
    /// Model of the particle filter
    #[arg(long, value_enum, default_value_t = ModelName::Paper)]
    pub model: ModelName,
    /// The old name of `--model`
    #[command(flatten)]
    pub renamed: RenamedArgs,
    /// Number of particles
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = particles)]
    pub particles: usize,
    /// How many threads
    #[command(flatten)]
    pub threads: ThreadArgs,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

impl ReproduceArgs {
    /// How all methods run.
    pub fn settings(&self) -> RunSettings {
        RunSettings {
            model: self.model.into(),
            particles: self.particles,
            tracking: if self.causal {
                Tracking::Causal
            } else {
                Tracking::Smoothed
            },
        }
    }
}

/// Simulator that moves the object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PhysicsName {
    /// Rig with compliant contacts, uneven friction, a drive that lags and stalls
    Testbed,
    /// The filter's own contact dynamics, without noise
    Model,
}

/// One of the paper's experiments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PaperName {
    /// Table II, Figures 2 to 4: jams soon after the first fixel contact
    #[value(name = "A")]
    A,
    /// Table III, Figures 5 to 7: slides along one fixel and ends on three
    #[value(name = "B")]
    B,
    /// Table IV: contact with a fixel and slide
    #[value(name = "1")]
    First,
    /// Table IV: contact with a fixel and slide
    #[value(name = "2")]
    Second,
    /// Table IV: contact with a fixel and stop
    #[value(name = "3")]
    Third,
    /// Table IV: contact with a fixel and stop
    #[value(name = "4")]
    Fourth,
    /// Not in the paper: a fixel catches the object at an edge, or misses it
    #[value(name = "5")]
    Edge,
    /// Not in the paper: a corner meets a fixel off its middle
    #[value(name = "6")]
    Corner,
}

impl From<PhysicsName> for Physics {
    fn from(name: PhysicsName) -> Self {
        match name {
            PhysicsName::Testbed => Self::Testbed,
            PhysicsName::Model => Self::Model,
        }
    }
}

impl From<PaperName> for PaperExperiment {
    fn from(name: PaperName) -> Self {
        match name {
            PaperName::A => Self::A,
            PaperName::B => Self::B,
            PaperName::First => Self::First,
            PaperName::Second => Self::Second,
            PaperName::Third => Self::Third,
            PaperName::Fourth => Self::Fourth,
            PaperName::Edge => Self::Edge,
            PaperName::Corner => Self::Corner,
        }
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
