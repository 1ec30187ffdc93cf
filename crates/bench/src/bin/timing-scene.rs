//! `timing-scene`: this project in the row of its peers. Prints the input of
//! `bench/peers/compare.py`: `pose FRAME X Y THETA` of the first particle, `time FRAME NS` per
//! particle, and `creep MM` over 5 s under half the friction limit.

use std::error::Error;
use std::io::Write;

use stickslip_bench::{Batch, FRAME, FRAMES, timing_input, timing_scene};
use stickslip_dynamics::{Dynamics, Level, Particle, Scene, StepInput, StepWork, Wrench};

/// Blocks of particles.
const BLOCKS: u32 = 4;

/// Frames of the creep test: 5 s.
const CREEP_FRAMES: u32 = 150;

fn main() -> Result<(), Box<dyn Error>> {
    let scene = timing_scene()?;
    let dynamics = with_level(
        Dynamics::new(scene.clone()),
        std::env::args().nth(1).as_deref(),
    )?;
    let mut out = std::io::stdout().lock();
    let mut batch = Batch::scattered(&dynamics, BLOCKS);
    (0..FRAMES).for_each(|frame| {
        batch.step(&dynamics, &timing_input(frame));
    });
    let mut batch = Batch::scattered(&dynamics, BLOCKS);
    for frame in 0..FRAMES {
        let time = batch.step(&dynamics, &timing_input(frame));
        let Some(Particle { pose, .. }) = batch.first() else {
            continue;
        };
        writeln!(
            out,
            "time {frame} {time}\npose {frame} {:e} {:e} {:e}",
            pose.x, pose.y, pose.theta
        )?;
    }
    writeln!(out, "creep {:e}", creep(&scene) * 1e3)?;
    Ok(())
}

/// The dynamics on the instructions of this name.
fn with_level(dynamics: Dynamics, name: Option<&str>) -> Result<Dynamics, String> {
    let Some(name) = name else {
        return Ok(dynamics);
    };
    let sets: Vec<(&str, Level)> = stickslip_bench::instruction_sets();
    let found = sets.iter().find(|(known, _)| *known == name);
    let known: Vec<&str> = sets.iter().map(|(known, _)| *known).collect();
    found
        .map(|(_, level)| dynamics.with_level(*level))
        .ok_or(format!("`{name}`: this machine has {}", known.join(", ")))
}

/// Distance that the object moves (m) under half of μ_s m g.
fn creep(scene: &Scene) -> f64 {
    let weight = scene.object.mass * scene.gravity;
    let applied = Wrench {
        fx: 0.5 * scene.nominal.mu_s * weight * FRAME,
        ..Wrench::default()
    };
    let (dynamics, mut particle, mut work) = (
        Dynamics::new(scene.clone()),
        [Particle::default()],
        StepWork::<1>::default(),
    );
    for _ in 0..CREEP_FRAMES {
        particle[0].applied = applied;
        let _ = dynamics.step(
            &StepInput {
                h: FRAME,
                pusher: None,
            },
            &[scene.nominal],
            &mut particle,
            &mut work,
        );
    }
    let pose = particle[0].pose;
    (pose.x * pose.x + pose.y * pose.y).sqrt()
}
