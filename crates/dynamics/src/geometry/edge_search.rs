//! Over which edges of a shape a round vertex stands: [`Search`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::cluster::Cluster;
use crate::geometry::feature::Edge;
use crate::geometry::shape::Shape;
use crate::geometry::transform::{Vec2s, dot};

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

/// What a round vertex is looked for over: the edges of a shape.
pub(crate) struct Search<'a, const W: usize> {
    pub shape: &'a Shape,
    /// Centre of the round vertex in the shape's frame.
    pub centre: &'a Vec2s<W>,
    /// The lanes in which it comes near the shape.
    pub within: Mask<W>,
    /// Height below which it counts (m).
    pub limit: Lanes<W>,
    /// Width of the borders between features (m).
    pub slack: Lanes<W>,
}

impl<const W: usize> Search<'_, W> {
    /// Finds the edges over which the centre stands, less than the limit high, among those that the
    /// round vertex `faces`.
    ///
    /// From outside these are all that see it on their outward side; from inside, the edge of least
    /// penetration and those that meet it in a reflex corner as well.
    #[inline(always)]
    pub fn stands(&self, faces: impl Fn(&Edge) -> Mask<W>, near: &mut Vec<Stand<W>>) {
        let mut found = self.scan(false, &faces, near);
        if self.shape.outline().clusters.len() > 1 && self.maybe_inside(&found).any() {
            found = self.scan(true, &faces, near);
        }
        if found.behind.any() {
            leave_ways_out(
                self.shape,
                self.centre,
                found.behind,
                !found.highest.gt(self.slack),
                near,
            );
        }
    }

    /// Whether some feature of a cluster may be nearer than the limit.
    #[inline(always)]
    pub fn meets(&self, cluster: &Cluster) -> bool {
        self.shape.outline().clusters.len() == 1
            || (self.within & cluster.is_near(self.centre, self.limit.max(Lanes::ZERO))).any()
    }

    /// Where the centre lies below all edges looked at, and so perhaps inside: then it meets the
    /// edge of least penetration that it faces, wherever that is.
    #[inline(always)]
    fn maybe_inside(&self, found: &Scanned<W>) -> Mask<W> {
        let radius = self.shape.bounding_radius();
        self.within
            & dot(self.centre, self.centre).lt(Lanes::splat(radius * radius))
            & !found.highest.gt(self.slack)
    }

    #[inline(always)]
    fn scan(
        &self,
        everything: bool,
        faces: &impl Fn(&Edge) -> Mask<W>,
        near: &mut Vec<Stand<W>>,
    ) -> Scanned<W> {
        near.clear();
        let outline = self.shape.outline();
        let mut found = Scanned {
            highest: Lanes::splat(f64::NEG_INFINITY),
            behind: Mask::splat(false),
        };
        for cluster in &outline.clusters {
            if !everything && !self.meets(cluster) {
                continue;
            }
            let members = cluster.among(outline.edges.len());
            let start = members.start;
            for (k, edge) in outline.edges[members].iter().enumerate() {
                let (s, height) = edge.coordinates_each(self.centre);
                found.highest = found.highest.max(height);
                let mut present =
                    self.within & height.lt(self.limit) & edge.holds_each(s, self.slack);
                if !present.any() {
                    continue;
                }
                present = present & faces(edge);
                if present.any() {
                    near.push(Stand {
                        edge: start + k,
                        s,
                        height,
                        present,
                    });
                    found.behind = found.behind | present & height.lt(Lanes::ZERO);
                }
            }
        }
        found
    }
}

/// What a look at some edges tells.
struct Scanned<const W: usize> {
    /// Largest height over the line of one of them (m).
    highest: Lanes<W>,
    /// Where the centre stands behind one of those found.
    behind: Mask<W>,
}

/// Of the edges behind which the point lies, keeps the way out: where it is inside, the edge of
/// least penetration and those in a reflex corner with it.
#[inline(always)]
fn leave_ways_out<const W: usize>(
    shape: &Shape,
    centre: &Vec2s<W>,
    behind: Mask<W>,
    below_all: Mask<W>,
    near: &mut [Stand<W>],
) {
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
        let flush =
            !stand.height.lt(Lanes::ZERO) & stand.height.lt(Lanes::splat(shape.tolerance()));
        beside = beside | stand.present & flush & !stand.s.lt(Lanes::ZERO) & !stand.s.gt(length);
    }
    // a corner flush with one face may lie behind the next; what rests on a face that it faces is
    // outside
    let asked = behind & !beside;
    let inside = asked
        & if shape.parts().len() == 1 {
            below_all
        } else {
            shape.contains(centre)
        };
    for k in 0..near.len() {
        let mut out = is(way, near[k].edge);
        for other in near.iter().filter(|other| {
            edges[other.edge]
                .reflex
                .contains(&Some(near[k].edge as u32))
        }) {
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
        (
            d[0] * self.along[0] + d[1] * self.along[1],
            d[0] * self.along[1] - d[1] * self.along[0],
        )
    }

    /// Where a foot at distance `s` belongs to the edge.
    #[inline(always)]
    fn holds_each<const W: usize>(&self, s: Lanes<W>, slack: Lanes<W>) -> Mask<W> {
        let [before, after] = self.buried;
        !s.lt(-slack - before) & !s.gt(slack + (self.length + after))
    }
}
