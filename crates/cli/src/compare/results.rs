//! What a comparison found: [`Comparison`], per folder and over folders.

use std::path::Path;

use anyhow::Result;
use serde::Serialize;
use stickslip::diagnosis::{assumed_stall_force, collapsed, misread};
use stickslip_evaluation::{ScoredRun, Variant, quantile};
use stickslip_formats::Experiment;

use crate::args::CompareArgs;
use crate::failure::one_line;

/// The scores of one run, or their medians over runs.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ShownScores {
    /// Weighted RMSE over the hidden rows, over all rows where none is hidden (mm).
    pub wmse_mm: Option<f64>,
    /// The same while the object moves (mm).
    pub wmse_moving_mm: Option<f64>,
    /// Final position error (mm).
    pub final_error_mm: Option<f64>,
    /// Final angle error (degrees).
    pub final_error_deg: Option<f64>,
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
    /// Force at which its pusher gives way (N); `None` is a rigid drive.
    pub stall_force: Option<f64>,
    /// Whether that force is not the scene's.
    pub stall_force_assumed: bool,
    /// What was assumed of its scene, in a line.
    #[serde(skip)]
    pub note: Option<String>,
    /// What makes its scores doubtful.
    pub warnings: Vec<String>,
    /// One entry per variant.
    pub methods: Vec<VariantScores>,
}

/// A folder that gave no result.
#[derive(Clone, Debug, Serialize)]
pub struct LostFolder {
    /// The folder.
    pub folder: String,
    /// Why, in one line.
    pub error: String,
}

/// A variant's median and 90th percentile over folders.
#[derive(Clone, Debug, Serialize)]
pub struct Overall {
    /// The variant.
    #[serde(skip)]
    pub variant: Variant,
    /// Its name in JSON.
    pub method: &'static str,
    /// Number of folders it ran on.
    pub folders: usize,
    /// Medians over folders.
    pub median: ShownScores,
    /// 90th percentiles over folders.
    pub p90: ShownScores,
    /// Unsolved particle steps over all folders and seeds.
    pub unsolved: u64,
}

/// All that a comparison found.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Particles of each filter.
    pub particles: usize,
    /// Seeds.
    pub seeds: u64,
    /// What a quantile is.
    pub quantile: &'static str,
    /// Per folder.
    pub folders: Vec<FolderResult>,
    /// Over folders.
    pub overall: Vec<Overall>,
    /// Folders that gave no result.
    pub errors: Vec<LostFolder>,
}

/// The scores that are shown, in order.
pub const COLUMNS: [Column; 4] = [
    Column {
        title: "WMSE mm",
        of: |scores| scores.wmse_mm,
    },
    Column {
        title: "moving mm",
        of: |scores| scores.wmse_moving_mm,
    },
    Column {
        title: "final mm",
        of: |scores| scores.final_error_mm,
    },
    Column {
        title: "final deg",
        of: |scores| scores.final_error_deg,
    },
];

impl ShownScores {
    /// The scores of one run.
    pub fn of(run: &ScoredRun) -> Self {
        let scores = &run.scores;
        Self {
            wmse_mm: scores.wmse_occluded_mm.or(scores.wmse_mm),
            wmse_moving_mm: scores.wmse_moving_mm,
            final_error_mm: scores.final_error_mm,
            final_error_deg: scores.final_error_deg,
            unsolved: run.unsolved,
            collapses: run.collapses,
            seen: run.seen(),
        }
    }

    /// The `q`-quantile of each score, and all unsolved steps and collapses.
    fn quantile(of: &[Self], q: f64) -> Self {
        let each = |score: fn(&Self) -> Option<f64>| {
            quantile(&of.iter().filter_map(score).collect::<Vec<_>>(), q)
        };
        Self {
            wmse_mm: each(|m| m.wmse_mm),
            wmse_moving_mm: each(|m| m.wmse_moving_mm),
            final_error_mm: each(|m| m.final_error_mm),
            final_error_deg: each(|m| m.final_error_deg),
            unsolved: of.iter().map(|m| m.unsolved).sum(),
            collapses: of.iter().map(|m| m.collapses).sum(),
            seen: of.iter().map(|m| m.seen).sum(),
        }
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
    /// Medians over the runs of each variant; the first failed run is the folder's error.
    pub fn gather<'a>(
        folder: &Path,
        experiment: &Experiment,
        runs: impl Iterator<Item = (Variant, &'a Result<ShownScores>)>,
    ) -> Result<Self, &'a anyhow::Error> {
        let mut by_variant: Vec<(Variant, Vec<ShownScores>)> = Vec::new();
        for (variant, scores) in runs {
            let scores = *scores.as_ref()?;
            match by_variant.last_mut() {
                Some((last, all)) if *last == variant => all.push(scores),
                _ => by_variant.push((variant, vec![scores])),
            }
        }
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
        let warnings = warnings.collect();
        let methods = by_variant.into_iter().map(|(variant, scores)| {
            VariantScores::new(variant, ShownScores::quantile(&scores, 0.5))
        });
        Ok(Self {
            warnings,
            folder: folder.display().to_string(),
            stall_force: setup.scene.pusher.stall_force,
            stall_force_assumed: setup.stall_force_assumed,
            note: assumed_stall_force(setup).map(|finding| finding.to_string()),
            methods: methods.collect(),
        })
    }
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
    pub fn new(args: &CompareArgs, folders: Vec<FolderResult>, errors: Vec<LostFolder>) -> Self {
        let overall = Variant::COMPARED
            .into_iter()
            .filter_map(|variant| Overall::new(variant, &folders))
            .collect();
        let quantile = "linear between order statistics: position q (n - 1) from the smallest";
        Self {
            particles: args.shared.particles,
            seeds: args.seeds,
            quantile,
            folders,
            overall,
            errors,
        }
    }
}

impl Overall {
    /// `None` where the variant ran on no folder.
    fn new(variant: Variant, folders: &[FolderResult]) -> Option<Self> {
        let entries = folders
            .iter()
            .flat_map(|folder| &folder.methods)
            .filter(|entry| entry.variant == variant);
        let scores: Vec<ShownScores> = entries.map(|entry| entry.scores).collect();
        let (median, p90) = (
            ShownScores::quantile(&scores, 0.5),
            ShownScores::quantile(&scores, 0.9),
        );
        let result = Self {
            variant,
            method: variant.key(),
            folders: scores.len(),
            median,
            p90,
            unsolved: median.unsolved,
        };
        (!scores.is_empty()).then_some(result)
    }
}
