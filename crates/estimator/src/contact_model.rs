//! The particle filter's model of a pushed object (eq. 6): Γ' as transition, camera and tactile
//! sensors as observation.

use stickslip_dynamics::{Dynamics, Lanes, Level, Mask, Pose, StepInput, on_widest};
use stickslip_filter::{Block, BlockMut, Draw, Model};

use crate::angle::{nearest_zero, wrapped};
use crate::chunk::{Column, LANES, flag, part, store_part};
use crate::columns::Columns;
use crate::propagation::Propagation;
use crate::sums::{Reference, Sums};
use crate::watch::StepWatch;
use crate::{Camera, Setup};

/// Best log-likelihood below which no particle explains the observation: the particles are
/// reinitialised around it.
const COLLAPSED: f64 = -6.0;

/// Whether the friction parameters take a random step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterNoise {
    /// β̂ = β + w_β τ(β).
    Drawn,
    /// β̂ = β, while the camera is blacked out.
    Frozen,
}

/// One step of a log.
#[derive(Clone, Debug)]
pub struct StepPlan {
    /// Substeps; their lengths sum to the step's.
    pub substeps: Vec<StepInput>,
    /// Whether the pusher moves.
    pub driven: bool,
    /// Whether the parameters move.
    pub parameter_noise: ParameterNoise,
    /// Ring slot for the pose at the end of the step, where past poses are kept.
    pub slot: usize,
    /// Near what the particles' columns will be.
    pub reference: Reference,
}

impl StepPlan {
    /// No step at all.
    pub(crate) fn none(reference: Reference) -> Self {
        Self {
            substeps: Vec::new(),
            driven: false,
            parameter_noise: ParameterNoise::Frozen,
            slot: 0,
            reference,
        }
    }
}

/// Where in a particle's past the camera looks: between two ring slots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookback {
    /// Slot of the earlier pose.
    pub earlier: usize,
    /// Slot of the later pose.
    pub later: usize,
    /// Fraction of the way from the earlier to the later.
    pub fraction: f64,
}

/// What the sensors read at one row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observation {
    /// Camera pose.
    pub pose: Option<Pose>,
    /// Where the camera looks back to; `None` is the present.
    pub lookback: Option<Lookback>,
    /// Tactile readings, one per sensor.
    pub tactile: Vec<Option<bool>>,
}

impl Observation {
    /// True where nothing was read.
    pub fn is_empty(&self) -> bool {
        self.pose.is_none() && self.tactile.iter().all(Option::is_none)
    }
}

/// The model of one setup, started at one pose.
#[derive(Clone, Debug)]
pub struct ContactModel<'w> {
    pub(crate) dynamics: Dynamics,
    pub(crate) setup: Setup,
    camera: Camera,
    /// log-probability of a reading, by whether the particle touches and by what was read.
    reading: [[f64; 2]; 2],
    start: Pose,
    pub(crate) columns: Columns,
    pub(crate) watch: Option<&'w dyn StepWatch>,
}

impl<'w> ContactModel<'w> {
    /// A model whose particles start around `start`, with `history` past poses per particle.
    pub fn new(setup: &Setup, camera: Camera, start: Pose, history: usize) -> Self {
        let columns = Columns::new(setup.scene.fixels.len(), history);
        let (missed, invented) = (setup.tactile.false_negative, setup.tactile.false_positive);
        let reading =
            [[1.0 - invented, invented], [missed, 1.0 - missed]].map(|row| row.map(libm::log));
        Self {
            dynamics: Dynamics::new(setup.scene.clone()),
            setup: setup.clone(),
            camera,
            reading,
            start,
            columns,
            watch: None,
        }
    }

    /// The same, with a `watch` that is shown every step solved.
    #[must_use]
    pub fn watched(self, watch: Option<&'w dyn StepWatch>) -> Self {
        Self { watch, ..self }
    }

    /// x, y and θ of one chunk's particles where the camera sees them.
    #[inline(always)]
    fn seen(&self, lookback: Option<Lookback>, block: &Block<'_>, chunk: usize) -> [Column; 3] {
        let Some(Lookback {
            earlier,
            later,
            fraction,
        }) = lookback
        else {
            return pose(block, Columns::POSE, chunk);
        };
        let mut seen = pose(block, self.columns.past_pose(earlier), chunk);
        for (seen, later) in seen
            .iter_mut()
            .zip(pose(block, self.columns.past_pose(later), chunk))
        {
            *seen += (later - *seen) * fraction;
        }
        seen
    }

    /// log of the camera's likelihood up to a constant: normal, its standard deviations widened by
    /// `likelihood_scale`; 0 where it saw nothing.
    #[inline(always)]
    fn camera_log_likelihood(
        &self,
        observation: &Observation,
        block: &Block<'_>,
        chunk: usize,
    ) -> Column {
        let Some(measured) = observation.pose else {
            return Column::ZERO;
        };
        let [x, y, theta] = self.seen(observation.lookback, block, chunk);
        let scale = self.setup.filter.likelihood_scale;
        let [per_metre, per_radian] = [
            1.0 / (scale * self.camera.position_std),
            1.0 / (scale * self.camera.orientation_std),
        ];
        let (dx, dy) = ((x - measured.x) * per_metre, (y - measured.y) * per_metre);
        let turn = nearest_zero(theta - measured.theta) * per_radian;
        (dx * dx + dy * dy + turn * turn) * -0.5
    }

    /// log-probability of the tactile readings given one chunk's contacts.
    ///
    /// What a driven particle touches its impulses tell. An idle one stays where it is whether the
    /// pusher that stands behind it presses on it or not, since the support's friction holds it:
    /// both are certified solutions of its step, and which of them a step returns is an accident of
    /// the warm start and the tracking noise. The one that explains the readings counts.
    #[inline(always)]
    fn tactile_log_likelihood(
        &self,
        readings: &[Option<bool>],
        block: &Block<'_>,
        chunk: usize,
    ) -> Column {
        let driven = self.readings_log_probability(
            readings,
            #[inline(always)]
            |j| flag(block, self.columns.contact_fixel(j), chunk),
        );
        let idle = flag(block, Columns::IDLE, chunk);
        if !idle.any() {
            return driven;
        }
        let pressed = self.readings_log_probability(
            readings,
            #[inline(always)]
            |j| flag(block, self.columns.against_fixel(j), chunk),
        );
        let untouched = self.readings_log_probability(
            readings,
            #[inline(always)]
            |_| Mask::splat(false),
        );
        idle.select(pressed.max(untouched), driven)
    }

    #[inline(always)]
    fn readings_log_probability(
        &self,
        readings: &[Option<bool>],
        touches: impl Fn(usize) -> Mask<LANES>,
    ) -> Column {
        let mut sum = Column::ZERO;
        for (j, reading) in readings.iter().enumerate() {
            if let Some(reading) = reading {
                let [free, touching] =
                    [0, 1].map(|touches| self.reading[touches][usize::from(*reading)]);
                sum += touches(j).select(Lanes::splat(touching), Lanes::splat(free));
            }
        }
        sum
    }
}

/// Three neighbouring columns of one chunk.
#[inline(always)]
fn pose(block: &Block<'_>, first_column: usize, chunk: usize) -> [Column; 3] {
    // an array made by a closure would be made by baseline code, and copied
    let [x, y, theta] = [first_column, first_column + 1, first_column + 2];
    [
        part(block.column(x), chunk, 0.0),
        part(block.column(y), chunk, 0.0),
        part(block.column(theta), chunk, 0.0),
    ]
}

/// Writes `value(chunk)` for every chunk of particles, on the widest instructions.
fn by_chunk(out: &mut [f64], value: impl Fn(usize) -> Column) {
    on_widest(
        Level::new(),
        #[inline(always)]
        || {
            for chunk in 0..out.len().div_ceil(LANES) {
                store_part(out, chunk, &value(chunk));
            }
        },
    );
}

impl Model for ContactModel<'_> {
    type Input = StepPlan;
    type Observation = Observation;
    type Scratch = Propagation;
    type Sums = Sums;

    fn columns(&self) -> usize {
        self.columns.count()
    }

    fn scratch(&self) -> Propagation {
        Propagation::default()
    }

    fn initialise(&self, draw: Draw, block: &mut BlockMut<'_>) {
        let nominal = self.setup.scene.nominal;
        for (i, particle) in block.particles() {
            let pose = self.drawn_around(&self.start, draw.normals::<3>(particle, 0));
            write(block, Columns::POSE, i, &pose);
            write(
                block,
                Columns::FRICTION,
                i,
                &[nominal.mu_s, nominal.mu_p, nominal.mu_f, nominal.d_tri],
            );
            for slot in 0..self.columns.history() {
                write(block, self.columns.past_pose(slot), i, &pose);
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
        scratch.propagate(self, plan, draw, block);
    }

    fn log_likelihood(&self, observation: &Observation, block: &Block<'_>, out: &mut [f64]) {
        by_chunk(
            out,
            #[inline(always)]
            |chunk| {
                self.camera_log_likelihood(observation, block, chunk)
                    + self.tactile_log_likelihood(&observation.tactile, block, chunk)
            },
        );
    }

    fn sum(&self, plan: &StepPlan, block: &Block<'_>, weights: &[f64], sums: &mut Sums) {
        on_widest(
            Level::new(),
            #[inline(always)]
            || sums.take(block, weights, &plan.reference, self.columns),
        );
    }

    /// The camera's alone: reinitialising the pose makes no touch likelier.
    fn resetting_log_likelihood(
        &self,
        observation: &Observation,
        block: &Block<'_>,
        out: &mut [f64],
    ) {
        by_chunk(
            out,
            #[inline(always)]
            |chunk| self.camera_log_likelihood(observation, block, chunk),
        );
    }

    fn collapsed(&self, best_log_likelihood: f64) -> bool {
        best_log_likelihood < COLLAPSED
    }

    /// Moves every particle, its past included, so that what the camera sees is drawn around the
    /// measured pose.
    fn reinitialise(&self, observation: &Observation, draw: Draw, block: &mut BlockMut<'_>) {
        let Some(measured) = observation.pose else {
            return;
        };
        for (i, particle) in block.particles() {
            let seen = self
                .seen(observation.lookback, &block.as_block(), i / LANES)
                .map(|column| column.0[i % LANES]);
            let [x, y, theta] = self.drawn_around(&measured, draw.normals::<3>(particle, 0));
            let shift = [x - seen[0], y - seen[1], wrapped(theta - seen[2])];
            let past = (0..self.columns.history()).map(|slot| self.columns.past_pose(slot));
            for column in std::iter::once(Columns::POSE).chain(past) {
                for (axis, shift) in shift.iter().enumerate() {
                    block.column_mut(column + axis)[i] += shift;
                }
            }
        }
    }
}

impl<'w> ContactModel<'w> {
    fn drawn_around(&self, pose: &Pose, normals: [f64; 3]) -> [f64; 3] {
        let camera = &self.camera;
        [
            pose.x + camera.position_std * normals[0],
            pose.y + camera.position_std * normals[1],
            pose.theta + camera.orientation_std * normals[2],
        ]
    }
}

fn write(block: &mut BlockMut<'_>, first_column: usize, i: usize, values: &[f64]) {
    for (k, value) in values.iter().enumerate() {
        block.column_mut(first_column + k)[i] = *value;
    }
}
