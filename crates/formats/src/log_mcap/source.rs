//! A topic of a bag with its messages: [`Source`].

use std::collections::BTreeMap;

use stickslip::PoseCovariance;
use stickslip_dynamics::Pose;

use crate::log_mcap::arrival::{self, Clock};
use crate::log_mcap::error::{McapError, McapPlace, McapProblem};
use crate::log_mcap::losses::Losses;
use crate::log_mcap::message::{Bool, Message, SECOND, Time, WrenchStamped, decode};
use crate::log_mcap::planar::{Tilt, ZAxis, is_missing, planar};
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
    /// Messages that are not in it.
    pub losses: Losses,
}

/// The readings of a sensor's topic.
pub(crate) struct TopicReadings<T> {
    /// By time.
    pub readings: Series<T>,
    /// Messages that are not in it.
    pub losses: Losses,
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
            if is_missing(&message.position, &message.orientation) {
                return Ok(None);
            }
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
            Ok(Some(Timed { time, value: pose }))
        })?;
        (found.poses, found.losses) = self.by_stamp(read)?;
        Ok(found)
    }

    /// Forces by stamp (N).
    pub(crate) fn forces(
        &self,
        frame: &mut CommonFrame,
    ) -> Result<TopicReadings<[f64; 2]>, McapError> {
        self.kind(&[WrenchStamped::TYPE])?;
        let read = self.read(|data| {
            let message: WrenchStamped = decode(data)?;
            let Some([x, y, _]) = finite_force(&message) else {
                return Ok(None);
            };
            frame.check(&message.header.frame_id, self.name, true)?;
            let time = stamp(&message.header.stamp)?;
            Ok(Some(Timed {
                time,
                value: [x, y],
            }))
        })?;
        let (readings, losses) = self.by_stamp(read)?;
        Ok(TopicReadings { readings, losses })
    }

    /// Touches of a sensor: readings by log time, since such messages have no stamp, or forces by
    /// stamp, of which those of `touch_force` (N) and more are touches.
    pub(crate) fn touches(&self, touch_force: f64) -> Result<TopicReadings<bool>, McapError> {
        if self.kind(&[Bool::TYPE, WrenchStamped::TYPE])? == WrenchStamped::TYPE {
            let read = self.read(|data| {
                let message: WrenchStamped = decode(data)?;
                let Some([x, y, z]) = finite_force(&message) else {
                    return Ok(None);
                };
                Ok(Some(Timed {
                    time: stamp(&message.header.stamp)?,
                    value: libm::hypot(libm::hypot(x, y), z) >= touch_force,
                }))
            })?;
            let (readings, losses) = self.by_stamp(read)?;
            return Ok(TopicReadings { readings, losses });
        }
        let mut readings: Series<bool> = Vec::with_capacity(self.content.messages.len());
        for raw in &self.content.messages {
            let message = decode(&raw.data).map_err(|problem| self.error(Some(raw), problem))?;
            let Bool { data: value } = message;
            let time = log_time(raw);
            readings.push(Timed { time, value });
        }
        let timed = self.content.messages.iter().map(|raw| (raw, log_time(raw)));
        let late = arrival::check(timed, Clock::LogTime);
        late.map_err(|(raw, problem)| self.error(Some(raw), problem))?;
        readings.sort_by_key(|touch| touch.time);
        Ok(TopicReadings {
            readings,
            losses: Losses::default(),
        })
    }

    /// All messages with a measurement, each taken apart by `take`.
    fn read<T>(
        &self,
        mut take: impl FnMut(&[u8]) -> Result<Option<Timed<T>>, McapProblem>,
    ) -> Result<Vec<FromMessage<'a, T>>, McapError> {
        let mut read = Vec::with_capacity(self.content.messages.len());
        for raw in &self.content.messages {
            let timed = take(&raw.data).map_err(|problem| self.error(Some(raw), problem))?;
            read.extend(timed.map(|timed| FromMessage { raw, timed }));
        }
        Ok(read)
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

    /// Sorted; two different messages with one stamp are an error, and so is a clock that jumps
    /// back.
    fn by_stamp<T>(
        &self,
        mut messages: Vec<FromMessage<'a, T>>,
    ) -> Result<(Series<T>, Losses), McapError> {
        let measured = messages.len();
        arrival::drop_unstamped(&mut messages, |message| message.timed.time);
        let stamps = messages
            .iter()
            .map(|message| (message.raw, message.timed.time));
        let late = arrival::check(stamps, Clock::Stamp);
        let late = late.map_err(|(raw, problem)| self.error(Some(raw), problem))?;
        let count = messages.len();
        messages.sort_by_key(|message| message.timed.time);
        messages.dedup_by(|a, b| a.timed.time == b.timed.time && a.raw.data == b.raw.data);
        let losses = Losses {
            unmeasured: self.content.messages.len() - measured,
            unstamped: measured - count,
            repeated: count - messages.len(),
            late,
            ..Losses::default()
        };
        if let Some([first, second]) = messages
            .array_windows()
            .find(|[a, b]| a.timed.time == b.timed.time)
        {
            let problem = McapProblem::SameStamp {
                stamp: seconds_text(second.timed.time),
                first: first.raw.number as usize,
            };
            return Err(self.error(Some(second.raw), problem));
        }
        let series = messages.into_iter().map(|message| message.timed);
        Ok((series.collect(), losses))
    }

    /// An error in a message, or in the whole topic.
    pub(crate) fn error(&self, message: Option<&RawMessage>, problem: McapProblem) -> McapError {
        let place = McapPlace {
            topic: self.name.to_owned(),
            message: message.map(|raw| (raw.number as usize, raw.log_time)),
        };
        let file = message.map_or(0, |raw| raw.file as usize);
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
        let found = frame_name(found);
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

/// Name of a frame without the slash that older programs put before it.
pub(crate) fn frame_name(name: &str) -> &str {
    name.strip_prefix('/').unwrap_or(name)
}

/// The time of a stamp (ns).
pub(crate) fn stamp(stamp: &Time) -> Result<i64, McapProblem> {
    match stamp.nanosec {
        found if i64::from(found) >= SECOND => Err(McapProblem::Nanoseconds { found }),
        _ => Ok(stamp.nanoseconds()),
    }
}

/// Time at which a message was recorded (ns).
fn log_time(raw: &RawMessage) -> i64 {
    i64::try_from(raw.log_time).unwrap_or(i64::MAX)
}

/// The force of a message (N); `None` where a number is not finite, so that none was measured.
fn finite_force(message: &WrenchStamped) -> Option<[f64; 3]> {
    let force = &message.force;
    let force = [force.x, force.y, force.z];
    force
        .iter()
        .all(|number| number.is_finite())
        .then_some(force)
}
