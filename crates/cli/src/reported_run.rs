//! A run for a report: [`reported_run`].

use stickslip::RunError;
use stickslip_evaluation::{RunConditions, ScoredRun, Variant};
use stickslip_formats::Experiment;
use stickslip_report::{CloudSample, ReportedRun};

/// Particles that are drawn.
pub const DRAWN: usize = 60;

/// Runs a variant and keeps some of its particles to be drawn; none where its camera stays on,
/// since its cloud is a dot.
pub fn reported_run(
    variant: Variant,
    experiment: &Experiment,
    conditions: &RunConditions,
) -> Result<ReportedRun, RunError> {
    let drawn = if variant.camera_on() { 0 } else { DRAWN };
    let sample = CloudSample::new(drawn);
    let scored = ScoredRun::new(variant, experiment, conditions, Some(&sample))?;
    Ok(sample.into_run(scored))
}
