//! The camera chain: the commands [`print()`], [`calibrate`], [`track`] and [`render`], and
//! replicates of the paper from frames, [`filmed`]. Part of the program with the feature `camera`;
//! `no_camera.rs` takes its place without.

mod args;
mod bag_images;
mod calibrate;
mod filmed;
mod frame_names;
mod frames;
mod print;
mod print_args;
mod render;
mod setup;
mod track;

pub use args::{CalibrateArgs, RenderArgs, TrackArgs};
pub use calibrate::calibrate;
pub use filmed::filmed;
pub use print::print;
pub use print_args::PrintArgs;
pub use render::render;
pub use track::track;

/// Note below the list of commands: none.
pub const NOTE: Option<&str> = None;
