//! Particles that an observer sees: all of them, with the weights of the estimate. The observer
//! changes no bit of a run.

use std::sync::Mutex;

use stickslip::dynamics::{Feet, Friction, Object, Part, Pose, Pusher, Scene, Shape};
use stickslip::{
    Camera, FilterModel, FilterSettings, Log, Observer, Occlusion, ParticleView, Run, RunOptions,
    Setup, SolvedStep, Tactile, Uncertainty, run, run_observed,
};

const ROWS: usize = 40;
const FIRST: usize = 2;

/// Weighted sums over the particles after one row: sum of weights, means and standard deviations of
/// x, y, θ and μ_s, covariances of x and y, x and θ, y and θ.
#[derive(Debug)]
struct Moments {
    row: usize,
    particles: usize,
    weight: f64,
    means: [f64; 4],
    stds: [f64; 4],
    cross: [f64; 3],
}

#[derive(Debug, Default)]
struct Sums(Mutex<Vec<Moments>>);

impl Observer for Sums {
    fn on_step(&self, _: &SolvedStep<'_>) {}

    fn on_row(&self, row: usize, cloud: &ParticleView<'_>) {
        let values = |particle: usize| {
            let (pose, friction) = (cloud.pose(particle), cloud.friction(particle));
            [pose.x, pose.y, pose.theta, friction.mu_s]
        };
        let sum = |f: &dyn Fn([f64; 4]) -> f64| -> f64 {
            cloud
                .weights()
                .iter()
                .enumerate()
                .map(|(i, w)| w * f(values(i)))
                .sum()
        };
        let means = std::array::from_fn(|k| sum(&|x| x[k]));
        let stds = std::array::from_fn(|k| sum(&|x| (x[k] - means[k]).powi(2)).sqrt());
        let pairs = [[0, 1], [0, 2], [1, 2]];
        let cross = pairs.map(|[i, j]| sum(&|x| (x[i] - means[i]) * (x[j] - means[j])));
        let moments = Moments {
            row,
            particles: cloud.len(),
            weight: sum(&|_| 1.0),
            means,
            stds,
            cross,
        };
        self.0.lock().expect("one thread").push(moments);
    }
}

/// A disc that a disc pushes.
fn setup() -> Setup {
    let disc = |radius| {
        Shape::new(vec![Part::Disc {
            radius,
            centre: [0.0, 0.0],
        }])
        .expect("a disc")
    };
    let scene = Scene {
        gravity: 9.81,
        object: Object {
            mass: 0.5,
            inertia: 2e-4,
            shape: disc(0.03),
        },
        feet: Feet::Tripod { angle: 0.0 },
        pusher: Pusher {
            fingers: vec![disc(0.005)],
            stall_force: None,
        },
        fixels: Vec::new(),
        nominal: Friction {
            mu_s: 0.3,
            mu_p: 0.3,
            mu_f: 0.3,
            d_tri: 0.02,
        },
    };
    let camera = Camera {
        position_std: 3e-4,
        orientation_std: 5e-3,
        latency: 0.0,
        pusher_position_std: 1e-4,
        pusher_orientation_std: 2e-3,
    };
    Setup {
        scene,
        stall_force_assumed: false,
        camera: Some(camera),
        tactile: Tactile::default(),
        filter: FilterSettings::default(),
        wrench: None,
        uncertainty: Uncertainty::default().with_known_feet(),
        start: None,
    }
}

/// The camera misses the first rows.
fn log() -> Log {
    let object =
        |row| (row >= FIRST).then(|| Pose::new(0.001 * (row as f64 - 20.0).max(0.0), 0.0, 0.0));
    Log {
        time: (0..ROWS).map(|row| row as f64 / 30.0).collect(),
        object: (0..ROWS).map(object).collect(),
        pusher: (0..ROWS)
            .map(|row| Some(Pose::new(-0.055 + 0.001 * row as f64, 0.001, 0.0)))
            .collect(),
        ..Log::default()
    }
}

fn watched(options: &RunOptions) -> (Run, Vec<Moments>) {
    let sums = Sums::default();
    let run = run_observed(&setup(), &log(), options, &sums, &mut |_| ()).expect("a run");
    (run, sums.0.into_inner().expect("one thread"))
}

#[test]
fn an_observer_sees_the_particles_that_the_estimate_is_made_of() {
    let options = RunOptions {
        model: FilterModel::Paper,
        particles: 100,
        occlusion: Occlusion::Rows { from: 30, to: None },
        ..RunOptions::default()
    };
    let (run, sums) = watched(&options);
    assert_eq!(
        sums.iter().map(|moments| moments.row).collect::<Vec<_>>(),
        (FIRST..ROWS).collect::<Vec<_>>()
    );
    for Moments {
        row,
        particles,
        weight,
        means,
        stds,
        cross,
    } in sums
    {
        let told = &run.estimate.rows[row];
        let (pose, friction, spread) = (
            told.pose.expect("a pose"),
            told.friction.expect("friction"),
            told.spread.expect("a spread"),
        );
        assert!(particles == 100 && (weight - 1.0).abs() < 1e-12);
        // the mean direction of angles some hundredths apart is their mean but for a third power of
        // them
        for ((mean, told), tolerance) in means
            .iter()
            .zip([pose.x, pose.y, pose.theta, friction.mu_s])
            .zip([1e-12, 1e-12, 1e-5, 1e-12])
        {
            assert!(
                (mean - told).abs() < tolerance,
                "row {row}: {mean} and {told}"
            );
        }
        let told = [
            spread.pose.x,
            spread.pose.y,
            spread.pose.theta,
            spread.friction.expect("friction").mu_s,
        ];
        for (std, told) in stds.iter().zip(told) {
            assert!(
                (std - told).abs() < 1e-5 * std + 1e-10,
                "row {row}: {std} and {told}"
            );
        }
        let of = spread.cross.expect("covariances");
        for ((k, found), [i, j]) in [of.x_y, of.x_theta, of.y_theta]
            .into_iter()
            .enumerate()
            .zip([[0, 1], [0, 2], [1, 2]])
        {
            let tolerance = 1e-5 * stds[i] * stds[j] + 1e-16;
            assert!(
                (found - cross[k]).abs() < tolerance,
                "row {row}: {found} and {}",
                cross[k]
            );
        }
        assert!(stds[..3].iter().all(|std| *std > 1e-6), "{stds:?}");
    }
}

/// Weights and poses of the particles after every row.
#[derive(Debug, Default)]
struct Clouds(Mutex<Vec<Vec<(f64, Pose)>>>);

impl Observer for Clouds {
    fn on_step(&self, _: &SolvedStep<'_>) {}

    fn on_row(&self, _: usize, cloud: &ParticleView<'_>) {
        let weighted = cloud.weights().iter().enumerate();
        let cloud = weighted.map(|(i, weight)| (*weight, cloud.pose(i)));
        self.0.lock().expect("one thread").push(cloud.collect());
    }
}

#[test]
fn in_contact_mode_no_pose_is_nearer_to_the_particles_in_the_mean() {
    let options = RunOptions {
        particles: 100,
        occlusion: Occlusion::Rows { from: 30, to: None },
        ..RunOptions::default()
    };
    let (setup, clouds) = (setup(), Clouds::default());
    let rho = setup.scene.object.gyration_radius();
    let run = run_observed(&setup, &log(), &options, &clouds, &mut |_| ()).expect("a run");
    let clouds = clouds.0.into_inner().expect("one thread");
    for (row, cloud) in run.estimate.rows[FIRST..].iter().zip(clouds) {
        let (told, spread) = (row.pose.expect("a pose"), row.spread.expect("a spread"));
        let mean = |of: &dyn Fn(&Pose) -> f64| -> f64 {
            cloud.iter().map(|(weight, pose)| weight * of(pose)).sum()
        };
        let distance = |from: Pose| {
            mean(&|pose| {
                let [x, y] = [pose.x - from.x, pose.y - from.y];
                x.hypot(y).hypot(rho * (pose.theta - from.theta))
            })
        };
        // of a convex function no step down is shorter; within 10 um a particle pulls less, (51)
        let least = distance(told) - 2e-6;
        for way in [3e-5, -3e-5, 1e-3] {
            let elsewhere = [
                Pose::new(told.x + way, told.y, told.theta),
                Pose::new(told.x, told.y + way, told.theta),
                Pose::new(told.x, told.y, told.theta + way / rho),
            ];
            for pose in elsewhere {
                assert!(distance(pose) > least, "{pose:?} is nearer than {told:?}");
            }
        }
        // and the spread is about it
        let off = mean(&|pose| (pose.x - told.x) * (pose.theta - told.theta));
        let [x, theta] = [
            mean(&|pose| (pose.x - told.x).powi(2)).sqrt(),
            mean(&|pose| (pose.theta - told.theta).powi(2)).sqrt(),
        ];
        assert!((spread.pose.x - x).abs() < 1e-5 * x + 1e-10);
        assert!((spread.pose.theta - theta).abs() < 1e-5 * theta + 1e-10);
        let found = spread.cross.expect("covariances").x_theta;
        assert!((found - off).abs() < 1e-5 * x * theta + 1e-16);
    }
}

#[test]
fn an_observer_changes_no_bit() {
    let options = RunOptions {
        model: FilterModel::Paper,
        particles: 100,
        ..RunOptions::default()
    };
    let plain = run(&setup(), &log(), &options, &mut |_| ()).expect("a run");
    assert_eq!(watched(&options).0, plain);
}

#[test]
fn methods_without_particles_show_none() {
    let options = RunOptions {
        model: FilterModel::Paper,
        method: stickslip::Method::Kalman,
        ..RunOptions::default()
    };
    assert!(watched(&options).1.is_empty());
}
