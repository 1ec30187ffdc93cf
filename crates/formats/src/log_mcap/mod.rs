//! A log as MCAP recordings of ROS 2 messages: [`read_bag`], [`read_log_mcap`], [`write_log_mcap`].
//!
//! - `records` takes the files apart into records, `messages` into messages; `recording` keeps
//!   those of the needed topics.
//! - `message`, `pose_message` and `image_message` have the types of messages.
//! - `source` makes measurements of a topic, `transforms` of frames and `body` of a body's.
//! - `planar` projects poses on the table, `rows` makes a log's rows.
//! - `topics` and `place` say which topic is which.
//! - `arrival` finds clocks that jump back, `losses` counts what a series lacks.
//! - `sensors` fills in touches and forces.
//! - `images` shows images one by one, by their `camera_topics`.
//! - `part` chooses messages by log time.
//! - `info` describes a whole bag, `suggestion` names those of its topics that would do.
//! - `estimate` writes estimates, its bodies by `drawing`, in messages of `output_message`.

mod arrival;
mod body;
mod camera_topics;
mod drawing;
mod error;
mod estimate;
mod image_message;
mod images;
mod info;
mod losses;
mod message;
mod messages;
mod output_message;
mod part;
mod place;
mod planar;
mod pose_message;
mod read;
mod recording;
mod records;
mod rows;
mod sensors;
mod series;
mod source;
mod suggestion;
mod topics;
mod transforms;
mod write;

pub use camera_topics::{CameraMapping, CameraTopics};
pub use error::{McapError, McapPlace, McapProblem};
pub use estimate::{write_estimate_mcap, write_estimate_tum};
pub use image_message::{BagCameraInfo, BagImage, BagPicture};
pub use images::{CameraRecording, read_bag_camera_info, read_bag_images};
pub use info::{BagInfo, PosesInfo, TopicInfo, read_bag_info};
pub use part::{BagPart, LogTime, LogTimeError};
pub use place::{Frames, Place};
pub use read::{BagOptions, read_bag, read_log_mcap};
pub use sensors::Readings;
pub use topics::{Topic, TopicError, TopicMapping, Topics};
pub(crate) use write::LogMessages;
pub use write::{McapWriteError, write_log_mcap};
