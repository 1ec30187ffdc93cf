//! A stalled pusher that is logged a little inside the object: it stays where it yielded to, and
//! its friction drags nothing along.

use crate::common;
use crate::common::{FRAME, Rng, at, disc, fixel, pushing, square, square_scene, step};
use stickslip_dynamics::{
    Dynamics, Feet, FingerMotion, Friction, Object, Outcome, Particle, Pose, Pusher, Scene,
    StepInput, StepWork, Twist,
};

/// A plate of 60 mm x 45 mm between a round thumb and a fixel; the line through the two contacts is
/// within both friction cones.
fn squeezed() -> (Scene, Particle) {
    let scene = Scene {
        gravity: 9.81,
        object: Object {
            mass: 0.5,
            inertia: 2.34375e-4,
            shape: common::polygon(vec![
                [-0.0225, -0.03],
                [0.0225, -0.03],
                [0.0225, 0.03],
                [-0.0225, 0.03],
            ]),
        },
        feet: Feet::Tripod {
            angle: std::f64::consts::FRAC_PI_2,
        },
        pusher: Pusher {
            fingers: vec![disc(0.008)],
            stall_force: Some(25.0),
        },
        fixels: vec![fixel(disc(0.006), 0.06909, 0.01542)],
        nominal: Friction {
            mu_s: 0.38,
            mu_p: 0.40,
            mu_f: 0.21,
            d_tri: 0.02,
        },
    };
    (
        scene,
        at(Pose::new(
            0.044_411_7,
            0.001_099_7,
            24.0559_f64.to_radians(),
        )),
    )
}

/// Distance between two poses, rotation at the radius of gyration (m).
fn pose_distance(dynamics: &Dynamics, a: &Pose, b: &Pose) -> f64 {
    (a.x - b.x)
        .hypot(a.y - b.y)
        .hypot(dynamics.scene().object.gyration_radius() * (a.theta - b.theta))
}

/// A grasp that holds is at rest, wherever between 0 and 0.4 mm inside the object the thumb is
/// logged. Without the memory of where the thumb stands, each step drags the object along by its
/// own friction: 3 mm in 4 s.
#[test]
fn squeezed_object_does_not_creep() {
    for inside in [0.0, 1e-4, 2e-4, 4e-4] {
        let (scene, mut particle) = squeezed();
        let (dynamics, mut work) = (Dynamics::new(scene), StepWork::default());
        let input = pushing(FRAME, 0.020_982 - 0.008 + inside - 1.25e-4, -0.003, 0.0);
        // overlaps of 0.1 mm with the fixel are pushed apart at first
        (0..3).for_each(|_| {
            assert_eq!(
                step(&dynamics, &input, &mut particle, &mut work).outcome,
                Outcome::Solved
            )
        });
        let settled = particle.pose;
        (0..120).for_each(|_| {
            assert_eq!(
                step(&dynamics, &input, &mut particle, &mut work).outcome,
                Outcome::Solved
            )
        });
        let crept = pose_distance(&dynamics, &settled, &particle.pose);
        assert!(crept < 1e-5, "{inside}: {crept}");
    }
}

/// A force on the pusher pushes it back, wherever its last motion went: also after a recoil by
/// micrometres, or a motion along the object's face. A rigid pusher has no solution here.
#[test]
fn pusher_gives_way_to_what_presses_on_it_whatever_its_last_direction() {
    for direction in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.6, -0.8]] {
        let mut input = pushing(FRAME, 0.020_982 - 0.008 + 2e-4, -0.003, 0.0);
        input.pusher.as_mut().unwrap()[0].direction = direction;
        for stall_force in [Some(25.0), None] {
            let (mut scene, mut particle) = squeezed();
            scene.pusher.stall_force = stall_force;
            let (dynamics, mut work) = (Dynamics::new(scene), StepWork::default());
            let start = particle.pose;
            let solved = (0..60)
                .filter(|_| {
                    step(&dynamics, &input, &mut particle, &mut work).outcome == Outcome::Solved
                })
                .count();
            assert_eq!(
                solved == 60,
                stall_force.is_some(),
                "{direction:?}, {stall_force:?}: {solved} of 60 solved"
            );
            let moved = pose_distance(&dynamics, &start, &particle.pose);
            assert!(moved < 1e-3, "{direction:?}, {stall_force:?}: {moved}");
        }
    }
}

/// A pusher that stands s behind its pose is the pusher at the place where it stands, commanded s/h
/// faster: the same step. The object's corners meet a face of the pusher's that is wider, so that
/// gaps are linear and the two problems are equal but for rounding.
#[test]
fn lag_is_a_pusher_that_starts_where_it_stands() {
    let mut rng = Rng(7);
    let mut yielded = 0;
    for _ in 0..200 {
        let mut scene = square_scene(vec![fixel(disc(0.005), 0.0299, rng.within(-0.02, 0.02))]);
        scene.pusher = Pusher {
            fingers: vec![square(0.1)],
            stall_force: Some(rng.within(0.5, 30.0)),
        };
        let dynamics = Dynamics::new(scene);
        let (sin, cos) = libm::sincos(rng.within(-0.9, 0.9));
        let lag = rng.within(0.0, 5e-4);
        let (x, y) = (-0.125 + rng.within(0.0, 4e-4), rng.within(-0.01, 0.01));
        let command = Twist {
            vx: rng.within(0.0, 0.02),
            vy: rng.within(-0.01, 0.01),
            omega: 0.0,
        };
        let input = |behind: f64| {
            let pose = Pose::new(x - behind * cos, y - behind * sin, 0.0);
            let twist = Twist {
                vx: command.vx + behind * cos / FRAME,
                vy: command.vy + behind * sin / FRAME,
                omega: 0.0,
            };
            StepInput {
                h: FRAME,
                pusher: Some(
                    FingerMotion {
                        pose,
                        twist,
                        direction: [cos, sin],
                    }
                    .into(),
                ),
            }
        };
        let advance = |input: &StepInput, pusher_lag: [f64; 2]| {
            let mut particle = at(Pose::default());
            particle.pusher_lag[0] = pusher_lag;
            let (mut work, mut one) = (StepWork::<1>::default(), particle);
            let report = step(&dynamics, input, &mut one, &mut work);
            particle = one;
            (report.outcome, particle, work.solution(0).pusher_yield)
        };
        let (behind, ahead) = (
            advance(&input(0.0), [lag * cos, lag * sin]),
            advance(&input(lag), [0.0; 2]),
        );
        assert_eq!((behind.0, ahead.0), (Outcome::Solved, Outcome::Solved));
        assert!(
            pose_distance(&dynamics, &behind.1.pose, &ahead.1.pose) < 1e-9,
            "{behind:?} {ahead:?}"
        );
        let [x, y] = behind.1.pusher_lag[0];
        assert!((x.hypot(y) - FRAME * behind.2).abs() < 1e-15);
        yielded += u32::from(behind.2 > 1e-6);
    }
    assert!(yielded > 50, "{yielded}");
}
