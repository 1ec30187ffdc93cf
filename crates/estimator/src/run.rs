//! Runs a method over a recorded log: [`run`], the particle filter and its baselines behind one
//! door.

use stickslip_dynamics::Pose;

use crate::schedule::{LONGEST_PAUSE, Schedule};
use crate::track::PusherTrack;
use crate::watch::StepWatch;
use crate::{
    Estimate, EstimateRow, Log, Occlusion, RunError, Setup, Tracking, kalman_baseline, nominal,
    particle_run,
};

/// How a log is turned into estimates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Method {
    /// The particle filter over contact dynamics.
    #[default]
    Particle,
    /// A constant-velocity Kalman filter that knows nothing of contact.
    Kalman,
    /// The nominal simulation, which never looks at the camera after the first pose.
    Nominal,
}

/// Whether tactile data is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum TactileUse {
    /// Tactile readings weigh the particles.
    #[default]
    Used,
    /// They are ignored.
    Ignored,
}

/// Options of a run; the defaults are those of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunOptions {
    /// Method.
    pub method: Method,
    /// Number of particles.
    pub particles: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Use of tactile data.
    pub tactile: TactileUse,
    /// How the pusher is tracked.
    pub tracking: Tracking,
    /// Forced number of substeps per row; `None`: by the length of the step.
    pub substeps: Option<u32>,
    /// What is hidden from the method.
    pub occlusion: Occlusion,
}

impl Default for RunOptions {
    fn default() -> Self {
        Self {
            method: Method::Particle,
            particles: 500,
            seed: 0,
            tactile: TactileUse::Used,
            tracking: Tracking::Smoothed,
            substeps: None,
            occlusion: Occlusion::None,
        }
    }
}

/// What a run produced.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// One row per log row.
    pub estimate: Estimate,
    /// Particle-steps without a certified solution, over all rows.
    pub unsolved: u64,
    /// Rows at which no particle explained the camera and all were drawn anew around its pose.
    pub collapses: u32,
}

/// Runs a method over a log; `progress` is told every finished row.
///
/// # Errors
/// Where the log has no visible object pose, the scene lacks what the method needs, or options are
/// out of range.
pub fn run(
    setup: &Setup,
    log: &Log,
    options: &RunOptions,
    progress: &mut dyn FnMut(usize),
) -> Result<Run, RunError> {
    run_prepared(
        setup,
        &Prepared::new(setup, log, options)?,
        options,
        progress,
    )
}

/// The same, with a `watch` that is shown every time step solved on the way; it changes no result.
///
/// # Errors
/// Those of [`run`].
pub fn run_watched(
    setup: &Setup,
    log: &Log,
    options: &RunOptions,
    watch: &dyn StepWatch,
    progress: &mut dyn FnMut(usize),
) -> Result<Run, RunError> {
    let prepared = Prepared {
        watch: Some(watch),
        ..Prepared::new(setup, log, options)?
    };
    run_prepared(setup, &prepared, options, progress)
}

fn run_prepared(
    setup: &Setup,
    prepared: &Prepared<'_>,
    options: &RunOptions,
    progress: &mut dyn FnMut(usize),
) -> Result<Run, RunError> {
    let camera = || setup.camera.ok_or(RunError::NoCamera);
    let (estimate, collapses) = match options.method {
        Method::Particle => particle_run::track(setup, camera()?, prepared, options, progress)?,
        Method::Kalman => (kalman_baseline::track(setup, &camera()?, prepared)?, 0),
        Method::Nominal => (nominal::simulate(setup, prepared, progress), 0),
    };
    let unsolved = estimate
        .rows
        .iter()
        .filter_map(|row| row.unsolved)
        .map(u64::from)
        .sum();
    Ok(Run {
        estimate,
        unsolved,
        collapses,
    })
}

/// Refuses a log whose steps no substeps can follow.
fn check_pauses(time: &[f64]) -> Result<(), RunError> {
    match time
        .array_windows()
        .position(|[from, to]| to - from > LONGEST_PAUSE)
    {
        Some(row) => Err(RunError::Pause {
            row: row + 1,
            from: time[row],
            to: time[row + 1],
        }),
        None => Ok(()),
    }
}

/// A log made ready: who sees what, from where it starts, and the steps between its rows.
pub(crate) struct Prepared<'a> {
    pub log: &'a Log,
    pub hidden: Vec<bool>,
    /// First row with a visible object pose: row 0 of the estimate.
    pub first: usize,
    pub start: Pose,
    pub schedule: Schedule,
    pub watch: Option<&'a dyn StepWatch>,
}

impl<'a> Prepared<'a> {
    fn new(setup: &Setup, log: &'a Log, options: &RunOptions) -> Result<Self, RunError> {
        let fixels = setup.scene.fixels.len();
        if log.tactile.len() > fixels {
            return Err(RunError::Sensors {
                sensors: log.tactile.len(),
                fixels,
            });
        }
        check_pauses(&log.time)?;
        let hidden = options.occlusion.hidden(log);
        let seen = (0..log.len()).find_map(|row| {
            log.object[row]
                .filter(|_| !hidden[row])
                .map(|pose| (row, pose))
        });
        let (first, start) = seen.ok_or(RunError::NoObjectPose { rows: log.len() })?;
        let track = PusherTrack::new(log, setup.camera.as_ref(), options.tracking)?;
        Ok(Self {
            log,
            hidden,
            first,
            start,
            schedule: Schedule::new(&log.time, &track, options.substeps),
            watch: None,
        })
    }

    /// The object pose of a row, where it was measured and is not hidden.
    pub fn visible(&self, row: usize) -> Option<Pose> {
        self.log.object[row].filter(|_| !self.hidden[row])
    }

    /// Empty rows for every row of the log.
    pub fn empty_estimate(&self, setup: &Setup) -> Estimate {
        Estimate {
            time: self.log.time.clone(),
            rows: vec![EstimateRow::default(); self.log.len()],
            fixels: setup.scene.fixels.len(),
            has_tripod: setup.has_tripod(),
        }
    }

    /// Most rows of the log that lie within `latency` of each other, and two more: the past poses a
    /// particle must keep.
    pub fn rows_within(&self, latency: f64) -> usize {
        if latency <= 0.0 {
            return 0;
        }
        let time = &self.log.time;
        let mut earlier = 0;
        let spans = time.iter().enumerate().map(|(row, t)| {
            while t - time[earlier] > latency {
                earlier += 1;
            }
            row - earlier
        });
        spans.max().unwrap_or(0) + 3
    }
}
