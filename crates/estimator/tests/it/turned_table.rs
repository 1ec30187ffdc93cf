//! Independence of the belief from the world's axes. Noise is drawn along them, but with equal
//! deviations on both, so the belief of a turned scene is the turned belief. The random numbers
//! differ, so scores differ as those of two seeds do.

use crate::common::{RATE, log, setup};
use stickslip::dynamics::Pose;
use stickslip::{FilterModel, Log, RunOptions, Setup, run};

const SEEDS: u64 = 24;
const ROWS: usize = 50;

/// The rows that the camera sees.
const SEEN: usize = 30;

/// Turns a pose by a right angle, counter-clockwise, which takes x to y and y to -x.
fn turned(pose: Pose) -> Pose {
    Pose::new(-pose.y, pose.x, pose.theta + std::f64::consts::FRAC_PI_2)
}

/// A disc that is pushed past a fixel; the camera is off in the end.
fn pushed() -> (Setup, Log) {
    let seen = |t: f64| t < (SEEN as f64 - 0.5) / RATE;
    let object = |t: f64| seen(t).then(|| Pose::new((0.02 * t - 0.004).max(0.0), 0.0, 0.0));
    let pusher = |t: f64| Some(Pose::new(0.02 * t - 0.039, 0.0, 0.0));
    (setup(&[[0.06, -0.022]]), log(ROWS, object, pusher))
}

/// The scene and its log on a table turned by a right angle.
fn on_a_turned_table(setup: &Setup, log: &Log) -> (Setup, Log) {
    let (mut setup, mut log) = (setup.clone(), log.clone());
    for fixel in &mut setup.scene.fixels {
        fixel.pose = turned(fixel.pose);
    }
    for pose in log.object.iter_mut().chain(&mut log.pusher) {
        *pose = pose.map(turned);
    }
    (setup, log)
}

/// Mean pose and logarithms of its standard deviations at the last row: of each seed.
fn beliefs(setup: &Setup, log: &Log, model: FilterModel) -> Vec<[f64; 6]> {
    let belief = |seed: u64| {
        let options = RunOptions {
            model,
            seed,
            ..RunOptions::default()
        };
        let run = run(setup, log, &options, &mut |_| ()).expect("a log that can be tracked");
        let row = run.estimate.rows.last().expect("rows");
        let mean = row.pose.expect("a pose");
        let std = row.spread.expect("a spread").pose;
        let log = [std.x, std.y, std.theta].map(libm::log);
        [mean.x, mean.y, mean.theta, log[0], log[1], log[2]]
    };
    (0..SEEDS).map(belief).collect()
}

/// Mean over the seeds, and its standard error.
fn over_seeds(values: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let count = SEEDS as f64;
    let mean = values.clone().fold(0.0, |sum, x| sum + x) / count;
    let square = values.fold(0.0, |sum, x| sum + (x - mean).powi(2));
    [mean, (square / (count - 1.0) / count).sqrt()]
}

fn the_belief_turns_with_the_scene(model: FilterModel) {
    let (setup, log) = pushed();
    let straight = beliefs(&setup, &log, model);
    let (setup, log) = on_a_turned_table(&setup, &log);
    let other = beliefs(&setup, &log, model);

    // the belief on the turned table, in the axes of the straight one
    let back = |b: &[f64; 6]| {
        let turn = b[2] - std::f64::consts::FRAC_PI_2;
        [b[1], -b[0], turn, b[4], b[3], b[5]]
    };
    for k in 0..6 {
        let [expected, error] = over_seeds(straight.iter().map(|b| b[k]));
        let [found, other_error] = over_seeds(other.iter().map(|b| back(b)[k]));
        let limit = 4.0 * error.hypot(other_error);
        assert!(
            (found - expected).abs() < limit,
            "{model:?}, number {k}: {found} turned, {expected} straight, {limit}"
        );
        // noise that is twice as large along one axis would be seen
        assert!(k < 3 || limit < 0.5, "{model:?}, number {k}: {limit}");
    }
}

#[test]
fn the_belief_of_contact_mode_turns_with_the_scene() {
    the_belief_turns_with_the_scene(FilterModel::Robust);
}

#[test]
fn the_belief_of_paper_mode_turns_with_the_scene() {
    the_belief_turns_with_the_scene(FilterModel::Paper);
}
