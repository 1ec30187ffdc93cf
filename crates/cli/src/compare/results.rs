//! Results of a comparison: [`Comparison`], per folder and over folders.

use std::cmp::Ordering;
use std::path::Path;

use anyhow::Result;
use serde::Serialize;
use stickslip::diagnosis::{assumed_stall_force, collapsed, misread};
use stickslip_evaluation::{PIT_BINS, ScoredRun, Variant, quantile};
use stickslip_formats::Experiment;

use super::best_baseline::BestBaseline;
use super::folder_set::FolderSet;
use crate::failure::one_line;

/// The scores of one run, or their medians over runs.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct ShownScores {
    /// Weighted RMSE over the hidden rows, over all rows where none is hidden (mm).
    pub wmse_mm: Option<f64>,
    /// Weighted RMSE while the object moves (mm).
    pub wmse_moving_mm: Option<f64>,
    /// Weighted RMSE over the hidden rows up to 1 s after the last motion (mm).
    pub wmse_until_rest_mm: Option<f64>,
    /// Final position error (mm).
    pub final_error_mm: Option<f64>,
    /// Final angle error (degrees).
    pub final_error_deg: Option<f64>,
    /// Share of the 90 % intervals of x, y and θ that cover the reference, over the rows of
    /// `wmse_mm`.
    pub covered_90: Option<f64>,
    /// Such a share over the rows that were seen while the object moved.
    pub covered_90_seen: Option<f64>,
    /// Such a share at the last scored row.
    pub covered_90_final: Option<f64>,
    /// Continuous ranked probability score over the rows of `wmse_mm` (mm).
    pub crps_mm: Option<f64>,
    /// Histogram of the probability integral transform over those rows; a mean wherever it is over
    /// several runs or folders.
    pub pit: Option<[f64; PIT_BINS]>,
    /// Unsolved particle steps, summed over seeds.
    pub unsolved: u64,
    /// Rows at which no particle explained the camera, summed over seeds.
    pub collapses: u32,
    /// Rows with a camera pose that was used.
    #[serde(skip)]
    pub seen: usize,
}

/// One of the scores that are shown.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Title in tables.
    pub title: &'static str,
    /// The score.
    pub of: fn(&ShownScores) -> Option<f64>,
    /// Statistic of it that is shown over folders.
    pub over: Over,
}

/// Statistic of a score that is shown over folders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// Its median and its 90th percentile.
    Quantiles,
    /// Its mean: a share has no tail.
    Mean,
}

/// A variant's scores.
#[derive(Clone, Debug, Serialize)]
pub struct VariantScores {
    /// The variant.
    #[serde(skip)]
    pub variant: Variant,
    /// Its name in JSON.
    pub method: &'static str,
    /// Its scores.
    #[serde(flatten)]
    pub scores: ShownScores,
}

/// The variants' scores on one folder, medians over seeds.
#[derive(Clone, Debug, Serialize)]
pub struct FolderResult {
    /// The folder.
    pub folder: String,
    /// Force at which its pusher yields (N); `None` is a rigid drive.
    pub stall_force: Option<f64>,
    /// True if that force is not the scene's.
    pub stall_force_assumed: bool,
    /// Assumptions about its scene, in a line.
    #[serde(skip)]
    pub note: Option<String>,
    /// Reasons to doubt its scores.
    pub warnings: Vec<String>,
    /// One entry per variant.
    pub methods: Vec<VariantScores>,
}

/// A scored run that a caller made.
#[derive(Clone, Debug)]
pub struct ComparedRun {
    /// Its experiment folder.
    pub folder: String,
    /// The method.
    pub variant: Variant,
    /// Its scores.
    pub scores: ShownScores,
    /// Reasons to doubt them.
    pub warnings: Vec<String>,
}

/// A folder that gave no result.
#[derive(Clone, Debug, Serialize)]
pub struct LostFolder {
    /// The folder.
    pub folder: String,
    /// The reason, in one line.
    pub error: String,
}

/// All that a comparison found.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Particles of each filter.
    pub particles: usize,
    /// Seeds.
    pub seeds: u64,
    /// Definition of a quantile.
    pub quantile: &'static str,
    /// Per folder.
    pub folders: Vec<FolderResult>,
    /// Over folders; every set compares methods that ran on all of its folders.
    pub sets: Vec<FolderSet>,
    /// Best baseline against the particle filter; `None` if either has no score.
    pub best_baseline: Option<BestBaseline>,
    /// Gain by touch; `None` if fewer than two folders have sensors.
    pub touch_gain: Option<TouchGain>,
    /// Folders that gave no result.
    pub errors: Vec<LostFolder>,
}

/// CRPS of the particle filter with touch minus that without, folder by folder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TouchGain {
    /// Mean over folders (mm); negative where touch makes the belief better.
    pub crps_mm: f64,
    /// Standard error of that mean (mm).
    pub standard_error_mm: f64,
    /// Number of folders.
    pub folders: usize,
}

/// The scores that are shown, in order.
pub const COLUMNS: [Column; 6] = [
    Column {
        title: "RMSE mm",
        of: |scores| scores.wmse_mm,
        over: Over::Quantiles,
    },
    Column {
        title: "moving mm",
        of: |scores| scores.wmse_moving_mm,
        over: Over::Quantiles,
    },
    Column {
        title: "final mm",
        of: |scores| scores.final_error_mm,
        over: Over::Quantiles,
    },
    Column {
        title: "final deg",
        of: |scores| scores.final_error_deg,
        over: Over::Quantiles,
    },
    Column {
        title: "covers %",
        of: |scores| scores.covered_90.map(|share| 100.0 * share),
        over: Over::Mean,
    },
    Column {
        title: "CRPS mm",
        of: |scores| scores.crps_mm,
        over: Over::Mean,
    },
];

/// Meaning of the columns of a table.
pub const LEGEND: &str = "RMSE: of the pose on occluded rows, on all rows if none is occluded. Moving: while the object moves. Final: at the last row. \
     Covers: share of 90 % intervals of x, y and theta that cover the reference, mean. CRPS: error of the whole belief, mean.";

impl ShownScores {
    /// The scores of one run.
    pub fn of(run: &ScoredRun) -> Self {
        let scores = &run.scores;
        let belief = match scores.wmse_occluded_mm {
            Some(_) => scores.belief_occluded,
            None => scores.belief,
        };
        Self {
            wmse_mm: scores.wmse_occluded_mm.or(scores.wmse_mm),
            wmse_moving_mm: scores.wmse_moving_mm,
            wmse_until_rest_mm: scores.wmse_until_rest_mm,
            final_error_mm: scores.final_error_mm,
            final_error_deg: scores.final_error_deg,
            covered_90: belief.covered,
            covered_90_seen: scores.belief_seen.covered,
            covered_90_final: scores.belief_final.covered,
            crps_mm: belief.crps_mm,
            pit: belief.pit,
            unsolved: run.unsolved,
            collapses: run.collapses,
            seen: run.seen(),
        }
    }

    /// Median errors and mean shares over seeds.
    fn over_seeds(of: &[Self]) -> Self {
        let mean = Self::mean(of);
        Self {
            covered_90: mean.covered_90,
            covered_90_seen: mean.covered_90_seen,
            covered_90_final: mean.covered_90_final,
            crps_mm: mean.crps_mm,
            pit: mean.pit,
            ..Self::quantile(of, 0.5)
        }
    }

    /// The `q`-quantile of each score, and all unsolved steps and collapses.
    pub fn quantile(of: &[Self], q: f64) -> Self {
        Self::each(of, |values| quantile(values, q))
    }

    /// The mean of each score, and all unsolved steps and collapses.
    pub fn mean(of: &[Self]) -> Self {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let pit: Vec<_> = of.iter().filter_map(|scores| scores.pit).collect();
        let tenth = |k: usize| {
            let shares = pit.iter().map(|shares| shares[k]);
            mean(&shares.collect::<Vec<_>>())
        };
        Self {
            pit: (!pit.is_empty()).then(|| std::array::from_fn(tenth)),
            ..Self::each(of, |values| (!values.is_empty()).then(|| mean(values)))
        }
    }

    /// Applies `summarise` to each score but the histogram, and sums unsolved steps and collapses.
    fn each(of: &[Self], summarise: impl Fn(&[f64]) -> Option<f64>) -> Self {
        let each = |score: fn(&Self) -> Option<f64>| {
            summarise(&of.iter().filter_map(score).collect::<Vec<_>>())
        };
        Self {
            wmse_mm: each(|m| m.wmse_mm),
            wmse_moving_mm: each(|m| m.wmse_moving_mm),
            wmse_until_rest_mm: each(|m| m.wmse_until_rest_mm),
            final_error_mm: each(|m| m.final_error_mm),
            final_error_deg: each(|m| m.final_error_deg),
            covered_90: each(|m| m.covered_90),
            covered_90_seen: each(|m| m.covered_90_seen),
            covered_90_final: each(|m| m.covered_90_final),
            crps_mm: each(|m| m.crps_mm),
            pit: None,
            unsolved: of.iter().map(|m| m.unsolved).sum(),
            collapses: of.iter().map(|m| m.collapses).sum(),
            seen: of.iter().map(|m| m.seen).sum(),
        }
    }
}

impl TouchGain {
    fn of(folders: &[FolderResult]) -> Option<Self> {
        let crps = |folder: &FolderResult, variant| folder.scores(variant)?.crps_mm;
        let gains = folders.iter().filter_map(|folder| {
            Some(crps(folder, Variant::Particle)? - crps(folder, Variant::ParticleNoTouch)?)
        });
        let gains: Vec<f64> = gains.collect();
        let count = gains.len() as f64;
        let mean = gains.iter().sum::<f64>() / count;
        let squares: f64 = gains.iter().map(|gain| (gain - mean).powi(2)).sum();
        (gains.len() >= 2).then(|| Self {
            crps_mm: mean,
            standard_error_mm: (squares / (count - 1.0) / count).sqrt(),
            folders: gains.len(),
        })
    }
}

impl VariantScores {
    /// The scores of a variant.
    pub fn new(variant: Variant, scores: ShownScores) -> Self {
        Self {
            variant,
            method: variant.key(),
            scores,
        }
    }
}

impl FolderResult {
    /// Scores of a variant; `None` if it did not run here.
    pub fn scores(&self, variant: Variant) -> Option<ShownScores> {
        let mut methods = self.methods.iter();
        let found = methods.find(|entry| entry.variant == variant)?;
        Some(found.scores)
    }

    /// Medians over the runs of each variant; the first failed run is the folder's error.
    pub fn gather<'a>(
        folder: &Path,
        experiment: &Experiment,
        runs: impl Iterator<Item = (Variant, &'a Result<ShownScores>)>,
    ) -> Result<Self, &'a anyhow::Error> {
        let runs = runs.map(|(variant, scores)| Ok((variant, *scores.as_ref()?)));
        let by_variant = by_variant(runs.collect::<Result<Vec<_>, _>>()?);
        let Experiment { setup, log, .. } = experiment;
        let unexplained = by_variant.iter().flat_map(|(variant, scores)| {
            let worst = scores.iter().max_by_key(|scores| scores.collapses)?;
            let finding = collapsed(worst.collapses, worst.seen)?;
            Some(format!("{}: {finding}", variant.name()))
        });
        let misread = misread(setup, log).into_iter();
        let warnings = misread
            .map(|finding| finding.to_string())
            .chain(unexplained);
        Ok(Self {
            warnings: warnings.collect(),
            folder: folder.display().to_string(),
            stall_force: setup.scene.pusher.stall_force,
            stall_force_assumed: setup.stall_force_assumed,
            note: assumed_stall_force(setup).map(|finding| finding.to_string()),
            methods: over_seeds(&by_variant),
        })
    }

    /// Medians over runs that a caller made of one folder.
    fn of_runs(folder: &str, runs: &[&ComparedRun]) -> Self {
        let scores = runs.iter().map(|run| (run.variant, run.scores));
        let mut warnings = Vec::new();
        for warning in runs.iter().flat_map(|run| &run.warnings) {
            if !warnings.contains(warning) {
                warnings.push(warning.clone());
            }
        }
        Self {
            folder: folder.to_owned(),
            stall_force: None,
            stall_force_assumed: false,
            note: None,
            warnings,
            methods: over_seeds(&by_variant(scores)),
        }
    }
}

/// The scores of each variant, whose runs follow each other.
fn by_variant(
    runs: impl IntoIterator<Item = (Variant, ShownScores)>,
) -> Vec<(Variant, Vec<ShownScores>)> {
    let mut by_variant: Vec<(Variant, Vec<ShownScores>)> = Vec::new();
    for (variant, scores) in runs {
        match by_variant.last_mut() {
            Some((last, all)) if *last == variant => all.push(scores),
            _ => by_variant.push((variant, vec![scores])),
        }
    }
    by_variant
}

fn over_seeds(runs: &[(Variant, Vec<ShownScores>)]) -> Vec<VariantScores> {
    let of = runs.iter();
    of.map(|(variant, scores)| VariantScores::new(*variant, ShownScores::over_seeds(scores)))
        .collect()
}

impl LostFolder {
    /// The folder with its error.
    pub fn new(folder: &Path, error: &anyhow::Error) -> Self {
        let (folder, error) = (folder.display().to_string(), one_line(error));
        let error = if error.contains(&folder) {
            error
        } else {
            format!("{folder}: {error}")
        };
        Self { folder, error }
    }
}

impl Comparison {
    /// The folders' results with quantiles over them.
    pub fn new(
        (particles, seeds): (usize, u64),
        folders: Vec<FolderResult>,
        errors: Vec<LostFolder>,
    ) -> Self {
        let quantile = "linear between order statistics: position q (n - 1) from the smallest";
        Self {
            particles,
            seeds,
            quantile,
            best_baseline: BestBaseline::of(&folders),
            touch_gain: TouchGain::of(&folders),
            sets: FolderSet::all(&folders),
            folders,
            errors,
        }
    }

    /// Of runs that a caller made; those of one folder and method follow each other.
    pub fn of_runs(runs: &[ComparedRun], particles: usize) -> Self {
        let mut names: Vec<&str> = runs.iter().map(|run| run.folder.as_str()).collect();
        names.dedup();
        let folder = |name: &str| {
            let own: Vec<&ComparedRun> = runs.iter().filter(|run| run.folder == name).collect();
            FolderResult::of_runs(name, &own)
        };
        let own = |run: &ComparedRun| (run.folder.clone(), run.variant);
        let seeds = runs.chunk_by(|a, b| own(a) == own(b)).map(<[_]>::len).max();
        let folders = names.into_iter().map(folder).collect();
        Self::new((particles, seeds.unwrap_or(0) as u64), folders, Vec::new())
    }

    /// Folders in which the particle filter has a score, its largest error first.
    pub fn ranked(&self) -> Vec<&FolderResult> {
        let score = |folder: &FolderResult| folder.scores(Variant::Particle)?.wmse_mm;
        let scored = self.folders.iter();
        let mut ranked: Vec<&FolderResult> = scored.filter(|of| score(of).is_some()).collect();
        ranked.sort_by(|a, b| score(b).partial_cmp(&score(a)).unwrap_or(Ordering::Equal));
        ranked
    }
}
