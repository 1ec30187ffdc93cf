//! Two placed shapes whose contacts are sought: [`Pair`].

use stickslip_lanes::Lanes;

use crate::geometry::placed::Placed;
use crate::geometry::transform::Transform;

/// Width of the borders between features, as a share of the bodies' size: at least one of two
/// neighbours always answers.
const BORDER: f64 = 1e-12;

/// The object and another body.
pub(crate) struct Pair<'a, T = f64> {
    pub object: Placed<'a, T>,
    pub other: Placed<'a, T>,
    /// Place of each body in the frame of the other one.
    pub other_in_object: Transform<T>,
    pub object_in_other: Transform<T>,
    /// Gap below which a contact counts (m).
    pub search_distance: T,
    /// Width of the borders between features (m).
    pub slack: f64,
}

impl<'a, const W: usize> Pair<'a, Lanes<W>> {
    #[inline(always)]
    pub fn new(
        object: Placed<'a, Lanes<W>>,
        other: Placed<'a, Lanes<W>>,
        search_distance: Lanes<W>,
    ) -> Self {
        let other_in_object = other.transform.relative_to(&object.transform);
        Self {
            object,
            other,
            other_in_object,
            object_in_other: other_in_object.inverse(),
            search_distance,
            slack: BORDER * (object.shape.bounding_radius() + other.shape.bounding_radius()),
        }
    }

    /// One lane's pair.
    pub fn lane(&self, lane: usize) -> Pair<'a> {
        Pair {
            object: self.object.lane(lane),
            other: self.other.lane(lane),
            other_in_object: self.other_in_object.lane(lane),
            object_in_other: self.object_in_other.lane(lane),
            search_distance: self.search_distance.0[lane],
            slack: self.slack,
        }
    }
}

/// First ids of the contacts of a pair, by the kinds of the two features.
#[derive(Clone, Copy)]
pub(crate) struct FirstIds {
    /// A vertex of each.
    pub vertices: u32,
    /// A vertex of the object, an edge of the other.
    pub other_edges: u32,
}

impl FirstIds {
    #[inline(always)]
    pub fn new<T>(pair: &Pair<'_, T>) -> Self {
        let (object, other) = (pair.object.shape.outline(), pair.other.shape.outline());
        let vertices = other.vertices.len() * object.edges.len();
        let other_edges = vertices + other.vertices.len() * object.vertices.len();
        Self {
            vertices: vertices as u32,
            other_edges: other_edges as u32,
        }
    }
}
