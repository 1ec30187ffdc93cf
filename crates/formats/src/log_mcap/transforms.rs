//! Transforms as `/tf` and `/tf_static` have them, and the way from one frame to another:
//! [`Transforms`].

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Isometry3, Quaternion as Rotation, Translation3, UnitQuaternion};

use crate::log_mcap::arrival::{self, Clock, Late};
use crate::log_mcap::error::{McapError, McapProblem};
use crate::log_mcap::losses::Losses;
use crate::log_mcap::message::{Message, Quaternion, Vector3, decode};
use crate::log_mcap::place::Frames;
use crate::log_mcap::planar::{check_pose, is_missing};
use crate::log_mcap::pose_message::{TfMessage, TransformStamped};
use crate::log_mcap::recording::RawMessage;
use crate::log_mcap::rows::BRIDGED;
use crate::log_mcap::series::{Series, Timed, seconds_text};
use crate::log_mcap::source::{Source, frame_name, stamp};

/// All transforms of a bag, by child and parent.
pub(crate) struct Transforms<'a> {
    moving: Source<'a>,
    links: BTreeMap<String, BTreeMap<String, Link<'a>>>,
}

/// Recorded transforms of a frame in its parent.
struct Link<'a> {
    source: Source<'a>,
    /// True if it is published once and for all.
    is_static: bool,
    samples: Vec<(&'a RawMessage, TransformStamped)>,
}

/// A frame in its parent, over time.
enum Motion {
    Static(Isometry3<f64>),
    Moving(Moving),
}

/// A frame that moves.
struct Moving {
    series: Series<Isometry3<f64>>,
    /// Transforms that are not in it.
    losses: Losses,
}

/// One link of a chain; `inverted` where the chain goes from parent to child.
struct Step {
    motion: Motion,
    inverted: bool,
}

/// Poses of a frame in another one.
pub(crate) struct Chain {
    /// Position and orientation at the stamps of the first link that moves.
    pub poses: Series<(Vector3, Quaternion)>,
    /// Transforms of that link without a pose.
    pub losses: Losses,
}

impl<'a> Transforms<'a> {
    /// All transforms of a topic and of its companion with those that never change.
    pub(crate) fn read(moving: Source<'a>, fixed: Option<Source<'a>>) -> Result<Self, McapError> {
        let mut links: BTreeMap<String, BTreeMap<String, Link<'a>>> = BTreeMap::new();
        for (source, is_static) in [(Some(moving), false), (fixed, true)] {
            let Some(source) = source else { continue };
            source.kind(&[TfMessage::TYPE])?;
            for raw in &source.content.messages {
                let message: TfMessage =
                    decode(&raw.data).map_err(|problem| source.error(Some(raw), problem))?;
                for transform in message.transforms {
                    let child = frame_name(&transform.child_frame_id).to_owned();
                    let parents = links.entry(child).or_default();
                    let parent = frame_name(&transform.header.frame_id).to_owned();
                    let link = parents.entry(parent).or_insert_with(|| Link {
                        source,
                        is_static,
                        samples: Vec::new(),
                    });
                    link.samples.push((raw, transform));
                }
            }
        }
        Ok(Self { moving, links })
    }

    /// Names of all frames.
    pub(crate) fn frames(&self) -> BTreeSet<&str> {
        let parents = self.links.values().flat_map(BTreeMap::keys);
        self.links
            .keys()
            .chain(parents)
            .map(String::as_str)
            .collect()
    }

    /// Frames that move in those above them.
    pub(crate) fn moving(&self) -> BTreeSet<&str> {
        let moves = |frame: &&str| {
            let line = self.ancestry(frame).unwrap_or_default();
            let mut links = line
                .array_windows()
                .map(|[child, parent]| &self.links[*child][*parent]);
            links.any(|link| !link.is_static)
        };
        self.frames().into_iter().filter(moves).collect()
    }

    /// Number of frames above one.
    pub(crate) fn depth(&self, frame: &str) -> usize {
        self.ancestry(frame).map_or(0, |line| line.len() - 1)
    }

    /// The poses of a frame in another one: at every stamp of the first link that moves on the way
    /// from the child, the others interpolated between neighbours at most 0.2 s apart.
    pub(crate) fn chain(&self, frames: &Frames) -> Result<Chain, McapError> {
        let steps = self.steps(frames)?;
        let moving = steps.iter().find_map(|step| match &step.motion {
            Motion::Moving(moving) => Some(moving),
            Motion::Static(_) => None,
        });
        let Some(moving) = moving else {
            let frames = frames.to_string();
            return Err(self.error(McapProblem::NothingMoves { frames }));
        };
        let mut chain = Chain {
            poses: Vec::with_capacity(moving.series.len()),
            losses: moving.losses,
        };
        for Timed { time, .. } in &moving.series {
            // from the child's frame outwards, so that each link is applied after those below it
            let pose = steps.iter().try_fold(Isometry3::identity(), |pose, step| {
                let link = step.motion.at(*time)?;
                Some(if step.inverted { link.inverse() } else { link } * pose)
            });
            match pose {
                Some(pose) => chain.poses.push(Timed {
                    time: *time,
                    value: parts(&pose),
                }),
                None => chain.losses.unlinked += 1,
            }
        }
        Ok(chain)
    }

    /// The links from the child up to the frame above both, and from there down to the parent.
    fn steps(&self, frames: &Frames) -> Result<Vec<Step>, McapError> {
        let (up, down) = (
            self.ancestry(&frames.child)?,
            self.ancestry(&frames.parent)?,
        );
        let meet = up.iter().position(|frame| down.contains(frame));
        let Some(meet) = meet else {
            return Err(self.error(McapProblem::NoChain {
                child: frames.child.clone(),
                parent: frames.parent.clone(),
                found: self.frames().iter().map(ToString::to_string).collect(),
            }));
        };
        let below = down.iter().take_while(|frame| **frame != up[meet]).count();
        let mut steps = Vec::new();
        for [child, parent] in up[..=meet].array_windows() {
            steps.push(self.step(child, parent, false)?);
        }
        for [child, parent] in down[..=below].array_windows().rev() {
            steps.push(self.step(child, parent, true)?);
        }
        Ok(steps)
    }

    /// A frame, its parent, the parent of that and so on.
    fn ancestry<'f>(&'f self, frame: &'f str) -> Result<Vec<&'f str>, McapError> {
        let mut line = vec![frame];
        while let Some(parents) = self.links.get(line[line.len() - 1]) {
            let mut names = parents.keys().map(String::as_str);
            let (Some(parent), second) = (names.next(), names.next()) else {
                break;
            };
            let other = second.or(Some(parent).filter(|parent| line.contains(parent)));
            if let Some(other) = other {
                return Err(self.error(McapProblem::TwoParents {
                    frame: line[line.len() - 1].to_owned(),
                    parents: [parent.to_owned(), other.to_owned()],
                }));
            }
            line.push(parent);
        }
        Ok(line)
    }

    fn step(&self, child: &str, parent: &str, inverted: bool) -> Result<Step, McapError> {
        let motion = self.links[child][parent].motion()?;
        Ok(Step { motion, inverted })
    }

    fn error(&self, problem: McapProblem) -> McapError {
        self.moving.error(None, problem)
    }
}

impl Link<'_> {
    /// The motion, every transform checked. One transform may be published several times.
    fn motion(&self) -> Result<Motion, McapError> {
        let mut samples = Vec::with_capacity(self.samples.len());
        for (raw, transform) in &self.samples {
            let wrong = |problem| self.source.error(Some(raw), problem);
            if !self.is_static && is_missing(&transform.translation, &transform.rotation) {
                continue;
            }
            check_pose(&transform.translation, &transform.rotation).map_err(wrong)?;
            let time = match self.is_static {
                true => 0,
                false => stamp(&transform.header.stamp).map_err(wrong)?,
            };
            samples.push((*raw, time, isometry(transform)));
        }
        let measured = samples.len();
        let mut late = Late::default();
        if !self.is_static {
            arrival::drop_unstamped(&mut samples, |(_, time, _)| *time);
            let stamps = samples.iter().map(|(raw, time, _)| (*raw, *time));
            let checked = arrival::check(stamps, Clock::Stamp);
            late = checked.map_err(|(raw, problem)| self.source.error(Some(raw), problem))?;
        }
        let count = samples.len();
        samples.sort_by_key(|(_, time, _)| *time);
        samples.dedup_by(|(_, a_time, a), (_, b_time, b)| a_time == b_time && a == b);
        let losses = Losses {
            unmeasured: self.samples.len() - measured,
            unstamped: measured - count,
            repeated: count - samples.len(),
            late,
            ..Losses::default()
        };
        let twice = samples.array_windows().find(|[a, b]| a.1 == b.1);
        if let Some([(first, ..), (second, time, _)]) = twice {
            let problem = match self.is_static {
                true => McapProblem::StaticMoved {
                    frame: self.samples[0].1.child_frame_id.clone(),
                    first: first.number as usize,
                },
                false => McapProblem::SameStamp {
                    stamp: seconds_text(*time),
                    first: first.number as usize,
                },
            };
            return Err(self.source.error(Some(second), problem));
        }
        let mut series = samples
            .into_iter()
            .map(|(_, time, value)| Timed { time, value });
        Ok(match series.next() {
            Some(only) if self.is_static => Motion::Static(only.value),
            first => Motion::Moving(Moving {
                series: first.into_iter().chain(series).collect(),
                losses,
            }),
        })
    }
}

impl Motion {
    /// Pose of the frame at a time (ns), if it is known.
    fn at(&self, time: i64) -> Option<Isometry3<f64>> {
        let series = match self {
            Self::Static(pose) => return Some(*pose),
            Self::Moving(moving) => &moving.series,
        };
        let after = series.partition_point(|pose| pose.time < time);
        let next = series.get(after)?;
        if next.time == time {
            return Some(next.value);
        }
        let before = series.get(after.checked_sub(1)?)?;
        let apart = next.time.saturating_sub(before.time);
        if apart > BRIDGED {
            return None;
        }
        let share = (time - before.time) as f64 / apart as f64;
        // half a turn from one sample to the next has no way between
        before.value.try_lerp_slerp(&next.value, share, 1e-9)
    }
}

fn isometry(transform: &TransformStamped) -> Isometry3<f64> {
    let (at, q) = (&transform.translation, &transform.rotation);
    Isometry3::from_parts(
        Translation3::new(at.x, at.y, at.z),
        UnitQuaternion::from_quaternion(Rotation::new(q.w, q.x, q.y, q.z)),
    )
}

fn parts(pose: &Isometry3<f64>) -> (Vector3, Quaternion) {
    let (at, q) = (&pose.translation, pose.rotation.quaternion());
    let position = Vector3 {
        x: at.x,
        y: at.y,
        z: at.z,
    };
    let orientation = Quaternion {
        x: q.i,
        y: q.j,
        z: q.k,
        w: q.w,
    };
    (position, orientation)
}
