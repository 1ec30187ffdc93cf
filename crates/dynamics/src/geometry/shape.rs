//! Planar shapes: unions of discs, convex polygons and ellipses, checked once at [`Shape::new`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::outline::Outline;
use crate::geometry::part::Solid;
use crate::geometry::shape_error::{ShapeError, check};
use crate::geometry::transform::Vec2s;
use crate::geometry::vec2::Vec2;

/// Two boundary points nearer than this share of the shape's extent are one point; files are
/// rounded to 1 µm.
pub(crate) const TOLERANCE: f64 = 2e-5;

/// A part's boundary point deeper than this share of the shape's size in another part is not on the
/// union's boundary.
const HIDDEN: f64 = 1e-9;

/// One convex part of a [`Shape`], in the body frame.
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

/// A union of convex parts, with the features of its boundary that can touch.
#[derive(Clone, Debug)]
pub struct Shape {
    parts: Vec<Part>,
    solids: Vec<Solid>,
    outline: Outline,
    bounding_radius: f64,
    tolerance: f64,
}

impl Shape {
    /// A shape from its parts.
    ///
    /// Parts may share edges, wholly or in part, and may overlap; only the boundary of their union
    /// touches anything.
    ///
    /// # Errors
    /// [`ShapeError`], which names the part and the vertex (counted from 1), the value found, the
    /// rule and what to do.
    ///
    /// ```
    /// # use stickslip_dynamics::{Part, Shape};
    /// let clockwise = Part::Polygon { vertices: vec![[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]] };
    /// assert!(Shape::new(vec![clockwise]).unwrap_err().to_string().contains("counter-clockwise"));
    /// ```
    pub fn new(parts: Vec<Part>) -> Result<Self, ShapeError> {
        check(&parts)?;
        let bounding_radius = parts.iter().map(Part::reach).fold(0.0, f64::max);
        let tolerance = TOLERANCE * extent(&parts);
        let mut solids: Vec<Solid> = parts.iter().map(Solid::new).collect();
        let outline = Outline::new(&parts, &mut solids, tolerance);
        solids
            .iter_mut()
            .for_each(|solid| solid.close_seams(tolerance));
        Ok(Self {
            parts,
            solids,
            outline,
            bounding_radius,
            tolerance,
        })
    }

    /// The parts it was made of.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Radius of the smallest disc about the frame's origin that holds the shape (m); of an ellipse
    /// off the origin, a bound.
    pub fn bounding_radius(&self) -> f64 {
        self.bounding_radius
    }

    /// The boundary of the union.
    #[inline(always)]
    pub(crate) fn outline(&self) -> &Outline {
        &self.outline
    }

    /// The parts as solids.
    pub(crate) fn solids(&self) -> &[Solid] {
        &self.solids
    }

    /// Lengths below this are rounding of the input (m).
    #[inline(always)]
    pub(crate) fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Where a boundary point of one part lies inside another one, and so not on the union's
    /// boundary.
    #[inline(always)]
    pub(crate) fn hides<const W: usize>(&self, points: &Vec2s<W>) -> Mask<W> {
        self.holds_deeper(points, HIDDEN * self.bounding_radius)
    }

    /// Where a point lies inside the union, seams included.
    #[inline(always)]
    pub(crate) fn contains<const W: usize>(&self, points: &Vec2s<W>) -> Mask<W> {
        self.holds_deeper(points, 0.0)
    }

    /// Where a point lies deeper than `depth` (m) in some part.
    #[inline(always)]
    fn holds_deeper<const W: usize>(&self, points: &Vec2s<W>, depth: f64) -> Mask<W> {
        let mut held = Mask::splat(false);
        for solid in &self.solids {
            held = held | solid.depths(points).gt(Lanes::splat(depth));
        }
        held
    }
}

impl Part {
    /// Largest distance of its points from the frame's origin (m).
    fn reach(&self) -> f64 {
        match self {
            Part::Polygon { vertices } => vertices
                .iter()
                .map(|v| v[0].hypot(v[1]))
                .fold(0.0, f64::max),
            Part::Disc { radius, centre } => radius + centre[0].hypot(centre[1]),
            Part::Ellipse {
                semi_axes, centre, ..
            } => semi_axes[0].max(semi_axes[1]) + centre[0].hypot(centre[1]),
        }
    }

    /// Corners of a box that holds it.
    fn bounds(&self) -> [Vec2; 2] {
        let about = |c: &Vec2, r: f64| [[c[0] - r, c[1] - r], [c[0] + r, c[1] + r]];
        match self {
            Part::Polygon { vertices } => {
                let fold = |f: fn(f64, f64) -> f64| {
                    vertices
                        .iter()
                        .skip(1)
                        .fold(vertices[0], |m, v| [f(m[0], v[0]), f(m[1], v[1])])
                };
                [fold(f64::min), fold(f64::max)]
            }
            Part::Disc { radius, centre } => about(centre, *radius),
            Part::Ellipse {
                semi_axes, centre, ..
            } => about(centre, semi_axes[0].max(semi_axes[1])),
        }
    }
}

/// The longer side of a box about all parts (m).
fn extent(parts: &[Part]) -> f64 {
    let boxes = || parts.iter().map(Part::bounds);
    let side = |k: usize| {
        boxes().map(|b| b[1][k]).fold(f64::MIN, f64::max)
            - boxes().map(|b| b[0][k]).fold(f64::MAX, f64::min)
    };
    side(0).max(side(1))
}
