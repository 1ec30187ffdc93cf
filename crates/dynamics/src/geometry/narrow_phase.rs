//! Contacts between two placed shapes, `W` pairs of poses side by side: gap, normal and contact
//! point ([`narrow_phase`]).
//!
//! Signs: the normal points INTO the object; the gap is positive where the bodies are apart. With
//! the twists v of the object and v' of the other body, the rate of the gap is (n, r × n)·v − n·u,
//! r the contact's arm and u the other surface's velocity there.
//!
//! Two kinds of pairs of features touch: an edge with a rounded vertex (corner or disc) of the
//! other body, and two rounded vertices.
//! - A corner touches every edge that it projects onto and faces, its normal cone widened a little:
//!   faces that meet give two points.
//! - Two corners touch along the line of their centres where it lies in both cones. The borders of
//!   a cone are those of the edges next to it, so that a corner that is passed always has a contact
//!   with one of them.
//! - A centre inside the other body touches only the edge of least penetration (and those in a
//!   reflex corner with it); from outside, edges that are seen from behind do not count.
//! - A point of a disc that lies inside a sibling part counts only where an overlap
//!   would have no contact else.
//! - Where polygons overlap with no corner of one in the other, their parts' least penetration (by
//!   separating axes) is a contact; of two convex polygons no gap is deeper than that, and one is
//!   as deep.

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::contact::{Contact, Gap};
use crate::geometry::contact_manifold::ContactManifold;
use crate::geometry::edge_search::EdgeProjection;
use crate::geometry::pair::{FirstIds, Pair};
use crate::geometry::placed::{Placed, may_touch};
use crate::geometry::polygon_collider::PolygonCollider;
use crate::geometry::vertex_collider::VertexCollider;

/// Ids after all others: of the contact for an overlap that no feature shows, and of the one whose
/// point a sibling part hides.
const LEAST_PENETRATION: u32 = Contact::<1>::ID_COUNT - 2;
const HIDDEN: u32 = Contact::<1>::ID_COUNT - 1;

/// Appends every contact of `object` with `other` whose gap is below `search_distance` (m).
///
/// The order of contacts is fixed by the shapes' features.
///
/// ```
/// # use stickslip_dynamics::{Part, Placed, Pose, Shape, narrow_phase};
/// let disc = |radius| Shape::new(vec![Part::Disc { radius, centre: [0.0, 0.0] }]);
/// let (object, pusher) = (disc(0.03)?, disc(0.005)?);
/// let mut gaps = Vec::new();
/// let pose = Pose::new(-0.036, 0.0, 0.0);
/// narrow_phase(&Placed::new(&object, Pose::default()), &Placed::new(&pusher, pose), 0.002, &mut gaps);
/// assert_eq!((gaps[0].normal, gaps[0].arm), ([1.0, 0.0], [-0.03, 0.0]));
/// assert!((gaps[0].gap - 0.001).abs() < 1e-15);
/// # Ok::<(), stickslip_dynamics::ShapeError>(())
/// ```
pub fn narrow_phase(
    object: &Placed<'_>,
    other: &Placed<'_>,
    search_distance: f64,
    out: &mut Vec<Gap>,
) {
    let mut narrow = NarrowPhase::<1>::default();
    let [object, other] = [object, other].map(Placed::splat);
    let origins = [object.transform.origin, other.transform.origin];
    let search_distance = Lanes([search_distance]);
    let active = may_touch([object.shape, other.shape], origins, search_distance);
    if !active.any() {
        return;
    }
    narrow.collide(object, other, search_distance, active);
    let contacts = narrow.contacts().filter(|found| found.present.lane(0));
    out.extend(contacts.map(|found| found.lane(0)));
}

/// Finds the contacts of two shapes, and keeps the memory that this takes.
#[derive(Clone, Debug, Default)]
pub(crate) struct NarrowPhase<const W: usize> {
    manifold: ContactManifold<W>,
    projections: Vec<EdgeProjection<W>>,
}

impl<const W: usize> NarrowPhase<W> {
    /// Finds the contacts of two bodies whose gap is below `search_distance` (m), in the `active`
    /// lanes: those in which they [`may_touch`], of which there is one.
    #[inline(always)]
    pub fn collide(
        &mut self,
        object: Placed<'_, Lanes<W>>,
        other: Placed<'_, Lanes<W>>,
        search_distance: Lanes<W>,
        active: Mask<W>,
    ) {
        self.manifold.clear(object.shape.bounding_radius());
        let pair = Pair::new(object, other, search_distance);
        self.collide_pair(&pair, active);
    }

    #[inline(always)]
    fn collide_pair(&mut self, pair: &Pair<'_, Lanes<W>>, active: Mask<W>) {
        let (object, other) = (pair.object.shape.outline(), pair.other.shape.outline());
        let (ids, manifold) = (FirstIds::new(pair), &mut self.manifold);

        // corners and discs
        let mut vertices = VertexCollider {
            pair,
            ids,
            active,
            projections: &mut self.projections,
            manifold,
        };
        vertices.collide_other_vertices();
        if !other.edges.is_empty() {
            vertices.collide_object_vertices();
        }

        // overlaps that no feature shows
        if !object.edges.is_empty() && !other.edges.is_empty() {
            PolygonCollider {
                pair,
                id: LEAST_PENETRATION,
                active,
                manifold,
            }
            .collide();
        }

        manifold.settle_hidden(HIDDEN);
        manifold.sort();
    }

    /// The contacts found last; some may be present in no lane.
    #[inline(always)]
    pub fn contacts(&self) -> impl Iterator<Item = &Contact<W>> {
        self.manifold.iter()
    }
}
