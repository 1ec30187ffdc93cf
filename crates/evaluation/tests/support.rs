//! An object stands on other feet than its scene says. The push that the camera sees shows where
//! its centre of friction lies, and the belief uses that while the camera is off.

use stickslip::{Occlusion, RunOptions, run};
use stickslip_evaluation::{PUSHER_MEMORY, Physics, REPEATS, Simulation, SimulationOptions};
use stickslip_formats::{Experiment, TruthFacts, read_scene};

/// First occluded row, in the middle of the push.
const DARK: usize = 75;

/// A box that is pushed along its middle; `support` is all that its scenes differ by.
fn scene(support: &str) -> String {
    format!(
        "
gravity = 9.81
object  = {{ mass = 0.5, shape = [{{ polygon = [[-0.04, -0.03], [0.04, -0.03], [0.04, 0.03], [-0.04, 0.03]] }}] }}
support = {{ friction = 0.28, {support} }}
pusher  = {{ friction = 0.3, shape = [{{ disc = {{ radius = 0.005 }} }}] }}
fixels  = {{ friction = 0.25 }}
camera  = {{ position_std = 3.0e-4, orientation_std = 5.2e-3 }}
start   = {{ object = [0, 0, 0], pusher = [-0.05, 0.0, 0], speed = 0.02, duration = 4.5 }}
"
    )
}

/// Log of the rig, whose object stands on feet 5 mm off its middle.
fn logged(seed: u64) -> Experiment {
    let feet = "feet = [[0.0, 0.028], [0.02, -0.007], [-0.02, -0.007]], foot_loads = [0.333, 0.333, 0.334]";
    let setup = read_scene(&scene(feet), "feet.toml").expect("a scene");
    let options = SimulationOptions {
        physics: Physics::Model,
        seeds: seed.into(),
        rate: 30.0,
        repeats: REPEATS,
        pusher_memory: PUSHER_MEMORY,
    };
    let simulation = Simulation::run(&setup, &TruthFacts::default(), &options, &mut |_, _| ());
    simulation.expect("it runs").into_experiment(setup)
}

/// Error of the belief at the end of the occlusion: in standard deviations (root mean square of x,
/// y and θ), and as a distance (m). The scene file adds `more` uncertainty.
fn off(experiment: &Experiment, more: &str, seed: u64) -> (f64, f64) {
    let scene = scene("tripod_radius = 0.022") + more;
    let setup = read_scene(&scene, "scene.toml").expect("a scene");
    let options = RunOptions {
        seed,
        occlusion: Occlusion::Rows {
            from: DARK,
            to: None,
        },
        ..RunOptions::default()
    };
    let run = run(&setup, &experiment.log, &options, &mut |_| ()).expect("a run");
    let row = run.estimate.rows.last().expect("rows");
    let (pose, spread) = (row.pose.expect("a pose"), row.spread.expect("a spread"));
    let truth = experiment.truth.as_ref().and_then(|t| t.pose.last());
    let truth = truth.expect("the exact motion");
    let differences = pose.fields().into_iter().zip(truth.fields());
    let deviations = differences.zip(spread.pose.fields());
    let squares = deviations.map(|((a, b), std)| ((a - b) / std).powi(2));
    let apart = (pose.x - truth.x).hypot(pose.y - truth.y);
    ((squares.sum::<f64>() / 3.0).sqrt(), apart)
}

#[test]
fn where_the_centre_of_friction_lies_is_learned_from_the_push_that_is_seen() {
    let told = "\n[uncertainty]\ncentre_of_friction = 0\ntripod_angle = 0\nfoot_stretch = 0\n";
    let mut sums = [[0.0; 2]; 2];
    for seed in 0..6 {
        let experiment = logged(seed);
        for (sum, more) in sums.iter_mut().zip(["", told]) {
            let (deviations, apart) = off(&experiment, more, seed);
            sum[0] += deviations * deviations / 6.0;
            sum[1] += apart / 6.0;
        }
    }
    let [[unknown, apart], [known, far]] = sums;
    assert!(unknown.sqrt() < 2.0, "{unknown} off by {apart} m");
    assert!(known.sqrt() > 3.0, "{known} off by {far} m");
    assert!(apart < 0.6 * far, "{apart} m, {far} m");
}
