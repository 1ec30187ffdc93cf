//! A log as an MCAP recording of ROS 2 messages: [`read_log_mcap`], [`write_log_mcap`].
//!
//! `recording` takes the file apart into messages by topic, `message` has their types, `series`
//! makes measurements of them and `rows` a log's rows; `topics` says which topic is which.

mod error;
mod message;
mod read;
mod recording;
mod rows;
mod series;
mod topics;
mod write;

pub use error::{McapError, McapPlace, McapProblem};
pub use read::read_log_mcap;
pub use topics::{Topic, TopicError, TopicMapping, Topics};
pub use write::{McapWriteError, write_log_mcap};
