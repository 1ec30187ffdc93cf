//! Runs the solver over a corpus and counts how its problems ended, per family: [`survey`].

use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;
use stickslip_dynamics::{Outcome, Route, solve};

use crate::{Corpus, Family, gap_margin, may_jam};

/// How the problems of one family ended.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Problems.
    pub problems: u64,
    /// Solved by the fast solver, the smoothed steps, the homotopy, the search over modes.
    pub solved: [u64; 4],
    /// Proven to have no solution.
    pub infeasible: u64,
    /// Indices of problems with neither.
    pub failed: Vec<u64>,
    /// Indices said to be infeasible although a solution is known to exist.
    pub contradicted: Vec<u64>,
    /// Largest residual of a solved problem, in m/s.
    pub worst_residual: f64,
}

/// Solves the problems of `range`; independent of the number of threads.
pub fn survey(corpus: &Corpus, range: Range<u64>) -> BTreeMap<Family, Tally> {
    let one = |index: u64| {
        let mut tallies = BTreeMap::new();
        tallies.insert(corpus.family(index), examine(corpus, index));
        tallies
    };
    range.into_par_iter().map(one).reduce(BTreeMap::new, merged)
}

fn examine(corpus: &Corpus, index: u64) -> Tally {
    let problem = corpus.problem(index);
    let (_, report) = solve(&problem);
    let mut tally = Tally { problems: 1, ..Tally::default() };
    match (report.outcome, report.route) {
        (Outcome::Solved, route) => {
            tally.solved[match route {
                Route::Newton => 0,
                Route::Continuation => 1,
                Route::Homotopy => 2,
                Route::Modes => 3,
            }] = 1;
            tally.worst_residual = report.residual;
        }
        (Outcome::Infeasible, _) => {
            tally.infeasible = 1;
            let exists = corpus.witness(index).is_some() || !may_jam(&problem) && gap_margin(&problem, 1.0) > 0.0;
            tally.contradicted.extend(exists.then_some(index));
        }
        (Outcome::Failed, _) => tally.failed.push(index),
    }
    tally
}

fn merged(mut all: BTreeMap<Family, Tally>, more: BTreeMap<Family, Tally>) -> BTreeMap<Family, Tally> {
    for (family, tally) in more {
        let sum = all.entry(family).or_default();
        sum.problems += tally.problems;
        for (a, b) in sum.solved.iter_mut().zip(tally.solved) {
            *a += b;
        }
        sum.infeasible += tally.infeasible;
        sum.failed.extend(tally.failed);
        sum.contradicted.extend(tally.contradicted);
        sum.worst_residual = sum.worst_residual.max(tally.worst_residual);
    }
    all
}
