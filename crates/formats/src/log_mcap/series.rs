//! The messages of one topic as measurements in the order of their times: [`Series`].

use std::f64::consts::{PI, TAU};

use stickslip::{Rule, Unit};
use stickslip_dynamics::Pose;

use crate::log_mcap::error::{McapError, McapPlace, McapProblem};
use crate::log_mcap::message::{
    Bool, Header, Message, PoseStamped, Quaternion, SECOND, WrenchStamped, decode,
};
use crate::log_mcap::recording::{Content, RawMessage};

/// How far a quaternion's length may be from 1.
const UNIT: f64 = 0.01;
/// Tilt from which a pose is not one in the plane (rad).
const TILTED: f64 = 5.0 * PI / 180.0;
/// Tilt from which a pose has no angle about the vertical (rad).
const UPSIDE_DOWN: f64 = 179.9 * PI / 180.0;
/// Encoding of all messages.
pub(crate) const ENCODING: &str = "cdr";

/// A measurement and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Timed<T> {
    /// Time (ns).
    pub time: i64,
    /// What was measured.
    pub value: T,
}

/// Measurements of one topic, times rising.
pub(crate) type Series<T> = Vec<Timed<T>>;

/// Poses that stand askew.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Tilt {
    /// How many are tilted by more than 5°.
    pub count: usize,
    /// Largest tilt (rad).
    pub largest: f64,
}

/// The frame that all poses and forces must be in.
#[derive(Clone, Debug, Default)]
pub(crate) struct CommonFrame(Option<(String, String)>);

/// A topic of a file, with its messages.
pub(crate) struct Source<'a> {
    /// Display name of the file.
    pub file: &'a str,
    /// Name of the topic.
    pub name: String,
    /// What it holds.
    pub content: &'a Content,
}

/// One message while it is read.
struct Numbered<T> {
    number: usize,
    log_time: u64,
    timed: Timed<T>,
}

impl Source<'_> {
    /// Poses by stamp, angles unwrapped, and how they are tilted.
    pub(crate) fn poses(&self, frame: &mut CommonFrame) -> Result<(Series<Pose>, Tilt), McapError> {
        let mut tilt = Tilt::default();
        let read = self.read(|message: PoseStamped| {
            frame.check(&message.header, &self.name, false)?;
            let (pose, leans) = planar(&message)?;
            tilt.count += usize::from(leans > TILTED);
            tilt.largest = if leans > tilt.largest {
                leans
            } else {
                tilt.largest
            };
            Ok(Timed {
                time: stamp(&message.header)?,
                value: pose,
            })
        })?;
        let mut poses = self.by_stamp(read)?;
        unwrap(&mut poses);
        Ok((poses, tilt))
    }

    /// Forces by stamp (N).
    pub(crate) fn forces(&self, frame: &mut CommonFrame) -> Result<Series<[f64; 2]>, McapError> {
        let read = self.read(|message: WrenchStamped| {
            frame.check(&message.header, &self.name, true)?;
            let force = &message.force;
            finite([
                ("force.x", force.x),
                ("force.y", force.y),
                ("force.z", force.z),
            ])?;
            Ok(Timed {
                time: stamp(&message.header)?,
                value: [force.x, force.y],
            })
        })?;
        self.by_stamp(read)
    }

    /// Readings by log time; such messages have no stamp.
    pub(crate) fn touches(&self) -> Result<Series<bool>, McapError> {
        let read = self.read(|message: Bool| {
            Ok(Timed {
                time: 0,
                value: message.data,
            })
        })?;
        let at = |log_time: u64| i64::try_from(log_time).unwrap_or(i64::MAX);
        let mut touches: Series<bool> = read
            .iter()
            .map(|m| Timed {
                time: at(m.log_time),
                value: m.timed.value,
            })
            .collect();
        touches.sort_by_key(|touch| touch.time);
        Ok(touches)
    }

    /// All messages, each taken apart by `take`.
    fn read<M: Message, T>(
        &self,
        mut take: impl FnMut(M) -> Result<Timed<T>, McapProblem>,
    ) -> Result<Vec<Numbered<T>>, McapError> {
        self.check_kinds(M::TYPE)?;
        let numbered =
            (1..)
                .zip(&self.content.messages)
                .map(|(number, raw): (usize, &RawMessage)| {
                    let timed = decode::<M>(&raw.data).and_then(&mut take);
                    let timed = timed
                        .map_err(|problem| self.error(Some((number, raw.log_time)), problem))?;
                    Ok(Numbered {
                        number,
                        log_time: raw.log_time,
                        timed,
                    })
                });
        numbered.collect()
    }

    fn check_kinds(&self, expected: &'static str) -> Result<(), McapError> {
        for kind in &self.content.kinds {
            if kind.encoding != ENCODING {
                return Err(self.error(
                    None,
                    McapProblem::WrongEncoding {
                        found: kind.encoding.clone(),
                    },
                ));
            }
            if kind.schema != expected {
                let found = if kind.schema.is_empty() {
                    "without a type".to_owned()
                } else {
                    kind.schema.clone()
                };
                return Err(self.error(None, McapProblem::WrongType { found, expected }));
            }
        }
        Ok(())
    }

    /// Sorted; two messages with one stamp are an error.
    fn by_stamp<T>(&self, mut messages: Vec<Numbered<T>>) -> Result<Series<T>, McapError> {
        messages.sort_by_key(|message| message.timed.time);
        if let Some([first, second]) = messages
            .array_windows()
            .find(|[a, b]| a.timed.time == b.timed.time)
        {
            let stamp = seconds_text(second.timed.time);
            let problem = McapProblem::SameStamp {
                stamp,
                first: first.number,
            };
            return Err(self.error(Some((second.number, second.log_time)), problem));
        }
        Ok(messages.into_iter().map(|message| message.timed).collect())
    }

    fn error(&self, message: Option<(usize, u64)>, problem: McapProblem) -> McapError {
        let place = Some(McapPlace {
            topic: self.name.clone(),
            message,
        });
        McapError {
            file: self.file.to_owned(),
            place,
            problem: Box::new(problem),
        }
    }
}

impl CommonFrame {
    /// Takes the first frame, and compares the others with it.
    fn check(&mut self, header: &Header, topic: &str, wrench: bool) -> Result<(), McapProblem> {
        let (expected, of) = self
            .0
            .get_or_insert_with(|| (header.frame_id.clone(), topic.to_owned()));
        if header.frame_id == *expected {
            return Ok(());
        }
        Err(McapProblem::Frame {
            found: header.frame_id.clone(),
            expected: expected.clone(),
            of: of.clone(),
            wrench,
        })
    }
}

/// A time (ns) in seconds, without rounding.
pub(crate) fn seconds_text(time: i64) -> String {
    let sign = if time < 0 { "-" } else { "" };
    let (whole, part) = (
        time.unsigned_abs() / SECOND.unsigned_abs(),
        time.unsigned_abs() % SECOND.unsigned_abs(),
    );
    format!("{sign}{whole}.{part:09}")
}

fn stamp(header: &Header) -> Result<i64, McapProblem> {
    match header.stamp.nanosec {
        found if i64::from(found) >= SECOND => Err(McapProblem::Nanoseconds { found }),
        _ => Ok(header.stamp.nanoseconds()),
    }
}

fn finite<const N: usize>(numbers: [(&'static str, f64); N]) -> Result<(), McapProblem> {
    match numbers.into_iter().find(|(_, number)| !number.is_finite()) {
        Some((field, found)) => Err(McapProblem::NotFinite { field, found }),
        None => Ok(()),
    }
}

/// The pose in the plane, its angle 2 atan2(q_z, q_w) in [−π, π), and the angle between its z-axis
/// and the vertical (rad).
fn planar(message: &PoseStamped) -> Result<(Pose, f64), McapProblem> {
    let (at, q) = (&message.position, &message.orientation);
    finite([
        ("position.x", at.x),
        ("position.y", at.y),
        ("position.z", at.z),
    ])?;
    for (field, found) in [("position.x", at.x), ("position.y", at.y)] {
        if let Some(rule) = Rule::Finite.broken_by(found, Unit::Metre) {
            return Err(McapProblem::OutOfRange { field, found, rule });
        }
    }
    finite([
        ("orientation.x", q.x),
        ("orientation.y", q.y),
        ("orientation.z", q.z),
        ("orientation.w", q.w),
    ])?;
    let tilt = tilt(q)?;
    Ok((
        Pose::new(at.x, at.y, wrapped(2.0 * libm::atan2(q.z, q.w))),
        tilt,
    ))
}

fn tilt(q: &Quaternion) -> Result<f64, McapProblem> {
    let (aside, upright) = (libm::hypot(q.x, q.y), libm::hypot(q.z, q.w));
    let length = libm::hypot(aside, upright);
    if (length - 1.0).abs() > UNIT {
        return Err(McapProblem::NotUnit { found: length });
    }
    let tilt = 2.0 * libm::atan2(aside, upright);
    if tilt > UPSIDE_DOWN {
        Err(McapProblem::UpsideDown)
    } else {
        Ok(tilt)
    }
}

/// The angle in [−π, π) that equals `angle` on the circle (rad); an angle in there keeps its bits.
fn wrapped(angle: f64) -> f64 {
    angle - TAU * ((angle + PI) / TAU).floor()
}

/// Adds full turns so that no angle is more than half a turn from the one before.
fn unwrap(poses: &mut [Timed<Pose>]) {
    let mut turns = 0.0;
    let mut before = poses.first().map_or(0.0, |pose| pose.value.theta);
    for pose in poses {
        let theta = pose.value.theta;
        turns -= ((theta - before + PI) / TAU).floor();
        before = theta;
        pose.value.theta = theta + TAU * turns;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unwrap_turns_on_over_half_a_turn() {
        let pose = |theta| Timed {
            time: 0,
            value: Pose::new(0.0, 0.0, theta),
        };
        let mut poses = [3.0, -3.0, 3.0, 0.0, -3.0, 2.0].map(pose);
        unwrap(&mut poses);
        let expected = [3.0, TAU - 3.0, 3.0, 0.0, -3.0, 2.0 - TAU];
        for (pose, expected) in poses.iter().zip(expected) {
            assert!(
                (pose.value.theta - expected).abs() < 1e-15,
                "{}",
                pose.value.theta
            );
        }
    }

    #[test]
    fn wrapped_keeps_angles_in_half_a_turn_and_takes_full_turns_away() {
        assert_eq!([-3.0, 0.0, 1e-9, 3.0].map(wrapped), [-3.0, 0.0, 1e-9, 3.0]);
        assert_eq!(wrapped(4.0), 4.0 - TAU);
        assert_eq!(wrapped(-4.0), TAU - 4.0);
    }

    #[test]
    fn seconds_text_keeps_every_nanosecond() {
        assert_eq!(
            seconds_text(1_700_000_000_000_000_001),
            "1700000000.000000001"
        );
        assert_eq!(seconds_text(-1), "-0.000000001");
    }
}
