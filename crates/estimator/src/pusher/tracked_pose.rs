//! A finger at one row of its track: [`TrackedPose`], and the motion between two of them.

use crate::tuning::{BRIDGED_INTERVALS, LONGEST_BRIDGE, STANDSTILL, TELLING_SPEED};
use stickslip_dynamics::{FingerMotion, MOST_FINGERS, Pose, PusherMotion};
use stickslip_filter::AxisEstimate;

/// Unit vector of each finger's last motion.
pub(crate) type Directions = [[f64; 2]; MOST_FINGERS];

/// A finger at one row of its track.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedPose {
    /// Pose.
    pub pose: Pose,
    /// Velocity (m/s).
    pub velocity: [f64; 2],
    /// Standard deviation of the tracked speed (m/s); 0 where poses are exact.
    pub speed_std: f64,
    /// Time before this row for which the pusher was held where it was last seen (s). It came here
    /// within that time. 0 if it was seen in the row before.
    pub held: f64,
}

impl TrackedPose {
    /// The pusher at the tracked x, y and θ.
    pub(crate) fn of([x, y, theta]: [AxisEstimate; 3]) -> Self {
        Self {
            pose: Pose::new(x.position, y.position, theta.position),
            velocity: [x.velocity, y.velocity],
            speed_std: (x.velocity_variance + y.velocity_variance).sqrt(),
            held: 0.0,
        }
    }

    /// Returns true if the tracked speed exceeds what noise makes of a standing pusher.
    pub fn moves(&self) -> bool {
        let speed = self.velocity[0].hypot(self.velocity[1]);
        speed > TELLING_SPEED * self.speed_std && speed > STANDSTILL
    }
}

/// Returns true if a finger moves, as far as its track can tell.
pub(crate) fn moves(fingers: &[Option<TrackedPose>]) -> bool {
    fingers.iter().flatten().any(TrackedPose::moves)
}

/// Returns the length (s) of the step to a row `h` seconds after the last one, where the fingers
/// are `next`. A step that catches up with a held finger lasts as long as the finger took: within
/// one row it would throw the object ahead.
pub(crate) fn step_length(next: &[Option<TrackedPose>], h: f64) -> f64 {
    let held = next.iter().flatten().map(|next| next.held);
    held.fold(h, f64::max)
}

/// The pusher during a step of length `h` (s) in which its fingers go from `now` to `next`; `last`
/// has their last directions of motion. `None` where a finger is off the plane.
pub(crate) fn motion(
    now: &[Option<TrackedPose>],
    next: &[Option<TrackedPose>],
    h: f64,
    last: &Directions,
) -> Option<PusherMotion> {
    let fingers = now.iter().zip(next).zip(last);
    PusherMotion::new(
        fingers.map(|((now, next), last)| Some(finger_motion((*now)?, (*next)?, h, *last))),
    )
}

fn finger_motion(now: TrackedPose, next: TrackedPose, h: f64, last: [f64; 2]) -> FingerMotion {
    // the direction of the step would contain the corrections of a causal track, which may point
    // backwards
    let [vx, vy] = next.velocity;
    let direction = if next.moves() {
        [vx / vx.hypot(vy), vy / vx.hypot(vy)]
    } else {
        last
    };
    FingerMotion {
        pose: now.pose,
        twist: now.pose.twist_to(next.pose, h),
        direction,
    }
}

/// Keeps the directions of the fingers of a step, where there is a pusher.
pub(crate) fn keep_directions(motion: Option<&PusherMotion>, directions: &mut Directions) {
    for (direction, finger) in directions
        .iter_mut()
        .zip(motion.into_iter().flat_map(|m| &**m))
    {
        *direction = finger.direction;
    }
}

/// Returns true if a gap from `from` to `to` (s) without a pusher pose is bridged. Poses come at an
/// `interval` (s).
pub(crate) fn bridged(from: f64, to: f64, interval: Option<f64>) -> bool {
    let intervals = interval.map_or(0.0, |interval| BRIDGED_INTERVALS * interval);
    to - from <= LONGEST_BRIDGE.max(intervals) + 1e-9
}
