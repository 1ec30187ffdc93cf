//! Polygons that overlap although no feature shows it: [`PolygonCollider`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::contact::Contact;
use crate::geometry::contact_manifold::ContactManifold;
use crate::geometry::pair::Pair;
use crate::geometry::separating_axis::{least_gap, least_penetration, separated};

/// Depth, as a share of the smaller body's size, above which the features' own contacts are
/// compared with the least penetration.
const SHALLOW: f64 = 1e-5;

/// Adds the least penetration of a pair's polygons where the features' contacts do not show it.
pub(crate) struct PolygonCollider<'a, const W: usize> {
    pub pair: &'a Pair<'a, Lanes<W>>,
    /// Id of the contact that it adds.
    pub id: u32,
    /// Lanes in which the two bodies may touch.
    pub active: Mask<W>,
    pub manifold: &'a mut ContactManifold<W>,
}

impl<const W: usize> PolygonCollider<'_, W> {
    /// Of two convex polygons, the least penetration bounds all gaps; in a union it only stands in
    /// for overlaps without a contact.
    #[inline(always)]
    pub fn collide(&mut self) {
        let (object, other) = (self.pair.object.shape, self.pair.other.shape);
        let parts = [object.convex_parts(), other.convex_parts()];
        let transforms = [&self.pair.other_in_object, &self.pair.object_in_other];
        let convex = if let [[a], [b]] = parts {
            Some([a, b])
        } else {
            None
        };

        // lanes whose polygons have no separating side, down to a depth where features are exact
        let asked = if convex.is_some() {
            self.active
        } else {
            self.active & !self.manifold.deeper_than(0.0)
        };
        let depth = -SHALLOW * object.bounding_radius().min(other.bounding_radius());
        let shallow = asked & !self.manifold.deeper_than(depth);
        let mut suspects = asked & !separated(parts, transforms, shallow, depth);

        // of two convex polygons, those whose contacts do not reach the least penetration
        if let Some(pair) = convex
            && suspects.any()
        {
            let least = least_gap(pair, transforms);
            suspects = suspects
                & least.lt(self.pair.search_distance.min(Lanes::ZERO))
                & !self.manifold.limit_depth(suspects, least, self.pair.slack);
        }
        if suspects.any() {
            self.push_least_penetrations(suspects);
        }
    }

    #[inline(never)]
    fn push_least_penetrations(&mut self, suspects: Mask<W>) {
        for lane in suspects.lanes() {
            let pair = self.pair.lane(lane);
            let parts = [pair.object.shape, pair.other.shape].map(|shape| shape.convex_parts());
            let Some(least) = least_penetration(parts, &pair.other_in_object) else {
                continue;
            };
            let here = Mask::from_fn(|i| i == lane);
            let reached = self
                .manifold
                .limit_depth(here, Lanes::splat(least.gap), pair.slack);
            if least.gap < pair.search_distance && !reached.lane(lane) {
                let contact = least.rotated(&pair.object.transform);
                self.manifold
                    .push(Contact::in_lane(self.id, lane, &contact));
            }
        }
    }
}
