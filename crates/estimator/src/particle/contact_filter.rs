//! The particle filter over contact dynamics, one row at a time: [`ContactFilter`], docs/method.md,
//! "The particle filter" (paper §III-D).

use std::num::NonZero;

use stickslip_dynamics::{Pose, StepInput};
use stickslip_filter::{
    BLOCK, Draw, Model, ParticleFilter, Purpose, Resampling, Settings, StepReport, Streams,
    WeightUpdate,
};

use crate::covariance::PoseCovariance;
use crate::error::RunError;
use crate::estimate::EstimateRow;
use crate::filter_model::FilterModel;
use crate::outcomes::{End, Outcomes};
use crate::particle::estimate::end::end as end_of;
use crate::particle::estimate::mode_finder::ModeFinder;
use crate::particle::estimate::summary::summarise;
use crate::particle::estimate::sums::Reference;
use crate::particle::model::ContactModel;
use crate::particle::sensor::camera_gate::CameraGate;
use crate::particle::sensor::observation::{Observation, PoseAt};
use crate::particle::sensor::pusher_likelihood::{Push, fastest};
use crate::particle::set::history::PoseHistory;
use crate::particle::set::observer::Observer;
use crate::particle::set::view::ParticleView;
use crate::particle::transition::noise_clock::NoiseClock;
use crate::particle::transition::step_plan::{Drive, ParameterNoise, StepPlan};
use crate::particle::transition::unseen_pusher::HiddenPusher;
use crate::pose_clock::PoseClock;
use crate::setup::{Camera, Setup};
use crate::tuning::{LEAST_MOVED, TOUCHING};

/// Measurements of a row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured<'a> {
    /// Time (s).
    pub time: f64,
    /// Pose of the object, where the camera saw it.
    pub object: Option<Pose>,
    /// Covariance of that pose, if it has one of its own.
    pub covariance: Option<PoseCovariance>,
    /// Tactile readings that count, one per sensor.
    pub tactile: &'a [Option<bool>],
    /// Force of the pusher on the object (N).
    pub force: Option<[f64; 2]>,
}

/// Options of a contact filter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FilterOptions<'o> {
    /// Configuration of the filter.
    pub model: FilterModel,
    /// Number of particles.
    pub particles: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Longest time before the latest row at which late poses may show the object (s).
    pub late: f64,
    /// True if camera poses may move particles (robust model).
    pub camera_moves: bool,
    /// Observer of every time step.
    pub observer: Option<&'o dyn Observer>,
}

impl FilterOptions<'_> {
    /// Settings of the particle filter.
    pub fn settings(&self, setup: &Setup) -> Settings {
        Settings {
            particles: self.particles,
            seed: self.seed,
            resample_below: setup.filter.resample_below,
            resampling: Resampling::Systematic,
        }
    }
}

/// The particle filter, with the estimate at the latest row.
#[derive(Clone)]
pub(crate) struct ContactFilter<'o> {
    filter: ParticleFilter<ContactModel<'o>>,
    history: PoseHistory,
    latency: f64,
    camera: PoseClock,
    noise: NoiseClock,
    plan: StepPlan,
    observation: Observation,
    latest: EstimateRow,
    /// Values about which the next row's sums are taken: the means of the latest one.
    reference: Reference,
    modes: ModeFinder,
    collapses: u32,
    /// True if the latest row reinitialised the particles.
    collapsed: bool,
    /// ln of the likelihood that the particles gave to the rows so far.
    log_evidence: f64,
    gate: CameraGate,
    pusher: HiddenPusher,
    push: Push,
    /// The latest camera pose.
    shown: Pose,
    /// True if camera poses may move particles (robust model).
    camera_moves: bool,
}

impl<'o> ContactFilter<'o> {
    /// Particles around `start`.
    ///
    /// # Errors
    /// Where the filter's settings are out of range.
    pub fn new(
        setup: &Setup,
        camera: Camera,
        start: PoseAt,
        options: &FilterOptions<'o>,
    ) -> Result<Self, RunError> {
        let unknown = match options.model {
            FilterModel::Robust => setup.uncertainty.most_latency(),
            FilterModel::Paper => 0.0,
        };
        let PoseAt { time, pose, .. } = start;
        let history = PoseHistory::new(camera.latency + unknown + options.late, time);
        let model = ContactModel::new(options.model, setup, camera, start, history.slots());
        let model = model.observed(options.observer).moved_by(LEAST_MOVED);
        let reference = Reference::new(pose, setup.scene.nominal);
        let mut this = Self {
            filter: ParticleFilter::new(model, options.settings(setup))?,
            history,
            latency: camera.latency,
            camera: PoseClock::new(time),
            noise: NoiseClock::default(),
            plan: StepPlan::none(reference),
            reference,
            observation: Observation::default(),
            latest: EstimateRow::default(),
            modes: ModeFinder::new(setup.scene.object.gyration_radius(), camera.position_std),
            collapses: 0,
            collapsed: false,
            log_evidence: 0.0,
            gate: CameraGate::default(),
            pusher: HiddenPusher::default(),
            push: Push::default(),
            shown: pose,
            camera_moves: options.camera_moves && options.model == FilterModel::Robust,
        };
        this.filter.recompute_sums(&this.plan);
        this.summarise();
        this.latest.visual = true;
        Ok(this)
    }

    /// Takes one row: the step that leads to it, then its measurements.
    pub fn step(&mut self, measured: Measured<'_>, drive: Drive<'_>) -> &EstimateRow {
        let measured = Measured {
            object: measured.object.filter(|pose| self.is_new(*pose)),
            ..measured
        };
        let was_dark = self.plan.is_dark();
        let was_unwatched = was_dark && self.pusher.is_hidden();
        self.plan_step(&measured, drive);
        self.remember_observation();
        self.observation.pose = measured.object;
        self.observation.covariance = measured.covariance;
        self.look_back(measured.time);
        self.observation.latency = self.history.at(measured.time - self.latency);
        self.observation.tactile.clear();
        let tactile = measured.tactile.iter().copied();
        self.observation.tactile.extend(tactile);
        let contact = self.model() == FilterModel::Robust;
        self.observation.weighs_step = contact;
        self.observation.moves = self.camera_moves;

        self.expect_pose(was_unwatched);
        let observation = Some(&self.observation).filter(|observation| !observation.is_empty());
        let report = self.filter.step(&self.plan, observation);
        self.take(&report);
        if let WeightUpdate::Weighed { log_evidence } = report.weight_update {
            self.log_evidence += log_evidence;
        }
        self.summarise();
        self.latest.collapsed = Some(self.collapsed);
        self.latest.resampled = Some(report.resampled);
        self.latest.visual = measured.object.is_some();
        if self.latest.visual {
            self.filter.count_ancestors_from_now();
        }
        &self.latest
    }

    /// Goes on with another number of particles; nothing changes if it is the same.
    pub fn resize(&mut self, particles: NonZero<u32>) {
        if particles == self.count() {
            return;
        }
        let resized = self.filter.resize(particles.get() as usize);
        resized.expect("a u32 from 1 up is a number of particles");
    }

    /// Configuration of the filter.
    pub fn model(&self) -> FilterModel {
        self.filter.model().columns().model()
    }

    /// The number of particles.
    pub fn count(&self) -> NonZero<u32> {
        let count = u32::try_from(self.filter.particles().len());
        let count = count.ok().and_then(NonZero::new);
        count.expect("a particle set is numbered in u32 and never empty")
    }

    /// Returns true if a camera pose is a new measurement. In the robust model, a pose that equals
    /// the one before is that frame again.
    fn is_new(&mut self, pose: Pose) -> bool {
        let before = std::mem::replace(&mut self.shown, pose);
        pose != before || self.model() == FilterModel::Paper
    }

    /// Decides before a camera pose whether it is accepted even if no particle explains it. It is
    /// if it is the first one after neither object nor pusher was seen.
    fn expect_pose(&mut self, was_unwatched: bool) {
        if self.observation.pose.is_none() {
            return;
        }
        if let Some(all) = self.gate.expect(was_unwatched) {
            self.filter.change_model(|model| model.accept_poses(all));
        }
    }

    /// Keeps the observation that weighed the particles last, for them to learn from (robust
    /// model).
    fn remember_observation(&mut self) {
        std::mem::swap(&mut self.plan.seen, &mut self.observation);
        let contact = self.model() == FilterModel::Robust;
        if !contact || self.collapsed {
            self.plan.seen.pose = None;
        }
    }

    /// Notes where each particle finds its past poses.
    fn look_back(&mut self, time: f64) {
        self.observation.time = time;
        self.observation.past.clear();
        if self.model() == FilterModel::Robust {
            self.observation.past.extend(self.history.kept());
        }
    }

    /// Takes the effect that a row's pose, on time or late, had on the particles.
    fn take(&mut self, report: &StepReport) {
        self.collapsed = report.collapsed();
        self.collapses += u32::from(self.collapsed);
        self.gate.judge(report);
    }

    /// Writes the plan of the step to a row.
    fn plan_step(&mut self, measured: &Measured<'_>, drive: Drive<'_>) {
        let model = self.model();
        let plan = &mut self.plan;
        plan.substeps.clear();
        plan.substeps.extend_from_slice(drive.substeps);
        plan.driven = drive.moves;
        plan.tactile.clear();
        plan.tactile.extend_from_slice(measured.tactile);
        plan.parameter_noise = match self
            .camera
            .is_dark(measured.time, measured.object.is_some())
        {
            false => ParameterNoise::Drawn,
            true => ParameterNoise::Frozen,
        };
        plan.noise_age = self.noise.age(plan.duration());
        plan.reference = self.reference;
        let setup = self.filter.model().setup();
        let scene = &setup.scene;
        // near a fixel the force depends on the very pose that is sought in the dark
        let open = !plan.is_dark() || scene.fixels.is_empty();
        let counts = open && setup.wrench.is_some() && model == FilterModel::Robust;
        plan.force = measured.force.filter(|_| counts);
        plan.pusher_is_back = false;
        plan.unseen_pusher = match drive.substeps.last().filter(|_| !drive.unseen) {
            Some(last) => {
                plan.pusher_is_back = self.pusher.seen(plan.duration(), last, drive.moves);
                None
            }
            None => {
                let hidden_object = self.latest.pose.filter(|_| plan.is_dark());
                self.pusher.unseen(scene, plan.duration(), hidden_object)
            }
        };
        if let Some(pusher) = drive.substeps.last().and_then(|step| step.pusher)
            && drive.moves
            && model == FilterModel::Paper
        {
            plan.touching = TOUCHING.max(fastest(&pusher) * plan.duration());
        }
        let least = self.filter.model().setup().uncertainty.pusher_lag;
        plan.stopped = self.push.stops(&drive, plan.duration(), least);
        plan.slot = self.history.push(measured.time);
        let slots = self.history.slots();
        if slots > self.filter.model().columns().history() {
            self.filter.change_model(|model| model.keep_history(slots));
        }
    }

    /// Takes a row that comes so soon after the latest step that no step leads to it. Its pose is
    /// weighed as one of the past.
    pub fn look(&mut self, measured: Measured<'_>) -> &EstimateRow {
        let seen = measured.object.is_some_and(|pose| {
            self.weigh(PoseAt {
                time: measured.time,
                pose,
                covariance: measured.covariance,
            })
        });
        let row = &mut self.latest;
        row.visual = seen;
        for count in [&mut row.unsolved, &mut row.failed] {
            *count = count.map(|_| 0);
        }
        row.resampled = row.resampled.map(|_| false);
        row.collapsed = row.collapsed.map(|collapsed| collapsed && seen);
        &self.latest
    }

    /// Weighs the particles by a pose that arrives late, against their own poses at its time. The
    /// latency has not been subtracted from that time.
    pub fn weigh_late(&mut self, late: PoseAt) -> &EstimateRow {
        self.weigh(late);
        &self.latest
    }

    /// Weighs the particles by a pose; returns true if it is a new one.
    fn weigh(&mut self, late: PoseAt) -> bool {
        if !self.is_new(late.pose) {
            return false;
        }
        let PoseAt { time, pose, .. } = late;
        self.observation.pose = Some(pose);
        self.observation.covariance = late.covariance;
        self.look_back(time);
        self.observation.latency = self.history.at(time - self.latency);
        self.observation.tactile.clear();
        self.observation.weighs_step = false;
        self.observation.moves = self.camera_moves;
        self.expect_pose(false);
        let report = self.filter.observe(&self.plan, &self.observation);
        self.take(&report);
        self.camera.late_pose();
        self.summarise();
        self.filter.count_ancestors_from_now();
        self.latest.collapsed = Some(self.collapsed);
        true
    }

    /// Writes the estimate of the particles.
    fn summarise(&mut self) {
        let row = &mut self.latest;
        summarise(&self.filter, &self.plan.reference, row);
        if let Some((pose, spread)) = row.pose.zip(row.spread) {
            let belief = (pose, spread.pose);
            self.modes.find(&self.filter, belief, &mut row.modes);
        }
        if let Some(reference) = Reference::of(row) {
            self.reference = reference;
        }
        let lineage = self.filter.lineage();
        row.distinct = Some(lineage.parents() as u32);
        row.ancestors = Some(lineage.ancestors() as u32);
    }

    /// The estimate at the latest row.
    pub fn latest(&self) -> &EstimateRow {
        &self.latest
    }

    /// The particles after the latest row.
    pub fn particles(&self) -> ParticleView<'_> {
        let weighed = (self.filter.particles(), self.filter.weights());
        let driven = self.plan.driven;
        ParticleView::new(weighed, self.filter.model(), &self.observation, driven)
    }

    /// Moves copies of the particles over the steps of a plan, and returns how they end. The random
    /// numbers are those that the next rows would use.
    pub fn outcomes(&self, steps: &[Vec<StepInput>]) -> Outcomes {
        let model = self.filter.model();
        let transition = model.transition();
        let streams = Streams::new(self.filter.settings().seed).of(Purpose::Propagate);
        let mut noise = self.noise;
        let plans = steps.iter().enumerate().map(|(row, substeps)| {
            let mut plan = StepPlan {
                substeps: substeps.clone(),
                driven: true,
                intended: true,
                // what moves in the last step moves by itself
                undisturbed: row + 1 == steps.len(),
                slot: self.plan.slot,
                ..StepPlan::none(self.reference)
            };
            plan.noise_age = noise.age(plan.duration());
            (plan, streams.at(self.filter.steps() + 1 + row as u64))
        });
        let plans: Vec<(StepPlan, Draw)> = plans.collect();
        let touching = plans.last().map_or(0.0, |(plan, _)| plan.touching);
        let rho = transition.setup.scene.object.gyration_radius();
        let mut particles = self.filter.particles().clone();
        let mut ends = vec![End::default(); particles.len()];
        particles.advance(None, ends.chunks_mut(BLOCK), |block, ends| {
            let mut scratch = model.scratch();
            for (plan, draw) in &plans {
                scratch.propagate(transition, plan, *draw, block);
            }
            for (i, end) in ends.iter_mut().enumerate() {
                *end = end_of(&scratch, i, rho, touching);
            }
        });
        Outcomes::of(&ends, self.filter.weights().weights())
    }

    /// Number of rows at which no particle explained the camera pose, so that all were
    /// reinitialised around it.
    pub fn collapses(&self) -> u32 {
        self.collapses
    }

    /// ln of the evidence of the rows so far: the likelihood that the particles gave them, up to a
    /// constant of the sensors. Rows at which they collapsed are left out.
    pub fn log_evidence(&self) -> f64 {
        self.log_evidence
    }
}
