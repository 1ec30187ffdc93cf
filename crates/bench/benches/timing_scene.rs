//! `cargo bench -p stickslip-bench --bench timing_scene`: the timing scene, phase by phase, on each
//! instruction set.

use std::error::Error;

use stickslip_bench::{
    FRAMES, MOVING, PHASES, Results, TimedScene, instruction_sets, time_scenes, timing_input,
    timing_scene,
};
use stickslip_dynamics::Dynamics;

/// Rounds that are counted.
const ROUNDS: usize = 9;

fn main() -> Result<(), Box<dyn Error>> {
    let scene = timing_scene()?;
    let timed = |(name, level)| TimedScene {
        name: format!("timing scene / {name}"),
        dynamics: Dynamics::new(scene.clone()).with_level(level),
        inputs: (0..FRAMES).map(timing_input).collect(),
    };
    let scenes: Vec<TimedScene> = instruction_sets().into_iter().map(timed).collect();
    let mut results = Results::open()?;
    for timing in time_scenes(&scenes, ROUNDS) {
        timing.write("moving", MOVING, &mut results)?;
        for (phase, frames) in PHASES {
            timing.write(phase, frames, &mut results)?;
        }
    }
    Ok(())
}
