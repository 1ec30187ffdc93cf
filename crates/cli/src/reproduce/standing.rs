//! The paper's order of two methods, and ours: [`Standing`].

use serde::Serialize;
use stickslip::{Direction, PairedDifference};

use super::participant::Participant;

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

/// Two methods of a row that the paper puts in an order.
#[derive(Clone, Debug, Serialize)]
pub struct Standing {
    /// The better one in the paper.
    pub better: &'static str,
    /// The worse one there.
    pub worse: &'static str,
    /// Their numbers there (mm).
    pub paper_mm: [f64; 2],
    /// The better one's WMSE less the worse one's, median over seeds (mm).
    pub difference_mm: f64,
    /// Standard error of that median (mm); null for fewer than six seeds.
    pub standard_error_mm: f64,
    /// What became of the order.
    pub finding: Finding,
}

/// A method in a row: its number in the paper and its scores by seed (mm).
#[derive(Clone, Debug)]
pub struct Entrant {
    /// The method.
    pub participant: Participant,
    /// Its number in the paper.
    pub paper_mm: f64,
    /// Its scores, seed by seed.
    pub scores: Vec<f64>,
}

impl Standing {
    /// All pairs of a row, the best of the paper first.
    pub fn all(entrants: &[Entrant]) -> Vec<Self> {
        let mut ranked: Vec<&Entrant> = entrants.iter().collect();
        ranked.sort_by(|a, b| a.paper_mm.total_cmp(&b.paper_mm));
        let pairs = ranked
            .iter()
            .enumerate()
            .flat_map(|(k, better)| ranked[k + 1..].iter().map(move |worse| (better, worse)));
        pairs
            .filter_map(|(better, worse)| Self::of(better, worse))
            .collect()
    }

    fn of(better: &Entrant, worse: &Entrant) -> Option<Self> {
        let difference = PairedDifference::of(&better.scores, &worse.scores)?;
        let finding = match difference.direction(CLEAR) {
            Direction::Below => Finding::Holds,
            Direction::Unclear => Finding::Unclear,
            Direction::Above => Finding::Reversed,
        };
        Some(Self {
            better: better.participant.key(),
            worse: worse.participant.key(),
            paper_mm: [better.paper_mm, worse.paper_mm],
            difference_mm: difference.median,
            standard_error_mm: difference.standard_error,
            finding,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::participant::{KALMAN, NOMINAL, TACTILE};
    use super::*;

    fn entrant(participant: Participant, paper_mm: f64, score: impl Fn(usize) -> f64) -> Entrant {
        Entrant {
            participant,
            paper_mm,
            scores: (0..8).map(score).collect(),
        }
    }

    #[test]
    fn standings_compare_seed_by_seed_in_the_papers_order() {
        // the large spread over seeds is shared by two of them, so their small difference counts
        let rows = [
            entrant(NOMINAL, 4.0, |seed| 10.0 * seed as f64 + 1.0),
            entrant(KALMAN, 17.0, |seed| 10.0 * seed as f64 + 0.01 * seed as f64),
            entrant(TACTILE, 0.2, |seed| 30.0 + (seed % 2) as f64),
        ];
        let standings = Standing::all(&rows);
        let order: Vec<[&str; 2]> = standings.iter().map(|s| [s.better, s.worse]).collect();
        assert_eq!(
            order,
            [
                ["particle_tactile", "nominal"],
                ["particle_tactile", "kalman"],
                ["nominal", "kalman"]
            ]
        );
        assert_eq!(standings[2].finding, Finding::Reversed);
        assert!(
            (standings[2].difference_mm - 0.965).abs() < 1e-12,
            "{standings:?}"
        );
        assert_eq!(
            (standings[0].finding, standings[1].finding),
            (Finding::Unclear, Finding::Unclear)
        );
        assert_eq!(standings[0].paper_mm, [0.2, 4.0]);
    }

    #[test]
    fn standing_of_one_seed_is_unclear() {
        let rows = [NOMINAL, KALMAN].map(|participant| Entrant {
            participant,
            paper_mm: 1.0,
            scores: vec![3.0],
        });
        assert_eq!(Standing::all(&rows)[0].finding, Finding::Unclear);
    }
}
