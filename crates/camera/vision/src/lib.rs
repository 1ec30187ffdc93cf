//! From camera frames to poses on the table.
//!
//! An overhead camera is calibrated once from frames of a tag [`Board`] ([`calibrate`]): [`Lens`]
//! and the place of the table before it ([`Camera`]). Then [`track`] finds the tags of object and
//! pusher in every frame and returns their planar poses with covariance. A pose is found in the
//! plane that the tag's print is known to lie in, never as the six-parameter pose of a single tag,
//! which has two near-equal solutions (Collins & Bartoli 2014).
//!
//! Tags are found by `kornia-apriltag`; their borders are then refitted to the pixels themselves
//! (`edge`), since the library's corners are neither free of bias nor come with their noise.
//!
//! Lengths in m, world frame: x and y on the table, z up from it. Pixels: x right, y down, the
//! centre of the first pixel at (0, 0).
//!
//! Invariants:
//! - opens no file, knows no filter;
//! - results do not depend on the number of threads, bit for bit;
//! - a pose whose tag's border does not fit a square on its plane is not given: it is counted as
//!   [`Sighting::Distorted`].

mod board;
mod board_recording;
mod bundle;
mod calibrate;
mod calibration_error;
mod camera;
mod camera_info;
mod config;
mod detector;
mod edge;
mod homography;
mod lens;
mod levenberg_marquardt;
mod motion;
mod outline;
mod pdf;
mod picture;
mod planar_pose;
mod poses_csv;
mod print;
mod raw_picture;
mod sheet;
mod table;
mod tag;
mod tags;
mod track;

pub use board::{Board, BoardOnTable, read_board, write_board};
pub use board_recording::{BoardRecording, CalibrationFrame, search_board};
pub use calibrate::{Calibration, calibrate};
pub use calibration_error::CalibrationError;
pub use camera::{Camera, read_camera, read_camera_with, read_lens, write_camera};
pub use camera_info::{CameraInfo, CameraInfoError, read_camera_info};
pub use config::{ConfigError, ConfigProblem};
pub use detector::{Detector, FoundTag};
pub use lens::Lens;
pub use picture::{PictureError, read_compressed, read_picture};
pub use planar_pose::{Measurement, TagPlace};
pub use poses_csv::write_poses;
pub use print::{Paper, PrintError, print_board, print_tags};
pub use raw_picture::{RawPicture, RawPictureError};
pub use sheet::Sheet;
pub use table::{TableFit, find_table};
pub use tag::{TAG_COUNT, tag_cells};
pub use tags::{BodyTag, Tags, read_tags, write_tags};
pub use track::{FrameSighting, FrameTracker, Sighting, Track, TrackError, track};
