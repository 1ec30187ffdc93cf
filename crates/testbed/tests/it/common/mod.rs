//! The scene `bench-scene` and its recorded trajectories.
use stickslip_dynamics::{Pose, Scene, SpeedProfile, Start};
use stickslip_testkit::{data_root, disc, fixels, pushed_scene, square};

/// `bench-scene/scene.toml`.
pub fn bench_scene() -> Scene {
    let pin = disc(0.005);
    let positions = [[0.0794, 0.0591], [0.1203, -0.0458], [0.0606, 0.0485]];
    pushed_scene(square(0.05), pin.clone(), fixels(&pin, &positions))
}

/// Pushed at 20 mm/s for 6.6 s.
pub fn bench_start() -> Start {
    let speed = SpeedProfile::new(vec![[0.0, 0.02], [6.6, 0.02], [6.6, 0.0]]).expect("a profile");
    Start {
        object: Pose::default(),
        pusher: Pose::new(-0.032, -0.0033, 0.0),
        direction: 0.0,
        other_fingers: Vec::new(),
        speed,
        duration: 8.0,
    }
}

/// Poses at the ends of the frames 1, 2, ...
pub fn reference(file: &str) -> Vec<[f64; 3]> {
    let path = data_root()
        .expect("recorded data")
        .join("bench-scene")
        .join(file);
    let text = std::fs::read_to_string(path).expect("the reference trajectory");
    let row = |line: &str| {
        let words: Vec<f64> = line
            .split_whitespace()
            .map(|word| word.parse().expect("a number"))
            .collect();
        [words[1], words[2], words[3]]
    };
    text.lines().map(row).collect()
}
