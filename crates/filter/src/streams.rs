//! Counter-based random numbers: Philox4x32-10 and Box–Muller.
//!
//! A random number is a pure function of (seed, purpose, step, particle, draw). No generator has a
//! state, so neither the order of evaluation nor the number of threads can matter (Salmon, Moraes,
//! Dror & Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011). The seed is Philox's key;
//! the counter's 128 bits are
//!
//! | word | 0 | 1 | 2 | 3 |
//! | --- | --- | --- | --- | --- |
//! | holds | draw / 2 | particle | step, low 32 bits | step, next 24 bits; kind, 1 bit; purpose, 7 bits |
//!
//! so different arguments never share a counter. One counter gives 128 bits: two uniform numbers,
//! or by Box–Muller two independent normal ones; the kind keeps the two families apart.

use stickslip_lanes::box_muller;

const STEP_BITS: u32 = 56;
const ROUNDS: usize = 10;
const LOW_WORD: u64 = 0xFFFF_FFFF;
/// Particles side by side in [`Draw::normal_columns`].
const LANES: usize = 8;

/// Purpose of a random number. Streams of different purposes are independent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
#[non_exhaustive]
pub enum Purpose {
    /// Anything outside a filter: the default of [`Streams::new`].
    General = 0,
    /// The particles at the start.
    Initialise = 1,
    /// Process noise.
    Propagate = 2,
    /// The filter's regular resampling.
    Resample = 3,
    /// The filter's resampling after a collapse.
    ResampleAfterCollapse = 4,
    /// Particles reinitialised around an observation after a collapse.
    Reinitialise = 5,
    /// Noise of simulated sensors.
    Measure = 6,
    /// Resampling to another number of particles.
    Resize = 7,
    /// Noise of the measurements that particles are moved to.
    Move = 9,
}

#[derive(Clone, Copy)]
enum Kind {
    Uniform = 0,
    Normal = 1,
}

/// All random numbers of one seed and one purpose.
///
/// ```
/// use stickslip_filter::{Purpose, Streams};
/// let streams = Streams::new(7);
/// assert_eq!(streams.normal(3, 0, 1), streams.normals::<2>(3, 0, 0)[1]);
/// assert_ne!(streams.normal(3, 0, 1), streams.of(Purpose::Measure).normal(3, 0, 1));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Streams {
    seed: u64,
    purpose: Purpose,
}

impl Streams {
    /// The streams of `seed`, for [`Purpose::General`].
    pub fn new(seed: u64) -> Self {
        Streams {
            seed,
            purpose: Purpose::General,
        }
    }

    /// Streams of this seed for another purpose.
    pub fn of(self, purpose: Purpose) -> Self {
        Streams { purpose, ..self }
    }

    /// The streams at one step, below 2^56.
    pub fn at(self, step: u64) -> Draw {
        assert!(
            step >> STEP_BITS == 0,
            "step {step} does not fit {STEP_BITS} bits"
        );
        Draw {
            streams: self,
            step,
        }
    }

    /// A standard normal number; even and odd draws (2k, 2k + 1) come in pairs from one evaluation.
    pub fn normal(self, step: u64, particle: u32, draw: u32) -> f64 {
        self.at(step).normal(particle, draw)
    }

    /// The standard normal numbers `first_draw`, ..., `first_draw + K - 1`.
    pub fn normals<const K: usize>(self, step: u64, particle: u32, first_draw: u32) -> [f64; K] {
        self.at(step).normals(particle, first_draw)
    }

    /// A number uniform in the open interval (0, 1), independent of the normal one of the same
    /// draw.
    pub fn uniform(self, step: u64, particle: u32, draw: u32) -> f64 {
        self.at(step).uniform(particle, draw)
    }
}

/// The random numbers of one seed, purpose and step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Draw {
    streams: Streams,
    step: u64,
}

impl Draw {
    /// The step these numbers belong to.
    pub fn step(self) -> u64 {
        self.step
    }

    /// The random numbers of the step `steps` before this one, which is step `steps` or later.
    pub fn before(self, steps: u64) -> Self {
        let step = self.step.checked_sub(steps);
        Self {
            step: step.expect("no step comes before step 0"),
            ..self
        }
    }

    /// A standard normal number.
    #[inline]
    pub fn normal(self, particle: u32, draw: u32) -> f64 {
        self.normal_pair(particle, draw / 2)[(draw % 2) as usize]
    }

    /// The standard normal numbers `first_draw`, ..., `first_draw + K - 1`; cheapest where
    /// `first_draw` is even.
    #[inline]
    pub fn normals<const K: usize>(self, particle: u32, first_draw: u32) -> [f64; K] {
        let mut out = [0.0; K];
        let mut pair = [0.0; 2];
        for (i, x) in out.iter_mut().enumerate() {
            let draw = first_draw + i as u32;
            if i == 0 || draw.is_multiple_of(2) {
                pair = self.normal_pair(particle, draw / 2);
            }
            *x = pair[(draw % 2) as usize];
        }
        out
    }

    /// A number uniform in the open interval (0, 1).
    #[inline]
    pub fn uniform(self, particle: u32, draw: u32) -> f64 {
        self.uniform_lanes::<1>(Kind::Uniform, particle, draw / 2)[(draw % 2) as usize][0]
    }

    /// The standard normal numbers `2 * pair` and `2 * pair + 1` of neighbouring particles, a
    /// column of each: the same numbers as [`normal`](Self::normal), faster. It is inlined, so that
    /// inside a function compiled for wider vector instructions it uses them.
    ///
    /// # Panics
    /// If the columns differ in length.
    #[inline(always)]
    pub fn normal_columns(self, first_particle: u32, pair: u32, even: &mut [f64], odd: &mut [f64]) {
        assert_eq!(even.len(), odd.len());
        let mut first = first_particle;
        for (even, odd) in even.chunks_mut(LANES).zip(odd.chunks_mut(LANES)) {
            let [u, v] = self.uniform_lanes::<LANES>(Kind::Normal, first, pair);
            store(even, &u);
            store(odd, &v);
            first = first.wrapping_add(LANES as u32);
        }
        // a loop of its own, over memory: fused with the one above, it does not vectorise
        for (even, odd) in even.iter_mut().zip(odd) {
            [*even, *odd] = box_muller(*even, *odd);
        }
    }

    #[inline]
    fn normal_pair(self, particle: u32, pair: u32) -> [f64; 2] {
        let [[u], [v]] = self.uniform_lanes(Kind::Normal, particle, pair);
        box_muller(u, v)
    }

    /// The uniform numbers `2 * pair` and `2 * pair + 1` of L neighbouring particles.
    #[inline(always)]
    fn uniform_lanes<const L: usize>(
        self,
        kind: Kind,
        first_particle: u32,
        pair: u32,
    ) -> [[f64; L]; 2] {
        let Streams { seed, purpose } = self.streams;
        let tag = (purpose as u64) << 25 | (kind as u64) << 24;
        let particles =
            std::array::from_fn(|lane| u64::from(first_particle.wrapping_add(lane as u32)));
        let counter = [
            [u64::from(pair); L],
            particles,
            [self.step & LOW_WORD; L],
            [self.step >> 32 | tag; L],
        ];
        let [a, b, c, d] = philox4x32_10(counter, [seed as u32, (seed >> 32) as u32]);
        [open_unit(a, b), open_unit(c, d)]
    }
}

/// Writes as many numbers as `to` has room for.
#[inline(always)]
fn store<const L: usize>(to: &mut [f64], from: &[f64; L]) {
    match to.first_chunk_mut() {
        Some(lanes) => *lanes = *from,
        None => store_last(to, from),
    }
}

/// Out of line, because a copy of run-time length compiles to a call of memcpy: inlined, whole
/// chunks would be copied that way too.
#[cold]
#[inline(never)]
fn store_last(to: &mut [f64], from: &[f64]) {
    to.copy_from_slice(&from[..to.len()]);
}

/// The middle of one of 2^52 equal cells of (0, 1): never 0, never 1, and exact in f64.
#[inline(always)]
fn open_unit<const L: usize>(low: [u64; L], high: [u64; L]) -> [f64; L] {
    const HALF_CELL: f64 = f64::EPSILON / 2.0;
    std::array::from_fn(|i| {
        let mantissa = (high[i] << 32 | low[i] & LOW_WORD) >> 12;
        f64::from_bits(mantissa | 1.0f64.to_bits()) - (1.0 - HALF_CELL)
    })
}

/// Philox4x32 with 10 rounds (Salmon et al. 2011, section 3.3) on L counters side by side.
///
/// The 32-bit words are the low halves of u64, because SIMD multiplies 32-bit numbers to 64 bits;
/// the high halves are ignored.
#[inline(always)]
fn philox4x32_10<const L: usize>(mut counter: [[u64; L]; 4], mut key: [u32; 2]) -> [[u64; L]; 4] {
    for _ in 0..ROUNDS {
        counter = philox_round(counter, key.map(u64::from));
        key = [
            key[0].wrapping_add(0x9E37_79B9),
            key[1].wrapping_add(0xBB67_AE85),
        ];
    }
    counter
}

#[inline(always)]
fn philox_round<const L: usize>(
    [c0, c1, c2, c3]: [[u64; L]; 4],
    [k0, k1]: [u64; 2],
) -> [[u64; L]; 4] {
    let mut out = [[0; L]; 4];
    for i in 0..L {
        let a = (c0[i] & LOW_WORD) * 0xD251_1F53;
        let b = (c2[i] & LOW_WORD) * 0xCD9E_8D57;
        out[0][i] = (b >> 32) ^ c1[i] ^ k0;
        out[1][i] = b;
        out[2][i] = (a >> 32) ^ c3[i] ^ k1;
        out[3][i] = a;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `kat_vectors` of the Random123 distribution, lines `philox4x32 10`.
    #[test]
    fn philox_gives_the_published_known_answers() {
        let ones = u32::MAX;
        for (counter, key, answer) in [
            (
                [0; 4],
                [0; 2],
                [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8],
            ),
            (
                [ones; 4],
                [ones; 2],
                [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd],
            ),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ] {
            let words = philox4x32_10(counter.map(|c: u32| [u64::from(c); 3]), key);
            assert_eq!(
                words.map(|word| word.map(|w| w as u32)),
                answer.map(|a: u32| [a; 3])
            );
        }
    }

    #[test]
    fn open_unit_stays_inside_the_open_interval() {
        assert!(open_unit([0], [0])[0] > 0.0);
        assert!(open_unit([LOW_WORD], [LOW_WORD])[0] < 1.0);
    }
}
