//! Arguments of the commands about camera frames.

use std::path::PathBuf;

use clap::Args;
use stickslip_formats::CameraMapping;

use crate::arg_values::{Rows, ThreadArgs, positive};

/// Arguments of `stickslip calibrate`.
#[derive(Debug, Args)]
pub struct CalibrateArgs {
    /// Folder with images of the board: lying on the table in one, held and tilted to all sides in
    /// the others; or a bag of such images. Where its CameraInfo or --lens tells the lens, one
    /// image of the board on the table is enough
    #[arg(value_name = "FRAMES")]
    pub frames: PathBuf,
    /// Take the lens from this file, and find the table alone, from the image in which the board
    /// lies on it: ROS' camera_info.yaml, the YAML of OpenCV's calibration, or a calibration.toml
    #[arg(long, value_name = "FILE")]
    pub lens: Option<PathBuf>,
    /// Topics of a bag of images, as for `track`
    #[arg(long = "topic", value_name = "KEY=TOPIC")]
    pub topics: Vec<CameraMapping>,
    /// The board (board.toml): rows, columns, tag_size, gap, and how it lies on the table
    #[arg(long, value_name = "TOML")]
    pub board: PathBuf,
    /// The image in which the board lies on the table; of a bag, its number from 1 on [default: the
    /// first one]
    #[arg(long, value_name = "NAME")]
    pub flat: Option<String>,
    /// Write the calibration into this file
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
    /// Folder with the images, and their times in frames.csv (time,file); or a bag of images, its
    /// folder or an .mcap file
    #[arg(value_name = "FRAMES")]
    pub frames: PathBuf,
    /// Topics of a bag: image=/camera/image_raw (needed); info=TOPIC for CameraInfo elsewhere than
    /// beside the images, info= to leave it out; fixel_1=TOPIC, ..., wrench=TOPIC for what sensors
    /// felt; may be repeated
    #[arg(long = "topic", value_name = "KEY=TOPIC")]
    pub topics: Vec<CameraMapping>,
    /// The calibrated camera (calibration.toml); with the CameraInfo of a bag, [lens] may be left
    /// out of it
    #[arg(long, value_name = "TOML")]
    pub calibration: PathBuf,
    /// Which tag is on which body, and where (tags.toml)
    #[arg(long, value_name = "TOML")]
    pub tags: PathBuf,
    /// Frames per second of images without frames.csv, in the order of their names
    #[arg(long, value_name = "HZ", value_parser = positive)]
    pub rate: Option<f64>,
    /// Take tactile and force readings from this log (CSV or MCAP), whose rows have the frames'
    /// times
    #[arg(long, value_name = "LOG")]
    pub sensors: Option<PathBuf>,
    /// Write log.csv, log.mcap and poses.csv (with covariances) into this folder
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
    /// Write frames/, board/, board.toml, tags.toml and copies of scene and truth into this folder
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// The hand covers the object's tag in the frames FROM to TO (excluded; to the end without TO)
    /// [default: truth.json's occlude_from]
    #[arg(long, value_name = "FROM[:TO]")]
    pub cover: Option<Rows>,
    /// Probability that the frame grabber delivers a frame twice
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = probability)]
    pub repeat: f64,
    /// Blur of lens and defocus, as a standard deviation
    #[arg(long, value_name = "PX", default_value_t = 0.6, value_parser = positive)]
    pub blur: f64,
    /// Time that the shutter is open
    #[arg(long, value_name = "S", default_value_t = 0.008, value_parser = positive)]
    pub exposure: f64,
    /// Frames of the calibration recording
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u16).range(4..=1000))]
    pub board_frames: u16,
    /// Seed of all noise
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
