//! Planar shapes: unions of discs, convex polygons and ellipses, checked once at [`Shape::new`].

use crate::outline::{Features, features};

/// Two boundary points nearer than this share of the shape's extent are one point; files are rounded to 1 µm.
const TOLERANCE: f64 = 2e-5;

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
    features: Features,
    bounding_radius: f64,
    tolerance: f64,
}

/// Why parts do not make a shape. Parts and vertices are counted from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// No part.
    #[error("the shape has no parts; give at least one polygon, disc or ellipse")]
    Empty,
    /// A number is NaN or infinite.
    #[error("part {part} has a number that is not finite; give metres and radians as plain numbers")]
    NotFinite {
        /// The part.
        part: usize,
    },
    /// A radius or semi-axis is not positive.
    #[error("part {part} has a radius or semi-axis of {value} m; it must be positive")]
    Size {
        /// The part.
        part: usize,
        /// The value found.
        value: f64,
    },
    /// Fewer than three vertices.
    #[error("part {part} is a polygon of {vertices} vertices; it needs at least 3")]
    TooFewVertices {
        /// The part.
        part: usize,
        /// Vertices found.
        vertices: usize,
    },
    /// Two neighbouring vertices coincide.
    #[error("part {part}: vertex {vertex} repeats the one before it; leave it out (a polygon closes by itself)")]
    RepeatedVertex {
        /// The part.
        part: usize,
        /// The vertex.
        vertex: usize,
    },
    /// Clockwise.
    #[error("part {part} is a polygon in clockwise order; list its vertices counter-clockwise")]
    Clockwise {
        /// The part.
        part: usize,
    },
    /// Not convex.
    #[error("part {part} is not convex at vertex {vertex}; cut a concave outline into convex parts that share edges")]
    NotConvex {
        /// The part.
        part: usize,
        /// The vertex.
        vertex: usize,
    },
}

impl Shape {
    /// A shape from its parts.
    ///
    /// # Errors
    /// [`ShapeError`], which names the part (counted from 1), the rule and what to do.
    ///
    /// ```
    /// # use stickslip_dynamics::{Part, Shape};
    /// let clockwise = Part::Polygon { vertices: vec![[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]] };
    /// assert!(Shape::new(vec![clockwise]).unwrap_err().to_string().contains("counter-clockwise"));
    /// ```
    pub fn new(parts: Vec<Part>) -> Result<Self, ShapeError> {
        if parts.is_empty() {
            return Err(ShapeError::Empty);
        }
        for (index, part) in parts.iter().enumerate() {
            check(part, index + 1)?;
        }
        let bounding_radius = parts.iter().map(Part::reach).fold(0.0, f64::max);
        let tolerance = TOLERANCE * bounding_radius;
        Ok(Self { features: features(&parts, tolerance), parts, bounding_radius, tolerance })
    }

    /// The parts it was made of.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Radius of the smallest disc about the frame's origin that holds the shape (m).
    pub fn bounding_radius(&self) -> f64 {
        self.bounding_radius
    }

    /// The boundary features of the union.
    pub(crate) fn features(&self) -> &Features {
        &self.features
    }

    /// Whether a boundary point of one part lies inside another one, and so not on the union's boundary.
    pub(crate) fn hides(&self, point: [f64; 2]) -> bool {
        self.parts.len() > 1 && self.parts.iter().any(|part| part.depth(point) > self.tolerance)
    }

    /// Whether the union holds a point.
    pub(crate) fn contains(&self, point: [f64; 2]) -> bool {
        self.parts.iter().any(|part| part.depth(point) > -self.tolerance)
    }
}

impl Part {
    /// Largest distance of its points from the frame's origin.
    fn reach(&self) -> f64 {
        match self {
            Part::Polygon { vertices } => vertices.iter().map(|v| v[0].hypot(v[1])).fold(0.0, f64::max),
            Part::Disc { radius, centre } => radius + centre[0].hypot(centre[1]),
            Part::Ellipse { semi_axes, centre, .. } => semi_axes[0].max(semi_axes[1]) + centre[0].hypot(centre[1]),
        }
    }

    /// How deep a point lies inside (m, about; exact in sign): negative outside.
    fn depth(&self, point: [f64; 2]) -> f64 {
        match self {
            Part::Polygon { vertices } => edges(vertices).map(|(a, b)| left_of(a, b, point)).fold(f64::INFINITY, f64::min),
            Part::Disc { radius, centre } => radius - (point[0] - centre[0]).hypot(point[1] - centre[1]),
            Part::Ellipse { semi_axes, centre, angle } => {
                let (sin, cos) = libm::sincos(*angle);
                let d = [point[0] - centre[0], point[1] - centre[1]];
                let [x, y] = [(cos * d[0] + sin * d[1]) / semi_axes[0], (cos * d[1] - sin * d[0]) / semi_axes[1]];
                (1.0 - x.hypot(y)) * semi_axes[0].min(semi_axes[1])
            }
        }
    }
}

/// The directed edges of a polygon.
pub(crate) fn edges(vertices: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    vertices.iter().zip(vertices.iter().cycle().skip(1)).map(|(a, b)| (*a, *b))
}

/// Distance of `point` to the left of the line from a to b.
fn left_of(a: [f64; 2], b: [f64; 2], point: [f64; 2]) -> f64 {
    let t = [b[0] - a[0], b[1] - a[1]];
    (t[0] * (point[1] - a[1]) - t[1] * (point[0] - a[0])) / t[0].hypot(t[1])
}

fn check(part: &Part, index: usize) -> Result<(), ShapeError> {
    match part {
        Part::Polygon { vertices } => check_polygon(vertices, index),
        Part::Disc { radius, centre } => check_sizes(&[*radius], &[centre[0], centre[1]], index),
        Part::Ellipse { semi_axes, centre, angle } => check_sizes(semi_axes, &[centre[0], centre[1], *angle], index),
    }
}

fn check_sizes(sizes: &[f64], others: &[f64], part: usize) -> Result<(), ShapeError> {
    if sizes.iter().chain(others).any(|x| !x.is_finite()) {
        return Err(ShapeError::NotFinite { part });
    }
    sizes.iter().find(|size| **size <= 0.0).map_or(Ok(()), |&value| Err(ShapeError::Size { part, value }))
}

fn check_polygon(vertices: &[[f64; 2]], part: usize) -> Result<(), ShapeError> {
    if vertices.as_flattened().iter().any(|x| !x.is_finite()) {
        return Err(ShapeError::NotFinite { part });
    }
    if vertices.len() < 3 {
        return Err(ShapeError::TooFewVertices { part, vertices: vertices.len() });
    }
    if let Some(vertex) = edges(vertices).position(|(a, b)| a == b) {
        return Err(ShapeError::RepeatedVertex { part, vertex: (vertex + 1) % vertices.len() + 1 });
    }
    let area: f64 = edges(vertices).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
    if area <= 0.0 {
        return Err(ShapeError::Clockwise { part });
    }
    // convex: no vertex lies to the right of any edge (rounding to a micrometre is forgiven)
    let extent = vertices.iter().map(|v| v[0].hypot(v[1])).fold(0.0, f64::max);
    let dents = |(a, b)| vertices.iter().position(|v| left_of(a, b, *v) < -TOLERANCE * extent);
    edges(vertices).find_map(dents).map_or(Ok(()), |vertex| Err(ShapeError::NotConvex { part, vertex: vertex + 1 }))
}
