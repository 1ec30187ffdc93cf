//! Pairs with an ellipse: closed form over an edge, Newton's method on the separation otherwise ([`crate::separation`]).

use crate::feature::{Cone, Ellipse};
use crate::narrow::Pair;
use crate::outline::Outline;
use crate::plane::{Vec2, add, dot, length, negate, scale, sub};
use crate::separation::{Peak, Separation};
use crate::Shape;

/// An ellipse against a feature, in the frame of the feature's body.
#[derive(Clone, Copy)]
struct Meeting {
    /// Unit normal out of the feature, into the ellipse.
    normal: Vec2,
    /// Boundary point of the ellipse.
    touch: Vec2,
    /// Gap (m).
    gap: f64,
}

impl Pair<'_> {
    /// Every pair with an ellipse.
    pub(crate) fn ellipses(&mut self, mine: &Outline, theirs: &Outline) {
        for ellipse in &theirs.ellipses {
            let seen = ellipse.seen_from(&self.in_object);
            self.ellipse_on_object(&seen);
            for own in &mine.ellipses {
                self.ellipse_on_ellipse(own, &seen);
            }
        }
        for ellipse in &mine.ellipses {
            self.ellipse_on_other(ellipse);
        }
    }

    /// An ellipse of the other body, in the object's frame.
    fn ellipse_on_object(&mut self, ellipse: &Ellipse) {
        meetings(ellipse, self.object, [self.reach, self.slack], |Meeting { normal, touch, gap }| {
            if !(ellipse.covered && self.other.hides(self.in_other.point(touch))) {
                self.push_in_object(negate(normal), add(touch, scale(-gap, normal)), gap);
            }
        });
    }

    fn ellipse_on_other(&mut self, own: &Ellipse) {
        let ellipse = own.seen_from(&self.in_other);
        meetings(&ellipse, self.other, [self.reach, self.slack], |Meeting { normal, touch, gap }| {
            let touch = self.in_object.point(touch);
            if !(own.covered && self.object.hides(touch)) {
                self.push_on_other(normal, touch, gap);
            }
        });
    }

    /// Both in the object's frame.
    fn ellipse_on_ellipse(&mut self, own: &Ellipse, theirs: &Ellipse) {
        let separation = Separation { d: sub(own.centre, theirs.centre), ellipses: [Some(own), Some(theirs)], radius: 0.0 };
        if length(separation.d) - own.radius() - theirs.radius() >= self.reach {
            return;
        }
        let Some(Peak { normal, gap }) = separation.widest(&Cone::full(), 0.0) else { return };
        let touch = own.point(negate(normal));
        let hidden = own.covered && self.object.hides(touch) || theirs.covered && self.other.hides(self.in_other.point(theirs.point(normal)));
        if gap < self.reach && !hidden {
            self.push_in_object(normal, touch, gap);
        }
    }
}

/// Reports where an ellipse meets the edges and round vertices of a shape, with a gap below `reach`.
///
/// Where its centre is outside, that is every feature with the centre in front; where it is inside, the one of least penetration too.
fn meetings(ellipse: &Ellipse, shape: &Shape, [reach, slack]: [f64; 2], mut report: impl FnMut(Meeting)) {
    let mut way_out: Option<Meeting> = None;
    let mut meet = |meeting: Meeting, height: f64| {
        if height >= 0.0 && meeting.gap < reach {
            report(meeting);
        } else if height < 0.0 && way_out.is_none_or(|way| meeting.gap > way.gap) {
            way_out = Some(meeting);
        }
    };
    for edge in &shape.outline().edges {
        let (_, height) = edge.coordinates(ellipse.centre);
        let (normal, touch) = (edge.normal(), ellipse.point(negate(edge.normal())));
        if edge.holds(edge.coordinates(touch).0, slack) {
            meet(Meeting { normal, touch, gap: height - ellipse.support(normal) }, height);
        }
    }
    for round in &shape.outline().rounds {
        let separation = Separation { d: sub(ellipse.centre, round.centre), ellipses: [Some(ellipse), None], radius: round.radius };
        if length(separation.d) - round.radius - ellipse.radius() >= reach {
            continue;
        }
        let Some(Peak { normal, gap }) = separation.widest(&round.cone, slack) else { continue };
        if !(round.covered && shape.hides(add(round.centre, scale(round.radius, normal)))) {
            meet(Meeting { normal, touch: ellipse.point(negate(normal)), gap }, dot(normal, separation.d));
        }
    }
    if let Some(way) = way_out.filter(|way| way.gap < reach && shape.contains(ellipse.centre)) {
        report(way);
    }
}
