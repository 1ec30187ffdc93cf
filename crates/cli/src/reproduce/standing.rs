//! The paper's order of two methods, and ours: [`Standing`].

use serde::Serialize;
use stickslip::{Direction, PairedDifference};

use super::participant::Participant;
use super::reasons::reason;

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
    /// The better one's WMSE less the worse one's, mean over seeds (mm).
    pub difference_mm: f64,
    /// Standard error of that mean (mm); null for a single seed.
    pub standard_error_mm: f64,
    /// What became of the order.
    pub finding: Finding,
    /// Why, where it does not hold and the cause is known.
    pub why: Option<&'static str>,
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
    /// All pairs of a row that is called `title`, the best of the paper first.
    pub fn all(title: &str, entrants: &[Entrant]) -> Vec<Self> {
        let mut ranked: Vec<&Entrant> = entrants.iter().collect();
        ranked.sort_by(|a, b| a.paper_mm.total_cmp(&b.paper_mm));
        let pairs = ranked.iter().enumerate().flat_map(|(k, better)| ranked[k + 1..].iter().map(move |worse| (better, worse)));
        pairs.filter_map(|(better, worse)| Self::of(title, better, worse)).collect()
    }

    fn of(title: &str, better: &Entrant, worse: &Entrant) -> Option<Self> {
        let difference = PairedDifference::of(&better.scores, &worse.scores)?;
        let finding = match difference.direction(CLEAR) {
            Direction::Below => Finding::Holds,
            Direction::Unclear => Finding::Unclear,
            Direction::Above => Finding::Reversed,
        };
        let why = (finding != Finding::Holds).then(|| reason(title, better.participant, worse.participant)).flatten();
        Some(Self {
            better: better.participant.key(),
            worse: worse.participant.key(),
            paper_mm: [better.paper_mm, worse.paper_mm],
            difference_mm: difference.mean,
            standard_error_mm: difference.standard_error,
            finding,
            why,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::participant::{KALMAN, NOMINAL, TACTILE};
    use super::*;

    fn entrant(participant: Participant, paper_mm: f64, scores: [f64; 4]) -> Entrant {
        Entrant { participant, paper_mm, scores: scores.to_vec() }
    }

    #[test]
    fn standings_compare_seed_by_seed_in_the_papers_order() {
        let rows = [
            entrant(NOMINAL, 4.0, [2.0, 12.0, 22.0, 32.0]),
            entrant(KALMAN, 17.0, [1.0, 11.1, 21.0, 31.0]),
            entrant(TACTILE, 0.2, [2.5, 3.0, 30.0, 33.0]),
        ];
        let standings = Standing::all("none", &rows);
        let order: Vec<[&str; 2]> = standings.iter().map(|s| [s.better, s.worse]).collect();
        assert_eq!(order, [["particle_tactile", "nominal"], ["particle_tactile", "kalman"], ["nominal", "kalman"]]);
        // the large spread over seeds is shared by both, so the small difference counts
        assert_eq!(standings[2].finding, Finding::Reversed);
        assert!((standings[2].difference_mm - 0.975).abs() < 1e-12 && (standings[2].standard_error_mm - 0.025).abs() < 1e-12);
        assert_eq!((standings[0].finding, standings[1].finding), (Finding::Unclear, Finding::Unclear));
        assert_eq!(standings[0].paper_mm, [0.2, 4.0]);
    }

    #[test]
    fn standing_of_one_seed_is_unclear() {
        let rows = [NOMINAL, KALMAN].map(|participant| Entrant { participant, paper_mm: 1.0, scores: vec![3.0] });
        assert_eq!(Standing::all("none", &rows)[0].finding, Finding::Unclear);
    }
}
