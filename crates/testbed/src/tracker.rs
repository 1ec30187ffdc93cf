//! What a camera that tracks object and pusher measures: [`Tracker`], [`Sighting`].

use stickslip_dynamics::Pose;
use stickslip_filter::{Purpose, Streams};

use crate::Trace;

/// Draws of a frame's noise; those of the touch sensors are numbered by sensor, from 0 up.
const OBJECT: u32 = u32::MAX;
const PUSHER: u32 = u32::MAX - 1;
const REPEAT: u32 = u32::MAX - 2;

/// Noise of a camera that tracks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracker {
    /// Standard deviation of one object position, per axis (m).
    pub position_std: f64,
    /// Standard deviation of one object angle (rad).
    pub orientation_std: f64,
    /// Standard deviation of one pusher position, per axis (m).
    pub pusher_position_std: f64,
    /// Standard deviation of one pusher angle (rad).
    pub pusher_orientation_std: f64,
    /// Time by which the object's pose is old (s).
    pub latency: f64,
    /// Share of frames that repeat the one before.
    pub repeats: f64,
}

/// What was measured in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// Pose of the object.
    pub object: Pose,
    /// Pose of the pusher.
    pub pusher: Pose,
    /// Whether the frame is the one before once more.
    pub repeated: bool,
}

impl Tracker {
    /// Sees everything as it is.
    pub const EXACT: Self = Self {
        position_std: 0.0,
        orientation_std: 0.0,
        pusher_position_std: 0.0,
        pusher_orientation_std: 0.0,
        latency: 0.0,
        repeats: 0.0,
    };

    /// One sighting per frame of `trace`.
    pub fn sight(&self, trace: &Trace, seed: u64) -> Vec<Sighting> {
        let streams = Streams::new(seed).of(Purpose::Measure);
        let mut sightings: Vec<Sighting> = Vec::with_capacity(trace.frames.len());
        for (k, frame) in trace.frames.iter().enumerate() {
            let draw = streams.at(k as u64);
            let noisy = |pose: Pose, who: u32, [position, angle]: [f64; 2]| {
                let [x, y, theta] = draw.normals(who, 0);
                Pose::new(
                    pose.x + position * x,
                    pose.y + position * y,
                    pose.theta + angle * theta,
                )
            };
            let repeated = sightings
                .last()
                .copied()
                .filter(|_| draw.uniform(REPEAT, 0) < self.repeats);
            sightings.push(repeated.map_or_else(
                || Sighting {
                    object: noisy(
                        object_at(trace, frame.time - self.latency),
                        OBJECT,
                        [self.position_std, self.orientation_std],
                    ),
                    pusher: noisy(
                        frame.pusher,
                        PUSHER,
                        [self.pusher_position_std, self.pusher_orientation_std],
                    ),
                    repeated: false,
                },
                |before| Sighting {
                    repeated: true,
                    ..before
                },
            ));
        }
        sightings
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
    use crate::Frame;

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
                contacts: vec![],
                pusher_force: [0.0; 2],
                fixel_forces: vec![],
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
    fn exact_tracker_sees_what_is() {
        let trace = trace();
        let sightings = Tracker::EXACT.sight(&trace, 7);
        assert!(
            sightings
                .iter()
                .zip(&trace.frames)
                .all(|(s, f)| (s.object, s.pusher) == (f.object, f.pusher) && !s.repeated)
        );
    }

    #[test]
    fn noise_has_the_deviations_asked_for() {
        let deviations = Tracker {
            position_std: 1e-3,
            orientation_std: 0.02,
            pusher_position_std: 1e-4,
            pusher_orientation_std: 3e-3,
            ..Tracker::EXACT
        };
        let trace = trace();
        let sightings = deviations.sight(&trace, 7);
        let error = |of: &dyn Fn(&Sighting, &Frame) -> f64| {
            root_mean_square(sightings.iter().zip(&trace.frames).map(|(s, f)| of(s, f)))
        };
        for (measured, expected) in [
            (error(&|s, f| s.object.x - f.object.x), 1e-3),
            (error(&|s, f| s.object.y - f.object.y), 1e-3),
            (error(&|s, f| s.object.theta - f.object.theta), 0.02),
            (error(&|s, f| s.pusher.x - f.pusher.x), 1e-4),
            (error(&|s, f| s.pusher.theta - f.pusher.theta), 3e-3),
        ] {
            // 20 000 errors: a standard error of 0.5 %
            assert!(
                (measured / expected - 1.0).abs() < 0.02,
                "{measured} {expected}"
            );
        }
    }

    #[test]
    fn latency_shows_the_object_where_it_was() {
        let sightings = Tracker {
            latency: 0.05,
            ..Tracker::EXACT
        }
        .sight(&trace(), 7);
        assert!(
            (sightings[30].object.x - 0.03 * 0.95).abs() < 1e-12
                && (sightings[30].object.theta - 0.95).abs() < 1e-12
        );
        assert_eq!(
            (sightings[0].object, sightings[30].pusher),
            (Pose::default(), Pose::new(-1.0, 2.0, 0.5))
        );
    }

    #[test]
    fn repeated_frames_hold_everything_of_the_one_before() {
        let tracker = Tracker {
            position_std: 1e-3,
            repeats: 0.1,
            ..Tracker::EXACT
        };
        let sightings = tracker.sight(&trace(), 7);
        let repeats = sightings.windows(2).filter(|pair| pair[1].repeated).count();
        assert!(
            (repeats as f64 / FRAMES as f64 - 0.1).abs() < 0.007,
            "{repeats}"
        );
        assert!(
            sightings
                .windows(2)
                .all(|pair| pair[1].repeated == (pair[0].object == pair[1].object))
        );
    }
}
