//! From a log to a recording: [`write_log_mcap`].

use std::collections::BTreeMap;
use std::io::{Seek, Write};
use std::iter::once;

use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};
use stickslip::{Log, PoseCovariance};
use stickslip_dynamics::Pose;

use crate::log_csv::assert_equal_columns;
use crate::log_mcap::message::{
    Bool, Header, PoseStamped, Quaternion, SECOND, Time, Vector3, WrenchStamped, WrittenMessage,
    encode,
};
use crate::log_mcap::pose_message::{PoseWithCovarianceStamped, spatial_covariance};
use crate::log_mcap::source::ENCODING;
use crate::log_mcap::topics::{Topic, Topics};

/// Frame of all poses and forces.
const FRAME: &str = "world";
/// Size of a chunk (bytes); a file that is cut off loses at most one.
const CHUNK: u64 = 1 << 16;

/// Reason why a log was not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum McapWriteError {
    /// A time that no stamp holds.
    #[error("row {row} is at {time} s; ROS 2 stamps hold 0 to 2147483647 s. Shift the log's times")]
    Time {
        /// The row, from 0.
        row: usize,
        /// Its time (s).
        time: f64,
    },
    /// Two rows with one stamp.
    #[error(
        "row {row} is at {time} s, less than a nanosecond after the row before; stamps hold whole nanoseconds. Leave one of them out"
    )]
    SameStamp {
        /// The later row, from 0.
        row: usize,
        /// Its time (s).
        time: f64,
    },
    /// A topic with frames.
    #[error(
        "{0} is mapped to frames of transforms, and poses are written as PoseStamped. Map it to a topic"
    )]
    Frames(Topic),
    /// The writer failed.
    #[error("the recording cannot be written: {0}")]
    Output(#[source] Box<dyn std::error::Error + Send + Sync>),
}

impl From<std::io::Error> for McapWriteError {
    fn from(error: std::io::Error) -> Self {
        Self::Output(error.into())
    }
}

impl From<mcap::McapError> for McapWriteError {
    fn from(error: mcap::McapError) -> Self {
        match error {
            mcap::McapError::Io(error) => error.into(),
            other => Self::Output(other.into()),
        }
    }
}

/// Writes a log as an MCAP recording of ROS 2 messages. Poses are `geometry_msgs/msg/PoseStamped`,
/// the object's `PoseWithCovarianceStamped` where the log has covariances (zeros in rows without).
/// Tactile readings are `std_msgs/msg/Bool`, forces `geometry_msgs/msg/WrenchStamped`. All are in
/// the frame `world` and at their row's time, rounded to nanoseconds. An empty cell is no message.
/// Equal logs give equal bytes.
///
/// Reading by [`crate::read_log_mcap`] loses rows without any cell.
///
/// # Errors
/// A time that a stamp cannot hold, two rows within a nanosecond, or what `writer` says. After the
/// last nothing useful is written.
///
/// # Panics
/// If the columns differ in length.
pub fn write_log_mcap(
    writer: impl Write + Seek,
    log: &Log,
    topics: &Topics,
) -> Result<(), McapWriteError> {
    assert_equal_columns(log);
    let stamps = stamps(&log.time)?;
    let mut messages = LogMessages::new(writer, log, topics)?;
    for (row, stamp) in stamps.into_iter().enumerate() {
        messages.write_row(log, row, stamp)?;
    }
    messages.finish()
}

/// The messages of logs while they are written, a topic per column.
pub(crate) struct LogMessages<W: Write + Seek> {
    recorder: Recorder<W>,
    object: Option<u16>,
    /// Of the pusher, then of each other finger.
    fingers: Vec<Option<u16>>,
    touches: Vec<Option<u16>>,
    wrench: Option<u16>,
}

impl<W: Write + Seek> LogMessages<W> {
    /// Begins a recording with a channel for each column that `log` has.
    pub(crate) fn new(writer: W, log: &Log, topics: &Topics) -> Result<Self, McapWriteError> {
        // plain: a log whose end is lost can then be read up to there by any tool
        let mut recorder = Recorder::new(writer, None)?;
        let object = match log.object_covariance.is_empty() {
            true => recorder.channel::<PoseStamped>(topics, Topic::Object)?,
            false => recorder.channel::<PoseWithCovarianceStamped>(topics, Topic::Object)?,
        };
        let fingers = once(Topic::Pusher)
            .chain((1..=log.other_fingers.len()).map(Topic::Finger))
            .map(|finger| recorder.channel::<PoseStamped>(topics, finger))
            .collect::<Result<Vec<_>, _>>()?;
        let touches = (1..=log.tactile.len())
            .map(|k| recorder.channel::<Bool>(topics, Topic::Fixel(k)))
            .collect::<Result<Vec<_>, _>>()?;
        let wrench = if log.force.is_empty() {
            None
        } else {
            recorder.channel::<WrenchStamped>(topics, Topic::Wrench)?
        };
        Ok(Self {
            recorder,
            object,
            fingers,
            touches,
            wrench,
        })
    }

    /// Writes all rows of a log with those columns.
    pub(crate) fn write(&mut self, log: &Log) -> Result<(), McapWriteError> {
        for (row, stamp) in stamps(&log.time)?.into_iter().enumerate() {
            self.write_row(log, row, stamp)?;
        }
        Ok(())
    }

    /// Writes a message for each cell of a row that is not empty.
    fn write_row(&mut self, log: &Log, row: usize, stamp: i64) -> Result<(), McapWriteError> {
        let pose = |pose: Pose| pose_message(stamp, pose);
        let recorder = &mut self.recorder;
        match log.object_covariance.get(row) {
            None => recorder.write(self.object, stamp, log.object[row].map(pose))?,
            Some(own) => {
                let noisy =
                    log.object[row].map(|pose| noisy_pose_message(stamp, pose, own.as_ref()));
                recorder.write(self.object, stamp, noisy)?;
            }
        }
        for (channel, poses) in self.fingers.iter().zip(log.fingers()) {
            recorder.write(*channel, stamp, poses[row].map(pose))?;
        }
        for (channel, column) in self.touches.iter().zip(&log.tactile) {
            recorder.write(*channel, stamp, column[row].map(|data| Bool { data }))?;
        }
        let force = log.force.get(row).copied().flatten();
        let force = force.map(|force| force_message(stamp, force));
        recorder.write(self.wrench, stamp, force)
    }

    /// Ends the chunk at hand and writes it.
    pub(crate) fn flush(&mut self) -> Result<(), McapWriteError> {
        Ok(self.recorder.0.flush()?)
    }

    /// Ends the recording.
    pub(crate) fn finish(self) -> Result<(), McapWriteError> {
        self.recorder.finish()
    }
}

/// Times of the rows (ns), each one that a stamp holds, rising.
pub(crate) fn stamps(time: &[f64]) -> Result<Vec<i64>, McapWriteError> {
    let mut stamps: Vec<i64> = Vec::with_capacity(time.len());
    for (row, &time) in time.iter().enumerate() {
        let stamp = (time * SECOND as f64).round() as i64;
        if !time.is_finite() || time < 0.0 || Time::of(stamp).is_none() {
            return Err(McapWriteError::Time { row, time });
        }
        if stamps.last().is_some_and(|before| *before >= stamp) {
            return Err(McapWriteError::SameStamp { row, time });
        }
        stamps.push(stamp);
    }
    Ok(stamps)
}

/// A recording while it is written.
pub(crate) struct Recorder<W: Write + Seek>(Writer<W>);

impl<W: Write + Seek> Recorder<W> {
    /// Begins a recording whose chunks may be packed.
    pub(crate) fn new(writer: W, compression: Option<Compression>) -> Result<Self, McapWriteError> {
        let options = WriteOptions::new()
            .compression(compression)
            .profile("ros2")
            .library("stickslip")
            .chunk_size(Some(CHUNK));
        Ok(Self(options.create(writer)?))
    }

    /// A topic of the recording; `None` for one that is left out.
    fn channel<M: WrittenMessage>(
        &mut self,
        topics: &Topics,
        topic: Topic,
    ) -> Result<Option<u16>, McapWriteError> {
        let name = match topics.places(topic).first() {
            None => return Ok(None),
            Some(place) if place.frames.is_some() => return Err(McapWriteError::Frames(topic)),
            Some(place) => place.topic.clone(),
        };
        Ok(Some(self.topic::<M>(&name)?))
    }

    /// A topic by its name.
    pub(crate) fn topic<M: WrittenMessage>(&mut self, name: &str) -> Result<u16, McapWriteError> {
        let schema = self
            .0
            .add_schema(M::TYPE, "ros2msg", M::SCHEMA.as_bytes())?;
        let metadata = BTreeMap::from([("offered_qos_profiles".to_owned(), String::new())]);
        Ok(self.0.add_channel(schema, name, ENCODING, &metadata)?)
    }

    /// Ends the recording.
    pub(crate) fn finish(mut self) -> Result<(), McapWriteError> {
        self.0.finish()?;
        Ok(())
    }

    /// Writes a message, if there is one.
    pub(crate) fn write<M: WrittenMessage>(
        &mut self,
        channel: Option<u16>,
        stamp: i64,
        message: Option<M>,
    ) -> Result<(), McapWriteError> {
        let Some((channel_id, message)) = channel.zip(message) else {
            return Ok(());
        };
        let time = stamp.unsigned_abs();
        let header = MessageHeader {
            channel_id,
            sequence: 0,
            log_time: time,
            publish_time: time,
        };
        Ok(self.0.write_to_known_channel(&header, &encode(&message))?)
    }
}

/// The header of a message in the common frame at a time (ns).
pub(crate) fn header(stamp: i64) -> Header {
    let Some(stamp) = Time::of(stamp) else {
        panic!("{stamp} ns was checked")
    };
    Header {
        stamp,
        frame_id: FRAME.to_owned(),
    }
}

fn pose_message(stamp: i64, pose: Pose) -> PoseStamped {
    let (position, orientation) = pose_parts(pose);
    PoseStamped {
        header: header(stamp),
        position,
        orientation,
    }
}

fn noisy_pose_message(
    stamp: i64,
    pose: Pose,
    own: Option<&PoseCovariance>,
) -> PoseWithCovarianceStamped {
    let (position, orientation) = pose_parts(pose);
    PoseWithCovarianceStamped {
        header: header(stamp),
        position,
        orientation,
        covariance: own.map_or([[0.0; 6]; 6], spatial_covariance),
    }
}

/// A pose on the table in space.
pub(crate) fn pose_parts(pose: Pose) -> (Vector3, Quaternion) {
    let (z, w) = libm::sincos(pose.theta / 2.0);
    let position = Vector3 {
        x: pose.x,
        y: pose.y,
        z: 0.0,
    };
    let orientation = Quaternion {
        x: 0.0,
        y: 0.0,
        z,
        w,
    };
    (position, orientation)
}

fn force_message(stamp: i64, force: [f64; 2]) -> WrenchStamped {
    WrenchStamped {
        header: header(stamp),
        force: Vector3 {
            x: force[0],
            y: force[1],
            z: 0.0,
        },
        torque: Vector3::default(),
    }
}
