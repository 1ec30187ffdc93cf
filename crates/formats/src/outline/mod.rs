//! Outlines from drawings: [`read_svg_outline`], [`read_dxf_outline`], both an [`Outline`].
//!
//! `svg` and `dxf` take drawings apart into `lines`, curves flattened by `flatten`; `contours`
//! joins lines that meet into closed ones, `drawn_outline` takes the outermost and moves it into
//! the object's frame, `decompose` cuts it into convex parts.

mod contours;
mod decompose;
mod drawn_outline;
mod dxf;
mod error;
mod flatten;
mod lines;
mod svg;

pub use drawn_outline::{DrawnUnit, Outline};
pub use dxf::read_dxf_outline;
pub use error::{OutlineError, OutlineProblem};
pub use svg::read_svg_outline;

/// Options for reading a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlineOptions {
    /// Metres that one unit of the drawing is; `None`: as the drawing says.
    pub scale: Option<f64>,
    /// Largest distance of the outline from a curve that it stands for (m).
    pub tolerance: f64,
}

impl Default for OutlineOptions {
    /// 0.02 mm, which is less than cameras see.
    fn default() -> Self {
        Self {
            scale: None,
            tolerance: 2e-5,
        }
    }
}

/// A point of the plane (m).
type Point = [f64; 2];
