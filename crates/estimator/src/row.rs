//! Measurements of one camera frame: [`Row`].

use stickslip_dynamics::{Pose, Scene};

use crate::counted::counted;
use crate::covariance::PoseCovariance;
use crate::range::Unit;

/// Longest time between two rows (s). A log that pauses longer is in milliseconds, or mixes two
/// clocks or two recordings. Its substeps would fill the memory.
pub(crate) const LONGEST_PAUSE: f64 = 5.0;

/// Latest time (s). Today's time in nanoseconds is earlier: other rules refuse it with a better
/// message.
const LATEST: f64 = 1e19;

/// Returns the unit of times whose typical step from row to row is `step`; `None` for seconds.
pub(crate) fn unit_of_times(step: f64) -> Option<&'static str> {
    match step {
        step if step > 5e5 => Some("nanoseconds"),
        step if step > 500.0 => Some("microseconds"),
        step if step > LONGEST_PAUSE => Some("milliseconds"),
        _ => None,
    }
}

/// The measurements of one instant, `None` where there is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Time (s).
    pub time: f64,
    /// Pose of the object as the camera measured it. It shows the object one latency earlier.
    pub object: Option<Pose>,
    /// Covariance of that pose; `None`: the noise of the scene's camera. It is ignored without a
    /// pose.
    pub object_covariance: Option<PoseCovariance>,
    /// Pose of the pusher, or of the first finger of a hand.
    pub pusher: Option<Pose>,
    /// Poses of the hand's other fingers; those past the end are missing.
    pub other_fingers: Vec<Option<Pose>>,
    /// Tactile readings over the interval that ends here, sensor k on fixel k, those of a hand's
    /// fingers behind them. Sensors past the end are silent.
    pub tactile: Vec<Option<bool>>,
    /// Force of the pusher, or of the whole hand, on the object over the same interval, world frame
    /// (N).
    pub force: Option<[f64; 2]>,
}

/// Reason why a row was refused. The tracker stays as it was before.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RowError {
    /// The time is not a plausible number.
    #[error("the row's time is {time:?} s; it must be finite, and at most 1e19")]
    Time {
        /// The time found (s).
        time: f64,
    },
    /// A number of a pose is NaN or infinite.
    #[error(
        "the {body}'s pose at {time} s is ({x}, {y}, {theta}); all three must be finite; give None where nothing was measured",
        x = pose.x, y = pose.y, theta = pose.theta
    )]
    Pose {
        /// `object` or `pusher`.
        body: &'static str,
        /// Time of the row (s).
        time: f64,
        /// The pose found.
        pose: Pose,
    },
    /// A pose is implausibly far away.
    #[error(
        "the {body}'s pose at {time} s is ({x:?}, {y:?}, {theta:?}); no coordinate may be beyond 1e6 m or 1e6 rad; give None where nothing was measured",
        x = pose.x, y = pose.y, theta = pose.theta
    )]
    Far {
        /// `object` or `pusher`.
        body: &'static str,
        /// Time of the row (s).
        time: f64,
        /// The pose found.
        pose: Pose,
    },
    /// A matrix that is no covariance.
    #[error(
        "the covariance of the object's pose at {time} s is {covariance:?}; it must be finite and positive definite, with standard deviations between 1e-9 and 1e6; give None where it is not known"
    )]
    Covariance {
        /// Time of the row (s).
        time: f64,
        /// The covariance found.
        covariance: PoseCovariance,
    },
    /// More sensors than bodies for them.
    #[error(
        "the row at {time} s has {} but the scene has {}; sensor k is on the k-th [[fixel]], or behind them on a finger of a hand",
        counted(*.sensors as u64, "tactile reading"),
        counted_bodies(*.fixels, *.fingers)
    )]
    Sensors {
        /// Time of the row (s).
        time: f64,
        /// Readings found.
        sensors: usize,
        /// Fixels of the scene.
        fixels: usize,
        /// Fingers of the scene.
        fingers: usize,
    },
    /// More fingers than the scene's.
    #[error(
        "the row at {time} s has poses of {} besides the pusher but the scene has {}; give one pose for each [[finger]]",
        counted(*.found as u64, "finger"), counted(*.fingers as u64, "[[finger]] table")
    )]
    Fingers {
        /// Time of the row (s).
        time: f64,
        /// Fingers with a pose, or with a place for one, besides the pusher.
        found: usize,
        /// `[[finger]]` tables of the scene.
        fingers: usize,
    },
    /// The time since the previous row is too long: what happened in it is unknown.
    #[error(
        "the row is at {to} s and the latest before it at {from} s; rows must be at most {longest} s apart. Give all times in seconds and by one clock, or start a new tracker",
        longest = LONGEST_PAUSE
    )]
    Pause {
        /// Time of the latest row (s).
        from: f64,
        /// Time of the row (s).
        to: f64,
    },
    /// The row is older than the particles' history.
    #[error(
        "the row is at {time} s but the tracker is at {latest} s and remembers {remembered} s; leave such rows out, or raise `late` in the tracker's options"
    )]
    TooLate {
        /// Time of the row (s).
        time: f64,
        /// Time of the latest row (s).
        latest: f64,
        /// Longest time by which a row may be behind the latest one (s).
        remembered: f64,
    },
}

/// Bodies that may have a sensor, in words: the fixels, and the fingers of a hand of several.
pub fn counted_bodies(fixels: usize, fingers: usize) -> String {
    let fixels = counted(fixels as u64, "fixel");
    match fingers {
        1 => fixels,
        _ => format!("{fixels} and {}", counted(fingers as u64, "finger")),
    }
}

impl Row {
    /// Refuses a row that no tracker can use.
    pub(crate) fn check(&self, scene: &Scene) -> Result<(), RowError> {
        let time = self.time;
        if time.is_nan() || time.abs() > LATEST {
            return Err(RowError::Time { time });
        }
        let (found, fingers) = (self.other_fingers.len(), scene.pusher.fingers.len());
        if found >= fingers {
            return Err(RowError::Fingers {
                time,
                found,
                fingers: fingers - 1,
            });
        }
        let others = self.other_fingers.iter().map(|pose| ("finger", *pose));
        let bodies = [("object", self.object), ("pusher", self.pusher)];
        for (body, pose) in bodies.into_iter().chain(others) {
            let Some(pose) = pose else { continue };
            if !pose.is_finite() {
                return Err(RowError::Pose { body, time, pose });
            }
            let places = [pose.x, pose.y].iter().all(|x| Unit::Metre.holds(*x));
            if !(places && Unit::Radian.holds(pose.theta)) {
                return Err(RowError::Far { body, time, pose });
            }
        }
        if let Some(covariance) = self.object_covariance
            && self.object.is_some()
            && !covariance.is_valid()
        {
            return Err(RowError::Covariance { time, covariance });
        }
        let sensors = self.tactile.len();
        if sensors > scene.sensors() {
            return Err(RowError::Sensors {
                time,
                sensors,
                fixels: scene.fixels.len(),
                fingers,
            });
        }
        Ok(())
    }

    /// Poses of the scene's fingers.
    pub(crate) fn fingers(&self, scene: &Scene) -> impl Iterator<Item = Option<Pose>> {
        let others = (1..scene.pusher.fingers.len())
            .map(|i| self.other_fingers.get(i - 1).copied().flatten());
        std::iter::once(self.pusher).chain(others)
    }
}
