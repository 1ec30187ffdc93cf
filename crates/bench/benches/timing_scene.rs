//! `cargo bench -p stickslip-bench --bench timing_scene`: the timing scene, phase by phase, on each
//! instruction set.

use std::error::Error;

use stickslip_bench::{
    Case, FRAMES, MOVING, PHASES, Results, instruction_sets, measure, timing_input, timing_scene,
};
use stickslip_dynamics::Dynamics;

/// Rounds that are counted.
const ROUNDS: usize = 9;

fn main() -> Result<(), Box<dyn Error>> {
    let scene = timing_scene()?;
    let case = |(name, level)| Case {
        name: format!("timing scene / {name}"),
        dynamics: Dynamics::new(scene.clone()).with_level(level),
        inputs: (0..FRAMES).map(timing_input).collect(),
    };
    let cases: Vec<Case> = instruction_sets().into_iter().map(case).collect();
    let mut results = Results::open()?;
    for course in measure(&cases, ROUNDS) {
        course.write("moving", MOVING, &mut results)?;
        for (phase, frames) in PHASES {
            course.write(phase, frames, &mut results)?;
        }
    }
    Ok(())
}
