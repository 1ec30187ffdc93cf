//! Reason why parts do not make a shape: [`ShapeError`], and the checks.

use crate::geometry::part::{Part, TOLERANCE};
use crate::geometry::vec2::{Vec2, cross, dot, length, sub};

/// Reason why parts do not make a shape. Parts and vertices are counted from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// No part.
    #[error("the shape has no parts; give at least one polygon or disc")]
    Empty,
    /// A number is NaN or infinite.
    #[error(
        "part {part}: {what} is {value}; it must be a finite number. Give metres and radians as plain numbers"
    )]
    NotFinite {
        /// The part.
        part: usize,
        /// Name of the number.
        what: String,
        /// The value found.
        value: f64,
    },
    /// A radius is not positive.
    #[error(
        "part {part}: the radius is {radius} m; it must be positive. Give the half width of the part in metres"
    )]
    Size {
        /// The part.
        part: usize,
        /// The radius found (m).
        radius: f64,
    },
    /// Fewer than three vertices.
    #[error(
        "part {part} is a polygon of {vertices} vertices; it needs at least 3. Add the missing ones or use a disc"
    )]
    TooFewVertices {
        /// The part.
        part: usize,
        /// Vertices found.
        vertices: usize,
    },
    /// Two neighbouring vertices coincide.
    #[error(
        "part {part}: vertex {vertex} at ({x}, {y}) m repeats the one before it; an edge must have a length. Leave it out (a polygon closes by itself)"
    )]
    RepeatedVertex {
        /// The part.
        part: usize,
        /// The vertex.
        vertex: usize,
        /// x of the vertex (m).
        x: f64,
        /// y of the vertex (m).
        y: f64,
    },
    /// Clockwise.
    #[error(
        "part {part} is a polygon in clockwise order (signed area {area:e} m^2); list its vertices counter-clockwise, that is, reverse them"
    )]
    Clockwise {
        /// The part.
        part: usize,
        /// Signed area (m²).
        area: f64,
    },
    /// No area.
    #[error(
        "part {part} is a polygon without area ({area:e} m^2): its vertices lie on one line or its outline crosses itself. Check their order"
    )]
    Flat {
        /// The part.
        part: usize,
        /// Signed area (m²).
        area: f64,
    },
    /// Not convex.
    #[error(
        "part {part} is not convex at vertex {vertex}, ({x}, {y}) m, which lies {dent:e} m inside the line of its neighbours; \
         cut a concave outline into convex parts that share edges"
    )]
    NotConvex {
        /// The part.
        part: usize,
        /// The vertex.
        vertex: usize,
        /// x of the vertex (m).
        x: f64,
        /// y of the vertex (m).
        y: f64,
        /// Depth of the dent (m).
        dent: f64,
    },
    /// The outline winds more than once.
    #[error(
        "part {part} is a polygon whose outline crosses itself (it winds {turns} times); list its vertices in the order of its boundary"
    )]
    SelfIntersecting {
        /// The part.
        part: usize,
        /// Number of times that it winds about its inside.
        turns: i64,
    },
}

/// Checks every part.
pub(crate) fn check(parts: &[Part]) -> Result<(), ShapeError> {
    if parts.is_empty() {
        return Err(ShapeError::Empty);
    }
    parts
        .iter()
        .enumerate()
        .try_for_each(|(index, part)| match part {
            Part::Polygon { vertices } => check_polygon(vertices, index + 1),
            Part::Disc { radius, centre } => check_disc(*radius, *centre, index + 1),
        })
}

fn check_disc(radius: f64, [x, y]: Vec2, part: usize) -> Result<(), ShapeError> {
    let numbers = [
        ("the radius", radius),
        ("x of the centre", x),
        ("y of the centre", y),
    ];
    if let Some((what, value)) = numbers.into_iter().find(|(_, value)| !value.is_finite()) {
        let what = what.to_owned();
        return Err(ShapeError::NotFinite { part, what, value });
    }
    if radius <= 0.0 {
        return Err(ShapeError::Size { part, radius });
    }
    Ok(())
}

fn check_polygon(vertices: &[Vec2], part: usize) -> Result<(), ShapeError> {
    if let Some(k) = vertices.as_flattened().iter().position(|x| !x.is_finite()) {
        let what = format!("{} of vertex {}", ["x", "y"][k % 2], k / 2 + 1);
        let value = vertices[k / 2][k % 2];
        return Err(ShapeError::NotFinite { part, what, value });
    }
    let count = vertices.len();
    if count < 3 {
        return Err(ShapeError::TooFewVertices {
            part,
            vertices: count,
        });
    }
    let extent = vertices
        .iter()
        .map(|v| length(sub(*v, vertices[0])))
        .fold(0.0, f64::max);
    let before = |k: usize| vertices[(k + count - 1) % count];
    let repeats = |k: &usize| length(sub(vertices[*k], before(*k))) <= 1e-9 * extent;
    if let Some(k) = (0..count).rev().find(repeats) {
        let [x, y] = vertices[k];
        return Err(ShapeError::RepeatedVertex {
            part,
            vertex: k + 1,
            x,
            y,
        });
    }
    check_turns(vertices, extent, part)
}

/// Checks the area, then each vertex for dents, then the number of turns.
fn check_turns(vertices: &[Vec2], extent: f64, part: usize) -> Result<(), ShapeError> {
    let count = vertices.len();
    let arm = |k: usize| sub(vertices[k], vertices[0]);
    let area: f64 = (1..count - 1)
        .map(|k| 0.5 * cross(arm(k), arm(k + 1)))
        .sum();
    if area.abs() <= 1e-9 * extent * extent {
        return Err(ShapeError::Flat { part, area });
    }
    if area < 0.0 {
        return Err(ShapeError::Clockwise { part, area });
    }
    let mut angle = 0.0;
    for k in 0..count {
        let vertex = vertices[k];
        let t = sub(vertex, vertices[(k + count - 1) % count]);
        let u = sub(vertices[(k + 1) % count], vertex);
        let chord = [t[0] + u[0], t[1] + u[1]];
        // a dent of the size of rounding is forgiven; a spike, where the boundary turns back, is
        // not
        let dent = if length(chord) > 0.0 {
            -cross(t, u) / length(chord)
        } else {
            length(t)
        };
        let turns_back = dot(t, u) < 0.0 && cross(t, u).abs() <= 1e-9 * length(t) * length(u);
        if dent > TOLERANCE * extent || turns_back {
            return Err(ShapeError::NotConvex {
                part,
                vertex: k + 1,
                x: vertex[0],
                y: vertex[1],
                dent,
            });
        }
        angle += libm::atan2(cross(t, u), dot(t, u));
    }
    match (angle / std::f64::consts::TAU).round() as i64 {
        1 => Ok(()),
        turns => Err(ShapeError::SelfIntersecting { part, turns }),
    }
}
