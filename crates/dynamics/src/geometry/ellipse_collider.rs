//! The ellipses of two bodies against all features, lane by lane: [`EllipseCollider`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::contact::{Contact, Gap};
use crate::geometry::contact_manifold::ContactManifold;
use crate::geometry::ellipse::Ellipse;
use crate::geometry::ellipse_contact::{EllipseContact, hides};
use crate::geometry::normal_cone::NormalCone;
use crate::geometry::pair::Pair;
use crate::geometry::separation::{Peak, Separation};
use crate::geometry::vec2::{add, length, negate, scale, sub};

/// Adds the contacts of a pair that have an ellipse, with ids from `first_id` on, in the lanes of
/// `active`.
#[inline(never)]
pub(crate) fn collide_ellipses<const W: usize>(
    pair: &Pair<'_, Lanes<W>>,
    first_id: u32,
    active: Mask<W>,
    found: &mut Vec<EllipseContact>,
    manifold: &mut ContactManifold<W>,
) {
    for lane in active.lanes() {
        found.clear();
        let pair = &pair.lane(lane);
        EllipseCollider { pair, found }.collide();
        for (k, EllipseContact { contact, hidden }) in found.iter().enumerate() {
            let contact = Contact::in_lane(first_id + k as u32, lane, contact);
            manifold.push_unless(Mask::splat(*hidden), contact);
        }
    }
}

/// Finds the contacts of a pair that have an ellipse, in the world frame.
struct EllipseCollider<'a> {
    pair: &'a Pair<'a>,
    found: &'a mut Vec<EllipseContact>,
}

impl EllipseCollider<'_> {
    fn collide(&mut self) {
        let (object, other) = (self.pair.object.shape, self.pair.other.shape);
        for ellipse in &other.outline().ellipses {
            let seen = ellipse.transformed(&self.pair.other_in_object);
            self.ellipse_on_object(&seen);
            for own in &object.outline().ellipses {
                self.ellipse_on_ellipse(own, &seen);
            }
        }
        for ellipse in &object.outline().ellipses {
            self.ellipse_on_other(ellipse);
        }
    }

    /// An ellipse of the other body, in the object's frame.
    fn ellipse_on_object(&mut self, ellipse: &Ellipse) {
        let Pair {
            object,
            other,
            object_in_other,
            search_distance,
            slack,
            ..
        } = self.pair;
        let distances = [*search_distance, *slack];
        EllipseContact::find(ellipse, object.shape, distances, |found| {
            let Gap { normal, arm, gap } = found.contact;
            let contact = Gap {
                normal: negate(normal),
                arm: add(arm, scale(-gap, normal)),
                gap,
            };
            let point = object_in_other.transform_point(arm);
            self.found.push(EllipseContact {
                contact: contact.rotated(&object.transform),
                hidden: found.hidden || ellipse.covered && hides(other.shape, point),
            });
        });
    }

    /// An ellipse of the object, in its own frame.
    fn ellipse_on_other(&mut self, own: &Ellipse) {
        let Pair {
            object,
            other,
            other_in_object,
            object_in_other,
            search_distance,
            slack,
        } = self.pair;
        let ellipse = own.transformed(object_in_other);
        let distances = [*search_distance, *slack];
        EllipseContact::find(&ellipse, other.shape, distances, |found| {
            let Gap { normal, arm, gap } = found.contact;
            let point = other_in_object.transform_point(arm);
            let contact = Gap {
                normal: other.transform.rotate(normal),
                arm: object.transform.rotate(point),
                gap,
            };
            self.found.push(EllipseContact {
                contact,
                hidden: found.hidden || own.covered && hides(object.shape, point),
            });
        });
    }

    /// An ellipse of each body, both in the object's frame.
    fn ellipse_on_ellipse(&mut self, object: &Ellipse, other: &Ellipse) {
        let pair = self.pair;
        let separation = Separation {
            d: sub(object.centre, other.centre),
            ellipses: [Some(object), Some(other)],
            radius: 0.0,
        };
        let radii = [object, other].map(Ellipse::outer_radius);
        if length(separation.d) - radii[0] - radii[1] >= pair.search_distance {
            return;
        }
        let Some(Peak { normal, gap }) = separation.widest(&NormalCone::full(), 0.0) else {
            return;
        };
        if gap >= pair.search_distance {
            return;
        }
        let arm = object.point(negate(normal));
        let other_point = pair.object_in_other.transform_point(other.point(normal));
        let contact = Gap { normal, arm, gap };
        self.found.push(EllipseContact {
            contact: contact.rotated(&pair.object.transform),
            hidden: object.covered && hides(pair.object.shape, arm)
                || other.covered && hides(pair.other.shape, other_point),
        });
    }
}
