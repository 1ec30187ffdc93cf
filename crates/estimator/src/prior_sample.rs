//! Experiments drawn from the particle filter's own model: [`PriorSample`].

use std::sync::Mutex;

use stickslip_dynamics::{Body, Friction, Lanes, Pose};
use stickslip_filter::{Purpose, Streams};

use crate::error::RunError;
use crate::filter_model::FilterModel;
use crate::log::Log;
use crate::occlusion::Occlusion;
use crate::options::{RunOptions, TactileUse};
use crate::particle::sensor::camera_noise::NoisePrior;
use crate::particle::sensor::touch_channel::{DrawnSensor, TouchChannel, touch_probability};
use crate::particle::set::observer::{Observer, SolvedStep};
use crate::particle::set::view::ParticleView;
use crate::run::run_observed;
use crate::setup::{Camera, ForceSensor, Setup};
use crate::tuning::FORCE_MODEL;

/// One experiment drawn from the particle filter's prior (docs/model.md).
///
/// An object moves under the logged pusher as a particle does. Its friction, the rig's errors and
/// the disturbing forces are drawn from their priors. Camera and sensors read it by the rules that
/// the filter weighs by.
///
/// The filter's beliefs about such experiments are calibrated if it has enough particles
/// (simulation-based calibration, Talts et al. 2018). If real logs look unlike them, its model is
/// wrong (prior predictive check). No camera pose is an outlier, and `likelihood_scale` counts as
/// 1.
#[derive(Clone, Debug, PartialEq)]
pub struct PriorSample {
    /// Measurements. Times, pusher and first object pose are those of the given log. Further poses
    /// and readings are drawn where that log has some.
    pub log: Log,
    /// True states, by row from the first one with an object pose on.
    pub truth: Vec<SampledState>,
    /// Weight of the sample: the probability, up to a constant, that the pusher moves as logged
    /// although the object may hold it up.
    pub chance: f64,
}

/// True state at a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledState {
    /// The object's pose.
    pub pose: Pose,
    /// Friction that governs it.
    pub friction: Friction,
}

impl PriorSample {
    /// Draws one under the pusher of `log`, from around its first object pose on. That pose stays,
    /// because the filter knows nothing of the object before it. The filter's first belief is then
    /// a distribution around the first camera pose.
    ///
    /// # Errors
    /// Those of [`run`](crate::run).
    pub fn draw(setup: &Setup, log: &Log, model: FilterModel, seed: u64) -> Result<Self, RunError> {
        let camera = setup.camera.ok_or(RunError::NoCamera)?;
        let streams = Streams::new(seed).of(Purpose::Measure);
        let mut log = log.clone();
        log.object_covariance.clear();
        let first = log.object.iter().position(Option::is_some);
        let first = first.ok_or(RunError::NoObjectPose { rows: log.len() })?;

        // the motion, which no force weighs
        let has_force = !std::mem::take(&mut log.force).is_empty();
        let options = RunOptions {
            model,
            particles: 1,
            seed,
            tactile: TactileUse::Ignored,
            occlusion: Occlusion::Rows {
                from: first + 1,
                to: None,
            },
            ..RunOptions::default()
        };
        let camera = with_noise_drawn(camera, setup, model, streams);
        let setup = Setup {
            camera: Some(camera),
            ..setup.clone()
        };
        let witness = Witness::new(&setup, model);
        let run = run_observed(&setup, &log, &options, &witness, &mut |_| ())?;
        let rows = witness.state.into_inner();
        let rows = rows.expect("no thread panicked").rows;

        // its measurements
        let readings = Readings {
            setup: &setup,
            camera,
            model,
            streams,
        };
        readings.write(&rows, &mut log);
        if let Some(sensor) = setup.wrench.filter(|_| has_force) {
            log.force = readings.forces(&sensor, &rows, log.len());
        }
        Ok(Self {
            log,
            truth: rows.into_iter().map(|row| row.truth).collect(),
            chance: run.log_evidence.map_or(0.0, libm::exp),
        })
    }
}

/// Returns the camera with its unknown noise drawn from the prior.
fn with_noise_drawn(camera: Camera, setup: &Setup, model: FilterModel, streams: Streams) -> Camera {
    let prior = NoisePrior::new(setup.uncertainty.camera_noise);
    let prior = prior.filter(|_| model == FilterModel::Robust);
    let level = |sensor| prior.map_or(1.0, |prior| prior.drawn(streams.at(0), sensor).sqrt());
    Camera {
        position_std: level(NOISE_LEVELS) * camera.position_std,
        orientation_std: level(NOISE_LEVELS + 1) * camera.orientation_std,
        ..camera
    }
}

/// State of one particle at a row.
#[derive(Clone, Debug)]
struct Witnessed {
    truth: SampledState,
    /// The pose that the camera shows.
    shown: Pose,
    /// Probability that each sensor feels a contact.
    touch: Vec<f64>,
    /// Force of the pusher as (49) predicts it (N), the scale included; `None` where it does not.
    force: Option<[f64; 2]>,
}

/// Observer that records the states of a single particle.
#[derive(Debug)]
struct Witness<'a> {
    setup: &'a Setup,
    model: FilterModel,
    state: Mutex<WitnessState>,
}

#[derive(Debug, Default)]
struct WitnessState {
    rows: Vec<Witnessed>,
    /// Impulse and gap of each fixel in the latest step, in the units of [`touch_probability`].
    contacts: Vec<(f64, f64)>,
    /// Since the latest row: time (s), impulse of the table's friction (N s), whether the pusher
    /// and a fixel pressed.
    duration: f64,
    support: [f64; 2],
    pushed: bool,
    held: bool,
}

impl WitnessState {
    /// Adds a step to what happened since the latest row.
    fn add(&mut self, step: &SolvedStep<'_>) {
        self.duration += step.problem.h;
        for foot in step.solution.feet {
            self.support[0] += foot[0];
            self.support[1] += foot[1];
        }
        for (body, normal) in step.bodies.iter().zip(&step.solution.normal) {
            match body {
                Body::Finger(_) => self.pushed |= *normal > 0.0,
                Body::Fixel(_) => self.held |= *normal > 0.0,
            }
        }
    }

    /// Force of the pusher since the latest row, which ends here.
    fn force(&mut self) -> Option<[f64; 2]> {
        let (duration, pushed, held) = (self.duration, self.pushed, self.held);
        let force = std::mem::take(&mut self.support).map(|impulse| -impulse / duration);
        (self.duration, self.pushed, self.held) = (0.0, false, false);
        match pushed {
            false => Some([0.0; 2]),
            true => (!held).then_some(force),
        }
    }
}

impl<'a> Witness<'a> {
    fn new(setup: &'a Setup, model: FilterModel) -> Self {
        Self {
            setup,
            model,
            state: Mutex::default(),
        }
    }

    /// Returns impulse and gap of the body of a sensor, over all contacts with it. The gap is that
    /// after the step.
    fn contact(&self, step: &SolvedStep<'_>, sensor: usize) -> (f64, f64) {
        let sensed = self.setup.scene.sensed(sensor);
        let SolvedStep {
            problem, solution, ..
        } = step;
        let (mut impulse, mut gap) = (0.0, f64::INFINITY);
        let contacts = problem.contacts.iter().zip(&solution.normal);
        for ((contact, normal), body) in contacts.zip(step.bodies) {
            if *body == sensed {
                let ([nx, ny], [rx, ry]) = (contact.normal, contact.arm);
                let twist = solution.twist;
                let opening = nx * twist.vx + ny * twist.vy + (rx * ny - ry * nx) * twist.omega;
                impulse += normal;
                gap = f64::min(gap, contact.gap + problem.h * opening);
            }
        }
        (
            impulse / (self.setup.tactile.touch_force * problem.h),
            gap / self.setup.uncertainty.touch_gap,
        )
    }
}

impl Observer for Witness<'_> {
    fn on_step(&self, step: &SolvedStep<'_>) {
        let sensors = 0..self.setup.scene.sensors();
        let contacts = sensors.map(|j| self.contact(step, j)).collect();
        let mut state = self.state.lock().expect("one thread");
        state.contacts = contacts;
        state.add(step);
    }

    fn on_row(&self, _: usize, particles: &ParticleView<'_>) {
        let mut state = self.state.lock().expect("one thread");
        let contacts = state.contacts.iter().enumerate();
        let touch = contacts.map(|(j, (impulse, gap))| match self.model {
            FilterModel::Robust => {
                let impulse = if particles.is_driven() { *impulse } else { 0.0 };
                touch_probability(Lanes([impulse]), Lanes([*gap])).0[0]
            }
            FilterModel::Paper => f64::from(u8::from(particles.touches_sensor(0, j))),
        });
        let touch = touch.collect();
        let scale = particles.force_scale(0).zip(self.setup.wrench);
        let factor = scale.map_or(1.0, |(z, sensor)| libm::exp(z * sensor.scale_std));
        let force = state.force().map(|force| force.map(|x| x * factor));
        let row = Witnessed {
            truth: SampledState {
                pose: particles.pose(0),
                friction: particles.friction(0),
            },
            shown: particles.shown_pose(0),
            touch,
            force,
        };
        state.rows.push(row);
    }
}

/// Camera and sensors that read a particle.
#[derive(Clone, Copy, Debug)]
struct Readings<'a> {
    setup: &'a Setup,
    /// Camera with its true noise.
    camera: Camera,
    model: FilterModel,
    streams: Streams,
}

impl Readings<'_> {
    /// Writes readings of a particle into `log` where that has readings. Its first object pose
    /// stays.
    fn write(&self, rows: &[Witnessed], log: &mut Log) {
        let streams = self.streams;
        let first = log.len() - rows.len();

        // the camera
        let camera = self.camera;
        let later = rows
            .iter()
            .zip(&mut log.object[first..])
            .enumerate()
            .skip(1);
        for (k, (row, pose)) in later {
            let [x, y, theta] = streams.normals(k as u64, 0, 0);
            *pose = pose.map(|_| Pose {
                x: row.shown.x + camera.position_std * x,
                y: row.shown.y + camera.position_std * y,
                theta: row.shown.theta + camera.orientation_std * theta,
            });
        }

        // the sensors
        for (j, sensor) in log.tactile.iter_mut().enumerate() {
            let sensor = sensor[first..].iter_mut().zip(rows);
            self.read_touch(j, sensor.zip(&log.time[first..]));
        }
    }

    /// Draws the forces that a sensor measures, row by row; none before the first row.
    fn forces(
        &self,
        sensor: &ForceSensor,
        rows: &[Witnessed],
        len: usize,
    ) -> Vec<Option<[f64; 2]>> {
        let bias = [0, 1].map(|axis| sensor.bias_std * self.streams.normal(0, FORCE_BIAS, axis));
        let measured = |(k, row): (usize, &Witnessed)| {
            let force = row.force?;
            let size = libm::hypot(force[0], force[1]);
            let std = sensor.force_std.hypot(FORCE_MODEL * size);
            Some([0, 1].map(|axis| {
                let normal = self.streams.normal(k as u64, FORCE_NOISE, axis as u32);
                force[axis] + bias[axis] + std * normal
            }))
        };
        let unseen = std::iter::repeat_n(None, len - rows.len());
        unseen
            .chain(rows.iter().enumerate().map(measured))
            .collect()
    }

    /// Draws the readings of sensor `j`, row by row.
    fn read_touch<'r>(
        &self,
        j: usize,
        rows: impl Iterator<Item = ((&'r mut Option<bool>, &'r Witnessed), &'r f64)>,
    ) {
        let streams = self.streams;
        let channel = TouchChannel::new(&self.setup.tactile);
        let particle = FIRST_SENSOR + j as u32;
        let mut sensor = DrawnSensor {
            state: channel.state_at(streams.uniform(0, particle, 3)),
            threshold: streams.uniform(0, particle, 4),
        };
        let mut before = None;
        for (k, ((reading, row), time)) in rows.enumerate() {
            let h = time - before.replace(*time).unwrap_or(*time);
            let touch = row.touch.get(j).copied().unwrap_or(0.0);
            let uniform = std::array::from_fn(|n| streams.uniform(k as u64, particle, n as u32));
            let drawn = match self.model {
                FilterModel::Robust => {
                    let drawn = channel.drawn(sensor, h, touch, uniform);
                    sensor = drawn.0;
                    drawn.1
                }
                FilterModel::Paper => channel.drawn_working(touch, [uniform[1], uniform[2]]),
            };
            *reading = reading.map(|_| drawn);
        }
    }
}

/// Particle numbers of the random streams. Number 0 draws the errors of the camera's poses.
const NOISE_LEVELS: u32 = 1;
const FIRST_SENSOR: u32 = 3;
const FORCE_BIAS: u32 = 1 << 16;
const FORCE_NOISE: u32 = FORCE_BIAS + 1;
