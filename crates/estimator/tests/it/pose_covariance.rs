//! Poses with a covariance of their own, against the posterior of normal distributions in closed
//! form.

use std::sync::Mutex;

use crate::common::{disc, log, setup};
use stickslip::dynamics::Pose;
use stickslip::{
    FilterModel, Log, Method, Observer, ParticleView, PoseCovariance, RunOptions, Setup,
    SolvedStep, run, run_observed,
};

/// Two poses of an object at rest, and their covariances.
const POSES: [Pose; 2] = [
    Pose {
        x: 1e-3,
        y: 2e-3,
        theta: 0.10,
    },
    Pose {
        x: 1.4e-3,
        y: 1.9e-3,
        theta: 0.103,
    },
];
const NOISE: [PoseCovariance; 2] = [
    PoseCovariance {
        x: 4e-8,
        y: 9e-8,
        theta: 1e-5,
        x_y: 3e-8,
        x_theta: -2e-7,
        y_theta: 1e-7,
    },
    PoseCovariance {
        x: 6e-8,
        y: 2e-8,
        theta: 2e-5,
        x_y: -1e-8,
        x_theta: 3e-7,
        y_theta: 2e-7,
    },
];

type Matrix = [[f64; 3]; 3];

fn matrix(c: &PoseCovariance) -> Matrix {
    [
        [c.x, c.x_y, c.x_theta],
        [c.x_y, c.y, c.y_theta],
        [c.x_theta, c.y_theta, c.theta],
    ]
}

/// The inverse by cofactors.
fn inverse(m: &Matrix) -> Matrix {
    let cofactor = |i: usize, j: usize| {
        let ([a, b], [p, q]) = ([(i + 1) % 3, (i + 2) % 3], [(j + 1) % 3, (j + 2) % 3]);
        m[a][p] * m[b][q] - m[a][q] * m[b][p]
    };
    let determinant: f64 = (0..3).map(|j| m[0][j] * cofactor(0, j)).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i) / determinant))
}

fn times(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| (0..3).map(|j| m[i][j] * v[j]).sum())
}

/// Mean and covariance of x, y, θ given both poses.
fn posterior() -> ([f64; 3], Matrix) {
    let [a, b] = NOISE.map(|noise| inverse(&matrix(&noise)));
    let sum: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + b[i][j]));
    let covariance = inverse(&sum);
    let [p, q] = POSES.map(|pose| [pose.x, pose.y, pose.theta]);
    let (p, q) = (times(&a, p), times(&b, q));
    let right = std::array::from_fn(|i| p[i] + q[i]);
    (times(&covariance, right), covariance)
}

/// An object that nothing moves, and a camera whose poses are not widened.
fn at_rest() -> Setup {
    let mut setup = setup(&[]);
    setup.filter.likelihood_scale = 1.0;
    setup.filter.force_std = 0.0;
    setup.uncertainty.force_std = 0.0;
    setup.uncertainty.camera_noise = 0.0;
    setup.scene.object.shape = disc(0.03);
    setup
}

fn two_poses() -> Log {
    Log {
        object: POSES.map(Some).to_vec(),
        object_covariance: NOISE.map(Some).to_vec(),
        ..log(2, |_| None, |_| None)
    }
}

/// Mean and covariance of the particles after the latest row.
#[derive(Debug, Default)]
struct Moments(Mutex<([f64; 3], Matrix)>);

impl Observer for Moments {
    fn on_step(&self, _: &SolvedStep<'_>) {}

    fn on_row(&self, _: usize, cloud: &ParticleView<'_>) {
        let at = |k: usize| {
            let pose = cloud.pose(k);
            [pose.x, pose.y, pose.theta]
        };
        let sum = |of: &dyn Fn([f64; 3]) -> f64| -> f64 {
            let weighted = cloud.weights().iter().enumerate();
            weighted.map(|(k, weight)| weight * of(at(k))).sum()
        };
        let mean: [f64; 3] = std::array::from_fn(|i| sum(&|pose| pose[i]));
        let covariance = std::array::from_fn(|i| {
            std::array::from_fn(|j| sum(&|pose| (pose[i] - mean[i]) * (pose[j] - mean[j])))
        });
        *self.0.lock().expect("one thread") = (mean, covariance);
    }
}

#[test]
fn two_noisy_poses_have_the_posterior_of_normal_distributions() {
    const PARTICLES: usize = 40_000;
    let (expected, covariance) = posterior();
    // the second pose is nearer the first in y than in x, and both noises lean, so that a filter
    // which took the axes for independent would be off by many of the standard errors below
    for model in [FilterModel::Paper, FilterModel::Robust] {
        let options = RunOptions {
            model,
            particles: PARTICLES,
            ..RunOptions::default()
        };
        let moments = Moments::default();
        run_observed(&at_rest(), &two_poses(), &options, &moments, &mut |_| {}).expect("a run");
        let (mean, found) = *moments.0.lock().expect("one thread");
        for i in 0..3 {
            let std = covariance[i][i].sqrt();
            // weights leave some thousand particles
            let error = std / (PARTICLES as f64 / 10.0).sqrt();
            assert!(
                (mean[i] - expected[i]).abs() < 4.0 * error,
                "{model:?} {i}: {mean:?} {expected:?}"
            );
            for j in 0..3 {
                let scale = std * covariance[j][j].sqrt();
                assert!(
                    (found[i][j] - covariance[i][j]).abs() < 0.08 * scale,
                    "{model:?} {i} {j}: {found:?} {covariance:?}"
                );
            }
        }
    }
}

/// The Kalman filter's axes are means weighted by the inverse variances, without process noise and
/// with a velocity that is known to be 0.
#[test]
fn the_kalman_filter_weighs_poses_by_their_variances() {
    let options = RunOptions {
        method: Method::Kalman,
        ..RunOptions::default()
    };
    let run = run(&at_rest(), &two_poses(), &options, &mut |_| {}).expect("a run");
    let last = &run.estimate.rows[1];
    let (pose, spread) = (last.pose.expect("a pose"), last.spread.expect("a spread"));
    let weighted = |a: f64, var_a: f64, b: f64, var_b: f64| {
        (
            (a / var_a + b / var_b) / (1.0 / var_a + 1.0 / var_b),
            (1.0 / (1.0 / var_a + 1.0 / var_b)).sqrt(),
        )
    };
    let ([p, q], [a, b]) = (POSES, NOISE);
    for (found, std, (mean, expected)) in [
        (pose.x, spread.pose.x, weighted(p.x, a.x, q.x, b.x)),
        (pose.y, spread.pose.y, weighted(p.y, a.y, q.y, b.y)),
        (
            pose.theta,
            spread.pose.theta,
            weighted(p.theta, a.theta, q.theta, b.theta),
        ),
    ] {
        // the process noise that stands in for too few poses
        assert!((found - mean).abs() < 0.02 * expected, "{found} {mean}");
        assert!((std / expected - 1.0).abs() < 0.02, "{std} {expected}");
    }
}

#[test]
fn a_covariance_without_a_pose_says_nothing() {
    let still = Pose::default();
    let seen = |t: f64| (t < 0.1).then_some(still);
    let plain = log(6, seen, |_| None);
    let noisy = Log {
        object_covariance: plain
            .object
            .iter()
            .map(|pose| pose.is_none().then_some(NOISE[0]))
            .collect(),
        ..plain.clone()
    };
    let options = RunOptions {
        particles: 64,
        ..RunOptions::default()
    };
    let estimate = |log: &Log| {
        run(&setup(&[]), log, &options, &mut |_| {})
            .expect("a run")
            .estimate
    };
    assert_eq!(estimate(&noisy), estimate(&plain));
}
