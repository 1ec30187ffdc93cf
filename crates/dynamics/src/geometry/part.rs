//! The inside of one convex part ([`Solid`]): depth of a point, and which stretch of a segment it
//! covers.

use stickslip_lanes::Lanes;

use crate::geometry::feature::Edge;
use crate::geometry::shape::Part;
use crate::geometry::transform::{Vec2s, dot as dot_each, dot_fixed, splat};
use crate::geometry::vec2::{Vec2, cross, dot, left, length, right, sub, unit};

/// A half plane n·p ≤ offset that bounds a polygon.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    /// Unit outward normal.
    pub normal: Vec2,
    /// n·p on the line (m).
    pub offset: f64,
    /// Whether some of it is boundary of the union, and not a seam.
    pub exposed: bool,
    /// Whether some of it is not.
    pub seam: bool,
}

/// One convex part, made ready for questions about its inside.
#[derive(Clone, Debug)]
pub(crate) enum Solid {
    Polygon(Polygon),
    /// `axis` is the unit vector of the first semi-axis; a disc is one with equal axes.
    Oval {
        centre: Vec2,
        axis: Vec2,
        semi_axes: [f64; 2],
    },
}

#[derive(Clone, Debug)]
pub(crate) struct Polygon {
    pub corners: Vec<Vec2>,
    /// Side k runs from corner k to the next one.
    pub sides: Vec<Side>,
    /// Centre and radius of a disc that holds it (m).
    pub centre: Vec2,
    pub radius: f64,
}

/// A stretch of a segment, distances from its start (m).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cover {
    /// Covered within the tolerance.
    pub near: [f64; 2],
    /// Covered to the very surface.
    pub exact: [f64; 2],
    /// Whether the segment lies on the solid's surface with its body on the same side.
    pub flush: bool,
}

impl Solid {
    pub fn new(part: &Part) -> Self {
        match part {
            Part::Polygon { vertices } => Solid::Polygon(Polygon::new(vertices)),
            Part::Disc { radius, centre } => Solid::Oval {
                centre: *centre,
                axis: [1.0, 0.0],
                semi_axes: [*radius; 2],
            },
            Part::Ellipse {
                semi_axes,
                centre,
                angle,
            } => {
                let (sin, cos) = libm::sincos(*angle);
                Solid::Oval {
                    centre: *centre,
                    axis: [cos, sin],
                    semi_axes: *semi_axes,
                }
            }
        }
    }

    /// Moves sides that are seams outward, so that no gap of rounding is left between parts.
    pub fn close_seams(&mut self, tolerance: f64) {
        if let Solid::Polygon(polygon) = self {
            polygon
                .sides
                .iter_mut()
                .filter(|side| side.seam)
                .for_each(|side| side.offset += 2.0 * tolerance);
        }
    }

    /// How deep points lie inside (m; negative outside): exact for polygons and discs inside, in
    /// sign for ellipses.
    #[inline(always)]
    pub fn depths<const W: usize>(&self, points: &Vec2s<W>) -> Lanes<W> {
        match self {
            Solid::Polygon(polygon) => polygon.depths(points),
            Solid::Oval {
                centre,
                axis,
                semi_axes: [a, b],
            } => {
                let d = [points[0] - centre[0], points[1] - centre[1]];
                let scaled = [dot_fixed(&d, *axis) / *a, dot_fixed(&d, left(*axis)) / *b];
                (-dot_each(&scaled, &scaled).sqrt() + 1.0) * if a < b { *a } else { *b }
            }
        }
    }

    /// The same of one point.
    pub fn depth(&self, point: Vec2) -> f64 {
        self.depths(&splat::<1>(point)).0[0]
    }

    /// The stretch of `edge` that the solid covers, if it is longer than what merely touches.
    pub fn cover(&self, edge: &Edge, tolerance: f64) -> Option<Cover> {
        let cover = match self {
            Solid::Polygon(polygon) => polygon.cover(edge, tolerance)?,
            Solid::Oval { .. } => self.oval_cover(edge)?,
        };
        (cover.near[1] - cover.near[0] > 4.0 * tolerance).then_some(cover)
    }

    /// Roots of |S (start + s along − centre)|² = 1, S the scaling that makes the oval a unit
    /// circle.
    fn oval_cover(&self, edge: &Edge) -> Option<Cover> {
        let Solid::Oval {
            centre,
            axis,
            semi_axes: [a, b],
        } = self
        else {
            return None;
        };
        let scaled = |v: Vec2| [dot(*axis, v) / a, cross(*axis, v) / b];
        let (d, t) = (scaled(sub(edge.start, *centre)), scaled(edge.along));
        let (half, tt) = (dot(d, t), dot(t, t));
        let discriminant = half * half - tt * (dot(d, d) - 1.0);
        let root = if discriminant > 0.0 {
            discriminant.sqrt()
        } else {
            return None;
        };
        let low = ((-half - root) / tt).max(0.0);
        let high = ((-half + root) / tt).min(edge.length);
        Some(Cover {
            near: [low, high],
            exact: [low, high],
            flush: false,
        })
    }
}

impl Polygon {
    fn new(vertices: &[Vec2]) -> Self {
        let side = |(a, b): (&Vec2, &Vec2)| {
            let normal = right(unit(sub(*b, *a)));
            Side {
                normal,
                offset: dot(normal, *a),
                exposed: false,
                seam: false,
            }
        };
        let next = vertices.iter().cycle().skip(1);
        let count = vertices.len() as f64;
        let centre = vertices.iter().fold([0.0; 2], |sum, v| {
            [sum[0] + v[0] / count, sum[1] + v[1] / count]
        });
        let radius = vertices
            .iter()
            .map(|v| length(sub(*v, centre)))
            .fold(0.0, f64::max);
        Self {
            corners: vertices.to_vec(),
            sides: vertices.iter().zip(next).map(side).collect(),
            centre,
            radius,
        }
    }

    #[inline(always)]
    fn depths<const W: usize>(&self, points: &Vec2s<W>) -> Lanes<W> {
        let mut depths = Lanes::splat(f64::INFINITY);
        for side in &self.sides {
            depths = depths.min(-dot_fixed(points, side.normal) + side.offset);
        }
        depths
    }

    /// Clips the edge by the half planes, each moved outward by the tolerance; the exact ends lie
    /// where it crosses the very lines.
    fn cover(&self, edge: &Edge, tolerance: f64) -> Option<Cover> {
        let mut cover = Cover {
            near: [0.0, edge.length],
            exact: [0.0, edge.length],
            flush: false,
        };
        for side in &self.sides {
            let (height, slope) = (
                dot(side.normal, edge.start) - side.offset,
                dot(side.normal, edge.along),
            );
            if (slope * edge.length).abs() <= tolerance {
                let middle = height + 0.5 * slope * edge.length;
                if middle > tolerance {
                    return None;
                }
                cover.flush |= middle >= -tolerance && dot(side.normal, edge.normal()) > 0.0;
                continue;
            }
            let (near, exact) = ((tolerance - height) / slope, -height / slope);
            if slope > 0.0 && near < cover.near[1] {
                (cover.near[1], cover.exact[1]) = (near, exact);
            }
            if slope < 0.0 && near > cover.near[0] {
                (cover.near[0], cover.exact[0]) = (near, exact);
            }
        }
        Some(cover)
    }
}
