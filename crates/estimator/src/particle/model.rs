//! The particle filter's model of a pushed object (docs/method.md (17) to (27); paper eq. 6): Γ' as
//! transition, camera and tactile sensors as observation.

use stickslip_dynamics::{Dynamics, Level, Pose, on_widest};
use stickslip_filter::{BLOCK, Block, BlockMut, Draw, EnsembleShape, Model};

use crate::covariance::PoseCovariance;
use crate::filter_model::FilterModel;
use crate::particle::estimate::sums::Sums;
use crate::particle::sensor::camera_likelihood::CameraLikelihood;
use crate::particle::sensor::force_likelihood::ForceBias;
use crate::particle::sensor::observation::{Observation, PoseAt};
use crate::particle::sensor::tactile_likelihood::TactileLikelihood;
use crate::particle::sensor::touch_channel::TouchChannel;
use crate::particle::set::chunk::{Column, LANES, is_set, load_chunk, store_chunk};
use crate::particle::set::columns::Columns;
use crate::particle::set::observer::Observer;
use crate::particle::transition::propagation::{Propagation, Transition};
use crate::particle::transition::step_plan::StepPlan;
use crate::particle::unknown::moved;
use crate::particle::unknown::table;
use crate::setup::{Camera, Setup};
use crate::tuning::COLLAPSED;

/// The model of one setup, started at one pose.
///
/// A new sensor is one more field of [`Observation`] and one more term of
/// [`log_likelihood`](Model::log_likelihood), in a file next to [`CameraLikelihood`] and
/// [`TactileLikelihood`]. The whole way is in docs/method.md, "From the paper to the code".
#[derive(Clone, Debug)]
pub struct ContactModel<'o> {
    transition: Transition<'o>,
    camera: Camera,
    start: PoseAt,
    camera_likelihood: CameraLikelihood,
    tactile_likelihood: TactileLikelihood,
    /// Least share of a camera pose that moves particles.
    least_moved: f64,
}

impl<'o> ContactModel<'o> {
    /// A model whose particles start around `start`, with `history` past poses per particle.
    pub fn new(
        model: FilterModel,
        setup: &Setup,
        camera: Camera,
        start: PoseAt,
        history: usize,
    ) -> Self {
        let columns = Columns::new(model, setup.scene.fixels.len(), history)
            .with_fingers(setup.scene.pusher.fingers.len())
            .with_force(setup.wrench.is_some());
        Self {
            transition: Transition {
                dynamics: Dynamics::new(setup.scene.clone()),
                setup: setup.clone(),
                columns,
                observer: None,
            },
            camera,
            start,
            camera_likelihood: CameraLikelihood::new(&camera, setup, columns),
            tactile_likelihood: TactileLikelihood::new(&setup.tactile, columns),
            least_moved: 0.0,
        }
    }

    /// Returns the part that moves the particles.
    pub fn transition(&self) -> &Transition<'o> {
        &self.transition
    }

    /// The model with an `observer` that is shown every step solved.
    #[must_use]
    pub fn observed(mut self, observer: Option<&'o dyn Observer>) -> Self {
        self.transition.observer = observer;
        self
    }

    /// The model of particles that a camera pose moves by this share at least.
    #[must_use]
    pub fn moved_by(mut self, least: f64) -> Self {
        self.least_moved = least;
        self
    }

    /// Layout of the columns.
    pub fn columns(&self) -> Columns {
        self.transition.columns
    }

    /// Makes each particle keep `poses` past poses from now on, at least as many as before.
    pub fn keep_history(&mut self, poses: usize) {
        let columns = self.columns().with_history(poses);
        let setup = &self.transition.setup;
        self.camera_likelihood.set_columns(columns);
        self.tactile_likelihood = TactileLikelihood::new(&setup.tactile, columns);
        self.transition.columns = columns;
    }

    /// Noise, limits and sensors.
    pub(crate) fn setup(&self) -> &Setup {
        &self.transition.setup
    }

    /// The object's radius of gyration (m).
    pub fn gyration_radius(&self) -> f64 {
        self.transition.setup.scene.object.gyration_radius()
    }

    /// Sets whether poses that no particle explains reinitialise them all, or count as wrong
    /// (robust model).
    pub fn accept_poses(&mut self, all: bool) {
        self.camera_likelihood.accept_poses(all);
    }

    /// Likelihood of the camera's poses.
    pub(crate) fn camera_likelihood(&self) -> &CameraLikelihood {
        &self.camera_likelihood
    }

    /// Draws a pose around `pose` with the noise of a camera pose, by its own covariance if it has
    /// one.
    fn drawn_around(
        &self,
        (pose, covariance): (&Pose, Option<PoseCovariance>),
        [x, y, theta]: [f64; 3],
    ) -> Pose {
        if let Some(factor) = covariance.and_then(|c| c.factor()) {
            let error = factor.drawn([x, y, theta]);
            return Pose {
                x: pose.x + error.x,
                y: pose.y + error.y,
                theta: pose.theta + error.theta,
            };
        }
        let camera = &self.camera;
        Pose {
            x: pose.x + camera.position_std * x,
            y: pose.y + camera.position_std * y,
            theta: pose.theta + camera.orientation_std * theta,
        }
    }

    /// Lets the particles learn the camera's noise from the pose that weighed them last (robust
    /// model).
    fn learn_of_camera(&self, seen: &Observation, block: &mut BlockMut<'_>) {
        on_widest(
            Level::new(),
            #[inline(always)]
            || {
                for chunk in 0..block.len().div_ceil(LANES) {
                    self.camera_likelihood.learn(seen, block, chunk);
                }
            },
        );
    }

    /// Draws the unknowns of the robust model from their priors.
    fn draw_unknowns(&self, draw: Draw, particle: u32, block: &mut BlockMut<'_>, i: usize) {
        let Transition { setup, columns, .. } = &self.transition;
        let friction = setup.drawn_friction(draw.normals::<4>(particle, 4));
        write(block, Columns::FRICTION, i, friction.fields());
        table::draw(*columns, (draw, particle), block, i);
        for k in 0..3 {
            block.column_mut(columns.camera_noise() + k)[i] = 0.0;
        }
        if let Some(sensor) = &setup.wrench {
            let bias = ForceBias::prior(sensor);
            let bias = bias.numbers().map(|number| number.0[0]);
            write(block, columns.force_bias(), i, bias.each_ref());
        }
        let sensor = TouchChannel::new(&setup.tactile).start::<1>();
        let sensor = sensor.fields().map(|number| number.0[0]);
        for j in 0..columns.sensors() {
            write(block, columns.sensor(j), i, sensor.each_ref());
        }
    }
}

impl Model for ContactModel<'_> {
    type Input = StepPlan;
    type Observation = Observation;
    type Scratch = Propagation;
    type Sums = Sums;

    fn columns(&self) -> usize {
        self.transition.columns.count()
    }

    fn scratch(&self) -> Propagation {
        Propagation::default()
    }

    /// Draws poses as noisy as the camera's first one, at rest, all with the nominal friction.
    fn initialise(&self, draw: Draw, block: &mut BlockMut<'_>) {
        let start = (&self.start.pose, self.start.covariance);
        for (i, particle) in block.particles() {
            let pose = self.drawn_around(start, draw.normals::<3>(particle, 0));
            write(block, Columns::POSE, i, pose.fields());
            write(
                block,
                Columns::FRICTION,
                i,
                self.transition.setup.scene.nominal.fields(),
            );
            if self.columns().model() == FilterModel::Robust {
                self.draw_unknowns(draw, particle, block, i);
            }
            for slot in 0..self.columns().history() {
                write(block, self.columns().past_pose(slot), i, pose.fields());
            }
        }
    }

    fn propagate(
        &self,
        plan: &StepPlan,
        draw: Draw,
        block: &mut BlockMut<'_>,
        scratch: &mut Propagation,
    ) {
        if plan.seen.pose.is_some() {
            self.learn_of_camera(&plan.seen, block);
        }
        scratch.propagate(&self.transition, plan, draw, block);
    }

    fn log_likelihood(&self, observation: &Observation, block: &Block<'_>, out: &mut [f64]) {
        by_chunk(
            out,
            #[inline(always)]
            |chunk| {
                let camera = &self.camera_likelihood;
                let of_step = match self.columns().model() {
                    FilterModel::Paper => {
                        let tactile = &self.tactile_likelihood;
                        tactile.log_likelihood(&observation.tactile, block, chunk)
                    }
                    FilterModel::Robust if !observation.weighs_step => Column::ZERO,
                    FilterModel::Robust => {
                        let column = self.columns().step_log_likelihood();
                        load_chunk(block.column(column), chunk, 0.0)
                    }
                };
                camera.log_likelihood(observation, block, chunk) + of_step
            },
        );
    }

    fn sum(&self, plan: &StepPlan, block: &Block<'_>, weights: &[f64], sums: &mut Sums) {
        on_widest(
            Level::new(),
            #[inline(always)]
            || sums.evaluate(block, weights, &plan.reference, self.columns()),
        );
    }

    /// Returns that of the camera alone: reinitialising the pose makes no touch likelier.
    fn resetting_log_likelihood(
        &self,
        observation: &Observation,
        block: &Block<'_>,
        out: &mut [f64],
    ) {
        by_chunk(
            out,
            #[inline(always)]
            |chunk| {
                self.camera_likelihood
                    .log_likelihood(observation, block, chunk)
            },
        );
    }

    fn judges_resetting(&self, observation: &Observation) -> bool {
        self.columns().model() == FilterModel::Robust && observation.pose.is_some()
    }

    fn ensemble(&self) -> EnsembleShape {
        match self.columns().model() {
            FilterModel::Paper => EnsembleShape::default(),
            FilterModel::Robust => EnsembleShape {
                quantities: moved::count(self.columns()),
                errors: 3,
            },
        }
    }

    fn moves(&self, observation: &Observation) -> bool {
        observation.moves && observation.pose.is_some()
    }

    fn least_moved(&self, _: &Observation) -> f64 {
        self.least_moved
    }

    fn plausibility(&self, _: &Observation, log_evidence: f64) -> f64 {
        self.camera_likelihood.right(log_evidence)
    }

    fn read_ensemble(&self, observation: &Observation, block: &Block<'_>, to: &mut [f64]) {
        let (quantities, errors) = to.split_at_mut(moved::count(self.columns()) * BLOCK);
        moved::read(self.columns(), block, quantities);
        for chunk in 0..block.len().div_ceil(LANES) {
            let of_chunk = self.camera_likelihood.errors(observation, block, chunk);
            let noise = self.camera_likelihood.estimated_noise(block, chunk);
            let of_chunk = of_chunk.iter().chain(&noise);
            for (errors, column) in errors.chunks_mut(BLOCK).zip(of_chunk) {
                errors[chunk * LANES..][..LANES].copy_from_slice(&column.0);
            }
        }
    }

    fn write_ensemble(&self, from: &[f64], block: &mut BlockMut<'_>) {
        moved::write(self.columns(), from, block);
    }

    /// Returns false if the solver found neither a solution nor a proof that there is none.
    fn may_be_copied(&self, block: &Block<'_>, i: usize) -> bool {
        !is_set(block, Columns::FAILED, i)
    }

    fn collapsed(&self, best_log_likelihood: f64) -> bool {
        self.camera_likelihood.accepts_all() && best_log_likelihood < COLLAPSED
    }

    /// Moves every particle, its past included, so that the pose which the camera sees is drawn
    /// around the measured one.
    fn reinitialise(&self, observation: &Observation, draw: Draw, block: &mut BlockMut<'_>) {
        let Some(measured) = observation.pose else {
            return;
        };
        for (i, particle) in block.particles() {
            let camera = &self.camera_likelihood;
            let chunk = camera.shown(observation, &block.as_block(), i / LANES);
            let shown = chunk.map(|column| column.0[i % LANES]);
            let drawn = self.drawn_around(
                (&measured, observation.covariance),
                draw.normals::<3>(particle, 0),
            );
            // not the shorter way: all are to end with the same winding
            let shift = Pose {
                x: drawn.x - shown.x,
                y: drawn.y - shown.y,
                theta: drawn.theta - shown.theta,
            };
            let past = (0..self.columns().history()).map(|slot| self.columns().past_pose(slot));
            for column in std::iter::once(Columns::POSE).chain(past) {
                for (axis, shift) in shift.fields().into_iter().enumerate() {
                    block.column_mut(column + axis)[i] += shift;
                }
            }
        }
    }
}

/// Writes `value(chunk)` for every chunk of particles, on the widest instructions.
fn by_chunk(out: &mut [f64], value: impl Fn(usize) -> Column) {
    on_widest(
        Level::new(),
        #[inline(always)]
        || {
            for chunk in 0..out.len().div_ceil(LANES) {
                store_chunk(out, chunk, &value(chunk));
            }
        },
    );
}

/// Writes neighbouring columns of particle `i`.
pub(super) fn write<const N: usize>(
    block: &mut BlockMut<'_>,
    first_column: usize,
    i: usize,
    values: [&f64; N],
) {
    for (k, value) in values.into_iter().enumerate() {
        block.column_mut(first_column + k)[i] = *value;
    }
}
