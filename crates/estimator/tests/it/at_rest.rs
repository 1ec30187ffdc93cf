//! An object that rests against a pusher that stands, and contacts that slide slowly.

use crate::common::{RATE, log, setup};
use stickslip::dynamics::{Part, Pose, Shape};
use stickslip::{EstimateRow, Log, Method, Occlusion, RunOptions, Setup, Tracking, run};
use stickslip_filter::Streams;

const SPEED: f64 = 0.02;

/// Noise of the pusher's poses that the setup states (m).
const PUSHER_NOISE: f64 = 1e-4;

/// Time at which the pusher stops (s).
const STOPS: f64 = 2.0;

const TRACKINGS: [Tracking; 2] = [Tracking::Smoothed, Tracking::Causal];

/// The log with noise on its pusher.
fn with_noise(mut log: Log) -> Log {
    for (k, pose) in log.pusher.iter_mut().enumerate() {
        let [x, y] = Streams::new(6).normals::<2>(k as u64, 0, 0);
        *pose = pose.map(|pose| {
            let (x, y) = (pose.x + PUSHER_NOISE * x, pose.y + PUSHER_NOISE * y);
            Pose::new(x, y, pose.theta)
        });
    }
    log
}

/// A square that a disc pushes by its middle, with little friction between them.
fn square() -> Setup {
    let mut setup = setup(&[]);
    let side = 0.025;
    let vertices = vec![[-side, -side], [side, -side], [side, side], [-side, side]];
    setup.scene.object.shape = Shape::new(vec![Part::Polygon { vertices }]).expect("a square");
    setup.scene.nominal.mu_p = 0.02;
    setup
}

/// A push of that square until the pusher stops, which slips along the face at `sideways` (m/s).
/// The camera sees the true motion under the nominal friction.
fn slipping(sideways: f64) -> Log {
    let pusher = |time: f64| {
        let on = (time - 0.2).clamp(0.0, STOPS - 0.2);
        Some(Pose::new(-0.031 + SPEED * on, sideways * (on - 0.9), 0.0))
    };
    let mut log = log(180, |_| Some(Pose::default()), pusher);
    let options = RunOptions {
        method: Method::Nominal,
        ..RunOptions::default()
    };
    let truth = run(&square(), &log, &options, &mut |_| ()).expect("a simulation");
    for (row, pose) in truth.estimate.rows.iter().enumerate() {
        let [x, y, turn] = Streams::new(5).normals::<3>(row as u64, 0, 0);
        let noise = Pose::new(3e-4 * x, 3e-4 * y, 5e-3 * turn);
        log.object[row] = pose
            .pose
            .map(|pose| Pose::new(pose.x + noise.x, pose.y + noise.y, pose.theta + noise.theta));
    }
    with_noise(log)
}

fn rows(setup: &Setup, log: &Log, tracking: Tracking, hidden: usize) -> Vec<EstimateRow> {
    let options = RunOptions {
        tracking,
        occlusion: Occlusion::Rows {
            from: hidden,
            to: None,
        },
        ..RunOptions::default()
    };
    let run = run(setup, log, &options, &mut |_| ()).expect("a run");
    run.estimate.rows
}

/// Rows from some time (s) on to another.
fn between(rows: &[EstimateRow], from: f64, to: f64) -> &[EstimateRow] {
    &rows[(from * RATE) as usize..(to * RATE) as usize]
}

#[test]
fn contact_with_a_standing_noisy_pusher_sticks_at_rest() {
    for tracking in TRACKINGS {
        for hidden in [40, 180] {
            let rows = rows(&square(), &slipping(0.0), tracking, hidden);
            for row in between(&rows, STOPS + 0.5, 6.0) {
                let slip = row.slip.as_ref().expect("bodies")[0];
                let touches = row.contact_pusher.expect("a share");
                assert!(
                    touches > 0.05 && slip.stick > 0.99 * touches,
                    "{tracking:?}, hidden from {hidden}: {slip:?}"
                );
            }
        }
    }
}

#[test]
fn contact_that_slides_slowly_under_a_noisy_pusher_slides() {
    for tracking in TRACKINGS {
        for sideways in [-0.006, 0.006] {
            let rows = rows(&square(), &slipping(sideways), tracking, 180);
            let pushed = between(&rows, 0.8, STOPS - 0.2);
            let slides = |row: &&EstimateRow| {
                let slip = row.slip.as_ref().expect("bodies")[0];
                // the normal points along x into the object, so left of it is y
                let share = if sideways < 0.0 {
                    slip.left
                } else {
                    slip.right
                };
                share > 0.5
            };
            let share = pushed.iter().filter(slides).count() as f64 / pushed.len() as f64;
            assert!(share > 0.8, "{tracking:?}, {sideways} m/s: {share}");
        }
    }
}

/// A disc that a pusher brings to about where a fixel stands. Where that is, is known to
/// millimetres only, so that many particles do not reach it. Its sensor reads 1 from then on for
/// nine seconds, in which nothing moves.
#[test]
fn contact_whose_sensor_goes_on_reading_one_stays_and_the_spread_does_not_grow() {
    let mut setup = setup(&[[0.06, 0.0]]);
    setup.uncertainty.fixel_position = 2e-3;
    setup.uncertainty.roughness = 0.0;
    let reaches = 1.3;
    let pusher = |time: f64| Some(Pose::new(-0.036 + SPEED * time.min(reaches), 0.0, 0.0));
    let frame = |time: f64| Some(Pose::new(1e-9 * time, 0.0, 0.0));
    let mut log = with_noise(log(324, frame, pusher));
    log.tactile = vec![log.time.iter().map(|time| Some(*time >= reaches)).collect()];
    for tracking in TRACKINGS {
        let rows = rows(&setup, &log, tracking, 15);
        let touches = |row: &EstimateRow| row.contact_others.as_ref().expect("fixels")[0];
        let spread = |row: &EstimateRow| {
            let spread = row.spread.expect("a spread").pose;
            spread.x.hypot(spread.y)
        };
        let [first, .., last] = between(&rows, reaches + 0.5, 10.8) else {
            panic!("many rows");
        };
        assert!(
            touches(first) > 0.8 && touches(last) > touches(first) - 0.05,
            "{tracking:?}: {} to {}",
            touches(first),
            touches(last)
        );
        assert!(
            spread(last) < 1.1 * spread(first),
            "{tracking:?}: {} to {} m",
            spread(first),
            spread(last)
        );
    }
}
