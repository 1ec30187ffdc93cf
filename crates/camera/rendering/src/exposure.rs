//! Poses of all bodies while the shutter is open: [`Exposure`], [`BodyPoses`].

use stickslip_dynamics::{MOST_FINGERS, Pose};

use crate::prism::Parent;

/// Poses of everything that moves, in the world frame; `None` is not in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyPoses {
    /// The object.
    pub object: Option<Pose>,
    /// The pusher.
    pub pusher: Option<Pose>,
    /// The other fingers of a gripper.
    pub other_fingers: [Option<Pose>; MOST_FINGERS - 1],
    /// The hand that gets between camera and object.
    pub hand: Option<Pose>,
}

/// Poses while the shutter is open; they change evenly from start to end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposure {
    /// As the shutter opens.
    pub start: BodyPoses,
    /// As it closes.
    pub end: BodyPoses,
}

impl Exposure {
    /// Nothing moves.
    pub fn at_rest(poses: BodyPoses) -> Self {
        Self {
            start: poses,
            end: poses,
        }
    }

    /// Poses of a parent at start and end; `None` unless it is there for both.
    pub(crate) fn poses(&self, parent: Parent) -> Option<[Pose; 2]> {
        let both =
            |of: &dyn Fn(&BodyPoses) -> Option<Pose>| Some([of(&self.start)?, of(&self.end)?]);
        match parent {
            Parent::Table => Some([Pose::default(); 2]),
            Parent::Object => both(&|poses| poses.object),
            Parent::Pusher => both(&|poses| poses.pusher),
            Parent::Finger(k) => both(&|poses| poses.other_fingers[k]),
            Parent::Hand => both(&|poses| poses.hand),
        }
    }
}
