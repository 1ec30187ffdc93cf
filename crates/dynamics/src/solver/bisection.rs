//! Search along a line or curve by halving it: [`bisect`].

use crate::solver::interval::Interval;
use crate::solver::scalar_ncp::Candidate;

/// Widths of pieces below which their candidates are tried (m/s, relative where above 1). Where an
/// object creeps, only the middle of a narrow piece is near the solution.
const WIDTHS: [f64; 3] = [1e-5, 1e-8, 1e-11];

/// Candidates of one line or curve tried at each of these widths; neighbouring pieces differ
/// little, so that more would not help.
const ATTEMPTS: u32 = 6;

/// Width at which a piece is not halved any more.
const NARROWEST: f64 = 1e-12;

/// Refines a candidate and says whether it is a certified solution.
pub type Accept<'a> = dyn FnMut(&Candidate) -> bool + 'a;

/// What is known of a subset of generators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    /// It has no solution.
    Excluded,
    /// A candidate was accepted.
    Solved,
    /// Neither.
    Unclear,
}

impl Finding {
    /// Of a mode whose only candidate was accepted or not.
    pub fn of_candidate(accepted: bool) -> Self {
        if accepted {
            Self::Solved
        } else {
            Self::Unclear
        }
    }
}

/// What is known of one piece of a line or curve.
pub enum Piece {
    /// It has no solution.
    Excluded,
    /// It may have one near this.
    Candidate(Candidate),
}

/// Halves the whole interval until every piece is excluded or a candidate is accepted; gives up
/// after `max_pieces`.
pub fn bisect(
    whole: Interval,
    max_pieces: usize,
    examine: &mut dyn FnMut(Interval) -> Piece,
    accept: &mut Accept<'_>,
) -> Finding {
    let mut stack = vec![whole];
    let mut finding = Finding::Excluded;
    let mut attempts = [ATTEMPTS; WIDTHS.len()];
    let mut budget = max_pieces;
    while let Some(piece) = stack.pop() {
        if budget == 0 {
            return Finding::Unclear;
        }
        budget -= 1;
        let Piece::Candidate(candidate) = examine(piece) else {
            continue;
        };
        // a few candidates are tried at each width
        let Interval { low, high } = piece;
        let width = (high - low) / (1.0 + low.abs().max(high.abs()));
        let narrowest = WIDTHS.iter().rposition(|limit| width < *limit);
        if let Some(left) = narrowest.map(|k| &mut attempts[k])
            && *left > 0
        {
            *left -= 1;
            if accept(&candidate) {
                return Finding::Solved;
            }
        }
        // the lower half is next
        if width < NARROWEST {
            finding = Finding::Unclear;
            continue;
        }
        let middle = piece.midpoint();
        stack.push(Interval { low: middle, high });
        stack.push(Interval { low, high: middle });
    }
    finding
}
