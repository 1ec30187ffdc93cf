//! Arguments of the commands about camera frames.

use std::path::PathBuf;

use clap::Args;
use stickslip_formats::CameraMapping;

use crate::arg_values::{Rows, ThreadArgs, positive};

/// Arguments of `stickslip calibrate`.
#[derive(Debug, Args)]
pub struct CalibrateArgs {
    /// Folder or bag of images of the board: on the table in one, tilted to all sides in the
    /// others; with a known lens (--lens, CameraInfo) the one is enough
    #[arg(value_name = "FRAMES")]
    pub frames: PathBuf,
    /// File with the lens: camera_info.yaml of ROS, the YAML of OpenCV, or a calibration.toml
    /// [default: calibrate it]
    #[arg(long, value_name = "FILE")]
    pub lens: Option<PathBuf>,
    /// Topics of a bag of images, as for `track`
    #[arg(long = "topic", value_name = "KEY=TOPIC")]
    pub topics: Vec<CameraMapping>,
    /// Board (board.toml): rows, columns, tag_size, gap, and its pose on the table
    #[arg(long, value_name = "TOML")]
    pub board: PathBuf,
    /// Image with the board on the table; of a bag, its number from 1 [default: the first one]
    #[arg(long, value_name = "NAME")]
    pub flat: Option<String>,
    /// File for the calibration
    #[arg(long, value_name = "TOML", default_value = "calibration.toml")]
    pub out: PathBuf,
    /// How many threads
    #[command(flatten)]
    pub threads: ThreadArgs,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `stickslip track`.
#[derive(Debug, Args)]
pub struct TrackArgs {
    /// Folder of images, with their times in frames.csv (time,file); or a bag, its folder or an
    /// .mcap file
    #[arg(value_name = "FRAMES")]
    pub frames: PathBuf,
    /// Topics of a bag: image=/camera/image_raw (required), info=TOPIC of CameraInfo (info= ignores
    /// it), fixel_1=TOPIC, ... and wrench=TOPIC for touch and force; repeatable
    #[arg(long = "topic", value_name = "KEY=TOPIC")]
    pub topics: Vec<CameraMapping>,
    /// Calibrated camera (calibration.toml); [lens] is optional with the CameraInfo of a bag
    #[arg(long, value_name = "TOML")]
    pub calibration: PathBuf,
    /// Tags of object and pusher, with their size and pose (tags.toml)
    #[arg(long, value_name = "TOML")]
    pub tags: PathBuf,
    /// Frames per second of images without frames.csv, in the order of names
    #[arg(long, value_name = "HZ", value_parser = positive)]
    pub rate: Option<f64>,
    /// Log (CSV or MCAP) with touch, force and poses of a hand's other fingers, one row per frame
    /// at its time
    #[arg(long, value_name = "LOG")]
    pub sensors: Option<PathBuf>,
    /// Folder for log.csv, log.mcap and poses.csv (with covariances)
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// How many threads
    #[command(flatten)]
    pub threads: ThreadArgs,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `stickslip render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// Experiment folder (scene.toml, log.csv or log.mcap, truth.csv)
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Folder for frames/, board/, board.toml, tags.toml and copies of scene and truth
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Cover the object's tag from frame FROM until before TO [TO default: the end; default:
    /// occlude_from of truth.json]
    #[arg(long, value_name = "FROM[:TO]")]
    pub cover: Option<Rows>,
    /// Probability that a frame is delivered twice, 0 to below 1
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = probability)]
    pub repeat: f64,
    /// Standard deviation of the blur of lens and defocus in px
    #[arg(long, value_name = "PX", default_value_t = 0.6, value_parser = positive)]
    pub blur: f64,
    /// Exposure time in s
    #[arg(long, value_name = "S", default_value_t = 0.008, value_parser = positive)]
    pub exposure: f64,
    /// Frames of the calibration recording, 4 to 1000
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u16).range(4..=1000))]
    pub board_frames: u16,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// How many threads
    #[command(flatten)]
    pub threads: ThreadArgs,
}

fn probability(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (0.0..1.0).contains(&value) {
        Ok(value)
    } else {
        Err("must be from 0 to below 1".to_owned())
    }
}
