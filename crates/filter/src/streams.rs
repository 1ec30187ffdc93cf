//! Counter-based random numbers: Philox4x32-10 and Box–Muller.
//!
//! A random number is a pure function of (seed, purpose, step, particle, draw): no generator has a state, so
//! neither the order of evaluation nor the number of threads can matter (Salmon, Moraes, Dror & Shaw, "Parallel
//! random numbers: as easy as 1, 2, 3", SC 2011). The seed is Philox's key; the counter's 128 bits are
//!
//! | word | 0 | 1 | 2 | 3 |
//! | --- | --- | --- | --- | --- |
//! | holds | draw / 2 | particle | step, low 32 bits | step, next 24 bits; kind, 1 bit; purpose, 7 bits |
//!
//! so different arguments never share a counter. One counter gives 128 bits: two uniform numbers, or by
//! Box–Muller two independent normal ones; the kind keeps the two families apart.

use std::f64::consts::TAU;

const STEP_BITS: u32 = 56;
const ROUNDS: usize = 10;

/// What a random number is for. Streams of different purposes are independent.
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
    Recover = 4,
    /// Particles drawn anew around an observation after a collapse.
    Redraw = 5,
    /// Noise of simulated sensors.
    Measure = 6,
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

    /// The same seed's streams for another purpose.
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

    /// A number uniform in the open interval (0, 1), independent of the normal one of the same draw.
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

    /// A standard normal number.
    #[inline]
    pub fn normal(self, particle: u32, draw: u32) -> f64 {
        self.normal_pair(particle, draw / 2)[(draw % 2) as usize]
    }

    /// The standard normal numbers `first_draw`, ..., `first_draw + K - 1`; cheapest where `first_draw` is even.
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
        self.uniform_pair(Kind::Uniform, particle, draw / 2)[(draw % 2) as usize]
    }

    /// Box & Muller (1958).
    #[inline]
    fn normal_pair(self, particle: u32, pair: u32) -> [f64; 2] {
        let [u, v] = self.uniform_pair(Kind::Normal, particle, pair);
        let radius = (-2.0 * libm::log(u)).sqrt();
        let (sin, cos) = libm::sincos(TAU * v);
        [radius * cos, radius * sin]
    }

    #[inline]
    fn uniform_pair(self, kind: Kind, particle: u32, pair: u32) -> [f64; 2] {
        let Streams { seed, purpose } = self.streams;
        let tag = (purpose as u32) << 25 | (kind as u32) << 24;
        let counter = [
            pair,
            particle,
            self.step as u32,
            (self.step >> 32) as u32 | tag,
        ];
        let [a, b, c, d] = philox4x32_10(counter, [seed as u32, (seed >> 32) as u32]);
        [open_unit(a, b), open_unit(c, d)]
    }
}

/// The middle of one of 2^52 equal cells of (0, 1): never 0, never 1, and exact in f64.
#[inline]
fn open_unit(low: u32, high: u32) -> f64 {
    const CELL: f64 = 1.0 / (1u64 << 52) as f64;
    let bits = (u64::from(high) << 32 | u64::from(low)) >> 12;
    (bits as f64 + 0.5) * CELL
}

/// Philox4x32 with 10 rounds (Salmon et al. 2011, section 3.3).
#[inline]
fn philox4x32_10(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for _ in 0..ROUNDS {
        counter = philox_round(counter, key);
        key = [
            key[0].wrapping_add(0x9E37_79B9),
            key[1].wrapping_add(0xBB67_AE85),
        ];
    }
    counter
}

#[inline]
fn philox_round([c0, c1, c2, c3]: [u32; 4], [k0, k1]: [u32; 2]) -> [u32; 4] {
    let a = u64::from(c0) * 0xD251_1F53;
    let b = u64::from(c2) * 0xCD9E_8D57;
    [
        (b >> 32) as u32 ^ c1 ^ k0,
        b as u32,
        (a >> 32) as u32 ^ c3 ^ k1,
        a as u32,
    ]
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
            assert_eq!(philox4x32_10(counter, key), answer);
        }
    }

    #[test]
    fn open_unit_stays_inside_the_open_interval() {
        assert!(open_unit(0, 0) > 0.0);
        assert!(open_unit(u32::MAX, u32::MAX) < 1.0);
    }
}
