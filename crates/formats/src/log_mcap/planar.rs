//! From a pose in space to one in the plane of the table: [`planar`].

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use stickslip::{Rule, Unit};
use stickslip_dynamics::Pose;

use crate::log_mcap::error::McapProblem;
use crate::log_mcap::message::{Quaternion, Vector3};

/// Largest difference of a quaternion's length from 1.
const UNIT: f64 = 0.01;
/// Tilt from which a pose is not one in the plane (rad).
const TILTED: f64 = 5.0 * PI / 180.0;
/// Tilt from which a pose has no angle about the vertical (rad).
const UPSIDE_DOWN: f64 = 179.9 * PI / 180.0;

/// Directions in which the z-axis of a frame may point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ZAxis {
    /// Up from the table.
    Up,
    /// Up or, as for detectors of tags, into the tag.
    UpOrDown,
}

/// Poses that stand askew.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Tilt {
    /// Number of poses tilted by more than 5°.
    pub count: usize,
    /// Largest tilt (rad).
    pub largest: f64,
}

impl Tilt {
    /// Counts one more pose.
    pub(crate) fn add(&mut self, leans: f64) {
        self.count += usize::from(leans > TILTED);
        self.largest = if leans > self.largest {
            leans
        } else {
            self.largest
        };
    }
}

/// Refuses a number that is not finite; names the field.
pub(crate) fn finite<const N: usize>(numbers: [(&'static str, f64); N]) -> Result<(), McapProblem> {
    match numbers.into_iter().find(|(_, number)| !number.is_finite()) {
        Some((field, found)) => Err(McapProblem::NotFinite { field, found }),
        None => Ok(()),
    }
}

/// Returns true for the numbers of a body that was not seen: a quaternion of zeros, as motion
/// capture publishes it, or a number that is not finite.
pub(crate) fn is_missing(at: &Vector3, q: &Quaternion) -> bool {
    let rotation = [q.x, q.y, q.z, q.w];
    let numbers = [at.x, at.y, at.z].into_iter().chain(rotation);
    rotation == [0.0; 4] || numbers.into_iter().any(|number| !number.is_finite())
}

/// Refuses a position or an orientation that none can be.
pub(crate) fn check_pose(at: &Vector3, q: &Quaternion) -> Result<(), McapProblem> {
    finite([
        ("position.x", at.x),
        ("position.y", at.y),
        ("position.z", at.z),
    ])?;
    finite([
        ("orientation.x", q.x),
        ("orientation.y", q.y),
        ("orientation.z", q.z),
        ("orientation.w", q.w),
    ])?;
    let length = libm::hypot(libm::hypot(q.x, q.y), libm::hypot(q.z, q.w));
    if (length - 1.0).abs() > UNIT {
        return Err(McapProblem::NotUnit { found: length });
    }
    Ok(())
}

/// The pose in the plane, its angle in [−π, π), and the angle between its z-axis and the vertical
/// (rad). The angle is 2 atan2(q_z, q_w), and that of the x-axis where the z-axis points down.
pub(crate) fn planar(
    at: &Vector3,
    q: &Quaternion,
    z_axis: ZAxis,
) -> Result<(Pose, f64), McapProblem> {
    for (field, found) in [("position.x", at.x), ("position.y", at.y)] {
        if !found.is_finite() {
            continue; // told by the next check, as the other numbers
        }
        if let Some(rule) = Rule::Finite.broken_by(found, Unit::Metre) {
            return Err(McapProblem::OutOfRange { field, found, rule });
        }
    }
    check_pose(at, q)?;
    let tilt = 2.0 * libm::atan2(libm::hypot(q.x, q.y), libm::hypot(q.z, q.w));
    let upright = Pose::new(at.x, at.y, wrapped(2.0 * libm::atan2(q.z, q.w)));
    match z_axis {
        ZAxis::Up if tilt > UPSIDE_DOWN => Err(McapProblem::UpsideDown),
        ZAxis::UpOrDown if tilt > FRAC_PI_2 => {
            let [x, y] = [
                q.x * q.x - q.y * q.y - q.z * q.z + q.w * q.w,
                2.0 * (q.x * q.y + q.w * q.z),
            ];
            Ok((Pose::new(at.x, at.y, wrapped(libm::atan2(y, x))), PI - tilt))
        }
        _ => Ok((upright, tilt)),
    }
}

/// The angle in [−π, π) that equals `angle` on the circle (rad); an angle in there keeps its bits.
pub(crate) fn wrapped(angle: f64) -> f64 {
    angle - TAU * ((angle + PI) / TAU).floor()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapped_keeps_angles_in_half_a_turn_and_takes_full_turns_away() {
        assert_eq!([-3.0, 0.0, 1e-9, 3.0].map(wrapped), [-3.0, 0.0, 1e-9, 3.0]);
        assert_eq!(wrapped(4.0), 4.0 - TAU);
        assert_eq!(wrapped(-4.0), TAU - 4.0);
    }

    #[test]
    fn a_tag_that_faces_down_has_the_angle_of_its_x_axis() {
        // turned by 0.3 about z, then over its own x-axis by 178 degrees
        let (over, turn) = (178.0_f64.to_radians() / 2.0, 0.15);
        let (so, co) = libm::sincos(over);
        let (st, ct) = libm::sincos(turn);
        let q = Quaternion {
            x: ct * so,
            y: st * so,
            z: st * co,
            w: ct * co,
        };
        let (pose, tilt) = planar(&Vector3::default(), &q, ZAxis::UpOrDown).unwrap();
        assert!((pose.theta - 0.3).abs() < 1e-12, "{}", pose.theta);
        assert!((tilt - 2.0_f64.to_radians()).abs() < 1e-12, "{tilt}");
    }
}
