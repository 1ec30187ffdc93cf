//! Choice of the push that brings a square nearest to its goal, by simulating 200 of them:
//! `cargo run --release -p stickslip-dynamics --example rollout`.

use std::error::Error;

use stickslip_dynamics::{
    Dynamics, Feet, Friction, Object, Part, Pose, Pusher, RolloutStart, Scene, Shape, Twist,
};

const PUSHES: usize = 200;
const STEPS: usize = 60;
const H: f64 = 1.0 / 30.0;

fn main() -> Result<(), Box<dyn Error>> {
    // a square of 50 mm and a pusher of 10 mm, on a table
    let vertices = vec![
        [-0.025, -0.025],
        [0.025, -0.025],
        [0.025, 0.025],
        [-0.025, 0.025],
    ];
    let (radius, centre) = (0.005, [0.0, 0.0]);
    let friction = Friction {
        mu_s: 0.28,
        mu_p: 0.30,
        mu_f: 0.25,
        d_tri: 0.02,
    };
    let scene = Scene {
        gravity: 9.81,
        object: Object {
            mass: 0.5,
            inertia: 2.1e-4,
            shape: Shape::new(vec![Part::Polygon { vertices }])?,
        },
        feet: Feet::Tripod { angle: 0.0 },
        pusher: Pusher {
            fingers: vec![Shape::new(vec![Part::Disc { radius, centre }])?],
            stall_force: Some(20.0),
        },
        fixels: Vec::new(),
        nominal: friction,
    };

    // pushes along x, at heights from -20 to 20 mm
    let start = RolloutStart {
        pose: Pose::default(),
        twist: Twist::default(),
        friction,
    };
    let height = |push: usize| -0.02 + 0.04 * push as f64 / (PUSHES - 1) as f64;
    let push =
        |push| (0..=STEPS).map(move |k| Pose::new(-0.031 + 1e-3 * k as f64, height(push), 0.0));
    let pushers: Vec<Pose> = (0..PUSHES).flat_map(push).collect();
    let rollout = Dynamics::new(scene).rollout(H, &[start; PUSHES], &pushers)?;

    // the one that ends nearest to the goal
    let goal = Pose::new(0.040, 0.004, 0.5);
    let distance = |pose: Pose| {
        let turn = 0.02 * (pose.theta - goal.theta);
        ((pose.x - goal.x).powi(2) + (pose.y - goal.y).powi(2) + turn * turn).sqrt()
    };
    let ends = rollout.poses.chunks(STEPS + 1).map(|poses| poses[STEPS]);
    let best = ends
        .enumerate()
        .min_by(|(_, a), (_, b)| distance(*a).total_cmp(&distance(*b)));
    if let Some((push, end)) = best {
        println!("push at y = {:.1} mm ends at {end:.4?}", 1e3 * height(push));
    }
    Ok(())
}
