//! Arguments of `stickslip print`: [`PrintArgs`].

use std::path::PathBuf;

use clap::Args;
use stickslip_vision::Paper;

use crate::arg_values::positive;

/// Arguments of `stickslip print`.
#[derive(Debug, Args)]
pub struct PrintArgs {
    /// File to write: PDF if its name ends in .pdf, else SVG
    #[arg(value_name = "FILE")]
    pub out: PathBuf,
    /// Numbers of the tags to draw, as 0,1
    #[arg(
        long,
        value_name = "N,...",
        value_delimiter = ',',
        required_unless_present = "board",
        conflicts_with = "board"
    )]
    pub tags: Vec<u16>,
    /// Edge of a tag's black square in m
    #[arg(long, value_name = "M", value_parser = positive, default_value_t = 0.028)]
    pub size: f64,
    /// Calibration board to draw (board.toml)
    #[arg(long, value_name = "TOML")]
    pub board: Option<PathBuf>,
    /// Paper size in mm, each side 20 to 5000; 210x297 is A4
    #[arg(long, value_name = "WxH", value_parser = paper, default_value = "210x297")]
    pub paper: Paper,
}

/// Width and height in mm.
fn paper(text: &str) -> Result<Paper, String> {
    let sides = text.split_once('x');
    let sides = sides.and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    let within = |sides: &[f64; 2]| sides.iter().all(|side| (20.0..=5000.0).contains(side));
    let sides = sides.filter(within);
    let [width, height] =
        sides.ok_or("must be width x height in mm, each from 20 to 5000, as 297x210")?;
    Ok(Paper { width, height })
}
