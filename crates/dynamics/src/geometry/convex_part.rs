//! A convex part that answers questions about its inside: [`ConvexPart`].

use stickslip_lanes::Lanes;

use crate::geometry::edge::{Cover, Edge};
use crate::geometry::ellipse::Ellipse;
use crate::geometry::part::Part;
use crate::geometry::polygon::Polygon;
use crate::geometry::vec2::{Vec2, splat};

/// A polygon or an ellipse; a disc is an ellipse with equal axes.
#[derive(Clone, Debug)]
pub(crate) enum ConvexPart {
    Polygon(Polygon),
    Ellipse(Ellipse),
}

impl ConvexPart {
    pub fn new(part: &Part) -> Self {
        match part {
            Part::Polygon { vertices } => Self::Polygon(Polygon::new(vertices)),
            Part::Disc { radius, centre } => {
                Self::Ellipse(Ellipse::new(*centre, [1.0, 0.0], [*radius; 2]))
            }
            Part::Ellipse {
                semi_axes,
                centre,
                angle,
            } => {
                let (sin, cos) = libm::sincos(*angle);
                Self::Ellipse(Ellipse::new(*centre, [cos, sin], *semi_axes))
            }
        }
    }

    pub fn polygon(&self) -> Option<&Polygon> {
        match self {
            Self::Polygon(polygon) => Some(polygon),
            Self::Ellipse(_) => None,
        }
    }

    /// Centre and radius of a disc that holds it (m).
    pub fn bounding_disc(&self) -> (Vec2, f64) {
        match self {
            Self::Polygon(polygon) => (polygon.centre, polygon.radius),
            Self::Ellipse(ellipse) => (ellipse.centre, ellipse.outer_radius()),
        }
    }

    /// Moves sides that are seams outward, so that no gap of rounding is left between parts.
    pub fn close_seams(&mut self, tolerance: f64) {
        if let Self::Polygon(polygon) = self {
            let seams = polygon.sides.iter_mut().filter(|side| side.seam);
            seams.for_each(|side| side.offset += 2.0 * tolerance);
        }
    }

    /// Depth of points inside (m; negative outside): exact for polygons and discs inside, in sign
    /// for ellipses.
    #[inline(always)]
    pub fn depth<const W: usize>(&self, points: Vec2<Lanes<W>>) -> Lanes<W> {
        match self {
            Self::Polygon(polygon) => polygon.depth(points),
            Self::Ellipse(ellipse) => ellipse.depth(points),
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
            Self::Ellipse(ellipse) => ellipse.cover(edge),
        };
        cover.filter(|Cover { tolerant, .. }| tolerant[1] - tolerant[0] > 4.0 * tolerance)
    }
}
