//! Samples of an ensemble: [`Chain`].

/// The walkers of an ensemble, move by move.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    walkers: usize,
    dimension: usize,
    /// Samples, move by move, walker by walker.
    samples: Vec<Vec<f64>>,
    /// Walkers that moved, move by move.
    accepted: Vec<usize>,
}

impl Chain {
    pub fn new(walkers: usize, dimension: usize) -> Self {
        Self {
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

    /// The largest split R̂ of the coordinates (Gelman et al., Bayesian Data Analysis, 3rd ed.,
    /// 11.4): the halves of every walker's way are compared; 1 where all agree.
    pub fn split_rhat(&self) -> f64 {
        (0..self.dimension)
            .map(|k| self.split_rhat_of(k))
            .fold(1.0, f64::max)
    }

    fn split_rhat_of(&self, coordinate: usize) -> f64 {
        let moves = self.accepted.len();
        let half = moves / 2;
        if half < 2 {
            return f64::INFINITY;
        }
        let mut means = Vec::new();
        let mut variances = Vec::new();
        for walker in 0..self.walkers {
            for first in [0, moves - half] {
                let at = |step: usize| self.samples[step * self.walkers + walker][coordinate];
                let values: Vec<f64> = (first..first + half).map(at).collect();
                let (mean, variance) = mean_and_variance(&values);
                means.push(mean);
                variances.push(variance);
            }
        }
        let within = variances.iter().sum::<f64>() / variances.len() as f64;
        let (_, between) = mean_and_variance(&means);
        let n = half as f64;
        ((n - 1.0) / n + between / within.max(f64::MIN_POSITIVE)).sqrt()
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
