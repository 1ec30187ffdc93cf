//! Poses that a tracking camera measures: [`TrackingCamera`], [`CameraMeasurement`].

use stickslip_dynamics::Pose;
use stickslip_filter::{Purpose, Streams};

use crate::trace::Trace;

/// Numbers of a frame's random draws; the touch sensors count theirs from 0 up.
const OBJECT: u32 = u32::MAX;
const PUSHER: u32 = u32::MAX - 1;
const REPEAT: u32 = u32::MAX - 2;

/// Number of the draws of a finger, the pusher's for the first.
fn finger_number(finger: usize) -> u32 {
    match finger {
        0 => PUSHER,
        _ => REPEAT - finger as u32,
    }
}

/// A camera that tracks object and pusher, by its errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackingCamera {
    /// Standard deviation of one object position, per axis (m).
    pub position_std: f64,
    /// Standard deviation of one object angle (rad).
    pub orientation_std: f64,
    /// Standard deviation of one pusher position, per axis (m).
    pub pusher_position_std: f64,
    /// Standard deviation of one pusher angle (rad).
    pub pusher_orientation_std: f64,
    /// Time over which the pusher's error forgets itself (s); 0: every frame has its own. A tracker
    /// filters what it sees, so that its error drifts: an Ornstein–Uhlenbeck process.
    pub pusher_memory: f64,
    /// Age of the object's pose when it is reported (s).
    pub latency: f64,
    /// Share of frames that repeat the one before.
    pub repeats: f64,
}

/// Measurement of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraMeasurement {
    /// Pose of the object.
    pub object: Pose,
    /// Pose of the pusher.
    pub pusher: Pose,
    /// Poses of a hand's other fingers; each has an error as the pusher's, and of its own.
    pub other_fingers: Vec<Pose>,
    /// True if the frame repeats the one before.
    pub repeated: bool,
}

impl TrackingCamera {
    /// Measures without error.
    pub const EXACT: Self = Self {
        position_std: 0.0,
        orientation_std: 0.0,
        pusher_position_std: 0.0,
        pusher_orientation_std: 0.0,
        pusher_memory: 0.0,
        latency: 0.0,
        repeats: 0.0,
    };

    /// One measurement per frame of `trace`.
    pub fn measure(&self, trace: &Trace, seed: u64) -> Vec<CameraMeasurement> {
        let streams = Streams::new(seed).of(Purpose::Measure);
        let mut measured: Vec<CameraMeasurement> = Vec::with_capacity(trace.frames.len());
        let fingers = trace.frames.first();
        let fingers = fingers.map_or(0, |frame| 1 + frame.other_fingers.len());
        let mut drifts = vec![[0.0; 3]; fingers];
        for (k, frame) in trace.frames.iter().enumerate() {
            let draw = streams.at(k as u64);
            let noisy = |pose: Pose, [x, y, theta]: [f64; 3], [position, angle]: [f64; 2]| {
                Pose::new(
                    pose.x + position * x,
                    pose.y + position * y,
                    pose.theta + angle * theta,
                )
            };

            // a finger's error keeps a part of what it was, and its variance
            let kept = match k.checked_sub(1) {
                Some(before) if self.pusher_memory > 0.0 => {
                    let age = frame.time - trace.frames[before].time;
                    libm::exp(-age / self.pusher_memory)
                }
                _ => 0.0,
            };
            let fresh = (1.0 - kept * kept).sqrt();
            for (finger, drift) in drifts.iter_mut().enumerate() {
                let news = draw.normals::<3>(finger_number(finger), 0);
                for (error, new) in drift.iter_mut().zip(news) {
                    *error = kept * *error + fresh * new;
                }
            }
            let pusher_std = [self.pusher_position_std, self.pusher_orientation_std];
            let others = frame.other_fingers.iter().zip(&drifts[1..]);
            let repeated = measured
                .last()
                .cloned()
                .filter(|_| draw.uniform(REPEAT, 0) < self.repeats);
            measured.push(repeated.map_or_else(
                || {
                    CameraMeasurement {
                        object: noisy(
                            object_at(trace, frame.time - self.latency),
                            draw.normals(OBJECT, 0),
                            [self.position_std, self.orientation_std],
                        ),
                        pusher: noisy(frame.pusher, drifts[0], pusher_std),
                        other_fingers: others
                            .map(|(pose, drift)| noisy(*pose, *drift, pusher_std))
                            .collect(),
                        repeated: false,
                    }
                },
                |before| CameraMeasurement {
                    repeated: true,
                    ..before
                },
            ));
        }
        measured
    }
}

/// The object's pose at a time, linear between frames.
fn object_at(trace: &Trace, time: f64) -> Pose {
    let frames = &trace.frames;
    let after = frames.partition_point(|frame| frame.time < time);
    match (after.checked_sub(1), frames.get(after)) {
        (Some(before), Some(next)) => {
            let last = &frames[before];
            last.object
                .interpolate(next.object, (time - last.time) / (next.time - last.time))
        }
        (None, Some(first)) => first.object,
        (_, None) => frames[frames.len() - 1].object,
    }
}

#[cfg(test)]
mod tests {
    use stickslip_dynamics::{Friction, Twist};

    use super::*;
    use crate::trace::Frame;

    const FRAMES: usize = 20_000;

    /// The object moves at 30 mm/s and turns at 1 rad/s, the pusher stands.
    fn trace() -> Trace {
        let frame = |k: usize| {
            let time = k as f64 / 30.0;
            Frame {
                time,
                object: Pose::new(0.03 * time, 0.0, time),
                twist: Twist::default(),
                pusher: Pose::new(-1.0, 2.0, 0.5),
                other_fingers: vec![Pose::new(1.0, 3.0, 0.25)],
                contacts: vec![],
                pusher_force: [0.0; 2],
                hand_force: [0.0; 2],
                fixel_forces: vec![],
                finger_forces: vec![],
                tactile: vec![],
            }
        };
        let friction = Friction {
            mu_s: 0.3,
            mu_p: 0.3,
            mu_f: 0.3,
            d_tri: 0.01,
        };
        Trace {
            friction,
            frames: (0..FRAMES).map(frame).collect(),
            unsolved: 0,
        }
    }

    fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
        (values.map(|x| x * x).fold(0.0, |sum, x| sum + x) / FRAMES as f64).sqrt()
    }

    #[test]
    fn exact_camera_measures_the_truth() {
        let trace = trace();
        let measured = TrackingCamera::EXACT.measure(&trace, 7);
        assert!(
            measured
                .iter()
                .zip(&trace.frames)
                .all(|(s, f)| (s.object, s.pusher) == (f.object, f.pusher)
                    && s.other_fingers == f.other_fingers
                    && !s.repeated)
        );
    }

    #[test]
    fn noise_has_the_deviations_asked_for() {
        let camera = TrackingCamera {
            position_std: 1e-3,
            orientation_std: 0.02,
            pusher_position_std: 1e-4,
            pusher_orientation_std: 3e-3,
            ..TrackingCamera::EXACT
        };
        let trace = trace();
        let measured = camera.measure(&trace, 7);
        let error = |of: &dyn Fn(&CameraMeasurement, &Frame) -> f64| {
            root_mean_square(measured.iter().zip(&trace.frames).map(|(s, f)| of(s, f)))
        };
        for (measured, expected) in [
            (error(&|s, f| s.object.x - f.object.x), 1e-3),
            (error(&|s, f| s.object.y - f.object.y), 1e-3),
            (error(&|s, f| s.object.theta - f.object.theta), 0.02),
            (error(&|s, f| s.pusher.x - f.pusher.x), 1e-4),
            (
                error(&|s, f| s.other_fingers[0].x - f.other_fingers[0].x),
                1e-4,
            ),
            (error(&|s, f| s.pusher.theta - f.pusher.theta), 3e-3),
        ] {
            // 20 000 errors: a standard error of 0.5 %
            assert!(
                (measured / expected - 1.0).abs() < 0.02,
                "{measured} {expected}"
            );
        }
    }

    /// A frame later a part exp(-1/(30 · 0.15)) of the error is left, and its size is the same.
    #[test]
    fn pusher_error_forgets_itself_over_its_memory() {
        let camera = TrackingCamera {
            pusher_position_std: 1e-4,
            pusher_memory: 0.15,
            ..TrackingCamera::EXACT
        };
        let measured = camera.measure(&trace(), 7);
        let error: Vec<f64> = measured.iter().map(|seen| seen.pusher.x + 1.0).collect();
        let variance = root_mean_square(error.iter().copied()).powi(2);
        for lag in [1, 5] {
            let product = |k: usize| error[k] * error[k + lag];
            let sum = (0..FRAMES - lag).map(product).fold(0.0, |sum, x| sum + x);
            let expected = libm::exp(-(lag as f64) / (30.0 * 0.15));
            let found = sum / FRAMES as f64 / variance;
            assert!((found - expected).abs() < 0.03, "{found} {expected}");
        }
        // about 2200 independent errors: a standard error of 1.5 %
        assert!((variance.sqrt() / 1e-4 - 1.0).abs() < 0.06, "{variance}");
    }

    #[test]
    fn latency_shows_the_object_where_it_was() {
        let measured = TrackingCamera {
            latency: 0.05,
            ..TrackingCamera::EXACT
        }
        .measure(&trace(), 7);
        assert!(
            (measured[30].object.x - 0.03 * 0.95).abs() < 1e-12
                && (measured[30].object.theta - 0.95).abs() < 1e-12
        );
        assert_eq!(
            (measured[0].object, measured[30].pusher),
            (Pose::default(), Pose::new(-1.0, 2.0, 0.5))
        );
    }

    #[test]
    fn repeated_frames_hold_everything_of_the_one_before() {
        let camera = TrackingCamera {
            position_std: 1e-3,
            repeats: 0.1,
            ..TrackingCamera::EXACT
        };
        let measured = camera.measure(&trace(), 7);
        let repeats = measured.windows(2).filter(|pair| pair[1].repeated).count();
        assert!(
            (repeats as f64 / FRAMES as f64 - 0.1).abs() < 0.007,
            "{repeats}"
        );
        assert!(
            measured
                .windows(2)
                .all(|pair| pair[1].repeated == (pair[0].object == pair[1].object))
        );
    }
}
