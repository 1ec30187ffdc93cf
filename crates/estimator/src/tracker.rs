//! Tracks the object row by row, as a robot needs it: [`Tracker`].

use std::num::NonZero;

use stickslip_dynamics::{MOST_FINGERS, StepInput};

use crate::diagnosis::{Finding, collapsed, left_out_poses};
use crate::error::RunError;
use crate::estimate::EstimateRow;
use crate::filter_model::FilterModel;
use crate::options::{RunOptions, TactileUse};
use crate::outcomes::{Outcomes, Plan, PlanError};
use crate::particle::contact_filter::FilterOptions;
use crate::particle::contact_filter::{ContactFilter, Measured};
use crate::particle::sensor::observation::PoseAt;
use crate::particle::set::observer::Observer;
use crate::particle::set::view::ParticleView;
use crate::particle::transition::step_plan::Drive;
use crate::pose_clock::PoseClock;
use crate::pusher::causal::CausalTrack;
use crate::pusher::schedule::split;
use crate::pusher::tracked_pose::{
    Directions, TrackedPose, keep_directions, motion, moves, step_length,
};
use crate::row::{LONGEST_PAUSE, Row, RowError};
use crate::setup::{Camera, Setup};
use crate::tuning::SHORTEST_STEP;

/// Direction in which a finger that has not moved yet may yield.
const FIRST_DIRECTION: [f64; 2] = [1.0, 0.0];

/// Largest number of substeps from row to row.
const MOST_SUBSTEPS: u32 = 10_000;

/// Memory per particle (bytes), including that of the one that learns friction with it. It was
/// measured with four bodies to touch; past poses are not counted.
fn particle_bytes(model: FilterModel) -> usize {
    match model {
        FilterModel::Robust => 5200,
        FilterModel::Paper => 600,
    }
}

/// Options of a tracker; the defaults are those of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackerOptions {
    /// Configuration of the particle filter.
    pub model: FilterModel,
    /// Number of particles that estimate the pose. The robust model has as many more that learn
    /// friction.
    pub particles: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Use of tactile readings.
    pub tactile: TactileUse,
    /// Forced number of substeps from row to row; `None`: by the length of the step.
    pub substeps: Option<u32>,
    /// Longest time (s) by which a row may be behind the latest one and still count. The particles
    /// keep their poses for as long.
    pub late: f64,
    /// True if camera poses move particles as well as weigh them (robust model; docs/model.md
    /// (45)).
    pub camera_moves: bool,
}

impl Default for TrackerOptions {
    fn default() -> Self {
        Self {
            late: 0.2,
            ..Self::of(&RunOptions::default())
        }
    }
}

impl TrackerOptions {
    /// Options of a run over a whole log, whose rows are never late.
    pub fn of(options: &RunOptions) -> Self {
        Self {
            model: options.model,
            particles: options.particles,
            seed: options.seed,
            tactile: options.tactile,
            substeps: options.substeps,
            late: 0.0,
            camera_moves: options.camera_moves,
        }
    }

    /// Refuses options that are out of range.
    pub(crate) fn check(&self) -> Result<(), RunError> {
        let (particles, late) = (self.particles, self.late);
        if let Some(substeps) = self.substeps.filter(|n| !(1..=MOST_SUBSTEPS).contains(n)) {
            return Err(RunError::Substeps {
                substeps,
                most: MOST_SUBSTEPS,
            });
        }
        if !(0.0..=LONGEST_PAUSE).contains(&late) {
            return Err(RunError::Late { late });
        }
        let bytes = particles.saturating_mul(particle_bytes(self.model));
        let given = Vec::<u8>::new().try_reserve_exact(bytes);
        given.map_err(|_| RunError::Memory {
            particles,
            megabytes: bytes / 1_000_000,
        })
    }
}

/// Cost of a step: its time is proportional to the product of both numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepSize {
    /// Number of substeps that lead to the row; 0 at the first one.
    pub substeps: u32,
    /// Number of particles.
    pub particles: NonZero<u32>,
}

/// The particle filter over contact dynamics, one row at a time.
///
/// It returns the same bits as [`run`](crate::run) with [`Tracking::Causal`](crate::Tracking): the
/// pusher is tracked from the rows so far (docs/method.md, "The pusher's track").
///
/// After the first rows, a row on one thread allocates nothing, except
///
/// - where the number of particles changes,
/// - where a step needs the search over contact modes.
///
/// ```
/// use stickslip::{Row, Tracker, TrackerOptions};
/// # let folder = "../testkit/experiments/slide-ell-disc-110";
/// let scene = std::fs::read_to_string(format!("{folder}/scene.toml"))?;
/// let setup = stickslip_formats::read_scene(&scene, "scene.toml")?;
/// let mut tracker = Tracker::new(&setup, &TrackerOptions::default())?;
/// # let csv = std::fs::read(format!("{folder}/log.csv"))?;
/// # let (log, _) = stickslip_formats::read_log(&csv[..], "log.csv")?;
/// # let camera = (0..20).map(|row| log.row(row));
/// for row in camera {
///     let estimate = tracker.push(&row)?;
///     println!("{:.3} s: {:?}", row.time, estimate.pose);
/// }
/// let particles = tracker.particles().expect("there was a pose");
/// assert_eq!(particles.len(), 500);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A clone goes on by itself, as the original would: equal rows give it equal estimates.
#[derive(Clone)]
pub struct Tracker<'o> {
    setup: Setup,
    camera: Camera,
    options: TrackerOptions,
    observer: Option<&'o dyn Observer>,
    /// Track of each finger.
    fingers: Vec<CausalTrack>,
    /// Clock of the pusher's poses, from the first row on.
    pusher_clock: Option<PoseClock>,
    /// The fingers at the latest row.
    latest: Vec<Option<TrackedPose>>,
    /// The fingers at the latest step's end.
    tracked: Vec<Option<TrackedPose>>,
    directions: Directions,
    substeps: Vec<StepInput>,
    /// Time of the latest row (s).
    time: Option<f64>,
    /// Time of the latest step's end (s).
    stepped: Option<f64>,
    /// The filter, from the first object pose on.
    filter: Option<ContactFilter<'o>>,
    /// Empty row, for rows before the first object pose.
    nothing: EstimateRow,
    /// Number of rows with a camera pose.
    seen: usize,
}

impl Tracker<'static> {
    /// A tracker that waits for its first row.
    ///
    /// # Errors
    /// If the scene has no camera, or its numbers or the options are out of range.
    pub fn new(setup: &Setup, options: &TrackerOptions) -> Result<Self, RunError> {
        Self::build(setup, options, None)
    }
}

impl<'o> Tracker<'o> {
    /// A tracker with an `observer` that is shown every time step solved; it changes no result.
    ///
    /// # Errors
    /// Those of [`Tracker::new`].
    pub fn observed(
        setup: &Setup,
        options: &TrackerOptions,
        observer: &'o dyn Observer,
    ) -> Result<Self, RunError> {
        Self::build(setup, options, Some(observer))
    }

    pub(crate) fn build(
        setup: &Setup,
        options: &TrackerOptions,
        observer: Option<&'o dyn Observer>,
    ) -> Result<Self, RunError> {
        setup.check()?;
        options.check()?;
        let camera = setup.camera.ok_or(RunError::NoCamera)?;
        let fingers = setup.scene.pusher.fingers.len();
        let tracker = Self {
            setup: setup.clone(),
            camera,
            options: *options,
            observer,
            fingers: vec![CausalTrack::new(Some(&camera))?; fingers],
            pusher_clock: None,
            latest: vec![None; fingers],
            tracked: vec![None; fingers],
            directions: [FIRST_DIRECTION; MOST_FINGERS],
            substeps: Vec::new(),
            time: None,
            stepped: None,
            filter: None,
            nothing: EstimateRow::default(),
            seen: 0,
        };
        tracker.filter_options().settings(setup).check()?;
        Ok(tracker)
    }

    fn filter_options(&self) -> FilterOptions<'o> {
        FilterOptions {
            model: self.options.model,
            particles: self.options.particles,
            seed: self.options.seed,
            late: self.options.late,
            camera_moves: self.options.camera_moves,
            observer: self.observer,
        }
    }

    /// Takes one row and returns the estimate at the latest row. The cells of the estimate are
    /// empty before the first object pose.
    ///
    /// A row without an object pose is occluded. A row that is not later than the latest one is
    /// late. Its object pose is weighed against each particle's own pose at that time, up to
    /// [`TrackerOptions::late`] back. The rest of a late row is not used: the step that it would
    /// have driven is made already.
    ///
    /// # Errors
    /// [`RowError`] if the row cannot be used; the tracker then is as it was before.
    pub fn push(&mut self, row: &Row) -> Result<&EstimateRow, RowError> {
        self.push_sized(row, |step| step.particles)
    }

    /// Takes one row like [`push`](Self::push), with the number of particles that `particles`
    /// returns. Its argument is the size of the step to the row, with the number of particles of
    /// the row before. It is not called at late rows, at rows to which no step leads, and before
    /// the first object pose.
    ///
    /// If the number changes, the particles are resampled first. The estimates of this row and
    /// later ones then depend on when it changed.
    ///
    /// # Errors
    /// Those of [`push`](Self::push).
    pub fn push_sized(
        &mut self,
        row: &Row,
        particles: impl FnOnce(StepSize) -> NonZero<u32>,
    ) -> Result<&EstimateRow, RowError> {
        row.check(&self.setup.scene)?;
        match self.time {
            Some(latest) if row.time <= latest => return self.push_late(row, latest),
            Some(from) if row.time - from > LONGEST_PAUSE => {
                return Err(RowError::Pause { from, to: row.time });
            }
            _ => {}
        }

        // the pusher, and the substeps over which it drives the object
        let tracks = self.fingers.iter_mut().zip(&mut self.latest);
        for ((track, latest), pose) in tracks.zip(row.fingers(&self.setup.scene)) {
            *latest = track.push(row.time, pose);
        }
        let moves = moves(&self.latest);
        let clock = self.pusher_clock.get_or_insert(PoseClock::new(row.time));
        let seen = row.fingers(&self.setup.scene).all(|pose| pose.is_some());
        let overdue = clock.is_dark(row.time, seen);
        self.time = Some(row.time);
        self.seen += usize::from(row.object.is_some());
        self.plan_substeps(row.time);

        // the particles, which begin at the first pose of the object
        match (&mut self.filter, row.object) {
            (Some(filter), object) => {
                let tactile = match self.options.tactile {
                    TactileUse::Used => &row.tactile[..],
                    TactileUse::Ignored => &[],
                };
                let measured = Measured {
                    time: row.time,
                    object,
                    covariance: row.object_covariance,
                    tactile,
                    force: row.force,
                };
                let substeps = &self.substeps;
                if substeps.is_empty() {
                    filter.look(measured);
                    return Ok(self.estimate());
                }
                filter.resize(particles(StepSize {
                    substeps: substeps.len() as u32,
                    particles: filter.count(),
                }));
                let drive = Drive::new(substeps, moves);
                let unseen = drive.unseen || overdue;
                filter.step(measured, Drive { unseen, ..drive });
            }
            (None, Some(pose)) => {
                let options = self.filter_options();
                let start = PoseAt {
                    time: row.time,
                    pose,
                    covariance: row.object_covariance,
                };
                let filter = ContactFilter::new(&self.setup, self.camera, start, &options);
                self.filter = Some(filter.expect("the settings were checked"));
            }
            (None, None) => {}
        }
        Ok(self.estimate())
    }

    /// Writes the substeps from the end of the latest step to `time`, where the fingers are the
    /// latest ones. There is none if `time` is too near.
    fn plan_substeps(&mut self, time: f64) {
        self.substeps.clear();
        let Some(from) = self.stepped else {
            self.stepped = Some(time);
            self.tracked.clone_from(&self.latest);
            return;
        };
        let h = time - from;
        if h < SHORTEST_STEP {
            return;
        }
        self.stepped = Some(time);
        let h = step_length(&self.latest, h);
        let motion = motion(&self.tracked, &self.latest, h, &self.directions);
        self.tracked.clone_from(&self.latest);
        keep_directions(motion.as_ref(), &mut self.directions);
        self.substeps
            .extend(split(h, motion, self.options.substeps));
    }

    fn push_late(&mut self, row: &Row, latest: f64) -> Result<&EstimateRow, RowError> {
        let remembered = self.options.late;
        if row.time < latest - remembered {
            return Err(RowError::TooLate {
                time: row.time,
                latest,
                remembered,
            });
        }
        if let (Some(filter), Some(pose)) = (&mut self.filter, row.object) {
            filter.weigh_late(PoseAt {
                time: row.time,
                pose,
                covariance: row.object_covariance,
            });
        }
        Ok(self.estimate())
    }

    /// Predicts how the pusher's intended motion will end, if nothing is measured on the way: moves
    /// copies of the particles, with their velocities, friction and offsets, and with random
    /// forces. The tracker stays as it is, and returns the same for the same plan.
    ///
    /// # Errors
    /// If there is no particle yet, or the plan does not go with the scene.
    pub fn outcomes(&self, plan: &Plan) -> Result<Outcomes, PlanError> {
        plan.check(self.setup.scene.pusher.fingers.len())?;
        let filter = self.filter.as_ref().ok_or(PlanError::NoPose)?;
        Ok(filter.outcomes(&plan.steps(self.directions)))
    }

    /// The estimate at the latest row; its cells are empty before the first object pose.
    pub fn estimate(&self) -> &EstimateRow {
        self.filter
            .as_ref()
            .map_or(&self.nothing, ContactFilter::latest)
    }

    /// The particles after the latest row; `None` before the first object pose.
    pub fn particles(&self) -> Option<ParticleView<'_>> {
        self.filter.as_ref().map(ContactFilter::particles)
    }

    /// Time of the latest row (s).
    pub fn time(&self) -> Option<f64> {
        self.time
    }

    /// Number of rows at which no particle explained the camera pose, so that all were
    /// reinitialised around it.
    pub fn collapses(&self) -> u32 {
        self.filter.as_ref().map_or(0, ContactFilter::collapses)
    }

    /// Number of pusher poses that counted as missing, since the pusher could not have come there
    /// in time (docs/method.md, "The pusher's track").
    pub fn pusher_poses_left_out(&self) -> u32 {
        self.fingers.iter().map(CausalTrack::left_out).sum()
    }

    /// Finds reasons to doubt the estimates so far: collapses, and pusher poses that counted as
    /// missing.
    pub fn doubts(&self) -> Vec<Finding> {
        let left_out = left_out_poses(self.pusher_poses_left_out() as usize, "");
        let collapsed = collapsed(self.collapses(), self.seen);
        left_out.into_iter().chain(collapsed).collect()
    }

    /// ln of the evidence of the rows so far, see [`Run::log_evidence`](crate::Run::log_evidence);
    /// 0 before the first pose.
    pub fn log_evidence(&self) -> f64 {
        self.filter
            .as_ref()
            .map_or(0.0, ContactFilter::log_evidence)
    }
}
