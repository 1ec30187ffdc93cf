//! Search along a line or curve by halving it: [`search_path`].

use crate::ncp::report::TOLERANCE;
use crate::solver::exhaustive::certifier::Certifier;
use crate::solver::exhaustive::generator::Generator;
use crate::solver::exhaustive::interval::Interval;
use crate::solver::exhaustive::mode_conditions::ModeConditions;
use crate::solver::exhaustive::scalar_ncp::Candidate;
use crate::solver::vector::Vector;

/// Widths of pieces below which their middles are tried (m/s, relative where above 1). Where an
/// object creeps, only the middle of a narrow piece is near the solution.
pub const WIDTHS: [f64; 3] = [1e-5, 1e-8, 1e-11];

/// The root of a piece is sought again once the piece is by so much narrower.
const NARROWER: f64 = 1e-3;

/// Width at which a piece is not halved any more.
pub const NARROWEST: f64 = 1e-12;

/// Miss up to which a point is a root (m/s).
const ROOT: f64 = 1e-11;

/// Most steps of the search for a root.
const ROOT_STEPS: u32 = 40;

/// Ends of lines, curves and planes (m/s): no impulse or speed is so large.
pub const FARTHEST: f64 = 1e6;

/// Thoroughness of the search of a line or curve.
#[derive(Clone, Copy, Debug)]
pub struct Thoroughness {
    /// Most pieces.
    pub pieces: u32,
    /// Width of pieces below which it gives up (m/s, relative where above 1).
    pub gives_up: f64,
    /// Roots that are refined, and middles of pieces at each width; neighbouring pieces differ
    /// little, so that more than some do not help.
    pub attempts: u32,
    /// Candidates of all lines and curves that are refined at the same V: where all gaps close
    /// together, most modes have the same.
    pub patience: u32,
    /// True if pieces are excluded by balances, too: some linear systems for each.
    pub separates: bool,
    /// True if candidates that fail are tried with other impulses, too, where feet stand.
    pub stands: bool,
}

/// Result for a subset of generators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    /// It has no solution.
    Excluded,
    /// A candidate was certified.
    Solved,
    /// Neither.
    Unclear,
}

impl Finding {
    /// Of a mode whose only candidate was certified or not.
    pub fn of_candidate(certified: bool) -> Self {
        if certified {
            Self::Solved
        } else {
            Self::Unclear
        }
    }
}

/// A point of a line or curve.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Its place.
    pub x: f64,
    /// V there.
    pub v: Vector<4>,
    /// Impulses of the feet.
    pub feet: [[f64; 2]; 3],
    /// Residual of the last condition: zero at a solution.
    pub miss: f64,
    /// Error of V (m/s).
    pub error: f64,
    /// Linear systems that it took.
    pub systems: u32,
}

/// A line or curve on which V meets all conditions of a mode but one.
pub trait ModePath {
    /// The point at x.
    fn sample(&mut self, x: f64) -> Sample;

    /// Returns true if there is no solution between two points.
    fn excludes(&self, a: &Sample, b: &Sample) -> bool;

    /// The mode's conditions and generators, where balances say more of it.
    fn balanced(&self) -> Option<(&ModeConditions, &[Generator])> {
        None
    }

    /// Returns true if there is no solution between two points, by balances.
    fn separates(&self, a: &Sample, b: &Sample, certifier: &mut Certifier<'_>) -> bool {
        self.balanced().is_some_and(|(conditions, chosen)| {
            conditions.separates(chosen, &[a.v, b.v], certifier)
        })
    }

    /// A point with the impulses of the mode.
    fn candidate(&self, at: &Sample) -> Candidate;

    /// Candidate with impulses that balance the load where feet stand, if others are known.
    fn standing_candidate(&self, at: &Sample, certifier: &mut Certifier<'_>) -> Option<Candidate> {
        let (conditions, chosen) = self.balanced()?;
        conditions.standing_candidate(chosen, &at.v, certifier)
    }
}

/// Searches a line or curve as far as solutions are sought.
pub fn search_path(
    Interval { low, high }: Interval,
    path: &mut impl ModePath,
    thoroughness: Thoroughness,
    certifier: &mut Certifier<'_>,
) -> Finding {
    let whole = Interval {
        low: low.max(-FARTHEST),
        high: high.min(FARTHEST),
    };
    if whole.is_empty() {
        return Finding::Excluded;
    }
    search_pieces(whole, thoroughness, path, certifier)
}

/// Halves the whole interval until every piece is excluded or a candidate is certified; gives up
/// after so many pieces, or where no work is left.
fn search_pieces(
    whole: Interval,
    thoroughness: Thoroughness,
    path: &mut impl ModePath,
    certifier: &mut Certifier<'_>,
) -> Finding {
    let sample = |path: &mut _, x: f64, certifier: &mut Certifier<'_>| -> Sample {
        let at = ModePath::sample(path, x);
        certifier.spend(at.systems);
        at
    };
    let ends = [whole.low, whole.high].map(|x| sample(path, x, certifier));
    let mut stack = vec![ends];
    let mut finding = Finding::Excluded;
    let mut left = Attempts::new(thoroughness.attempts);
    for piece in 0.. {
        let Some([a, b]) = stack.pop() else {
            break;
        };
        if piece == thoroughness.pieces || certifier.left() == 0 {
            return Finding::Unclear;
        }
        if path.excludes(&a, &b) || thoroughness.separates && path.separates(&a, &b, certifier) {
            continue;
        }
        let width = (b.x - a.x) / (1.0 + a.x.abs().max(b.x.abs()));
        // the root where the last condition changes its sign
        if a.miss * b.miss <= 0.0 && left.takes_root(&a, &b, width) {
            let root = root(path, a, b, certifier);
            if solves(path, &root, thoroughness, certifier) {
                return Finding::Solved;
            }
            left.failed_root = (root.x, width);
        }
        // the middle of a narrow piece, or where the condition holds all along
        let middle = sample(path, 0.5 * (a.x + b.x), certifier);
        if left.takes_middle(&middle, width) && solves(path, &middle, thoroughness, certifier) {
            return Finding::Solved;
        }
        // where the condition hardly fails, or touches zero, the point itself may do: steps towards a root lead away
        if width < WIDTHS[0]
            && middle.miss.abs() <= TOLERANCE
            && certifier.accepts(&path.candidate(&middle))
        {
            return Finding::Solved;
        }
        // the lower half is next
        if width < NARROWEST {
            finding = Finding::Unclear;
            continue;
        }
        if width < thoroughness.gives_up {
            return Finding::Unclear;
        }
        stack.push([middle, b]);
        stack.push([a, middle]);
    }
    finding
}

/// Returns true if a point refines to a certified solution.
fn solves(
    path: &impl ModePath,
    at: &Sample,
    thoroughness: Thoroughness,
    certifier: &mut Certifier<'_>,
) -> bool {
    certifier.certifies(&path.candidate(at))
        || thoroughness.stands
            && path
                .standing_candidate(at, certifier)
                .is_some_and(|candidate| certifier.certifies(&candidate))
}

/// Candidates of a line or curve that may still be refined.
struct Attempts {
    roots: u32,
    /// Middles of pieces of each width.
    middles: [u32; WIDTHS.len()],
    /// The last root that was none of the problem's solutions.
    /// and the width of its piece.
    failed_root: (f64, f64),
}

impl Attempts {
    fn new(each: u32) -> Self {
        Self {
            roots: each,
            middles: [each; WIDTHS.len()],
            failed_root: (f64::NAN, 0.0),
        }
    }

    /// Decides whether to refine the root of a piece, and counts it: not where that is the one that
    /// failed.
    fn takes_root(&mut self, a: &Sample, b: &Sample, width: f64) -> bool {
        let (root, of_width) = self.failed_root;
        let known = width > NARROWER * of_width && (a.x..=b.x).contains(&root);
        !known && take(&mut self.roots)
    }

    /// Decides whether to refine the middle of a piece, and counts it.
    fn takes_middle(&mut self, middle: &Sample, width: f64) -> bool {
        match WIDTHS.iter().rposition(|limit| width < *limit) {
            Some(k) => take(&mut self.middles[k]),
            None => middle.miss.abs() <= ROOT && take(&mut self.roots),
        }
    }
}

/// Counts one down; whether there was one.
fn take(left: &mut u32) -> bool {
    let any = *left > 0;
    *left = left.saturating_sub(1);
    any
}

/// Between two points that miss the last condition to opposite sides, one that meets it: false
/// position, with the miss of an end that stays halved (the Illinois algorithm).
fn root(
    path: &mut impl ModePath,
    mut a: Sample,
    mut b: Sample,
    certifier: &mut Certifier<'_>,
) -> Sample {
    for _ in 0..ROOT_STEPS {
        let size = a.x.abs().max(b.x.abs());
        if a.miss == b.miss || (b.x - a.x).abs() <= 1e-15 * size {
            break;
        }
        let x = (a.x * b.miss - b.x * a.miss) / (b.miss - a.miss);
        let between = path.sample(x.clamp(a.x.min(b.x), a.x.max(b.x)));
        certifier.spend(between.systems);
        if between.miss.abs() <= f64::max(1e-14 * size, 1e-3 * ROOT) {
            return between;
        }
        if between.miss * b.miss < 0.0 {
            a = b;
        } else {
            a.miss *= 0.5;
        }
        b = between;
    }
    b
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::solver::exhaustive::certifier::{Effort, Judged};

    /// The line V = (x, 0, 0, 0), 0 ≤ x ≤ 6, with the condition sin(x) = level.
    struct Wave {
        level: f64,
    }

    impl Wave {
        fn miss(&self, x: f64) -> f64 {
            libm::sin(x) - self.level
        }
    }

    impl ModePath for Wave {
        fn sample(&mut self, x: f64) -> Sample {
            Sample {
                x,
                v: [x, 0.0, 0.0, 0.0],
                feet: [[0.0; 2]; 3],
                miss: self.miss(x),
                error: 0.0,
                systems: 1,
            }
        }

        fn excludes(&self, a: &Sample, b: &Sample) -> bool {
            let is_inside = |extremum: &f64| (a.x..=b.x).contains(extremum);
            let extrema = [FRAC_PI_2, 3.0 * FRAC_PI_2].into_iter().filter(is_inside);
            let misses = || extrema.clone().chain([a.x, b.x]).map(|x| self.miss(x));
            misses().all(|miss| miss > TOLERANCE) || misses().all(|miss| miss < -TOLERANCE)
        }

        fn candidate(&self, at: &Sample) -> Candidate {
            Candidate {
                v: at.v,
                ..Candidate::default()
            }
        }
    }

    const THOROUGH: Thoroughness = Thoroughness {
        pieces: 10_000,
        gives_up: 0.0,
        attempts: 6,
        patience: u32::MAX,
        separates: false,
        stands: false,
    };

    fn search(level: f64, limit: u32) -> (Finding, Vec<f64>) {
        let mut tried = Vec::new();
        let mut judge = |candidate: &Candidate, effort| {
            let x = candidate.v[0];
            // only the second root is a solution
            let certified = match effort {
                Effort::AsItIs => x > 1.5 && Wave { level }.miss(x).abs() <= TOLERANCE,
                Effort::Refine => {
                    tried.push(x);
                    (x - (PI - libm::asin(level))).abs() < 1e-9
                }
            };
            Judged {
                certified,
                systems: 1,
            }
        };
        let whole = Interval {
            low: 0.0,
            high: 6.0,
        };
        let mut certifier = Certifier::new(&mut judge, limit);
        let finding = search_pieces(whole, THOROUGH, &mut Wave { level }, &mut certifier);
        (finding, tried)
    }

    #[test]
    fn second_root_is_found_where_the_first_is_no_solution() {
        let (finding, tried) = search(0.5, 100_000);
        assert_eq!(finding, Finding::Solved, "{tried:?}");
    }

    /// No step towards a root ends at one, but some points meet the condition within the tolerance.
    #[test]
    fn condition_that_is_nearly_met_is_solved_where_it_is() {
        assert_eq!(search(1.0 + 0.5 * TOLERANCE, 10_000).0, Finding::Solved);
        assert_eq!(search(1.0 + 1.5 * TOLERANCE, 10_000).0, Finding::Excluded);
    }

    #[test]
    fn condition_that_no_point_meets_is_excluded() {
        assert_eq!(search(1.2, 10_000).0, Finding::Excluded);
    }

    #[test]
    fn search_without_work_left_is_unclear() {
        assert_eq!(search(0.5, 5).0, Finding::Unclear);
    }
}
