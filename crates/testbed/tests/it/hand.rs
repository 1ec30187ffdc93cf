//! A hand: fingers on one spindle close around an object.

use std::f64::consts::PI;

use stickslip_dynamics::{Body, Pose, Scene, SpeedProfile, Start};
use stickslip_testbed::{Frame, Model, Rig, TouchSensors, Trace, Trial, TrialError};
use stickslip_testkit::{disc, pushed_scene};

const STALL: f64 = 15.0;

/// Two discs on the x axis about a disc of 30 mm that is 6 mm off their middle.
fn jaw() -> (Scene, Start) {
    let mut scene = pushed_scene(disc(0.03), disc(0.005), Vec::new());
    scene.pusher.fingers.push(disc(0.005));
    scene.pusher.stall_force = Some(STALL);
    let start = Start {
        object: Pose::new(0.006, 0.0, 0.0),
        pusher: Pose::new(-0.05, 0.0, 0.0),
        direction: 0.0,
        other_fingers: vec![(Pose::new(0.05, 0.0, 0.0), PI)],
        speed: SpeedProfile::constant(0.01),
        duration: 3.0,
    };
    (scene, start)
}

fn trial<'a>(scene: &'a Scene, start: &'a Start) -> Trial<'a> {
    Trial {
        scene,
        start,
        rate: 30.0,
        seed: 3,
    }
}

fn last(trace: &Trace) -> &Frame {
    trace.frames.last().expect("frames")
}

#[test]
fn a_jaw_brings_the_object_to_its_middle_and_shares_the_force_of_its_spindle() {
    let (scene, start) = jaw();
    let trial = trial(&scene, &start);
    let rig = Rig::of(&scene).run(&trial).expect("a trace");
    let model = Model {
        friction: scene.nominal,
        touch: TouchSensors::default(),
    };
    let model = model.run(&trial).expect("a trace");
    for trace in [&rig, &model] {
        let end = last(trace);
        assert!(
            end.object.x.abs() < 1e-4 && end.object.y.abs() < 1e-4,
            "{end:?}"
        );
        // together they press with what the spindle can; the table can take a difference of the two
        let [left, right] = end.finger_forces[..] else {
            panic!("{end:?}");
        };
        let sliding = scene.nominal.mu_s * scene.object.mass * scene.gravity;
        assert!((left + right - STALL).abs() < 0.05, "{end:?}");
        assert!((left - right).abs() < sliding, "{end:?}");
        assert_eq!(end.tactile, [true, true]);
        // they stall where they touch the disc, as far from the middle as each other
        let [left, right] = [end.pusher.x, end.other_fingers[0].x];
        assert!(
            (left + right).abs() < 1e-12 && (right - 0.035).abs() < 5e-5,
            "{end:?}"
        );
        // the finger on the object's side touches first
        let first = |finger| trace.first_contact(Body::Finger(finger)).expect("a touch");
        assert!(first(1) + 10 < first(0));
    }
    assert_eq!(model.unsolved, 0);
}

#[test]
fn each_finger_has_a_place_at_the_start() {
    let (mut scene, mut start) = jaw();
    start.other_fingers.clear();
    let refused = Rig::of(&scene).run(&trial(&scene, &start));
    assert_eq!(
        refused,
        Err(TrialError::Hand {
            fingers: 2,
            found: 1
        })
    );
    start = jaw().1;
    scene.pusher.fingers[1] = disc(0.02);
    let refused = Rig::of(&scene).run(&trial(&scene, &start));
    assert!(
        matches!(
            refused,
            Err(TrialError::Overlap {
                body: Body::Finger(1),
                ..
            })
        ),
        "{refused:?}"
    );
}
