//! A log as MCAP recordings of ROS 2 messages: [`read_bag`], [`read_log_mcap`], [`write_log_mcap`].
//!
//! `recording` takes the files apart into messages by topic, `message` and `pose_message` have their
//! types. `source` makes measurements of a topic, `transforms` of frames and `body` of a body's;
//! `planar` projects poses on the table, `rows` makes a log's rows. `topics` and `place` say which
//! topic is which.

mod body;
mod error;
mod message;
mod place;
mod planar;
mod pose_message;
mod read;
mod recording;
mod rows;
mod series;
mod source;
mod topics;
mod transforms;
mod write;

pub use error::{McapError, McapPlace, McapProblem};
pub use place::{Frames, Place};
pub use read::{BagOptions, read_bag, read_log_mcap};
pub use topics::{Topic, TopicError, TopicMapping, Topics};
pub use write::{McapWriteError, write_log_mcap};
