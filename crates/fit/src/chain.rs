//! Samples of several ensembles: [`Chain`].

use std::ops::Range;

/// The walkers of several independent ensembles, move by move.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    ensembles: usize,
    /// Walkers of all ensembles, those of one side by side.
    walkers: usize,
    dimension: usize,
    /// Samples, move by move, walker by walker.
    samples: Vec<Vec<f64>>,
    /// Walkers that moved, move by move.
    accepted: Vec<usize>,
}

impl Chain {
    pub fn new(ensembles: usize, walkers: usize, dimension: usize) -> Self {
        Self {
            ensembles,
            walkers,
            dimension,
            samples: Vec::new(),
            accepted: Vec::new(),
        }
    }

    /// Appends where the walkers are, `accepted` of which moved.
    pub fn push(&mut self, vectors: &[Vec<f64>], accepted: usize) {
        self.samples.extend_from_slice(vectors);
        self.accepted.push(accepted);
    }

    /// Share of the proposals that were accepted.
    pub fn acceptance(&self) -> f64 {
        self.accepted.iter().sum::<usize>() as f64 / self.samples.len().max(1) as f64
    }

    /// The second half of its moves.
    pub fn second_half(&self) -> Self {
        let from = self.accepted.len() / 2;
        Self {
            samples: self.samples[from * self.walkers..].to_vec(),
            accepted: self.accepted[from..].to_vec(),
            ..*self
        }
    }

    /// Means of the coordinates.
    pub fn means(&self) -> Vec<f64> {
        let mean = |k: usize| self.mean_of(|sample| sample[k]);
        (0..self.dimension).map(mean).collect()
    }

    /// Covariance matrix of the coordinates, row by row.
    pub fn covariance(&self) -> Vec<Vec<f64>> {
        let means = self.means();
        let of = |i: usize, j: usize| {
            self.mean_of(|sample| (sample[i] - means[i]) * (sample[j] - means[j]))
        };
        (0..self.dimension)
            .map(|i| (0..self.dimension).map(|j| of(i, j)).collect())
            .collect()
    }

    /// `count` samples, evenly over the chain.
    pub fn thinned(&self, count: usize) -> Vec<Vec<f64>> {
        let all = self.samples.len();
        (0..count)
            .map(|k| self.samples[(2 * k + 1) * all / (2 * count)].clone())
            .collect()
    }

    /// The largest split R̂ of the coordinates.
    pub fn split_rhat(&self) -> f64 {
        let of = (0..self.dimension).map(|k| self.split_rhat_of(k));
        of.fold(1.0, f64::max)
    }

    /// Split R̂ of a coordinate (Gelman et al., Bayesian Data Analysis, 3rd ed., 11.4): the halves
    /// of every ensemble's way are compared; 1 where all agree.
    pub fn split_rhat_of(&self, coordinate: usize) -> f64 {
        let rhat = |[within, between]: [f64; 2]| (1.0 + between / within).sqrt();
        self.variances(coordinate).map_or(f64::INFINITY, rhat)
    }

    /// Number of independent samples of a coordinate whose mean would scatter as those of the
    /// halves do.
    pub fn effective_samples_of(&self, coordinate: usize) -> f64 {
        let groups = (2 * self.ensembles) as f64;
        let worth = |[within, between]: [f64; 2]| groups * within / between.max(f64::MIN_POSITIVE);
        let worth = self.variances(coordinate).map_or(0.0, worth);
        worth.min(self.samples.len() as f64)
    }

    /// The fewest of any coordinate.
    pub fn effective_samples(&self) -> f64 {
        let of = (0..self.dimension).map(|k| self.effective_samples_of(k));
        of.fold(self.samples.len() as f64, f64::min)
    }

    /// Means of a coordinate over each ensemble, in so many equal parts of its way.
    pub fn ensemble_means_of(&self, coordinate: usize, parts: usize) -> Vec<Vec<f64>> {
        let moves = self.accepted.len();
        let mean = |ensemble: usize, part: usize| {
            let moves = part * moves / parts..(part + 1) * moves / parts;
            mean_and_variance(&self.values(ensemble, moves, coordinate)).0
        };
        (0..self.ensembles)
            .map(|ensemble| (0..parts).map(|part| mean(ensemble, part)).collect())
            .collect()
    }

    /// Values of a coordinate in some moves of an ensemble.
    fn values(&self, ensemble: usize, moves: Range<usize>, coordinate: usize) -> Vec<f64> {
        let own = self.walkers / self.ensembles;
        let walkers = |step: usize| &self.samples[step * self.walkers + ensemble * own..][..own];
        let samples = moves.flat_map(walkers);
        samples.map(|sample| sample[coordinate]).collect()
    }

    /// Variance of a coordinate within the halves of every ensemble's way, and between their means.
    fn variances(&self, coordinate: usize) -> Option<[f64; 2]> {
        let moves = self.accepted.len();
        let half = moves / 2;
        if half < 2 {
            return None;
        }
        let (mut means, mut within) = (Vec::new(), 0.0);
        for ensemble in 0..self.ensembles {
            for first in [0, moves - half] {
                let values = self.values(ensemble, first..first + half, coordinate);
                let (mean, variance) = mean_and_variance(&values);
                means.push(mean);
                within += variance / (2 * self.ensembles) as f64;
            }
        }
        let (_, between) = mean_and_variance(&means);
        Some([within.max(f64::MIN_POSITIVE), between])
    }

    fn mean_of(&self, of: impl Fn(&[f64]) -> f64) -> f64 {
        let sum: f64 = self.samples.iter().map(|sample| of(sample)).sum();
        sum / self.samples.len() as f64
    }
}

/// Mean, and variance with n - 1, of at least two numbers.
fn mean_and_variance(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
    (mean, squares / (n - 1.0))
}

#[cfg(test)]
mod tests {
    use stickslip_filter::Streams;

    use super::*;

    /// Chains of one walker: AR(1) with this memory per move, about a place of each ensemble.
    fn chain(memory: f64, places: [f64; 4]) -> Chain {
        let mut chain = Chain::new(4, 4, 1);
        let mut at = places.map(|place| vec![place]);
        for step in 0..4000 {
            for (k, (x, place)) in at.iter_mut().zip(places).enumerate() {
                let normal = Streams::new(5).normal(step, k as u32, 0);
                x[0] = place + memory * (x[0] - place) + (1.0 - memory * memory).sqrt() * normal;
            }
            chain.push(&at, 4);
        }
        chain
    }

    #[test]
    fn split_rhat_tells_ensembles_that_disagree() {
        assert!(chain(0.5, [0.0; 4]).split_rhat() < 1.01);
        let apart = chain(0.5, [0.0, 0.0, 0.0, 1.0]).split_rhat();
        assert!((apart - 1.10_f64).abs() < 0.02, "{apart}");

        // so do their means in each quarter of the way
        let means = chain(0.5, [0.0, 0.0, 0.0, 1.0]).ensemble_means_of(0, 4);
        for (means, place) in means.iter().zip([0.0, 0.0, 0.0, 1.0]) {
            assert_eq!(means.len(), 4);
            // 1000 moves with memory 0.5 are worth 333
            assert!(
                means
                    .iter()
                    .all(|mean| (mean - place).abs() < 4.0 / 333.0_f64.sqrt())
            );
        }
    }

    /// A chain with memory a is worth n (1 - a) / (1 + a) independent samples.
    #[test]
    fn effective_samples_are_those_of_chains_with_a_memory() {
        for memory in [0.0, 0.9] {
            let expected = 16_000.0 * (1.0 - memory) / (1.0 + memory);
            let found = chain(memory, [0.0; 4]).effective_samples_of(0);
            // seven differences of means know their variance to a factor of about three
            assert!(
                (0.3..4.0).contains(&(found / expected)),
                "{memory}: {found}"
            );
        }
    }
}
