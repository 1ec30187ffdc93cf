//! The camera chain in a build without the feature `camera`: its commands are listed, and refused
//! with the way to get them.

use std::ffi::OsString;

use anyhow::Result;
use clap::Args;
use clap::error::ErrorKind;
use stickslip_evaluation::paper::{NoiseLevel, Replicate};

use crate::verdict::Verdict;

/// Note below the list of commands.
pub const NOTE: Option<&str> = Some(
    "print, calibrate, track and render need the feature `camera`:\n  \
     cargo install --path crates/cli --features camera",
);

/// Words of a command that is left out.
#[derive(Debug, Args)]
#[command(disable_help_flag = true)]
pub struct LeftOut {
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    words: Vec<OsString>,
}

pub type CalibrateArgs = LeftOut;
pub type PrintArgs = LeftOut;
pub type RenderArgs = LeftOut;
pub type TrackArgs = LeftOut;

pub use refuse as calibrate;
pub use refuse as print;
pub use refuse as render;
pub use refuse as track;

/// Refuses a command.
pub fn refuse(_: &LeftOut) -> Result<Verdict> {
    Err(left_out())
}

/// Refuses `reproduce --from-frames`.
pub fn filmed(_: &[Replicate]) -> Result<(Vec<Replicate>, Vec<Replicate>, Vec<NoiseLevel>)> {
    Err(left_out())
}

/// A wrong use of this build, with the commands that make another.
fn left_out() -> anyhow::Error {
    let text = "camera frames need the feature `camera`, which this build leaves out; run \
        `cargo run --release --features camera -- ...` or \
        `cargo install --path crates/cli --features camera`\n";
    clap::Error::raw(ErrorKind::InvalidSubcommand, text).into()
}
