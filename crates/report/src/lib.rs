//! Figures, tables and the self-contained HTML report of pushing experiments. Nothing here computes an estimate or opens a file.

mod axis;
mod colour;
mod courses;
mod drawing;
mod font;
mod legend;
mod marks;
mod outline;
mod overlay;
mod plot;
mod png;
mod quantile;
mod time_figure;

pub use axis::Scale;
pub use colour::{Colour, Line};
pub use courses::{PoseError, friction_panels, pose_errors};
pub use drawing::Drawing;
pub use marks::Mark;
pub use outline::Outline;
pub use overlay::{Body, CameraImage, ImageError, Overlay};
pub use png::{PngError, png_of};
pub use quantile::quantile;
pub use time_figure::{Curve, Level, Panel, TimeFigure};
