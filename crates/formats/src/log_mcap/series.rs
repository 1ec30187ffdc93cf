//! Measurements in the order of their times: [`Series`].

use std::f64::consts::{PI, TAU};

use stickslip_dynamics::Pose;

use crate::log_mcap::message::SECOND;

/// A measurement and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Timed<T> {
    /// Time (ns).
    pub time: i64,
    /// The measurement.
    pub value: T,
}

impl<T: Copy> Timed<T> {
    /// Something made of the measurement, at its time.
    pub(crate) fn map<U>(&self, make: impl FnOnce(T) -> U) -> Timed<U> {
        Timed {
            time: self.time,
            value: make(self.value),
        }
    }
}

/// Measurements of one thing, times rising.
pub(crate) type Series<T> = Vec<Timed<T>>;

/// A time (ns) in seconds, without rounding.
pub(crate) fn seconds_text(time: i64) -> String {
    let sign = if time < 0 { "-" } else { "" };
    let (whole, part) = (
        time.unsigned_abs() / SECOND.unsigned_abs(),
        time.unsigned_abs() % SECOND.unsigned_abs(),
    );
    format!("{sign}{whole}.{part:09}")
}

/// Adds full turns so that no angle is more than half a turn from the one before.
pub(crate) fn unwrap(poses: &mut [Timed<Pose>]) {
    let mut turns = 0.0;
    let mut before = poses.first().map_or(0.0, |pose| pose.value.theta);
    for pose in poses {
        let theta = pose.value.theta;
        turns -= ((theta - before + PI) / TAU).floor();
        before = theta;
        pose.value.theta = theta + TAU * turns;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unwrap_turns_on_over_half_a_turn() {
        let pose = |theta| Timed {
            time: 0,
            value: Pose::new(0.0, 0.0, theta),
        };
        let mut poses = [3.0, -3.0, 3.0, 0.0, -3.0, 2.0].map(pose);
        unwrap(&mut poses);
        let expected = [3.0, TAU - 3.0, 3.0, 0.0, -3.0, 2.0 - TAU];
        for (pose, expected) in poses.iter().zip(expected) {
            assert!(
                (pose.value.theta - expected).abs() < 1e-15,
                "{}",
                pose.value.theta
            );
        }
    }

    #[test]
    fn seconds_text_keeps_every_nanosecond() {
        assert_eq!(
            seconds_text(1_700_000_000_000_000_001),
            "1700000000.000000001"
        );
        assert_eq!(seconds_text(-1), "-0.000000001");
    }
}
