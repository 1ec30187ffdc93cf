//! The paper's order of two variants, and ours: [`PairedComparison`].

use serde::Serialize;

use crate::run::ScoredRun;
use crate::statistics::{Direction, FEWEST_PAIRS, PairedDifference};
use crate::variant::Variant;

/// Standard errors that a difference must exceed to count.
pub const CLEAR: f64 = 2.0;

/// Reproduction of an order of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// By more than [`CLEAR`] standard errors.
    Holds,
    /// The difference is within them.
    Unclear,
    /// It is the other way round, by more than them.
    Reversed,
    /// So few seeds have no standard error.
    TooFewSeeds,
}

/// Scores by which two variants are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Over all rows, against the exact motion.
    AllRows,
    /// Over the rows after the occlusion begins, against the exact motion.
    DarkRows,
    /// Over all rows, against the camera's own poses: as the paper scores.
    CameraPoses,
}

/// The better one's scores less the worse one's, seed by seed.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Difference {
    /// Median over seeds (mm).
    pub difference_mm: f64,
    /// Standard error of that median (mm); null for fewer than six seeds.
    pub standard_error_mm: f64,
    /// Reproduction of the paper's order.
    pub finding: Finding,
}

/// Two variants of a row that the paper puts in an order, compared seed by seed.
#[derive(Clone, Debug, Serialize)]
pub struct PairedComparison {
    /// The better one in the paper.
    pub better: &'static str,
    /// The worse one there.
    pub worse: &'static str,
    /// Their numbers there (mm).
    pub paper_mm: [f64; 2],
    /// Over all rows.
    #[serde(flatten)]
    pub all_rows: Difference,
    /// Over the rows after the occlusion begins.
    pub dark_rows: Difference,
    /// Over all rows, against the camera's own poses.
    pub camera_poses: Difference,
}

/// A variant in a row: its number in the paper and its runs, seed by seed.
#[derive(Clone, Debug)]
pub(super) struct SeedRuns<'a> {
    pub variant: Variant,
    pub paper_mm: f64,
    pub runs: Vec<&'a ScoredRun>,
}

impl Finding {
    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Unclear => "unclear",
            Self::Reversed => "reversed",
            Self::TooFewSeeds => "too few seeds",
        }
    }
}

impl Measure {
    /// All, in the order of tables.
    pub const ALL: [Self; 3] = [Self::AllRows, Self::DarkRows, Self::CameraPoses];

    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::AllRows => "all rows",
            Self::DarkRows => "occluded rows",
            Self::CameraPoses => "against camera poses",
        }
    }

    /// A run's score (mm).
    ///
    /// # Panics
    /// If the run is of an experiment without truth, occlusion or pose.
    #[must_use]
    pub fn score(self, run: &ScoredRun) -> f64 {
        let score = match self {
            Self::AllRows => run.scores.wmse_mm,
            Self::DarkRows => run.scores.wmse_occluded_mm,
            Self::CameraPoses => run.camera_wmse_mm,
        };
        score.expect("a simulated experiment has a truth and a pose for every row")
    }
}

impl Difference {
    /// `None` without seeds.
    fn of(better: &SeedRuns<'_>, worse: &SeedRuns<'_>, measure: Measure) -> Option<Self> {
        let [a, b] = [better, worse].map(|own| own.scores(measure));
        let difference = PairedDifference::of(&a, &b)?;
        let finding = match difference.direction(CLEAR) {
            _ if difference.pairs < FEWEST_PAIRS => Finding::TooFewSeeds,
            Direction::Below => Finding::Holds,
            Direction::Unclear => Finding::Unclear,
            Direction::Above => Finding::Reversed,
        };
        Some(Self {
            difference_mm: difference.median,
            standard_error_mm: difference.standard_error,
            finding,
        })
    }
}

impl SeedRuns<'_> {
    /// One score, seed by seed (mm).
    pub fn scores(&self, measure: Measure) -> Vec<f64> {
        self.runs.iter().map(|run| measure.score(run)).collect()
    }
}

impl PairedComparison {
    /// All pairs of a row, the best of the paper first.
    pub(super) fn all(row: &[SeedRuns<'_>]) -> Vec<Self> {
        let mut ranked: Vec<&SeedRuns<'_>> = row.iter().collect();
        ranked.sort_by(|a, b| a.paper_mm.total_cmp(&b.paper_mm));
        let pairs = ranked
            .iter()
            .enumerate()
            .flat_map(|(k, better)| ranked[k + 1..].iter().map(move |worse| (better, worse)));
        pairs
            .filter_map(|(better, worse)| Self::of(better, worse))
            .collect()
    }

    fn of(better: &SeedRuns<'_>, worse: &SeedRuns<'_>) -> Option<Self> {
        let by = |measure: Measure| Difference::of(better, worse, measure);
        Some(Self {
            better: better.variant.paper_key(),
            worse: worse.variant.paper_key(),
            paper_mm: [better.paper_mm, worse.paper_mm],
            all_rows: by(Measure::AllRows)?,
            dark_rows: by(Measure::DarkRows)?,
            camera_poses: by(Measure::CameraPoses)?,
        })
    }

    /// The difference by one measure.
    #[must_use]
    pub fn by(&self, measure: Measure) -> &Difference {
        match measure {
            Measure::AllRows => &self.all_rows,
            Measure::DarkRows => &self.dark_rows,
            Measure::CameraPoses => &self.camera_poses,
        }
    }
}

#[cfg(test)]
mod tests {
    use stickslip::Estimate;

    use super::*;
    use crate::score::Scores;

    /// Runs whose scores over all rows are given, and twice as large over the occluded rows.
    fn runs(variant: Variant, seeds: usize, score: impl Fn(usize) -> f64) -> Vec<ScoredRun> {
        let run = |seed: usize| ScoredRun {
            variant,
            estimate: Estimate::default(),
            scores: Scores {
                wmse_mm: Some(score(seed)),
                wmse_occluded_mm: Some(2.0 * score(seed)),
                ..Scores::default()
            },
            camera_wmse_mm: Some(1.0),
            unsolved: 0,
            failed: 0,
            collapses: 0,
            log_evidence: None,
        };
        (0..seeds).map(run).collect()
    }

    fn row(paper_mm: f64, runs: &[ScoredRun]) -> SeedRuns<'_> {
        SeedRuns {
            variant: runs[0].variant,
            paper_mm,
            runs: runs.iter().collect(),
        }
    }

    #[test]
    fn pairs_compare_seed_by_seed_in_the_papers_order() {
        // the large spread over seeds is shared by two of them, so their small difference counts
        let nominal = runs(Variant::Nominal, 8, |seed| 10.0 * seed as f64 + 1.0);
        let kalman = runs(Variant::Kalman, 8, |seed| 10.01 * seed as f64);
        let particle = runs(Variant::Particle, 8, |seed| 30.0 + (seed % 2) as f64);
        let rows = [row(4.0, &nominal), row(17.0, &kalman), row(0.2, &particle)];
        let pairs = PairedComparison::all(&rows);
        let order: Vec<[&str; 2]> = pairs.iter().map(|pair| [pair.better, pair.worse]).collect();
        assert_eq!(
            order,
            [
                ["particle_tactile", "nominal"],
                ["particle_tactile", "kalman"],
                ["nominal", "kalman"]
            ]
        );
        let finding = |pair: usize| Measure::ALL.map(|measure| pairs[pair].by(measure).finding);
        assert_eq!(finding(2)[..2], [Finding::Reversed; 2]);
        assert_eq!(finding(0), [Finding::Unclear; 3]);
        let [all, dark, camera] = Measure::ALL.map(|measure| pairs[2].by(measure).difference_mm);
        assert!((all - 0.965).abs() < 1e-12 && (dark - 1.93).abs() < 1e-12 && camera == 0.0);
        assert_eq!(pairs[0].paper_mm, [0.2, 4.0]);
    }

    #[test]
    fn five_seeds_are_too_few_and_six_are_not() {
        for (seeds, finding) in [(5, Finding::TooFewSeeds), (6, Finding::Holds)] {
            let nominal = runs(Variant::Nominal, seeds, |_| 1.0);
            let kalman = runs(Variant::Kalman, seeds, |_| 3.0);
            let pairs = PairedComparison::all(&[row(1.0, &nominal), row(2.0, &kalman)]);
            assert_eq!(pairs[0].all_rows.finding, finding);
        }
    }
}
