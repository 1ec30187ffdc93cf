//! Reason why a drawing gives no outline: [`OutlineError`].

use crate::outline::Point;

/// Reason why a drawing gives no outline.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}{}: {problem}", .line.map_or(String::new(), |line| format!(":{line}")))]
pub struct OutlineError {
    /// Display name of the file.
    pub file: String,
    /// Line, from 1, where one is meant.
    pub line: Option<usize>,
    /// The problem.
    pub problem: OutlineProblem,
}

/// Problem of a drawing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OutlineProblem {
    /// Not the format.
    #[error("this is no {format} drawing: {why}. {next}")]
    Format {
        /// SVG or DXF.
        format: &'static str,
        /// The fault.
        why: String,
        /// Next step.
        next: &'static str,
    },
    /// Something that is drawn by reference.
    #[error("`{what}` cannot be read. {next}")]
    Unsupported {
        /// The element or entity.
        what: String,
        /// Next step.
        next: &'static str,
    },
    /// A number that is none.
    #[error("`{found}` is no {expected}. Save the drawing again")]
    Number {
        /// The text found.
        found: String,
        /// The expected text.
        expected: &'static str,
    },
    /// Lengths without a unit.
    #[error(
        "the drawing does not say in which unit it is. Give the metres of one unit with --scale, 0.001 for millimetres"
    )]
    NoUnit,
    /// Lines that do not close.
    #[error(
        "a line from ({}, {}) to ({}, {}) mm does not close, and no other one goes on there. Close the outline, and delete other lines",
        mm(.from[0]), mm(.from[1]), mm(.to[0]), mm(.to[1])
    )]
    Open {
        /// Its first point (m).
        from: Point,
        /// Its last one (m).
        to: Point,
    },
    /// Nothing that is closed.
    #[error("there is no closed line in it. Draw the outline as one closed line")]
    Nothing,
    /// Several outlines.
    #[error(
        "there are {count} outlines that do not lie in each other, of which one is the object's. Delete the others"
    )]
    Several {
        /// Their number.
        count: usize,
    },
    /// An outline that crosses itself.
    #[error("the outline crosses or touches itself near ({}, {}) mm. Draw it as a simple line", mm(.at[0]), mm(.at[1]))]
    Crossing {
        /// Place (m).
        at: Point,
    },
    /// Sizes that cannot be meant.
    #[error(
        "the outline is {} x {} mm large; an object on a table has 0.1 mm to 10 m. Give the metres of one unit with --scale",
        mm(.size[0]), mm(.size[1])
    )]
    Size {
        /// Width and height (m).
        size: Point,
    },
    /// More than an outline can be.
    #[error(
        "its curves are more than {most} points as lines. Save the outline alone, or draw curves with a larger --tolerance"
    )]
    Points {
        /// Largest number that is taken.
        most: usize,
    },
    /// Too fine.
    #[error(
        "the outline has {vertices} vertices{}; a scene takes {most}. Draw curves with a larger --tolerance",
        if *.parts > 0 { format!(" in {parts} convex parts") } else { String::new() }
    )]
    Fine {
        /// Its vertices.
        vertices: usize,
        /// Its convex parts; 0 where it was not cut.
        parts: usize,
        /// Limit, in words.
        most: &'static str,
    },
}

fn mm(metres: f64) -> f64 {
    (1e6 * metres).round() / 1e3
}
