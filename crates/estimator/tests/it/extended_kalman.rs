//! The extended Kalman filter against closed forms, and against particles that go through Γ by
//! themselves.

use crate::common::{RATE, log, setup};
use stickslip::dynamics::{Dynamics, Friction, Particle, Pose, StepInput, StepWork, Wrench};
use stickslip::{
    Estimate, Log, Method, Occlusion, PoseCovariance, PusherTrack, RunOptions, Schedule, Setup,
    Tracking, run,
};
use stickslip_filter::Streams;

fn estimate(setup: &Setup, log: &Log, method: Method, occlusion: Occlusion) -> Estimate {
    let options = RunOptions {
        method,
        occlusion,
        ..RunOptions::default()
    };
    let run = run(setup, log, &options, &mut |_| ());
    run.expect("a run").estimate
}

/// x and y of an object at rest: the inverse of the sum of the inverse covariances, by hand.
#[test]
fn poses_of_an_object_at_rest_add_up_by_their_covariances() {
    const ROWS: usize = 12;
    let noise = |row: usize| PoseCovariance {
        x: 4e-8 + 1e-8 * row as f64,
        y: 9e-8 - 5e-9 * row as f64,
        theta: 1e-5,
        x_y: 1e-8 * (row as f64 - 6.0) / 6.0,
        ..PoseCovariance::default()
    };
    let streams = Streams::new(3);
    let pose = |row: usize| {
        let [a, b, c] = streams.normals::<3>(row as u64, 0, 0);
        Pose::new(3e-4 * a, 3e-4 * b, 3e-3 * c)
    };
    let log = Log {
        object: (0..ROWS).map(|row| Some(pose(row))).collect(),
        object_covariance: (0..ROWS).map(|row| Some(noise(row))).collect(),
        ..log(ROWS, |_| None, |_| None)
    };
    let found = estimate(&setup(&[]), &log, Method::ExtendedKalman, Occlusion::None);

    // sums of C⁻¹ and C⁻¹ z of x and y; θ is by itself
    let (mut a, mut b, mut c, mut u, mut v) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for row in 0..ROWS {
        let (n, z) = (noise(row), pose(row));
        let det = n.x * n.y - n.x_y * n.x_y;
        let (p, q, r) = (n.y / det, -n.x_y / det, n.x / det);
        (a, b, c) = (a + p, b + q, c + r);
        (u, v) = (u + p * z.x + q * z.y, v + q * z.x + r * z.y);
        let det = a * c - b * b;
        let count = (row + 1) as f64;
        let theta = (0..=row).map(|k| pose(k).theta / count);
        let expected = [
            (c * u - b * v) / det,
            (a * v - b * u) / det,
            theta.fold(0.0, |sum, x| sum + x),
            (c / det).sqrt(),
            (a / det).sqrt(),
            (1e-5 / count).sqrt(),
            -b / det * 1e4,
        ];
        let (pose, spread) = (found.rows[row].pose, found.rows[row].spread);
        let (pose, spread) = (pose.expect("a pose"), spread.expect("a spread"));
        let found = [
            pose.x,
            pose.y,
            pose.theta,
            spread.pose.x,
            spread.pose.y,
            spread.pose.theta,
            spread.cross.expect("covariances").x_y * 1e4,
        ];
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-9 * expected.abs().max(1e-4),
                "row {row}: {found} {expected}"
            );
        }
    }
}

/// An object that nothing has touched reveals nothing of friction: it keeps its log-normal prior,
/// on every row.
#[test]
fn friction_that_took_no_part_keeps_its_prior() {
    let setup = setup(&[[0.2, 0.0]]);
    let streams = Streams::new(4);
    let object = |t: f64| {
        let [a, b] = streams.normals::<2>((t * RATE).round() as u64, 0, 0);
        Some(Pose::new(3e-4 * a, 3e-4 * b, 0.0))
    };
    let log = log(30, object, |_| None);
    let found = estimate(&setup, &log, Method::ExtendedKalman, Occlusion::None);
    let nominal = setup.scene.nominal;
    let prior = setup.uncertainty.friction;
    for row in &found.rows {
        let mean = row.friction.expect("friction");
        let std = row.spread.expect("a spread").friction.expect("its spread");
        let all = mean.fields().into_iter().zip(std.fields());
        let priors = nominal.fields().into_iter().zip(prior.fields());
        for ((mean, std), (nominal, s)) in all.zip(priors) {
            // moments of a log-normal distribution
            let expected = nominal * libm::exp(0.5 * s * s);
            assert!((mean / expected - 1.0).abs() < 1e-12, "{mean} {expected}");
            let spread = expected * (libm::exp(s * s) - 1.0).sqrt();
            assert!((std / spread - 1.0).abs() < 1e-12, "{std} {spread}");
        }
    }
}

/// A disc at rest that jumps by `jump` (m) for `rows` rows from row 10 on.
fn jumping(jump: f64, rows: std::ops::Range<usize>) -> Log {
    let streams = Streams::new(6);
    let object = |t: f64| {
        let row = (t * RATE).round() as usize;
        let [a, b, c] = streams.normals::<3>(row as u64, 0, 0);
        let off = if rows.contains(&row) { jump } else { 0.0 };
        Some(Pose::new(1e-4 * a + off, 1e-4 * b, 2e-3 * c))
    };
    log(20, object, |_| None)
}

#[test]
fn wrong_poses_are_left_out_and_four_in_a_row_believed() {
    let options = RunOptions {
        method: Method::ExtendedKalman,
        ..RunOptions::default()
    };
    let of = |log: &Log| run(&setup(&[]), log, &options, &mut |_| ()).expect("a run");
    // as if the camera had not seen them
    let wrong = of(&jumping(0.02, 10..13));
    let mut unseen = jumping(0.0, 0..0);
    unseen.object[10..13].fill(None);
    assert_eq!(wrong.estimate.rows, of(&unseen).estimate.rows);
    assert_eq!(wrong.collapses, 0);

    let log = jumping(0.02, 10..20);
    let moved = of(&log);
    assert_eq!(moved.collapses, 1);
    let rows = &moved.estimate.rows;
    assert!(!rows[12].visual && rows[13].visual);
    assert_eq!(rows[13].pose, log.object[13]);
    let std = rows[13].spread.expect("a spread").pose;
    assert!((std.x / 3e-4 - 1.0).abs() < 1e-12, "{std:?}");
    let moved = rows[19].pose.expect("a pose").x;
    assert!((moved - 0.02).abs() < 3e-4, "{moved}");
}

/// The disc goes head-on into a fixel, then is pressed against it for seconds, with a rigid pusher
/// or not. The camera is off from before the touch. Every number is finite, and rigid jams are
/// counted.
#[test]
fn a_jam_leaves_finite_numbers_and_counts_what_has_no_solution() {
    let unsolved = |stall_force| {
        let mut setup = setup(&[[0.045, 0.0]]);
        setup.scene.pusher.stall_force = stall_force;
        let object = |t: f64| (t < 0.5).then(|| Pose::new(0.015 * t, 1e-5 * t, 1e-4 * t));
        let pusher = |t: f64| Some(Pose::new(-0.035 + 0.015 * t.min(1.5), 0.0, 0.0));
        let found = estimate(
            &setup,
            &log(90, object, pusher),
            Method::ExtendedKalman,
            Occlusion::None,
        );
        let mut unsolved = 0;
        for row in &found.rows {
            let (pose, spread) = (row.pose.expect("a pose"), row.spread.expect("a spread"));
            assert!(pose.is_finite() && spread.pose.is_finite(), "{row:?}");
            let friction = spread.friction.expect("friction");
            assert!(friction.fields().iter().all(|std| std.is_finite()));
            unsolved += row.unsolved.unwrap_or(0);
        }
        unsolved
    };
    assert_eq!(unsolved(Some(20.0)), 0);
    assert!(unsolved(None) > 0);
}

#[test]
fn what_other_methods_refuse_is_refused_in_the_same_words() {
    let refusal = |change: fn(&mut Setup, &mut Log), method| {
        let (mut setup, mut log) = (setup(&[]), jumping(0.0, 0..0));
        change(&mut setup, &mut log);
        let options = RunOptions {
            method,
            ..RunOptions::default()
        };
        let refused = run(&setup, &log, &options, &mut |_| ()).expect_err("a refusal");
        refused.to_string()
    };
    let changes: [fn(&mut Setup, &mut Log); 4] = [
        |setup, _| setup.camera = None,
        |setup, _| setup.uncertainty.force_std = f64::NAN,
        |_, log| log.object.fill(None),
        |_, log| log.time[3] = f64::NAN,
    ];
    for change in changes {
        let found = refusal(change, Method::ExtendedKalman);
        assert_eq!(found, refusal(change, Method::Kalman));
    }
}

/// Rows of the push, and the last of them that the camera sees.
const ROWS: usize = 36;
const SEEN: usize = 24;

/// A disc that is pushed a little off its middle, with noise so small that Γ is nearly linear in
/// it. A camera that errs sees it, then the camera is off.
fn pushed() -> (Setup, Log) {
    let mut setup = setup(&[]);
    let camera = setup.camera.as_mut().expect("a camera");
    (camera.position_std, camera.orientation_std) = (1e-4, 2e-3);
    (camera.pusher_position_std, camera.pusher_orientation_std) = (0.0, 0.0);
    setup.uncertainty.friction = Friction {
        mu_s: 0.05,
        mu_p: 0.05,
        mu_f: 0.05,
        d_tri: 0.05,
    };
    setup.uncertainty.force_std = 0.05;
    let pusher = |t: f64| Some(Pose::new(-0.035 + 0.02 * t, 0.002, 0.0));
    // begins a hundredth of a millimetre before the touch
    let start = Pose::new(-4e-5, 0.0, 0.0);
    let exact = PoseCovariance {
        x: 1e-12,
        y: 1e-12,
        theta: 1e-8,
        ..PoseCovariance::default()
    };
    let blind = log(ROWS, |t| (t == 0.0).then_some(start), pusher);
    let truth = estimate(&setup, &blind, Method::Nominal, Occlusion::None);
    let streams = Streams::new(5);
    let object = |row: usize| {
        let [x, y, theta] = streams.normals::<3>(row as u64, 0, 0);
        let true_pose = truth.rows[row].pose.expect("a pose");
        let seen = Pose::new(
            true_pose.x + 1e-4 * x,
            true_pose.y + 1e-4 * y,
            true_pose.theta + 2e-3 * theta,
        );
        (row <= SEEN).then_some(if row == 0 { start } else { seen })
    };
    let log = Log {
        object: (0..ROWS).map(object).collect(),
        object_covariance: (0..ROWS).map(|row| (row == 0).then_some(exact)).collect(),
        ..blind
    };
    (setup, log)
}

/// A cloud's mean and standard deviations of x, y, θ.
type Moments = [f64; 6];

/// Number of particles that are computed together in a step.
const LANES: usize = 8;

/// A particle with its ln β/β_nominal.
#[derive(Clone, Copy)]
struct Weighed {
    particle: Particle,
    ratios: [f64; 4],
}

/// A bootstrap particle filter, written out. Returns moments after the last row seen and after the
/// last row.
fn bootstrap(setup: &Setup, log: &Log, seed: u64, count: usize) -> [Moments; 2] {
    let camera = setup.camera.expect("a camera");
    let track = PusherTrack::new(log, Some(&camera), Tracking::Smoothed).expect("a track");
    let schedule = Schedule::new(&log.time, &track, None);
    let dynamics = Dynamics::new(setup.scene.clone());
    let streams = Streams::new(seed);
    let (start, exact) = (log.object[0].expect("a pose"), log.object_covariance[0]);
    let exact = exact.expect("a covariance");
    let priors = setup.uncertainty.friction.fields().map(|std| *std);
    let mut cloud: Vec<Weighed> = (0..count)
        .map(|i| {
            let n = streams.normals::<7>(0, i as u32, 0);
            let pose = Pose::new(
                start.x + exact.x.sqrt() * n[0],
                start.y + exact.y.sqrt() * n[1],
                start.theta + exact.theta.sqrt() * n[2],
            );
            Weighed {
                particle: Particle {
                    pose,
                    ..Particle::default()
                },
                ratios: std::array::from_fn(|k| priors[k] * n[3 + k]),
            }
        })
        .collect();

    let mut moments = [[0.0; 6]; 2];
    for row in 1..ROWS {
        let [input] = schedule.step(row - 1) else {
            panic!("one step a row")
        };
        let draw = |i: usize| streams.normals::<7>(row as u64, i as u32, 0);
        propagate(setup, &dynamics, input, &draw, &mut cloud);
        if let Some(z) = log.object[row] {
            let weight = |of: &Weighed| {
                let q = of.particle.pose;
                let (x, y) = (q.x - z.x, q.y - z.y);
                let theta = (q.theta - z.theta) / camera.orientation_std;
                let r = (x * x + y * y) / (camera.position_std * camera.position_std);
                libm::exp(-0.5 * (r + theta * theta))
            };
            let weights: Vec<f64> = cloud.iter().map(weight).collect();
            cloud = resampled(&cloud, &weights, streams.uniform(row as u64, 0, 0));
        }
        if row == SEEN {
            moments[0] = moments_of(&cloud);
        }
    }
    moments[1] = moments_of(&cloud);
    moments
}

/// Γ' with the noise of the robust model: (19), (21) and (34).
fn propagate(
    setup: &Setup,
    dynamics: &Dynamics,
    input: &StepInput,
    draw: &dyn Fn(usize) -> [f64; 7],
    cloud: &mut [Weighed],
) {
    let object = &setup.scene.object;
    let share = setup.uncertainty.force_std * object.mass * setup.scene.gravity * input.h;
    let rho = (object.inertia / object.mass).sqrt();
    let nominal = setup.scene.nominal;
    let priors = setup.uncertainty.friction.fields().map(|std| *std);
    let mut work = StepWork::<LANES>::default();
    for (chunk, weighed) in cloud.chunks_exact_mut(LANES).enumerate() {
        let mut frictions = [nominal; LANES];
        let mut particles = [Particle::default(); LANES];
        for lane in 0..LANES {
            let n = draw(chunk * LANES + lane);
            let values = frictions[lane].fields_mut().into_iter();
            for (value, ratio) in values.zip(weighed[lane].ratios) {
                *value *= libm::exp(ratio);
            }
            let std = share * frictions[lane].mu_s;
            particles[lane] = Particle {
                applied: Wrench {
                    fx: std * n[0],
                    fy: std * n[1],
                    torque: std * rho * n[2],
                },
                ..weighed[lane].particle
            };
        }
        let _ = dynamics.step(input, &frictions, &mut particles, &mut work);
        for lane in 0..LANES {
            weighed[lane].particle = particles[lane];
            // all but mu_f take part in a push
            let n = draw(chunk * LANES + lane);
            for k in [0, 1, 3] {
                let a = 0.1_f64;
                let ratio = &mut weighed[lane].ratios[k];
                *ratio = (1.0 - a * a).sqrt() * *ratio + a * priors[k] * n[3 + k];
            }
        }
    }
}

/// Systematic resampling.
fn resampled(cloud: &[Weighed], weights: &[f64], uniform: f64) -> Vec<Weighed> {
    let total = weights.iter().fold(0.0, |sum, w| sum + w);
    let step = total / cloud.len() as f64;
    let (mut from, mut upto) = (0, weights[0]);
    let points = (0..cloud.len()).map(|i| (i as f64 + uniform) * step);
    let pick = |point: f64| {
        while upto < point && from + 1 < cloud.len() {
            from += 1;
            upto += weights[from];
        }
        cloud[from]
    };
    points.map(pick).collect()
}

fn moments_of(cloud: &[Weighed]) -> Moments {
    let mut moments = [0.0; 6];
    for k in 0..3 {
        let value = |of: &Weighed| *of.particle.pose.fields()[k];
        let count = cloud.len() as f64;
        let mean = cloud.iter().map(value).fold(0.0, |sum, x| sum + x) / count;
        let square = |sum: f64, of: &Weighed| sum + (value(of) - mean).powi(2);
        let squares = cloud.iter().fold(0.0, square);
        (moments[k], moments[3 + k]) = (mean, (squares / count).sqrt());
    }
    moments
}

/// The filter equals particles, which use no derivative, if Γ is smooth and the noise small. It
/// lies within four standard errors of the mean over independent clouds.
#[test]
fn a_smooth_push_has_the_moments_of_a_cloud_through_the_same_steps() {
    const CLOUDS: u64 = 12;
    let (setup, log) = pushed();
    let found = estimate(&setup, &log, Method::ExtendedKalman, Occlusion::None);
    let clouds: Vec<[Moments; 2]> = (0..CLOUDS)
        .map(|seed| bootstrap(&setup, &log, 100 + seed, 1600))
        .collect();
    for (when, row) in [SEEN, ROWS - 1].into_iter().enumerate() {
        let pose = found.rows[row].pose.expect("a pose");
        let std = found.rows[row].spread.expect("a spread").pose;
        let found = [pose.x, pose.y, pose.theta, std.x, std.y, std.theta];
        for k in 0..6 {
            let values = || clouds.iter().map(|moments| moments[when][k]);
            let count = CLOUDS as f64;
            let mean = values().fold(0.0, |sum, x| sum + x) / count;
            let squares = values().fold(0.0, |sum, x| sum + (x - mean).powi(2));
            let error = (squares / (count - 1.0) / count).sqrt();
            assert!(
                (found[k] - mean).abs() < 4.0 * error,
                "row {row}, number {k}: {} {mean} error {error}",
                found[k]
            );
            // a spread that is off by a tenth would be seen
            let spread = found[3 + k % 3];
            assert!(
                error < 0.02 * spread,
                "row {row}, number {k}: {error} {spread}"
            );
        }
    }
}
