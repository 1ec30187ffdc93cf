//! Properties that files of an experiment must have in common.

use stickslip::Log;
use stickslip_formats::{Experiment, TruthFacts, read_scene};

#[test]
fn experiment_with_more_sensors_than_fixels_is_refused() {
    let setup = read_scene(include_str!("full_scene.toml"), "scene.toml").expect("a scene");
    let sensors = setup.scene.fixels.len() + 1;
    let log = Log {
        time: vec![0.0; 5],
        object: vec![None; 5],
        pusher: vec![None; 5],
        tactile: vec![vec![None; 5]; sensors],
        ..Log::default()
    };
    let refused = Experiment::new(setup, log, None, TruthFacts::default())
        .expect_err("a sensor without a fixel");
    assert!(
        refused.to_string().contains(&format!("{sensors}")),
        "{refused}"
    );
}
