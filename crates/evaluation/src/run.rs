//! One run of a [`Variant`] on an experiment with its scores: [`ScoredRun`].

use stickslip::{
    Estimate, FilterModel, Observer, Occlusion, Run, RunError, RunOptions, Tracking, run,
    run_observed,
};
use stickslip_formats::Experiment;

use crate::score::{Reference, Scores, score};
use crate::variant::Variant;

/// Conditions that all variants of a comparison have in common on one experiment and seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunConditions {
    /// Rules of the particle filter.
    pub model: FilterModel,
    /// Number of particles.
    pub particles: usize,
    /// Tracking of the pusher: from the whole log, or causally, as live.
    pub tracking: Tracking,
    /// Hidden rows, except for variants whose camera stays on.
    pub occlusion: Occlusion,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// One run of a variant, with its scores.
#[derive(Clone, Debug, PartialEq)]
pub struct ScoredRun {
    /// The variant.
    pub variant: Variant,
    /// Its estimate, row by row.
    pub estimate: Estimate,
    /// Its scores; those over hidden rows are over the same rows where its camera stayed on.
    pub scores: Scores,
    /// Weighted RMSE over all rows against the log's own poses, hidden ones included (mm).
    pub camera_wmse_mm: Option<f64>,
    /// Particle-steps without a certified solution.
    pub unsolved: u64,
    /// Of those, the ones whose solver gave up.
    pub failed: u64,
    /// Rows at which no particle explained the camera.
    pub collapses: u32,
    /// ln of the evidence of the log, see [`Run::log_evidence`].
    pub log_evidence: Option<f64>,
}

impl ScoredRun {
    /// Runs `variant` on an experiment and scores it; an `observer` changes no result.
    ///
    /// # Errors
    /// Those of [`stickslip::run`].
    pub fn new(
        variant: Variant,
        experiment: &Experiment,
        conditions: &RunConditions,
        observer: Option<&dyn Observer>,
    ) -> Result<Self, RunError> {
        let Experiment { setup, log, .. } = experiment;
        let options = conditions.options(variant);
        let run = match observer {
            Some(observer) => run_observed(setup, log, &options, observer, &mut |_| ())?,
            None => run(setup, log, &options, &mut |_| ())?,
        };
        let radius = setup.virtual_radius();
        Ok(Self::of(
            variant,
            run,
            experiment,
            (conditions.occlusion, radius),
        ))
    }

    /// Scores a run that was made while `occlusion` hid the object, angles weighted by `radius`
    /// (m).
    #[must_use]
    pub fn of(
        variant: Variant,
        run: Run,
        experiment: &Experiment,
        (occlusion, radius): (Occlusion, f64),
    ) -> Self {
        let Run {
            estimate,
            unsolved,
            failed,
            collapses,
            log_evidence,
        } = run;
        let hidden = occlusion.hidden(&experiment.log);
        let against = |reference: &Reference| score(&estimate, reference, &hidden, radius);
        Self {
            variant,
            scores: against(&Reference::of(experiment)),
            camera_wmse_mm: against(&Reference::measured(experiment)).wmse_mm,
            estimate,
            unsolved,
            failed,
            collapses,
            log_evidence,
        }
    }

    /// Rows with a camera pose that was used.
    pub fn seen(&self) -> usize {
        self.estimate.rows.iter().filter(|row| row.visual).count()
    }
}

impl RunConditions {
    /// Options of a run of `variant`.
    pub fn options(&self, variant: Variant) -> RunOptions {
        RunOptions {
            method: variant.method(),
            model: self.model,
            particles: self.particles,
            seed: self.seed,
            tactile: variant.tactile(),
            tracking: self.tracking,
            substeps: None,
            occlusion: if variant.camera_on() {
                Occlusion::None
            } else {
                self.occlusion
            },
            ..RunOptions::default()
        }
    }
}
