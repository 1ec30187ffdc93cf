//! A motion to be shown: [`RecordedMotion`].

use std::f64::consts::{SQRT_2, TAU};

use stickslip_dynamics::{MOST_FINGERS, Pose, Scene, Shape};

use crate::appearance::{Appearance, TagMount};
use crate::exposure::BodyPoses;

/// Poses of object and fingers, one entry per frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedMotion {
    /// Middle of the exposure (s), strictly rising.
    pub time: Vec<f64>,
    /// The object.
    pub object: Vec<Pose>,
    /// The pusher; `None` is out of the picture.
    pub pusher: Vec<Option<Pose>>,
    /// Poses of each other finger of a gripper.
    pub other_fingers: Vec<Vec<Option<Pose>>>,
}

impl RecordedMotion {
    /// A box that holds the bodies with their tags at all times, and all fixels: its lower left and
    /// upper right corner (m).
    pub fn bounds(&self, scene: &Scene, appearance: &Appearance) -> [[f64; 2]; 2] {
        let moving = |shape: &Shape, tag: &Option<TagMount>| {
            let radius = shape.bounding_radius().max(tag_radius(tag));
            move |pose: &Pose| (pose.x, pose.y, radius)
        };
        let object = moving(&scene.object.shape, &appearance.object_tag);
        let pusher = moving(&scene.pusher.fingers[0], &appearance.pusher_tag);
        let shapes = scene.pusher.fingers[1..].iter();
        let fingers = self.other_fingers.iter().zip(shapes);
        let fingers = fingers.flat_map(|(poses, shape)| {
            let finger = moving(shape, &None);
            poses.iter().flatten().map(finger)
        });
        let fixels = scene
            .fixels
            .iter()
            .map(|f| (f.pose.x, f.pose.y, f.shape.bounding_radius()));
        let discs = self
            .object
            .iter()
            .map(object)
            .chain(self.pusher.iter().flatten().map(pusher))
            .chain(fingers)
            .chain(fixels);
        let empty = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        discs.fold(empty, |[low, high], (x, y, r)| {
            [
                [low[0].min(x - r), low[1].min(y - r)],
                [high[0].max(x + r), high[1].max(y + r)],
            ]
        })
    }

    /// Direction from the pusher's first to its last position (rad); zero where it does not move.
    pub fn push_direction(&self) -> f64 {
        let mut seen = self.pusher.iter().flatten();
        let ends = seen.next().zip(seen.next_back());
        ends.map_or(0.0, |(first, last)| {
            libm::atan2(last.y - first.y, last.x - first.x)
        })
    }

    /// Object and fingers at a time: linear between frames, at rest before the first and after the
    /// last.
    pub(crate) fn at(&self, time: f64) -> BodyPoses {
        let later = self
            .time
            .partition_point(|t| *t < time)
            .min(self.time.len().saturating_sub(1));
        let earlier = later.saturating_sub(1);
        let step = self.time[later] - self.time[earlier];
        let share = if step > 0.0 {
            ((time - self.time[earlier]) / step).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let finger = |poses: &[Option<Pose>]| {
            let ends = poses[earlier].zip(poses[later]);
            ends.map(|(from, to)| between(from, to, share))
        };
        let mut other_fingers = [None; MOST_FINGERS - 1];
        for (to, poses) in other_fingers.iter_mut().zip(&self.other_fingers) {
            *to = finger(poses);
        }
        BodyPoses {
            object: Some(between(self.object[earlier], self.object[later], share)),
            pusher: finger(&self.pusher),
            other_fingers,
            hand: None,
        }
    }
}

/// The pose on the shorter way round; angles may be wrapped to one turn.
fn between(from: Pose, to: Pose, share: f64) -> Pose {
    let turns = ((to.theta - from.theta) / TAU).round();
    let near = Pose {
        theta: to.theta - TAU * turns,
        ..to
    };
    from.interpolate(near, share)
}

/// Distance from a body's origin that its tag's print stays within (m).
fn tag_radius(mount: &Option<TagMount>) -> f64 {
    mount.map_or(0.0, |m| {
        libm::hypot(m.pose.x, m.pose.y) + m.tag.print_size() / SQRT_2
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_between_wrapped_angles_takes_the_shorter_way() {
        let at = |theta: f64| Pose::new(0.0, 0.0, theta);
        let motion = RecordedMotion {
            time: vec![0.0, 1.0],
            object: vec![at(3.1), at(-3.1)],
            pusher: vec![Some(at(-3.0)), Some(at(3.0))],
            other_fingers: vec![vec![Some(at(3.0)), Some(at(-3.0))]],
        };
        let poses = motion.at(0.5);
        let bodies = [poses.object, poses.pusher, poses.other_fingers[0]];
        let turns = bodies.map(|pose| pose.unwrap().theta.abs() - TAU / 2.0);
        assert!(turns.iter().all(|off| off.abs() < 1e-12), "{turns:?}");
    }
}
