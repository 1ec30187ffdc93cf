//! The paper's order of two variants, and ours: [`PairedComparison`].

use serde::Serialize;

use crate::statistics::{Direction, PairedDifference};
use crate::variant::Variant;

/// Standard errors that a difference must exceed to count.
pub const CLEAR: f64 = 2.0;

/// Whether an order of the paper is found again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// By more than [`CLEAR`] standard errors.
    Holds,
    /// The difference is within them.
    Unclear,
    /// It is the other way round, by more than them.
    Reversed,
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
    /// The better one's weighted RMSE less the worse one's, median over seeds (mm).
    pub difference_mm: f64,
    /// Standard error of that median (mm); null for fewer than six seeds.
    pub standard_error_mm: f64,
    /// What became of the order.
    pub finding: Finding,
}

/// A variant in a row: its number in the paper and its scores (mm), seed by seed.
#[derive(Clone, Debug)]
pub(super) struct SeedScores {
    pub variant: Variant,
    pub paper_mm: f64,
    pub scores: Vec<f64>,
}

impl PairedComparison {
    /// All pairs of a row, the best of the paper first.
    pub(super) fn all(row: &[SeedScores]) -> Vec<Self> {
        let mut ranked: Vec<&SeedScores> = row.iter().collect();
        ranked.sort_by(|a, b| a.paper_mm.total_cmp(&b.paper_mm));
        let pairs = ranked
            .iter()
            .enumerate()
            .flat_map(|(k, better)| ranked[k + 1..].iter().map(move |worse| (better, worse)));
        pairs
            .filter_map(|(better, worse)| Self::of(better, worse))
            .collect()
    }

    fn of(better: &SeedScores, worse: &SeedScores) -> Option<Self> {
        let difference = PairedDifference::of(&better.scores, &worse.scores)?;
        let finding = match difference.direction(CLEAR) {
            Direction::Below => Finding::Holds,
            Direction::Unclear => Finding::Unclear,
            Direction::Above => Finding::Reversed,
        };
        Some(Self {
            better: better.variant.paper_key(),
            worse: worse.variant.paper_key(),
            paper_mm: [better.paper_mm, worse.paper_mm],
            difference_mm: difference.median,
            standard_error_mm: difference.standard_error,
            finding,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scores(variant: Variant, paper_mm: f64, score: impl Fn(usize) -> f64) -> SeedScores {
        SeedScores {
            variant,
            paper_mm,
            scores: (0..8).map(score).collect(),
        }
    }

    #[test]
    fn pairs_compare_seed_by_seed_in_the_papers_order() {
        // the large spread over seeds is shared by two of them, so their small difference counts
        let rows = [
            scores(Variant::Nominal, 4.0, |seed| 10.0 * seed as f64 + 1.0),
            scores(Variant::Kalman, 17.0, |seed| {
                10.0 * seed as f64 + 0.01 * seed as f64
            }),
            scores(Variant::Particle, 0.2, |seed| 30.0 + (seed % 2) as f64),
        ];
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
        assert_eq!(pairs[2].finding, Finding::Reversed);
        assert!((pairs[2].difference_mm - 0.965).abs() < 1e-12, "{pairs:?}");
        assert_eq!(
            (pairs[0].finding, pairs[1].finding),
            (Finding::Unclear, Finding::Unclear)
        );
        assert_eq!(pairs[0].paper_mm, [0.2, 4.0]);
    }

    #[test]
    fn comparison_of_one_seed_is_unclear() {
        let rows = [Variant::Nominal, Variant::Kalman].map(|variant| SeedScores {
            variant,
            paper_mm: 1.0,
            scores: vec![3.0],
        });
        assert_eq!(PairedComparison::all(&rows)[0].finding, Finding::Unclear);
    }
}
