//! A log as MCAP recordings of ROS 2 messages: [`read_bag`], [`read_log_mcap`], [`write_log_mcap`].
//!
//! `recording` takes the files apart into messages by topic, `records` into records, `message` and `pose_message` have their
//! types. `source` makes measurements of a topic, `transforms` of frames and `body` of a body's;
//! `planar` projects poses on the table, `rows` makes a log's rows. `topics` and `place` say which
//! topic is which. `info` looks at a whole bag, `suggestion` which of its topics would do.

mod body;
mod error;
mod estimate;
mod info;
mod message;
mod output_message;
mod place;
mod planar;
mod pose_message;
mod read;
mod recording;
mod records;
mod rows;
mod series;
mod source;
mod suggestion;
mod topics;
mod transforms;
mod write;

pub use error::{McapError, McapPlace, McapProblem};
pub use estimate::{write_estimate_mcap, write_estimate_tum};
pub use info::{BagInfo, PosesInfo, TopicInfo, read_bag_info};
pub use place::{Frames, Place};
pub use read::{BagOptions, read_bag, read_log_mcap};
pub use topics::{Topic, TopicError, TopicMapping, Topics};
pub(crate) use write::LogMessages;
pub use write::{McapWriteError, write_log_mcap};
