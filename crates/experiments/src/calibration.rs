//! Calibration of beliefs by simulated experiments whose friction is drawn from the prior, and the
//! rank of the truth in the belief ([`CalibrationRun`], [`Tally`]). This is simulation-based
//! calibration, Talts et al. 2018.

use std::sync::Mutex;

use stickslip::{
    FilterModel, Observer, ParticleView, PriorSample, SampledState, Setup, SolvedStep, Tracking,
    Uncertainty, wrapped,
};
use stickslip_evaluation::paper::PaperExperiment;
use stickslip_evaluation::{
    LearnedParameter, PUSHER_MEMORY, Physics, REPEATS, RunConditions, ScoredRun, Simulation,
    SimulationOptions, Variant,
};
use stickslip_filter::{Purpose, Streams};
use stickslip_formats::{Experiment, TruthFacts, read_scene};

/// Quantities of a run: the pose at its end, the four friction parameters.
pub const QUANTITIES: [&str; 7] = ["x", "y", "theta", "mu_s", "mu_p", "mu_f", "d_tri"];

/// Place of the truth in a belief.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Weight of the particles below the truth; uniform from 0 to 1 where beliefs are calibrated.
    pub rank: f64,
    /// Distance of the belief's mean from the truth (SI).
    pub error: f64,
    /// Distance of the prior's mean from the truth; of a pose, that of the belief's mean.
    pub prior_error: f64,
}

/// One simulated run: each of [`QUANTITIES`], `None` where the run says that it was not observed. A
/// pose is that of the last row, friction that of the row which the run reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationRun {
    /// Place of the truth of each.
    pub placed: [Option<Placed>; 7],
    /// Rank of the truth of each at the last row that the camera saw, observed or not.
    pub seen: [f64; 7],
}

/// Source of the object's motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TruthSource {
    /// The filter's own model, noise and measurements included ([`PriorSample`]): calibrated
    /// beliefs cover such truths as often as they say.
    Prior,
    /// A simulation by the filter's dynamics without noise, or by the testbed.
    Simulated(Physics),
}

/// Options of the simulation and of the estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationOptions {
    /// Source of the object's motion.
    pub source: TruthSource,
    /// Rules of the particle filter.
    pub model: FilterModel,
    /// Uncertainty of scenes: that of truths, and that of the robust model.
    pub uncertainty: Uncertainty,
    /// Sensors of the run: whether touch is used, and whether the camera stays on. Otherwise the
    /// camera turns off before the first contact with a fixel.
    pub variant: Variant,
    /// Number of particles.
    pub particles: usize,
}

impl Placed {
    /// Returns true if the central 90 % of the belief cover the truth.
    #[must_use]
    pub fn is_held(&self) -> bool {
        covers(self.rank)
    }
}

impl CalibrationRun {
    /// The paper's experiments in turn, by as many seeds from 0 on; those that
    /// [`CalibrationRun::new`] has.
    #[must_use]
    pub fn of_papers(seeds: usize, options: &CalibrationOptions) -> Vec<Self> {
        let papers = PaperExperiment::ALL.into_iter().cycle();
        papers
            .zip(0..seeds as u64)
            .filter_map(|(paper, seed)| Self::new(paper, seed, options))
            .collect()
    }

    /// Simulates `paper` with friction drawn from its scene's prior, and tracks it through an
    /// occlusion. `None` where no fixel is met, or the drawn rig cannot be simulated.
    ///
    /// The occlusion begins before the first contact with a fixel. If the filter's own model moves
    /// the object, that is the contact of the simulation whose pusher it has, so that the occlusion
    /// reveals nothing of the truth.
    ///
    /// # Panics
    /// If an embedded scene cannot be run.
    #[must_use]
    pub fn new(paper: PaperExperiment, seed: u64, options: &CalibrationOptions) -> Option<Self> {
        let scene = paper.scene();
        let mut setup = read_scene(scene.scene, scene.name).expect("the embedded scene is one");
        setup.uncertainty = options.uncertainty;
        if options.source == TruthSource::Prior {
            // the camera is as noisy as the prior says, not less
            setup.filter.likelihood_scale = 1.0;
        }
        let known = match options.source {
            TruthSource::Prior => sampled(&setup, seed, options.model),
            TruthSource::Simulated(physics) => simulated(&setup, seed, physics),
        }?;
        let experiment = &known.experiment;
        experiment.facts.occlude_from?;
        let conditions = RunConditions {
            model: options.model,
            particles: options.particles,
            tracking: Tracking::Smoothed,
            occlusion: experiment.facts.occlusion(),
            seed,
        };
        let ranks = Ranks::of(&known.truth);
        let run = ScoredRun::new(options.variant, experiment, &conditions, Some(&ranks));
        let run = run.expect("the embedded scene can be run");
        let dark = experiment.facts.occlude_from?;
        let end = if options.variant.camera_on() {
            known.truth.len()
        } else {
            dark
        };
        let last_seen = end.checked_sub(1)?;
        Some(Self {
            placed: placed(&known, &run, &ranks)?,
            seen: ranks.at(last_seen)?,
        })
    }
}

/// An experiment with all that is true of it.
struct KnownExperiment {
    experiment: Experiment,
    /// By row.
    truth: Vec<SampledState>,
}

/// In the order of [`QUANTITIES`].
fn values(state: &SampledState) -> [f64; 7] {
    let (pose, friction) = (state.pose.fields(), state.friction.fields());
    let mut values = pose.into_iter().chain(friction);
    std::array::from_fn(|_| *values.next().expect("three and four"))
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
        seeds: seed.into(),
        rate: 30.0,
        repeats: REPEATS,
        pusher_memory: PUSHER_MEMORY,
    };
    let simulation = Simulation::run(setup, &known, &options, &mut |_, _| ()).ok()?;
    let poses = simulation.truth.pose.iter();
    let truth = poses.map(|pose| SampledState {
        pose: *pose,
        friction,
    });
    Some(KnownExperiment {
        truth: truth.collect(),
        experiment: simulation.into_experiment(setup.clone()),
    })
}

/// An experiment drawn from the filter's prior, under the pusher of a simulation.
fn sampled(setup: &Setup, seed: u64, model: FilterModel) -> Option<KnownExperiment> {
    let mut experiment = simulated(setup, seed, Physics::Model)?.experiment;
    let seed = seed + OTHER_SEEDS;
    let sample = PriorSample::draw(setup, &experiment.log, model, seed).ok()?;
    // a motion that the logged pusher contradicts is as much rarer among truths
    let streams = Streams::new(seed).of(Purpose::General);
    if streams.uniform(0, 0, 0) > sample.chance {
        return None;
    }
    experiment.log = sample.log;
    Some(KnownExperiment {
        experiment,
        truth: sample.truth,
    })
}

/// Seeds of truths lie apart from those of filters.
const OTHER_SEEDS: u64 = 1 << 32;

/// Ranks of the truth among the particles, row by row.
#[derive(Debug)]
struct Ranks<'a> {
    truth: &'a [SampledState],
    /// By row, in the order of [`QUANTITIES`].
    ranks: Mutex<Vec<[f64; 7]>>,
}

impl<'a> Ranks<'a> {
    fn of(truth: &'a [SampledState]) -> Self {
        let ranks = Mutex::new(vec![[f64::NAN; 7]; truth.len()]);
        Self { truth, ranks }
    }

    /// At a row.
    fn at(&self, row: usize) -> Option<[f64; 7]> {
        let ranks = self.ranks.lock().ok()?;
        ranks.get(row).copied()
    }
}

impl Observer for Ranks<'_> {
    fn on_step(&self, _: &SolvedStep<'_>) {}

    fn wants_steps(&self) -> bool {
        false
    }

    fn on_row(&self, row: usize, particles: &ParticleView<'_>) {
        let ranks = self.among(row, particles);
        self.ranks.lock().expect("no thread panicked")[row] = ranks;
    }
}

impl Ranks<'_> {
    /// Of the truth at a row, among some particles.
    fn among(&self, row: usize, particles: &ParticleView<'_>) -> [f64; 7] {
        let truth = self.truth[row];
        let mut ranks = [0.0; 7];
        for (i, weight) in particles.weights().iter().enumerate() {
            let mut pose = particles.pose(i);
            pose.theta = truth.pose.theta + wrapped(pose.theta - truth.pose.theta);
            let friction = particles.friction(i);
            let particle = values(&SampledState { pose, friction });
            for ((rank, value), truth) in ranks.iter_mut().zip(particle).zip(values(&truth)) {
                // equal values: half of them count as below
                let below =
                    f64::from(u8::from(value < truth)) + f64::from(u8::from(value <= truth));
                *rank += 0.5 * weight * below;
            }
        }
        ranks
    }
}

/// Place of the truth in the belief at the end of a run.
fn placed(
    known: &KnownExperiment,
    run: &ScoredRun,
    ranks: &Ranks<'_>,
) -> Option<[Option<Placed>; 7]> {
    let last = known.truth.len() - 1;
    let (truth, mean) = (known.truth[last].pose, run.estimate.rows.last()?.pose?);
    let errors = [
        mean.x - truth.x,
        mean.y - truth.y,
        wrapped(mean.theta - truth.theta),
    ];
    let at_end = ranks.at(last)?;
    let mut all = [None; 7];
    for ((to, error), rank) in all.iter_mut().zip(errors).zip(at_end) {
        *to = Some(Placed {
            rank,
            error: error.abs(),
            prior_error: error.abs(),
        });
    }
    let nominal = &known.experiment.setup.scene.nominal;
    for parameter in LearnedParameter::all(&run.estimate) {
        let Some(row) = parameter.row else { continue };
        let place = QUANTITIES.iter().position(|name| *name == parameter.name)?;
        let truth = parameter.among(&known.truth[row].friction)?;
        all[place] = Some(Placed {
            rank: ranks.at(row)?[place],
            error: (parameter.mean - truth).abs(),
            prior_error: (parameter.among(nominal)? - truth).abs(),
        });
    }
    Some(all)
}

/// Returns true if the central 90 % of a belief cover a truth of this rank.
fn covers(rank: f64) -> bool {
    (0.05..=0.95).contains(&rank)
}

/// Number of truths that beliefs cover, and the distribution of their ranks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankTally {
    /// Number of beliefs.
    pub count: usize,
    /// Share of them whose central 90 % cover the truth.
    pub covered: f64,
    /// Standard error of that share.
    pub standard_error: f64,
    /// χ² of the ranks in ten equal bins against uniform ones; 21.7 is its 99 % quantile.
    pub chi_squared: f64,
}

impl RankTally {
    /// `None` where there are none.
    fn of(ranks: &[f64]) -> Option<Self> {
        if ranks.is_empty() {
            return None;
        }
        let count = ranks.len() as f64;
        let covered = ranks.iter().filter(|rank| covers(**rank)).count() as f64 / count;
        let mut bins = [0.0; 10];
        for rank in ranks {
            bins[((rank * 10.0) as usize).min(9)] += 1.0;
        }
        let expected = count / 10.0;
        Some(Self {
            count: ranks.len(),
            covered,
            standard_error: (covered * (1.0 - covered) / count).sqrt(),
            chi_squared: bins
                .iter()
                .map(|bin| (bin - expected) * (bin - expected) / expected)
                .sum(),
        })
    }
}

/// Results of many runs for one quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tally {
    /// In the runs that observed it, `None` where none did.
    pub observed: Option<Observed>,
    /// In all runs, at the last row that the camera saw.
    pub seen: RankTally,
}

/// Results of the runs that identified a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observed {
    /// Ranks of the truth.
    pub ranks: RankTally,
    /// Median distance from the truth (SI).
    pub error: f64,
    /// Median distance of the prior's mean from the truth; for a pose, that of the belief's mean.
    pub prior_error: f64,
}

impl Tally {
    /// Of quantity number `which` of [`QUANTITIES`]; `None` where there is no run.
    #[must_use]
    pub fn of(runs: &[CalibrationRun], which: usize) -> Option<Self> {
        let seen: Vec<f64> = runs.iter().map(|run| run.seen[which]).collect();
        let placed: Vec<Placed> = runs.iter().filter_map(|run| run.placed[which]).collect();
        Some(Self {
            observed: Observed::of(&placed),
            seen: RankTally::of(&seen)?,
        })
    }
}

impl Observed {
    fn of(placed: &[Placed]) -> Option<Self> {
        let ranks: Vec<f64> = placed.iter().map(|placed| placed.rank).collect();
        let median = |distance: fn(&Placed) -> f64| {
            let distances: Vec<f64> = placed.iter().map(distance).collect();
            stickslip::quantile(&distances, 0.5)
        };
        Some(Self {
            ranks: RankTally::of(&ranks)?,
            error: median(|placed| placed.error)?,
            prior_error: median(|placed| placed.prior_error)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beliefs of standard deviation `std` about truths from N(0, 1) measured with deviation 1.
    fn tally(std: f64) -> Observed {
        let runs: Vec<CalibrationRun> = (0..2000)
            .map(|seed| {
                let [truth, noise] = Streams::new(seed).normals::<2>(0, 0, 0);
                let error = (truth + noise) / 2.0 - truth;
                let placed = Placed {
                    rank: 0.5 * libm::erfc(error / std / std::f64::consts::SQRT_2),
                    error: error.abs(),
                    prior_error: truth.abs(),
                };
                CalibrationRun {
                    placed: [Some(placed); 7],
                    seen: [placed.rank; 7],
                }
            })
            .collect();
        let tally = Tally::of(&runs, 0).expect("runs");
        let observed = tally.observed.expect("all observe");
        assert_eq!(tally.seen, observed.ranks);
        observed
    }

    #[test]
    fn the_exact_posterior_is_calibrated_and_a_narrow_one_is_not() {
        // the posterior of N(0, 1) measured once with deviation 1 has variance 1/2
        let exact = tally(0.5_f64.sqrt());
        let ranks = exact.ranks;
        assert!(
            (ranks.covered - 0.9).abs() < 4.0 * ranks.standard_error,
            "{exact:?}"
        );
        assert!(
            ranks.chi_squared < 30.0 && exact.error < exact.prior_error,
            "{exact:?}"
        );
        let narrow = tally(0.3).ranks;
        assert!(
            narrow.covered < 0.6 && narrow.chi_squared > 100.0,
            "{narrow:?}"
        );
    }
}
