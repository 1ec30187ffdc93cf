//! Two rules for the time when the camera is off that need no model of contact: [`stopping`] and
//! [`with_pusher`]. Both are the Kalman filter while the camera is on. The camera is off in the
//! rows that an occlusion hides.

use stickslip_dynamics::{Pose, Twist};

use crate::estimate::Estimate;
use crate::options::TactileUse;
use crate::prepared_log::PreparedLog;

/// The Kalman filter, at rest from the first occluded row on at which a sensor reads a touch.
pub(crate) fn stopping(
    mut kalman: Estimate,
    prepared: &PreparedLog<'_>,
    tactile: TactileUse,
) -> Estimate {
    let feels = |row: usize| {
        let sensors = &prepared.log.tactile;
        tactile == TactileUse::Used && sensors.iter().any(|sensor| sensor[row] == Some(true))
    };
    let mut rest = None;
    for row in prepared.first..kalman.rows.len() {
        if !prepared.hidden[row] {
            rest = None;
            continue;
        }
        if rest.is_none() && feels(row) {
            rest = Some(row);
        }
        if let Some(at) = rest {
            let (pose, spread) = (kalman.rows[at].pose, kalman.rows[at].spread);
            let now = &mut kalman.rows[row];
            (now.pose, now.spread) = (pose, spread);
            now.twist = Some(Twist::default());
        }
    }
    kalman
}

/// The Kalman filter; while the camera is off, the object moves with the pusher as one body.
pub(crate) fn with_pusher(mut kalman: Estimate, prepared: &PreparedLog<'_>) -> Estimate {
    for row in prepared.first + 1..kalman.rows.len() {
        if !prepared.hidden[row] {
            continue;
        }
        let (before, now) = (prepared.track.pose(row - 1), prepared.track.pose(row));
        let (last, spread) = (kalman.rows[row - 1].pose, kalman.rows[row - 1].spread);
        let moved = match (before, now, last) {
            (Some(before), Some(now), Some(object)) => Some(carried(object, before, now)),
            (_, _, object) => object,
        };
        let h = prepared.log.time[row] - prepared.log.time[row - 1];
        let row = &mut kalman.rows[row];
        (row.pose, row.spread) = (moved, spread);
        row.twist = moved.zip(last).map(|(now, before)| Twist {
            vx: (now.x - before.x) / h,
            vy: (now.y - before.y) / h,
            omega: (now.theta - before.theta) / h,
        });
    }
    kalman
}

/// Returns `object` after the rigid motion that takes a body from `before` to `now`.
fn carried(object: Pose, before: Pose, now: Pose) -> Pose {
    let turn = now.theta - before.theta;
    let (sin, cos) = (libm::sin(turn), libm::cos(turn));
    let (x, y) = (object.x - before.x, object.y - before.y);
    Pose::new(
        now.x + cos * x - sin * y,
        now.y + sin * x + cos * y,
        object.theta + turn,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_glued_to_a_pusher_keeps_its_place_on_it() {
        let (before, now) = (Pose::new(0.1, 0.2, 0.3), Pose::new(-0.1, 0.5, 1.3));
        let object = Pose::new(0.15, 0.1, -2.0);
        let moved = carried(object, before, now);
        // in the pusher's frame, by complex numbers written out
        let inside = |object: Pose, pusher: Pose| {
            let (x, y) = (object.x - pusher.x, object.y - pusher.y);
            let (s, c) = (libm::sin(-pusher.theta), libm::cos(-pusher.theta));
            [c * x - s * y, s * x + c * y, object.theta - pusher.theta]
        };
        let (a, b) = (inside(object, before), inside(moved, now));
        assert!(
            a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12),
            "{a:?}, {b:?}"
        );
    }
}
