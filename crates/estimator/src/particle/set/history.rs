//! Past poses that the particles keep, so that a camera pose that shows the past can be weighed:
//! [`PoseHistory`].

use std::collections::VecDeque;

use crate::particle::sensor::observation::LatencyCompensation;

/// Number of slots by which a history grows.
const GROWTH: usize = 8;

/// Times of the past poses that every particle keeps, each with its slot (columns of the particle
/// set).
#[derive(Clone, Debug)]
pub(crate) struct PoseHistory {
    /// Time back to which poses are needed (s); 0: the particles keep none.
    depth: f64,
    /// (time, slot) in order of time, the first row of the estimate first.
    kept: VecDeque<(f64, usize)>,
    free: Vec<usize>,
    slots: usize,
}

impl PoseHistory {
    /// A history of `depth` seconds, which begins at `time` in slot 0.
    pub fn new(depth: f64, time: f64) -> Self {
        let slots = if depth > 0.0 { GROWTH } else { 0 };
        Self {
            depth,
            kept: (0..slots.min(1)).map(|slot| (time, slot)).collect(),
            free: (1..slots).rev().collect(),
            slots,
        }
    }

    /// Number of slots.
    pub fn slots(&self) -> usize {
        self.slots
    }

    /// Returns a slot for the pose at `time`, the latest; it may be one that is no longer needed.
    /// The history grows if none is left. Returns 0 if no history is kept.
    pub fn push(&mut self, time: f64) -> usize {
        if self.slots == 0 {
            return 0;
        }
        // one pose from before the depth stays, to interpolate from
        while self.kept.len() > 1 && self.kept[1].0 < time - self.depth {
            self.free
                .extend(self.kept.pop_front().map(|(_, slot)| slot));
        }
        if self.free.is_empty() {
            self.free.extend((self.slots..self.slots + GROWTH).rev());
            self.slots += GROWTH;
        }
        let slot = self.free.pop().unwrap_or(0);
        self.kept.push_back((time, slot));
        slot
    }

    /// Returns times (s) and slots of the poses that are kept, in order of time.
    pub fn kept(&self) -> impl Iterator<Item = (f64, usize)> {
        self.kept.iter().copied()
    }

    /// Returns the poses between which `time` lies; before the first one, the first one counts.
    /// `None` if no history is kept.
    pub fn at(&self, time: f64) -> Option<LatencyCompensation> {
        let shown = time.max(self.kept.front()?.0);
        let later = self.kept.iter().position(|(t, _)| *t >= shown);
        let later = later.unwrap_or(self.kept.len() - 1);
        let (earlier, later) = (self.kept[later.saturating_sub(1)], self.kept[later]);
        let span = later.0 - earlier.0;
        let fraction = if span > 0.0 {
            (shown - earlier.0) / span
        } else {
            0.0
        };
        Some(LatencyCompensation {
            earlier: earlier.1,
            later: later.1,
            fraction,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns what a particle would hold in each slot: the time at which it was written.
    fn replay(depth: f64, times: &[f64], lookback: f64) -> Vec<f64> {
        let mut history = PoseHistory::new(depth, times[0]);
        let mut slots = vec![f64::NAN; 1000];
        slots[0] = times[0];
        let shown = |history: &PoseHistory, slots: &[f64], time: f64| {
            let LatencyCompensation {
                earlier,
                later,
                fraction,
            } = history.at(time).expect("a history");
            slots[earlier] + (slots[later] - slots[earlier]) * fraction
        };
        let rows = times[1..].iter().map(|time| {
            slots[history.push(*time)] = *time;
            shown(&history, &slots, time - lookback)
        });
        rows.collect()
    }

    #[test]
    fn at_interpolates_between_the_poses_around_a_time_at_any_rate() {
        for rate in [10.0, 30.0, 1000.0] {
            let times: Vec<f64> = (0..400)
                .map(|k| f64::from(k) / rate + 1e-3 * f64::from(k % 3))
                .collect();
            for (found, time) in replay(0.1, &times, 0.07).iter().zip(&times[1..]) {
                let expected = (time - 0.07).max(times[0]);
                assert!(
                    (found - expected).abs() < 1e-12,
                    "{rate} Hz: {found}, {expected}"
                );
            }
        }
    }

    #[test]
    fn slots_grow_with_the_rate_and_are_used_again() {
        let mut history = PoseHistory::new(0.1, 0.0);
        (1..5000).for_each(|k| {
            history.push(f64::from(k) * 1e-3);
        });
        assert!((100..130).contains(&history.slots()), "{}", history.slots());
        assert_eq!(PoseHistory::new(0.0, 0.0).slots(), 0);
        assert_eq!(PoseHistory::new(0.0, 0.0).at(1.0), None);
    }
}
