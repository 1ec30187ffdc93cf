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

fn simulated(wrench: Option<ForceSensor>, seed: u64) -> Log {
    let mut setup = read_scene(SCENE, "test").expect("a scene");
    setup.wrench = wrench;
    let options = SimulationOptions {
        physics: Physics::Model,
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
    let exact = ForceSensor {
        force_std: 0.0,
        bias_std: 0.0,
        scale_std: 0.0,
    };
    let forces = forces(exact, 0);
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
