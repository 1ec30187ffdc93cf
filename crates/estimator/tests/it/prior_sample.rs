//! Experiments drawn from the filter's own model. What is drawn has the priors' distributions. The
//! filter's beliefs about such experiments cover as much as they say (simulation-based
//! calibration).

use std::sync::Mutex;

use crate::common::{log, setup};
use stickslip::dynamics::Pose;
use stickslip::{
    FilterModel, ForceSensor, Log, Observer, ParticleView, PriorSample, RunOptions, SampledState,
    Setup, SolvedStep, Tactile, run_observed,
};

/// Experiments that are drawn.
const SAMPLES: u64 = 100;

/// A disc that is pushed against a fixel, from 1.25 s on; it gets there at about 2.5 s.
fn scene() -> Setup {
    let mut setup = setup(&[[0.06, 0.0]]);
    setup.filter.likelihood_scale = 1.0;
    setup
}

fn push() -> Log {
    let mut log = log(
        90,
        |_| Some(Pose::default()),
        |t| Some(Pose::new(-0.06 + 0.02 * t, 0.0, 0.0)),
    );
    log.tactile = vec![vec![Some(false); log.time.len()]];
    log
}

fn samples(setup: &Setup, log: &Log) -> Vec<PriorSample> {
    let draw = |seed| PriorSample::draw(setup, log, FilterModel::Robust, seed).expect("a sample");
    (0..SAMPLES).map(draw).collect()
}

/// Weight of the particles below the true x, y, θ and μ_s at one row.
#[derive(Debug)]
struct Ranks {
    row: usize,
    truth: SampledState,
    ranks: Mutex<[f64; 4]>,
}

impl Ranks {
    /// The ranks at one row of a run on a sample.
    fn of(setup: &Setup, sample: &PriorSample, row: usize, seed: u64) -> [f64; 4] {
        let ranks = Self {
            row,
            truth: sample.truth[row],
            ranks: Mutex::default(),
        };
        let options = RunOptions {
            particles: 256,
            seed,
            ..RunOptions::default()
        };
        run_observed(setup, &sample.log, &options, &ranks, &mut |_| ()).expect("a run");
        ranks.ranks.into_inner().expect("one thread")
    }
}

impl Observer for Ranks {
    fn on_step(&self, _: &SolvedStep<'_>) {}

    fn on_row(&self, row: usize, particles: &ParticleView<'_>) {
        if row != self.row {
            return;
        }
        let numbers = |pose: Pose, mu_s: f64| [pose.x, pose.y, pose.theta, mu_s];
        let truth = numbers(self.truth.pose, self.truth.friction.mu_s);
        let mut ranks = [0.0; 4];
        for (i, weight) in particles.weights().iter().enumerate() {
            let values = numbers(particles.pose(i), particles.friction(i).mu_s);
            for (rank, (value, truth)) in ranks.iter_mut().zip(values.iter().zip(truth)) {
                *rank += if *value < truth { *weight } else { 0.0 };
            }
        }
        *self.ranks.lock().expect("one thread") = ranks;
    }
}

#[test]
fn beliefs_of_where_an_object_waits_hold_what_they_say() {
    let (setup, row) = (scene(), 25);
    let mut held = [0_u32; 3];
    for (seed, sample) in (1000..).zip(samples(&setup, &push())) {
        let ranks = Ranks::of(&setup, &sample, row, seed);
        for (held, rank) in held.iter_mut().zip(ranks) {
            *held += u32::from((0.05..=0.95).contains(&rank));
        }
    }
    // 90 % of 100, whose standard deviation is 3
    assert!(held.iter().all(|held| (80..=99).contains(held)), "{held:?}");
}

/// A push over the open table with a force sensor, from 1.25 s on.
#[test]
fn beliefs_of_the_tables_friction_hold_what_they_say() {
    let mut setup = setup(&[]);
    setup.filter.likelihood_scale = 1.0;
    setup.wrench = Some(ForceSensor {
        force_std: 0.03,
        bias_std: 0.1,
        scale_std: 0.1,
    });
    let mut log = push();
    log.tactile.clear();
    log.force = vec![Some([0.0; 2]); log.time.len()];
    let (mut held, mut below) = (0_u32, 0_u32);
    for (seed, sample) in (1000..).zip(samples(&setup, &log)) {
        assert!(sample.log.force[80].is_some_and(|[x, _]| x > 0.3));
        let [.., rank] = Ranks::of(&setup, &sample, 80, seed);
        held += u32::from((0.05..=0.95).contains(&rank));
        below += u32::from(rank < 0.5);
    }
    // 90 and 50 % of 100, whose standard deviations are 3 and 5
    assert!((80..=99).contains(&held), "{held}");
    assert!((35..=65).contains(&below), "{below}");
}

#[test]
fn a_truth_is_drawn_around_the_first_pose_which_stays() {
    let setup = scene();
    let camera = setup.camera.expect("a camera");
    let level = setup.uncertainty.camera_noise;
    let freedom = 1.0 + 0.5 / (level * level);
    // many short ones: nothing is near yet
    let mut log = push();
    log.truncate(20);
    let draw = |seed| PriorSample::draw(&setup, &log, FilterModel::Robust, seed).expect("a sample");
    let samples: Vec<PriorSample> = (0..400).map(draw).collect();
    let first = Pose::default();
    assert!(
        samples
            .iter()
            .all(|sample| sample.log.object[0] == Some(first))
    );
    // squares of distances from the truth: of the first pose, and the sum of the next ones, which
    // rest there, too
    let squares = samples.iter().map(|sample| {
        let at = sample.truth[0].pose;
        let square = |pose: &Pose| (pose.x - at.x).powi(2) + (pose.y - at.y).powi(2);
        let later = sample.log.object[1..20].iter().flatten();
        [square(&first), later.map(square).sum()]
    });
    let squares: Vec<[f64; 2]> = squares.collect();
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| squares.iter().map(of).sum::<f64>() / 400.0;
    // as noisy as all poses of its camera: the ratio is F-distributed with 2 and 38 degrees of
    // freedom, of mean 38/36 and standard deviation 1.13
    let ratio = mean(&|[first, later]| first / 2.0 / (later / 38.0));
    assert!((ratio - 38.0 / 36.0).abs() < 4.0 * 0.057, "{ratio}");
    // a camera that is noisier is so in both: their logarithms, of variances 2.0 and 0.4, have the
    // covariance 0.36, whose standard error is 0.05
    let [a, b] = [0, 1].map(|k| mean(&|squares| libm::log(squares[k])));
    let covariance = mean(&|[first, later]| (libm::log(*first) - a) * (libm::log(*later) - b));
    assert!((covariance - 0.36).abs() < 0.2, "{covariance}");
    // and that noise is unknown: variances of the position in nominal ones have mean ν/(ν − 2),
    // with a standard error of 0.12
    let told = 2.0 * camera.position_std * camera.position_std;
    let mean = mean(&|[first, _]| first / told);
    let expected = freedom / (freedom - 2.0);
    assert!((mean - expected).abs() < 0.4, "{mean}, {expected}");
}

#[test]
fn friction_drawn_has_its_prior_s_distribution_to_the_end() {
    let setup = scene();
    let drawn = samples(&setup, &push()).into_iter().map(|sample| {
        let last = sample.truth.last().expect("rows").friction;
        libm::log(last.mu_p / setup.scene.nominal.mu_p) / setup.uncertainty.friction.mu_p
    });
    let drawn: Vec<f64> = drawn.collect();
    let count = drawn.len() as f64;
    let mean = drawn.iter().sum::<f64>() / count;
    let variance = drawn.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (count - 1.0);
    // within four standard errors of a standard normal distribution
    assert!(mean.abs() < 4.0 / count.sqrt(), "{mean}");
    assert!(
        (variance - 1.0).abs() < 4.0 * (2.0 / count).sqrt(),
        "{variance}"
    );
}

#[test]
fn sensors_that_never_err_read_what_is_touched() {
    let setup = Setup {
        tactile: Tactile {
            false_negative: 1e-9,
            false_positive: 1e-9,
            ..Tactile::default()
        },
        ..scene()
    };
    let (mut free, mut pressed) = (0, 0);
    for sample in samples(&setup, &push()) {
        for (truth, reading) in sample.truth.iter().zip(&sample.log.tactile[0]) {
            // 30 mm and 5 mm of radius; offsets and outline are some tenths of a millimetre
            let gap = (0.06 - truth.pose.x).hypot(truth.pose.y) - 0.035;
            free += u32::from(gap > 5e-3);
            assert!(gap < 5e-3 || *reading == Some(false), "{truth:?}");
        }
        // the pusher, which goes on, presses the object against the fixel
        pressed += u32::from(*sample.log.tactile[0].last().expect("rows") == Some(true));
    }
    assert!(free > 1000);
    assert!(f64::from(pressed) > 0.9 * SAMPLES as f64, "{pressed}");
}

#[test]
fn a_sample_is_reproduced_by_its_seed() {
    let draw =
        |seed| PriorSample::draw(&scene(), &push(), FilterModel::Robust, seed).expect("a sample");
    assert_eq!(draw(3), draw(3));
    assert_ne!(draw(3).truth, draw(4).truth);
}
