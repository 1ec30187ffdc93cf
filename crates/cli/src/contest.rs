//! The methods that are compared on one experiment: [`Rival`], and one [`Attempt`] of one of them.

use anyhow::Result;
use stickslip::{
    Method, Observer, Occlusion, Run, RunOptions, Scores, TactileUse, Tracking, run, run_observed,
    score,
};
use stickslip_formats::Experiment;
use stickslip_report::Colour;

/// A way to estimate that takes part in a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rival {
    /// The nominal simulation.
    Nominal,
    /// The Kalman filter.
    Kalman,
    /// The particle filter without tactile readings.
    ParticleNoTactile,
    /// The particle filter with all that the log has.
    Particle,
    /// The same with nothing hidden, scored over the same rows.
    ParticleAlwaysOn,
}

/// What all attempts of a comparison share.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// Number of particles.
    pub particles: usize,
    /// How the pusher is tracked.
    pub tracking: Tracking,
}

/// One run of one rival, with its scores.
#[derive(Clone, Debug)]
pub struct Attempt {
    /// The run.
    pub run: Run,
    /// Its scores; over hidden rows also where this rival saw them.
    pub scores: Scores,
}

impl Rival {
    /// All, in the order of tables.
    pub const ALL: [Self; 5] = [
        Self::Nominal,
        Self::Kalman,
        Self::ParticleNoTactile,
        Self::Particle,
        Self::ParticleAlwaysOn,
    ];

    /// Name in tables and figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Kalman => "kalman",
            Self::ParticleNoTactile => "particle, no tactile",
            Self::Particle => "particle",
            Self::ParticleAlwaysOn => "particle, camera on",
        }
    }

    /// Colour in figures.
    pub fn colour(self) -> Colour {
        match self {
            Self::Nominal => Colour::GREY,
            Self::Kalman => Colour::ORANGE,
            Self::ParticleNoTactile => Colour::SKY,
            Self::Particle => Colour::VERMILLION,
            Self::ParticleAlwaysOn => Colour::GREEN,
        }
    }

    /// Name in reports.
    pub fn title(self) -> &'static str {
        match self {
            Self::Nominal => "nominal simulation",
            Self::Kalman => "Kalman filter",
            Self::ParticleNoTactile => "particle filter without touch",
            Self::Particle => "particle filter",
            Self::ParticleAlwaysOn => "particle filter, camera on",
        }
    }

    /// Name in JSON.
    pub fn key(self) -> &'static str {
        match self {
            Self::Nominal => "nominal",
            Self::Kalman => "kalman",
            Self::ParticleNoTactile => "particle_no_tactile",
            Self::Particle => "particle",
            Self::ParticleAlwaysOn => "particle_always_on",
        }
    }

    /// Whether a run depends on its seed.
    pub fn is_random(self) -> bool {
        !matches!(self, Self::Nominal | Self::Kalman)
    }

    /// Those that differ on this experiment when `occlusion` hides rows.
    pub fn on(experiment: &Experiment, occlusion: Occlusion) -> Vec<Self> {
        let hides = occlusion.hidden(&experiment.log).contains(&true);
        let differs = |rival: &Self| match rival {
            Self::ParticleNoTactile => !experiment.log.tactile.is_empty(),
            Self::ParticleAlwaysOn => hides,
            _ => true,
        };
        Self::ALL.into_iter().filter(differs).collect()
    }

    /// Runs and scores it; `occlusion` is what is hidden, and scored even where this rival sees it.
    /// A `watch` changes no result.
    pub fn attempt(
        self,
        experiment: &Experiment,
        occlusion: Occlusion,
        rules: &Rules,
        seed: u64,
        watch: Option<&dyn Observer>,
    ) -> Result<Attempt> {
        let run = self.run(experiment, occlusion, rules, seed, watch)?;
        let hidden = occlusion.hidden(&experiment.log);
        let scores = score(
            &run.estimate,
            &experiment.reference(),
            &hidden,
            experiment.setup.virtual_radius(),
        );
        Ok(Attempt { run, scores })
    }

    /// Runs it while `occlusion` hides the object.
    pub fn run(
        self,
        experiment: &Experiment,
        occlusion: Occlusion,
        rules: &Rules,
        seed: u64,
        watch: Option<&dyn Observer>,
    ) -> Result<Run> {
        let Experiment { setup, log, .. } = experiment;
        let options = self.options(occlusion, rules, seed);
        Ok(match watch {
            Some(watch) => run_observed(setup, log, &options, watch, &mut |_| ())?,
            None => run(setup, log, &options, &mut |_| ())?,
        })
    }

    fn options(self, occlusion: Occlusion, rules: &Rules, seed: u64) -> RunOptions {
        let (particles, tracking) = (rules.particles, rules.tracking);
        let options = RunOptions {
            particles,
            tracking,
            seed,
            occlusion,
            ..RunOptions::default()
        };
        match self {
            Self::Nominal => RunOptions {
                method: Method::Nominal,
                ..options
            },
            Self::Kalman => RunOptions {
                method: Method::Kalman,
                ..options
            },
            Self::ParticleNoTactile => RunOptions {
                tactile: TactileUse::Ignored,
                ..options
            },
            Self::Particle => options,
            Self::ParticleAlwaysOn => RunOptions {
                occlusion: Occlusion::None,
                ..options
            },
        }
    }
}
