//! What a binary tactile sensor says over time (contact mode): [`TouchChannel`].

use crate::setup::Tactile;

/// Probabilities that a sensor is stuck at 0 and at 1.
pub(crate) type Stuck = [f64; 2];

/// A sensor that works, or is stuck at one reading for a while; which, is not known, but inferred
/// from its readings, particle by particle (docs/method.md, "Touch").
///
/// Readings of a sensor that misses a touch now will miss it in the next frame, too: they count
/// once, not frame by frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TouchChannel {
    /// Of a sensor that works: probability of reading 1 without touch, and with it.
    reads_one: [f64; 2],
    /// Share of time for which a sensor is stuck at 0 and at 1.
    share: Stuck,
    /// Rate at which what is stuck gets free (1/s).
    recovery: f64,
}

impl TouchChannel {
    pub fn new(sensors: &Tactile) -> Self {
        Self {
            reads_one: [sensors.false_positive, 1.0 - sensors.false_negative],
            share: [sensors.false_negative, sensors.false_positive],
            recovery: RECOVERY,
        }
    }

    /// Before the first reading.
    pub fn start(&self) -> Stuck {
        self.share
    }

    /// After `h` seconds and a reading of a sensor that is touched with probability `touch`: the
    /// probabilities, and the log-likelihood of the reading.
    pub fn read(&self, stuck: Stuck, h: f64, touch: f64, reading: bool) -> (Stuck, f64) {
        // what may have happened since the last reading
        let freed = 1.0 - libm::exp(-self.recovery * h);
        let stuck: Stuck = std::array::from_fn(|k| stuck[k] + freed * (self.share[k] - stuck[k]));
        let works = 1.0 - stuck[0] - stuck[1];

        // Bayes' rule
        let one = touch * self.reads_one[1] + (1.0 - touch) * self.reads_one[0];
        let of_working = if reading { one } else { 1.0 - one };
        let of_stuck = [0, 1].map(|at| {
            if reading == (at == 1) {
                1.0 - SLIP
            } else {
                SLIP
            }
        });
        let joint: Stuck = std::array::from_fn(|k| stuck[k] * of_stuck[k]);
        let likelihood = works * of_working + joint[0] + joint[1];
        (joint.map(|joint| joint / likelihood), libm::log(likelihood))
    }
}

/// Rate at which a stuck sensor gets free (1/s).
const RECOVERY: f64 = 0.5;

/// Probability that a stuck sensor reads the other value after all.
const SLIP: f64 = 0.01;
