//! A simulated experiment as its files hold it: [`Simulation`].

use anyhow::{Context, Result};
use stickslip::dynamics::{Body, Friction, Start};
use stickslip::{Log, Setup};
use stickslip_formats::{Truth, TruthFacts};
use stickslip_testbed::{
    CameraMeasurement, Model, Rig, TouchSensors, Trace, TrackingCamera, Trial,
};

use crate::args::Physics;
use crate::failure::hinted;

/// Share of frames that the paper's frame grabber repeats.
pub const REPEATS: f64 = 0.02;

/// Time from the blackout to the first contact with a fixel (s): five frames at 30 Hz.
const BLACKOUT_LEAD: f64 = 1.0 / 6.0;

/// How to simulate.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// What moves the object.
    pub physics: Physics,
    /// Seed of everything that is random.
    pub seed: u64,
    /// Frames per second (Hz).
    pub rate: f64,
    /// Share of frames that the frame grabber repeats.
    pub repeats: f64,
}

/// A simulated experiment.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// What happened.
    pub trace: Trace,
    /// What was measured.
    pub log: Log,
    /// What is true.
    pub truth: Truth,
    /// True friction and events.
    pub facts: TruthFacts,
}

impl Simulation {
    /// Simulates the experiment of `setup`, whose file is called `name`; `known` has the true
    /// friction and the blackout, where they are not the scene's friction and just before the first
    /// contact with a fixel.
    pub fn run(setup: &Setup, name: &str, known: &TruthFacts, options: &Options) -> Result<Self> {
        let start = start(setup, name)?;
        let trial = Trial {
            scene: &setup.scene,
            start,
            rate: options.rate,
            seed: options.seed,
        };
        let friction = friction(setup, known);
        let touch = TouchSensors {
            threshold: setup.tactile.touch_force,
            ..TouchSensors::default()
        };
        let run = match options.physics {
            Physics::Testbed => {
                let Friction {
                    mu_s, mu_p, mu_f, ..
                } = friction;
                Rig {
                    mu_s,
                    mu_p,
                    mu_f,
                    touch,
                    ..Rig::of(&setup.scene)
                }
                .run(&trial)
            }
            Physics::Model => Model { friction, touch }.run(&trial),
        };
        let trace = run.with_context(|| name.to_owned())?;
        let log = log(
            &trace,
            &tracker(setup, options.repeats).measure(&trace, options.seed),
        );
        let facts = facts(&trace, known, options);
        Ok(Self {
            truth: truth(&trace),
            log,
            facts,
            trace,
        })
    }
}

fn start<'a>(setup: &'a Setup, name: &str) -> Result<&'a Start> {
    setup.start.as_ref().ok_or_else(|| {
        let help = "add [start] with object = [x, y, theta], pusher = [x, y, theta], speed = ... in m/s and duration = ... in s";
        hinted(format!("{name}: there is no table [start], so nobody knows where the experiment begins"), help)
    })
}

/// The true friction: what is known, else the nominal one.
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
fn tracker(setup: &Setup, repeats: f64) -> TrackingCamera {
    setup
        .camera
        .map_or(TrackingCamera::EXACT, |camera| TrackingCamera {
            position_std: camera.position_std,
            orientation_std: camera.orientation_std,
            pusher_position_std: camera.pusher_position_std,
            pusher_orientation_std: camera.pusher_orientation_std,
            latency: camera.latency,
            repeats,
        })
}

fn log(trace: &Trace, sightings: &[CameraMeasurement]) -> Log {
    let sensors = trace.frames.first().map_or(0, |frame| frame.tactile.len());
    Log {
        time: trace.frames.iter().map(|frame| frame.time).collect(),
        object: sightings
            .iter()
            .map(|sighting| Some(sighting.object))
            .collect(),
        pusher: sightings
            .iter()
            .map(|sighting| Some(sighting.pusher))
            .collect(),
        tactile: (0..sensors)
            .map(|k| {
                trace
                    .frames
                    .iter()
                    .map(|frame| Some(frame.tactile[k]))
                    .collect()
            })
            .collect(),
        force: Vec::new(),
    }
}

fn truth(trace: &Trace) -> Truth {
    let frames = &trace.frames;
    let fixels = frames.first().map_or(0, |frame| frame.fixel_forces.len());
    Truth {
        time: frames.iter().map(|frame| frame.time).collect(),
        pose: frames.iter().map(|frame| frame.object).collect(),
        twist: frames.iter().map(|frame| frame.twist).collect(),
        pusher: frames.iter().map(|frame| frame.pusher).collect(),
        pusher_force: frames
            .iter()
            .map(|frame| length(frame.pusher_force))
            .collect(),
        fixel_forces: (0..fixels)
            .map(|j| frames.iter().map(|frame| frame.fixel_forces[j]).collect())
            .collect(),
    }
}

fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

fn facts(trace: &Trace, known: &TruthFacts, options: &Options) -> TruthFacts {
    let Friction {
        mu_s,
        mu_p,
        mu_f,
        d_tri,
    } = trace.friction;
    let fixels = trace
        .frames
        .first()
        .map_or(0, |frame| frame.fixel_forces.len());
    let lead = (BLACKOUT_LEAD * options.rate).round() as usize;
    let before_contact = trace
        .first_fixel_contact()
        .map(|row| row.saturating_sub(lead));
    TruthFacts {
        source: Some(format!(
            "stickslip simulate, {}, seed {}",
            options.physics.name(),
            options.seed
        )),
        mu_s: Some(mu_s),
        mu_p: Some(mu_p),
        mu_f: Some(mu_f),
        d_tri: Some(d_tri),
        first_pusher_contact: trace.first_contact(Body::Pusher),
        first_fixel_contacts: (0..fixels)
            .map(|j| trace.first_contact(Body::Fixel(j)))
            .collect(),
        occlude_from: known
            .occlude_from
            .filter(|row| *row < trace.frames.len())
            .or(before_contact),
        final_pose: None,
    }
}
