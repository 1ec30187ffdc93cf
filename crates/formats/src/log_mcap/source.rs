//! A topic of a bag with its messages: [`Source`].

use std::collections::BTreeMap;

use stickslip::PoseCovariance;
use stickslip_dynamics::Pose;

use crate::log_mcap::error::{McapError, McapPlace, McapProblem};
use crate::log_mcap::message::{Bool, Message, SECOND, Time, WrenchStamped, decode};
use crate::log_mcap::planar::{Tilt, ZAxis, finite, planar};
use crate::log_mcap::pose_message::{PoseKind, TfMessage, ToldNoise};
use crate::log_mcap::recording::{Content, RawMessage};
use crate::log_mcap::series::{Series, Timed, seconds_text};

/// Encoding of all messages.
pub(crate) const ENCODING: &str = "cdr";

/// The frame that all poses and forces must be in.
#[derive(Clone, Debug, Default)]
pub(crate) struct CommonFrame(Option<(String, String)>);

/// A topic of a bag, with its messages.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    /// Display names of the bag's files.
    pub files: &'a [String],
    /// Name of the topic.
    pub name: &'a str,
    /// Its content.
    pub content: &'a Content,
}

/// The poses of a topic.
#[derive(Default)]
pub(crate) struct TopicPoses {
    /// By stamp, angles in [−π, π).
    pub poses: Series<Pose>,
    /// Tilt of the frame.
    pub tilt: Tilt,
    /// Covariances of the poses, by stamp (ns), where their messages have one.
    pub covariances: BTreeMap<i64, PoseCovariance>,
    /// Number of messages whose numbers are no covariance.
    pub impossible: usize,
}

/// A measurement with the message that it is from.
#[derive(Clone, Copy)]
pub(crate) struct FromMessage<'a, T> {
    /// The message.
    pub raw: &'a RawMessage,
    /// The measurement.
    pub timed: Timed<T>,
}

impl<'a> Source<'a> {
    /// Poses by stamp, angles in [−π, π), with the tilt and noise in their messages.
    pub(crate) fn poses(&self, frame: &mut CommonFrame) -> Result<TopicPoses, McapError> {
        let schema = self.kind(&PoseKind::TYPES)?;
        let mut found = TopicPoses::default();
        let Some(kind) = PoseKind::of(schema) else {
            return Ok(found);
        };
        let read = self.read(|data| {
            let message = kind.decode(data)?;
            frame.check(&message.header.frame_id, self.name, false)?;
            let (pose, leans) = planar(&message.position, &message.orientation, ZAxis::Up)?;
            found.tilt.add(leans);
            let time = stamp(&message.header.stamp)?;
            match message.noise {
                ToldNoise::Known(covariance) => {
                    found.covariances.insert(time, covariance);
                }
                ToldNoise::Impossible => found.impossible += 1,
                ToldNoise::Unknown => {}
            }
            Ok(Timed { time, value: pose })
        })?;
        found.poses = self.by_stamp(read)?;
        Ok(found)
    }

    /// Forces by stamp (N).
    pub(crate) fn forces(&self, frame: &mut CommonFrame) -> Result<Series<[f64; 2]>, McapError> {
        self.kind(&[WrenchStamped::TYPE])?;
        let read = self.read(|data| {
            let message: WrenchStamped = decode(data)?;
            frame.check(&message.header.frame_id, self.name, true)?;
            let force = finite_force(&message)?;
            Ok(Timed {
                time: stamp(&message.header.stamp)?,
                value: [force[0], force[1]],
            })
        })?;
        self.by_stamp(read)
    }

    /// Touches of a sensor: readings by log time, since such messages have no stamp, or forces by
    /// stamp, of which those of `touch_force` (N) and more are touches.
    pub(crate) fn touches(&self, touch_force: f64) -> Result<Series<bool>, McapError> {
        if self.kind(&[Bool::TYPE, WrenchStamped::TYPE])? == WrenchStamped::TYPE {
            let read = self.read(|data| {
                let message: WrenchStamped = decode(data)?;
                let [x, y, z] = finite_force(&message)?;
                Ok(Timed {
                    time: stamp(&message.header.stamp)?,
                    value: libm::hypot(libm::hypot(x, y), z) >= touch_force,
                })
            })?;
            return self.by_stamp(read);
        }
        let read = self.read(|data| {
            let Bool { data: value } = decode(data)?;
            Ok(Timed { time: 0, value })
        })?;
        let at = |message: &FromMessage<'_, bool>| Timed {
            time: i64::try_from(message.raw.log_time).unwrap_or(i64::MAX),
            value: message.timed.value,
        };
        let mut touches: Series<bool> = read.iter().map(at).collect();
        touches.sort_by_key(|touch| touch.time);
        Ok(touches)
    }

    /// All messages, each taken apart by `take`.
    pub(crate) fn read<T>(
        &self,
        mut take: impl FnMut(&[u8]) -> Result<Timed<T>, McapProblem>,
    ) -> Result<Vec<FromMessage<'a, T>>, McapError> {
        let read = |raw: &'a RawMessage| {
            let timed = take(&raw.data).map_err(|problem| self.error(Some(raw), problem))?;
            Ok(FromMessage { raw, timed })
        };
        self.content.messages.iter().map(read).collect()
    }

    /// The type of all messages, which must be one of `expected`; that of no message is the first.
    pub(crate) fn kind(&self, expected: &[&'static str]) -> Result<&'a str, McapError> {
        let mut first = None;
        for kind in &self.content.kinds {
            if kind.encoding != ENCODING {
                let found = kind.encoding.clone();
                return Err(self.error(None, McapProblem::WrongEncoding { found }));
            }
            let is_first = *first.get_or_insert(&kind.schema) == &kind.schema;
            if is_first && expected.contains(&kind.schema.as_str()) {
                continue;
            }
            if kind.schema == TfMessage::TYPE {
                return Err(self.error(None, McapProblem::FramesNeeded));
            }
            if kind.schema.ends_with("/AprilTagDetectionArray") {
                return Err(self.error(None, McapProblem::Detections));
            }
            let found = match kind.schema.as_str() {
                "" => "without a type".to_owned(),
                schema => schema.to_owned(),
            };
            let expected = match first.filter(|_| !is_first) {
                Some(first) => first.clone(),
                None => expected.join(" or "),
            };
            return Err(self.error(None, McapProblem::WrongType { found, expected }));
        }
        Ok(first.map_or(expected[0], String::as_str))
    }

    /// Sorted; two messages with one stamp are an error.
    pub(crate) fn by_stamp<T>(
        &self,
        mut messages: Vec<FromMessage<'a, T>>,
    ) -> Result<Series<T>, McapError> {
        messages.sort_by_key(|message| message.timed.time);
        if let Some([first, second]) = messages
            .array_windows()
            .find(|[a, b]| a.timed.time == b.timed.time)
        {
            let problem = McapProblem::SameStamp {
                stamp: seconds_text(second.timed.time),
                first: first.raw.number,
            };
            return Err(self.error(Some(second.raw), problem));
        }
        Ok(messages.into_iter().map(|message| message.timed).collect())
    }

    /// An error in a message, or in the whole topic.
    pub(crate) fn error(&self, message: Option<&RawMessage>, problem: McapProblem) -> McapError {
        let place = McapPlace {
            topic: self.name.to_owned(),
            message: message.map(|raw| (raw.number, raw.log_time)),
        };
        let file = message.map_or(0, |raw| raw.file);
        McapError {
            file: self.files.get(file).cloned().unwrap_or_default(),
            place: Some(place),
            problem: Box::new(problem),
        }
    }
}

impl CommonFrame {
    /// Takes the first frame, and compares the others with it.
    pub(crate) fn check(
        &mut self,
        found: &str,
        topic: &str,
        wrench: bool,
    ) -> Result<(), McapProblem> {
        let (expected, of) = self
            .0
            .get_or_insert_with(|| (found.to_owned(), topic.to_owned()));
        if found == *expected {
            return Ok(());
        }
        Err(McapProblem::Frame {
            found: found.to_owned(),
            expected: expected.clone(),
            of: of.clone(),
            wrench,
        })
    }
}

/// The time of a stamp (ns).
pub(crate) fn stamp(stamp: &Time) -> Result<i64, McapProblem> {
    match stamp.nanosec {
        found if i64::from(found) >= SECOND => Err(McapProblem::Nanoseconds { found }),
        _ => Ok(stamp.nanoseconds()),
    }
}

fn finite_force(message: &WrenchStamped) -> Result<[f64; 3], McapProblem> {
    let force = &message.force;
    finite([
        ("force.x", force.x),
        ("force.y", force.y),
        ("force.z", force.z),
    ])?;
    Ok([force.x, force.y, force.z])
}
