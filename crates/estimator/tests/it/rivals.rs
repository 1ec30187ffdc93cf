//! Two baselines of the particle filter: the Kalman filter that stops at touch, and the object
//! glued to the pusher.

use crate::common::{log, setup};
use stickslip::dynamics::{Pose, Twist};
use stickslip::{Estimate, Method, Occlusion, RunOptions, TactileUse, run};

/// A disc that slides at 20 mm/s next to a pusher that turns. The camera is off from row 60, the
/// disc is touched from row 70.
fn estimate(method: Method, tactile: TactileUse) -> Estimate {
    let object = |time: f64| Some(Pose::new(0.02 * time, 0.0, 0.0));
    let pusher = |time: f64| Some(Pose::new(0.02 * time - 0.05, 0.0, 0.3 * time));
    let mut log = log(100, object, pusher);
    log.tactile = vec![(0..100).map(|row| Some(row >= 70)).collect()];
    let options = RunOptions {
        method,
        tactile,
        occlusion: Occlusion::Rows { from: 60, to: None },
        ..RunOptions::default()
    };
    let run = run(&setup(&[[0.5, 0.0]]), &log, &options, &mut |_| ());
    run.expect("a run").estimate
}

fn pose(estimate: &Estimate, row: usize) -> Pose {
    estimate.rows[row].pose.expect("a pose")
}

#[test]
fn the_kalman_filter_that_stops_rests_from_the_first_touch_on() {
    let kalman = estimate(Method::Kalman, TactileUse::Used);
    let stops = estimate(Method::KalmanStops, TactileUse::Used);
    assert_eq!(stops.rows[..=69], kalman.rows[..=69]);
    assert_eq!(pose(&stops, 99), pose(&kalman, 70));
    assert_eq!(stops.rows[99].twist, Some(Twist::default()));
    // without sensors it is the Kalman filter
    let numb = estimate(Method::KalmanStops, TactileUse::Ignored);
    assert_eq!(numb.rows, kalman.rows);
}

#[test]
fn what_is_glued_to_the_pusher_goes_round_with_it() {
    let glued = estimate(Method::WithPusher, TactileUse::Used);
    let kalman = estimate(Method::Kalman, TactileUse::Used);
    assert_eq!(glued.rows[59], kalman.rows[59]);
    // 50 mm ahead of the pusher, on a line that turns by 0.3 rad/s; the track errs by some 0.01 rad
    let turned = 0.3 * 40.0 / 30.0;
    let (last, pusher) = (pose(&glued, 99), 0.02 * 99.0 / 30.0 - 0.05);
    let expected = (pusher + 0.05 * libm::cos(turned), 0.05 * libm::sin(turned));
    assert!(
        (last.x - expected.0).abs() < 1e-3 && (last.y - expected.1).abs() < 1e-3,
        "{last:?}, {expected:?}"
    );
    assert!((last.theta - pose(&kalman, 59).theta - turned).abs() < 0.02);
}
