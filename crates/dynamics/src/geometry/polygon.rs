//! A convex polygon as an intersection of half planes: [`Polygon`].

use stickslip_lanes::Lanes;

use crate::geometry::edge::{Cover, Edge};
use crate::geometry::vec2::{Vec2, bounding_disc, dot, right, sub, unit};

#[derive(Clone, Debug)]
pub(crate) struct Polygon {
    pub vertices: Vec<Vec2>,
    /// Side k runs from vertex k to the next one.
    pub sides: Vec<Side>,
    /// Centre and radius of a disc that holds it (m).
    pub centre: Vec2,
    pub radius: f64,
}

/// A half plane n·p ≤ offset that bounds a polygon.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    /// Unit outward normal.
    pub normal: Vec2,
    /// n·p on the line (m).
    pub offset: f64,
    /// True if some of it is boundary of the union, and not a seam.
    pub exposed: bool,
    /// True if some of it is a seam: covered by another part.
    pub seam: bool,
}

impl Polygon {
    pub fn new(vertices: &[Vec2]) -> Self {
        let (centre, radius) = bounding_disc(vertices.iter().copied());
        let side = |[from, to]: [Vec2; 2]| {
            let normal = right(unit(sub(to, from)));
            Side {
                normal,
                offset: dot(normal, from),
                exposed: false,
                seam: false,
            }
        };
        Self {
            sides: segments(vertices).map(side).collect(),
            vertices: vertices.to_vec(),
            centre,
            radius,
        }
    }

    /// The two ends of every side.
    pub fn segments(&self) -> impl Iterator<Item = [Vec2; 2]> {
        segments(&self.vertices)
    }

    /// Depth of points inside (m; negative outside).
    #[inline(always)]
    pub fn depth<const W: usize>(&self, points: Vec2<Lanes<W>>) -> Lanes<W> {
        let mut depth = Lanes::splat(f64::INFINITY);
        for side in &self.sides {
            depth = depth.min(-dot(points, side.normal) + side.offset);
        }
        depth
    }

    /// The stretch of `edge` inside: clipped by the half planes, each moved outward by the
    /// tolerance; the exact ends lie where the edge crosses the lines themselves.
    pub fn cover(&self, edge: &Edge, tolerance: f64) -> Option<Cover> {
        let mut cover = Cover {
            tolerant: [0.0, edge.length],
            exact: [0.0, edge.length],
            flush: false,
        };
        for side in &self.sides {
            let height = dot(side.normal, edge.start) - side.offset;
            let slope = dot(side.normal, edge.along);

            // an edge parallel to the side lies outside as a whole, or is not cut by it
            if (slope * edge.length).abs() <= tolerance {
                let middle = height + 0.5 * slope * edge.length;
                if middle > tolerance {
                    return None;
                }
                cover.flush |= middle >= -tolerance && dot(side.normal, edge.normal()) > 0.0;
                continue;
            }

            // any other one leaves the half plane at its end or enters it at its start
            let (tolerant, exact) = ((tolerance - height) / slope, -height / slope);
            if slope > 0.0 && tolerant < cover.tolerant[1] {
                (cover.tolerant[1], cover.exact[1]) = (tolerant, exact);
            }
            if slope < 0.0 && tolerant > cover.tolerant[0] {
                (cover.tolerant[0], cover.exact[0]) = (tolerant, exact);
            }
        }
        Some(cover)
    }
}

fn segments(vertices: &[Vec2]) -> impl Iterator<Item = [Vec2; 2]> {
    let next = vertices.iter().cycle().skip(1);
    vertices.iter().zip(next).map(|(from, to)| [*from, *to])
}
