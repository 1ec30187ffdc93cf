//! The posterior by an ensemble of Markov chains: [`sample`], stretch moves (Goodman & Weare 2010).
//!
//! Written here because the rollouts of half an ensemble run side by side in vector lanes; samplers
//! that are to be had ask for one density at a time.

use stickslip_filter::{Draw, Streams};

use crate::chain::Chain;
use crate::posterior::{LANES, Posterior};

/// Largest stretch of a move.
const STRETCH: f64 = 2.0;

/// Spread of the walkers around the optimum at the start, in whitened coordinates.
const START_STD: f64 = 0.2;

/// Step of the random streams at which moves begin; earlier ones start searches and walkers.
const FIRST_MOVE: u64 = 1 << 32;

/// Draws of one walker in one move: its partner, its stretch, whether it is accepted.
const DRAWS: [u32; 3] = [0, 1, 2];

/// Moves of every walker between two checks whether the chains have settled, and most rounds of
/// them.
const ROUNDS: [usize; 2] = [200, 6];

/// Moves and rounds where every vector has a scene of its own: its pushes are predicted one by one
/// then, which takes ten times as long.
const COSTLY_ROUNDS: [usize; 2] = [80, 4];

/// Walkers for vectors of `dimension` numbers: four for each, and a multiple of two blocks of
/// lanes.
fn walkers(dimension: usize) -> usize {
    (4 * dimension).div_ceil(2 * LANES).max(2) * 2 * LANES
}

/// Moves of a round, and most rounds.
pub(crate) fn rounds(costly: bool) -> [usize; 2] {
    if costly { COSTLY_ROUNDS } else { ROUNDS }
}

/// Most vectors that are tried in so many rounds of so many moves.
pub(crate) fn most_sampled(dimension: usize, [round, most_rounds]: [usize; 2]) -> u64 {
    (walkers(dimension) * (round * most_rounds + 1)) as u64
}

/// Samples `posterior` from around `start` until the second half of the chains has settled, by
/// `settled` as split R̂, or for the most rounds; also the number of vectors tried.
pub(crate) fn sample(
    posterior: &Posterior<'_>,
    start: &[f64],
    settled: f64,
    streams: Streams,
) -> (Chain, u64) {
    let (dimension, count) = (posterior.dimension(), walkers(posterior.dimension()));
    let mut vectors: Vec<Vec<f64>> = (0..count)
        .map(|walker| {
            let normal = |k: usize| streams.normal(1, walker as u32, k as u32);
            (0..dimension)
                .map(|k| start[k] + START_STD * normal(k))
                .collect()
        })
        .collect();
    let mut densities = posterior.log_densities(&vectors);
    let mut chain = Chain::new(count, dimension);
    let mut moves = 0;
    let [round, most_rounds] = rounds(posterior.is_costly());
    for _ in 0..most_rounds {
        for _ in 0..round {
            let mut accepted = 0;
            let draw = streams.at(FIRST_MOVE + moves as u64);
            for half in 0..2 {
                accepted += move_half(posterior, &mut vectors, &mut densities, half, draw);
            }
            chain.push(&vectors, accepted);
            moves += 1;
        }
        let second_half = chain.second_half();
        if second_half.split_rhat() <= settled {
            break;
        }
    }
    (chain.second_half(), (count * (moves + 1)) as u64)
}

/// Moves one half of the walkers along lines to walkers of the other; how many moved.
fn move_half(
    posterior: &Posterior<'_>,
    vectors: &mut [Vec<f64>],
    densities: &mut [f64],
    half: usize,
    draw: Draw,
) -> usize {
    let (count, dimension) = (vectors.len() / 2, vectors[0].len());
    let (own, other) = (half * count, (1 - half) * count);

    // where each would go: x' = y + s (x - y), with a density of s proportional to 1/√s
    let proposed: Vec<(Vec<f64>, f64)> = (0..count)
        .map(|k| {
            let walker = (own + k) as u32;
            let [partner, stretch] = [DRAWS[0], DRAWS[1]].map(|i| draw.uniform(walker, i));
            let partner = &vectors[other + (partner * count as f64) as usize];
            let root = (1.0 + stretch * (STRETCH - 1.0)) / STRETCH.sqrt();
            let s = root * root;
            let stretched = vectors[own + k].iter().zip(partner);
            (stretched.map(|(x, y)| y + s * (x - y)).collect(), s)
        })
        .collect();
    let candidates: Vec<Vec<f64>> = proposed.iter().map(|(vector, _)| vector.clone()).collect();
    let new = posterior.log_densities(&candidates);

    // who goes
    let mut accepted = 0;
    for (k, (vector, s)) in proposed.into_iter().enumerate() {
        let volume = (dimension - 1) as f64 * libm::log(s);
        let chance = volume + new[k] - densities[own + k];
        if libm::log(draw.uniform((own + k) as u32, DRAWS[2])) < chance {
            vectors[own + k] = vector;
            densities[own + k] = new[k];
            accepted += 1;
        }
    }
    accepted
}
