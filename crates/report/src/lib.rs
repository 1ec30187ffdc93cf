//! Figures, tables and the self-contained HTML report of pushing experiments. Nothing here computes
//! an estimate or opens a file.
//!
//! Figures are drawn as SVG straight from the numbers: they are small, keep their text, and take on
//! the colours of their page. With the feature `png`, `png_of` turns them into pixels.

mod animation;
mod axis;
mod belief_figures;
mod cloud_sample;
mod colour;
mod curves;
mod drawing;
mod experiment_figures;
mod font;
mod histogram;
mod intervals;
mod legend;
#[cfg(feature = "png")]
mod lettering;
mod live_page;
mod marks;
mod outline;
mod overlay;
mod page;
mod particle_cloud;
mod playback;
mod playback_data;
mod plot;
#[cfg(feature = "png")]
mod png;
mod reported_experiment;
mod reported_run;
mod scatter;
mod sentences;
mod strip;
mod table;
mod terms;
mod thinning;
mod time_figure;
mod touch;
mod view_page;

pub use axis::Scale;
pub use cloud_sample::CloudSample;
pub use colour::{Colour, Line};
pub use curves::{FRICTION_PARAMETERS, FrictionParameter, PoseError, friction_panels, pose_errors};
pub use drawing::Drawing;
pub use experiment_figures::Figure;
pub use histogram::{Histogram, Histograms};
pub use live_page::live_page;
pub use marks::Mark;
pub use outline::Outline;
pub use overlay::{Body, Overlay};
pub use page::{Block, Report, Section};
pub use particle_cloud::ParticleCloud;
pub use playback::{Playback, PlaybackRun, Touch};
#[cfg(feature = "png")]
pub use png::{PngError, png_of};
pub use reported_experiment::ReportedExperiment;
pub use reported_run::ReportedRun;
pub use scatter::{PointSet, ScatterPlot};
pub use sentences::{Fate, Outcome, Sentence, verdicts};
pub use strip::{StripGroup, StripLane, StripPlot};
pub use table::{Table, number};
pub use time_figure::{Bars, Curve, Level, Panel, TimeFigure};
pub use view_page::view_page;
