//! The features of two placed shapes, each against each: [`Pair`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::contact::{Contact, Gap};
use crate::geometry::edge_search::{Search, Stand};
use crate::geometry::ellipse_pair::EllipsePair;
use crate::geometry::feature::{Edge, Round};
use crate::geometry::narrow_phase::{NarrowWork, PairFrames};
use crate::geometry::outline::Outline;
use crate::geometry::separating_axis::{least_gap, least_penetration, separated};
use crate::geometry::shape::Shape;
use crate::geometry::transform::{Frames, Vec2s, dot, dot_fixed, splat};
use crate::geometry::vec2::{Vec2, negate, scale};

/// Width of the borders between features, as a share of the bodies' size: at least one of two
/// neighbours always answers.
const BORDER: f64 = 1e-12;

/// Slack of the borders of a cone (rad).
const ANGLE: f64 = 1e-9;

/// Depth, as a share of the smaller body's size, above which the features' own contacts are
/// compared with the least penetration.
const SHALLOW: f64 = 1e-5;

/// Two placed shapes and where their contacts go.
pub(crate) struct Pair<'a, const W: usize> {
    object: &'a Shape,
    other: &'a Shape,
    /// Object and other in the world.
    object_frame: Frames<W>,
    other_frame: Frames<W>,
    /// The other's frame seen from the object's, and the inverse.
    in_object: Frames<W>,
    in_other: Frames<W>,
    /// Lanes in which the two can touch.
    near: Mask<W>,
    /// Gap below which a contact counts (m).
    reach: Lanes<W>,
    /// Width of borders (m).
    slack: f64,
    places: Places,
    work: &'a mut NarrowWork<W>,
}

/// First numbers of the contacts between features, by kind of pair.
#[derive(Clone, Copy)]
struct Places {
    round_on_round: u32,
    round_on_other: u32,
    ellipses: u32,
}

/// The contact that stands for an overlap no feature answers for, and one whose point a sibling
/// part hides: after all others.
const LEAST_PENETRATION: u32 = Contact::<1>::PLACES - 2;
const HIDDEN: u32 = Contact::<1>::PLACES - 1;

impl<'a, const W: usize> Pair<'a, W> {
    /// Of shapes at `frames`, which can touch in the lanes of `near`, with gaps below `reach` (m).
    #[inline(always)]
    pub fn new(
        [object, other]: [&'a Shape; 2],
        frames: &PairFrames<W>,
        reach: Lanes<W>,
        near: Mask<W>,
        work: &'a mut NarrowWork<W>,
    ) -> Self {
        let in_object = frames.other.seen_from(&frames.object);
        let (mine, theirs) = (object.outline(), other.outline());
        let round_on_round = theirs.rounds.len() * mine.edges.len();
        let round_on_other = round_on_round + theirs.rounds.len() * mine.rounds.len();
        let ellipses = round_on_other + mine.rounds.len() * theirs.edges.len();
        Self {
            object,
            other,
            object_frame: frames.object,
            other_frame: frames.other,
            in_object,
            in_other: in_object.inverse(),
            near,
            reach,
            slack: BORDER * (object.bounding_radius() + other.bounding_radius()),
            places: Places {
                round_on_round: round_on_round as u32,
                round_on_other: round_on_other as u32,
                ellipses: ellipses as u32,
            },
            work,
        }
    }

    /// Leaves all contacts in the working memory.
    #[inline(always)]
    pub fn meet(&mut self) {
        let (mine, theirs) = (self.object.outline(), self.other.outline());
        self.rounds_on_object(mine, theirs);
        if !theirs.edges.is_empty() {
            self.rounds_on_other(mine, theirs);
        }
        if !mine.ellipses.is_empty() || !theirs.ellipses.is_empty() {
            self.ellipses();
        }
        if !mine.edges.is_empty() && !theirs.edges.is_empty() {
            self.polygons();
        }
        self.work.found.settle_hidden(HIDDEN);
    }

    /// The other's corners and discs against the object's edges, corners and discs, in the object's
    /// frame.
    #[inline(always)]
    fn rounds_on_object(&mut self, mine: &Outline, theirs: &Outline) {
        for (i, round) in theirs.rounds.iter().enumerate() {
            let centre = self.in_object.point(round.centre);
            let search = self.search(self.object, &centre, round.radius);
            if !search.within.any() {
                continue;
            }
            let at = Over {
                frame: self.in_object,
                round,
            };
            search.stands(
                #[inline(always)]
                |edge| at.faces(edge),
                &mut self.work.near,
            );
            for k in 0..self.work.near.len() {
                let Stand {
                    edge: index,
                    s,
                    height,
                    present,
                    ..
                } = self.work.near[k];
                let edge = &mine.edges[index];
                let normal = self.object_frame.turn_fixed(negate(edge.normal()));
                let foot = [
                    s * edge.along[0] + edge.start[0],
                    s * edge.along[1] + edge.start[1],
                ];
                let gap = height - round.radius;
                let contact = Contact {
                    place: (i * mine.edges.len() + index) as u32,
                    present,
                    normal,
                    arm: self.object_frame.turn(&foot),
                    gap,
                };
                self.push(contact, round.covered, || at.touch(edge), self.other);
            }
            for cluster in &mine.clusters {
                if !search.meets(cluster) {
                    continue;
                }
                for j in cluster.among(mine.rounds.len()) {
                    let place = self.places.round_on_round + (i * mine.rounds.len() + j) as u32;
                    self.round_on_round(place, &mine.rounds[j], round, &centre);
                }
            }
        }
    }

    /// The object's corners and discs against the other's edges, in the other's frame.
    #[inline(always)]
    fn rounds_on_other(&mut self, mine: &Outline, theirs: &Outline) {
        let limit = self.reach + self.other.bounding_radius();
        for cluster in &mine.clusters {
            if cluster.is_near(&self.in_object.origin, limit).any() {
                for j in cluster.among(mine.rounds.len()) {
                    self.round_on_other(j, &mine.rounds[j], theirs);
                }
            }
        }
    }

    /// The object's corner or disc of number `j` against the other's edges.
    #[inline(always)]
    fn round_on_other(&mut self, j: usize, round: &Round, theirs: &Outline) {
        let centre = self.in_other.point(round.centre);
        let search = self.search(self.other, &centre, round.radius);
        if !search.within.any() {
            return;
        }
        let at = Over {
            frame: self.in_other,
            round,
        };
        search.stands(
            #[inline(always)]
            |edge| at.faces(edge),
            &mut self.work.near,
        );
        for k in 0..self.work.near.len() {
            let Stand {
                edge: index,
                height,
                present,
                ..
            } = self.work.near[k];
            let edge = &theirs.edges[index];
            let place = self.places.round_on_other + (j * theirs.edges.len() + index) as u32;
            let normal = self.other_frame.turn_fixed(edge.normal());
            let contact = Contact {
                place,
                present,
                normal,
                arm: self.object_frame.turn(&at.touch(edge)),
                gap: height - round.radius,
            };
            self.push(contact, round.covered, || at.touch(edge), self.object);
        }
    }

    /// The search for a disc about `centre`, in the frame of `shape`, where it comes near the
    /// shape's bounding disc.
    #[inline(always)]
    fn search<'s>(&self, shape: &'s Shape, centre: &'s Vec2s<W>, radius: f64) -> Search<'s, W> {
        let near = self.reach + (shape.bounding_radius() + radius);
        let within = self.near & near.gt(Lanes::ZERO) & dot(centre, centre).lt(near * near);
        Search {
            shape,
            centre,
            within,
            limit: self.reach + radius,
            slack: Lanes::splat(self.slack),
        }
    }

    /// Two corners or discs; `centre` is that of the other's one in the object's frame.
    #[inline(always)]
    fn round_on_round(&mut self, place: u32, own: &Round, round: &Round, centre: &Vec2s<W>) {
        let d = [-centre[0] + own.centre[0], -centre[1] + own.centre[1]];
        let limit = self.reach + (own.radius + round.radius);
        let mut present = self.near & limit.gt(Lanes::ZERO) & dot(&d, &d).lt(limit * limit);
        if !present.any() {
            return;
        }
        let back = self.in_object.turn_back(&d);
        present = present
            & own.cone.holds_each(&[-d[0], -d[1]], self.slack)
            & round.cone.holds_each(&back, self.slack);
        if present.any() {
            self.push_rounds(place, own, round, &d, present);
        }
    }

    /// `d` leads from the other's centre to the object's one. A corner's own edges answer for what
    /// is right at it.
    #[inline(always)]
    fn push_rounds(
        &mut self,
        place: u32,
        own: &Round,
        round: &Round,
        d: &Vec2s<W>,
        mut present: Mask<W>,
    ) {
        let distance = dot(d, d).sqrt();
        if !(own.cone.is_full() && round.cone.is_full()) {
            present = present & distance.gt(Lanes::splat(self.slack));
        }
        let apart = distance.gt(Lanes::ZERO);
        let inverse = Lanes::splat(1.0) / apart.select(distance, Lanes::splat(1.0));
        let normal = [
            apart.select(d[0] * inverse, Lanes::splat(1.0)),
            apart.zero_unless(d[1] * inverse),
        ];
        let back = self.in_object.turn_back(&normal);
        present = present
            & own.cone.holds_each(&[-normal[0], -normal[1]], ANGLE)
            & round.cone.holds_each(&back, ANGLE);
        let touch = [
            -normal[0] * own.radius + own.centre[0],
            -normal[1] * own.radius + own.centre[1],
        ];
        let theirs = [
            back[0] * round.radius + round.centre[0],
            back[1] * round.radius + round.centre[1],
        ];
        let mut hidden = Mask::splat(false);
        if own.covered {
            hidden = hidden | self.object.hides(&touch);
        }
        if round.covered {
            hidden = hidden | self.other.hides(&theirs);
        }
        let gap = distance - own.radius - round.radius;
        let contact = Contact {
            place,
            present,
            normal: self.object_frame.turn(&normal),
            arm: self.object_frame.turn(&touch),
            gap,
        };
        self.work.found.push_unless(hidden, contact);
    }

    /// Adds a contact; where `covered`, a sibling part in `shape` may hide its point.
    #[inline(always)]
    fn push(
        &mut self,
        contact: Contact<W>,
        covered: bool,
        touch: impl Fn() -> Vec2s<W>,
        shape: &Shape,
    ) {
        if covered {
            self.work.found.push_unless(shape.hides(&touch()), contact);
        } else {
            self.work.found.push(contact);
        }
    }

    /// Every pair with an ellipse, lane by lane.
    #[inline(never)]
    fn ellipses(&mut self) {
        for lane in self.near.lanes() {
            self.work.ellipses.clear();
            EllipsePair {
                object: self.object,
                other: self.other,
                object_frame: self.object_frame.lane(lane),
                other_frame: self.other_frame.lane(lane),
                in_object: self.in_object.lane(lane),
                in_other: self.in_other.lane(lane),
                reach: self.reach.0[lane],
                slack: self.slack,
            }
            .meet(&mut self.work.ellipses);
            for (k, &(gap, hidden)) in self.work.ellipses.iter().enumerate() {
                let contact = Contact::in_lane(self.places.ellipses + k as u32, lane, &gap);
                self.work.found.push_unless(Mask::splat(hidden), contact);
            }
        }
    }

    /// Polygons that overlap although no feature answered for it; of two convex ones, the least
    /// penetration bounds all gaps.
    #[inline(always)]
    fn polygons(&mut self) {
        let (mine, theirs) = (self.object.solids(), self.other.solids());
        let frames = [&self.in_object, &self.in_other];
        let convex = if let ([a], [b]) = (mine, theirs) {
            Some([a, b])
        } else {
            None
        };
        let asked = if convex.is_some() {
            self.near
        } else {
            self.near & !self.work.found.deeper_than(0.0)
        };
        let depth = -SHALLOW
            * self
                .object
                .bounding_radius()
                .min(self.other.bounding_radius());
        let shallow = asked & !self.work.found.deeper_than(depth);
        let mut suspects = asked & !separated(mine, theirs, frames, shallow, depth);
        if let Some(pair) = convex
            && suspects.any()
        {
            let least = least_gap(pair, frames);
            suspects = suspects
                & least.lt(self.reach.min(Lanes::ZERO))
                & !self.work.found.bound(suspects, least, self.slack);
        }
        if suspects.any() {
            self.least_penetrations(suspects);
        }
    }

    #[inline(never)]
    fn least_penetrations(&mut self, suspects: Mask<W>) {
        for lane in suspects.lanes() {
            let in_object = self.in_object.lane(lane);
            let Some(least) =
                least_penetration(self.object.solids(), self.other.solids(), &in_object)
            else {
                continue;
            };
            let here = Mask::from_fn(|i| i == lane);
            let answered = self
                .work
                .found
                .bound(here, Lanes::splat(least.gap), self.slack)
                .lane(lane);
            if least.gap < self.reach.0[lane] && !answered {
                let frame = self.object_frame.lane(lane);
                let gap = Gap {
                    normal: frame.turn(least.normal),
                    arm: frame.turn(least.touch),
                    gap: least.gap,
                };
                self.work
                    .found
                    .push(Contact::in_lane(LEAST_PENETRATION, lane, &gap));
            }
        }
    }
}

/// A corner or disc above a shape's edges.
struct Over<'a, const W: usize> {
    /// The frame of its own body, seen from the shape's.
    frame: Frames<W>,
    round: &'a Round,
}

impl<const W: usize> Over<'_, W> {
    /// Where the round vertex faces an edge.
    #[inline(always)]
    fn faces(&self, edge: &Edge) -> Mask<W> {
        if self.round.cone.is_full() {
            return Mask::splat(true);
        }
        self.round
            .cone
            .faces_each(&self.frame.turn_back_fixed(negate(edge.normal())))
    }

    /// Its point nearest to the line of an edge, in its own body's frame.
    #[inline(always)]
    fn touch(&self, edge: &Edge) -> Vec2s<W> {
        if self.round.radius == 0.0 {
            return splat(self.round.centre);
        }
        let [x, y] = self
            .frame
            .turn_back_fixed(scale(-self.round.radius, edge.normal()));
        [x + self.round.centre[0], y + self.round.centre[1]]
    }
}

impl crate::geometry::feature::Cone {
    /// [`holds`](Self::holds), lane by lane.
    #[inline(always)]
    fn holds_each<const W: usize>(&self, direction: &Vec2s<W>, slack: f64) -> Mask<W> {
        let [before, after]: [Vec2; 2] = self.along;
        !dot_fixed(direction, before).lt(Lanes::splat(-slack))
            & !dot_fixed(direction, after).gt(Lanes::splat(slack))
    }

    /// Where a unit vector lies in the widened cone.
    #[inline(always)]
    fn faces_each<const W: usize>(&self, normal: &Vec2s<W>) -> Mask<W> {
        !dot_fixed(normal, self.middle).lt(Lanes::splat(self.cos_tilted))
    }
}
