//! Pushes that a page about a fit plays back: [`players`].

use stickslip::dynamics::Pose;
use stickslip::{FilterModel, Occlusion, RunError, Tracking};
use stickslip_evaluation::{RunConditions, Variant};
use stickslip_fit::{CrossValidation, HeldOut, Push};
use stickslip_formats::{Experiment, TruthFacts};
use stickslip_report::{Block, Colour, ReportedExperiment, Section};

use super::FitResult;
use super::tables::validations;
use crate::reported_run::reported_run;
use crate::since_start::since_start;

/// The push with the largest final position error.
pub fn worst(validation: &CrossValidation) -> Option<&HeldOut> {
    let error = |push: &&HeldOut| push.final_mm[1];
    let pushes = validation.pushes.iter();
    pushes.max_by(|a, b| error(a).total_cmp(&error(b)))
}

/// Of the pushes left out and of those of `--test`, the one with the largest error: measured,
/// simulated with the nominal scene, and predicted by the fit. Of a push whose name another one
/// has, it is not known which one that was.
pub fn players(result: &FitResult, pushes: [&[Push]; 2]) -> Result<Vec<Section>, RunError> {
    let mut sections = Vec::new();
    for (k, title, validation) in validations(result) {
        let Some(worst) = worst(validation) else {
            continue;
        };
        let named = pushes[k].iter().filter(|push| push.name == worst.push);
        if let [push] = named.collect::<Vec<_>>()[..] {
            sections.push(Section {
                title: format!("{}: largest error of {title}", push.name),
                blocks: vec![
                    player(push, &result.posterior.worst[k])?,
                    Block::Note("Predictions know the first pose and the pusher's way.".to_owned()),
                ],
            });
        }
    }
    Ok(sections)
}

/// A push with its nominal simulation and the `poses` that a fit predicts, row by row.
fn player(push: &Push, poses: &[Option<[f64; 3]>]) -> Result<Block, RunError> {
    let experiment = Experiment {
        setup: push.setup.clone(),
        log: push.log.clone(),
        truth: None,
        facts: TruthFacts::default(),
    };
    let conditions = RunConditions {
        model: FilterModel::default(),
        particles: 1,
        tracking: Tracking::Smoothed,
        occlusion: Occlusion::None,
        seed: 0,
    };
    let nominal = reported_run(Variant::Nominal, &experiment, &conditions)?;
    let mut fitted = nominal.clone();
    for (row, pose) in fitted.scored.estimate.rows.iter_mut().zip(poses) {
        row.pose = pose.map(|[x, y, theta]| Pose::new(x, y, theta));
    }
    let (shown, runs, _) = since_start(&experiment, vec![nominal, fitted]);
    let reported = ReportedExperiment::new(&push.name, "", &shown, Occlusion::None, runs);
    let mut playback = reported.playback();
    for (run, (name, colour)) in playback.runs.iter_mut().zip([
        ("nominal scene", Colour::GREY),
        ("median of the posterior", Colour::BLUE),
    ]) {
        (run.name, run.colour) = (name.to_owned(), colour);
    }
    playback.lowest_first.clear();
    playback.poster = push.log.len() - 1;
    Ok(Block::Playback(Box::new(playback)))
}
