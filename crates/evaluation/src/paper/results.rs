//! The paper's tables with ours: [`Results`].

use serde::Serialize;

use super::comparison::{CLEAR, Finding, Measure, PairedComparison, SeedRuns};
use super::published::{PUBLISHED, PublishedRow, PublishedTable};
use super::run_set::RunSet;
use super::scenes::PaperExperiment;
use crate::run::ScoredRun;
use crate::statistics::{Band, Direction, PairedDifference};
use crate::variant::Variant;

/// Weighted RMSE under occlusion that the particle filter is to stay below (mm).
const TARGET_MM: f64 = 0.5;

/// Baselines of the particle filter under occlusion.
const BASELINES: [Variant; 3] = [Variant::Nominal, Variant::Kalman, Variant::ParticleNoTouch];

/// A variant's number in the paper next to ours.
#[derive(Clone, Debug, Serialize)]
pub struct Cell {
    /// The variant.
    #[serde(skip)]
    pub variant: Variant,
    /// Its name.
    pub method: &'static str,
    /// The paper's WMSE (mm).
    pub paper_mm: f64,
    /// Ours over all rows, as the paper's, over seeds (mm).
    pub wmse_mm: Band,
    /// The same, seed by seed (mm).
    #[serde(skip)]
    pub seeds_mm: Vec<f64>,
    /// Ours over the rows after the occlusion begins (mm).
    pub dark_mm: Band,
    /// Ours over all rows against the camera's own poses, as the paper scores (mm).
    pub camera_mm: Band,
    /// Particle-steps without a certified solution, over all seeds.
    pub unsolved: u64,
}

/// A row of a table.
#[derive(Clone, Debug, Serialize)]
pub struct ResultsRow {
    /// Its title.
    pub title: &'static str,
    /// Variants.
    pub cells: Vec<Cell>,
    /// The paper's order of each two of them.
    pub orderings: Vec<PairedComparison>,
}

/// A table.
#[derive(Clone, Debug, Serialize)]
pub struct ResultsTable {
    /// Its number.
    pub name: &'static str,
    /// Its rows.
    pub rows: Vec<ResultsRow>,
}

/// The particle filter with tactile data against another variant, after the occlusion begins.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct BaselineComparison {
    /// The other variant.
    #[serde(rename = "rival")]
    pub baseline: &'static str,
    /// Its weighted RMSE over seeds (mm).
    #[serde(rename = "rival_mm")]
    pub baseline_mm: Band,
    /// The particle filter's less the other's, median over seeds (mm).
    pub difference_mm: f64,
    /// Standard error of that median (mm); null for fewer than six seeds.
    pub standard_error_mm: f64,
    /// Below the other by more than [`CLEAR`] standard errors.
    pub better: bool,
    /// Above the other by more than them.
    pub worse: bool,
}

/// The particle filter with tactile data after the occlusion begins.
#[derive(Clone, Debug, Serialize)]
pub struct OcclusionResult {
    /// The experiment.
    pub experiment: &'static str,
    /// Its weighted RMSE over seeds (mm).
    pub wmse_mm: Band,
    /// Weighted RMSE by its own standard deviations (mm).
    pub spread_mm: Band,
    /// Weighted RMSE of the filter whose camera stays on (mm).
    pub camera_on_mm: Band,
    /// True if the median is below 0.5 mm.
    pub below_target: bool,
    /// Against the nominal simulation, the Kalman filter and the particle filter without tactile
    /// data.
    #[serde(rename = "margins")]
    pub baselines: Vec<BaselineComparison>,
}

/// All tables from one set of replicates.
#[derive(Clone, Debug, Serialize)]
pub struct Results {
    /// Tables II, III and IV.
    pub tables: Vec<ResultsTable>,
    /// All experiments under occlusion.
    #[serde(rename = "blackouts")]
    pub occlusions: Vec<OcclusionResult>,
}

/// A variant's medians from frames over those from poses.
#[derive(Clone, Debug, Serialize)]
pub struct Ratio {
    /// Title of the row.
    pub row: &'static str,
    /// The variant.
    pub method: &'static str,
    /// Weighted RMSE over all rows.
    pub wmse: f64,
    /// Weighted RMSE over the rows after the occlusion begins.
    pub dark: f64,
}

impl Results {
    /// The tables from all runs.
    ///
    /// # Panics
    /// If an experiment was not run, or not every row of one has a truth.
    #[must_use]
    pub fn new(run_sets: &[RunSet]) -> Self {
        let runs = AllRuns(run_sets);
        let table = |table: &PublishedTable| ResultsTable {
            name: table.name,
            rows: table.rows.iter().map(|row| runs.row(row)).collect(),
        };
        Self {
            tables: PUBLISHED.iter().map(table).collect(),
            occlusions: PaperExperiment::ALL
                .map(|paper| runs.occlusion(paper))
                .into(),
        }
    }

    /// Every order of the paper with the title of its row.
    pub fn orders(&self) -> impl Iterator<Item = (&'static str, &PairedComparison)> {
        let rows = self.tables.iter().flat_map(|table| &table.rows);
        rows.flat_map(|row| row.orderings.iter().map(|order| (row.title, order)))
    }

    /// Number of the paper's orders with a finding, by one measure.
    #[must_use]
    pub fn count(&self, measure: Measure, finding: Finding) -> usize {
        let orders = self.orders();
        orders
            .filter(|(_, order)| order.by(measure).finding == finding)
            .count()
    }

    fn cells(&self) -> impl Iterator<Item = (&'static str, &Cell)> {
        let rows = self.tables.iter().flat_map(|table| &table.rows);
        rows.flat_map(|row| row.cells.iter().map(|cell| (row.title, cell)))
    }
}

impl Ratio {
    /// The ratio in every cell.
    #[must_use]
    pub fn all(frames: &Results, poses: &Results) -> Vec<Self> {
        let pairs = frames.cells().zip(poses.cells());
        pairs
            .map(|((row, frames), (_, poses))| Self {
                row,
                method: frames.method,
                wmse: frames.wmse_mm.median / poses.wmse_mm.median,
                dark: frames.dark_mm.median / poses.dark_mm.median,
            })
            .collect()
    }
}

/// All runs, by experiment and variant.
struct AllRuns<'a>(&'a [RunSet]);

impl AllRuns<'_> {
    fn runs(&self, paper: PaperExperiment, variant: Variant) -> impl Iterator<Item = &ScoredRun> {
        let own = self
            .0
            .iter()
            .filter(move |set| set.replicate.paper == paper);
        own.filter_map(move |set| set.run(variant))
    }

    /// A variant's scores over the rows after the occlusion begins, seed by seed (mm).
    fn dark_scores(&self, paper: PaperExperiment, variant: Variant) -> Vec<f64> {
        let runs = self.runs(paper, variant);
        runs.map(|run| Measure::DarkRows.score(run)).collect()
    }

    fn row(&self, row: &PublishedRow) -> ResultsRow {
        let paper = row.experiment;
        let runs = |(variant, paper_mm): &(Variant, f64)| SeedRuns {
            variant: *variant,
            paper_mm: *paper_mm,
            runs: self.runs(paper, *variant).collect(),
        };
        let runs: Vec<SeedRuns<'_>> = row.cells.iter().map(runs).collect();
        let cell = |own: &SeedRuns<'_>| {
            let seeds_mm = own.scores(Measure::AllRows);
            Cell {
                variant: own.variant,
                method: own.variant.paper_key(),
                paper_mm: own.paper_mm,
                wmse_mm: band(&seeds_mm),
                seeds_mm,
                dark_mm: band(&own.scores(Measure::DarkRows)),
                camera_mm: band(&own.scores(Measure::CameraPoses)),
                unsolved: own.runs.iter().map(|run| run.unsolved).sum(),
            }
        };
        ResultsRow {
            title: row.title,
            cells: runs.iter().map(cell).collect(),
            orderings: PairedComparison::all(&runs),
        }
    }

    fn occlusion(&self, paper: PaperExperiment) -> OcclusionResult {
        let own = self.dark_scores(paper, Variant::Particle);
        let spreads: Vec<f64> = self
            .runs(paper, Variant::Particle)
            .filter_map(|run| run.scores.spread_occluded_mm)
            .collect();
        let wmse_mm = band(&own);
        let against =
            |baseline: Variant| against(baseline, &own, &self.dark_scores(paper, baseline));
        OcclusionResult {
            experiment: paper.name(),
            wmse_mm,
            spread_mm: band(&spreads),
            camera_on_mm: band(&self.dark_scores(paper, Variant::ParticleCameraOn)),
            below_target: wmse_mm.median < TARGET_MM,
            baselines: BASELINES.map(against).into(),
        }
    }
}

/// The scores of the particle filter against those of another variant with the same seeds.
fn against(baseline: Variant, own: &[f64], theirs: &[f64]) -> BaselineComparison {
    let difference = PairedDifference::of(own, theirs).expect(ONE_SEED);
    let direction = difference.direction(CLEAR);
    BaselineComparison {
        baseline: baseline.paper_key(),
        baseline_mm: band(theirs),
        difference_mm: difference.median,
        standard_error_mm: difference.standard_error,
        better: direction == Direction::Below,
        worse: direction == Direction::Above,
    }
}

const ONE_SEED: &str = "there is at least one seed";

fn band(scores: &[f64]) -> Band {
    Band::of(scores).expect(ONE_SEED)
}
