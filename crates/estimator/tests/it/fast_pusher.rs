//! A pusher that is tracked faster than the camera brings rows between frames. The belief about the
//! object does not depend on their number: rows at other rates show the same experiment.

use stickslip::dynamics::Pose;
use stickslip::{Estimate, FilterModel, Log, RunOptions, run};

use crate::common::{RATE, setup};

/// The last frame of the camera, and the end of the log (s).
const DARK: f64 = 2.0;
const END: f64 = 5.0;

/// Pose of a disc that a pusher drives through its middle from 1 s to 3 s.
fn truth(time: f64) -> Pose {
    Pose::new(0.02 * (time.clamp(1.0, 3.0) - 1.0), 0.0, 0.0)
}

/// Its log, with `between` rows of the pusher for each frame of the camera.
fn pushed(between: u32) -> Log {
    let rate = RATE * f64::from(between);
    let rows = 0..=(END * rate) as u32;
    let time: Vec<f64> = rows.clone().map(|row| f64::from(row) / rate).collect();
    let pusher = |time: &f64| Some(Pose::new(-0.035 + 0.02 * (time.min(3.0) - 1.0), 0.0, 0.0));
    let seen = |row: u32| row.is_multiple_of(between) && f64::from(row) <= DARK * rate;
    let object = |row: u32| seen(row).then(|| truth(f64::from(row) / rate));
    Log {
        object: rows.map(object).collect(),
        pusher: time.iter().map(pusher).collect(),
        time,
        ..Log::default()
    }
}

fn estimate(model: FilterModel, between: u32, seed: u64) -> Estimate {
    let options = RunOptions {
        model,
        particles: 200,
        seed,
        ..RunOptions::default()
    };
    let run = run(&setup(&[]), &pushed(between), &options, &mut |_| ());
    run.expect("a run").estimate
}

/// Standard deviations of x, y and θ at the end, and the greatest distance from the truth (m),
/// means over some seeds.
fn belief(model: FilterModel, between: u32) -> [f64; 4] {
    const SEEDS: u64 = 4;
    let mut sum = [0.0; 4];
    for seed in 0..SEEDS {
        let estimate = estimate(model, between, seed);
        let last = estimate.rows.last().expect("rows");
        let spread = last.spread.expect("a spread").pose;
        let rows = estimate.time.iter().zip(&estimate.rows);
        let error = |(time, pose): (&f64, Pose)| (pose.x - truth(*time).x).hypot(pose.y);
        let errors = rows.filter_map(|(time, row)| Some(error((time, row.pose?))));
        let farthest = errors.fold(0.0, f64::max);
        for (sum, value) in sum
            .iter_mut()
            .zip([spread.x, spread.y, spread.theta, farthest])
        {
            *sum += value / SEEDS as f64;
        }
    }
    sum
}

#[test]
fn rows_of_the_pusher_alone_do_not_change_the_belief() {
    for model in [FilterModel::Paper, FilterModel::Robust] {
        let slow = belief(model, 1);
        for between in [3, 33] {
            let fast = belief(model, between);
            let ratio = [0, 1, 2, 3].map(|k| fast[k] / slow[k]);
            let spreads = ratio[..3].iter().all(|ratio| (0.6..1.6).contains(ratio));
            assert!(
                spreads && ratio[3] < 1.5,
                "{model:?}, {between} rows a frame: {ratio:.2?} times what one row says"
            );
        }
    }
}
