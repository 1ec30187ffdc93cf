//! The convex parts that shapes are made of: [`Part`].

use crate::geometry::vec2::Vec2;

/// Two boundary points nearer than this share of the shape's extent are one point; files are
/// rounded to 1 µm.
pub(crate) const TOLERANCE: f64 = 2e-5;

/// One convex part of a [`Shape`](crate::Shape), in the body frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Part {
    /// Convex polygon, vertices counter-clockwise.
    Polygon {
        /// Vertices (m).
        vertices: Vec<[f64; 2]>,
    },
    /// Disc.
    Disc {
        /// Radius (m).
        radius: f64,
        /// Centre (m).
        centre: [f64; 2],
    },
    /// Ellipse.
    Ellipse {
        /// Half lengths of the two axes (m).
        semi_axes: [f64; 2],
        /// Centre (m).
        centre: [f64; 2],
        /// Angle of the first axis (rad).
        angle: f64,
    },
}

impl Part {
    /// Largest distance of its points from the frame's origin (m).
    pub(crate) fn bounding_radius(&self) -> f64 {
        match self {
            Part::Polygon { vertices } => vertices
                .iter()
                .map(|v| v[0].hypot(v[1]))
                .fold(0.0, f64::max),
            Part::Disc { radius, centre } => radius + centre[0].hypot(centre[1]),
            Part::Ellipse {
                semi_axes: [a, b],
                centre,
                ..
            } => a.max(*b) + centre[0].hypot(centre[1]),
        }
    }

    /// Lower left and upper right corner of a box that holds it.
    fn bounds(&self) -> [Vec2; 2] {
        let around = |c: &Vec2, r: f64| [[c[0] - r, c[1] - r], [c[0] + r, c[1] + r]];
        match self {
            Part::Polygon { vertices } => {
                let fold = |f: fn(f64, f64) -> f64| {
                    let rest = vertices.iter().skip(1);
                    rest.fold(vertices[0], |m, v| [f(m[0], v[0]), f(m[1], v[1])])
                };
                [fold(f64::min), fold(f64::max)]
            }
            Part::Disc { radius, centre } => around(centre, *radius),
            Part::Ellipse {
                semi_axes: [a, b],
                centre,
                ..
            } => around(centre, a.max(*b)),
        }
    }
}

/// The longer side of a box about all parts (m).
pub(crate) fn extent(parts: &[Part]) -> f64 {
    let boxes = || parts.iter().map(Part::bounds);
    let side = |k: usize| {
        boxes().map(|b| b[1][k]).fold(f64::MIN, f64::max)
            - boxes().map(|b| b[0][k]).fold(f64::MAX, f64::min)
    };
    side(0).max(side(1))
}
