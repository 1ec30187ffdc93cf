//! `rollouts`: rollouts of the timing scene on one thread, for comparison with Python's by
//! `bench/python/rollouts.py`.
//!
//! Prints ns per trajectory and step, the best of several rounds. The time is that which the thread
//! was on a processor, if Linux reports it.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use stickslip_bench::{FRAME, MOVING, scattered, timing_input, timing_scene};
use stickslip_dynamics::{Dynamics, Pose, RolloutStart, Twist};

const STATES: u32 = 10_000;
const ROUNDS: u32 = 5;

/// Time that this thread has been on a processor (s).
fn seconds_on_processor() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}

fn main() -> Result<(), Box<dyn Error>> {
    let scene = timing_scene()?;
    let friction = scene.nominal;
    let dynamics = Dynamics::new(scene);
    let start = |index| RolloutStart {
        pose: scattered(index).pose,
        twist: Twist::default(),
        friction,
    };
    let starts: Vec<RolloutStart> = (0..STATES).map(start).collect();
    let frames = (0..=MOVING.end as u32).filter_map(|frame| timing_input(frame).pusher);
    let push: Vec<Pose> = frames.map(|motion| motion[0].pose).collect();
    let pushers = push.repeat(STATES as usize);
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let (begin, started) = (seconds_on_processor(), Instant::now());
        black_box(dynamics.rollout(FRAME, &starts, &pushers)?);
        let wall = started.elapsed().as_secs_f64();
        let taken = begin.zip(seconds_on_processor());
        best = best.min(taken.map_or(wall, |(begin, end)| end - begin));
    }
    println!(
        "{:.2}",
        1e9 * best / f64::from(STATES) / MOVING.len() as f64
    );
    Ok(())
}
