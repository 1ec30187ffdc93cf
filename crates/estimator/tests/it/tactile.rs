//! Evidence of touch sensors: when contact begins, and nothing while object and pusher stand.

use stickslip::dynamics::{Feet, Fixel, Friction, Object, Part, Pose, Pusher, Scene, Shape};
use stickslip::{
    Camera, Estimate, FilterModel, FilterSettings, Log, Occlusion, RunOptions, Setup, Tactile,
    Uncertainty, run,
};

/// First row without the camera, just before the block meets the fixel.
const HIDDEN_FROM: usize = 38;

/// Row from which the pusher stands, by its track, too.
const STANDS_FROM: usize = 90;

fn shape(part: Part) -> Shape {
    Shape::new(vec![part]).expect("a valid shape")
}

fn disc() -> Shape {
    shape(Part::Disc {
        radius: 0.005,
        centre: [0.0; 2],
    })
}

/// A square block 5 mm before a fixel that stands `aside` of its middle (m).
fn setup(aside: f64) -> Setup {
    let side = 0.025;
    let block = shape(Part::Polygon {
        vertices: vec![[-side, -side], [side, -side], [side, side], [-side, side]],
    });
    let scene = Scene {
        gravity: 9.81,
        object: Object {
            mass: 0.5,
            inertia: 2.1e-4,
            shape: block,
        },
        feet: Feet::Tripod { angle: 0.3 },
        pusher: Pusher {
            fingers: vec![disc()],
            stall_force: Some(20.0),
        },
        fixels: vec![Fixel {
            pose: Pose::new(0.035, aside, 0.0),
            shape: disc(),
        }],
        nominal: Friction {
            mu_s: 0.28,
            mu_p: 0.3,
            mu_f: 0.25,
            d_tri: 0.02,
        },
    };
    let camera = Camera {
        position_std: 3e-4,
        orientation_std: 5e-3,
        latency: 0.0,
        pusher_position_std: 1e-4,
        pusher_orientation_std: 0.0,
    };
    Setup {
        scene,
        stall_force_assumed: false,
        camera: Some(camera),
        tactile: Tactile::default(),
        filter: FilterSettings::default(),
        wrench: None,
        uncertainty: Uncertainty::default(),
        start: None,
    }
}

/// The pusher goes at 30 mm/s from row 30 until it has pushed the block 5 mm to the fixel and half
/// a millimetre further.
fn log(readings: impl Fn(usize) -> bool) -> Log {
    let time: Vec<f64> = (0..150).map(|row| f64::from(row) / 30.0).collect();
    let pushed = |t: f64| (0.03 * (t - 1.0)).clamp(0.0, 0.0105);
    let pusher = time
        .iter()
        .map(|&t| Some(Pose::new(-0.035 + pushed(t), 0.0, 0.0)));
    let object = time
        .iter()
        .map(|&t| Some(Pose::new((pushed(t) - 0.005).clamp(0.0, 0.005), 0.0, 0.0)));
    let tactile = vec![(0..time.len()).map(|row| Some(readings(row))).collect()];
    Log {
        object_covariance: Vec::new(),
        pusher: pusher.collect(),
        other_fingers: Vec::new(),
        object: object.collect(),
        tactile,
        force: vec![None; time.len()],
        time,
    }
}

fn estimate(aside: f64, readings: impl Fn(usize) -> bool) -> Estimate {
    let occlusion = Occlusion::Rows {
        from: HIDDEN_FROM,
        to: None,
    };
    let options = RunOptions {
        model: FilterModel::Paper,
        particles: 200,
        occlusion,
        ..RunOptions::default()
    };
    run(&setup(aside), &log(readings), &options, &mut |_| ())
        .expect("a run")
        .estimate
}

/// The block meets the fixel in row 40.
fn true_reading(row: usize) -> bool {
    row >= 40
}

#[test]
fn readings_tell_nothing_of_a_block_that_stands() {
    let pressed = estimate(0.0, true_reading);
    let released = estimate(0.0, |row| true_reading(row) && row < STANDS_FROM);
    let flickering = estimate(0.0, |row| {
        true_reading(row) && (row < STANDS_FROM || row % 3 == 0)
    });
    for other in [released, flickering] {
        for row in STANDS_FROM - 1..150 {
            let [a, b] = [&pressed.rows[row], &other.rows[row]];
            assert_eq!(
                a.ess.map(|ess| (1e6 * ess).round()),
                b.ess.map(|ess| (1e6 * ess).round()),
                "row {row}"
            );
            let [p, q] = [a.pose.expect("a pose"), b.pose.expect("a pose")];
            assert!(
                (p.x - q.x)
                    .abs()
                    .max((p.y - q.y).abs())
                    .max((p.theta - q.theta).abs())
                    < 1e-12,
                "row {row}: {p:?} {q:?}"
            );
        }
    }
}

#[test]
fn readings_tell_when_contact_begins() {
    let [early, late] = [38, 42].map(|from| estimate(0.02, |row| row >= from));
    assert_ne!(early.rows[60].pose, late.rows[60].pose);
}
