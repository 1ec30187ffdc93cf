//! Runs the solver over a corpus and counts how its problems ended, per family: [`survey`].

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;

use rayon::prelude::*;
use stickslip_dynamics::{Outcome, Report, Route, StepProblem, StepSolution, solve};

use crate::corpus::{Corpus, Family};
use crate::jam::is_solvable;
use crate::speed_limit::is_sought;

/// Outcomes of the problems of one family.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Problems.
    pub problems: u64,
    /// Solved by the Newton iteration, the smoothed path, the search over modes.
    pub solved: [u64; 3],
    /// Proven to have no solution.
    pub infeasible: u64,
    /// Indices of problems with neither.
    pub failed: Vec<u64>,
    /// Indices said to be infeasible although a solution is known to exist.
    pub contradicted: Vec<u64>,
    /// Largest residual of a solved problem, in m/s.
    pub worst_residual: f64,
}

impl Tally {
    /// The columns of its [`Display`](fmt::Display).
    pub const TITLES: &'static str =
        " problems    newton  smoothed   modes  infeasible  failed     residual";

    /// One step by its report; `index` names it should it have failed.
    #[must_use]
    pub fn of_report(index: u64, report: &Report) -> Self {
        let mut tally = Tally {
            problems: 1,
            ..Tally::default()
        };
        match report.outcome {
            Outcome::Solved => {
                tally.solved[index_of(report.route)] = 1;
                tally.worst_residual = report.residual;
            }
            Outcome::Infeasible => tally.infeasible = 1,
            Outcome::Failed => tally.failed.push(index),
        }
        tally
    }

    /// Counts the problems of another tally too.
    pub fn add(&mut self, other: Tally) {
        self.problems += other.problems;
        for (a, b) in self.solved.iter_mut().zip(other.solved) {
            *a += b;
        }
        self.infeasible += other.infeasible;
        self.failed.extend(other.failed);
        self.contradicted.extend(other.contradicted);
        self.worst_residual = self.worst_residual.max(other.worst_residual);
    }

    /// The problems of both.
    #[must_use]
    pub fn sum(mut self, other: Tally) -> Self {
        self.add(other);
        self
    }
}

/// Index of a route in [`Tally::solved`].
fn index_of(route: Route) -> usize {
    match route {
        Route::Newton => 0,
        Route::SmoothedPath => 1,
        Route::ModeSearch => 2,
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [newton, smoothed, modes] = self.solved;
        let (problems, infeasible, failed) = (self.problems, self.infeasible, self.failed.len());
        write!(
            f,
            "{problems:>9} {newton:>9} {smoothed:>9} {modes:>7} {infeasible:>11} {failed:>7} {:>12.1e}",
            self.worst_residual
        )
    }
}

/// Solves the problems of `range`; independent of the number of threads.
pub fn survey(corpus: &Corpus, range: Range<u64>) -> BTreeMap<Family, Tally> {
    let one = |index: u64| {
        let (problem, witness) = corpus.draw(index);
        BTreeMap::from([(
            corpus.family(index),
            judge(index, &problem, witness.as_ref()),
        )])
    };
    range.into_par_iter().map(one).reduce(BTreeMap::new, merged)
}

/// Solves problem `index` of a set from a cold start; `witness` is a solution of it, where one is
/// known.
#[must_use]
pub fn judge(index: u64, problem: &StepProblem, witness: Option<&StepSolution>) -> Tally {
    let (solution, report) = solve(problem);
    let mut tally = Tally::of_report(index, &report);
    if report.outcome == Outcome::Solved && !is_sought(problem, &solution) {
        tally.worst_residual = f64::INFINITY;
    }
    if report.outcome == Outcome::Infeasible {
        let known = witness.is_some_and(|witness| is_sought(problem, witness));
        let exists = known || is_solvable(problem);
        tally.contradicted.extend(exists.then_some(index));
    }
    tally
}

fn merged(
    mut all: BTreeMap<Family, Tally>,
    more: BTreeMap<Family, Tally>,
) -> BTreeMap<Family, Tally> {
    for (family, tally) in more {
        all.entry(family).or_default().add(tally);
    }
    all
}
