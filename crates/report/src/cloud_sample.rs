//! A few particles of every row, to be drawn: [`CloudSample`].

use std::sync::{Mutex, PoisonError};

use stickslip::dynamics::Pose;
use stickslip::{Observer, ParticleView, SolvedStep};
use stickslip_evaluation::ScoredRun;

use crate::reported_run::ReportedRun;

/// Watches a run and keeps the poses of some particles after every row, drawn by their weights, so
/// that all kept ones count the same.
#[derive(Debug)]
pub struct CloudSample {
    kept: usize,
    rows: Mutex<Vec<(usize, Vec<Pose>)>>,
}

impl CloudSample {
    /// Keeps this number of particles in every row.
    #[must_use]
    pub fn new(kept: usize) -> Self {
        Self {
            kept,
            rows: Mutex::default(),
        }
    }

    /// The run with the particles kept of each of its rows; none where it has no particles.
    #[must_use]
    pub fn into_run(self, scored: ScoredRun) -> ReportedRun {
        let rows = scored.estimate.rows.len();
        let mut cloud = vec![Vec::new(); rows];
        let sampled = self.rows.into_inner();
        for (row, poses) in sampled.unwrap_or_else(PoisonError::into_inner) {
            if row < rows {
                cloud[row] = poses;
            }
        }
        ReportedRun { scored, cloud }
    }
}

impl Observer for CloudSample {
    fn on_step(&self, _: &SolvedStep<'_>) {}

    fn wants_steps(&self) -> bool {
        false
    }

    fn on_row(&self, row: usize, cloud: &ParticleView<'_>) {
        let poses = systematic(cloud.weights(), self.kept)
            .into_iter()
            .map(|particle| cloud.pose(particle))
            .collect();
        self.rows
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push((row, poses));
    }
}

/// The particles at which the running sum of weights passes (k + 1/2) / `count`: systematic
/// resampling without chance.
fn systematic(weights: &[f64], count: usize) -> Vec<usize> {
    let (mut particle, mut sum) = (0, weights.first().copied().unwrap_or(0.0));
    let mut drawn = Vec::with_capacity(count);
    for k in 0..count {
        let target = (k as f64 + 0.5) / count as f64;
        while sum < target && particle + 1 < weights.len() {
            particle += 1;
            sum += weights[particle];
        }
        drawn.push(particle);
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn systematic_draws_by_weight() {
        assert_eq!(systematic(&[0.5, 0.0, 0.25, 0.25], 4), [0, 0, 2, 3]);
        assert_eq!(systematic(&[0.125; 8], 2), [1, 5]);
        assert_eq!(systematic(&[1.0], 3), [0, 0, 0]);
    }
}
