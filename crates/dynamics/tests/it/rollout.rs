//! Rollouts: many trajectories side by side are those that come step by step.

use stickslip_dynamics::{
    Dynamics, Feet, FingerMotion, Fixel, Friction, Level, Object, Outcome, Part, Particle, Pose,
    Pusher, RolloutEnd, RolloutError, RolloutStart, Scene, Shape, StepInput, StepWork, Twist,
};

const STEPS: usize = 60;
const H: f64 = 1.0 / 30.0;

/// A square, a disc that pushes it and may stall, and two fixels in which it jams.
fn scene() -> Scene {
    let disc = |radius| {
        let centre = [0.0, 0.0];
        Shape::new(vec![Part::Disc { radius, centre }]).expect("a disc")
    };
    let vertices = vec![
        [-0.025, -0.025],
        [0.025, -0.025],
        [0.025, 0.025],
        [-0.025, 0.025],
    ];
    let fixel = |x, y| Fixel {
        pose: Pose::new(x, y, 0.0),
        shape: disc(0.005),
    };
    Scene {
        gravity: 9.81,
        object: Object {
            mass: 0.5,
            inertia: 2.1e-4,
            shape: Shape::new(vec![Part::Polygon { vertices }]).expect("a square"),
        },
        feet: Feet::Tripod { angle: 0.0 },
        pusher: Pusher {
            fingers: vec![disc(0.005)],
            stall_force: Some(20.0),
        },
        fixels: vec![fixel(0.05, 0.015), fixel(0.05, -0.015)],
        nominal: friction(0),
    }
}

fn friction(i: usize) -> Friction {
    let share = 1.0 + 0.01 * i as f64;
    Friction {
        mu_s: 0.28 * share,
        mu_p: 0.30 * share,
        mu_f: 0.25 * share,
        d_tri: 0.02 * share,
    }
}

/// Start `i` of as many as there are: no two alike.
fn start(i: usize) -> RolloutStart {
    let k = i as f64;
    RolloutStart {
        pose: Pose::new(1e-4 * k, -2e-4 * k, 0.01 * k),
        twist: Twist {
            vx: 0.001 * (k % 3.0),
            vy: 0.0,
            omega: 0.01 * (k % 5.0),
        },
        friction: friction(i),
    }
}

/// The pusher's poses of trajectory `i`: it comes, stops for some steps, and goes on at an angle.
fn pusher(i: usize) -> impl Iterator<Item = Pose> {
    let k = i as f64;
    (0..=STEPS).map(move |step| {
        let travelled = 0.02 * H * (step.min(20) + step.saturating_sub(25)) as f64;
        Pose::new(
            -0.032 + travelled,
            -0.003 + 1e-3 * k + 0.1 * travelled,
            0.3 * k,
        )
    })
}

/// Trajectory `i`, alone and step by step.
fn alone(dynamics: &Dynamics, i: usize) -> (Vec<Pose>, RolloutEnd) {
    let RolloutStart {
        pose,
        twist,
        friction,
    } = start(i);
    let mut particle = [Particle {
        pose,
        twist,
        ..Particle::default()
    }];
    let mut work = StepWork::<1>::default();
    let poses: Vec<Pose> = pusher(i).collect();
    let mut end = RolloutEnd::default();
    let (mut trajectory, mut direction) = (vec![pose], [1.0, 0.0]);
    for pair in poses.windows(2) {
        // from where it stands
        let [lag_x, lag_y] = std::mem::take(&mut particle[0].pusher_lag)[0];
        let from = Pose::new(pair[0].x - lag_x, pair[0].y - lag_y, pair[0].theta);
        let (x, y) = (pair[1].x - from.x, pair[1].y - from.y);
        let length = libm::hypot(x, y);
        if length > 0.0 {
            direction = [x / length, y / length];
        }
        let motion = FingerMotion {
            pose: from,
            twist: from.twist_to(pair[1], H),
            direction,
        };
        let input = StepInput {
            h: H,
            pusher: Some(motion.into()),
        };
        let [report] = dynamics.step(&input, &[friction], &mut particle, &mut work);
        end.unsolved += u32::from(report.outcome != Outcome::Solved);
        end.pusher_lag = particle[0].pusher_lag[0];
        let lag = libm::hypot(end.pusher_lag[0], end.pusher_lag[1]);
        end.most_pusher_lag = end.most_pusher_lag.max(lag);
        trajectory.push(particle[0].pose);
    }
    (trajectory, end)
}

#[test]
fn trajectories_side_by_side_are_those_of_single_steps_bit_for_bit() {
    let dynamics = Dynamics::new(scene());
    let narrow = dynamics.clone().with_level(Level::baseline());
    for count in [1, 7, 8, 9, 65, 130] {
        let starts: Vec<RolloutStart> = (0..count).map(start).collect();
        let pushers: Vec<Pose> = (0..count).flat_map(pusher).collect();
        let rollout = dynamics.rollout(H, &starts, &pushers).expect("a rollout");
        assert_eq!(rollout.steps, STEPS);
        assert_eq!(narrow.rollout(H, &starts, &pushers), Ok(rollout.clone()));
        for (i, found) in rollout.poses.chunks(STEPS + 1).enumerate() {
            let (expected, end) = alone(&dynamics, i);
            assert_eq!(found, expected, "trajectory {i} of {count}");
            assert_eq!(rollout.ends[i], end);
        }
    }
}

/// The pusher advances 36 mm, and the fixels stop the square after some 20 mm. A drive that yields
/// ends 10 mm and more behind; one without a force limit has steps without a solution.
#[test]
fn pushers_that_the_object_stops_stay_behind() {
    let poses: Vec<Pose> = (0..=STEPS)
        .map(|step| Pose::new(-0.032 + 0.02 * H * step as f64, 0.0, 0.0))
        .collect();
    let at_rest = RolloutStart {
        pose: Pose::default(),
        twist: Twist::default(),
        friction: friction(0),
    };
    let end = |scene| {
        let rollout = Dynamics::new(scene).rollout(H, &[at_rest], &poses);
        rollout.expect("a rollout").ends[0]
    };
    let gave_way = end(scene());
    assert_eq!(gave_way.unsolved, 0);
    assert!(gave_way.pusher_lag[0] > 0.01, "{gave_way:?}");
    assert!(gave_way.most_pusher_lag >= gave_way.pusher_lag[0]);
    let mut rigid = scene();
    rigid.pusher.stall_force = None;
    let stuck = end(rigid);
    assert!(
        stuck.unsolved > 0 && stuck.most_pusher_lag == 0.0,
        "{stuck:?}"
    );
}

/// The drive stalls, and its poses go 100 mm on, through the jammed square and beyond: the square
/// stays where it jammed, and the pusher at its face.
#[test]
fn a_stalled_pusher_stays_where_it_stopped_however_far_its_poses_go_on() {
    let steps = 6 * STEPS;
    let advance = |step: usize| 0.0004 * step as f64;
    let poses: Vec<Pose> = (0..=steps)
        .map(|step| Pose::new(-0.032 + advance(step), 0.0, 0.0))
        .collect();
    let at_rest = RolloutStart {
        pose: Pose::default(),
        twist: Twist::default(),
        friction: friction(0),
    };
    let rollout = Dynamics::new(scene()).rollout(H, &[at_rest], &poses);
    let rollout = rollout.expect("a rollout");
    // fixels of radius 5 mm at x = 50 mm stop the face that lies 25 mm ahead of the middle
    for pose in &rollout.poses[2 * STEPS..] {
        let away = (pose.x - 0.02).abs().max(pose.y.abs());
        assert!(away < 1e-4 && pose.theta.abs() < 1e-3, "{pose:?}");
    }
    let end = rollout.ends[0];
    let stands = -0.032 + advance(steps) - end.pusher_lag[0];
    assert_eq!(end.unsolved, 0);
    assert!((stands - -0.01).abs() < 1e-4, "{end:?}");
}

/// q⁺ = q + h v⁺, of every step.
#[test]
fn twists_are_those_that_move_the_poses() {
    let starts: Vec<RolloutStart> = (0..20).map(start).collect();
    let pushers: Vec<Pose> = (0..20).flat_map(pusher).collect();
    let rollout = Dynamics::new(scene())
        .rollout(H, &starts, &pushers)
        .expect("a rollout");
    let (poses, twists) = (
        rollout.poses.chunks(STEPS + 1),
        rollout.twists.chunks(STEPS + 1),
    );
    for (poses, twists) in poses.zip(twists) {
        for (pair, twist) in poses.windows(2).zip(&twists[1..]) {
            assert_eq!(pair[0].advance(*twist, H), pair[1]);
        }
        assert_ne!(poses[0], poses[STEPS]);
    }
}

#[test]
fn input_that_cannot_be_simulated_is_refused() {
    let dynamics = Dynamics::new(scene());
    let starts = [start(0), start(1)];
    let pushers: Vec<Pose> = (0..2).flat_map(pusher).collect();
    let refused = |h: f64, starts: &[RolloutStart], pushers: &[Pose]| {
        dynamics.rollout(h, starts, pushers).expect_err("a refusal")
    };
    let shape = RolloutError::Shape {
        starts: 2,
        poses: 121,
        fingers: 1,
    };
    assert_eq!(refused(H, &starts, &pushers[..121]), shape);
    assert!(matches!(
        refused(H, &starts, &pushers[..2]),
        RolloutError::Shape { .. }
    ));
    assert!(matches!(
        refused(H, &[], &pushers),
        RolloutError::Shape { .. }
    ));
    for h in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            refused(h, &starts, &pushers),
            RolloutError::Step { .. }
        ));
    }
    let mut broken = pushers.clone();
    broken[63].theta = f64::NAN;
    let message = refused(H, &starts, &broken).to_string();
    assert!(
        message.starts_with("pusher pose 2 of trajectory 1"),
        "{message}"
    );
    let mut bad = starts;
    bad[1].twist.omega = f64::INFINITY;
    let message = refused(H, &bad, &pushers).to_string();
    assert!(message.starts_with("start 0 of trajectory 1"), "{message}");
    assert!(
        dynamics
            .rollout(H, &[], &[])
            .expect("nothing")
            .poses
            .is_empty()
    );
}
