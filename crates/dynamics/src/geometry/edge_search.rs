//! Over which edges of a shape a rounded vertex lies: [`EdgeSearch`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::cluster::Cluster;
use crate::geometry::edge::Edge;
use crate::geometry::shape::Shape;
use crate::geometry::vec2::{Vec2, dot};

/// The projection of a point onto an edge, in the lanes where it falls on the edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeProjection<const W: usize> {
    /// Number of the edge in the outline.
    pub edge: usize,
    /// Distance of the projection along the edge (m).
    pub s: Lanes<W>,
    /// Height of the point above the edge's line (m).
    pub height: Lanes<W>,
    /// The lanes that have it.
    pub present: Mask<W>,
}

/// A search for the edges of a shape that a rounded vertex may touch.
pub(crate) struct EdgeSearch<'a, const W: usize> {
    pub shape: &'a Shape,
    /// Centre of the vertex in the shape's frame.
    pub centre: Vec2<Lanes<W>>,
    /// The lanes in which the vertex comes near the shape.
    pub active: Mask<W>,
    /// Height below which an edge counts (m).
    pub limit: Lanes<W>,
    /// Width of the borders between features (m).
    pub slack: f64,
}

/// Result of a scan over some edges.
struct Scan<const W: usize> {
    /// Largest height over the line of one of them (m).
    highest: Lanes<W>,
    /// Lanes in which the centre lies behind one of the edges found.
    behind: Mask<W>,
}

impl<const W: usize> EdgeSearch<'_, W> {
    /// Lists the edges that the vertex `faces` and that the centre projects onto from less than the
    /// limit above.
    ///
    /// From outside these are all that have the centre in front; from inside, the edge of least
    /// penetration and those that meet it in a reflex corner as well.
    #[inline(always)]
    pub fn project_onto_edges(
        &self,
        faces: impl Fn(&Edge) -> Mask<W>,
        projections: &mut Vec<EdgeProjection<W>>,
    ) {
        let mut scan = self.scan(false, &faces, projections);
        if self.shape.outline().clusters.len() > 1 && self.may_be_inside(&scan).any() {
            scan = self.scan(true, &faces, projections);
        }
        if scan.behind.any() {
            self.keep_way_out(&scan, projections);
        }
    }

    /// Returns true if some feature of a cluster may be nearer than the limit.
    #[inline(always)]
    pub fn may_touch(&self, cluster: &Cluster) -> bool {
        self.shape.outline().clusters.len() == 1
            || (self.active & cluster.is_within(self.limit.max(Lanes::ZERO), self.centre)).any()
    }

    /// Lanes in which the centre lies below all edges scanned, and so perhaps inside. The edge of
    /// least penetration may then belong to any cluster.
    #[inline(always)]
    fn may_be_inside(&self, scan: &Scan<W>) -> Mask<W> {
        let radius = self.shape.bounding_radius();
        self.active
            & dot(self.centre, self.centre).lt(Lanes::splat(radius * radius))
            & !scan.highest.gt(Lanes::splat(self.slack))
    }

    /// Projects the centre onto the edges of the clusters that it may touch, or of all.
    #[inline(always)]
    fn scan(
        &self,
        all_clusters: bool,
        faces: &impl Fn(&Edge) -> Mask<W>,
        projections: &mut Vec<EdgeProjection<W>>,
    ) -> Scan<W> {
        projections.clear();
        let outline = self.shape.outline();
        let mut scan = Scan {
            highest: Lanes::splat(f64::NEG_INFINITY),
            behind: Mask::splat(false),
        };
        for cluster in &outline.clusters {
            if !all_clusters && !self.may_touch(cluster) {
                continue;
            }
            let members = cluster.members(outline.edges.len());
            let start = members.start;
            for (k, edge) in outline.edges[members].iter().enumerate() {
                let (s, height) = edge.coordinates(self.centre);
                scan.highest = scan.highest.max(height);
                let mut present =
                    self.active & height.lt(self.limit) & edge.spans_each(s, self.slack);
                if !present.any() {
                    continue;
                }
                present = present & faces(edge);
                if present.any() {
                    projections.push(EdgeProjection {
                        edge: start + k,
                        s,
                        height,
                        present,
                    });
                    scan.behind = scan.behind | present & height.lt(Lanes::ZERO);
                }
            }
        }
        scan
    }

    /// Drops the edges that have the centre behind them, except the way out where it is inside: the
    /// edge of least penetration and those in a reflex corner with it.
    #[inline(always)]
    fn keep_way_out(&self, scan: &Scan<W>, projections: &mut [EdgeProjection<W>]) {
        // of what is before a face, the face opposite is behind
        let inside = scan.behind & self.is_inside(scan);
        if !inside.any() {
            for at in projections {
                at.present = at.present & !at.height.lt(Lanes::ZERO);
            }
            return;
        }

        // the edge of least penetration, and whether the centre lies on another one
        let edges = &self.shape.outline().edges;
        let mut depth = Lanes::splat(f64::NEG_INFINITY);
        let mut way = Lanes::splat(-1.0);
        let mut beside = Mask::splat(false);
        for at in projections.iter() {
            let back = at.present & at.height.lt(Lanes::ZERO);
            let better = back & at.height.gt(depth);
            depth = better.select(at.height, depth);
            way = better.select(Lanes::splat(at.edge as f64), way);
            let length = Lanes::splat(edges[at.edge].length);
            let flush =
                !at.height.lt(Lanes::ZERO) & at.height.lt(Lanes::splat(self.shape.tolerance()));
            beside = beside | at.present & flush & !at.s.lt(Lanes::ZERO) & !at.s.gt(length);
        }

        // a corner flush with one face may lie behind the next; what rests on a face that it faces
        // is outside
        let inside = inside & !beside;
        for k in 0..projections.len() {
            let edge = projections[k].edge;
            let mut out = is(way, edge);
            for other in projections
                .iter()
                .filter(|other| edges[other.edge].reflex.contains(&Some(edge as u32)))
            {
                out = out | is(way, other.edge);
            }
            let at = &mut projections[k];
            at.present = at.present & (!at.height.lt(Lanes::ZERO) | inside & out);
        }
    }

    /// Lanes in which the centre is inside the shape, by the scanned edges or by the shape's parts.
    #[inline(always)]
    fn is_inside(&self, scan: &Scan<W>) -> Mask<W> {
        if self.shape.parts().len() == 1 {
            !scan.highest.gt(Lanes::splat(self.slack))
        } else {
            self.shape.contains(self.centre)
        }
    }
}

/// The lanes in which `way` is the edge of this number.
#[inline(always)]
fn is<const W: usize>(way: Lanes<W>, edge: usize) -> Mask<W> {
    !(way - edge as f64).abs().gt(Lanes::ZERO)
}
