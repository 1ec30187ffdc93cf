//! Measured poses of the pusher as the tracks take them: [`JumpGate`] leaves wrong ones out, and
//! unwraps angles.

use stickslip_dynamics::Pose;

use crate::angle::nearest_winding;
use crate::setup::Camera;
use crate::tuning::{JUMP_SIGMAS, LEAST_JUMP, MOST_ACCELERATION, PART_RADIUS};

/// Rejects poses that the pusher cannot have reached since the two before: wrong detections of its
/// tag. If such poses go on, the time to get there grows, until one is accepted.
///
/// The angle of an accepted pose is the winding nearest to that of the pose before, since a tracker
/// of poses may give angles in one turn. Every pose enters the estimator here, in a run over a
/// whole log as row by row.
#[derive(Clone, Debug)]
pub(crate) struct JumpGate {
    position_std: f64,
    orientation_std: f64,
    /// The latest two accepted poses, the last one first, each with its time (s).
    latest: [Option<(f64, Pose)>; 2],
    /// Number of rejected poses.
    left_out: u32,
}

/// Returns the accepted ones of a finger's `poses`, row by row, angles unwrapped. Without a
/// `camera` poses count as exact.
pub(crate) fn accepted(
    time: &[f64],
    poses: &[Option<Pose>],
    camera: Option<&Camera>,
) -> Vec<Option<Pose>> {
    let mut gate = JumpGate::new(camera);
    let rows = time.iter().zip(poses);
    rows.map(|(time, pose)| gate.pass(*time, *pose)).collect()
}

impl JumpGate {
    /// A gate before the first pose; without a `camera` poses count as exact.
    pub fn new(camera: Option<&Camera>) -> Self {
        let (position_std, orientation_std) = camera.map_or((0.0, 0.0), |camera| {
            (camera.pusher_position_std, camera.pusher_orientation_std)
        });
        Self {
            position_std,
            orientation_std,
            latest: [None; 2],
            left_out: 0,
        }
    }

    /// Returns the pose measured at `time` (s), which rises, its angle unwrapped; `None` if the
    /// pusher cannot be there.
    pub fn pass(&mut self, time: f64, pose: Option<Pose>) -> Option<Pose> {
        let measured = pose?;
        let pose = match self.latest[0] {
            Some((_, last)) => Pose {
                theta: nearest_winding(measured.theta, last.theta),
                ..measured
            },
            None => measured,
        };
        if let [Some(last), Some(before)] = self.latest
            && self.is_jump((time, pose), last, before)
        {
            self.left_out += 1;
            return None;
        }
        self.latest = [Some((time, pose)), self.latest[0]];
        Some(pose)
    }

    /// Number of poses that the pusher could not have reached.
    pub fn left_out(&self) -> u32 {
        self.left_out
    }

    fn is_jump(
        &self,
        (time, pose): (f64, Pose),
        (t1, last): (f64, Pose),
        (t0, before): (f64, Pose),
    ) -> bool {
        let h = time - t1;
        let ratio = h / (t1 - t0);
        let off = |now: f64, last: f64, before: f64| now - last - ratio * (last - before);
        let turn = off(pose.theta, last.theta, before.theta);
        let away = off(pose.x, last.x, before.x).hypot(off(pose.y, last.y, before.y));
        // uneven steps multiply the noise of the extrapolated pose
        let noise = JUMP_SIGMAS * (1.0 + ratio);
        let way = LEAST_JUMP + 0.5 * MOST_ACCELERATION * h * h;
        away > way + noise * self.position_std
            || turn.abs() > way / PART_RADIUS + noise * self.orientation_std
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns which of these x (m) at 60 Hz pass.
    fn passed(poses: &[f64]) -> Vec<bool> {
        let mut gate = JumpGate::new(None);
        let rows = poses.iter().enumerate();
        rows.map(|(k, x)| {
            let pose = Pose::new(*x, 0.0, 0.0);
            gate.pass(k as f64 / 60.0, Some(pose)).is_some()
        })
        .collect()
    }

    #[test]
    fn a_pose_or_two_aside_are_left_out_and_a_pusher_that_is_elsewhere_is_accepted() {
        let [yes, no] = [true, false];
        assert_eq!(
            passed(&[0.0, 1e-3, 0.022, 3e-3, 4e-3]),
            [yes, yes, no, yes, yes]
        );
        assert_eq!(
            passed(&[0.0, 1e-3, 0.022, 0.022, 4e-3]),
            [yes, yes, no, no, yes]
        );
        let [x, far] = [0.0, 0.05];
        assert_eq!(
            passed(&[x, x, far, far, far, far, far]),
            [yes, yes, no, no, no, no, yes]
        );
        // it starts at 0.15 m/s, and stops
        assert!(passed(&[0.0, 0.0, 2.5e-3, 5e-3, 5e-3]).iter().all(|p| *p));
    }
}
