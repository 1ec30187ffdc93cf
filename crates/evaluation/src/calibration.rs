//! Whether beliefs are true: simulated experiments whose friction is drawn from the prior, and where
//! the truth then lies in the belief ([`CalibrationRun`], [`Tally`]); simulation-based calibration,
//! Talts et al. 2018.

use stickslip::dynamics::{Friction, Pose};
use stickslip::{
    Camera, Estimate, Mode, Occlusion, RunOptions, Setup, TactileUse, Tracking, run, wrapped,
};
use stickslip_filter::{Purpose, Streams};
use stickslip_formats::{Experiment, TruthFacts, read_scene};

use crate::belief::NINETY_PERCENT;
use crate::learned_friction::LearnedParameter;
use crate::paper::PaperExperiment;
use crate::run::{RunConditions, ScoredRun};
use crate::simulation::{PUSHER_MEMORY, Physics, REPEATS, Simulation, SimulationOptions};
use crate::variant::Variant;

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

/// What moves the object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TruthSource {
    /// One particle of the filter's own, noise included: of such truths, true beliefs hold as much as
    /// they say.
    Particle,
    /// A simulation by the filter's dynamics without noise, or by the testbed.
    Simulated(Physics),
}

/// What is simulated, and how it is estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationOptions {
    /// What moves the object.
    pub source: TruthSource,
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
        let truth = match options.source {
            TruthSource::Particle => sampled(&setup, seed, options.mode),
            TruthSource::Simulated(physics) => simulated(&setup, seed, physics),
        }?;
        let experiment = &truth.experiment;
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
        let run = ScoredRun::new(variant, experiment, &conditions, None);
        let run = run.expect("the embedded scene can be run");
        Some(Self {
            placed: placed(&truth, &run)?,
        })
    }
}

/// An experiment with all that is true of it.
struct KnownExperiment {
    experiment: Experiment,
    friction: Friction,
    end: Pose,
}

/// An experiment simulated with friction from the prior; `None` where the drawn rig cannot be.
fn simulated(setup: &Setup, seed: u64, physics: Physics) -> Option<KnownExperiment> {
    let streams = Streams::new(seed).of(Purpose::General);
    let friction = setup.drawn_friction(streams.normals(0, 0, 0));
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
    let simulation = Simulation::run(setup, &known, &options).ok()?;
    let end = *simulation.truth.pose.last()?;
    Some(KnownExperiment {
        experiment: simulation.into_experiment(setup.clone()),
        friction,
        end,
    })
}

/// An experiment in which the object moves as a particle of the filter does that sees and feels
/// nothing, under the pusher of a simulation.
fn sampled(setup: &Setup, seed: u64, mode: Mode) -> Option<KnownExperiment> {
    let mut experiment = simulated(setup, seed, Physics::Model)?.experiment;
    let options = RunOptions {
        mode,
        particles: 1,
        seed: seed + OTHER_SEEDS,
        tactile: TactileUse::Ignored,
        occlusion: Occlusion::Rows { from: 1, to: None },
        ..RunOptions::default()
    };
    let particle = run(setup, &experiment.log, &options, &mut |_| ()).ok()?;
    // a motion that the logged pusher contradicts is as much rarer among truths
    let chance = libm::exp(particle.log_evidence?);
    let streams = Streams::new(seed + OTHER_SEEDS).of(Purpose::General);
    if streams.uniform(0, 0, 0) > chance {
        return None;
    }
    let last = particle.estimate.rows.last()?;
    let (friction, end) = (last.friction?, last.pose?);
    measure(&mut experiment, &particle.estimate, setup.camera?, seed);
    Some(KnownExperiment {
        experiment,
        friction,
        end,
    })
}

/// Seeds of truths lie apart from those of filters.
const OTHER_SEEDS: u64 = 1 << 32;

/// Frames from the blackout to the first contact with a fixel.
const LEAD: usize = 5;

/// Writes what camera and sensors read of the motion of `particle`, with the errors that the filter
/// reckons with.
fn measure(experiment: &mut Experiment, particle: &Estimate, camera: Camera, seed: u64) {
    let streams = Streams::new(seed + OTHER_SEEDS).of(Purpose::Measure);
    let setup = &experiment.setup;
    let wider = setup.filter.likelihood_scale;
    let late = -setup.uncertainty.latency * libm::log(streams.uniform(0, 0, 0));
    let (log, tactile) = (&mut experiment.log, setup.tactile);
    for (row, estimate) in particle.rows.iter().enumerate().skip(1) {
        let noise = streams.normals::<3>(row as u64, 0, 2);
        let shown = (log.time[row] - camera.latency - late).max(log.time[0]);
        log.object[row] = particle.pose_at(shown).map(|pose| Pose {
            x: pose.x + wider * camera.position_std * noise[0],
            y: pose.y + wider * camera.position_std * noise[1],
            theta: pose.theta + wider * camera.orientation_std * noise[2],
        });
        let contacts = estimate.contact_fixels.iter().flatten();
        for (j, (sensor, contact)) in log.tactile.iter_mut().zip(contacts).enumerate() {
            let errs = streams.uniform(row as u64, 1 + j as u32, 0);
            sensor[row] = Some(match *contact > 0.5 {
                true => errs > tactile.false_negative,
                false => errs < tactile.false_positive,
            });
        }
    }
    let touched = |row: &usize| {
        let contacts = particle.rows[*row].contact_fixels.iter().flatten();
        contacts.into_iter().any(|contact| *contact > 0.5)
    };
    let first = (0..particle.rows.len()).find(touched);
    experiment.facts.occlude_from = first.map(|row| row.saturating_sub(LEAD).max(1));
}

/// Where the truth lies at the end of a run.
fn placed(known: &KnownExperiment, run: &ScoredRun) -> Option<[Option<Placed>; 7]> {
    let (end, row) = (&known.end, run.estimate.rows.last()?);
    let (mean, spread) = (row.pose?, row.spread?);
    let turned = mean.theta + wrapped(end.theta - mean.theta);
    let pose = [
        (end.x, mean.x, spread.pose.x),
        (end.y, mean.y, spread.pose.y),
        (turned, mean.theta, spread.pose.theta),
    ];
    let mut all = [None; 7];
    for (to, (truth, mean, std)) in all.iter_mut().zip(pose) {
        let prior = mean;
        *to = Some(Placed {
            truth,
            mean,
            std,
            prior,
        });
    }
    let nominal = &known.experiment.setup.scene.nominal;
    for parameter in LearnedParameter::all(&run.estimate) {
        let place = QUANTITIES.iter().position(|name| *name == parameter.name)?;
        all[place] = parameter.observed.then_some(Placed {
            truth: parameter.among(&known.friction)?,
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
