//! Reason why a scene file was refused: [`SceneError`].

use stickslip_dynamics::ShapeError;

/// Reason why a scene file was refused, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}:{line}:{column}: {problem}")]
pub struct SceneError {
    /// Display name of the file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column, in characters, from 1.
    pub column: usize,
    /// The problem.
    pub problem: Box<SceneProblem>,
}

/// Problem of a scene file. `key` is the way to the value, as `object.shape[2].polygon`; items of
/// lists count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneProblem {
    /// The file is too large for a scene.
    #[error(
        "the file has {found} bytes; a scene has at most 1 MB. Give the path of the scene file, or simplify its outlines"
    )]
    TooLarge {
        /// Its size (bytes).
        found: usize,
    },
    /// The text is not TOML.
    #[error(
        "`{found}` is not TOML: {message}. Write `key = value` with one value a line, numbers without a unit, and tables as [name]"
    )]
    Syntax {
        /// The line as it stands.
        found: String,
        /// Message of the parser.
        message: String,
    },
    /// A key that the format does not have.
    #[error("`{key}` is not a known key; the nearest one is `{nearest}`. Correct or remove it")]
    UnknownKey {
        /// The key.
        key: String,
        /// The known key at this place with the fewest edits to it, or the same key where it
        /// belongs, as `object.mass`.
        nearest: String,
    },
    /// A key that the format no longer has.
    #[error("`{key}` is no longer a key: {instead}. Remove it")]
    RemovedKey {
        /// The key.
        key: String,
        /// Replacement of what it stood for.
        instead: &'static str,
    },
    /// A key that must be there.
    #[error("`{key}` is missing. Give {what}")]
    Missing {
        /// The key.
        key: String,
        /// Value to give.
        what: String,
    },
    /// A value of another type.
    #[error("{key} is {found}; it must be {expected}. Give {what}")]
    WrongType {
        /// The key.
        key: String,
        /// The value found.
        found: String,
        /// The type expected.
        expected: String,
        /// Value to give.
        what: String,
    },
    /// A number against its rule.
    #[error("{key} is {found}; it must be {rule}. Give {what}")]
    OutOfRange {
        /// The key.
        key: String,
        /// The value found, with its unit.
        found: String,
        /// The rule.
        rule: String,
        /// Value to give.
        what: String,
    },
    /// A part of a shape that is none or several of the three kinds.
    #[error(
        "{key} has {found} of the keys `polygon`, `disc` and `ellipse`; a part is exactly one of them. Give each part its own braces"
    )]
    PartKind {
        /// The part.
        key: String,
        /// Number of the three that it has.
        found: usize,
    },
    /// An outline that is too fine.
    #[error(
        "{key} has {found} {of}; at most {most} are read. Simplify the outline, or give discs as such"
    )]
    TooMany {
        /// The list.
        key: String,
        /// Its length.
        found: usize,
        /// Kind of its items.
        of: &'static str,
        /// The most that are read.
        most: usize,
    },
    /// A part or a whole shape that is no shape.
    #[error("{key}: {source}")]
    Shape {
        /// The part or the shape.
        key: String,
        /// The reason.
        source: ShapeError,
    },
    /// Feet and a tripod are both given.
    #[error(
        "`support.{key}` and `support.feet` are both given; known feet leave no tripod to estimate. Remove one of the two"
    )]
    FeetAndTripod {
        /// The tripod's key.
        key: &'static str,
    },
    /// More fingers than a hand may have.
    #[error(
        "this is [[finger]] number {}; a hand has the pusher and at most {most} other fingers. Remove it", most + 1
    )]
    TooManyFingers {
        /// Most of these tables.
        most: usize,
    },
    /// A missing value that cannot be worked out, since the object is no uniform plate.
    #[error(
        "`{key}` is missing, and the middle of the outline is at ({x:.4}, {y:.4}) m; it can be worked out only where that is the centre of mass, the origin of the object frame. Move the outline by ({dx:.4}, {dy:.4}), or give `{key}`", dx = -x, dy = -y
    )]
    OffCentre {
        /// The missing key.
        key: &'static str,
        /// The middle of the outline (m).
        x: f64,
        /// The middle of the outline (m).
        y: f64,
    },
    /// The feet stand on one line.
    #[error(
        "support.feet are on one line; three feet carry an object only as a triangle. Give their positions in the object frame in m"
    )]
    FeetOnLine,
    /// The centre of mass is not over the feet.
    #[error(
        "the centre of mass (the origin of the object frame) is outside the triangle of support.feet; foot {foot} would carry {load:.3} of the weight. Give the positions of the feet relative to the centre of mass in m"
    )]
    FeetTip {
        /// The foot with the most negative load, from 1.
        foot: usize,
        /// Its share of the weight.
        load: f64,
    },
}
