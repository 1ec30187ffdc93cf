//! A convex part that answers questions about its inside: [`ConvexPart`].

use stickslip_lanes::Lanes;

use crate::geometry::edge::{Cover, Edge};
use crate::geometry::part::Part;
use crate::geometry::polygon::Polygon;
use crate::geometry::vec2::{Vec2, dot, splat, sub};

/// A polygon or a disc.
#[derive(Clone, Debug)]
pub(crate) enum ConvexPart {
    Polygon(Polygon),
    Disc { centre: Vec2, radius: f64 },
}

impl ConvexPart {
    pub fn new(part: &Part) -> Self {
        match part {
            Part::Polygon { vertices } => Self::Polygon(Polygon::new(vertices)),
            Part::Disc { radius, centre } => Self::Disc {
                centre: *centre,
                radius: *radius,
            },
        }
    }

    pub fn polygon(&self) -> Option<&Polygon> {
        match self {
            Self::Polygon(polygon) => Some(polygon),
            Self::Disc { .. } => None,
        }
    }

    /// Centre and radius of a disc that holds it (m).
    pub fn bounding_disc(&self) -> (Vec2, f64) {
        match self {
            Self::Polygon(polygon) => (polygon.centre, polygon.radius),
            Self::Disc { centre, radius } => (*centre, *radius),
        }
    }

    /// Moves sides that are seams outward, so that no gap of rounding is left between parts.
    pub fn close_seams(&mut self, tolerance: f64) {
        if let Self::Polygon(polygon) = self {
            let seams = polygon.sides.iter_mut().filter(|side| side.seam);
            seams.for_each(|side| side.offset += 2.0 * tolerance);
        }
    }

    /// Depth of points inside (m; negative outside).
    #[inline(always)]
    pub fn depth<const W: usize>(&self, points: Vec2<Lanes<W>>) -> Lanes<W> {
        match self {
            Self::Polygon(polygon) => polygon.depth(points),
            Self::Disc { centre, radius } => {
                let from_centre = sub(points, *centre);
                -dot(from_centre, from_centre).sqrt() + *radius
            }
        }
    }

    /// [`depth`](Self::depth) of one point.
    pub fn depth_at(&self, point: Vec2) -> f64 {
        self.depth(splat::<1>(point)).0[0]
    }

    /// The stretch of `edge` inside the part, if it is longer than that of an edge that merely
    /// touches.
    pub fn cover(&self, edge: &Edge, tolerance: f64) -> Option<Cover> {
        let cover = match self {
            Self::Polygon(polygon) => polygon.cover(edge, tolerance),
            Self::Disc { centre, radius } => cover_by_disc(*centre, *radius, edge),
        };
        cover.filter(|Cover { tolerant, .. }| tolerant[1] - tolerant[0] > 4.0 * tolerance)
    }
}

/// The chord of a disc along an edge.
fn cover_by_disc(centre: Vec2, radius: f64, edge: &Edge) -> Option<Cover> {
    let (middle, height) = edge.coordinates(centre);
    let square = radius * radius - height * height;
    let half = Some(square).filter(|square| *square > 0.0)?.sqrt();
    let chord = [(middle - half).max(0.0), (middle + half).min(edge.length)];
    Some(Cover {
        tolerant: chord,
        exact: chord,
        flush: false,
    })
}
