//! One run with the particles of it that are drawn: [`ReportedRun`].

use stickslip::dynamics::Pose;
use stickslip_evaluation::ScoredRun;

use crate::colour::Colour;

/// One run with the particles of it that are drawn.
#[derive(Clone, Debug)]
pub struct ReportedRun {
    /// The run.
    pub scored: ScoredRun,
    /// Particles to draw, row by row; none for variants without.
    pub cloud: Vec<Vec<Pose>>,
}

impl ReportedRun {
    /// Name in tables and figures.
    #[must_use]
    pub fn title(&self) -> &'static str {
        self.scored.variant.title()
    }

    /// Colour in every figure.
    #[must_use]
    pub fn colour(&self) -> Colour {
        Colour::of(self.scored.variant)
    }

    /// Weighted RMSE while the camera was off, over all rows where it never was (mm).
    #[must_use]
    pub fn wmse_mm(&self) -> Option<f64> {
        let scores = &self.scored.scores;
        scores.wmse_occluded_mm.or(scores.wmse_mm)
    }

    pub(crate) fn camera_on(&self) -> bool {
        self.scored.variant.camera_on()
    }
}
