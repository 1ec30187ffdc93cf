//! What a binary tactile sensor says over time (contact mode): [`TouchChannel`].

use crate::setup::Tactile;

/// Probabilities that a sensor is stuck at 0 and at 1.
type Stuck = [f64; 2];

/// What a particle believes of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SensorBelief {
    stuck: Stuck,
    /// Probability that the contact presses, while it is idle, if the sensor works; else that of one
    /// that begins to be.
    presses: f64,
}

impl SensorBelief {
    /// Its numbers, to be stored in columns.
    pub const LEN: usize = 3;

    /// From its numbers.
    pub fn of([zero, one, presses]: [f64; Self::LEN]) -> Self {
        Self {
            stuck: [zero, one],
            presses,
        }
    }

    /// Its numbers.
    pub fn fields(&self) -> [&f64; Self::LEN] {
        let [zero, one] = &self.stuck;
        [zero, one, &self.presses]
    }
}

/// How a contact stands to its sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Touch {
    /// It is felt with this probability, row by row.
    Felt(f64),
    /// It is near and idle (docs/method.md (25)): no step tells whether it presses and so is felt, but
    /// it goes on as it is.
    Idle,
}

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
    /// Rate at which what is stuck gets free, and what is idle changes (1/s).
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
            presses: PRESSES,
        }
    }

    /// After `h` seconds and a reading: what is believed, and the log-likelihood of the reading.
    pub fn read(
        &self,
        SensorBelief { stuck, presses }: SensorBelief,
        h: f64,
        touch: Touch,
        reading: bool,
    ) -> (SensorBelief, f64) {
        // what may have happened since the last reading
        let freed = 1.0 - libm::exp(-self.recovery * h);
        let repaired = freed * (stuck[0] + stuck[1]) * (1.0 - self.share[0] - self.share[1]);
        let stuck: Stuck = std::array::from_fn(|k| stuck[k] + freed * (self.share[k] - stuck[k]));
        let works = 1.0 - stuck[0] - stuck[1];
        let felt = match touch {
            Touch::Felt(felt) => felt,
            Touch::Idle => {
                // a sensor that was stuck has told nothing of it
                let known = (1.0 - freed) * (1.0 - repaired / works);
                PRESSES + known * (presses - PRESSES)
            }
        };

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
        let of_works = (1.0 - felt) * of_working[0] + felt * of_working[1];
        let likelihood = works * of_works + joint[0] + joint[1];
        let after = SensorBelief {
            stuck: joint.map(|joint| joint / likelihood),
            presses: match touch {
                Touch::Felt(_) => PRESSES,
                Touch::Idle => felt * of_working[1] / of_works,
            },
        };
        (after, libm::log(likelihood))
    }

    /// A reading by the same rules, `h` seconds after the state given, drawn with four uniform
    /// numbers; with the state then.
    pub fn drawn(
        &self,
        before: DrawnSensor,
        h: f64,
        touch: Touch,
        [change, turn, feel, read]: [f64; 4],
    ) -> (DrawnSensor, bool) {
        let freed = 1.0 - libm::exp(-self.recovery * h);
        let state = match change < freed {
            true => self.state_at(change / freed),
            false => before.state,
        };
        let presses = match touch {
            Touch::Felt(_) => None,
            Touch::Idle => Some(match before.presses.filter(|_| turn >= freed) {
                Some(presses) => presses,
                None => feel < PRESSES,
            }),
        };
        let felt = match touch {
            Touch::Felt(felt) => felt,
            Touch::Idle => f64::from(u8::from(presses == Some(true))),
        };
        let reading = match state {
            SensorState::Works => self.drawn_working(felt, [feel, read]),
            SensorState::StuckAt(false) => read < SLIP,
            SensorState::StuckAt(true) => read < 1.0 - SLIP,
        };
        (DrawnSensor { state, presses }, reading)
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

/// A sensor of which all is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DrawnSensor {
    pub state: SensorState,
    /// Whether its contact presses, while that is idle.
    pub presses: Option<bool>,
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

/// A contact with this impulse and gap, in the units of [`felt`].
pub(crate) fn touch(impulse: f64, gap: f64, idle: bool) -> Touch {
    match idle && gap < NEAR {
        true => Touch::Idle,
        false => Touch::Felt(felt(impulse, gap)),
    }
}

/// Gap, in units of what is not known of it, within which an idle contact may press or not.
const NEAR: f64 = 2.0;

/// Probability that a contact presses which has just become idle.
const PRESSES: f64 = 0.5;

/// Rate at which a stuck sensor gets free, and an idle contact changes (1/s).
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
    fn evidence(rows: usize, touch: Touch, reading: bool) -> f64 {
        evidence_of(std::iter::repeat_n(reading, rows), touch)
    }

    fn evidence_of(readings: impl Iterator<Item = bool>, touch: Touch) -> f64 {
        let (mut belief, mut sum) = (channel().start(), 0.0);
        for reading in readings {
            let (next, log_likelihood) = channel().read(belief, 1.0 / 30.0, touch, reading);
            (belief, sum) = (next, sum + log_likelihood);
        }
        sum
    }

    #[test]
    fn the_likelihoods_of_both_readings_sum_to_one() {
        let idle = [0.0, 0.4, 1.0].map(|presses| (Touch::Idle, presses));
        let felt = [0.0, 0.3, 1.0].map(|felt| (Touch::Felt(felt), PRESSES));
        for (touch, presses) in idle.into_iter().chain(felt) {
            for [zero, one] in [[0.05, 0.01], [0.9, 0.0], [0.0, 0.7]] {
                let belief = SensorBelief::of([zero, one, presses]);
                let of = |reading| libm::exp(channel().read(belief, 0.1, touch, reading).1);
                assert!(
                    (of(false) + of(true) - 1.0).abs() < 1e-12,
                    "{touch:?}, {belief:?}"
                );
            }
        }
    }

    #[test]
    fn a_reading_that_stays_wrong_counts_once_not_row_by_row() {
        // independent misses of 5 % would count 3 each
        let touched = Touch::Felt(1.0);
        let (few, many) = (evidence(5, touched, false), evidence(100, touched, false));
        assert!((-6.0..-2.0).contains(&few), "{few}");
        assert!(many > few - 10.0, "{many}");
        assert!(evidence(100, touched, true) > -8.0);
    }

    #[test]
    fn an_idle_contact_explains_readings_of_either_kind_and_no_mixture() {
        let away = Touch::Felt(0.0);
        let against = |readings: Vec<bool>| {
            let idle = evidence_of(readings.iter().copied(), Touch::Idle);
            idle - evidence_of(readings.into_iter(), away)
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
        let (channel, touched) = (channel(), Touch::Felt(1.0));
        let (before, _) = channel.read(channel.start(), 0.03, touched, true);
        let (after, _) = channel.read(before, 0.03, touched, false);
        assert!(
            after.stuck[0] > 10.0 * before.stuck[0] && after.stuck[1] < before.stuck[1],
            "{before:?}, {after:?}"
        );
    }

    /// Share of 200,000 sensors that read each series of four readings, and its likelihood.
    fn drawn_and_expected(touches: [Touch; 4]) -> Vec<(f64, f64)> {
        use stickslip_filter::Streams;
        let channel = channel();
        let mut counts = [0_u32; 16];
        let sensors: u32 = 200_000;
        for sensor in 0..sensors {
            let draw = Streams::new(5).at(u64::from(sensor));
            let mut state = DrawnSensor {
                state: channel.state_at(draw.uniform(0, 9)),
                presses: None,
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
                let (next, more) = channel.read(belief, 0.4, touch, reading);
                (belief, log_likelihood) = (next, log_likelihood + more);
            }
            libm::exp(log_likelihood)
        };
        let share = |count: u32| f64::from(count) / f64::from(sensors);
        (counts.into_iter().map(share).zip((0..16).map(of))).collect()
    }

    #[test]
    fn readings_drawn_come_as_often_as_their_likelihood_says() {
        let felt = [0.0, 0.9, 0.9, 0.2].map(Touch::Felt);
        for (read, (share, expected)) in drawn_and_expected(felt).into_iter().enumerate() {
            let error = (share - expected) / (expected / 200_000.0).sqrt();
            assert!(error.abs() < 4.0, "{read:04b}: {share}, {expected}");
        }
        // of an idle contact, what was known before its sensor got stuck counts as forgotten
        let idle = [Touch::Felt(0.9), Touch::Idle, Touch::Idle, Touch::Idle];
        for (read, (share, expected)) in drawn_and_expected(idle).into_iter().enumerate() {
            assert!(
                (share - expected).abs() < 0.1 * expected + 0.002,
                "{read:04b}: {share}, {expected}"
            );
        }
    }

    #[test]
    fn felt_grows_with_the_impulse_and_falls_with_the_gap() {
        assert_eq!(felt(0.0, 0.0), 0.5);
        assert!(felt(3.0, 0.0) > 0.9 && felt(0.0, 3.0) < 0.01);
        assert!(felt(0.0, f64::INFINITY) == 0.0 && felt(f64::INFINITY, 0.0) == 1.0);
    }
}
