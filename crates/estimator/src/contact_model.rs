//! The particle filter's model of a pushed object (eq. 6): Γ' as transition, camera and tactile sensors as observation.

use stickslip_dynamics::{Body, Dynamics, Friction, Outcome, Particle, Pose, Report, StepInput, StepWork, Twist, WarmStart, Wrench};
use stickslip_filter::{Block, BlockMut, Draw, Model};

use crate::angle::wrapped;
use crate::columns::Columns;
use crate::watch::{SolvedStep, StepWatch};
use crate::{Camera, Limits, Setup};

/// Particles that are stepped side by side.
const LANES: usize = 8;

/// Time step to which the noise settings refer (s).
const NOISE_STEP: f64 = 1.0 / 30.0;

/// Speed above which an object counts as moving, mass-normalised (m/s) (Φ, Table I).
const MOVING: f64 = 1e-9;

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
    dynamics: Dynamics,
    setup: Setup,
    camera: Camera,
    start: Pose,
    columns: Columns,
    watch: Option<&'w dyn StepWatch>,
}

/// Working memory of one block.
#[derive(Debug, Default)]
pub struct Scratch {
    step: StepWork<LANES>,
}

/// The lanes of one chunk while they are stepped.
struct Chunk {
    /// First particle within its block.
    first: usize,
    /// Lanes that hold particles; those past them repeat the last.
    lanes: usize,
    /// β before the step; `friction` is β̂.
    kept: [Friction; LANES],
    particles: [Particle; LANES],
    friction: [Friction; LANES],
    touched: [Touched; LANES],
}

/// What took part in a step (Φ) and how it ended.
#[derive(Clone, Debug, Default, PartialEq)]
struct Touched {
    pusher: bool,
    fixel: bool,
    moved: bool,
    unsolved: bool,
}

impl<'w> ContactModel<'w> {
    /// A model whose particles start around `start`, with `history` past poses per particle.
    pub fn new(setup: &Setup, camera: Camera, start: Pose, history: usize) -> Self {
        let columns = Columns::new(setup.scene.fixels.len(), history);
        Self { dynamics: Dynamics::new(setup.scene.clone()), setup: setup.clone(), camera, start, columns, watch: None }
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

    /// Draws w_app for one substep: a share of μ_s m g per NOISE_STEP on each axis, its variance proportional to h.
    fn force_noise(&self, friction: &Friction, h: f64, normals: [f64; 3]) -> Wrench {
        let scene = &self.setup.scene;
        let weight = friction.mu_s * scene.object.mass * scene.gravity * NOISE_STEP;
        let std = self.setup.filter.force_std * weight * (h / NOISE_STEP).sqrt();
        let rho = scene.object.gyration_radius();
        Wrench { fx: std * normals[0], fy: std * normals[1], torque: std * rho * normals[2] }
    }

    /// β̂ = β + w_β τ(β), within the physical limits.
    fn disturb(&self, friction: &Friction, h: f64, normals: [f64; 4]) -> Friction {
        let settings = &self.setup.filter;
        let std = settings.parameter_std * (h / NOISE_STEP).sqrt();
        let step = |value: f64, normal: f64, limits: &Limits| (value + value * std * normal).clamp(limits.min, limits.max);
        Friction {
            mu_s: step(friction.mu_s, normals[0], &settings.mu_s),
            mu_p: step(friction.mu_p, normals[1], &settings.mu_p),
            mu_f: step(friction.mu_f, normals[2], &settings.mu_f),
            d_tri: step(friction.d_tri, normals[3], &settings.d_tri),
        }
    }

    /// Runs all substeps of one chunk and writes its particles back (eq. 6).
    fn step_chunk(&self, plan: &StepPlan, draw: Draw, block: &mut BlockMut<'_>, first: usize, work: &mut StepWork<LANES>) {
        let mut chunk = self.load(plan, draw, block, first);
        for (part, input) in plan.substeps.iter().enumerate() {
            for lane in 0..LANES {
                let particle = block.first_particle() + (first + lane) as u32;
                let normals = draw.normals::<3>(particle, 4 + 4 * part as u32);
                chunk.particles[lane].applied = self.force_noise(&chunk.friction[lane], input.h, normals);
            }
            self.step_lanes(input, &mut chunk, work);
        }
        self.store(plan, block, &chunk, work);
    }

    fn step_lanes(&self, input: &StepInput, chunk: &mut Chunk, work: &mut StepWork<LANES>) {
        let before: [f64; LANES] = std::array::from_fn(|lane| self.speed(&chunk.particles[lane].twist));
        let reports = self.dynamics.step(input, &chunk.friction, &mut chunk.particles, work);
        for lane in 0..LANES {
            let touched = &mut chunk.touched[lane];
            touched.unsolved |= reports[lane].outcome != Outcome::Solved;
            touched.pusher |= work.normal_impulse(lane, Body::Pusher) > 0.0;
            touched.fixel |= (0..self.setup.scene.fixels.len()).any(|j| work.normal_impulse(lane, Body::Fixel(j)) > 0.0);
            touched.moved |= before[lane].max(self.speed(&chunk.particles[lane].twist)) > MOVING;
        }
        if let Some(watch) = self.watch {
            show(watch, &reports[..chunk.lanes], work);
        }
    }

    /// ‖v‖, mass-normalised.
    fn speed(&self, twist: &Twist) -> f64 {
        let turn = self.setup.scene.object.gyration_radius() * twist.omega;
        (twist.vx * twist.vx + twist.vy * twist.vy + turn * turn).sqrt()
    }

    /// The chunk that starts at particle `first` of the block, with β̂ drawn. Lanes past the end repeat the last.
    fn load(&self, plan: &StepPlan, draw: Draw, block: &BlockMut<'_>, first: usize) -> Chunk {
        let h: f64 = plan.substeps.iter().map(|step| step.h).sum();
        let index = |lane: usize| (first + lane).min(block.len() - 1);
        let kept: [Friction; LANES] = std::array::from_fn(|lane| friction_at(block, index(lane)));
        let friction = std::array::from_fn(|lane| match plan.parameter_noise {
            ParameterNoise::Frozen => kept[lane],
            ParameterNoise::Drawn => self.disturb(&kept[lane], h, draw.normals::<4>(block.first_particle() + index(lane) as u32, 0)),
        });
        let particles = std::array::from_fn(|lane| particle_at(block, index(lane)));
        Chunk { first, lanes: LANES.min(block.len() - first), kept, particles, friction, touched: Default::default() }
    }

    /// Writes a chunk back; Φ keeps only the parameters that took part (Table I).
    fn store(&self, plan: &StepPlan, block: &mut BlockMut<'_>, chunk: &Chunk, work: &StepWork<LANES>) {
        let last_h = plan.substeps.last().map_or(0.0, |step| step.h);
        let touch_impulse = self.setup.tactile.touch_force * last_h;
        for lane in 0..chunk.lanes {
            let i = chunk.first + lane;
            let (particle, touched) = (&chunk.particles[lane], &chunk.touched[lane]);
            write(block, Columns::POSE, i, &[particle.pose.x, particle.pose.y, particle.pose.theta]);
            write(block, Columns::TWIST, i, &[particle.twist.vx, particle.twist.vy, particle.twist.omega]);
            write(block, Columns::FRICTION, i, &select(touched, &chunk.friction[lane], &chunk.kept[lane]));
            write(block, Columns::WARM_START, i, &particle.warm.to_array());
            write(block, Columns::UNSOLVED, i, &[flag(touched.unsolved)]);
            write(block, Columns::CONTACT_PUSHER, i, &[flag(work.normal_impulse(lane, Body::Pusher) > 0.0)]);
            for j in 0..self.setup.scene.fixels.len() {
                let touches = work.normal_impulse(lane, Body::Fixel(j)) > touch_impulse;
                write(block, self.columns.contact_fixel(j), i, &[flag(touches)]);
            }
            if self.columns.history() > 0 {
                write(block, self.columns.past_pose(plan.slot), i, &[particle.pose.x, particle.pose.y, particle.pose.theta]);
            }
        }
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

    /// log of the camera's likelihood up to a constant: normal, its standard deviations widened by `likelihood_scale`.
    fn camera_log_likelihood(&self, measured: &Pose, pose: &Pose) -> f64 {
        let scale = self.setup.filter.likelihood_scale;
        let position = scale * self.camera.position_std;
        let (dx, dy) = ((measured.x - pose.x) / position, (measured.y - pose.y) / position);
        let turn = wrapped(measured.theta - pose.theta) / (scale * self.camera.orientation_std);
        -0.5 * (dx * dx + dy * dy + turn * turn)
    }

    /// log-probability of the tactile readings given particle `i`'s contacts.
    fn tactile_log_likelihood(&self, readings: &[Option<bool>], block: &Block<'_>, i: usize) -> f64 {
        let sensors = readings.iter().enumerate().filter_map(|(j, reading)| reading.map(|r| (j, r)));
        sensors.map(|(j, reading)| self.reading_log_probability(reading, block.column(self.columns.contact_fixel(j))[i] > 0.5)).sum()
    }

    fn reading_log_probability(&self, reading: bool, touches: bool) -> f64 {
        let tactile = &self.setup.tactile;
        libm::log(match (touches, reading) {
            (true, true) => 1.0 - tactile.false_negative,
            (true, false) => tactile.false_negative,
            (false, true) => tactile.false_positive,
            (false, false) => 1.0 - tactile.false_positive,
        })
    }
}

impl Model for ContactModel<'_> {
    type Input = StepPlan;
    type Observation = Observation;
    type Scratch = Scratch;

    fn columns(&self) -> usize {
        self.columns.count()
    }

    fn scratch(&self) -> Scratch {
        Scratch::default()
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

    fn propagate(&self, plan: &StepPlan, draw: Draw, block: &mut BlockMut<'_>, scratch: &mut Scratch) {
        for first in (0..block.len()).step_by(LANES) {
            self.step_chunk(plan, draw, block, first, &mut scratch.step);
        }
    }

    fn log_likelihood(&self, observation: &Observation, block: &Block<'_>, out: &mut [f64]) {
        for (i, out) in out.iter_mut().enumerate() {
            let camera = observation.pose.map(|pose| self.camera_log_likelihood(&pose, &self.seen_pose(observation, block, i)));
            *out = camera.unwrap_or(0.0) + self.tactile_log_likelihood(&observation.tactile, block, i);
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

/// Φ: the parameters that took part keep their new value.
fn select(touched: &Touched, new: &Friction, old: &Friction) -> [f64; 4] {
    let pick = |took_part: bool, new: f64, old: f64| if took_part { new } else { old };
    [
        pick(touched.moved, new.mu_s, old.mu_s),
        pick(touched.pusher, new.mu_p, old.mu_p),
        pick(touched.fixel, new.mu_f, old.mu_f),
        pick(touched.moved, new.d_tri, old.d_tri),
    ]
}

fn flag(value: bool) -> f64 {
    f64::from(u8::from(value))
}

/// Shows a watch the lanes' last step.
fn show(watch: &dyn StepWatch, reports: &[Report], work: &StepWork<LANES>) {
    for (lane, report) in reports.iter().enumerate() {
        watch.see(&SolvedStep { problem: work.problem(lane), solution: &work.solution(lane), report: *report });
    }
}

fn write(block: &mut BlockMut<'_>, first_column: usize, i: usize, values: &[f64]) {
    for (k, value) in values.iter().enumerate() {
        block.column_mut(first_column + k)[i] = *value;
    }
}

fn read<const N: usize>(block: &BlockMut<'_>, first_column: usize, i: usize) -> [f64; N] {
    std::array::from_fn(|k| block.column(first_column + k)[i])
}

fn friction_at(block: &BlockMut<'_>, i: usize) -> Friction {
    let [mu_s, mu_p, mu_f, d_tri] = read(block, Columns::FRICTION, i);
    Friction { mu_s, mu_p, mu_f, d_tri }
}

fn particle_at(block: &BlockMut<'_>, i: usize) -> Particle {
    let [x, y, theta] = read(block, Columns::POSE, i);
    let [vx, vy, omega] = read(block, Columns::TWIST, i);
    Particle {
        pose: Pose { x, y, theta },
        twist: Twist { vx, vy, omega },
        applied: Wrench::default(),
        warm: WarmStart::from_array(&read(block, Columns::WARM_START, i)),
    }
}
