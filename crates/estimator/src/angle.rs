//! Angles on the circle.

use std::f64::consts::{PI, TAU};

use stickslip_dynamics::{Lanes, Pose};

/// The angle in [−π, π) that equals `angle` on the circle (rad).
pub fn wrapped(angle: f64) -> f64 {
    angle - TAU * ((angle + PI) / TAU).floor()
}

/// Angles in [−π, π] that equal the given ones on the circle (rad).
#[inline(always)]
pub fn nearest_zero<const W: usize>(angles: Lanes<W>) -> Lanes<W> {
    angles - (angles * (1.0 / TAU)).round() * TAU
}

/// The angle nearest to `near` that equals `angle` on the circle (rad).
pub fn unwrapped(angle: f64, near: f64) -> f64 {
    near + wrapped(angle - near)
}

/// The angle nearest to `near` that is full turns from `angle` (rad); `angle` itself, to the bit,
/// if no turn is needed.
pub fn nearest_winding(angle: f64, near: f64) -> f64 {
    angle - TAU * ((angle - near) / TAU).round()
}

/// Difference `to` − `from`, with θ taken on the circle.
pub fn difference(to: &Pose, from: &Pose) -> Pose {
    Pose {
        x: to.x - from.x,
        y: to.y - from.y,
        theta: wrapped(to.theta - from.theta),
    }
}
