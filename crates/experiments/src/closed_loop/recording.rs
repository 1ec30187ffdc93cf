//! The log of a random scene: one object pushed by Γ with the true friction, measured with noise
//! ([`record`]).

use std::f64::consts::TAU;

use stickslip::Log;
use stickslip_dynamics::{
    Body, Dynamics, FingerMotion, Friction, Particle, Pose, StepInput, StepWork, Twist,
};

use super::random_scene::{PusherPoses, RandomScene};
use stickslip_testkit::SplitMix64;

/// An object farther than this from its start has flown off, and the log ends (m).
const FARTHEST: f64 = 1.0;

/// Longest step of the true motion (s).
const LONGEST_STEP: f64 = 0.05;

/// State at one frame, and touches up to it.
struct Frame {
    object: Pose,
    pusher: Pose,
    touches: Vec<bool>,
}

/// Moves the object and records the measurements of camera, pusher and touch sensors.
pub(super) fn record(scene: &RandomScene) -> Log {
    let frames = frames(scene);
    let mut rng = scene.noise.clone();
    let camera = scene.setup.camera.expect("every random scene has a camera");
    let mut log = Log {
        tactile: vec![Vec::new(); scene.setup.scene.fixels.len()],
        ..Log::default()
    };
    for (k, (frame, commanded)) in frames.iter().zip(&scene.commanded).enumerate() {
        log.time.push(k as f64 * scene.frame_time);
        let seen = jittered(
            &mut rng,
            frame.object,
            camera.position_std,
            camera.orientation_std,
        );
        log.object
            .push((k == 0 || rng.unit() >= scene.missing).then_some(seen));
        log.pusher.push(Some(match scene.pusher_poses {
            PusherPoses::Exact => frame.pusher,
            PusherPoses::Commanded => *commanded,
            PusherPoses::Noisy => jittered(
                &mut rng,
                frame.pusher,
                camera.pusher_position_std,
                camera.pusher_orientation_std,
            ),
        }));
        for (sensor, touches) in log.tactile.iter_mut().zip(&frame.touches) {
            sensor.push(Some(*touches));
        }
    }
    log
}

fn jittered(rng: &mut SplitMix64, pose: Pose, position_std: f64, orientation_std: f64) -> Pose {
    let [[x, y], [turn, _]] = [normals(rng), normals(rng)];
    Pose::new(
        pose.x + position_std * x,
        pose.y + position_std * y,
        pose.theta + orientation_std * turn,
    )
}

/// Two standard normal numbers (Box & Muller 1958).
fn normals(rng: &mut SplitMix64) -> [f64; 2] {
    let length = (-2.0 * libm::log(1.0 - rng.unit())).sqrt();
    let (sin, cos) = libm::sincos(TAU * rng.unit());
    [length * cos, length * sin]
}

/// The true motion: the pusher follows its command at the distance by which it has ever stalled.
fn frames(scene: &RandomScene) -> Vec<Frame> {
    let mut truth = scene.setup.scene.clone();
    truth.pusher.stall_force = Some(scene.true_stall_force);
    let fixels = truth.fixels.len();
    let dynamics = Dynamics::new(truth);
    let mut run = TrueRun {
        dynamics,
        friction: scene.truth,
        object: Particle {
            pose: scene.start,
            ..Particle::default()
        },
        pusher: scene.commanded[0],
        direction: first_direction(&scene.commanded),
        work: StepWork::default(),
    };
    let mut frames = vec![Frame {
        object: scene.start,
        pusher: run.pusher,
        touches: vec![false; fixels],
    }];
    for pair in scene.commanded.windows(2) {
        let h = run.follow(
            pair[0].twist_to(pair[1], scene.frame_time),
            scene.frame_time,
        );
        let object = run.object.pose;
        let flown = libm::hypot(object.x - scene.start.x, object.y - scene.start.y);
        if !object.is_finite() || flown > FARTHEST {
            break;
        }
        let threshold = scene.setup.tactile.touch_force * h;
        frames.push(Frame {
            object,
            pusher: run.pusher,
            touches: (0..fixels)
                .map(|j| run.work.normal_impulse(0, Body::Fixel(j)) > threshold)
                .collect(),
        });
    }
    frames
}

fn first_direction(commanded: &[Pose]) -> [f64; 2] {
    let ways = commanded
        .windows(2)
        .map(|pair| way(pair[0].twist_to(pair[1], 1.0)));
    ways.flatten().next().unwrap_or([1.0, 0.0])
}

/// Unit vector of a translation, where there is one.
fn way(twist: Twist) -> Option<[f64; 2]> {
    let length = libm::hypot(twist.vx, twist.vy);
    (length > 0.0).then(|| [twist.vx / length, twist.vy / length])
}

/// The true motion so far.
struct TrueRun {
    dynamics: Dynamics,
    friction: Friction,
    object: Particle,
    pusher: Pose,
    direction: [f64; 2],
    work: StepWork<1>,
}

impl TrueRun {
    /// One frame of `frame_time` (s) under a commanded twist; returns the length of its steps (s).
    fn follow(&mut self, twist: Twist, frame_time: f64) -> f64 {
        self.direction = way(twist).unwrap_or(self.direction);
        let parts = (frame_time / LONGEST_STEP).ceil().max(1.0);
        let h = frame_time / parts;
        for _ in 0..parts as usize {
            self.step(twist, h);
        }
        h
    }

    fn step(&mut self, twist: Twist, h: f64) {
        let input = StepInput {
            h,
            pusher: Some(
                FingerMotion {
                    pose: self.pusher,
                    twist,
                    direction: self.direction,
                }
                .into(),
            ),
        };
        let _ = self.dynamics.step(
            &input,
            &[self.friction],
            std::array::from_mut(&mut self.object),
            &mut self.work,
        );
        // it stays behind its command, and no lag is left to the particle
        let (problem, speed) = (self.work.problem(0), self.work.solution(0).pusher_yield);
        let [x, y] = problem
            .contacts
            .iter()
            .find_map(|c| c.yields)
            .unwrap_or_default();
        let moved = Twist {
            vx: twist.vx - speed * x,
            vy: twist.vy - speed * y,
            ..twist
        };
        self.pusher = self.pusher.advance(moved, h);
        self.object.pusher_lag = Default::default();
    }
}
