//! Best simple method of a comparison against the particle filter: [`BestBaseline`].

use std::fmt;

use serde::Serialize;
use stickslip::Method;
use stickslip_evaluation::{PairedDifference, Variant, quantile};

use super::results::FolderResult;

/// Ratio of median errors up to which two methods are level.
const LEVEL: f64 = 1.1;

/// Baseline with the lowest median error, and the particle filter on the same folders.
#[derive(Clone, Debug, Serialize)]
pub struct BestBaseline {
    /// The baseline.
    #[serde(skip)]
    variant: Variant,
    /// Its name in JSON.
    method: &'static str,
    /// Its median pose RMSE (mm).
    median_mm: f64,
    /// Median pose RMSE of the particle filter (mm).
    particle_median_mm: f64,
    /// Median over folders of the particle filter's error minus the baseline's (mm).
    difference_mm: f64,
    /// Distribution-free 95 % interval of that median (mm); `None` below six folders.
    interval_mm: Option<[f64; 2]>,
    /// Folders in which the particle filter is nearer.
    particle_nearer: usize,
    /// Folders with both.
    folders: usize,
}

impl BestBaseline {
    /// `None` without a scored particle filter and a scored baseline.
    pub fn of(folders: &[FolderResult]) -> Option<Self> {
        let baselines = Variant::COMPARED
            .into_iter()
            .filter(|variant| variant.method() != Method::Particle && !variant.camera_on());
        let all = baselines.filter_map(|variant| Self::against(variant, folders));
        // medians over fewer folders do not compare
        let all: Vec<Self> = all.collect();
        let most = all.iter().map(|baseline| baseline.folders).max()?;
        let all = all.into_iter().filter(|baseline| baseline.folders == most);
        all.min_by(|a, b| a.median_mm.total_cmp(&b.median_mm))
    }

    fn against(variant: Variant, folders: &[FolderResult]) -> Option<Self> {
        let error = |folder: &FolderResult, variant| folder.scores(variant)?.wmse_mm;
        let pairs = folders.iter().filter_map(|folder| {
            Some((error(folder, Variant::Particle)?, error(folder, variant)?))
        });
        let (particle, baseline): (Vec<f64>, Vec<f64>) = pairs.unzip();
        let difference = PairedDifference::of(&particle, &baseline)?;
        let nearer = particle.iter().zip(&baseline).filter(|(p, b)| p < b);
        Some(Self {
            variant,
            method: variant.key(),
            median_mm: quantile(&baseline, 0.5)?,
            particle_median_mm: quantile(&particle, 0.5)?,
            difference_mm: difference.median,
            interval_mm: difference.interval,
            particle_nearer: nearer.count(),
            folders: difference.pairs,
        })
    }

    /// "beats", "is level with" or "is worse than": the particle filter against the baseline.
    fn verdict(&self) -> &'static str {
        let [low, high] = [LEVEL * self.particle_median_mm, LEVEL * self.median_mm];
        match self.interval_mm {
            Some([_, most]) if most < 0.0 => "beats",
            Some([least, _]) if least > 0.0 => "is worse than",
            None if self.median_mm > low => "beats",
            None if self.particle_median_mm > high => "is worse than",
            _ => "is level with",
        }
    }
}

impl fmt::Display for BestBaseline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "The particle filter {} the best simple method here, the {}: {:.2} against {:.2} mm",
            self.verdict(),
            self.variant.title(),
            self.particle_median_mm,
            self.median_mm
        )?;
        match (self.interval_mm, self.folders) {
            (_, 1) => write!(f, ", one experiment."),
            (Some([low, high]), folders) => write!(
                f,
                " in the median, nearer in {} of {folders}; median difference {:+.2} mm, 95 % interval {low:+.2} to {high:+.2}.",
                self.particle_nearer, self.difference_mm
            ),
            (None, folders) => write!(
                f,
                " in the median, nearer in {} of {folders}; too few experiments for a test.",
                self.particle_nearer
            ),
        }
    }
}
