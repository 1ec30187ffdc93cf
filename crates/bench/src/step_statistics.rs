//! Outcomes of a set of particle-steps: [`StepStatistics`].

use stickslip_dynamics::{Outcome, Report, Route};

/// Steps with this many iterations or more are counted together.
const MOST_ITERATIONS: usize = 255;

/// Routes in the order in which the solver tries them, with their names.
const ROUTES: [(Route, &str); 3] = [
    (Route::Newton, "newton"),
    (Route::SmoothedPath, "smoothed path"),
    (Route::ModeSearch, "modes"),
];

/// Outcomes, routes, iterations and residuals of particle-steps.
#[derive(Clone, Debug)]
pub struct StepStatistics {
    steps: u64,
    unsolved: u64,
    routes: [u64; 3],
    by_iterations: Vec<u64>,
    worst_residual: f64,
}

impl Default for StepStatistics {
    fn default() -> Self {
        Self {
            steps: 0,
            unsolved: 0,
            routes: [0; 3],
            by_iterations: vec![0; MOST_ITERATIONS + 1],
            worst_residual: 0.0,
        }
    }
}

impl StepStatistics {
    /// Counts one particle-step.
    pub fn count(&mut self, report: &Report) {
        self.steps += 1;
        self.by_iterations[(report.systems as usize).min(MOST_ITERATIONS)] += 1;
        for (count, (route, _)) in self.routes.iter_mut().zip(ROUTES) {
            *count += u64::from(route == report.route);
        }
        match report.outcome {
            Outcome::Solved => self.worst_residual = self.worst_residual.max(report.residual),
            Outcome::Infeasible | Outcome::Failed => self.unsolved += 1,
        }
    }

    /// Adds the counts of another.
    pub fn add(&mut self, other: &Self) {
        self.steps += other.steps;
        self.unsolved += other.unsolved;
        self.routes
            .iter_mut()
            .zip(other.routes)
            .for_each(|(a, b)| *a += b);
        self.by_iterations
            .iter_mut()
            .zip(&other.by_iterations)
            .for_each(|(a, b)| *a += b);
        self.worst_residual = self.worst_residual.max(other.worst_residual);
    }

    /// Particle-steps.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Particle-steps without a certified solution.
    #[must_use]
    pub fn unsolved(&self) -> u64 {
        self.unsolved
    }

    /// Largest residual of a solved step (m/s).
    #[must_use]
    pub fn worst_residual(&self) -> f64 {
        self.worst_residual
    }

    /// Mean number of iterations; NaN without a step.
    #[must_use]
    pub fn mean_iterations(&self) -> f64 {
        let sum: u64 = self
            .by_iterations
            .iter()
            .zip(0..)
            .map(|(count, iterations)| count * iterations)
            .sum();
        sum as f64 / self.steps as f64
    }

    /// The smallest number of iterations that a share of the steps did not exceed.
    #[must_use]
    pub fn iterations_quantile(&self, share: f64) -> usize {
        let wanted = (share * self.steps as f64).ceil() as u64;
        let mut seen = 0;
        let reached = self.by_iterations.iter().position(|count| {
            seen += count;
            seen >= wanted
        });
        reached.unwrap_or(MOST_ITERATIONS)
    }

    /// The share of steps that each solver answered, with its name, cheapest first.
    pub fn route_shares(&self) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        ROUTES
            .iter()
            .zip(self.routes)
            .map(|((_, name), count)| (*name, count as f64 / self.steps as f64))
    }

    /// The share of steps that another solver than the first one answered.
    #[must_use]
    pub fn fallback_share(&self) -> f64 {
        1.0 - self.routes[0] as f64 / self.steps as f64
    }
}
