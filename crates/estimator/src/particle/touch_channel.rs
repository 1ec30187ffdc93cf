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

    /// A reading by the same rules: of a sensor that is in `state`, drawn with three uniform numbers,
    /// after `h` seconds with a touch felt with probability `touch`; with its state then.
    pub fn drawn(
        &self,
        state: SensorState,
        h: f64,
        touch: f64,
        [change, feel, read]: [f64; 3],
    ) -> (SensorState, bool) {
        let freed = 1.0 - libm::exp(-self.recovery * h);
        let state = match change < freed {
            true => self.state_at(change / freed),
            false => state,
        };
        let one = match state {
            SensorState::Works => return (state, self.drawn_working(touch, [feel, read])),
            SensorState::StuckAt(false) => SLIP,
            SensorState::StuckAt(true) => 1.0 - SLIP,
        };
        (state, read < one)
    }

    /// A reading of a sensor that works, drawn with two uniform numbers.
    pub fn drawn_working(&self, touch: f64, [feel, read]: [f64; 2]) -> bool {
        read < self.reads_one[usize::from(feel < touch)]
    }

    /// The state of a sensor of which nothing is known, by a uniform number.
    pub fn state_at(&self, uniform: f64) -> SensorState {
        let [zero, one] = self.share;
        match uniform {
            _ if uniform < zero => SensorState::StuckAt(false),
            _ if uniform < zero + one => SensorState::StuckAt(true),
            _ => SensorState::Works,
        }
    }
}

/// Whether a sensor works.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SensorState {
    Works,
    /// It gives this reading whatever it touches.
    StuckAt(bool),
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

/// The same for a contact that may be idle, given the reading: an idle one that is near may press or
/// not, so that it explains either reading (docs/method.md (25)).
pub(crate) fn felt_or_idle(impulse: f64, gap: f64, idle: bool, reading: bool) -> f64 {
    match idle && gap < NEAR {
        true => f64::from(u8::from(reading)),
        false => felt(impulse, gap),
    }
}

/// Gap, in units of what is not known of it, within which an idle contact may press or not.
const NEAR: f64 = 2.0;

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
    fn readings_drawn_come_as_often_as_their_likelihood_says() {
        use stickslip_filter::Streams;
        // share of sensors that read these rows, against the product of the rows' likelihoods
        let (channel, touches) = (channel(), [0.0, 0.9, 0.9, 0.2]);
        let mut counts = [0_u32; 16];
        let sensors: u32 = 200_000;
        for sensor in 0..sensors {
            let draw = Streams::new(5).at(u64::from(sensor));
            let mut state = channel.state_at(draw.uniform(0, 9));
            let mut read = 0;
            for (row, touch) in (0..).zip(touches) {
                let uniform = std::array::from_fn(|k| draw.uniform(row, k as u32));
                let drawn = channel.drawn(state, 0.4, touch, uniform);
                state = drawn.0;
                read = 2 * read + usize::from(drawn.1);
            }
            counts[read] += 1;
        }
        for (read, count) in counts.into_iter().enumerate() {
            let (mut stuck, mut log_likelihood) = (channel.start(), 0.0);
            for (row, touch) in touches.into_iter().enumerate() {
                let reading = read >> (3 - row) & 1 == 1;
                let (next, more) = channel.read(stuck, 0.4, touch, reading);
                (stuck, log_likelihood) = (next, log_likelihood + more);
            }
            let expected = libm::exp(log_likelihood) * f64::from(sensors);
            let error = (f64::from(count) - expected) / expected.sqrt();
            assert!(error.abs() < 4.0, "{read:04b}: {count}, {expected}");
        }
    }

    #[test]
    fn felt_grows_with_the_impulse_and_falls_with_the_gap() {
        assert_eq!(felt(0.0, 0.0), 0.5);
        assert!(felt(3.0, 0.0) > 0.9 && felt(0.0, 3.0) < 0.01);
        assert!(felt(0.0, f64::INFINITY) == 0.0 && felt(f64::INFINITY, 0.0) == 1.0);
    }
}
