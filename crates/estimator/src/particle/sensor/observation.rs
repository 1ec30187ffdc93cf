//! Readings of the sensors at one row: [`Observation`].

use stickslip_dynamics::Pose;

use crate::covariance::PoseCovariance;

/// A pose of the object at its time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PoseAt {
    /// Time of the measurement (s).
    pub time: f64,
    /// The pose.
    pub pose: Pose,
    /// Covariance of the pose, if it has one of its own.
    pub covariance: Option<PoseCovariance>,
}

/// Place in a particle's past that the camera shows: between two slots of its history
/// (docs/method.md (29)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatencyCompensation {
    /// Slot of the earlier pose.
    pub earlier: usize,
    /// Slot of the later pose.
    pub later: usize,
    /// Fraction of the way from the earlier to the later.
    pub fraction: f64,
}

/// Readings of the sensors at one row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observation {
    /// Camera pose.
    pub pose: Option<Pose>,
    /// Covariance of the pose, if it has one of its own.
    pub covariance: Option<PoseCovariance>,
    /// Time of the row (s).
    pub time: f64,
    /// Times (s) and slots of the past poses that every particle keeps, in order of time (robust
    /// model).
    pub past: Vec<(f64, usize)>,
    /// Past pose of each particle that the camera shows; `None` is the present one.
    pub latency: Option<LatencyCompensation>,
    /// Tactile readings, one per sensor.
    pub tactile: Vec<Option<bool>>,
    /// True if the step's own likelihood of pusher and sensors counts (robust model).
    pub weighs_step: bool,
    /// True if the camera's pose may move particles (robust model).
    pub moves: bool,
}

impl Observation {
    /// Returns true if nothing was read.
    pub fn is_empty(&self) -> bool {
        self.pose.is_none() && !self.weighs_step && self.tactile.iter().all(Option::is_none)
    }
}
