//! Whole runs against closed forms of the time-stepping scheme: sliding, spinning, pivoting on a
//! foot, and not moving at all.

use crate::common::{FRAME, at, disc, fixel, square, step, twist_distance};
use stickslip_dynamics::{
    Dynamics, Feet, FingerMotion, Friction, Object, Outcome, Particle, Pose, Pusher, Scene,
    StepInput, StepWork, Twist, Wrench, solve,
};
use stickslip_testkit::{Block, Stop};

const BLOCK: Block = Block {
    mass: 0.4,
    inertia: 3e-4,
    h: FRAME,
    mu_s: 0.21,
    gravity: 9.81,
    d_tri: 0.02,
};

/// A minute of frames.
const MINUTE: u32 = 1800;

/// The block as a scene, with a pusher that is as strong as need be and one fixel far away.
fn scene() -> Scene {
    Scene {
        gravity: BLOCK.gravity,
        object: Object {
            mass: BLOCK.mass,
            inertia: BLOCK.inertia,
            shape: square(0.025),
        },
        feet: Feet::Tripod { angle: 0.0 },
        pusher: Pusher {
            fingers: vec![disc(0.005)],
            stall_force: None,
        },
        fixels: vec![fixel(disc(0.005), 5.0, 5.0)],
        nominal: Friction {
            mu_s: BLOCK.mu_s,
            mu_p: 0.3,
            mu_f: 0.3,
            d_tri: BLOCK.d_tri,
        },
    }
}

const NO_PUSHER: StepInput = StepInput {
    h: FRAME,
    pusher: None,
};

/// Steps until the twist is zero; the number of steps. Twists may be off by 1e-9 m/s or, at the
/// radius of gyration, 1e-7 rad/s.
fn step_until_rest(
    particle: &mut Particle,
    speed: impl Fn(&Twist) -> f64,
    expected: impl Fn(u64) -> f64,
) -> u64 {
    let tolerance = if particle.twist.omega == 0.0 {
        1e-9
    } else {
        1e-7
    };
    let (dynamics, mut work) = (Dynamics::new(scene()), StepWork::default());
    for k in 1..1000 {
        let report = step(&dynamics, &NO_PUSHER, particle, &mut work);
        assert_eq!(report.outcome, Outcome::Solved, "step {k}");
        let error = speed(&particle.twist) - expected(k);
        assert!(error.abs() < tolerance, "step {k}: speed off by {error:e}");
        if particle.twist == Twist::default() {
            return k;
        }
    }
    panic!("it never stops");
}

#[test]
fn sliding_block_stops_after_the_steps_and_the_way_of_the_closed_form() {
    for (speed, angle) in [(0.7, 0.0), (0.31, 2.0), (0.05, -1.0), (1.9, 4.5)] {
        let (sin, cos) = libm::sincos(angle);
        let twist = Twist {
            vx: speed * cos,
            vy: speed * sin,
            omega: 0.0,
        };
        let mut particle = Particle {
            twist,
            ..at(Pose::new(0.3, -0.2, 0.7))
        };
        let steps = step_until_rest(
            &mut particle,
            |v| v.vx * cos + v.vy * sin,
            |k| BLOCK.slide_speed(speed, k),
        );
        let Stop {
            steps: expected,
            travel,
        } = BLOCK.slide_stop(speed);
        assert_eq!(steps, expected, "speed {speed}");
        let error = [
            particle.pose.x - 0.3 - travel * cos,
            particle.pose.y + 0.2 - travel * sin,
            particle.pose.theta - 0.7,
        ];
        assert!(
            error.iter().all(|e| e.abs() < 1e-9),
            "speed {speed}: {error:?}"
        );
    }
}

#[test]
fn spinning_block_stops_after_the_steps_and_the_angle_of_the_closed_form() {
    for omega in [40.0, 7.3, 0.4] {
        let mut particle = Particle {
            twist: Twist {
                omega,
                ..Twist::default()
            },
            ..at(Pose::new(0.3, -0.2, 0.7))
        };
        let steps = step_until_rest(&mut particle, |v| v.omega, |k| BLOCK.spin_speed(omega, k));
        let Stop {
            steps: expected,
            travel,
        } = BLOCK.spin_stop(omega);
        assert_eq!(steps, expected, "omega {omega}");
        let error = [
            particle.pose.x - 0.3,
            particle.pose.y + 0.2,
            particle.pose.theta - 0.7 - travel,
        ];
        assert!(
            error.iter().all(|e| e.abs() < 1e-7),
            "omega {omega}: {error:?}"
        );
    }
}

#[test]
fn block_that_pivots_about_a_stuck_foot_has_the_closed_form_twist_and_impulses() {
    let (b, d, root_3) = (BLOCK.bound(), BLOCK.d_tri, 3.0_f64.sqrt());
    let about_foot = BLOCK.inertia + BLOCK.mass * d * d;
    // Shares of what the stuck foot can take, and how fast it turns.
    for (across, along, turn) in [
        (0.0, 0.0, 1.0),
        (0.9, 0.1, 1.0),
        (-0.6, -0.6, 3.0),
        (0.3, 0.9, 0.02),
    ] {
        let omega = turn * b * d / BLOCK.inertia;
        let fy = -BLOCK.mass * d * omega - b / root_3 - along * b / 3.0;
        let torque = about_foot * omega + d * fy + 2.0 * b * d / root_3;
        let (problem, expected) = BLOCK
            .pivot_step(Wrench {
                fx: -across * b / 3.0,
                fy,
                torque,
            })
            .expect("a load that makes it pivot");
        let (solution, report) = solve(&problem);
        assert_eq!(report.outcome, Outcome::Solved);
        let error = twist_distance(&problem, solution.twist, expected.twist);
        assert!(error < 1e-9, "turn {turn}: twist off by {error:e}");
        for (p, e) in solution
            .feet
            .as_flattened()
            .iter()
            .zip(expected.feet.as_flattened())
        {
            assert!(
                (p - e).abs() < 1e-8 * b,
                "turn {turn}: {:?}, expected {:?}",
                solution.feet,
                expected.feet
            );
        }
    }
}

/// The impulse that just makes the block slide with `twist`: what the feet can oppose it with, Σ
/// J_kᵀ b_k s_k/|s_k|.
fn limit(pose: Pose, twist: Twist) -> Wrench {
    let feet = scene().feet_at(pose.theta, &scene().nominal, FRAME);
    feet.iter().fold(Wrench::default(), |sum, foot| {
        let s = twist.at(foot.arm);
        let size = foot.bound / libm::hypot(s[0], s[1]);
        let p = s.map(|s| size * s);
        Wrench {
            fx: sum.fx + p[0],
            fy: sum.fy + p[1],
            torque: sum.torque + foot.arm[0] * p[1] - foot.arm[1] * p[0],
        }
    })
}

fn scaled(w: Wrench, share: f64) -> Wrench {
    Wrench {
        fx: share * w.fx,
        fy: share * w.fy,
        torque: share * w.torque,
    }
}

/// Forces alone, torque alone, and both.
const MOTIONS: [[f64; 3]; 8] = [
    [1.0, 0.0, 0.0],
    [-0.6, 0.8, 0.0],
    [0.3, -0.95, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
    [0.5, 0.5, 20.0],
    [-0.2, 0.9, -60.0],
    [0.7, -0.1, 200.0],
];

fn twist_of([vx, vy, omega]: [f64; 3]) -> Twist {
    Twist { vx, vy, omega }
}

/// Asserts that a particle at rest stays exactly where it is for a minute.
fn assert_stays(dynamics: &Dynamics, input: &StepInput, start: Particle, what: &str) {
    let (mut particle, mut work) = (start, StepWork::default());
    for frame in 0..MINUTE {
        let report = step(dynamics, input, &mut particle, &mut work);
        assert_eq!(report.outcome, Outcome::Solved, "{what}, frame {frame}");
        assert_eq!(
            (particle.pose, particle.twist),
            (start.pose, Twist::default()),
            "{what}, frame {frame}"
        );
    }
}

#[test]
fn limit_of_a_translation_and_of_a_spin_are_the_textbook_ones() {
    let w = limit(
        Pose::default(),
        Twist {
            vx: 1.0,
            ..Twist::default()
        },
    );
    assert!((w.fx / BLOCK.bound() - 1.0).abs() < 1e-14 && w.torque.abs() < 1e-16);
    let w = limit(
        Pose::default(),
        Twist {
            omega: 1.0,
            ..Twist::default()
        },
    );
    assert!((w.torque / (BLOCK.bound() * BLOCK.d_tri) - 1.0).abs() < 1e-14 && w.fx.abs() < 1e-16);
}

#[test]
fn stuck_block_under_99_percent_of_its_limit_does_not_drift_in_a_minute() {
    let dynamics = Dynamics::new(scene());
    for motion in MOTIONS {
        for pose in [Pose::default(), Pose::new(0.3, -0.2, 0.7)] {
            let applied = scaled(limit(pose, twist_of(motion)), 0.99);
            assert_stays(
                &dynamics,
                &NO_PUSHER,
                Particle {
                    applied,
                    ..at(pose)
                },
                &format!("{motion:?} at {pose:?}"),
            );
        }
    }
}

#[test]
fn block_under_101_percent_of_its_limit_moves_at_once() {
    let dynamics = Dynamics::new(scene());
    for motion in MOTIONS {
        let pose = Pose::new(0.3, -0.2, 0.7);
        let w = scaled(limit(pose, twist_of(motion)), 1.01);
        let mut particle = Particle {
            applied: w,
            ..at(pose)
        };
        let report = step(
            &dynamics,
            &NO_PUSHER,
            &mut particle,
            &mut StepWork::default(),
        );
        let v = particle.twist;
        assert_eq!(report.outcome, Outcome::Solved);
        assert!(
            w.fx * v.vx + w.fy * v.vy + w.torque * v.omega > 0.0,
            "{motion:?}: {v:?}"
        );
        assert!(
            libm::hypot(v.vx, v.vy) + 0.02 * v.omega.abs() > 1e-4,
            "{motion:?}: {v:?}"
        );
    }
}

/// The pusher at rest, its disc `apart` from the middle of the block's face that looks to −x when
/// turned by `pose`.
fn resting_pusher(pose: Pose, apart: f64) -> StepInput {
    let [x, y] = pose.transform([-0.030 - apart, 0.004]);
    let direction = pose.rotate([1.0, 0.0]);
    StepInput {
        h: FRAME,
        pusher: Some(
            FingerMotion {
                pose: Pose::new(x, y, 0.0),
                twist: Twist::default(),
                direction,
            }
            .into(),
        ),
    }
}

#[test]
fn stuck_block_beside_a_resting_pusher_does_not_drift_in_a_minute() {
    let dynamics = Dynamics::new(scene());
    for apart in [0.0, 1e-4] {
        for motion in MOTIONS {
            for pose in [Pose::default(), Pose::new(0.3, -0.2, 0.7)] {
                let applied = scaled(limit(pose, twist_of(motion)), 0.99);
                let what = format!("{motion:?} at {pose:?}, pusher {apart} m away");
                assert_stays(
                    &dynamics,
                    &resting_pusher(pose, apart),
                    Particle {
                        applied,
                        ..at(pose)
                    },
                    &what,
                );
            }
        }
    }
}

#[test]
fn block_pressed_on_a_resting_pusher_by_five_times_its_limit_does_not_drift_in_a_minute() {
    let dynamics = Dynamics::new(scene());
    for pose in [Pose::default(), Pose::new(0.3, -0.2, 0.7)] {
        // The line of action runs through the point of contact, 4 mm off the centre of mass.
        let [fx, fy] = pose.rotate([-5.0 * BLOCK.bound(), 0.0]);
        let applied = Wrench {
            fx,
            fy,
            torque: 0.004 * 5.0 * BLOCK.bound(),
        };
        assert_stays(
            &dynamics,
            &resting_pusher(pose, 0.0),
            Particle {
                applied,
                ..at(pose)
            },
            &format!("at {pose:?}"),
        );
    }
}
