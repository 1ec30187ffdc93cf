//! Neighbouring features of a polygon with many corners, looked at together: [`Cluster`].

use std::ops::Range;

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::feature::Edge;
use crate::geometry::transform::{Vec2s, dot};
use crate::geometry::vec2::{Vec2, length, sub};

/// Features in a cluster.
const SIZE: usize = 8;

/// Outlines of fewer edges are looked at edge by edge.
const FEWEST: usize = 2 * SIZE;

/// Share of its radius by which a cluster's disc is widened, so that rounding hides nothing.
const SLACK: f64 = 1e-9;

/// Edges that follow each other, with the corners at their ends, and a disc that holds them.
#[derive(Clone, Debug)]
pub(crate) struct Cluster {
    /// Numbers of the edges, and of the round vertices, in the outline.
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
        let ends = || {
            edges[members.clone()]
                .iter()
                .flat_map(|edge| [edge.start, edge.at(edge.length)])
        };
        let count = 2.0 * members.len() as f64;
        let centre = ends().fold([0.0; 2], |sum, p| {
            [sum[0] + p[0] / count, sum[1] + p[1] / count]
        });
        let radius = ends().map(|p| length(sub(p, centre))).fold(0.0, f64::max) * (1.0 + SLACK);
        Self {
            members,
            centre,
            radius,
        }
    }

    /// Its members among `count` edges, or round vertices.
    #[inline(always)]
    pub fn among(&self, count: usize) -> Range<usize> {
        self.members.start..self.members.end.min(count)
    }

    /// Where some of its features may be less than `limit` (m) from a point.
    #[inline(always)]
    pub fn is_near<const W: usize>(&self, point: &Vec2s<W>, limit: Lanes<W>) -> Mask<W> {
        let d = [point[0] - self.centre[0], point[1] - self.centre[1]];
        let limit = limit + self.radius;
        limit.gt(Lanes::ZERO) & !dot(&d, &d).gt(limit * limit)
    }
}
