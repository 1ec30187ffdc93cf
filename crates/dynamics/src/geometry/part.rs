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
}

/// Corners of the polygon that stands for an ellipse. More make contacts with straight edges slow:
/// some corners within 0.1 rad of an edge touch it.
const ELLIPSE_CORNERS: u32 = 128;

impl Part {
    /// The polygon of 128 corners that stands for an ellipse.
    ///
    /// `semi_axes` are the half lengths of its two axes (m), positive; `angle` (rad) is that of the
    /// first one. The polygon has the ellipse's centre and area. Its moment of inertia agrees to
    /// 1 part in 10⁷. Its boundary lies at most 0.02 % of the longer semi-axis outside the
    /// ellipse, and at most 0.01 % inside.
    ///
    /// ```
    /// # use stickslip_dynamics::{Part, Shape};
    /// let plate = Shape::new(vec![Part::ellipse([0.03, 0.02], [0.0, 0.01], 0.5)])?;
    /// # Ok::<(), stickslip_dynamics::ShapeError>(())
    /// ```
    pub fn ellipse(semi_axes: [f64; 2], centre: [f64; 2], angle: f64) -> Self {
        let turn = std::f64::consts::TAU / f64::from(ELLIPSE_CORNERS);
        // the corners of the unit circle's polygon lie so far out that its area is π
        let outset = (turn / libm::sin(turn)).sqrt();
        let (sin, cos) = libm::sincos(angle);
        let corner = |k: u32| {
            let (y, x) = libm::sincos(turn * f64::from(k));
            let [u, v] = [outset * semi_axes[0] * x, outset * semi_axes[1] * y];
            [centre[0] + cos * u - sin * v, centre[1] + sin * u + cos * v]
        };
        Self::Polygon {
            vertices: (0..ELLIPSE_CORNERS).map(corner).collect(),
        }
    }

    /// Largest distance of its points from the frame's origin (m).
    pub(crate) fn bounding_radius(&self) -> f64 {
        match self {
            Part::Polygon { vertices } => vertices
                .iter()
                .map(|v| v[0].hypot(v[1]))
                .fold(0.0, f64::max),
            Part::Disc { radius, centre } => radius + centre[0].hypot(centre[1]),
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
