//! What a binary tactile sensor says over time (contact mode): [`TouchChannel`].

use crate::setup::Tactile;

/// Probabilities that a sensor is stuck at 0 and at 1.
pub(crate) type Stuck = [f64; 2];

/// A sensor that works, or is stuck at one reading for a while; which, is not known, but inferred
/// from its readings, particle by particle (docs/method.md, "Contact mode").
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

/// Probability that a sensor feels a contact, from its impulse in units of the sensor's threshold,
/// and its gap in units of what is not known of it. A contact that rests without pressing may or may
/// not be felt, and the threshold is not known exactly.
pub(crate) fn felt(impulse: f64, gap: f64) -> f64 {
    let near = 0.5 * libm::exp(-0.5 * gap.max(0.0) * gap.max(0.0));
    if impulse > 0.0 {
        near.max(1.0 - 0.5 / (1.0 + impulse * impulse))
    } else {
        near
    }
}

/// Rate at which a stuck sensor gets free (1/s).
const RECOVERY: f64 = 0.5;

/// Probability that a stuck sensor reads the other value after all.
const SLIP: f64 = 0.01;

#[cfg(test)]
mod tests {
    use super::*;

    fn channel() -> TouchChannel {
        TouchChannel::new(&Tactile::default())
    }

    /// log-likelihood of `rows` equal readings of a sensor that is touched or not.
    fn evidence(rows: usize, touch: f64, reading: bool) -> f64 {
        let (mut stuck, mut sum) = (channel().start(), 0.0);
        for _ in 0..rows {
            let (next, log_likelihood) = channel().read(stuck, 1.0 / 30.0, touch, reading);
            (stuck, sum) = (next, sum + log_likelihood);
        }
        sum
    }

    #[test]
    fn the_likelihoods_of_both_readings_sum_to_one() {
        for touch in [0.0, 0.3, 1.0] {
            for stuck in [[0.05, 0.01], [0.9, 0.0], [0.0, 0.7]] {
                let of = |reading| libm::exp(channel().read(stuck, 0.1, touch, reading).1);
                assert!(
                    (of(false) + of(true) - 1.0).abs() < 1e-12,
                    "{touch}, {stuck:?}"
                );
            }
        }
    }

    #[test]
    fn a_reading_that_stays_wrong_counts_once_not_row_by_row() {
        // independent misses of 5 % would count 3 each
        let (few, many) = (evidence(5, 1.0, false), evidence(100, 1.0, false));
        assert!((-6.0..-2.0).contains(&few), "{few}");
        assert!(many > few - 10.0, "{many}");
        assert!(evidence(100, 1.0, true) > -8.0);
    }

    #[test]
    fn a_wrong_reading_after_right_ones_makes_the_sensor_suspect() {
        let channel = channel();
        let (stuck, _) = channel.read(channel.start(), 0.03, 1.0, true);
        let (suspect, _) = channel.read(stuck, 0.03, 1.0, false);
        assert!(
            suspect[0] > 10.0 * stuck[0] && suspect[1] < stuck[1],
            "{stuck:?}, {suspect:?}"
        );
    }

    #[test]
    fn felt_grows_with_the_impulse_and_falls_with_the_gap() {
        assert_eq!(felt(0.0, 0.0), 0.5);
        assert!(felt(3.0, 0.0) > 0.9 && felt(0.0, 3.0) < 0.01);
        assert!(felt(0.0, f64::INFINITY) == 0.0 && felt(f64::INFINITY, 0.0) == 1.0);
    }
}
