//! Planar shapes: unions of discs and convex polygons, checked once at [`Shape::new`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::convex_part::ConvexPart;
use crate::geometry::outline::Outline;
use crate::geometry::part::{Part, TOLERANCE, extent};
use crate::geometry::shape_error::{ShapeError, check};
use crate::geometry::vec2::Vec2;

/// A part's boundary point deeper than this share of the shape's size in another part is not on the
/// union's boundary.
const HIDDEN: f64 = 1e-9;

/// A union of convex parts, with the features of its boundary that can touch.
#[derive(Clone, Debug)]
pub struct Shape {
    parts: Vec<Part>,
    convex_parts: Vec<ConvexPart>,
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
        let tolerance = TOLERANCE * extent(&parts);
        let mut convex_parts: Vec<ConvexPart> = parts.iter().map(ConvexPart::new).collect();
        let outline = Outline::new(&parts, &mut convex_parts, tolerance);
        for part in &mut convex_parts {
            part.close_seams(tolerance);
        }
        let radii = parts.iter().map(Part::bounding_radius);
        Ok(Self {
            bounding_radius: radii.fold(0.0, f64::max),
            parts,
            convex_parts,
            outline,
            tolerance,
        })
    }

    /// The parts it was made of.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Radius of the smallest disc about the frame's origin that holds the shape (m).
    pub fn bounding_radius(&self) -> f64 {
        self.bounding_radius
    }

    /// The boundary of the union.
    #[inline(always)]
    pub(crate) fn outline(&self) -> &Outline {
        &self.outline
    }

    /// The parts, in the order of [`parts`](Self::parts), with their insides.
    pub(crate) fn convex_parts(&self) -> &[ConvexPart] {
        &self.convex_parts
    }

    /// Lengths below this are rounding of the input (m).
    #[inline(always)]
    pub(crate) fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Lanes in which a boundary point of one part lies inside another one, and so not on the
    /// union's boundary.
    #[inline(always)]
    pub(crate) fn hides<const W: usize>(&self, points: Vec2<Lanes<W>>) -> Mask<W> {
        self.contains_deeper(points, HIDDEN * self.bounding_radius)
    }

    /// Lanes in which a point lies inside the union, seams included.
    #[inline(always)]
    pub(crate) fn contains<const W: usize>(&self, points: Vec2<Lanes<W>>) -> Mask<W> {
        self.contains_deeper(points, 0.0)
    }

    /// Lanes in which a point lies deeper than `depth` (m) in some part.
    #[inline(always)]
    fn contains_deeper<const W: usize>(&self, points: Vec2<Lanes<W>>, depth: f64) -> Mask<W> {
        let mut inside = Mask::splat(false);
        for part in &self.convex_parts {
            inside = inside | part.depth(points).gt(Lanes::splat(depth));
        }
        inside
    }
}
