//! How an intended motion of the pusher will end: [`Plan`], and [`Outcomes`].

use stickslip_dynamics::{Body, FingerMotion, Pose, PusherMotion, StepInput};

use crate::pusher::schedule::split;
use crate::pusher::tracked_pose::Directions;

/// Longest step of a plan (s).
const LONGEST: f64 = 1.0;

/// Intended motion of the pusher, and of the other fingers of a hand, from the latest row on.
///
/// Let a grasp go on closing at its end: a drive that stands presses with an unknown force, and
/// such an end counts as resting.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// Time from one pose to the next (s), at most 1.
    pub h: f64,
    /// Poses where steps begin and end, those of the latest row first: of the pusher, then of each
    /// other finger. Each moves straight from one to the next, less what its drive yields.
    pub fingers: Vec<Vec<Pose>>,
}

/// Reason why a plan was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// There are no particles yet.
    #[error("the tracker has seen no pose of the object; push rows until it has")]
    NoPose,
    /// Another number of fingers than the scene's.
    #[error(
        "the plan has the poses of {found} and the scene has {fingers}, the pusher and its [[finger]] tables; give each its poses"
    )]
    Fingers {
        /// Fingers of the plan.
        found: usize,
        /// Fingers of the scene, with the pusher.
        fingers: usize,
    },
    /// Too few poses, or not as many for each finger.
    #[error(
        "finger {finger} has {found} poses and the first one {first}; give all as many, at least 2"
    )]
    Poses {
        /// The finger, from 0.
        finger: usize,
        /// Its poses.
        found: usize,
        /// Those of the first finger.
        first: usize,
    },
    /// A pose is NaN or infinite.
    #[error("pose {row} of finger {finger} is not finite; all its numbers must be")]
    NotFinite {
        /// The finger, from 0.
        finger: usize,
        /// The pose, from 0.
        row: usize,
    },
    /// The step is no step.
    #[error("the step is {h} s; it must be above 0 and at most {LONGEST} s; try 1/30")]
    Step {
        /// The step found (s).
        h: f64,
    },
}

/// Probabilities of what is the case after the last step of a plan.
///
/// `held`, `jammed`, `resting`, `moving` and `lost` exclude each other and sum to 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcomes {
    /// The object rests, the drive yields, and the contacts that press are a frictional form
    /// closure: they resist forces and torques in all directions.
    pub held: f64,
    /// The object rests and the drive yields, without such a closure.
    pub jammed: f64,
    /// The object rests at a body, and the drive does not yield.
    pub resting: f64,
    /// The object moves, and a body touches it.
    pub moving: f64,
    /// No body touches the object.
    pub lost: f64,
    /// Sets of bodies that touch, the likeliest first.
    pub contacts: Vec<ContactSet>,
    /// Mean of the final poses; `theta` is unwrapped.
    pub pose: Pose,
    /// Their standard deviations (m, m, rad).
    pub spread: Pose,
    /// Probability that the last step has no certified solution.
    pub unsolved: f64,
}

/// Bodies that touch the object together.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactSet {
    /// The bodies: fingers, then fixels, in the scene's order.
    pub bodies: Vec<Body>,
    /// Its probability.
    pub probability: f64,
}

/// How one particle ends.
#[derive(Clone, Debug, Default)]
pub(crate) struct End {
    pub pose: Pose,
    pub bodies: Vec<Body>,
    pub moves: bool,
    pub yields: bool,
    pub closes: bool,
    pub solved: bool,
}

impl Plan {
    /// Refuses a plan that does not go with a scene of so many fingers.
    pub(crate) fn check(&self, fingers: usize) -> Result<(), PlanError> {
        let found = self.fingers.len();
        if found != fingers {
            return Err(PlanError::Fingers { found, fingers });
        }
        if !(self.h > 0.0 && self.h <= LONGEST) {
            return Err(PlanError::Step { h: self.h });
        }
        let first = self.fingers[0].len();
        for (finger, poses) in self.fingers.iter().enumerate() {
            let found = poses.len();
            if found != first || found < 2 {
                return Err(PlanError::Poses {
                    finger,
                    found,
                    first,
                });
            }
            if let Some(row) = poses.iter().position(|pose| !pose.is_finite()) {
                return Err(PlanError::NotFinite { finger, row });
            }
        }
        Ok(())
    }

    /// The substeps of every step; `directions` has the last directions of motion.
    pub(crate) fn steps(&self, mut directions: Directions) -> Vec<Vec<StepInput>> {
        let rows = self.fingers[0].len();
        let step = |row: usize| {
            let fingers = self.fingers.iter().zip(&mut directions);
            let motions = fingers.map(|(poses, direction)| {
                let twist = poses[row].twist_to(poses[row + 1], self.h);
                let speed = twist.vx.hypot(twist.vy);
                if speed > 0.0 {
                    *direction = [twist.vx / speed, twist.vy / speed];
                }
                Some(FingerMotion {
                    pose: poses[row],
                    twist,
                    direction: *direction,
                })
            });
            split(self.h, PusherMotion::new(motions), None).collect()
        };
        (0..rows - 1).map(step).collect()
    }
}

impl Outcomes {
    /// Sums over the particles' ends.
    pub(crate) fn of(ends: &[End], weights: &[f64]) -> Self {
        let mut all = Self::default();
        let near = ends.first().map_or(0.0, |end| end.pose.theta);
        let mut square: Pose = Pose::default();
        for (end, weight) in ends.iter().zip(weights) {
            let kind = match end {
                End { bodies, .. } if bodies.is_empty() => &mut all.lost,
                End { moves: true, .. } => &mut all.moving,
                End { yields: false, .. } => &mut all.resting,
                End { closes: true, .. } => &mut all.held,
                End { .. } => &mut all.jammed,
            };
            *kind += weight;
            all.unsolved += if end.solved { 0.0 } else { *weight };
            let mut sets = all.contacts.iter_mut();
            match sets.find(|set| set.bodies == end.bodies) {
                Some(set) => set.probability += weight,
                None => all.contacts.push(ContactSet {
                    bodies: end.bodies.clone(),
                    probability: *weight,
                }),
            }
            let theta = end.pose.theta - near;
            let pose = [end.pose.x, end.pose.y, theta];
            let sums = all.pose.fields_mut().into_iter().zip(square.fields_mut());
            for ((sum, square), value) in sums.zip(pose) {
                *sum += weight * value;
                *square += weight * value * value;
            }
        }
        let moments = all.pose.fields().into_iter().zip(square.fields());
        let stds: Vec<f64> = moments
            .map(|(mean, square): (&f64, &f64)| (square - mean * mean).max(0.0).sqrt())
            .collect();
        all.spread = Pose::new(stds[0], stds[1], stds[2]);
        all.pose.theta += near;
        all.contacts
            .sort_by(|a, b| b.probability.total_cmp(&a.probability));
        all
    }
}
