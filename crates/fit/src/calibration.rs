//! Simulation-based calibration of the fit (Talts et al. 2018): constants and noise are drawn from
//! the fit's own priors, pushes from its own dynamics and likelihood. Among draws from the
//! posterior, the rank of each true number is then uniform.

use stickslip_dynamics::{Pose, SpeedProfile, Start};
use stickslip_evaluation::{Physics, Simulation, SimulationOptions};
use stickslip_filter::Streams;
use stickslip_formats::{TruthFacts, read_scene};

use crate::likelihood::drawn_residuals;
use crate::parameter::Parameter;
use crate::posterior::Posterior;
use crate::progress::Progress;
use crate::push::{PreparedPush, Push};
use crate::sampler::sample;

/// A plate that is pushed without noise.
const SCENE: &str = "
gravity = 9.81
object  = { mass = 0.5, inertia = 3.3e-4, shape = [{ polygon = [[-0.04, -0.02], [0.04, -0.02], [0.04, 0.02], [-0.04, 0.02]] }] }
support = { friction = 0.3, tripod_radius = 0.025 }
pusher  = { friction = 0.3, stall_force = 100.0, shape = [{ disc = { radius = 0.005 } }] }
fixels  = { friction = 0.25 }
";

/// Places of the pushes along the face (m).
const PLACES: [f64; 2] = [-0.02, 0.012];

/// Draws of a posterior.
const DRAWS: usize = 500;

/// Pushes against the lower face, each at another place.
fn pushes(places: &[f64]) -> Vec<PreparedPush> {
    let push = |place: &f64| {
        let mut setup = read_scene(SCENE, "scene.toml").expect("a scene");
        setup.start = Some(Start {
            object: Pose::default(),
            pusher: Pose::new(*place, -0.026, 0.0),
            direction: std::f64::consts::FRAC_PI_2 - 10.0 * place,
            other_fingers: Vec::new(),
            speed: SpeedProfile::constant(0.02),
            duration: 1.0,
        });
        let options = SimulationOptions {
            physics: Physics::Model,
            seeds: 0.into(),
            rate: 10.0,
            repeats: 0.0,
            pusher_memory: 0.0,
        };
        let simulation = Simulation::run(&setup, &TruthFacts::default(), &options, &mut |_, _| ())
            .expect("runs");
        let log = simulation.log;
        let name = String::new();
        PreparedPush::new(Push { name, setup, log }).expect("a push")
    };
    places.iter().map(push).collect()
}

/// Shares of the posterior's draws below each true number, of each of `fits` fits: of the free
/// parameters, of the camera's noise and of the drift. Each push counts in full, since the model is
/// right.
fn ranks(free: &[Parameter], places: &[f64], fits: u64) -> Vec<Vec<f64>> {
    let clean = pushes(places);
    let unseen = Progress::new(&|_, _| (), 0);
    let of_fit = |fit: u64| {
        let streams = Streams::new(fit);
        let prior = Posterior::new(clean.iter().collect(), free, &unseen).expect("open priors");
        let numbers = 0..prior.dimension() as u32;
        let truth: Vec<f64> = numbers.map(|k| streams.normal(0, 0, k)).collect();

        // the pushes as such a rig would move and a camera see them
        let mut seen = clean.clone();
        for (k, push) in seen.iter_mut().enumerate() {
            let prediction = prior.predictions(k, std::slice::from_ref(&truth)).remove(0);
            let prediction = prediction.expect("an outline");
            let instants = prior.instants(k, &truth);
            let travelled: Vec<f64> = instants.iter().map(|instant| instant.travelled).collect();
            let radius = push.push.setup.virtual_radius();
            let draw = streams.at(1 + k as u64);
            let noise = prior.noise(&truth);
            let residuals = drawn_residuals(&travelled, &noise, push.noise(), radius, draw);
            let first = push.predictor.first;
            for ((row, pose), [x, y, turn]) in push.measured.iter_mut().zip(residuals) {
                let exact = prediction.poses[*row - first];
                *pose = Pose::new(exact.x + x, exact.y + y, exact.theta + turn / radius);
            }
        }

        let posterior = Posterior::new(seen.iter().collect(), free, &unseen).expect("open priors");
        let (chain, _) = sample(&posterior, &|_| 1.0, 1.01, Streams::new(1 << 20 | fit));
        let draws = chain.thinned(DRAWS);
        let below = |k: usize| draws.iter().filter(|draw| draw[k] < truth[k]).count();
        let ranks = (0..truth.len()).map(|k| below(k) as f64 / DRAWS as f64);
        ranks.collect()
    };
    (0..fits).map(of_fit).collect()
}

/// Prints how many ranks of each number lie in each fifth and in the middle 90 %.
fn print(ranks: &[Vec<f64>]) {
    for k in 0..ranks[0].len() {
        let mut fifths = [0; 5];
        let of_number = ranks.iter().map(|ranks| ranks[k]);
        of_number.for_each(|rank| fifths[((5.0 * rank) as usize).min(4)] += 1);
        let middle = |ranks: &&Vec<f64>| (0.05..=0.95).contains(&ranks[k]);
        let middle = ranks.iter().filter(middle).count();
        println!("{k}: {fifths:?}, 90 % cover {middle} of {}", ranks.len());
    }
}

/// Of uniform ranks, means are 0.5 ± 0.29 / sqrt(n), and mean distances from 0.5 are 0.25 ± 0.14 /
/// sqrt(n). Intervals half as wide as they should be have mean distances of 0.35.
#[test]
fn ranks_of_the_truth_are_uniform() {
    let ranks = ranks(&[Parameter::MuP, Parameter::TripodRadius], &PLACES[..1], 10);
    print(&ranks);
    let all: Vec<f64> = ranks.concat();
    let count = all.len() as f64;
    let mean = all.iter().sum::<f64>() / count;
    let distance = all.iter().map(|rank| (rank - 0.5).abs()).sum::<f64>() / count;
    assert!((mean - 0.5).abs() < 3.0 * 0.29 / count.sqrt(), "{mean}");
    assert!(
        (distance - 0.25).abs() < 3.0 * 0.14 / count.sqrt(),
        "{distance}"
    );
}

/// The parameters that are free by default.
#[test]
#[ignore = "takes an hour, prints ranks"]
fn ranks_of_all_that_is_free_by_default() {
    let setup = read_scene(SCENE, "scene.toml").expect("a scene");
    print(&ranks(&Parameter::default_list(&setup), &PLACES, 45));
}
