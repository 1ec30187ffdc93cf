//! Forces of a simulated sensor: those of the sliding object, its bias and its noise.

use stickslip::{ForceSensor, Log};
use stickslip_evaluation::{Physics, Simulation, SimulationOptions};
use stickslip_formats::{TruthFacts, read_scene};

const SCENE: &str = "
gravity = 9.81
[object]
mass = 0.5
shape = [ { disc = { radius = 0.03 } } ]
[support]
friction = 0.3
[pusher]
shape = [ { disc = { radius = 0.005 } } ]
friction = 0.3
stall_force = 30.0
[fixels]
friction = 0.3
[start]
object = [0.0, 0.0, 0.0]
pusher = [-0.045, 0.0, 0.0]
speed = 0.02
duration = 3.0
";

/// μ_s m g (N).
const SLIDING: f64 = 0.3 * 0.5 * 9.81;

/// Row by which the pusher has come 10 mm to the object, and first row of a steady slide.
const CONTACT: usize = 15;
const STEADY: usize = 25;

/// A second finger, which comes from the other side and touches after the first.
const JAW: &str = "
[[finger]]
shape = [ { disc = { radius = 0.005 } } ]
start = [0.055, 0.0, 0.0]
direction = 3.141592653589793
";

const EXACT: ForceSensor = ForceSensor {
    force_std: 0.0,
    bias_std: 0.0,
    scale_std: 0.0,
};

fn simulated(wrench: Option<ForceSensor>, seed: u64) -> Log {
    simulated_in(SCENE, Physics::Model, wrench, seed)
}

fn simulated_in(scene: &str, physics: Physics, wrench: Option<ForceSensor>, seed: u64) -> Log {
    let mut setup = read_scene(scene, "test").expect("a scene");
    setup.wrench = wrench;
    let options = SimulationOptions {
        physics,
        seeds: seed.into(),
        rate: 30.0,
        repeats: 0.0,
        pusher_memory: 0.0,
    };
    let simulation = Simulation::run(&setup, &TruthFacts::default(), &options, &mut |_, _| ());
    simulation.expect("it runs").log
}

fn forces(sensor: ForceSensor, seed: u64) -> Vec<[f64; 2]> {
    let log = simulated(Some(sensor), seed);
    assert_eq!(log.force.len(), log.len());
    log.force.into_iter().flatten().collect()
}

#[test]
fn without_a_sensor_there_are_no_forces() {
    assert!(simulated(None, 0).force.is_empty());
}

#[test]
fn a_sliding_object_takes_its_friction() {
    let forces = forces(EXACT, 0);
    assert!(forces[..CONTACT].iter().all(|force| *force == [0.0; 2]));
    for [x, y] in &forces[STEADY..] {
        assert!(
            (x / SLIDING - 1.0).abs() < 0.01 && y.abs() < 0.01,
            "{x} {y}"
        );
    }
}

#[test]
fn bias_lasts_and_noise_does_not() {
    let sensor = ForceSensor {
        force_std: 0.02,
        bias_std: 0.2,
        scale_std: 0.0,
    };
    let (mut squares, mut seeds) = (0.0, 0.0);
    for seed in 0..40 {
        let forces = forces(sensor, seed);
        let mean =
            |rows: &[[f64; 2]]| rows.iter().map(|force| force[1]).sum::<f64>() / rows.len() as f64;
        let (early, late) = (mean(&forces[..CONTACT]), mean(&forces[STEADY..]));
        assert!((early - late).abs() < 0.03, "{early} {late}");
        squares += late * late;
        seeds += 1.0;
    }
    let std = (squares / seeds).sqrt();
    assert!((std / 0.2 - 1.0).abs() < 0.35, "{std}");
}

/// The jaw pushes the object on, then squeezes it: its force is never more than the table takes.
#[test]
fn a_hand_has_the_force_of_all_its_fingers_together() {
    for physics in [Physics::Model, Physics::Testbed] {
        let log = simulated_in(&format!("{SCENE}{JAW}"), physics, Some(EXACT), 0);
        let sizes: Vec<f64> = log
            .force
            .iter()
            .map(|force| force.map_or(0.0, |[x, y]| x.hypot(y)))
            .collect();
        // the second finger touches at 0.75 s; the squeeze is at the stall force of 30 N
        let slides = sizes[17..22].iter().sum::<f64>() / 5.0;
        assert!((slides / SLIDING - 1.0).abs() < 0.1, "{physics:?} {slides}");
        assert!(
            sizes[40..].iter().all(|size| *size < 1.1 * SLIDING),
            "{physics:?} {sizes:?}"
        );
    }
}
