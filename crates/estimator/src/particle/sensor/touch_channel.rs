//! Model of a binary tactile sensor over time (robust model): [`TouchChannel`].

use stickslip_dynamics::Lanes;

use crate::setup::Tactile;
use crate::tuning::RECOVERY;

/// Number of numbers of a [`SensorBelief`], each a column.
pub(crate) const BELIEF_LEN: usize = 2 + QUARTERS;

/// Belief of W particles about a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SensorBelief<const W: usize> {
    /// Probabilities that it is stuck at 0 and at 1.
    stuck: [Lanes<W>; 2],
    /// Probabilities of the quarters in which the threshold of a working sensor may lie: it reads a
    /// touch whose probability exceeds the threshold. Within its quarter the threshold counts as
    /// drawn again in every row.
    threshold: [Lanes<W>; QUARTERS],
}

impl<const W: usize> SensorBelief<W> {
    /// Its numbers.
    pub fn fields(&self) -> [&Lanes<W>; BELIEF_LEN] {
        let ([zero, one], [a, b, c, d]) = (&self.stuck, &self.threshold);
        [zero, one, a, b, c, d]
    }

    /// Its numbers, to be written.
    pub fn fields_mut(&mut self) -> [&mut Lanes<W>; BELIEF_LEN] {
        let ([zero, one], [a, b, c, d]) = (&mut self.stuck, &mut self.threshold);
        [zero, one, a, b, c, d]
    }
}

/// A sensor that works, or is stuck at one reading for a while. Its state is inferred from its
/// readings, particle by particle (docs/model.md).
///
/// A sensor that misses a touch now will miss it in the next frame, too: such readings count once,
/// not frame by frame. So does what is not known of a contact, its gap or whether it presses. The
/// contact is felt if its probability of being so exceeds a number between 0 and 1 that stays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TouchChannel {
    /// Probability that a sensor reads 1 without touch, and with it. One that is stuck at 0 or 1
    /// reads as if it were never touched, or always: equal readings never tell it from a contact
    /// that stays as it is.
    reads_one: [f64; 2],
    /// Share of time for which a sensor is stuck at 0 and at 1.
    share: [f64; 2],
    /// Rate at which a stuck sensor gets free, and `threshold` changes (1/s).
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

    /// Returns the belief before the first reading.
    pub fn start<const W: usize>(&self) -> SensorBelief<W> {
        SensorBelief {
            stuck: self.share.map(Lanes::splat),
            threshold: [Lanes::splat(QUARTER); QUARTERS],
        }
    }

    /// Returns the probability that a stuck sensor gets free within `h` seconds. It is equal for
    /// all particles.
    pub fn freed(&self, h: f64) -> f64 {
        1.0 - libm::exp(-self.recovery * h)
    }

    /// Returns the belief about a sensor after some time, in which a stuck one is
    /// [`freed`](Self::freed).
    #[inline(always)]
    pub fn later<const W: usize>(
        &self,
        SensorBelief { stuck, threshold }: SensorBelief<W>,
        freed: f64,
    ) -> SensorBelief<W> {
        let one = Lanes::splat(1.0);
        let repaired = (stuck[0] + stuck[1]) * freed * (1.0 - self.share[0] - self.share[1]);
        let later = |stuck, share| stuck + (Lanes::splat(share) - stuck) * freed;
        let [at_zero, at_one] = stuck;
        let stuck = [later(at_zero, self.share[0]), later(at_one, self.share[1])];
        let works = one - stuck[0] - stuck[1];
        // a sensor that was stuck has said nothing of the contact
        let known = (one - repaired / works) * (1.0 - freed);
        let quarter = Lanes::splat(QUARTER);
        let known_of = |share| quarter + known * (share - quarter);
        let [a, b, c, d] = threshold;
        SensorBelief {
            stuck,
            threshold: [known_of(a), known_of(b), known_of(c), known_of(d)],
        }
    }

    /// Takes a reading of a sensor that is touched with probability `touch`. Returns the belief
    /// after it, and the log-likelihood of the reading.
    #[inline(always)]
    pub fn read<const W: usize>(
        &self,
        SensorBelief { stuck, threshold }: SensorBelief<W>,
        touch: Lanes<W>,
        reading: bool,
    ) -> (SensorBelief<W>, Lanes<W>) {
        let one = Lanes::splat(1.0);
        let [of_untouched, of_touched] = self
            .reads_one
            .map(|one| if reading { one } else { 1.0 - one });
        let (of_zero, of_one) = (stuck[0] * of_untouched, stuck[1] * of_touched);
        let works = one - stuck[0] - stuck[1];
        let mut of_quarters = threshold;
        for (k, share) in of_quarters.iter_mut().enumerate() {
            let touched = touch * QUARTERS as f64 - Lanes::splat(k as f64);
            let touched = touched.max(Lanes::ZERO).min(one);
            *share = *share * ((one - touched) * of_untouched + touched * of_touched);
        }
        let [a, b, c, d] = of_quarters;
        let of_works = a + b + c + d;
        let likelihood = works * of_works + of_zero + of_one;
        let after = SensorBelief {
            stuck: [of_zero / likelihood, of_one / likelihood],
            threshold: [a / of_works, b / of_works, c / of_works, d / of_works],
        };
        (after, likelihood.ln())
    }

    /// Returns the probability of a reading of the contact that makes it likeliest.
    pub fn most_likely(&self, reading: bool) -> f64 {
        let [untouched, touched] = self.reads_one;
        match reading {
            true => touched.max(untouched),
            false => 1.0 - touched.min(untouched),
        }
    }

    /// Draws a reading by these rules, `h` seconds after the state `before`, with a touch of this
    /// probability and three uniform numbers. Also returns the new state.
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
        let threshold = match turn < freed {
            true => turn / freed,
            false if repaired => (turn - freed) / (1.0 - freed),
            false => before.threshold,
        };
        let reading = match state {
            SensorState::Works => self.drawn_working(touch, [threshold, read]),
            SensorState::StuckAt(one) => read < self.reads_one[usize::from(one)],
        };
        (DrawnSensor { state, threshold }, reading)
    }

    /// Draws a reading of a working sensor with two uniform numbers. The first is the probability
    /// from which on it feels a touch.
    pub fn drawn_working(&self, touch: f64, [threshold, read]: [f64; 2]) -> bool {
        read < self.reads_one[usize::from(threshold < touch)]
    }

    /// Returns the state of a sensor of which nothing is known, by a uniform number.
    pub fn state_at(&self, uniform: f64) -> SensorState {
        let [zero, one] = self.share;
        match uniform {
            _ if uniform < zero => SensorState::StuckAt(false),
            _ if uniform < zero + one => SensorState::StuckAt(true),
            _ => SensorState::Works,
        }
    }
}

/// A sensor whose state is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DrawnSensor {
    pub state: SensorState,
    /// Probability of a touch from which on the sensor feels it.
    pub threshold: f64,
}

/// State of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SensorState {
    Works,
    /// It gives this reading whatever it touches.
    StuckAt(bool),
}

/// Returns the probability that a sensor feels a contact, from its impulse in units of the sensor's
/// threshold, and its gap in units of the gap's uncertainty. A contact that rests without pressing
/// may or may not be felt, and the threshold is not known exactly.
#[inline(always)]
pub(crate) fn touch_probability<const W: usize>(impulse: Lanes<W>, gap: Lanes<W>) -> Lanes<W> {
    let (one, half) = (Lanes::splat(1.0), Lanes::splat(0.5));
    let apart = gap.max(Lanes::ZERO);
    let near = (apart * -0.5 * apart).exp() * 0.5;
    let pressed = near.max(one - half / (one + impulse * impulse));
    impulse.gt(Lanes::ZERO).select(pressed, near)
}

/// Number of parts from 0 to 1, and the size of each.
const QUARTERS: usize = 4;
const QUARTER: f64 = 1.0 / QUARTERS as f64;

#[cfg(test)]
mod tests {
    use super::*;

    fn channel() -> TouchChannel {
        TouchChannel::new(&Tactile::default())
    }

    /// Returns the belief after `h` seconds and a reading, and the log-likelihood of the reading.
    fn read_after(
        h: f64,
        belief: SensorBelief<1>,
        touch: f64,
        reading: bool,
    ) -> (SensorBelief<1>, f64) {
        let channel = channel();
        let later = channel.later(belief, channel.freed(h));
        let (after, log_likelihood) = channel.read(later, Lanes([touch]), reading);
        (after, log_likelihood.0[0])
    }

    /// log-likelihood of `rows` equal readings of a contact.
    fn evidence(rows: usize, touch: f64, reading: bool) -> f64 {
        evidence_of(std::iter::repeat_n(reading, rows), touch)
    }

    fn evidence_of(readings: impl Iterator<Item = bool>, touch: f64) -> f64 {
        let (mut belief, mut sum) = (channel().start(), 0.0);
        for reading in readings {
            let (next, log_likelihood) = read_after(1.0 / 30.0, belief, touch, reading);
            (belief, sum) = (next, sum + log_likelihood);
        }
        sum
    }

    #[test]
    fn the_likelihoods_of_both_readings_sum_to_one() {
        for touch in [0.0, 0.3, 0.5, 1.0] {
            for [zero, one] in [[0.05, 0.01], [0.9, 0.0], [0.0, 0.7]] {
                for [a, b, c, d] in [[QUARTER; 4], [0.7, 0.0, 0.1, 0.2]] {
                    let mut belief = channel().start();
                    let numbers = [zero, one, a, b, c, d];
                    for (to, number) in belief.fields_mut().into_iter().zip(numbers) {
                        *to = Lanes([number]);
                    }
                    let of = |reading| libm::exp(read_after(0.1, belief, touch, reading).1);
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
    fn a_wrong_reading_after_right_ones_makes_the_sensor_suspect() {
        let (before, _) = read_after(0.03, channel().start(), 1.0, true);
        let (after, _) = read_after(0.03, before, 1.0, false);
        assert!(
            after.stuck[0].0[0] > 10.0 * before.stuck[0].0[0]
                && after.stuck[1].0[0] < before.stuck[1].0[0],
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
                threshold: draw.uniform(0, 10),
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
                let (next, more) = read_after(0.4, belief, touch, reading);
                (belief, log_likelihood) = (next, log_likelihood + more);
            }
            libm::exp(log_likelihood)
        };
        let share = |count: u32| f64::from(count) / f64::from(sensors);
        (counts.into_iter().map(share).zip((0..16).map(of))).collect()
    }

    #[test]
    fn readings_drawn_come_as_often_as_their_likelihood_says() {
        // probabilities that divide no quarter
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
    fn touch_probability_grows_with_the_impulse_and_falls_with_the_gap() {
        let touched = |impulse, gap| touch_probability(Lanes([impulse]), Lanes([gap])).0[0];
        assert_eq!(touched(0.0, 0.0), 0.5);
        assert!(touched(3.0, 0.0) > 0.9 && touched(0.0, 3.0) < 0.01);
        assert!(touched(0.0, f64::INFINITY) == 0.0 && touched(f64::INFINITY, 0.0) == 1.0);
    }
}
