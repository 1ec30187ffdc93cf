//! Simulated pushes of a plate whose friction is known.
use stickslip::Setup;
use stickslip_dynamics::{Friction, Pose, SpeedProfile, Start};
use stickslip_evaluation::{PUSHER_MEMORY, Physics, Simulation, SimulationOptions};
use stickslip_fit::Push;
use stickslip_formats::{TruthFacts, read_scene};

/// A plate on three feet under a finger; a fixel that no push comes near.
pub const SCENE: &str = "
gravity = 9.81
object  = { mass = 0.5, inertia = 3.3e-4, shape = [{ polygon = [[-0.04, -0.02], [0.04, -0.02], [0.04, 0.02], [-0.04, 0.02]] }] }
support = { friction = 0.3, tripod_radius = 0.025 }
pusher  = { friction = 0.3, stall_force = 100.0, shape = [{ disc = { radius = 0.005 } }] }
fixels  = { friction = 0.25 }
fixel   = [{ position = [0.5, 0.5], shape = [{ disc = { radius = 0.005 } }] }]
camera  = { position_std = 3.0e-4, orientation_std = 5.0e-3 }
";

/// The scene that methods are given.
pub fn setup() -> Setup {
    read_scene(SCENE, "scene.toml").unwrap()
}

/// `count` pushes of 35 mm against the lower long face, at different places and angles.
pub fn pushes(truth: Friction, physics: Physics, count: usize, seed: u64) -> Vec<Push> {
    pushes_in(&with(truth), physics, count, seed)
}

/// Pushes in another scene.
pub fn pushes_in(truth: &Setup, physics: Physics, count: usize, seed: u64) -> Vec<Push> {
    (0..count)
        .map(|k| {
            // the seed draws a rig, and all pushes are on one
            let own = if physics == Physics::Model {
                k as u64
            } else {
                0
            };
            let push = simulated(truth, physics, k, seed + own).0;
            Push {
                setup: setup(),
                ..push
            }
        })
        .collect()
}

/// The tripod of the rig that `seed` draws.
pub fn rig_tripod_radius(truth: Friction, seed: u64) -> f64 {
    let (_, facts) = simulated(&with(truth), Physics::Testbed, 0, seed);
    facts.d_tri.unwrap()
}

fn with(truth: Friction) -> Setup {
    let mut setup = setup();
    setup.scene.nominal = truth;
    setup
}

fn simulated(truth: &Setup, physics: Physics, k: usize, seed: u64) -> (Push, TruthFacts) {
    let place = [-0.025, 0.015, -0.01, 0.028, 0.005, -0.018, 0.021, -0.003][k % 8];
    let turn = [0.0, 0.5, -0.4, -0.6, 0.3, 0.6, 0.0, -0.2][(k + k / 8) % 8];
    let mut setup = truth.clone();
    let direction: f64 = std::f64::consts::FRAC_PI_2 + turn;
    setup.start = Some(Start {
        object: Pose::new(0.0, 0.0, 0.0),
        pusher: Pose::new(
            place - 0.004 * libm::cos(direction),
            -0.0255 - 0.004 * libm::sin(direction),
            0.0,
        ),
        direction,
        other_fingers: Vec::new(),
        speed: SpeedProfile::constant(0.015),
        duration: 1.5,
    });
    let options = SimulationOptions {
        physics,
        seeds: seed.into(),
        rate: 15.0,
        repeats: 0.0,
        pusher_memory: PUSHER_MEMORY,
    };
    let simulation =
        Simulation::run(&setup, &TruthFacts::default(), &options, &mut |_, _| ()).unwrap();
    let experiment = simulation.into_experiment(setup);
    let push = Push {
        name: format!("push {k}"),
        setup: experiment.setup,
        log: experiment.log,
    };
    (push, experiment.facts)
}
