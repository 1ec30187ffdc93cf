//! Over which edges of a shape a point stands: [`stands`].

use crate::Shape;
use crate::feature::Edge;
use crate::frames::{Vec2s, lane_of};
use crate::lanes::{Lanes, Mask};

/// A point that stands over an edge, in the lanes where it does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stand<const W: usize> {
    /// Number of the edge in the outline.
    pub edge: usize,
    /// Distance of its foot along the edge (m).
    pub s: Lanes<W>,
    /// Height above the edge's line (m).
    pub height: Lanes<W>,
    /// The lanes where it does.
    pub present: Mask<W>,
}

/// Finds the edges of `shape` over which `centre` stands, less than `limit` high, among those that the round vertex faces.
///
/// From outside these are all that see it on their outward side; from inside, the edge of least penetration and those that meet it
/// in a reflex corner as well.
#[inline(always)]
pub(crate) fn stands<const W: usize>(
    shape: &Shape,
    centre: &Vec2s<W>,
    within: Mask<W>,
    [limit, slack]: [Lanes<W>; 2],
    faces: impl Fn(&Edge) -> Mask<W>,
    near: &mut Vec<Stand<W>>,
) {
    near.clear();
    let mut highest = Lanes::splat(f64::NEG_INFINITY);
    let mut behind = Mask::splat(false);
    for (index, edge) in shape.outline().edges.iter().enumerate() {
        let (s, height) = edge.coordinates_each(centre);
        highest = highest.max(height);
        let mut present = within & height.lt(limit) & edge.holds_each(s, slack);
        if !present.any() {
            continue;
        }
        present = present & faces(edge);
        if present.any() {
            near.push(Stand { edge: index, s, height, present });
            behind = behind | present & height.lt(Lanes::ZERO);
        }
    }
    if behind.any() {
        leave_ways_out(shape, centre, behind, !highest.gt(slack), near);
    }
}

/// Of the edges behind which the point lies, keeps the way out: where it is inside, the edge of least penetration and those in a
/// reflex corner with it.
#[inline(always)]
fn leave_ways_out<const W: usize>(shape: &Shape, centre: &Vec2s<W>, behind: Mask<W>, below_all: Mask<W>, near: &mut [Stand<W>]) {
    let edges = &shape.outline().edges;
    let mut depth = Lanes::splat(f64::NEG_INFINITY);
    let mut way = Lanes::splat(-1.0);
    let mut beside = Mask::splat(false);
    for stand in near.iter() {
        let back = stand.present & stand.height.lt(Lanes::ZERO);
        let better = back & stand.height.gt(depth);
        depth = better.select(stand.height, depth);
        way = better.select(Lanes::splat(stand.edge as f64), way);
        let length = Lanes::splat(edges[stand.edge].length);
        let flush = !stand.height.lt(Lanes::ZERO) & stand.height.lt(Lanes::splat(shape.tolerance()));
        beside = beside | stand.present & flush & !stand.s.lt(Lanes::ZERO) & !stand.s.gt(length);
    }
    // a corner flush with one face may lie behind the next; what rests on a face that it faces is outside
    let asked = behind & !beside;
    let inside = if shape.parts().len() == 1 {
        asked & below_all
    } else {
        Mask::from_fn(|lane| asked.lane(lane) && shape.contains(lane_of(centre, lane)))
    };
    for k in 0..near.len() {
        let mut out = is(way, near[k].edge);
        for other in near.iter().filter(|other| edges[other.edge].reflex.contains(&Some(near[k].edge as u32))) {
            out = out | is(way, other.edge);
        }
        let stand = &mut near[k];
        stand.present = stand.present & (!stand.height.lt(Lanes::ZERO) | inside & out);
    }
}

/// The lanes in which `way` is the edge of this number.
#[inline(always)]
fn is<const W: usize>(way: Lanes<W>, edge: usize) -> Mask<W> {
    !(way - edge as f64).abs().gt(Lanes::ZERO)
}

impl Edge {
    /// (distance along the edge from its start, height above its line), both in m.
    #[inline(always)]
    fn coordinates_each<const W: usize>(&self, point: &Vec2s<W>) -> (Lanes<W>, Lanes<W>) {
        let d = [point[0] - self.start[0], point[1] - self.start[1]];
        (d[0] * self.along[0] + d[1] * self.along[1], d[0] * self.along[1] - d[1] * self.along[0])
    }

    /// Where a foot at distance `s` belongs to the edge.
    #[inline(always)]
    fn holds_each<const W: usize>(&self, s: Lanes<W>, slack: Lanes<W>) -> Mask<W> {
        let [before, after] = self.buried;
        !s.lt(-slack - before) & !s.gt(slack + (self.length + after))
    }
}
