//! Pairs with an ellipse: closed form over an edge, Newton's method on the separation otherwise
//! ([`crate::separation`]).

use crate::geometry::contact::Gap;
use crate::geometry::ellipse::{Peak, Separation};
use crate::geometry::feature::{Cone, Edge, Ellipse, Round};
use crate::geometry::part::Solid;
use crate::geometry::shape::Shape;
use crate::geometry::transform::{Frame, splat};
use crate::geometry::vec2::{Vec2, add, cross, dot, length, negate, scale, sub};

/// An ellipse against a feature, in the frame of the feature's body.
#[derive(Clone, Copy)]
struct Meeting {
    /// Unit normal out of the feature, into the ellipse.
    normal: Vec2,
    /// Boundary point of the ellipse.
    touch: Vec2,
    /// Gap (m).
    gap: f64,
    /// Whether the feature's own point is inside a sibling part.
    hidden: bool,
}

/// Two placed shapes, at least one of them with an ellipse.
pub(crate) struct EllipsePair<'a> {
    pub object: &'a Shape,
    pub other: &'a Shape,
    /// Object and other in the world.
    pub object_frame: Frame,
    pub other_frame: Frame,
    /// The other's frame seen from the object's, and the inverse.
    pub in_object: Frame,
    pub in_other: Frame,
    /// Gap below which a contact counts (m).
    pub reach: f64,
    /// Width of borders (m).
    pub slack: f64,
}

/// Contacts, each with whether a sibling part hides its point.
type Found = Vec<(Gap, bool)>;

impl EllipsePair<'_> {
    /// Appends the contacts of every pair with an ellipse.
    pub fn meet(&self, out: &mut Found) {
        let (mine, theirs) = (self.object.outline(), self.other.outline());
        for ellipse in &theirs.ellipses {
            let seen = ellipse.seen_from(&self.in_object);
            self.ellipse_on_object(&seen, out);
            for own in &mine.ellipses {
                self.ellipse_on_ellipse(own, &seen, out);
            }
        }
        for ellipse in &mine.ellipses {
            self.ellipse_on_other(ellipse, out);
        }
    }

    /// An ellipse of the other body, in the object's frame.
    fn ellipse_on_object(&self, ellipse: &Ellipse, out: &mut Found) {
        meetings(
            ellipse,
            self.object,
            [self.reach, self.slack],
            |Meeting {
                 normal,
                 touch,
                 gap,
                 hidden,
             }| {
                let contact = self.contact(negate(normal), add(touch, scale(-gap, normal)), gap);
                out.push((
                    contact,
                    hidden || ellipse.covered && hides(self.other, self.in_other.point(touch)),
                ));
            },
        );
    }

    fn ellipse_on_other(&self, own: &Ellipse, out: &mut Found) {
        let ellipse = own.seen_from(&self.in_other);
        meetings(
            &ellipse,
            self.other,
            [self.reach, self.slack],
            |Meeting {
                 normal,
                 touch,
                 gap,
                 hidden,
             }| {
                let touch = self.in_object.point(touch);
                let contact = Gap {
                    normal: self.other_frame.turn(normal),
                    arm: self.object_frame.turn(touch),
                    gap,
                };
                out.push((contact, hidden || own.covered && hides(self.object, touch)));
            },
        );
    }

    /// Both in the object's frame.
    fn ellipse_on_ellipse(&self, own: &Ellipse, theirs: &Ellipse, out: &mut Found) {
        let separation = Separation {
            d: sub(own.centre, theirs.centre),
            ellipses: [Some(own), Some(theirs)],
            radius: 0.0,
        };
        if length(separation.d) - own.radius() - theirs.radius() >= self.reach {
            return;
        }
        let Some(Peak { normal, gap }) = separation.widest(&Cone::full(), 0.0) else {
            return;
        };
        let touch = own.point(negate(normal));
        let hidden = own.covered && hides(self.object, touch)
            || theirs.covered && hides(self.other, self.in_other.point(theirs.point(normal)));
        if gap < self.reach {
            out.push((self.contact(normal, touch, gap), hidden));
        }
    }

    /// A contact given in the object's frame.
    fn contact(&self, normal: Vec2, touch: Vec2, gap: f64) -> Gap {
        Gap {
            normal: self.object_frame.turn(normal),
            arm: self.object_frame.turn(touch),
            gap,
        }
    }
}

/// Reports where an ellipse meets a shape with a gap below `reach`.
fn meetings(
    ellipse: &Ellipse,
    shape: &Shape,
    [reach, slack]: [f64; 2],
    report: impl FnMut(Meeting),
) {
    if shape.parts().len() == 1 {
        with_convex(ellipse, shape, slack)
            .into_iter()
            .filter(|meeting| meeting.gap < reach)
            .for_each(report);
    } else {
        with_union(ellipse, shape, [reach, slack], report);
    }
}

/// Two convex bodies have one contact: where the separation is largest.
fn with_convex(ellipse: &Ellipse, shape: &Shape, slack: f64) -> Option<Meeting> {
    let mut best: Option<Meeting> = None;
    for meeting in shape
        .outline()
        .edges
        .iter()
        .filter_map(|edge| over_edge(ellipse, edge, slack))
    {
        // apart, a local maximum is the only one
        if meeting.gap >= 0.0 {
            return Some(meeting);
        }
        best = wider(best, meeting);
    }
    for round in &shape.outline().rounds {
        let bound = round.cone.support(sub(ellipse.centre, round.centre))
            - ellipse.inner_radius()
            - round.radius;
        if best.is_none_or(|best| bound > best.gap)
            && let Some(meeting) = about_round(ellipse, round, slack)
        {
            best = wider(best, meeting);
        }
    }
    best
}

/// The one with the larger separation.
fn wider(best: Option<Meeting>, new: Meeting) -> Option<Meeting> {
    Some(best.filter(|best| best.gap >= new.gap).unwrap_or(new))
}

/// With a union it is every feature that has the ellipse's centre in front; where the centre is
/// inside, the least penetration too; where none of these answers for an overlap, as about a part
/// that the ellipse holds whole, the least penetration into the parts.
fn with_union(
    ellipse: &Ellipse,
    shape: &Shape,
    [reach, slack]: [f64; 2],
    mut report: impl FnMut(Meeting),
) {
    let (mut way_out, mut answered): (Option<Meeting>, bool) = (None, false);
    let mut meet = |meeting: Meeting, from: Vec2| {
        let height = dot(meeting.normal, sub(ellipse.centre, from));
        answered |= height >= 0.0 && meeting.gap < 0.0;
        if height >= 0.0 && meeting.gap < reach {
            report(meeting);
        } else if height < 0.0 && way_out.is_none_or(|way| meeting.gap > way.gap) {
            way_out = Some(meeting);
        }
    };
    for edge in &shape.outline().edges {
        if let Some(meeting) = over_edge(ellipse, edge, slack) {
            meet(meeting, edge.start);
        }
    }
    for round in &shape.outline().rounds {
        let near =
            length(sub(ellipse.centre, round.centre)) - round.radius - ellipse.radius() < reach;
        let Some(meeting) = near.then(|| about_round(ellipse, round, slack)).flatten() else {
            continue;
        };
        let hidden = round.covered
            && hides(
                shape,
                add(round.centre, scale(round.radius, meeting.normal)),
            );
        meet(Meeting { hidden, ..meeting }, round.centre);
    }
    let way_out = way_out.filter(|_| shape.contains(&splat::<1>(ellipse.centre)).lane(0));
    let least = if answered || way_out.is_some() {
        None
    } else {
        least_penetration(ellipse, shape.solids())
    };
    way_out
        .or(least)
        .filter(|way| way.gap < reach)
        .into_iter()
        .for_each(report);
}

/// Into the polygons of a union that an ellipse overlaps: each one's shallowest way out, the
/// deepest of these.
fn least_penetration(ellipse: &Ellipse, solids: &[Solid]) -> Option<Meeting> {
    let overlapped = solids.iter().filter(|solid| reaches_into(ellipse, solid));
    let ways = overlapped.filter_map(|solid| shallowest(ellipse, solid));
    ways.reduce(|deepest, way| if way.gap < deepest.gap { way } else { deepest })
}

/// The side that an ellipse reaches least far behind; seams are no way out.
fn shallowest(ellipse: &Ellipse, solid: &Solid) -> Option<Meeting> {
    let Solid::Polygon(polygon) = solid else {
        return None;
    };
    polygon
        .sides
        .iter()
        .filter(|side| side.exposed)
        .fold(None, |best, side| {
            let gap = dot(side.normal, ellipse.centre) - side.offset - ellipse.support(side.normal);
            wider(
                best,
                Meeting {
                    normal: side.normal,
                    touch: ellipse.point(negate(side.normal)),
                    gap,
                    hidden: false,
                },
            )
        })
}

/// Whether a boundary point of one part of `shape` is not on the union's boundary.
fn hides(shape: &Shape, point: Vec2) -> bool {
    shape.hides(&splat::<1>(point)).lane(0)
}

/// Whether an ellipse and a polygon overlap: scaled so that the ellipse is the unit circle, by the
/// distance from its centre.
fn reaches_into(ellipse: &Ellipse, solid: &Solid) -> bool {
    let Solid::Polygon(polygon) = solid else {
        return false;
    };
    let [a, b] = ellipse.semi_axes;
    let scaled = |corner: &Vec2| {
        let d = sub(*corner, ellipse.centre);
        [dot(ellipse.axis, d) / a, cross(ellipse.axis, d) / b]
    };
    let next = polygon.corners.iter().cycle().skip(1);
    let nearest = polygon
        .corners
        .iter()
        .zip(next)
        .map(|(from, to)| distance_to_segment(scaled(from), scaled(to)));
    solid.depth(ellipse.centre) > 0.0 || nearest.fold(f64::INFINITY, f64::min) < 1.0
}

/// Distance from the origin to a segment.
fn distance_to_segment(from: Vec2, to: Vec2) -> f64 {
    let along = sub(to, from);
    let share = (-dot(from, along) / dot(along, along)).clamp(0.0, 1.0);
    length(add(from, scale(share, along)))
}

/// Closed form: the ellipse's lowest point, if it stands over the edge.
fn over_edge(ellipse: &Ellipse, edge: &Edge, slack: f64) -> Option<Meeting> {
    let normal = edge.normal();
    let touch = ellipse.point(negate(normal));
    let (s, _) = edge.coordinates(touch);
    let (_, height) = edge.coordinates(ellipse.centre);
    edge.holds(s, slack).then(|| Meeting {
        normal,
        touch,
        gap: height - ellipse.support(normal),
        hidden: false,
    })
}

/// The largest separation from a corner or a disc within its cone.
fn about_round(ellipse: &Ellipse, round: &Round, slack: f64) -> Option<Meeting> {
    let separation = Separation {
        d: sub(ellipse.centre, round.centre),
        ellipses: [Some(ellipse), None],
        radius: round.radius,
    };
    let Peak { normal, gap } = separation.widest(&round.cone, slack)?;
    Some(Meeting {
        normal,
        touch: ellipse.point(negate(normal)),
        gap,
        hidden: false,
    })
}
