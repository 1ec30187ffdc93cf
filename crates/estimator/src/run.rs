//! Runs a method over a recorded log: [`run`].

use crate::baseline::{extended_kalman, kalman, nominal, stopping, with_pusher};
use crate::error::RunError;
use crate::estimate::{Estimate, EstimateRow};
use crate::log::Log;
use crate::options::{Method, RunOptions, TactileUse};
use crate::particle::contact_filter::FilterOptions;
use crate::particle::contact_filter::{ContactFilter, Measured};
use crate::particle::sensor::observation::PoseAt;
use crate::particle::set::observer::Observer;
use crate::particle::set::view::ParticleView;
use crate::particle::transition::step_plan::Drive;
use crate::prepared_log::PreparedLog;
use crate::pusher::track::Tracking;
use crate::row::Row;
use crate::setup::{Camera, Setup};
use crate::tracker::{Tracker, TrackerOptions};

/// Result of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// One row per log row.
    pub estimate: Estimate,
    /// Number of particle-steps without a certified solution, over all rows.
    pub unsolved: u64,
    /// Number of these whose solver gave up; for the others it proved that there is no solution.
    pub failed: u64,
    /// Number of rows at which no particle explained the camera pose, so that all were
    /// reinitialised around it.
    pub collapses: u32,
    /// ln of the evidence of the log, up to a constant of the log. Of two scenes or two models, the
    /// one with the higher evidence predicted camera poses and tactile readings better. Rows at
    /// which the filter collapsed are left out. `None` for methods without particles.
    pub log_evidence: Option<f64>,
}

/// Runs a method over a log; `progress` gets the number of every finished row.
///
/// ```
/// use stickslip::{Occlusion, RunOptions, run};
///
/// # let folder = "../testkit/experiments/slide-ell-disc-110";
/// let scene = std::fs::read_to_string(format!("{folder}/scene.toml"))?;
/// let setup = stickslip_formats::read_scene(&scene, "scene.toml")?;
/// let file = std::fs::File::open(format!("{folder}/log.csv"))?;
/// let (log, _) = stickslip_formats::read_log(file, "log.csv")?;
///
/// // the camera is off from row 200 on
/// let occlusion = Occlusion::Rows { from: 200, to: None };
/// let options = RunOptions { occlusion, ..RunOptions::default() };
/// let result = run(&setup, &log, &options, &mut |_| ())?;
/// let last = result.estimate.rows.last().expect("as many rows as the log");
/// println!("{:?} with friction {:?}", last.pose, last.friction);
/// # assert!(last.pose.is_some() && !last.visual);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If the log has no visible object pose, the scene lacks what the method needs, or options are out
/// of range.
pub fn run(
    setup: &Setup,
    log: &Log,
    options: &RunOptions,
    progress: &mut dyn FnMut(usize),
) -> Result<Run, RunError> {
    run_prepared(
        setup,
        &PreparedLog::new(setup, log, options)?,
        options,
        progress,
    )
}

/// Runs a method like [`run`], with an `observer` that is shown every time step solved on the way
/// and the particles after every row. It changes no result.
///
/// # Errors
/// Those of [`run`].
pub fn run_observed(
    setup: &Setup,
    log: &Log,
    options: &RunOptions,
    observer: &dyn Observer,
    progress: &mut dyn FnMut(usize),
) -> Result<Run, RunError> {
    let prepared = PreparedLog {
        observer: Some(observer),
        ..PreparedLog::new(setup, log, options)?
    };
    run_prepared(setup, &prepared, options, progress)
}

fn run_prepared(
    setup: &Setup,
    prepared: &PreparedLog<'_>,
    options: &RunOptions,
    progress: &mut dyn FnMut(usize),
) -> Result<Run, RunError> {
    let camera = || setup.camera.ok_or(RunError::NoCamera);
    let no_particles = ParticleRun::default();
    let (estimate, particle) = match (options.method, options.tracking) {
        (Method::Particle, Tracking::Smoothed) => {
            track_smoothed(setup, camera()?, prepared, options, progress)?
        }
        (Method::Particle, Tracking::Causal) => track_causal(setup, prepared, options, progress)?,
        (Method::Kalman, _) => (kalman::track(setup, &camera()?, prepared)?, no_particles),
        (Method::KalmanStops, _) => {
            let kalman = kalman::track(setup, &camera()?, prepared)?;
            (stopping(kalman, prepared, options.tactile), no_particles)
        }
        (Method::WithPusher, _) => {
            let kalman = kalman::track(setup, &camera()?, prepared)?;
            (with_pusher(kalman, prepared), no_particles)
        }
        (Method::ExtendedKalman, _) => {
            let (estimate, collapses) =
                extended_kalman::track(setup, camera()?, prepared, progress);
            let run = ParticleRun {
                collapses,
                ..no_particles
            };
            (estimate, run)
        }
        (Method::Nominal, _) => (nominal::simulate(setup, prepared, progress), no_particles),
    };
    let all = |count: fn(&EstimateRow) -> Option<u32>| {
        let counts = estimate.rows.iter().filter_map(count);
        counts.map(u64::from).sum()
    };
    Ok(Run {
        unsolved: all(|row| row.unsolved),
        failed: all(|row| row.failed),
        estimate,
        collapses: particle.collapses,
        log_evidence: particle.log_evidence,
    })
}

/// Counts of a run, and its evidence if it has particles.
#[derive(Clone, Copy, Debug, Default)]
struct ParticleRun {
    collapses: u32,
    log_evidence: Option<f64>,
}

/// Runs the particle filter, driven by the pusher's smoothed track; also returns its counts.
fn track_smoothed(
    setup: &Setup,
    camera: Camera,
    prepared: &PreparedLog<'_>,
    options: &RunOptions,
    progress: &mut dyn FnMut(usize),
) -> Result<(Estimate, ParticleRun), RunError> {
    let PreparedLog {
        log,
        first,
        start,
        schedule,
        observer,
        ..
    } = prepared;
    let filter_options = FilterOptions {
        model: options.model,
        particles: options.particles,
        seed: options.seed,
        late: 0.0,
        camera_moves: options.camera_moves,
        observer: *observer,
    };
    let start = PoseAt {
        time: log.time[*first],
        pose: *start,
        covariance: prepared.covariance(*first),
    };
    let mut filter = ContactFilter::new(setup, camera, start, &filter_options)?;
    let mut estimate = prepared.empty_estimate(setup);
    estimate.rows[*first].clone_from(filter.latest());
    prepared.show(*first, Some(filter.particles()));
    let mut row_at = Row::default();
    for row in first + 1..log.len() {
        prepared.read(row, options.tactile, &mut row_at);
        let measured = Measured {
            time: row_at.time,
            object: row_at.object,
            covariance: row_at.object_covariance,
            tactile: &row_at.tactile,
            force: row_at.force,
        };
        let drive = Drive {
            smoothed: true,
            ..Drive::new(schedule.step(row - 1), schedule.driven(row - 1))
        };
        estimate.rows[row].clone_from(match drive.substeps {
            [] => filter.look(measured),
            _ => filter.step(measured, drive),
        });
        prepared.show(row, Some(filter.particles()));
        progress(row);
    }
    let run = ParticleRun {
        collapses: filter.collapses(),
        log_evidence: Some(filter.log_evidence()),
    };
    Ok((estimate, run))
}

/// Runs the particle filter row by row, as a [`Tracker`] takes the rows; also returns its counts.
fn track_causal(
    setup: &Setup,
    prepared: &PreparedLog<'_>,
    options: &RunOptions,
    progress: &mut dyn FnMut(usize),
) -> Result<(Estimate, ParticleRun), RunError> {
    let tracker_options = TrackerOptions::of(options);
    let mut tracker = Tracker::build(setup, &tracker_options, prepared.observer)?;
    let mut estimate = prepared.empty_estimate(setup);
    let mut row_at = Row::default();
    for row in 0..prepared.log.len() {
        prepared.read(row, options.tactile, &mut row_at);
        estimate.rows[row].clone_from(tracker.push(&row_at)?);
        prepared.show(row, tracker.particles());
        if row > prepared.first {
            progress(row);
        }
    }
    let run = ParticleRun {
        collapses: tracker.collapses(),
        log_evidence: Some(tracker.log_evidence()),
    };
    Ok((estimate, run))
}

impl PreparedLog<'_> {
    /// Shows the observer the particles after a row.
    fn show(&self, row: usize, particles: Option<ParticleView<'_>>) {
        if let Some((observer, particles)) = self.observer.zip(particles) {
            observer.on_row(row, &particles);
        }
    }

    /// Writes the measurements of `row` that are not hidden; memory is reused.
    fn read(&self, row: usize, tactile: TactileUse, to: &mut Row) {
        to.time = self.log.time[row];
        to.object = self.visible(row);
        to.object_covariance = self.covariance(row);
        to.pusher = self.log.pusher[row];
        to.other_fingers.clear();
        let others = self.log.other_fingers.iter().map(|poses| poses[row]);
        to.other_fingers.extend(others);
        to.force = self.log.force.get(row).copied().flatten();
        to.tactile.clear();
        if tactile == TactileUse::Used {
            to.tactile
                .extend(self.log.tactile.iter().map(|sensor| sensor[row]));
        }
    }
}
