//! What a comparison found: [`Comparison`], per folder and over folders.

use std::path::Path;

use anyhow::Result;
use serde::Serialize;
use stickslip::{Scores, quantile};

use crate::args::CompareArgs;
use crate::contest::Rival;
use crate::failure::one_line;

/// The scores of one run, or their medians over runs.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Marks {
    /// WMSE over the hidden rows, over all rows where none is hidden (mm).
    pub wmse_mm: Option<f64>,
    /// WMSE while the object moves (mm).
    pub wmse_moving_mm: Option<f64>,
    /// Final position error (mm).
    pub final_error_mm: Option<f64>,
    /// Final angle error (degrees).
    pub final_error_deg: Option<f64>,
    /// Unsolved particle steps, summed over seeds.
    pub unsolved: u64,
}

/// One of the scores that are shown.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Title in tables.
    pub title: &'static str,
    /// The score.
    pub of: fn(&Marks) -> Option<f64>,
}

/// A rival's scores.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    /// The rival.
    #[serde(skip)]
    pub rival: Rival,
    /// Its name in JSON.
    pub method: &'static str,
    /// Its scores.
    #[serde(flatten)]
    pub marks: Marks,
}

/// The rivals' scores on one folder, medians over seeds.
#[derive(Clone, Debug, Serialize)]
pub struct FolderResult {
    /// The folder.
    pub folder: String,
    /// One entry per rival.
    pub methods: Vec<Entry>,
}

/// A folder that gave no result.
#[derive(Clone, Debug, Serialize)]
pub struct LostFolder {
    /// The folder.
    pub folder: String,
    /// Why, in one line.
    pub error: String,
}

/// A rival's median and 90th percentile over folders.
#[derive(Clone, Debug, Serialize)]
pub struct Overall {
    /// The rival.
    #[serde(skip)]
    pub rival: Rival,
    /// Its name in JSON.
    pub method: &'static str,
    /// Number of folders it ran on.
    pub folders: usize,
    /// Medians over folders.
    pub median: Marks,
    /// 90th percentiles over folders.
    pub p90: Marks,
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
        of: |marks| marks.wmse_mm,
    },
    Column {
        title: "moving mm",
        of: |marks| marks.wmse_moving_mm,
    },
    Column {
        title: "final mm",
        of: |marks| marks.final_error_mm,
    },
    Column {
        title: "final deg",
        of: |marks| marks.final_error_deg,
    },
];

impl Marks {
    /// The scores of one run.
    pub fn new(scores: &Scores, unsolved: u64) -> Self {
        Self {
            wmse_mm: scores.wmse_occluded_mm.or(scores.wmse_mm),
            wmse_moving_mm: scores.wmse_moving_mm,
            final_error_mm: scores.final_error_mm,
            final_error_deg: scores.final_error_deg,
            unsolved,
        }
    }

    /// The `q`-quantile of each score, and all unsolved steps.
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
        }
    }
}

impl Entry {
    /// The scores of a rival.
    pub fn new(rival: Rival, marks: Marks) -> Self {
        Self {
            rival,
            method: rival.key(),
            marks,
        }
    }
}

impl FolderResult {
    /// Medians over the runs of each rival; the first failed run is the folder's error.
    pub fn gather<'a>(
        folder: &Path,
        runs: impl Iterator<Item = (Rival, &'a Result<Marks>)>,
    ) -> Result<Self, &'a anyhow::Error> {
        let mut by_rival: Vec<(Rival, Vec<Marks>)> = Vec::new();
        for (rival, marks) in runs {
            let marks = *marks.as_ref()?;
            match by_rival.last_mut() {
                Some((last, all)) if *last == rival => all.push(marks),
                _ => by_rival.push((rival, vec![marks])),
            }
        }
        let methods = by_rival
            .into_iter()
            .map(|(rival, marks)| Entry::new(rival, Marks::quantile(&marks, 0.5)));
        Ok(Self {
            folder: folder.display().to_string(),
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
        let overall = Rival::ALL
            .into_iter()
            .filter_map(|rival| Overall::new(rival, &folders))
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
    /// `None` where the rival ran on no folder.
    fn new(rival: Rival, folders: &[FolderResult]) -> Option<Self> {
        let entries = folders
            .iter()
            .flat_map(|folder| &folder.methods)
            .filter(|entry| entry.rival == rival);
        let marks: Vec<Marks> = entries.map(|entry| entry.marks).collect();
        let (median, p90) = (Marks::quantile(&marks, 0.5), Marks::quantile(&marks, 0.9));
        let result = Self {
            rival,
            method: rival.key(),
            folders: marks.len(),
            median,
            p90,
            unsolved: median.unsolved,
        };
        (!marks.is_empty()).then_some(result)
    }
}
