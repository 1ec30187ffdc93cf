//! Input of one time step: [`StepInput`].

use std::fmt;
use std::ops::{Deref, DerefMut};

use stickslip_lanes::Lanes;

use crate::se2::{Pose, Twist};
use crate::support::Support;

/// Fingers that a pusher may have.
pub const MOST_FINGERS: usize = 4;

/// One finger of the pusher during one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FingerMotion<T = f64> {
    /// Pose at the start of the step.
    pub pose: Pose<T>,
    /// Commanded twist during the step.
    pub twist: Twist<T>,
    /// Unit vector of its commanded translation (the last one where it stands). A pusher with a
    /// force limit may yield in this direction.
    pub direction: [T; 2],
}

/// The pusher during one step: a [`FingerMotion`] for each of its fingers, in the scene's order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PusherMotion {
    fingers: [FingerMotion; MOST_FINGERS],
    count: usize,
}

impl PusherMotion {
    /// The motions of 1 to [`MOST_FINGERS`] fingers; `None` if one is missing, or the number is
    /// another.
    pub fn new(motions: impl IntoIterator<Item = Option<FingerMotion>>) -> Option<Self> {
        let mut all = Self {
            fingers: [FingerMotion::default(); MOST_FINGERS],
            count: 0,
        };
        for motion in motions {
            *all.fingers.get_mut(all.count)? = motion?;
            all.count += 1;
        }
        (all.count > 0).then_some(all)
    }

    /// Changes the motion of every finger.
    #[must_use]
    pub fn map(mut self, mut change: impl FnMut(FingerMotion) -> FingerMotion) -> Self {
        for finger in self.iter_mut() {
            *finger = change(*finger);
        }
        self
    }
}

impl From<FingerMotion> for PusherMotion {
    /// A pusher of one finger.
    fn from(motion: FingerMotion) -> Self {
        let mut fingers = [FingerMotion::default(); MOST_FINGERS];
        fingers[0] = motion;
        Self { fingers, count: 1 }
    }
}

/// The fingers, at least one.
impl Deref for PusherMotion {
    type Target = [FingerMotion];

    fn deref(&self) -> &[FingerMotion] {
        &self.fingers[..self.count]
    }
}

impl DerefMut for PusherMotion {
    fn deref_mut(&mut self) -> &mut [FingerMotion] {
        &mut self.fingers[..self.count]
    }
}

impl FingerMotion {
    /// Copies the motion into every lane.
    #[inline(always)]
    pub(crate) fn splat<const W: usize>(&self) -> FingerMotion<Lanes<W>> {
        let [dx, dy] = self.direction;
        FingerMotion {
            pose: self.pose.map(Lanes::splat),
            twist: self.twist.map(Lanes::splat),
            direction: [Lanes::splat(dx), Lanes::splat(dy)],
        }
    }
}

/// Offsets of pusher, fixels and feet from the poses that the input and the scene give, particle by
/// particle.
#[derive(Clone, Copy, Debug)]
pub struct Offsets<'a, const W: usize> {
    /// Offsets of the pusher's fingers (m): those of the first chunk, then those of the second, ...
    pub pusher: &'a [[Lanes<W>; 2]],
    /// Angles by which each finger is turned from its pose (rad), chunk by chunk; empty where they
    /// are not turned.
    pub pusher_turn: &'a [Lanes<W>],
    /// Offsets of the fixels (m): those of the first chunk, then those of the second, ...
    pub fixels: &'a [[Lanes<W>; 2]],
    /// Affine images of the scene's feet, chunk by chunk. Empty where they stand as in the scene.
    pub supports: &'a [Support<Lanes<W>>],
}

/// Input of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepInput {
    /// Step (s).
    pub h: f64,
    /// The pusher, with as many fingers as the scene's; `None` while it is off the plane.
    pub pusher: Option<PusherMotion>,
}

/// A body that the object may touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Body {
    /// The pusher's finger of this index; a pusher without others is finger 0.
    Finger(usize),
    /// The fixel of this index.
    Fixel(usize),
}

/// `pusher`, `finger 1`, `fixel 1`: other fingers and fixels count from 1, as in files.
impl fmt::Display for Body {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Finger(0) => f.write_str("pusher"),
            Self::Finger(k) => write!(f, "finger {k}"),
            Self::Fixel(j) => write!(f, "fixel {}", j + 1),
        }
    }
}

impl Body {
    /// Numbered from 1; 0 is no body.
    pub(crate) fn number(self) -> usize {
        match self {
            Body::Finger(i) => 1 + i,
            Body::Fixel(j) => 1 + MOST_FINGERS + j,
        }
    }
}
