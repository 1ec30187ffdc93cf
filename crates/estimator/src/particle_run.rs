//! The particle filter over a log, in the paper's mode: grasp acquisition as section III-D has it.

use stickslip_filter::{ParticleFilter, Resampling, Settings, StepReport};

use crate::cloud::Cloud;
use crate::contact_model::{ContactModel, Lookback, Observation, ParameterNoise, StepPlan};
use crate::run::Prepared;
use crate::summary::summary;
use crate::sums::Reference;
use crate::{Camera, Estimate, EstimateRow, RunError, RunOptions, Setup, TactileUse};

/// Tracks the object of `prepared`; also the number of collapses.
pub(crate) fn track(
    setup: &Setup,
    camera: Camera,
    prepared: &Prepared<'_>,
    options: &RunOptions,
    progress: &mut dyn FnMut(usize),
) -> Result<(Estimate, u32), RunError> {
    let history = prepared.rows_within(camera.latency);
    let model = ContactModel::new(setup, camera, prepared.start, history).watched(prepared.watch);
    let settings = Settings {
        particles: options.particles,
        seed: options.seed,
        resample_below: setup.filter.resample_below,
        resampling: Resampling::Systematic,
    };
    let mut filter = ParticleFilter::new(model, settings)?;
    let mut estimate = prepared.empty_estimate(setup);
    let mut collapses = 0;
    let mut reference = Reference::new(prepared.start, setup.scene.nominal);
    filter.recompute_sums(&StepPlan::none(reference));
    estimate.rows[prepared.first] = EstimateRow {
        visual: true,
        ..summary(&filter, &reference)
    };
    show(prepared, prepared.first, &filter);
    for row in prepared.first + 1..prepared.log.len() {
        reference = Reference::of(&estimate.rows[row - 1]).unwrap_or(reference);
        let plan = plan(prepared, row, history, reference);
        let observation = observation(prepared, &camera, options.tactile, row, history);
        let report = filter.step(&plan, Some(&observation).filter(|o| !o.is_empty()));
        collapses += u32::from(report.collapsed());
        estimate.rows[row] = reported(
            summary(&filter, &reference),
            &report,
            observation.pose.is_some(),
        );
        show(prepared, row, &filter);
        progress(row);
    }
    Ok((estimate, collapses))
}

/// Shows a watch the particles after `row`.
fn show(prepared: &Prepared<'_>, row: usize, filter: &ParticleFilter<ContactModel<'_>>) {
    if let Some(watch) = prepared.watch {
        watch.after(row, &Cloud::new(filter.particles(), filter.weights()));
    }
}

/// The step that leads to `row`.
fn plan(prepared: &Prepared<'_>, row: usize, history: usize, reference: Reference) -> StepPlan {
    let parameter_noise = if prepared.visible(row).is_some() {
        ParameterNoise::Drawn
    } else {
        ParameterNoise::Frozen
    };
    let (substeps, driven) = (
        prepared.schedule.step(row - 1).to_vec(),
        prepared.schedule.driven(row - 1),
    );
    StepPlan {
        substeps,
        driven,
        parameter_noise,
        slot: slot(row, history),
        reference,
    }
}

fn slot(row: usize, history: usize) -> usize {
    if history == 0 { 0 } else { row % history }
}

fn observation(
    prepared: &Prepared<'_>,
    camera: &Camera,
    tactile: TactileUse,
    row: usize,
    history: usize,
) -> Observation {
    let readings = match tactile {
        TactileUse::Used => prepared
            .log
            .tactile
            .iter()
            .map(|sensor| sensor[row])
            .collect(),
        TactileUse::Ignored => Vec::new(),
    };
    Observation {
        pose: prepared.visible(row),
        lookback: lookback(prepared, camera, row, history),
        tactile: readings,
    }
}

/// Between which stored poses the time lies that the camera shows at `row`; before the first row,
/// the first pose counts.
fn lookback(
    prepared: &Prepared<'_>,
    camera: &Camera,
    row: usize,
    history: usize,
) -> Option<Lookback> {
    if history == 0 {
        return None;
    }
    let time = &prepared.log.time;
    let shown = (time[row] - camera.latency).max(time[prepared.first]);
    let later = (prepared.first..=row)
        .find(|&k| time[k] >= shown)
        .unwrap_or(row);
    let earlier = later.saturating_sub(1).max(prepared.first);
    let span = time[later] - time[earlier];
    let fraction = if span > 0.0 {
        (shown - time[earlier]) / span
    } else {
        0.0
    };
    Some(Lookback {
        earlier: slot(earlier, history),
        later: slot(later, history),
        fraction,
    })
}

fn reported(row: EstimateRow, report: &StepReport, visual: bool) -> EstimateRow {
    EstimateRow {
        ess: Some(report.effective_sample_size),
        resampled: Some(report.resampled),
        visual,
        ..row
    }
}
