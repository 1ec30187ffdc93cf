//! The program, from its command line to its files and pages.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod bags;
mod browser;
#[cfg(feature = "camera")]
mod camera;
mod check;
mod check_poses;
mod common;
mod doubts;
mod filter_laws;
mod fit;
mod given;
mod inputs;
#[cfg(feature = "camera")]
mod lens;
mod live;
mod live_page;
mod live_recovery;
mod mcap;
mod newcomers;
mod outputs;
mod paper_scenes;
mod program;
mod reports;
mod reproduce;
#[cfg(feature = "camera")]
mod ros2;
mod simulate;
mod view_page;
