//! Poses of a body, from its topic or from the frames of its tags: [`BodyPoses`].

use std::collections::BTreeMap;

use stickslip::PoseCovariance;
use stickslip_dynamics::Pose;

use crate::log_mcap::error::{McapError, McapProblem};
use crate::log_mcap::losses::Losses;
use crate::log_mcap::place::Frames;
use crate::log_mcap::planar::{Tilt, ZAxis, planar, wrapped};
use crate::log_mcap::rows::MERGED;
use crate::log_mcap::series::{Series, Timed, unwrap};
use crate::log_mcap::source::{CommonFrame, Source, TopicPoses};
use crate::log_mcap::topics::Topic;
use crate::log_mcap::transforms::Transforms;
use crate::mounts::body_of;

/// Poses of a body from one place.
pub(crate) struct BodyPoses {
    /// Poses by stamp, angles in [−π, π).
    pub poses: Series<Pose>,
    /// Tilt of the frame that was seen.
    pub tilt: Tilt,
    /// Messages without a pose.
    pub losses: Losses,
    /// Covariances of the poses, by stamp (ns), where the messages have one.
    pub covariances: BTreeMap<i64, PoseCovariance>,
    /// Number of messages whose numbers are no covariance.
    pub impossible: usize,
}

/// A body whose tags are mounted as the scene says.
pub(crate) struct TaggedBody<'a> {
    /// The body.
    pub body: Topic,
    /// Poses of the tags on it.
    pub mounts: &'a BTreeMap<String, Pose>,
    /// Number of frames that are mapped to it.
    pub frames: usize,
}

impl BodyPoses {
    /// The poses of a whole topic.
    pub(crate) fn of_topic(
        source: &Source<'_>,
        frame: &mut CommonFrame,
    ) -> Result<Self, McapError> {
        let TopicPoses {
            poses,
            tilt,
            covariances,
            impossible,
            losses,
        } = source.poses(frame)?;
        Ok(Self {
            poses,
            tilt,
            losses,
            covariances,
            impossible,
        })
    }

    /// The poses of a body by one of its frames.
    pub(crate) fn of_frames(
        source: &Source<'_>,
        transforms: &Transforms<'_>,
        frames: &Frames,
        body: &TaggedBody<'_>,
    ) -> Result<Self, McapError> {
        let whole = |problem| source.error(None, problem);
        let mount = body.mount(&frames.child).map_err(whole)?;
        let chain = transforms.chain(frames)?;
        let mut tilt = Tilt::default();
        let mut poses = Vec::with_capacity(chain.poses.len());
        for Timed { time, value } in chain.poses {
            let (tag, leans) = planar(&value.0, &value.1, ZAxis::UpOrDown).map_err(whole)?;
            tilt.add(leans);
            let pose = body_of(tag, mount);
            let theta = wrapped(pose.theta);
            poses.push(Timed {
                time,
                value: Pose { theta, ..pose },
            });
        }
        Ok(Self {
            poses,
            tilt,
            losses: chain.losses,
            covariances: BTreeMap::new(),
            impossible: 0,
        })
    }
}

impl TaggedBody<'_> {
    /// Pose of a frame's tag on the body: in its origin if it is the only one and the scene says
    /// nothing.
    fn mount(&self, frame: &str) -> Result<Pose, McapProblem> {
        match self.mounts.get(frame) {
            Some(mount) => Ok(*mount),
            None if self.mounts.is_empty() && self.frames == 1 => Ok(Pose::default()),
            None => Err(McapProblem::UnknownTag {
                frame: frame.to_owned(),
                body: self.body,
                found: self.mounts.keys().cloned().collect(),
            }),
        }
    }
}

/// The poses of several places as one series, angles unwrapped: poses of different places within 1
/// ms are one pose, their mean.
pub(crate) fn joined(places: Vec<Series<Pose>>) -> Series<Pose> {
    let mut all: Vec<(usize, Timed<Pose>)> = Vec::new();
    for (place, series) in places.into_iter().enumerate() {
        all.extend(series.into_iter().map(|pose| (place, pose)));
    }
    all.sort_by_key(|(place, pose)| (pose.time, *place));
    let mut joined = Vec::with_capacity(all.len());
    let mut rest = all.as_slice();
    while let Some((_, first)) = rest.first() {
        let together = (1..rest.len())
            .find(|next| {
                let (place, pose) = &rest[*next];
                pose.time.saturating_sub(first.time) > MERGED
                    || rest[..*next].iter().any(|(other, _)| other == place)
            })
            .unwrap_or(rest.len());
        joined.push(mean(&rest[..together]));
        rest = &rest[together..];
    }
    unwrap(&mut joined);
    joined
}

/// The mean of poses, at the time of the first; one alone keeps its bits.
fn mean(poses: &[(usize, Timed<Pose>)]) -> Timed<Pose> {
    let first = poses[0].1;
    let count = poses.len() as f64;
    let from_first = |part: fn(&Pose, &Pose) -> f64| {
        let parts = poses
            .iter()
            .map(|(_, pose)| part(&pose.value, &first.value));
        parts.sum::<f64>() / count
    };
    Timed {
        time: first.time,
        value: Pose::new(
            first.value.x + from_first(|pose, first| pose.x - first.x),
            first.value.y + from_first(|pose, first| pose.y - first.y),
            wrapped(
                first.value.theta + from_first(|pose, first| wrapped(pose.theta - first.theta)),
            ),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joined_takes_the_mean_of_tags_seen_together() {
        let pose = |time, x, theta| Timed {
            time,
            value: Pose::new(x, 0.0, theta),
        };
        let (near, far) = (MERGED, MERGED + 1);
        let joined = joined(vec![
            vec![pose(0, 1.0, 3.1), pose(1000 * far, 5.0, 0.0)],
            vec![pose(near, 3.0, -3.1), pose(2000 * far, 7.0, 0.0)],
        ]);
        let found: Vec<_> = joined
            .iter()
            .map(|pose| (pose.time, pose.value.x))
            .collect();
        assert_eq!(found, [(0, 2.0), (1000 * far, 5.0), (2000 * far, 7.0)]);
        // over half a turn, not through zero
        assert!((joined[0].value.theta.abs() - std::f64::consts::PI).abs() < 1e-12);
    }
}
