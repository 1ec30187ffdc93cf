//! The most plausible vector: [`optimum`], Nelder–Mead from several starts.

use argmin::core::{CostFunction, Error, Executor, State};
use argmin::solver::neldermead::NelderMead;
use rayon::prelude::*;

use crate::posterior::Posterior;

/// Edge of the first simplex, in whitened coordinates.
const EDGE: f64 = 0.3;

/// Iterations of one search, for each number of a vector.
const ITERATIONS_PER_NUMBER: u64 = 40;

/// Standard deviation of the cost over a simplex at which a search ends.
const FLAT: f64 = 1e-3;

/// Cost of a vector without a density.
const IMPOSSIBLE: f64 = 1e300;

struct Cost<'a>(&'a Posterior<'a>);

impl CostFunction for Cost<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, vector: &Vec<f64>) -> Result<f64, Error> {
        let cost = -self.0.log_density(vector);
        Ok(if cost.is_finite() { cost } else { IMPOSSIBLE })
    }
}

/// Vectors that a search tries at most, unless it shrinks its simplex: the first simplex, then two
/// in each iteration.
pub(crate) fn most_tried(dimension: usize) -> u64 {
    (2 * ITERATIONS_PER_NUMBER + 1) * dimension as u64 + 1
}

/// The best vectors that searches from `starts` find, the best one first; the number of vectors
/// that they tried.
pub(crate) fn optima(posterior: &Posterior<'_>, starts: &[Vec<f64>]) -> (Vec<Vec<f64>>, u64) {
    let found: Vec<(f64, Vec<f64>, u64)> = starts
        .par_iter()
        .map(|start| search(posterior, start))
        .collect();
    let tried = found.iter().map(|(_, _, tried)| tried).sum();
    let mut found: Vec<(f64, Vec<f64>)> = found
        .into_iter()
        .map(|(cost, vector, _)| (cost, vector))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    (found.into_iter().map(|(_, vector)| vector).collect(), tried)
}

/// One search: its best cost and vector, and the number of vectors tried.
fn search(posterior: &Posterior<'_>, start: &[f64]) -> (f64, Vec<f64>, u64) {
    let dimension = start.len();
    let corner = |k: usize| {
        let mut vector = start.to_vec();
        vector[k] += if vector[k] > 0.0 { -EDGE } else { EDGE };
        vector
    };
    let simplex: Vec<Vec<f64>> = std::iter::once(start.to_vec())
        .chain((0..dimension).map(corner))
        .collect();
    let solver = NelderMead::new(simplex)
        .with_sd_tolerance(FLAT)
        .expect("a positive tolerance");
    let most = ITERATIONS_PER_NUMBER * dimension as u64;
    let result = Executor::new(Cost(posterior), solver)
        .configure(|state| state.max_iters(most))
        .timer(false)
        .run()
        .expect("the cost is always a number");
    let state = result.state();
    let tried = state
        .get_func_counts()
        .get("cost_count")
        .copied()
        .unwrap_or(0);
    let best = state.get_best_param().cloned().unwrap_or(start.to_vec());
    (state.get_best_cost(), best, tried)
}
