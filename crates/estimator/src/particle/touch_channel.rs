//! What a binary tactile sensor says over time (contact mode): [`TouchChannel`].

use crate::setup::Tactile;

/// Probabilities that a sensor is stuck at 0 and at 1.
type Stuck = [f64; 2];

/// What a particle believes of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SensorBelief {
    stuck: Stuck,
    /// If it works, in which quarter the probability of a touch lies from which on it feels it. Within a
    /// quarter that counts as drawn anew in every row.
    felt_from: [f64; QUARTERS],
}

impl SensorBelief {
    /// Its numbers, to be stored in columns.
    pub const LEN: usize = 2 + QUARTERS;

    /// From its numbers.
    pub fn of([zero, one, felt_from @ ..]: [f64; Self::LEN]) -> Self {
        Self {
            stuck: [zero, one],
            felt_from,
        }
    }

    /// Its numbers.
    pub fn fields(&self) -> [&f64; Self::LEN] {
        let ([zero, one], [a, b, c, d]) = (&self.stuck, &self.felt_from);
        [zero, one, a, b, c, d]
    }
}

/// A sensor that works, or is stuck at one reading for a while; which, is not known, but inferred
/// from its readings, particle by particle (docs/method.md, "Contact mode").
///
/// Readings of a sensor that misses a touch now will miss it in the next frame, too: they count
/// once, not frame by frame. So does what is not known of a contact, its gap or whether it presses: it is
/// felt where its probability of being so exceeds a number between 0 and 1, that stays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TouchChannel {
    /// Of a sensor that works: probability of reading 1 without touch, and with it.
    reads_one: [f64; 2],
    /// Share of time for which a sensor is stuck at 0 and at 1.
    share: Stuck,
    /// Rate at which what is stuck gets free, and `felt_from` changes (1/s).
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
    pub fn start(&self) -> SensorBelief {
        SensorBelief {
            stuck: self.share,
            felt_from: [QUARTER; QUARTERS],
        }
    }

    /// Probability that within `h` seconds what is stuck gets free: the same for all particles.
    pub fn freed(&self, h: f64) -> f64 {
        1.0 - libm::exp(-self.recovery * h)
    }

    /// After some time, in which what is stuck is [`freed`](Self::freed), and a reading of a sensor that is
    /// touched with probability `touch`: what is believed, and the log-likelihood of the reading.
    pub fn read(
        &self,
        SensorBelief { stuck, felt_from }: SensorBelief,
        freed: f64,
        touch: f64,
        reading: bool,
    ) -> (SensorBelief, f64) {
        // what may have happened since the last reading
        let repaired = freed * (stuck[0] + stuck[1]) * (1.0 - self.share[0] - self.share[1]);
        let stuck: Stuck = std::array::from_fn(|k| stuck[k] + freed * (self.share[k] - stuck[k]));
        let works = 1.0 - stuck[0] - stuck[1];
        // a sensor that was stuck has told nothing of the contact
        let known = (1.0 - freed) * (1.0 - repaired / works);
        let felt_from = felt_from.map(|share| QUARTER + known * (share - QUARTER));

        // Bayes' rule
        let of_working = [0, 1].map(|touched| {
            let one = self.reads_one[touched];
            if reading { one } else { 1.0 - one }
        });
        let of_stuck = [0, 1].map(|at| {
            if reading == (at == 1) {
                1.0 - SLIP
            } else {
                SLIP
            }
        });
        let joint: Stuck = std::array::from_fn(|k| stuck[k] * of_stuck[k]);
        let of_quarters: [f64; QUARTERS] = std::array::from_fn(|k| {
            let felt = (QUARTERS as f64 * touch - k as f64).clamp(0.0, 1.0);
            felt_from[k] * ((1.0 - felt) * of_working[0] + felt * of_working[1])
        });
        let of_works: f64 = of_quarters.iter().sum();
        let likelihood = works * of_works + joint[0] + joint[1];
        let after = SensorBelief {
            stuck: joint.map(|joint| joint / likelihood),
            felt_from: of_quarters.map(|quarter| quarter / of_works),
        };
        (after, libm::log(likelihood))
    }

    /// A reading by the same rules, `h` seconds after the state given, with a touch of this probability,
    /// drawn with three uniform numbers; with the state then.
    pub fn drawn(
        &self,
        before: DrawnSensor,
        h: f64,
        touch: f64,
        [change, turn, read]: [f64; 3],
    ) -> (DrawnSensor, bool) {
        let freed = self.freed(h);
        let state = match change < freed {
            true => self.state_at(change / freed),
            false => before.state,
        };
        let repaired = before.state != SensorState::Works && state == SensorState::Works;
        let felt_from = match turn < freed {
            true => turn / freed,
            false if repaired => (turn - freed) / (1.0 - freed),
            false => before.felt_from,
        };
        let reading = match state {
            SensorState::Works => self.drawn_working(touch, [felt_from, read]),
            SensorState::StuckAt(false) => read < SLIP,
            SensorState::StuckAt(true) => read < 1.0 - SLIP,
        };
        (DrawnSensor { state, felt_from }, reading)
    }

    /// A reading of a sensor that works, drawn with two uniform numbers, of which the first is the
    /// probability from which on it feels a touch.
    pub fn drawn_working(&self, touch: f64, [felt_from, read]: [f64; 2]) -> bool {
        read < self.reads_one[usize::from(felt_from < touch)]
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

/// A sensor of which all is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DrawnSensor {
    pub state: SensorState,
    /// Probability of a touch from which on it feels it.
    pub felt_from: f64,
}

/// Whether a sensor works.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SensorState {
    Works,
    /// It gives this reading whatever it touches.
    StuckAt(bool),
}

/// Probability that a sensor feels a contact, from its impulse in units of the sensor's felt_from,
/// and its gap in units of what is not known of it. A contact that rests without pressing may or may
/// not be felt, and the felt_from is not known exactly.
pub(crate) fn felt(impulse: f64, gap: f64) -> f64 {
    let near = 0.5 * libm::exp(-0.5 * gap.max(0.0) * gap.max(0.0));
    if impulse > 0.0 {
        near.max(1.0 - 0.5 / (1.0 + impulse * impulse))
    } else {
        near
    }
}

/// The same of a contact that may be idle: no step tells whether one that is near presses (docs/method.md
/// (38)).
pub(crate) fn felt_or_idle(impulse: f64, gap: f64, idle: bool) -> f64 {
    match idle && gap < NEAR {
        true => PRESSES,
        false => felt(impulse, gap),
    }
}

/// Gap, in units of what is not known of it, within which an idle contact may press or not.
const NEAR: f64 = 2.0;

/// Probability that an idle contact which is near presses.
const PRESSES: f64 = 0.5;

/// Parts from 0 to 1, and the size of each.
const QUARTERS: usize = 4;
const QUARTER: f64 = 1.0 / QUARTERS as f64;

/// Rate at which a stuck sensor gets free, and `felt_from` changes (1/s).
const RECOVERY: f64 = 0.5;

/// Probability that a stuck sensor reads the other value after all.
const SLIP: f64 = 0.01;

#[cfg(test)]
mod tests {
    use super::*;

    fn channel() -> TouchChannel {
        TouchChannel::new(&Tactile::default())
    }

    /// log-likelihood of `rows` equal readings of a contact.
    fn evidence(rows: usize, touch: f64, reading: bool) -> f64 {
        evidence_of(std::iter::repeat_n(reading, rows), touch)
    }

    fn evidence_of(readings: impl Iterator<Item = bool>, touch: f64) -> f64 {
        let (mut belief, mut sum) = (channel().start(), 0.0);
        for reading in readings {
            let (next, log_likelihood) =
                channel().read(belief, channel().freed(1.0 / 30.0), touch, reading);
            (belief, sum) = (next, sum + log_likelihood);
        }
        sum
    }

    #[test]
    fn the_likelihoods_of_both_readings_sum_to_one() {
        for touch in [0.0, 0.3, 0.5, 1.0] {
            for [zero, one] in [[0.05, 0.01], [0.9, 0.0], [0.0, 0.7]] {
                for [a, b, c, d] in [[QUARTER; 4], [0.7, 0.0, 0.1, 0.2]] {
                    let belief = SensorBelief::of([zero, one, a, b, c, d]);
                    let of = |reading| {
                        libm::exp(
                            channel()
                                .read(belief, channel().freed(0.1), touch, reading)
                                .1,
                        )
                    };
                    assert!(
                        (of(false) + of(true) - 1.0).abs() < 1e-12,
                        "{touch}, {belief:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_reading_that_stays_wrong_counts_once_not_row_by_row() {
        // independent misses of 5 % would count 3 each
        let touched = 1.0;
        let (few, many) = (evidence(5, touched, false), evidence(100, touched, false));
        assert!((-6.0..-2.0).contains(&few), "{few}");
        assert!(many > few - 10.0, "{many}");
        assert!(evidence(100, touched, true) > -8.0);
    }

    #[test]
    fn an_idle_contact_explains_readings_of_either_kind_and_no_mixture() {
        let against = |readings: Vec<bool>| {
            let idle = evidence_of(readings.iter().copied(), PRESSES);
            idle - evidence_of(readings.into_iter(), 0.0)
        };
        // zeros tell little against an idle contact, ones tell for it what a sensor stuck at 1 does not
        let zeros = against(vec![false; 300]);
        assert!((-4.0..0.0).contains(&zeros), "{zeros}");
        let ones = against(vec![true; 10]);
        assert!(ones > 1.5, "{ones}");

        // false alarms among zeros tell nothing for it, however many they are
        let alarms = |every: usize| (0..300).map(|row| row % every == every - 1).collect();
        for every in [30, 60, 100] {
            let told = against(alarms(every));
            assert!((-12.0..1.0).contains(&told), "{told}, every {every} rows");
        }
    }

    #[test]
    fn a_wrong_reading_after_right_ones_makes_the_sensor_suspect() {
        let (channel, touched) = (channel(), 1.0);
        let (before, _) = channel.read(channel.start(), channel.freed(0.03), touched, true);
        let (after, _) = channel.read(before, channel.freed(0.03), touched, false);
        assert!(
            after.stuck[0] > 10.0 * before.stuck[0] && after.stuck[1] < before.stuck[1],
            "{before:?}, {after:?}"
        );
    }

    /// Share of 200,000 sensors that read each series of four readings, and its likelihood.
    fn drawn_and_expected(touches: [f64; 4]) -> Vec<(f64, f64)> {
        use stickslip_filter::Streams;
        let channel = channel();
        let mut counts = [0_u32; 16];
        let sensors: u32 = 200_000;
        for sensor in 0..sensors {
            let draw = Streams::new(5).at(u64::from(sensor));
            let mut state = DrawnSensor {
                state: channel.state_at(draw.uniform(0, 9)),
                felt_from: draw.uniform(0, 10),
            };
            let mut read = 0;
            for (row, touch) in (0..).zip(touches) {
                let uniform = std::array::from_fn(|k| draw.uniform(row, k as u32));
                let drawn = channel.drawn(state, 0.4, touch, uniform);
                state = drawn.0;
                read = 2 * read + usize::from(drawn.1);
            }
            counts[read] += 1;
        }
        let of = |read: usize| {
            let (mut belief, mut log_likelihood) = (channel.start(), 0.0);
            for (row, touch) in touches.into_iter().enumerate() {
                let reading = read >> (3 - row) & 1 == 1;
                let (next, more) = channel.read(belief, channel.freed(0.4), touch, reading);
                (belief, log_likelihood) = (next, log_likelihood + more);
            }
            libm::exp(log_likelihood)
        };
        let share = |count: u32| f64::from(count) / f64::from(sensors);
        (counts.into_iter().map(share).zip((0..16).map(of))).collect()
    }

    #[test]
    fn readings_drawn_come_as_often_as_their_likelihood_says() {
        // where touches divide no quarter
        for touches in [[0.0, 1.0, 1.0, 0.0], [0.75, 0.5, 0.5, 0.25]] {
            for (read, (share, expected)) in drawn_and_expected(touches).into_iter().enumerate() {
                let error = (share - expected) / (expected / 200_000.0).sqrt();
                assert!(
                    error.abs() < 4.5,
                    "{touches:?}, {read:04b}: {share}, {expected}"
                );
            }
        }
    }

    #[test]
    fn felt_grows_with_the_impulse_and_falls_with_the_gap() {
        assert_eq!(felt(0.0, 0.0), 0.5);
        assert!(felt(3.0, 0.0) > 0.9 && felt(0.0, 3.0) < 0.01);
        assert!(felt(0.0, f64::INFINITY) == 0.0 && felt(f64::INFINITY, 0.0) == 1.0);
    }
}
