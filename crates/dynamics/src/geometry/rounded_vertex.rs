//! Corners and discs: [`RoundedVertex`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::edge::Edge;
use crate::geometry::normal_cone::NormalCone;
use crate::geometry::transform::Transform;
use crate::geometry::vec2::{Vec2, add, negate, scale, splat};

/// A convex corner (radius 0, the cone between its edges' normals) or a disc (all normals), in the
/// body frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoundedVertex {
    pub centre: Vec2,
    /// Radius (m).
    pub radius: f64,
    pub cone: NormalCone,
    /// True if a sibling part hides some of it.
    pub covered: bool,
}

impl RoundedVertex {
    /// Lanes in which it faces an edge of another body; `in_other` places its own body in the
    /// other's frame.
    #[inline(always)]
    pub fn faces<const W: usize>(&self, edge: &Edge, in_other: &Transform<Lanes<W>>) -> Mask<W> {
        if self.cone.is_full() {
            return Mask::splat(true);
        }
        self.cone
            .nearly_contains_each(in_other.inv_rotate(negate(edge.normal())))
    }

    /// Its point nearest to the line of an edge of another body, in its own body's frame.
    #[inline(always)]
    pub fn nearest_point<const W: usize>(
        &self,
        edge: &Edge,
        in_other: &Transform<Lanes<W>>,
    ) -> Vec2<Lanes<W>> {
        if self.radius == 0.0 {
            return splat(self.centre);
        }
        add(
            in_other.inv_rotate(scale(-self.radius, edge.normal())),
            self.centre,
        )
    }
}
