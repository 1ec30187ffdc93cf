//! One random scene with everything that a run of it needs: [`RandomScene`].

use std::fmt;

use stickslip::{
    Camera, FilterModel, FilterSettings, Limits, Occlusion, RunOptions, Setup, Tactile, TactileUse,
    Tracking, Uncertainty,
};
use stickslip_dynamics::{Feet, Fixel, Friction, Object, Pose, Pusher, Scene};

use super::layout::Layout;
use super::pusher_path::PusherPath;
use super::scene_kind::SceneKind;
use stickslip_testkit::SplitMix64;

const GRAVITY: f64 = 9.81;

/// Poses of the pusher in the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PusherPoses {
    /// Its true poses, exactly; the scene says so, or 1 µm.
    Exact,
    /// Its true poses, with the jitter that the scene says.
    Noisy,
    /// Its commanded poses, exactly, however far it stalled behind.
    Commanded,
}

impl PusherPoses {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Exact, Self::Noisy, Self::Commanded];
}

/// A random scene: the truth, the setup of the filter, and its options.
#[derive(Clone, Debug)]
pub(super) struct RandomScene {
    pub kind: SceneKind,
    /// Setup that the filter is given.
    pub setup: Setup,
    pub options: RunOptions,
    /// True friction.
    pub truth: Friction,
    /// Force at which the true pusher yields (N); the filter's may be rigid.
    pub true_stall_force: f64,
    /// Pose of the object in the first frame.
    pub start: Pose,
    /// Commanded pusher poses, one per frame.
    pub commanded: Vec<Pose>,
    pub pusher_poses: PusherPoses,
    /// Time from frame to frame (s).
    pub frame_time: f64,
    /// Share of the frames in which the camera does not find the object.
    pub missing: f64,
    /// Of the measurement noise.
    pub noise: SplitMix64,
}

impl RandomScene {
    /// Scene `index` of `seed`, `frames` long, for a filter of `particles`: a pure function of the
    /// four.
    pub fn draw(seed: u64, index: u64, frames: usize, particles: usize) -> Self {
        let mut rng = SplitMix64::stream(seed, index);
        let kind = SceneKind::of(index);
        let truth = friction(&mut rng);
        let layout = Layout::draw(&mut rng, kind, truth.mu_f);
        let world = world_frame(&mut rng);
        let mass = rng.log_within(0.02, 5.0);
        let travel = layout.way + way_beyond(&mut rng);
        let path = PusherPath::draw(&mut rng, travel);
        let commanded = path.poses(layout.pusher_start, frames);
        let pusher_poses = pusher_poses(&mut rng);
        let stall_force = rng.log_within(0.1, 100.0) * truth.mu_s * mass * GRAVITY;
        let radius = layout.object.shape.bounding_radius();
        let truth = Friction {
            d_tri: radius * rng.log_within(0.05, 0.8),
            ..truth
        };
        let limits = limits(radius);
        let scene = Scene {
            gravity: GRAVITY,
            feet: feet(&mut rng, truth.d_tri),
            object: Object {
                mass,
                inertia: mass * layout.object.gyration_squared * rng.within(0.7, 1.3),
                shape: layout.object.shape,
            },
            pusher: Pusher {
                fingers: vec![layout.pusher],
                stall_force: (!rng.one_in(6)).then_some(stall_force),
            },
            fixels: layout
                .fixels
                .into_iter()
                .map(|fixel| Fixel {
                    pose: placed(&world, fixel.pose),
                    ..fixel
                })
                .collect(),
            nominal: disturbed(&mut rng, truth, &limits),
        };
        Self {
            kind,
            setup: Setup {
                stall_force_assumed: false,
                camera: Some(camera(&mut rng, pusher_poses)),
                tactile: Tactile {
                    touch_force: rng.log_within(0.01, 0.5),
                    ..Tactile::default()
                },
                filter: filter_settings(&mut rng, limits),
                wrench: None,
                uncertainty: Uncertainty::default(),
                start: None,
                scene,
            },
            options: options(&mut rng, frames, particles),
            truth,
            true_stall_force: stall_force,
            start: placed(&world, Pose::new(0.0, 0.0, layout.theta)),
            commanded: commanded.iter().map(|pose| placed(&world, *pose)).collect(),
            pusher_poses,
            frame_time: 1.0 / rng.log_within(10.0, 100.0),
            missing: if rng.one_in(2) {
                0.0
            } else {
                rng.within(0.0, 0.5)
            },
            noise: SplitMix64::new(rng.word()),
        }
    }
}

impl fmt::Display for RandomScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Setup { scene, filter, .. } = &self.setup;
        let Object { mass, shape, .. } = &scene.object;
        let ratio = self.true_stall_force / (self.truth.mu_s * mass * scene.gravity);
        writeln!(f, "{:?}, {:?} pusher poses", self.kind, self.pusher_poses)?;
        writeln!(f, "mass {mass} kg, {:?}", scene.feet)?;
        writeln!(f, "object {:?}", shape.parts())?;
        writeln!(f, "pusher {:?}", scene.pusher.fingers[0].parts())?;
        for Fixel { pose, shape } in &scene.fixels {
            writeln!(f, "fixel {pose:?} {:?}", shape.parts())?;
        }
        writeln!(f, "true {:?}\nnominal {:?}", self.truth, scene.nominal)?;
        writeln!(
            f,
            "stall force {:?} N, the true one {ratio:.2} of the support's friction",
            scene.pusher.stall_force
        )?;
        writeln!(
            f,
            "force_std {:.3}, parameter_std {:.3}, {:.1} Hz, {:?}, substeps {:?}, {:?}",
            filter.force_std,
            filter.parameter_std,
            1.0 / self.frame_time,
            self.options.tracking,
            self.options.substeps,
            self.options.occlusion
        )
    }
}

/// A pose of the scene's frame in the world.
fn placed(world: &Pose, pose: Pose) -> Pose {
    let [x, y] = world.transform([pose.x, pose.y]);
    Pose::new(x, y, world.theta + pose.theta)
}

/// Half of the scenes lie along the world's axes, so that faces and normals are exact.
fn world_frame(rng: &mut SplitMix64) -> Pose {
    if rng.one_in(2) {
        Pose::default()
    } else {
        let angle = rng.within(-3.0, 3.0);
        Pose::new(rng.within(-0.5, 0.5), rng.within(-0.5, 0.5), angle)
    }
}

/// Distance that the pusher goes on once all bodies touch (m).
fn way_beyond(rng: &mut SplitMix64) -> f64 {
    rng.log_within(1e-3, 40e-3)
}

/// True friction; a sixth of the tables is very slippery. The tripod is left open.
fn friction(rng: &mut SplitMix64) -> Friction {
    let coefficient = |rng: &mut SplitMix64| {
        if rng.one_in(8) {
            rng.log_within(1e-3, 0.05)
        } else {
            rng.within(0.05, 1.5)
        }
    };
    Friction {
        mu_s: if rng.one_in(6) {
            rng.log_within(1e-3, 0.05)
        } else {
            rng.within(0.05, 1.0)
        },
        mu_p: coefficient(rng),
        mu_f: coefficient(rng),
        d_tri: 0.0,
    }
}

fn limits(radius: f64) -> Friction<Limits> {
    let coefficient = Limits {
        min: 1e-3,
        max: 1.5,
    };
    Friction {
        mu_s: coefficient,
        mu_p: coefficient,
        mu_f: coefficient,
        d_tri: Limits {
            min: 0.04 * radius,
            max: radius,
        },
    }
}

/// Friction that the filter assumes: the true values, each times 0.67 to 1.5.
fn disturbed(rng: &mut SplitMix64, truth: Friction, limits: &Friction<Limits>) -> Friction {
    let mut nominal = truth;
    for (value, limits) in nominal.fields_mut().into_iter().zip(limits.fields()) {
        *value = (*value * rng.log_within(0.67, 1.5)).clamp(limits.min, limits.max);
    }
    nominal
}

/// A tripod, or three known feet under uneven loads.
fn feet(rng: &mut SplitMix64, d_tri: f64) -> Feet {
    if !rng.one_in(4) {
        let angle = rng.within(-3.0, 3.0);
        return Feet::Tripod { angle };
    }
    let loads = [0; 3].map(|_| rng.log_within(0.05, 1.0));
    let total = loads[0] + loads[1] + loads[2];
    Feet::Known {
        positions: [0; 3].map(|_| rng.direction().map(|x| x * d_tri)),
        loads: loads.map(|load| load / total),
    }
}

fn pusher_poses(rng: &mut SplitMix64) -> PusherPoses {
    match rng.below(10) {
        0..=4 => PusherPoses::Noisy,
        5..=8 => PusherPoses::Exact,
        _ => PusherPoses::Commanded,
    }
}

fn camera(rng: &mut SplitMix64, pusher_poses: PusherPoses) -> Camera {
    let (position_std, orientation_std) = match pusher_poses {
        PusherPoses::Noisy => (rng.log_within(1e-5, 3e-4), rng.log_within(1e-4, 1e-2)),
        _ if rng.one_in(2) => (0.0, 0.0),
        _ => (1e-6, 1e-6),
    };
    Camera {
        position_std: rng.log_within(2e-5, 1e-3),
        orientation_std: rng.log_within(2e-4, 2e-2),
        latency: 0.0,
        pusher_position_std: position_std,
        pusher_orientation_std: orientation_std,
    }
}

fn filter_settings(rng: &mut SplitMix64, limits: Friction<Limits>) -> FilterSettings {
    FilterSettings {
        force_std: match rng.below(4) {
            0 => 0.0,
            1 => 0.15,
            _ => rng.within(0.0, 1.5),
        },
        parameter_std: rng.within(0.0, 0.2),
        limits,
        ..FilterSettings::default()
    }
}

fn options(rng: &mut SplitMix64, frames: usize, particles: usize) -> RunOptions {
    RunOptions {
        model: FilterModel::Paper,
        particles,
        seed: rng.word(),
        tactile: if rng.one_in(3) {
            TactileUse::Ignored
        } else {
            TactileUse::Used
        },
        tracking: if rng.one_in(3) {
            Tracking::Causal
        } else {
            Tracking::Smoothed
        },
        substeps: rng.one_in(5).then(|| 2 + rng.below(3) as u32),
        occlusion: if rng.one_in(2) {
            Occlusion::None
        } else {
            let from = 1 + rng.below(frames - 1);
            let to = rng.one_in(2).then(|| from + rng.below(frames));
            Occlusion::Rows { from, to }
        },
        ..RunOptions::default()
    }
}
