//! Whether beliefs are true: simulated experiments whose friction is drawn from the prior, and where
//! the truth then lies in the belief ([`CalibrationRun`], [`Tally`]); simulation-based calibration,
//! Talts et al. 2018.

use stickslip::dynamics::{Friction, Pose};
use stickslip::{Mode, Setup, Tracking, wrapped};
use stickslip_filter::{Purpose, Streams};
use stickslip_formats::{Experiment, TruthFacts, read_scene};

use crate::learned_friction::LearnedParameter;
use crate::paper::PaperExperiment;
use crate::run::{RunConditions, ScoredRun};
use crate::simulation::{
    PUSHER_MEMORY, Physics, REPEATS, Simulation, SimulationError, SimulationOptions,
};
use crate::variant::Variant;

/// Standard deviations on either side of the mean that hold 90 % of a normal distribution.
const NINETY_PERCENT: f64 = 1.644_853_626_951_472_7;

/// Quantities of a run: the pose at its end, the four friction parameters.
pub const QUANTITIES: [&str; 7] = ["x", "y", "theta", "mu_s", "mu_p", "mu_f", "d_tri"];

/// Where the truth lies in a belief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Truth (SI).
    pub truth: f64,
    /// Mean of the belief.
    pub mean: f64,
    /// Standard deviation of the belief.
    pub std: f64,
    /// What was believed before the run.
    pub prior: f64,
}

/// One simulated run: each of [`QUANTITIES`], `None` where the run says that it was not observed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationRun {
    /// Where the truth of each lies.
    pub placed: [Option<Placed>; 7],
}

/// What is simulated, and how it is estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationOptions {
    /// What moves the object.
    pub physics: Physics,
    /// Rules of the particle filter.
    pub mode: Mode,
    /// Whether it feels and not only sees.
    pub touch: bool,
    /// Number of particles.
    pub particles: usize,
}

impl CalibrationRun {
    /// Simulates `paper` with friction drawn from its scene's prior, and tracks it through the
    /// blackout before the first contact with a fixel. `None` where no fixel is met, or the drawn rig
    /// cannot be simulated.
    ///
    /// # Panics
    /// If an embedded scene cannot be run.
    #[must_use]
    pub fn new(paper: PaperExperiment, seed: u64, options: &CalibrationOptions) -> Option<Self> {
        let scene = paper.scene();
        let setup = read_scene(scene.scene, scene.name).expect("the embedded scene is one");
        let friction = drawn(&setup, seed);
        let experiment = simulated(&setup, &friction, seed, options.physics).ok()?;
        experiment.facts.occlude_from?;
        let conditions = RunConditions {
            mode: options.mode,
            particles: options.particles,
            tracking: Tracking::Smoothed,
            occlusion: experiment.facts.occlusion(),
            seed,
        };
        let variant = match options.touch {
            true => Variant::Particle,
            false => Variant::ParticleNoTouch,
        };
        let run = ScoredRun::new(variant, &experiment, &conditions, None);
        let run = run.expect("the embedded scene can be run");
        Some(Self {
            placed: placed(&experiment, &run, &friction)?,
        })
    }
}

/// Friction from the prior of a setup.
fn drawn(setup: &Setup, seed: u64) -> Friction {
    let streams = Streams::new(seed).of(Purpose::General);
    let normals = streams.normals::<4>(0, 0, 0);
    let (stds, limits) = (
        setup.uncertainty.friction.fields(),
        setup.filter.limits.fields(),
    );
    let mut friction = setup.scene.nominal;
    for (k, value) in friction.fields_mut().into_iter().enumerate() {
        *value *= libm::exp(stds[k] * normals[k]);
        *value = value.clamp(limits[k].min, limits[k].max);
    }
    friction
}

/// The experiment with a true friction; of the testbed's feet nobody knows the radius of a tripod.
fn simulated(
    setup: &Setup,
    friction: &Friction,
    seed: u64,
    physics: Physics,
) -> Result<Experiment, SimulationError> {
    let known = TruthFacts {
        mu_s: Some(friction.mu_s),
        mu_p: Some(friction.mu_p),
        mu_f: Some(friction.mu_f),
        d_tri: Some(friction.d_tri),
        ..TruthFacts::default()
    };
    let options = SimulationOptions {
        physics,
        seed,
        rate: 30.0,
        repeats: REPEATS,
        pusher_memory: PUSHER_MEMORY,
    };
    let simulation = Simulation::run(setup, &known, &options)?;
    Ok(simulation.into_experiment(setup.clone()))
}

/// Where the truth lies at the end of a run.
fn placed(
    experiment: &Experiment,
    run: &ScoredRun,
    friction: &Friction,
) -> Option<[Option<Placed>; 7]> {
    let truth = experiment.truth.as_ref()?;
    let row = run.estimate.rows.last()?;
    let (mean, spread) = (row.pose?, row.spread?);
    let end: &Pose = truth.pose.last()?;
    let turned = mean.theta + wrapped(end.theta - mean.theta);
    let pose = [
        (end.x, mean.x, spread.pose.x),
        (end.y, mean.y, spread.pose.y),
        (turned, mean.theta, spread.pose.theta),
    ];
    let mut all = [None; 7];
    for (to, (truth, mean, std)) in all.iter_mut().zip(pose) {
        *to = Some(Placed {
            truth,
            mean,
            std,
            prior: mean,
        });
    }
    let nominal = &experiment.setup.scene.nominal;
    for parameter in LearnedParameter::all(&run.estimate) {
        let place = QUANTITIES.iter().position(|name| *name == parameter.name)?;
        all[place] = parameter.observed.then_some(Placed {
            truth: parameter.among(friction)?,
            mean: parameter.mean,
            std: parameter.std,
            prior: parameter.among(nominal)?,
        });
    }
    Some(all)
}

impl Placed {
    /// Whether the 90 % interval of the belief holds the truth.
    #[must_use]
    pub fn covered(&self) -> bool {
        (self.truth - self.mean).abs() <= NINETY_PERCENT * self.std
    }

    /// Probability that the belief, taken as normal, gives to values below the truth; uniform where
    /// beliefs are true.
    #[must_use]
    pub fn rank(&self) -> f64 {
        match self.std > 0.0 {
            true => {
                let deviation = (self.truth - self.mean) / self.std;
                0.5 * libm::erfc(-deviation / std::f64::consts::SQRT_2)
            }
            false => f64::from(u8::from(self.truth > self.mean)),
        }
    }
}

/// What many runs say of one quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tally {
    /// Runs in which it was observed.
    pub runs: usize,
    /// Share of them whose 90 % interval holds the truth.
    pub covered: f64,
    /// Standard error of that share.
    pub standard_error: f64,
    /// χ² of the ranks in ten equal bins against uniform ones; 21.7 is its 99 % quantile.
    pub chi_squared: f64,
    /// Median distance from the truth (SI).
    pub error: f64,
    /// The same of what was believed before the run; 0 for a pose.
    pub prior_error: f64,
}

impl Tally {
    /// Of quantity number `which` of [`QUANTITIES`]; `None` where no run observed it.
    #[must_use]
    pub fn of(runs: &[CalibrationRun], which: usize) -> Option<Self> {
        let placed: Vec<Placed> = runs.iter().filter_map(|run| run.placed[which]).collect();
        let count = placed.len() as f64;
        let covered = placed.iter().filter(|placed| placed.covered()).count() as f64 / count;
        let mut bins = [0.0; 10];
        for placed in &placed {
            bins[((placed.rank() * 10.0) as usize).min(9)] += 1.0;
        }
        let expected = count / 10.0;
        let median = |distance: fn(&Placed) -> f64| {
            let distances: Vec<f64> = placed.iter().map(distance).collect();
            stickslip::quantile(&distances, 0.5)
        };
        Some(Self {
            runs: placed.len(),
            covered,
            standard_error: (covered * (1.0 - covered) / count).sqrt(),
            chi_squared: bins
                .iter()
                .map(|bin| (bin - expected) * (bin - expected) / expected)
                .sum(),
            error: median(|placed| (placed.truth - placed.mean).abs())?,
            prior_error: median(|placed| (placed.truth - placed.prior).abs())?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beliefs of standard deviation `std` about truths from N(0, 1) measured with deviation 1.
    fn tally(std: f64) -> Tally {
        let runs: Vec<CalibrationRun> = (0..2000)
            .map(|seed| {
                let [truth, noise] = Streams::new(seed).normals::<2>(0, 0, 0);
                let placed = Placed {
                    truth,
                    mean: (truth + noise) / 2.0,
                    std,
                    prior: 0.0,
                };
                CalibrationRun {
                    placed: [Some(placed); 7],
                }
            })
            .collect();
        Tally::of(&runs, 0).expect("runs")
    }

    #[test]
    fn the_exact_posterior_is_calibrated_and_a_narrow_one_is_not() {
        // the posterior of N(0, 1) measured once with deviation 1 has variance 1/2
        let exact = tally(0.5_f64.sqrt());
        assert!(
            (exact.covered - 0.9).abs() < 4.0 * exact.standard_error,
            "{exact:?}"
        );
        assert!(
            exact.chi_squared < 30.0 && exact.error < exact.prior_error,
            "{exact:?}"
        );
        let narrow = tally(0.3);
        assert!(
            narrow.covered < 0.6 && narrow.chi_squared > 100.0,
            "{narrow:?}"
        );
    }
}
