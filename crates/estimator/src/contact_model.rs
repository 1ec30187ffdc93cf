//! The particle filter's model of a pushed object (eq. 6): Γ' as transition, camera and tactile sensors as observation.

use stickslip_dynamics::{Dynamics, Pose, StepInput};
use stickslip_filter::{Block, BlockMut, Draw, Model};

use crate::angle::wrapped;
use crate::columns::Columns;
use crate::propagation::Propagation;
use crate::watch::StepWatch;
use crate::{Camera, Setup};

/// Best log-likelihood below which no particle explains the observation: the particles are redrawn around it.
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
        let reading = [[1.0 - invented, invented], [missed, 1.0 - missed]].map(|row| row.map(libm::log));
        Self { dynamics: Dynamics::new(setup.scene.clone()), setup: setup.clone(), camera, reading, start, columns, watch: None }
    }

    /// The same, with a `watch` that is shown every step solved.
    #[must_use]
    pub fn watched(self, watch: Option<&'w dyn StepWatch>) -> Self {
        Self { watch, ..self }
    }

    /// Layout of the particles.
    pub fn layout(&self) -> Columns {
        self.columns
    }

    /// The pose of particle `i` that the camera sees.
    fn seen_pose(&self, observation: &Observation, block: &Block<'_>, i: usize) -> Pose {
        let at = |column: usize| Pose::new(block.column(column)[i], block.column(column + 1)[i], block.column(column + 2)[i]);
        match observation.lookback {
            None => at(Columns::POSE),
            Some(look) => {
                let earlier = at(self.columns.past_pose(look.earlier));
                earlier.interpolate(at(self.columns.past_pose(look.later)), look.fraction)
            }
        }
    }

    /// log of the camera's likelihood of particle `i`; 0 where it saw nothing.
    fn camera_log_likelihood_of(&self, observation: &Observation, block: &Block<'_>, i: usize) -> f64 {
        observation.pose.map_or(0.0, |pose| self.camera_log_likelihood(&pose, &self.seen_pose(observation, block, i)))
    }

    /// log of the camera's likelihood up to a constant: normal, its standard deviations widened by `likelihood_scale`.
    fn camera_log_likelihood(&self, measured: &Pose, pose: &Pose) -> f64 {
        let scale = self.setup.filter.likelihood_scale;
        let position = scale * self.camera.position_std;
        let (dx, dy) = ((measured.x - pose.x) / position, (measured.y - pose.y) / position);
        let turn = wrapped(measured.theta - pose.theta) / (scale * self.camera.orientation_std);
        -0.5 * (dx * dx + dy * dy + turn * turn)
    }

    /// log-probability of the tactile readings given particle `i`'s contacts.
    ///
    /// What a driven particle touches its impulses tell. An idle one stays where it is whether the pusher that stands behind it
    /// presses on it or not, since the support's friction holds it: both are certified solutions of its step, and which of them a
    /// step returns is an accident of the warm start and the tracking noise. The one that explains the readings counts.
    fn tactile_log_likelihood(&self, readings: &[Option<bool>], block: &Block<'_>, i: usize) -> f64 {
        let set = |column: usize| block.column(column)[i] > 0.5;
        if set(Columns::IDLE) {
            let pressed = self.readings_log_probability(readings, |j| set(self.columns.against_fixel(j)));
            pressed.max(self.readings_log_probability(readings, |_| false))
        } else {
            self.readings_log_probability(readings, |j| set(self.columns.contact_fixel(j)))
        }
    }

    fn readings_log_probability(&self, readings: &[Option<bool>], touches: impl Fn(usize) -> bool) -> f64 {
        let sensors = readings.iter().enumerate().filter_map(|(j, reading)| reading.map(|r| (j, r)));
        sensors.map(|(j, reading)| self.reading[usize::from(touches(j))][usize::from(reading)]).sum()
    }
}

impl Model for ContactModel<'_> {
    type Input = StepPlan;
    type Observation = Observation;
    type Scratch = Propagation;

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
            write(block, Columns::FRICTION, i, &[nominal.mu_s, nominal.mu_p, nominal.mu_f, nominal.d_tri]);
            for slot in 0..self.columns.history() {
                write(block, self.columns.past_pose(slot), i, &pose);
            }
        }
    }

    fn propagate(&self, plan: &StepPlan, draw: Draw, block: &mut BlockMut<'_>, scratch: &mut Propagation) {
        scratch.propagate(self, plan, draw, block);
    }

    fn log_likelihood(&self, observation: &Observation, block: &Block<'_>, out: &mut [f64]) {
        for (i, out) in out.iter_mut().enumerate() {
            *out = self.camera_log_likelihood_of(observation, block, i) + self.tactile_log_likelihood(&observation.tactile, block, i);
        }
    }

    /// The camera's alone: a pose drawn anew makes no touch likelier.
    fn redrawn_log_likelihood(&self, observation: &Observation, block: &Block<'_>, out: &mut [f64]) {
        for (i, out) in out.iter_mut().enumerate() {
            *out = self.camera_log_likelihood_of(observation, block, i);
        }
    }

    fn collapsed(&self, best_log_likelihood: f64) -> bool {
        best_log_likelihood < COLLAPSED
    }

    /// Moves every particle, its past included, so that what the camera sees is drawn around the measured pose.
    fn redraw(&self, observation: &Observation, draw: Draw, block: &mut BlockMut<'_>) {
        let Some(measured) = observation.pose else { return };
        for (i, particle) in block.particles() {
            let seen = self.seen_pose(observation, &block.as_block(), i);
            let [x, y, theta] = self.drawn_around(&measured, draw.normals::<3>(particle, 0));
            let shift = [x - seen.x, y - seen.y, wrapped(theta - seen.theta)];
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
