//! A log made ready for a method: [`PreparedLog`].

use stickslip_dynamics::Pose;

use crate::covariance::PoseCovariance;
use crate::error::RunError;
use crate::estimate::{Estimate, EstimateRow};
use crate::log::Log;
use crate::options::RunOptions;
use crate::particle::set::observer::Observer;
use crate::pusher::schedule::Schedule;
use crate::pusher::track::PusherTrack;
use crate::setup::Setup;
use crate::tracker::TrackerOptions;

/// A log with its occlusion mask, start pose and step schedule.
pub(crate) struct PreparedLog<'a> {
    /// The log.
    pub log: &'a Log,
    /// True for each row whose object pose is hidden.
    pub hidden: Vec<bool>,
    /// First row with a visible object pose: row 0 of the estimate.
    pub first: usize,
    /// Pose in row `first`.
    pub start: Pose,
    /// The pusher's track.
    pub track: PusherTrack,
    /// The substeps from row to row.
    pub schedule: Schedule,
    /// Observer of every time step.
    pub observer: Option<&'a dyn Observer>,
}

impl<'a> PreparedLog<'a> {
    pub fn new(setup: &Setup, log: &'a Log, options: &RunOptions) -> Result<Self, RunError> {
        setup.check()?;
        TrackerOptions::of(options).check()?;
        log.check(&setup.scene)?;
        let hidden = options.occlusion.hidden(log);
        let mut seen = (0..log.len()).filter_map(|row| {
            log.object[row]
                .filter(|_| !hidden[row])
                .map(|pose| (row, pose))
        });
        let first = seen.next();
        let (first, start) = first.ok_or(RunError::NoObjectPose { rows: log.len() })?;
        let track = PusherTrack::new(log, setup.camera.as_ref(), options.tracking)?;
        Ok(Self {
            log,
            hidden,
            first,
            start,
            schedule: Schedule::new(&log.time, &track, options.substeps),
            track,
            observer: None,
        })
    }

    /// Returns the object pose of a row if it was measured and is not hidden.
    pub fn visible(&self, row: usize) -> Option<Pose> {
        self.log.object[row].filter(|_| !self.hidden[row])
    }

    /// Returns the covariance of that pose if the log has one.
    pub fn covariance(&self, row: usize) -> Option<PoseCovariance> {
        let covariance = self.log.object_covariance.get(row).copied().flatten();
        covariance.filter(|_| self.visible(row).is_some())
    }

    /// Returns an estimate with an empty row for every row of the log.
    pub fn empty_estimate(&self, setup: &Setup) -> Estimate {
        Estimate {
            time: self.log.time.clone(),
            rows: vec![EstimateRow::default(); self.log.len()],
            others: setup.scene.others(),
            has_tripod: setup.has_tripod(),
        }
    }
}
