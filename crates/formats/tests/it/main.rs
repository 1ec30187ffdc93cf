//! The files of an experiment, read and written.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod arbitrary;
mod bag;
mod bag_bytes;
mod bag_covariance;
mod bag_frames;
mod bag_images;
mod bag_runs;
mod data_folder;
mod estimate;
mod experiment;
mod hand;
mod key_table;
mod large;
mod log;
mod log_bits;
mod log_mcap;
mod log_mcap_refused;
mod memory;
mod outline;
mod ros2;
mod ros2_estimate;
mod ros2_peer;
mod scene;
mod scene_edit;
mod scene_help;
mod scene_keys;
mod scene_numbers;
mod scene_schema;
mod scene_text;
mod truth;
