//! Methods next to each other on equal sets of folders: [`FolderSet`].

use serde::Serialize;
use stickslip_evaluation::{PairedDifference, Variant};

use super::results::{FolderResult, ShownScores};

/// Folders, and the methods that ran on all of them.
#[derive(Clone, Debug, Serialize)]
pub struct FolderSet {
    /// The folders.
    pub folders: Vec<String>,
    /// Each method over these folders.
    pub methods: Vec<Overall>,
}

/// Scores of one variant over a set of folders.
#[derive(Clone, Debug, Serialize)]
pub struct Overall {
    /// The variant.
    #[serde(skip)]
    pub variant: Variant,
    /// Its name in JSON.
    pub method: &'static str,
    /// Medians over folders.
    pub median: ShownScores,
    /// 90th percentiles over folders.
    pub p90: ShownScores,
    /// Means over folders.
    pub mean: ShownScores,
    /// Pose RMSE minus that of the particle filter; `None` for the particle filter.
    pub difference: Option<Difference>,
}

/// Paired difference of two methods' pose RMSE.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Difference {
    /// Median over folders (mm); positive where the particle filter is nearer.
    pub median_mm: f64,
    /// Standard error of that median (mm); `None` below six folders.
    pub standard_error_mm: Option<f64>,
}

impl FolderSet {
    /// One set for each different list of folders that some variant ran on, the largest first.
    ///
    /// All methods run on most logs. A log without touch sensors, say, has no filter without touch.
    pub fn all(folders: &[FolderResult]) -> Vec<Self> {
        let ran = |variant: Variant| -> Vec<usize> {
            let has = |k: &usize| folders[*k].scores(variant).is_some();
            (0..folders.len()).filter(has).collect()
        };
        let mut sets: Vec<Vec<usize>> = Variant::COMPARED.into_iter().map(ran).collect();
        sets.retain(|set| !set.is_empty());
        // equal sets side by side, so that each is there once
        sets.sort_by(|a, b| b.len().cmp(&a.len()).then(a.cmp(b)));
        sets.dedup();
        let set = |set: Vec<usize>| {
            let folders: Vec<&FolderResult> = set.into_iter().map(|k| &folders[k]).collect();
            let methods = Variant::COMPARED.into_iter();
            Self {
                methods: methods
                    .filter_map(|variant| Overall::new(variant, &folders))
                    .collect(),
                folders: folders.iter().map(|result| result.folder.clone()).collect(),
            }
        };
        sets.into_iter().map(set).collect()
    }
}

impl Overall {
    /// `None` unless the variant ran on all of the folders.
    fn new(variant: Variant, folders: &[&FolderResult]) -> Option<Self> {
        let of = |variant| -> Option<Vec<ShownScores>> {
            folders
                .iter()
                .map(|folder| folder.scores(variant))
                .collect()
        };
        let scores = of(variant)?;
        let filter = of(Variant::Particle).filter(|_| variant != Variant::Particle);
        Some(Self {
            variant,
            method: variant.key(),
            median: ShownScores::quantile(&scores, 0.5),
            p90: ShownScores::quantile(&scores, 0.9),
            mean: ShownScores::mean(&scores),
            difference: filter.and_then(|filter| Difference::of(&scores, &filter)),
        })
    }
}

impl Difference {
    /// `None` where no folder has both scores.
    fn of(scores: &[ShownScores], filter: &[ShownScores]) -> Option<Self> {
        let pairs = scores.iter().zip(filter);
        let (own, filter): (Vec<f64>, Vec<f64>) = pairs
            .filter_map(|(own, filter)| own.wmse_mm.zip(filter.wmse_mm))
            .unzip();
        let difference = PairedDifference::of(&own, &filter)?;
        Some(Self {
            median_mm: difference.median,
            standard_error_mm: Some(difference.standard_error).filter(|error| error.is_finite()),
        })
    }
}
