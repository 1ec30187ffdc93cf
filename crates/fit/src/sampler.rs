//! The posterior by populations that cool from the prior: [`sample`], sequential Monte Carlo (Del
//! Moral, Doucet & Jasra 2006) with moves of differential evolution (ter Braak 2006).
//!
//! Written here because the rollouts of half a population run side by side in vector lanes;
//! samplers that are to be had ask for one density at a time.

use stickslip_filter::{Draw, Streams};

use crate::chain::Chain;
use crate::posterior::Posterior;

/// Independent populations, which must come to agree.
const POPULATIONS: usize = 4;

/// Vectors of a population.
const SIZE: usize = 256;

/// Best step of a random walk over the spread of a normal density in many dimensions, times the
/// square root of their number (Roberts, Gelman & Gilks 1997).
const BEST_STEP: f64 = 2.38;

/// Moves of which one goes by a whole difference, from mode to mode.
const JUMP_EVERY: u64 = 5;

/// Share of the vectors that one stage of cooling is to be worth.
const WORTH: f64 = 0.5;

/// Moves of every vector in a stage.
const STAGE: usize = 10;

/// Bisections of a power: a millionth is exact enough.
const BISECTIONS: usize = 20;

/// Most stages; the last one goes all the way.
const MOST_STAGES: usize = 20;

/// Step of the random streams at which moves begin; earlier ones start vectors and resample.
const FIRST_MOVE: u64 = 1 << 32;

/// Draws of one vector in one move: two others, whether it is accepted.
const DRAWS: [u32; 3] = [0, 1, 2];

/// Moves of every vector between two checks whether the populations agree, and most rounds of
/// them.
const ROUNDS: [usize; 2] = [20, 20];

/// Moves and rounds where every vector has a scene of its own: its pushes are predicted one by one
/// then, which takes ten times as long.
const COSTLY_ROUNDS: [usize; 2] = [20, 4];

/// Moves of a round, and most rounds.
fn rounds(costly: bool) -> [usize; 2] {
    if costly { COSTLY_ROUNDS } else { ROUNDS }
}

/// Most vectors that are tried.
pub(crate) fn most_sampled(costly: bool) -> u64 {
    let [round, most_rounds] = rounds(costly);
    (POPULATIONS * SIZE * (1 + STAGE * MOST_STAGES + round * most_rounds)) as u64
}

/// Vectors with their densities.
struct Populations<'a> {
    posterior: &'a Posterior<'a>,
    vectors: Vec<Vec<f64>>,
    /// Log-likelihood of each.
    likelihoods: Vec<f64>,
    /// Power of the likelihood in the density.
    power: f64,
    streams: Streams,
    moves: u64,
}

/// Samples `posterior`: populations drawn from the prior cool to the `power` of the likelihood that
/// their mean deserves. Then they move until the second half of their ways agrees, by
/// `settled` as split R̂, or for the most rounds. Also the number of vectors tried.
pub(crate) fn sample(
    posterior: &Posterior<'_>,
    power: &dyn Fn(&[f64]) -> f64,
    settled: f64,
    streams: Streams,
) -> (Chain, u64) {
    let mut populations = Populations::from_prior(posterior, streams);
    for stage in 1..=MOST_STAGES {
        let end = power(&populations.mean());
        if populations.power >= end {
            break;
        }
        populations.cool(end, stage == MOST_STAGES);
        for _ in 0..STAGE {
            populations.make_move();
        }
    }

    let mut chain = Chain::new(POPULATIONS, POPULATIONS * SIZE, posterior.dimension());
    let [round, most_rounds] = rounds(posterior.is_costly());
    for _ in 0..most_rounds {
        for _ in 0..round {
            let accepted = populations.make_move();
            chain.push(&populations.vectors, accepted);
        }
        if chain.second_half().split_rhat() <= settled {
            break;
        }
    }
    let tried = (populations.moves + 1) * (POPULATIONS * SIZE) as u64;
    (chain.second_half(), tried)
}

impl<'a> Populations<'a> {
    fn from_prior(posterior: &'a Posterior<'a>, streams: Streams) -> Self {
        let vector = |k: usize| -> Vec<f64> {
            let numbers = 0..posterior.dimension();
            numbers
                .map(|i| streams.normal(1, k as u32, i as u32))
                .collect()
        };
        let vectors: Vec<Vec<f64>> = (0..POPULATIONS * SIZE).map(vector).collect();
        Self {
            likelihoods: posterior.log_likelihoods(&vectors),
            vectors,
            posterior,
            power: 0.0,
            streams,
            moves: 0,
        }
    }

    fn mean(&self) -> Vec<f64> {
        let count = self.vectors.len() as f64;
        let mean = |k: usize| self.vectors.iter().map(|vector| vector[k]).sum::<f64>() / count;
        (0..self.posterior.dimension()).map(mean).collect()
    }

    /// Raises the power, at most to `end`, and resamples each population.
    fn cool(&mut self, end: f64, at_once: bool) {
        let most = self.likelihoods.iter().copied().fold(f64::MIN, f64::max);
        let weights = |power: f64| -> Vec<f64> {
            let ratios = self.likelihoods.iter().map(|likelihood| likelihood - most);
            ratios
                .map(|ratio| libm::exp((power - self.power) * ratio))
                .collect()
        };
        let worth = |power: f64| {
            let weights = weights(power);
            let sum: f64 = weights.iter().sum();
            let squares: f64 = weights.iter().map(|w| w * w).sum();
            sum * sum / squares / weights.len() as f64
        };
        let mut next = end;
        if !at_once && worth(end) < WORTH {
            // the worth falls with the power
            let mut low = self.power;
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (low + next);
                match worth(middle) < WORTH {
                    true => next = middle,
                    false => low = middle,
                }
            }
        }
        let weights = weights(next);
        let draw = self.streams.at(2 + self.moves);
        let mut chosen = Vec::with_capacity(weights.len());
        for population in 0..POPULATIONS {
            let first = population * SIZE;
            let offset = draw.uniform(population as u32, 0);
            chosen.extend(systematic(&weights[first..][..SIZE], offset).map(|k| first + k));
        }
        self.vectors = chosen.iter().map(|k| self.vectors[*k].clone()).collect();
        self.likelihoods = chosen.iter().map(|k| self.likelihoods[*k]).collect();
        self.power = next;
    }

    /// Moves every vector once; how many moved.
    fn make_move(&mut self) -> usize {
        let draw = self.streams.at(FIRST_MOVE + self.moves);
        self.moves += 1;
        (0..2).map(|half| self.move_half(half, draw)).sum()
    }

    fn density(&self, vector: &[f64], likelihood: f64) -> f64 {
        self.power * likelihood - 0.5 * vector.iter().map(|z| z * z).sum::<f64>()
    }

    /// Moves one half of each population by differences within the other half; how many moved.
    fn move_half(&mut self, half: usize, draw: Draw) -> usize {
        let count = SIZE / 2;
        let moving: Vec<usize> = (0..self.vectors.len())
            .filter(|k| k % SIZE / count == half)
            .collect();

        // where each would go: along the difference of two of the other half
        let jump = match self.moves % JUMP_EVERY {
            0 => 1.0,
            _ => BEST_STEP / (2.0 * self.posterior.dimension() as f64).sqrt(),
        };
        let propose = |k: &usize| -> Vec<f64> {
            let others = k / SIZE * SIZE + (1 - half) * count;
            let [a, b] = [DRAWS[0], DRAWS[1]].map(|i| {
                let drawn = draw.uniform(*k as u32, i) * count as f64;
                &self.vectors[others + drawn as usize]
            });
            let numbers = self.vectors[*k].iter().zip(a.iter().zip(b));
            numbers.map(|(x, (a, b))| x + jump * (a - b)).collect()
        };
        let candidates: Vec<Vec<f64>> = moving.iter().map(propose).collect();
        let likelihoods = self.posterior.log_likelihoods(&candidates);

        // who goes
        let mut accepted = 0;
        for ((k, likelihood), vector) in moving.into_iter().zip(likelihoods).zip(candidates) {
            let before = self.density(&self.vectors[k], self.likelihoods[k]);
            let chance = self.density(&vector, likelihood) - before;
            if libm::log(draw.uniform(k as u32, DRAWS[2])) < chance {
                self.vectors[k] = vector;
                self.likelihoods[k] = likelihood;
                accepted += 1;
            }
        }
        accepted
    }
}

/// Indices of a population of its size, drawn by weights (systematic resampling).
fn systematic(weights: &[f64], offset: f64) -> impl Iterator<Item = usize> {
    let total: f64 = weights.iter().sum();
    let step = total / weights.len() as f64;
    let (mut k, mut sum) = (0, weights[0]);
    (0..weights.len()).map(move |i| {
        while sum < (i as f64 + offset) * step && k + 1 < weights.len() {
            k += 1;
            sum += weights[k];
        }
        k
    })
}
