//! The posterior by ensembles of Markov chains: [`sample`], stretch moves (Goodman & Weare 2010).
//!
//! Written here because the rollouts of half an ensemble run side by side in vector lanes; samplers
//! that are to be had ask for one density at a time.

use stickslip_filter::{Draw, Streams};

use crate::chain::Chain;
use crate::posterior::{LANES, Posterior};

/// Largest stretch of a move.
const STRETCH: f64 = 2.0;

/// Independent ensembles, which must come to agree.
const ENSEMBLES: usize = 4;

/// Spreads at the start, in whitened coordinates: of the ensembles around the optimum, and of the
/// walkers of one.
const START_STDS: [f64; 2] = [0.5, 0.2];

/// Step of the random streams at which moves begin; earlier ones start searches and walkers.
const FIRST_MOVE: u64 = 1 << 32;

/// Draws of one walker in one move: its partner, its stretch, whether it is accepted.
const DRAWS: [u32; 3] = [0, 1, 2];

/// Moves of every walker between two checks whether the chains have settled, and most rounds of
/// them.
const ROUNDS: [usize; 2] = [100, 40];

/// Moves and rounds where every vector has a scene of its own: its pushes are predicted one by one
/// then, which takes ten times as long.
const COSTLY_ROUNDS: [usize; 2] = [50, 12];

/// Walkers of an ensemble for vectors of `dimension` numbers: at least two for each, and a multiple
/// of two blocks of lanes.
fn walkers(dimension: usize) -> usize {
    (2 * dimension).div_ceil(2 * LANES) * 2 * LANES
}

/// Moves of a round, and most rounds.
pub(crate) fn rounds(costly: bool) -> [usize; 2] {
    if costly { COSTLY_ROUNDS } else { ROUNDS }
}

/// Most vectors that are tried in so many rounds of so many moves.
pub(crate) fn most_sampled(dimension: usize, [round, most_rounds]: [usize; 2]) -> u64 {
    (ENSEMBLES * walkers(dimension) * (round * most_rounds + 1)) as u64
}

/// Samples `posterior` from around `start` until the second half of the chains has settled, by
/// `settled` as split R̂, or for the most rounds; also the number of vectors tried.
pub(crate) fn sample(
    posterior: &Posterior<'_>,
    start: &[f64],
    settled: f64,
    streams: Streams,
) -> (Chain, u64) {
    let dimension = posterior.dimension();
    let count = ENSEMBLES * walkers(dimension);
    let mut vectors: Vec<Vec<f64>> = (0..count)
        .map(|walker| {
            let ensemble = count + walker / walkers(dimension);
            let normal = |of: usize, k: usize| streams.normal(1, of as u32, k as u32);
            let [apart, within] = START_STDS;
            (0..dimension)
                .map(|k| start[k] + apart * normal(ensemble, k) + within * normal(walker, k))
                .collect()
        })
        .collect();
    let mut densities = posterior.log_densities(&vectors);
    let mut chain = Chain::new(ENSEMBLES, count, dimension);
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

/// Moves one half of the walkers of each ensemble along lines to walkers of the other half; how
/// many moved.
fn move_half(
    posterior: &Posterior<'_>,
    vectors: &mut [Vec<f64>],
    densities: &mut [f64],
    half: usize,
    draw: Draw,
) -> usize {
    let dimension = vectors[0].len();
    let (own_size, count) = (walkers(dimension), walkers(dimension) / 2);
    let moving: Vec<usize> = (0..vectors.len())
        .filter(|walker| walker % own_size / count == half)
        .collect();

    // where each would go: x' = y + s (x - y), with a density of s proportional to 1/√s
    let proposed: Vec<(Vec<f64>, f64)> = moving
        .iter()
        .map(|walker| {
            let drawn = |i: u32| draw.uniform(*walker as u32, i);
            let [partner, stretch] = [DRAWS[0], DRAWS[1]].map(drawn);
            let others = walker / own_size * own_size + (1 - half) * count;
            let partner = &vectors[others + (partner * count as f64) as usize];
            let root = (1.0 + stretch * (STRETCH - 1.0)) / STRETCH.sqrt();
            let s = root * root;
            let stretched = vectors[*walker].iter().zip(partner);
            (stretched.map(|(x, y)| y + s * (x - y)).collect(), s)
        })
        .collect();
    let candidates: Vec<Vec<f64>> = proposed.iter().map(|(vector, _)| vector.clone()).collect();
    let new = posterior.log_densities(&candidates);

    // who goes
    let mut accepted = 0;
    for ((walker, new), (vector, s)) in moving.into_iter().zip(new).zip(proposed) {
        let volume = (dimension - 1) as f64 * libm::log(s);
        let chance = volume + new - densities[walker];
        if libm::log(draw.uniform(walker as u32, DRAWS[2])) < chance {
            vectors[walker] = vector;
            densities[walker] = new;
            accepted += 1;
        }
    }
    accepted
}
