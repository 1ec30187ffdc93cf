//! Planar shapes: unions of discs, convex polygons and ellipses.

/// One convex part of a [`Shape`], in the body frame [m].
#[derive(Clone, Debug, PartialEq)]
pub enum Part {
    /// Convex polygon, vertices counter-clockwise.
    Polygon {
        /// Vertices [m].
        vertices: Vec<[f64; 2]>,
    },
    /// Disc.
    Disc {
        /// Radius [m].
        radius: f64,
        /// Centre [m].
        centre: [f64; 2],
    },
    /// Ellipse.
    Ellipse {
        /// Half lengths of the two axes [m].
        semi_axes: [f64; 2],
        /// Centre [m].
        centre: [f64; 2],
        /// Angle of the first axis [rad].
        angle: f64,
    },
}

/// A union of convex parts.
#[derive(Clone, Debug)]
pub struct Shape {
    parts: Vec<Part>,
}
