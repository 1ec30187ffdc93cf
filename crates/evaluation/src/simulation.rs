//! A simulated experiment, as its files would hold it: [`Simulation`].

use stickslip::dynamics::{Body, Friction, Scene};
use stickslip::{ForceSensor, Log, Setup};
use stickslip_filter::{Purpose, Streams};
use stickslip_formats::{Experiment, Truth, TruthFacts};
use stickslip_testbed::{
    CameraMeasurement, Frame, Model, Rig, TouchSensors, Trace, TrackingCamera, Trial, TrialError,
};

/// Share of frames that the paper's frame grabber repeats.
pub const REPEATS: f64 = 0.02;

/// Time over which the error of a tracked pusher forgets itself (s): that of a simple Kalman filter
/// on a hundred sightings.
pub const PUSHER_MEMORY: f64 = 0.15;

/// Time from the start of the occlusion to the first contact with a fixel (s): five frames at 30
/// Hz.
const BLACKOUT_LEAD: f64 = 1.0 / 6.0;

/// Source of the object's motion in a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Physics {
    /// A rig with compliant contacts, uneven friction and a drive that lags and stalls.
    Testbed,
    /// The filter's own contact dynamics, without noise.
    Model,
}

/// Seeds of a simulation. The noise of one rig is independent from that of another seed; one number
/// serves both, as `Seeds::from(7)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seeds {
    /// Of the testbed's rig: pressure, friction of the table, errors of the drive.
    pub rig: u64,
    /// Of the sensors: camera, touch, force.
    pub noise: u64,
}

impl From<u64> for Seeds {
    fn from(seed: u64) -> Self {
        Self {
            rig: seed,
            noise: seed,
        }
    }
}

/// Options of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulationOptions {
    /// Source of the object's motion.
    pub physics: Physics,
    /// Seeds of everything that is random.
    pub seeds: Seeds,
    /// Frames per second (Hz).
    pub rate: f64,
    /// Share of frames that the frame grabber repeats, 0 to 1.
    pub repeats: f64,
    /// Time over which the pusher's error forgets itself (s); 0: every frame has its own.
    pub pusher_memory: f64,
}

/// A simulated experiment.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// Record of the motion.
    pub trace: Trace,
    /// The measurements.
    pub log: Log,
    /// The truth.
    pub truth: Truth,
    /// True friction and events.
    pub facts: TruthFacts,
}

/// Reason why an experiment cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// The scene does not say how the experiment begins.
    #[error("there is no table [start], which gives the start of the experiment")]
    NoStart,
    /// The scene has a rigid drive, and the testbed none.
    #[error("pusher.stall_force is inf, and no drive of a rig is rigid")]
    RigidDrive,
    /// The testbed refuses it.
    #[error(transparent)]
    Trial(#[from] TrialError),
}

impl Physics {
    /// Name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Testbed => "testbed",
            Self::Model => "model",
        }
    }
}

impl Simulation {
    /// Simulates the experiment of `setup`. `known` has the true friction and the first hidden
    /// row. The defaults are the scene's friction, and five frames at 30 Hz before the first
    /// contact with a fixel. `progress` gets the number of finished frames, and of all.
    ///
    /// # Errors
    /// The setup has no start, bodies overlap there, the testbed is to have a rigid drive, or a
    /// number is out of range.
    pub fn run(
        setup: &Setup,
        known: &TruthFacts,
        options: &SimulationOptions,
        progress: &mut dyn FnMut(usize, usize),
    ) -> Result<Self, SimulationError> {
        let trial = Trial {
            scene: &setup.scene,
            start: setup.start.as_ref().ok_or(SimulationError::NoStart)?,
            rate: options.rate,
            seed: options.seeds.rig,
        };
        if options.physics == Physics::Testbed && setup.scene.pusher.stall_force.is_none() {
            return Err(SimulationError::RigidDrive);
        }
        let friction = friction(setup, known);
        let touch = TouchSensors {
            threshold: setup.tactile.touch_force,
            seed: Some(options.seeds.noise),
            ..TouchSensors::default()
        };

        // what happens
        let frames = trial.frames();
        let progress = &mut |done| progress(done, frames);
        let trace = match options.physics {
            Physics::Testbed => Rig {
                mu_s: friction.mu_s,
                mu_p: friction.mu_p,
                mu_f: friction.mu_f,
                touch,
                ..Rig::of(&setup.scene)
            }
            .run_observed(&trial, progress),
            Physics::Model => Model { friction, touch }.run_observed(&trial, progress),
        }?;

        // what is measured of it, and what is true
        let measurements = tracker(setup, options).measure(&trace, options.seeds.noise);
        Ok(Self {
            log: Log {
                force: setup.wrench.map_or_else(Vec::new, |sensor| {
                    forces(&trace, &sensor, options.seeds.noise)
                }),
                ..log(&trace, &measurements)
            },
            truth: truth(&trace),
            facts: facts(&setup.scene, &trace, known, options),
            trace,
        })
    }

    /// The experiment in the form of its files; `setup` is the methods' view of the simulated
    /// scene.
    ///
    /// # Panics
    /// If `setup` has fewer fixels than the simulated one.
    #[must_use]
    pub fn into_experiment(self, setup: Setup) -> Experiment {
        Experiment::new(setup, self.log, Some(self.truth), self.facts)
            .expect("a sensor for each fixel")
    }
}

/// The true friction where it is known, else the nominal one.
fn friction(setup: &Setup, known: &TruthFacts) -> Friction {
    let nominal = setup.scene.nominal;
    Friction {
        mu_s: known.mu_s.unwrap_or(nominal.mu_s),
        mu_p: known.mu_p.unwrap_or(nominal.mu_p),
        mu_f: known.mu_f.unwrap_or(nominal.mu_f),
        d_tri: known.d_tri.unwrap_or(nominal.d_tri),
    }
}

/// A camera as noisy as the scene says, exact where it says nothing.
fn tracker(setup: &Setup, options: &SimulationOptions) -> TrackingCamera {
    setup
        .camera
        .map_or(TrackingCamera::EXACT, |camera| TrackingCamera {
            position_std: camera.position_std,
            orientation_std: camera.orientation_std,
            pusher_position_std: camera.pusher_position_std,
            pusher_orientation_std: camera.pusher_orientation_std,
            latency: camera.latency,
            repeats: options.repeats,
            pusher_memory: options.pusher_memory,
        })
}

fn log(trace: &Trace, measurements: &[CameraMeasurement]) -> Log {
    let frames = &trace.frames;
    let sensors = frames.first().map_or(0, |frame| frame.tactile.len());
    let fingers = frames.first().map_or(1, |frame| frame.finger_forces.len());
    let reading = |k: usize| frames.iter().map(move |frame| Some(frame.tactile[k]));
    Log {
        time: frames.iter().map(|frame| frame.time).collect(),
        object: measurements.iter().map(|seen| Some(seen.object)).collect(),
        object_covariance: Vec::new(),
        pusher: measurements.iter().map(|seen| Some(seen.pusher)).collect(),
        other_fingers: (0..fingers - 1)
            .map(|k| {
                let seen = measurements.iter();
                seen.map(|seen| Some(seen.other_fingers[k])).collect()
            })
            .collect(),
        tactile: (0..sensors).map(|k| reading(k).collect()).collect(),
        force: Vec::new(),
    }
}

/// Forces of the pusher, or of the whole hand, as a sensor with these errors measures them.
fn forces(trace: &Trace, sensor: &ForceSensor, seed: u64) -> Vec<Option<[f64; 2]>> {
    let streams = Streams::new(seed).of(Purpose::Measure);
    let bias = [0, 1].map(|axis| sensor.bias_std * streams.at(0).normal(FORCE_BIAS, axis));
    let measured = |(k, frame): (usize, &Frame)| {
        let draw = streams.at(k as u64);
        let error =
            |axis: usize| bias[axis] + sensor.force_std * draw.normal(FORCE_NOISE, axis as u32);
        Some([0, 1].map(|axis| frame.hand_force[axis] + error(axis)))
    };
    trace.frames.iter().enumerate().map(measured).collect()
}

/// Numbers of the random streams of a force sensor, far from those of touch sensors and camera.
const FORCE_BIAS: u32 = 1 << 16;
const FORCE_NOISE: u32 = FORCE_BIAS + 1;

fn truth(trace: &Trace) -> Truth {
    let frames = &trace.frames;
    let size = |[x, y]: [f64; 2]| (x * x + y * y).sqrt();
    // columns force_1, ...: of fixels, then of a hand's other fingers
    let others = |frame: &Frame| [&frame.fixel_forces, &frame.finger_forces[1..]].concat();
    let forces: Vec<Vec<f64>> = frames.iter().map(others).collect();
    let columns = forces.first().map_or(0, Vec::len);
    Truth {
        time: frames.iter().map(|frame| frame.time).collect(),
        pose: frames.iter().map(|frame| frame.object).collect(),
        twist: frames.iter().map(|frame| frame.twist).collect(),
        pusher: frames.iter().map(|frame| frame.pusher).collect(),
        pusher_force: frames.iter().map(|f| size(f.pusher_force)).collect(),
        fixel_forces: (0..columns)
            .map(|j| forces.iter().map(|row| row[j]).collect())
            .collect(),
    }
}

fn facts(
    scene: &Scene,
    trace: &Trace,
    known: &TruthFacts,
    options: &SimulationOptions,
) -> TruthFacts {
    let SimulationOptions { physics, seeds, .. } = options;
    let Seeds { rig, noise } = seeds;
    let seeds = match rig == noise {
        true => format!("seed {rig}"),
        false => format!("rig seed {rig}, noise seed {noise}"),
    };
    let lead = (BLACKOUT_LEAD * options.rate).round() as usize;
    // fixels, or any finger of a hand, are where the object is hidden
    let hiding = (0..scene.sensors()).map(|k| scene.sensed(k));
    let first = hiding.filter_map(|body| trace.first_contact(body)).min();
    let before_contact = first.map(|row| row.saturating_sub(lead));
    TruthFacts {
        source: Some(format!("stickslip simulate, {}, {seeds}", physics.name())),
        mu_s: Some(trace.friction.mu_s),
        mu_p: Some(trace.friction.mu_p),
        mu_f: Some(trace.friction.mu_f),
        d_tri: Some(trace.friction.d_tri),
        first_pusher_contact: trace.first_contact(Body::Finger(0)),
        first_fixel_contacts: (0..scene.others())
            .map(|j| trace.first_contact(scene.other(j)))
            .collect(),
        occlude_from: known
            .occlude_from
            .filter(|row| *row < trace.frames.len())
            .or(before_contact),
        final_pose: trace.frames.last().map(|frame| frame.object),
    }
}
