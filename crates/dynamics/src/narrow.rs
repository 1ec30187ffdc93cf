//! Contacts between two placed shapes: gap, normal and contact point ([`narrow_phase`]).
//!
//! Signs: the normal points INTO the object; the gap is positive where the bodies are apart. With the twists v of the object and v'
//! of the other body, the rate of the gap is (n, r × n)·v − n·u, r the contact's arm and u the other surface's velocity there.
//!
//! Pairs that can touch: an edge with a round vertex (corner or disc) or an ellipse, either way round, and two of the latter.
//! - A corner meets every edge that it stands over and faces, its normal cone widened a little: faces that meet give two points.
//! - Two corners meet along the line of their centres where it lies in both cones; the borders of a cone are those of the edges
//!   beside it, so that a corner that is passed is always answered for by one of them.
//! - A centre inside the other body meets only the edge of least penetration (and those in a reflex corner with it); edges whose
//!   back it sees from outside are not met.
//! - A point of a disc or an ellipse that lies inside a sibling part touches only where an overlap would have no contact else.
//! - Where polygons overlap with no corner of one in the other, their parts' least penetration (by separating axes) is a contact; of
//!   two convex polygons no gap is deeper than that, and one is as deep.

use crate::feature::{Edge, Round};
use crate::outline::Outline;
use crate::overlap::least_penetration;
use crate::plane::{Frame, Vec2, add, cross, dot, length, negate, scale, sub};
use crate::{Pose, Shape};

/// Width of the borders between features, as a share of the bodies' size: at least one of two neighbours always answers.
const BORDER: f64 = 1e-12;

/// Slack of the borders of a cone (rad).
const ANGLE: f64 = 1e-9;

/// Contacts whose lines of action are nearer than this share of the object's size, with normals within about 0.1 rad, are one.
const SAME_LINE: f64 = 1e-4;

/// Cosine of the largest angle between the normals of one contact.
const SAME_NORMAL: f64 = 0.995;

/// A contact of the object with another body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Unit normal into the object, world frame.
    pub normal: [f64; 2],
    /// Contact point on the object's boundary minus the object's origin, world frame (m).
    pub arm: [f64; 2],
    /// Gap (m); negative is overlap.
    pub gap: f64,
}

/// A shape at a pose, with the pose's sine and cosine.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    shape: &'a Shape,
    frame: Frame,
}

impl<'a> Placed<'a> {
    /// Places a shape.
    pub fn new(shape: &'a Shape, pose: Pose) -> Self {
        Self { shape, frame: Frame::new(pose) }
    }
}

/// Appends every contact of `object` with `other` whose gap is below `reach` (m).
///
/// Nothing is allocated but what `out` grows by. The order of contacts is fixed by the shapes' features.
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
pub fn narrow_phase(object: &Placed<'_>, other: &Placed<'_>, reach: f64, out: &mut Vec<Gap>) {
    let apart = sub(other.frame.origin, object.frame.origin);
    let near = object.shape.bounding_radius() + other.shape.bounding_radius() + reach;
    if near > 0.0 && dot(apart, apart) < near * near {
        Pair::new(object, other, reach, out).meet();
    }
}

/// Two placed shapes and where their contacts go.
pub(crate) struct Pair<'a> {
    pub object: &'a Shape,
    pub other: &'a Shape,
    /// Object and other in the world.
    object_frame: Frame,
    other_frame: Frame,
    /// The other's frame seen from the object's, and the inverse.
    pub in_object: Frame,
    pub in_other: Frame,
    /// Gap below which a contact counts (m).
    pub reach: f64,
    /// Width of borders (m).
    pub slack: f64,
    out: &'a mut Vec<Gap>,
    first: usize,
    /// The deepest overlap at a boundary point that a sibling part hides.
    hidden: Option<Gap>,
}

/// Where the centre of a round vertex stands over an edge.
#[derive(Clone, Copy)]
struct Stand<'a> {
    edge: &'a Edge,
    /// Distance of its foot along the edge, and height above the edge's line (m).
    s: f64,
    height: f64,
}

impl<'a> Pair<'a> {
    #[inline]
    fn new(object: &'a Placed<'a>, other: &'a Placed<'a>, reach: f64, out: &'a mut Vec<Gap>) -> Self {
        let in_object = other.frame.seen_from(&object.frame);
        let slack = BORDER * (object.shape.bounding_radius() + other.shape.bounding_radius());
        let (object_frame, other_frame, first) = (object.frame, other.frame, out.len());
        let in_other = in_object.inverse();
        Self {
            object: object.shape,
            other: other.shape,
            object_frame,
            other_frame,
            in_object,
            in_other,
            reach,
            slack,
            out,
            first,
            hidden: None,
        }
    }

    #[inline]
    fn meet(&mut self) {
        let (mine, theirs) = (self.object.outline(), self.other.outline());
        self.rounds_on_object(mine, theirs);
        if !theirs.edges.is_empty() {
            self.rounds_on_other(mine, theirs);
        }
        if !mine.ellipses.is_empty() || !theirs.ellipses.is_empty() {
            self.ellipses(mine, theirs);
        }
        if !mine.edges.is_empty() && !theirs.edges.is_empty() {
            self.polygons();
        }
        if let Some(hidden) = self.hidden
            && !self.overlaps()
        {
            self.push(hidden);
        }
    }

    /// Whether a contact found so far is an overlap.
    #[inline(always)]
    fn overlaps(&self) -> bool {
        self.out[self.first..].iter().any(|contact| contact.gap < 0.0)
    }

    /// The other's corners and discs against the object's edges, corners and discs, in the object's frame.
    #[inline]
    fn rounds_on_object(&mut self, mine: &Outline, theirs: &Outline) {
        let frame = self.in_object;
        for round in &theirs.rounds {
            let centre = frame.point(round.centre);
            if !self.within(centre, self.object, round.radius) {
                continue;
            }
            let faces = |edge: &Edge| round.cone.faces(frame.turn_back(negate(edge.normal())));
            let (object, limits) = (self.object, [self.reach + round.radius, self.slack]);
            stands(object, centre, limits, faces, |Stand { edge, s, height }| {
                let touch = add(round.centre, scale(-round.radius, frame.turn_back(edge.normal())));
                let contact = self.contact(negate(edge.normal()), edge.at(s), height - round.radius);
                self.push_unless(round.covered && self.other.hides(touch), contact);
            });
            for own in &mine.rounds {
                self.round_on_round(own, round, centre);
            }
        }
    }

    /// The object's corners and discs against the other's edges, in the other's frame.
    #[inline]
    fn rounds_on_other(&mut self, mine: &Outline, theirs: &Outline) {
        debug_assert!(!theirs.edges.is_empty());
        let frame = self.in_other;
        for round in &mine.rounds {
            let centre = frame.point(round.centre);
            if !self.within(centre, self.other, round.radius) {
                continue;
            }
            let faces = |edge: &Edge| round.cone.faces(frame.turn_back(negate(edge.normal())));
            let (other, limits) = (self.other, [self.reach + round.radius, self.slack]);
            stands(other, centre, limits, faces, |Stand { edge, height, .. }| {
                let touch = add(round.centre, scale(-round.radius, frame.turn_back(edge.normal())));
                let contact = self.contact_on_other(edge.normal(), touch, height - round.radius);
                self.push_unless(round.covered && self.object.hides(touch), contact);
            });
        }
    }

    /// Whether a disc about `centre`, in the frame of `shape`, comes near the shape's bounding disc.
    #[inline(always)]
    fn within(&self, centre: Vec2, shape: &Shape, radius: f64) -> bool {
        let limit = shape.bounding_radius() + self.reach + radius;
        limit > 0.0 && dot(centre, centre) < limit * limit
    }

    /// Two corners or discs; `centre` is that of the other's one in the object's frame.
    #[inline(always)]
    fn round_on_round(&mut self, own: &Round, round: &Round, centre: Vec2) {
        let d = sub(own.centre, centre);
        let limit = own.radius + round.radius + self.reach;
        if limit > 0.0
            && dot(d, d) < limit * limit
            && own.cone.holds(negate(d), self.slack)
            && round.cone.holds(self.in_object.turn_back(d), self.slack)
        {
            self.push_rounds(own, round, d);
        }
    }

    /// `d` leads from the other's centre to the object's one. A corner's own edges answer for what is right at it.
    fn push_rounds(&mut self, own: &Round, round: &Round, d: Vec2) {
        let distance = length(d);
        if distance <= self.slack && !(own.cone.is_full() && round.cone.is_full()) {
            return;
        }
        let normal = if distance > 0.0 { scale(1.0 / distance, d) } else { [1.0, 0.0] };
        if !own.cone.holds(negate(normal), ANGLE) || !round.cone.holds(self.in_object.turn_back(normal), ANGLE) {
            return;
        }
        let touch = add(own.centre, scale(-own.radius, normal));
        let theirs = add(round.centre, scale(round.radius, self.in_object.turn_back(normal)));
        let contact = self.contact(normal, touch, distance - own.radius - round.radius);
        self.push_unless(own.covered && self.object.hides(touch) || round.covered && self.other.hides(theirs), contact);
    }

    /// Polygons that overlap although no feature answered for it; of two convex ones, the least penetration bounds all gaps.
    fn polygons(&mut self) {
        let convex = self.object.parts().len() == 1 && self.other.parts().len() == 1;
        if !convex && self.overlaps() {
            return;
        }
        let Some(least) = least_penetration(self.object.solids(), self.other.solids(), &self.in_object) else { return };
        let mut kept = self.first;
        for k in self.first..self.out.len() {
            if self.out[k].gap >= least.gap - self.slack {
                self.out[kept] = self.out[k];
                kept += 1;
            }
        }
        self.out.truncate(kept);
        let answered = self.out[self.first..].iter().any(|contact| contact.gap <= least.gap + self.slack);
        if least.gap < self.reach && !answered {
            self.push(self.contact(least.normal, least.touch, least.gap));
        }
    }

    /// A contact given in the object's frame.
    #[inline(always)]
    pub fn contact(&self, normal: Vec2, touch: Vec2, gap: f64) -> Gap {
        Gap { normal: self.object_frame.turn(normal), arm: self.object_frame.turn(touch), gap }
    }

    /// A contact given by its normal in the other's frame and its point in the object's.
    #[inline(always)]
    pub fn contact_on_other(&self, normal: Vec2, touch: Vec2, gap: f64) -> Gap {
        Gap { normal: self.other_frame.turn(normal), arm: self.object_frame.turn(touch), gap }
    }

    /// A contact whose point a sibling part hides counts only in overlap, and only if there is no other.
    #[inline(always)]
    pub fn push_unless(&mut self, hidden: bool, contact: Gap) {
        if !hidden {
            self.push(contact);
        } else if contact.gap < 0.0 && self.hidden.is_none_or(|old| contact.gap < old.gap) {
            self.hidden = Some(contact);
        }
    }

    /// Of two contacts with one line of action, which have one row W_n, keeps that with the smaller gap.
    #[inline(always)]
    fn push(&mut self, new: Gap) {
        let near = SAME_LINE * self.object.bounding_radius();
        let same = |old: &&mut Gap| {
            let d = sub(old.arm, new.arm);
            cross(d, old.normal).abs() < near && cross(d, new.normal).abs() < near && dot(old.normal, new.normal) > SAME_NORMAL
        };
        match self.out[self.first..].iter_mut().find(same) {
            Some(old) if new.gap < old.gap => *old = new,
            Some(_) => {}
            None => self.out.push(new),
        }
    }
}

/// Reports the edges of `shape` over which `centre` stands, less than `limit` high, among those that the round vertex faces.
///
/// From outside these are all that see it on their outward side; from inside, the edge of least penetration and those that meet it
/// in a reflex corner as well.
#[inline(always)]
fn stands<'s>(shape: &'s Shape, centre: Vec2, [limit, slack]: [f64; 2], faces: impl Fn(&Edge) -> bool, mut report: impl FnMut(Stand<'s>)) {
    let edges = &shape.outline().edges;
    let (mut highest, mut beside) = (f64::NEG_INFINITY, false);
    let mut way_out: Option<Stand<'s>> = None;
    for edge in edges {
        let (s, height) = edge.coordinates(centre);
        highest = if height > highest { height } else { highest };
        if height >= limit || !edge.holds(s, slack) {
            continue;
        }
        if !faces(edge) {
            continue;
        }
        if height >= 0.0 {
            beside |= height < shape.tolerance() && s >= 0.0 && s <= edge.length;
            report(Stand { edge, s, height });
        } else if way_out.is_none_or(|way| height > way.height) {
            way_out = Some(Stand { edge, s, height });
        }
    }
    let Some(way) = way_out else { return };
    // a corner flush with one face may lie behind the next; what rests on a face that it faces is outside
    let inside = if shape.parts().len() == 1 { highest <= slack } else { shape.contains(centre) };
    if beside || !inside {
        return;
    }
    report(way);
    for edge in way.edge.reflex.iter().flatten().map(|k| &edges[*k as usize]) {
        let (s, height) = edge.coordinates(centre);
        if height < 0.0 && height < limit && edge.holds(s, slack) && faces(edge) {
            report(Stand { edge, s, height });
        }
    }
}
