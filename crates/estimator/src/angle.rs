//! Angles on the circle.

use std::f64::consts::{PI, TAU};

/// The angle in [−π, π) that equals `angle` on the circle (rad).
pub fn wrapped(angle: f64) -> f64 {
    angle - TAU * ((angle + PI) / TAU).floor()
}

/// The angle nearest to `near` that equals `angle` on the circle (rad).
pub fn unwrapped(angle: f64, near: f64) -> f64 {
    near + wrapped(angle - near)
}
