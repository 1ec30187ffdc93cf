//! The files of an experiment, bytes to types and back: `scene.toml`, `log.csv`, `estimate.csv`,
//! `truth.csv`, `truth.json` and `frames.csv`; logs as MCAP recordings of ROS 2 messages too; logs,
//! estimates and truths as columns of numbers.
//!
//! Nothing here opens a file: readers take text, bytes or an [`std::io::Read`] with the name to
//! show in errors, writers an [`std::io::Write`]. Every refusal names the file, the line, the place
//! in the line, the value found, the rule and what to do. Input is never repaired: a file is read
//! as it stands or refused.

mod bag_metadata;
mod belief_columns;
mod csv_error;
mod csv_table;
mod estimate_columns;
mod estimate_csv;
mod estimate_json;
mod experiment;
mod frames_csv;
mod left_out;
mod log_columns;
mod log_csv;
mod log_mcap;
mod log_warning;
mod modes_csv;
mod mounts;
mod named_columns;
mod nearest;
mod number;
mod outline;
mod recorder;
mod row_json;
mod scene;
mod truth_csv;
mod truth_json;

pub use bag_metadata::{BagMetadata, BagMetadataError, read_bag_metadata};
pub use csv_error::{CsvColumn, CsvError, CsvProblem, LogError};
pub use estimate_columns::{estimate_columns, estimate_of_columns};
pub use estimate_csv::{read_estimate, write_estimate};
pub use estimate_json::{Pace, estimate_json};
pub use experiment::Experiment;
pub use frames_csv::{FrameList, read_frames, write_frames};
pub use left_out::{LeftOut, Reason};
pub use log_columns::{log_columns, log_of_columns};
pub use log_csv::{BodiesError, check_bodies, read_log, write_log};
pub use log_mcap::{
    BagCameraInfo, BagImage, BagInfo, BagOptions, BagPart, BagPicture, CameraMapping,
    CameraRecording, CameraTopics, Frames, LogTime, LogTimeError, McapError, McapPlace,
    McapProblem, McapWriteError, Place, PosesInfo, Readings, Topic, TopicError, TopicInfo,
    TopicMapping, Topics, read_bag, read_bag_camera_info, read_bag_images, read_bag_info,
    read_log_mcap, write_estimate_mcap, write_estimate_tum, write_log_mcap,
};
pub use log_warning::LogWarning;
pub use modes_csv::write_modes;
pub use mounts::Mounts;
pub use named_columns::{ColumnError, NamedColumns};
pub use nearest::nearest;
pub use outline::{
    DrawnUnit, Outline, OutlineError, OutlineOptions, OutlineProblem, read_dxf_outline,
    read_svg_outline,
};
pub use recorder::{CsvRecorder, McapRecorder};
pub use row_json::{RowJsonError, read_row_json};
pub use scene::{
    NEW_SCENE, SceneEdit, SceneError, SceneProblem, SceneWayError, read_mounts, read_scene,
    scene_assumptions, scene_schema,
};
pub use truth_csv::{Truth, read_truth_csv, truth_columns, truth_of_columns, write_truth_csv};
pub use truth_json::{TruthFacts, TruthFactsError, read_truth_json, write_truth_json};
