//! A strong drive presses an object against a fixel, both yield, and the pusher stands there for
//! seconds (testbed). While the camera is off, the belief must not creep out of the jam.

use stickslip::{Occlusion, RunOptions, run};
use stickslip_evaluation::{PUSHER_MEMORY, Physics, REPEATS, Simulation, SimulationOptions};
use stickslip_formats::{TruthFacts, read_scene};

const SCENE: &str = "
gravity = 9.81
object  = { mass = 2, shape = [{ polygon = [[-0.08, -0.08], [0.08, -0.08], [0.08, 0.08], [-0.08, 0.08]] }] }
support = { friction = 0.28 }
pusher  = { friction = 0.3, stall_force = 100, shape = [{ disc = { radius = 0.005 } }] }
fixels  = { friction = 0.25 }
fixel   = [{ position = [0.16, 0.048], shape = [{ disc = { radius = 0.005 } }] }]
camera  = { position_std = 3.0e-4, orientation_std = 5.2e-3 }
start   = { object = [0, 0, 0], pusher = [-0.1, -0.024, 0], speed = [[0, 0], [0.5, 0.03], [7, 0.03], [7, 0]], duration = 9 }
";

#[test]
fn a_jam_holds_in_the_belief_while_the_pusher_stands() {
    let setup = read_scene(SCENE, "scene.toml").expect("a scene");
    for seed in 0..4_u64 {
        let options = SimulationOptions {
            physics: Physics::Testbed,
            seeds: seed.into(),
            rate: 30.0,
            repeats: REPEATS,
            pusher_memory: PUSHER_MEMORY,
        };
        let simulation = Simulation::run(&setup, &TruthFacts::default(), &options, &mut |_, _| ());
        let experiment = simulation.expect("it runs").into_experiment(setup.clone());
        let dark = experiment.facts.occlude_from.expect("a fixel is met");
        let options = RunOptions {
            occlusion: Occlusion::Rows {
                from: dark,
                to: None,
            },
            ..RunOptions::default()
        };
        let run = run(&setup, &experiment.log, &options, &mut |_| ()).expect("a run");
        let rows = &run.estimate.rows;
        // two seconds after the jam, and at the end
        let [early, late] = [dark + 60, rows.len() - 1].map(|row| rows[row].pose.expect("a pose"));
        let way = (late.x - early.x).hypot(late.y - early.y);
        assert!(way < 1e-3, "seed {seed}: {way} m");
        let ancestors = rows[rows.len() - 1].ancestors.expect("a count");
        assert!(ancestors > 5, "seed {seed}: {ancestors}");
    }
}
