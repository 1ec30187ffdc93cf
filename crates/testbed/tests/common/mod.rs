//! The scene `bench-scene` and its recorded trajectories.
#![allow(dead_code, reason = "each test file uses a part")]

use stickslip_dynamics::{
    Feet, Fixel, Friction, Object, Part, Pose, Pusher, Scene, Shape, SpeedProfile, Start,
};
use stickslip_testkit::data_root;

/// A disc of 5 mm.
pub fn disc() -> Shape {
    Shape::new(vec![Part::Disc {
        radius: 0.005,
        centre: [0.0; 2],
    }])
    .expect("a disc")
}

/// `bench-scene/scene.toml`.
pub fn bench_scene() -> Scene {
    let corners = vec![
        [-0.025, -0.025],
        [0.025, -0.025],
        [0.025, 0.025],
        [-0.025, 0.025],
    ];
    let fixel = |(x, y)| Fixel {
        pose: Pose::new(x, y, 0.0),
        shape: disc(),
    };
    Scene {
        gravity: 9.81,
        object: Object {
            mass: 0.5,
            inertia: 2.083_333_333_333_333_5e-4,
            shape: Shape::new(vec![Part::Polygon { vertices: corners }]).expect("a square"),
        },
        feet: Feet::Tripod {
            angle: std::f64::consts::FRAC_PI_2,
        },
        pusher: Pusher {
            shape: disc(),
            stall_force: None,
        },
        fixels: [(0.0794, 0.0591), (0.1203, -0.0458), (0.0606, 0.0485)]
            .map(fixel)
            .to_vec(),
        nominal: Friction {
            mu_s: 0.3,
            mu_p: 0.3,
            mu_f: 0.3,
            d_tri: 0.02,
        },
    }
}

/// Pushed at 20 mm/s for 6.6 s.
pub fn bench_start() -> Start {
    let speed = SpeedProfile::new(vec![[0.0, 0.02], [6.6, 0.02], [6.6, 0.0]]).expect("a profile");
    Start {
        object: Pose::default(),
        pusher: Pose::new(-0.032, -0.0033, 0.0),
        direction: 0.0,
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
