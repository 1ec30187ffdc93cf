//! Neighbouring features of a polygon with many corners, culled together: [`Cluster`].

use std::ops::Range;

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::edge::Edge;
use crate::geometry::vec2::{Vec2, bounding_disc, dot, sub};

/// Features in a cluster.
const SIZE: usize = 8;

/// Outlines of fewer edges are not divided.
const FEWEST: usize = 2 * SIZE;

/// Share of its radius by which a cluster's disc is widened, so that rounding hides nothing.
const SLACK: f64 = 1e-9;

/// Edges that follow each other, with the corners at their ends, and a disc that holds them.
#[derive(Clone, Debug)]
pub(crate) struct Cluster {
    /// Numbers of the edges, and of the vertices, in the outline.
    members: Range<usize>,
    centre: Vec2,
    /// Radius (m).
    radius: f64,
}

impl Cluster {
    /// One cluster of so many features, wherever they are.
    pub fn of_all(features: usize) -> Self {
        Self {
            members: 0..features,
            centre: [0.0; 2],
            radius: f64::INFINITY,
        }
    }

    /// The clusters of a convex polygon's edges, in which corner k is the end of edge k; a single
    /// one where there are few.
    pub fn of_polygon(edges: &[Edge]) -> Vec<Self> {
        if edges.len() < FEWEST {
            return vec![Self::of_all(edges.len())];
        }
        let starts = (0..edges.len()).step_by(SIZE);
        starts
            .map(|start| Self::new(edges, start..edges.len().min(start + SIZE)))
            .collect()
    }

    fn new(edges: &[Edge], members: Range<usize>) -> Self {
        let ends = |edge: &Edge| [edge.start, edge.at(edge.length)];
        let (centre, radius) = bounding_disc(edges[members.clone()].iter().flat_map(ends));
        Self {
            members,
            centre,
            radius: radius * (1.0 + SLACK),
        }
    }

    /// Its members among `count` edges, or vertices.
    #[inline(always)]
    pub fn members(&self, count: usize) -> Range<usize> {
        self.members.start..self.members.end.min(count)
    }

    /// Lanes in which some of its features may be less than `limit` (m) from a point.
    #[inline(always)]
    pub fn is_within<const W: usize>(&self, limit: Lanes<W>, point: Vec2<Lanes<W>>) -> Mask<W> {
        let d = sub(point, self.centre);
        let limit = limit + self.radius;
        limit.gt(Lanes::ZERO) & !dot(d, d).gt(limit * limit)
    }
}
