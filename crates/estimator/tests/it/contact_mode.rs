//! Behaviour of the robust model that the paper's model lacks, on experiments whose truth is known
//! by construction.

use crate::common::{RATE, log, setup, slippery, sticky};
use stickslip::dynamics::Pose;
use stickslip::{Estimate, FilterModel, Log, Method, Occlusion, Run, RunOptions, Setup, run};

/// Speed of the pusher (m/s), and time at which it meets the disc (s).
const SPEED: f64 = 0.02;
const MEETS: f64 = 1.0;

/// A pusher that drives the disc through its middle from [`MEETS`] to 3 s.
fn pusher(time: f64) -> Option<Pose> {
    Some(Pose::new(
        -0.035 + SPEED * (time.min(3.0) - MEETS),
        0.0,
        0.0,
    ))
}

/// Pose of the disc under that push.
fn truth(time: f64) -> Pose {
    Pose::new(SPEED * (time.clamp(MEETS, 3.0) - MEETS), 0.0, 0.0)
}

fn pushed(latency: f64) -> Log {
    log(150, |time| Some(truth(time - latency)), pusher)
}

fn estimate(setup: &Setup, log: &Log, model: FilterModel) -> Estimate {
    estimate_of(400, setup, log, model)
}

fn estimate_of(particles: usize, setup: &Setup, log: &Log, model: FilterModel) -> Estimate {
    let options = RunOptions {
        model,
        particles,
        ..RunOptions::default()
    };
    run(setup, log, &options, &mut |_| ())
        .expect("a run")
        .estimate
}

/// Largest distance from the truth over the rows from `from` (s) to `to` (s), in m.
fn farthest(estimate: &Estimate, from: f64, to: f64) -> f64 {
    let rows = estimate.time.iter().zip(&estimate.rows);
    let errors = rows.filter(|(time, _)| (from..to).contains(*time));
    errors
        .filter_map(|(time, row)| Some((row.pose?.x - truth(*time).x).hypot(row.pose?.y)))
        .fold(0.0, f64::max)
}

#[test]
fn friction_that_nothing_was_felt_of_keeps_its_prior() {
    let setup = setup(&[[0.2, 0.0]]);
    let estimate = estimate(&setup, &pushed(0.0), FilterModel::Robust);
    let last = estimate.rows.last().expect("rows");
    let (mean, std) = (
        last.friction.expect("friction").mu_f,
        last.spread
            .and_then(|spread| spread.friction)
            .expect("a spread")
            .mu_f,
    );
    // a log-normal variable of median m and deviation s has mean m e^(s²/2) and this deviation; the
    // upper limit of 1 cuts little of it
    let (median, s): (f64, f64) = (0.33, 0.45);
    let expected = median * libm::exp(s * s / 2.0);
    let deviation = expected * (libm::exp(s * s) - 1.0).sqrt();
    assert!((mean / expected - 1.0).abs() < 0.1, "{mean}, {expected}");
    assert!((std / deviation - 1.0).abs() < 0.2, "{std}, {deviation}");
}

#[test]
fn after_one_pose_an_object_is_where_the_camera_shows_it_within_its_nominal_noise() {
    let setup = setup(&[]);
    let options = RunOptions {
        particles: 4000,
        occlusion: Occlusion::Rows { from: 1, to: None },
        ..RunOptions::default()
    };
    let log = log(3, |_| Some(Pose::default()), |_| None);
    let run = run(&setup, &log, &options, &mut |_| ()).expect("a run");
    let spread = run.estimate.rows[2].spread.expect("a spread").pose;
    let camera = setup.camera.expect("a camera");
    for (spread, told) in [
        (spread.x, camera.position_std),
        (spread.y, camera.position_std),
        (spread.theta, camera.orientation_std),
    ] {
        let ratio = spread / told;
        assert!((ratio - 1.0).abs() < 0.08, "{ratio}");
    }
}

#[test]
fn a_pose_that_is_wrong_now_and_then_moves_nothing() {
    let setup = setup(&[]);
    let mut log = pushed(0.0);
    for row in (20..150).step_by(17) {
        log.object[row] = Some(Pose::new(0.015, -0.02, 1.0));
    }
    let contact = farthest(&estimate(&setup, &log, FilterModel::Robust), 0.5, 5.0);
    let paper = farthest(&estimate(&setup, &log, FilterModel::Paper), 0.5, 5.0);
    assert!(contact < 6e-4, "{contact}");
    assert!(paper > 5e-3, "{paper}: the log has no outliers");
}

#[test]
fn a_camera_that_lags_more_than_told_does_not_drag_the_estimate() {
    let setup = setup(&[]);
    let late = pushed(0.08);
    // while the disc moves, the camera is 1.6 mm behind
    // at more than twice what the prior expects: some forty of 400 particles lag as much
    let contact = farthest(
        &estimate_of(1000, &setup, &late, FilterModel::Robust),
        2.0,
        3.0,
    );
    let paper = farthest(&estimate(&setup, &late, FilterModel::Paper), 2.0, 3.0);
    assert!(contact < 6e-4, "{contact}");
    assert!(paper > contact, "{paper}, {contact}");
}

#[test]
fn a_camera_that_moves_for_good_is_followed() {
    let setup = setup(&[]);
    let mut log = pushed(0.0);
    let elsewhere = Pose::new(0.1, 0.05, 0.5);
    log.object[120..].fill(Some(elsewhere));
    // equal poses are one frame again and again: let them differ
    for (row, pose) in log.object.iter_mut().enumerate().skip(120) {
        *pose = pose.map(|pose| Pose::new(pose.x + 1e-6 * row as f64, pose.y, pose.theta));
    }
    let estimate = estimate(&setup, &log, FilterModel::Robust);
    let row = 120 + (0.3 * RATE) as usize;
    let pose = estimate.rows[row].pose.expect("a pose");
    assert!(
        (pose.x - 0.1).abs() < 2e-3 && (pose.y - 0.05).abs() < 2e-3,
        "{pose:?}"
    );
}

/// Bodies that are pressed give a little: a disc that jams rests deeper in the fixel than the rig
/// allows. No particle may have expected that on a rig that seemed well measured while the disc
/// moved.
#[test]
fn a_jam_that_gives_way_ends_where_the_camera_shows_it() {
    let setup = setup(&[[0.105, 0.0]]);
    let (rate, give) = (120.0, 1.5e-4);
    let pusher = |time: f64| (-0.045 + SPEED * time).min(0.035 + 2.0 * give);
    let rests = 0.07 + give;
    let time: Vec<f64> = (0..1440).map(|row| f64::from(row) / rate).collect();
    let object = |(row, time): (usize, &f64)| {
        // some noise that returns, as far from zero in the mean as a hundredth of the camera's
        let noise = 3e-4 * libm::sin(11.0 * row as f64);
        let other = 3e-4 * libm::sin(17.0 * row as f64);
        let x = (pusher(*time) + 0.035).clamp(0.0, rests);
        Some(Pose::new(x + noise, other, 10.0 * noise))
    };
    let log = Log {
        object: time.iter().enumerate().map(object).collect(),
        pusher: time
            .iter()
            .map(|t| Some(Pose::new(pusher(*t), 0.0, 0.0)))
            .collect(),
        time,
        ..Log::default()
    };
    let estimate = estimate(&setup, &log, FilterModel::Robust);
    let late = &estimate.rows[1200..];
    let error: f64 = late
        .iter()
        .map(|row| row.pose.expect("a pose").x - rests)
        .sum();
    let error = error / late.len() as f64;
    assert!(error.abs() < 4e-5, "{error} m");
}

/// Runs with the camera off from row 5 on.
fn blind(setup: &Setup, log: &Log) -> Run {
    let options = RunOptions {
        particles: 400,
        occlusion: Occlusion::Rows { from: 5, to: None },
        ..RunOptions::default()
    };
    run(setup, log, &options, &mut |_| ()).expect("a run")
}

/// Distance (m) of the end of a run from the log's last pose.
fn final_error(run: &Run, log: &Log) -> f64 {
    let believed = run.estimate.rows[109].pose.expect("a pose");
    let last = log.object[109].expect("a pose");
    (believed.x - last.x).hypot(believed.y - last.y)
}

#[test]
fn a_pusher_that_goes_on_says_that_nothing_jams() {
    let (slippery, log) = slippery();
    let mut sticky = sticky(&slippery, 0.45);
    let error = |pusher_lag| {
        sticky.uncertainty.pusher_lag = pusher_lag;
        final_error(&blind(&sticky, &log), &log)
    };
    let [deaf, hears] = [1e3, 3e-4].map(error);
    assert!(hears < 0.5 * deaf, "{hears} m, without the pusher {deaf} m");
}

#[test]
fn the_evidence_is_for_the_friction_that_was() {
    let (slippery, log) = slippery();
    let sticky = sticky(&slippery, 0.45);
    let [right, wrong] = [&slippery, &sticky].map(|setup| blind(setup, &log).log_evidence);
    assert!(right > wrong, "{right:?}, {wrong:?}");
    let other = RunOptions {
        method: Method::Kalman,
        ..RunOptions::default()
    };
    let kalman = run(&slippery, &log, &other, &mut |_| ()).expect("a run");
    assert_eq!(kalman.log_evidence, None);
}

/// Mean error (m) along the push, and mean spread, of an object that is pushed steadily for 1.8 s
/// under a camera that lags by `latency` (s).
fn pushed_steadily(setup: &Setup, latency: f64) -> [f64; 2] {
    const SEEDS: u64 = 12;
    let log = pushed(latency);
    let (mut error, mut spread) = (0.0, 0.0);
    for seed in 0..SEEDS {
        let options = RunOptions {
            particles: 1000,
            seed,
            ..RunOptions::default()
        };
        let run = run(setup, &log, &options, &mut |_| ()).expect("a run");
        let (time, at) = (run.estimate.time[85], &run.estimate.rows[85]);
        error += at.pose.expect("a pose").x - truth(time).x;
        spread += at.spread.expect("a spread").pose.x;
    }
    [error, spread].map(|sum| sum / SEEDS as f64)
}

/// The camera determines o − v L under a steady push: the pusher's offset minus the way in the
/// latency. The priors leave a mixture on that line: that of all scales η of the rig, each by how
/// likely it makes what the camera shows. The sums are over η and over the latency.
#[test]
fn a_steady_push_leaves_latency_and_offset_as_uncertain_as_their_priors() {
    let setup = setup(&[]);
    let unsure = setup.uncertainty;
    let expected = |true_latency: f64| {
        let (mut weight, mut mean, mut square) = (0.0, 0.0, 0.0);
        for k in -300..300 {
            let eta = unsure.roughness * 0.01 * (f64::from(k) + 0.5);
            let well = unsure.well_measured;
            let better = well + (1.0 - well) / (1.0 + libm::exp(-10.0 * eta));
            let std = better.sqrt().sqrt() * libm::exp(eta) * unsure.pusher_offset;
            for step in 0..4000 {
                let latency = 1e-4 * (f64::from(step) + 0.5);
                let offset = SPEED * (latency - true_latency);
                let normal = libm::pow(eta / unsure.roughness, 2.0) + libm::pow(offset / std, 2.0);
                let late = libm::log(latency / unsure.latency) / 1.2;
                let density = libm::exp(-0.5 * (normal + late * late)) / (std * latency);
                weight += density;
                mean += density * offset;
                square += density * offset * offset;
            }
        }
        let mean = mean / weight;
        [mean, (square / weight - mean * mean).sqrt()]
    };
    for latency in [0.0, 0.05] {
        let [error, spread] = pushed_steadily(&setup, latency);
        let [mean, std] = expected(latency);
        assert!(
            (spread / std - 1.0).abs() < 0.4,
            "{latency} s: {spread}, {std}"
        );
        assert!(
            (error - mean).abs() < 0.6 * std,
            "{latency} s: {error}, {mean}"
        );
    }
}
