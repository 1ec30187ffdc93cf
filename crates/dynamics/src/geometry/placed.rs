//! A shape at a pose: [`Placed`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::shape::Shape;
use crate::geometry::transform::Transform;
use crate::geometry::vec2::{Vec2, dot, sub};
use crate::se2::Pose;

/// A shape at a pose, with the pose's sine and cosine.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a, T = f64> {
    pub(crate) shape: &'a Shape,
    /// From the shape's frame to the world.
    pub(crate) transform: Transform<T>,
}

impl<'a> Placed<'a> {
    /// Places a shape.
    pub fn new(shape: &'a Shape, pose: Pose) -> Self {
        Self {
            shape,
            transform: Transform::from(pose),
        }
    }

    /// Copies it into every lane.
    #[inline(always)]
    pub(crate) fn splat<const W: usize>(&self) -> Placed<'a, Lanes<W>> {
        Placed {
            shape: self.shape,
            transform: self.transform.splat(),
        }
    }
}

impl<'a, const W: usize> Placed<'a, Lanes<W>> {
    /// One lane's.
    #[inline(always)]
    pub(crate) fn lane(&self, lane: usize) -> Placed<'a> {
        Placed {
            shape: self.shape,
            transform: self.transform.lane(lane),
        }
    }
}

/// Lanes in which the bounding discs of two bodies at `origins` (m) are less than `distance` (m)
/// apart. Elsewhere no gap can be below it.
#[inline(always)]
pub(crate) fn may_touch<const W: usize>(
    [object, other]: [&Shape; 2],
    origins: [Vec2<Lanes<W>>; 2],
    distance: Lanes<W>,
) -> Mask<W> {
    let apart = sub(origins[0], origins[1]);
    let limit = distance + (object.bounding_radius() + other.bounding_radius());
    limit.gt(Lanes::ZERO) & dot(apart, apart).lt(limit * limit)
}
