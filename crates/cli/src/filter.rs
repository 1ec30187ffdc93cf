//! `stickslip filter`: one method over one log, its scores and its estimates.

use std::collections::BTreeMap;
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result};
use clap::CommandFactory;
use serde::Serialize;
use stickslip::diagnosis::{Finding, assumed_stall_force, doubts};
use stickslip::dynamics::Pose;
use stickslip::{Estimate, Occlusion, Run, TactileUse, keep_threads_awake, run, run_observed};
use stickslip_evaluation::{LearnedParameter, ScoredRun, Variant};
use stickslip_formats::{
    Experiment, write_estimate, write_estimate_mcap, write_estimate_tum, write_modes,
};
use stickslip_report::{
    Block, CloudSample, Report, ReportedExperiment, ReportedRun, Table, number,
};

use crate::args::{FilterArgs, MethodName, Program};
use crate::experiment::{
    check_occlusion, check_sense, experiment_name, read_experiment, reference_name,
};
use crate::files::{Results, ready_file, ready_folder, refuse_inputs, write_report};
use crate::given::Given;
use crate::log_files::LogFiles;
use crate::origin::origin;
use crate::output::{show_result, talk};
use crate::progress::{Work, bar};
use crate::reported_run::DRAWN;
use crate::since_start::since_start;
use crate::verdict::Verdict;

/// Name of the file of estimates.
const ESTIMATE: &str = "estimate.csv";

/// Particle steps above which a person would wait.
const LONG: usize = 200_000;

/// Printed result of a run.
#[derive(Debug, Serialize)]
struct Summary<'a> {
    wmse_mm: Option<f64>,
    wmse_occluded_mm: Option<f64>,
    wmse_moving_mm: Option<f64>,
    final_error_mm: Option<f64>,
    final_error_deg: Option<f64>,
    frames: usize,
    unsolved: u64,
    /// Of those, the ones whose solver gave up; the others have no solution.
    failed: u64,
    collapses: u32,
    /// ln of the evidence of the log.
    log_evidence: Option<f64>,
    /// Reasons to doubt the scores.
    warnings: &'a [String],
    real_time_factor: f64,
    /// Stall force in N; `None` is a rigid drive.
    stall_force: Option<f64>,
    stall_force_assumed: bool,
    friction: BTreeMap<&'static str, LearnedParameter>,
}

/// Runs the command.
pub fn filter(args: &FilterArgs) -> Result<Verdict> {
    let given = args.given.resolve("filter")?;
    let (experiment, verdict) = read_experiment(
        &given.scene,
        &given.log,
        &args.topics.options(Program::command())?,
        args.truth.as_deref(),
    )?;
    check_occlusion(args.shared.occlusion(), &experiment.log)?;
    check_sense(&args.shared.force, &experiment)
        .with_context(|| given.log.display().to_string())?;
    check_places(args, &given)?;
    let sample = CloudSample::new(DRAWN);
    let (run, seconds) =
        timed_run(args, &experiment, &sample).with_context(|| given.log.display().to_string())?;
    let radius = args.virtual_radius;
    let radius = radius.unwrap_or(experiment.setup.virtual_radius());
    let hidden = args.shared.occlusion();
    let warnings: Vec<String> = doubts(&experiment.setup, &experiment.log, &run)
        .iter()
        .map(Finding::to_string)
        .collect();
    let scored = ScoredRun::of(args.variant(), run, &experiment, (hidden, radius));
    let run = sample.into_run(scored);
    let scored = &run.scored;
    let summary = Summary::new(&experiment, scored, seconds, &warnings);
    show_result(args.shared.json, &summary, || {
        tables((args, &given.log), &experiment, &scored.estimate, &summary)
    })?;
    let written = args
        .out
        .as_deref()
        .map(|folder| write_all(args, folder, &run, &experiment))
        .transpose()?
        .unwrap_or_default();
    let reported = args
        .report
        .as_deref()
        .map(|path| {
            let inputs = (args, &given);
            report(inputs, &experiment, run.clone(), &warnings, path)
        })
        .transpose()?;
    for path in written.into_iter().chain(reported) {
        talk(format_args!("wrote {}", path.display()));
    }
    Ok(verdict)
}

/// Refuses places for results that cannot be written, before the run.
fn check_places(args: &FilterArgs, given: &Given) -> Result<()> {
    let logs = LogFiles::find(&given.log)?.paths;
    let inputs = logs.iter().chain(&args.truth).map(PathBuf::as_path);
    let inputs: Vec<&Path> = inputs.chain([given.scene.as_path()]).collect();
    if let Some(folder) = &args.out {
        ready_folder(folder)?;
        refuse_inputs(&folder.join(ESTIMATE), &inputs)?;
    }
    args.report
        .iter()
        .try_for_each(|path| ready_file(path, &inputs))
}

/// The run and the wall time of its loop (s); `sample` is shown the particles where they are drawn.
fn timed_run(
    args: &FilterArgs,
    experiment: &Experiment,
    sample: &CloudSample,
) -> Result<(Run, f64)> {
    let options = args.run_options();
    let long =
        args.method == MethodName::Particle && experiment.log.len() * options.particles > LONG;
    let progress = bar(
        experiment.log.len(),
        "frames",
        if long { Work::Long } else { Work::Short },
    );
    let pool = args.shared.threads.filter_pool(options.particles)?;
    let start = Instant::now();
    let Experiment { setup, log, .. } = experiment;
    let mut advance = |row: usize| progress.set_position(row as u64);
    let drawn = args.report.is_some() || args.mcap;
    let mut track = || match drawn {
        true => run_observed(setup, log, &options, sample, &mut advance),
        false => run(setup, log, &options, &mut advance),
    };
    let result = pool.install(|| keep_threads_awake(&mut track));
    let seconds = start.elapsed().as_secs_f64();
    progress.finish_and_clear();
    Ok((result?, seconds))
}

/// Writes a report about the run.
fn report(
    (args, given): (&FilterArgs, &Given),
    experiment: &Experiment,
    run: ReportedRun,
    warnings: &[String],
    path: &Path,
) -> Result<PathBuf> {
    let name = experiment_name(&given.log);
    let page = page(&name, experiment, (run, args.shared.occlusion()), warnings);
    let own = origin([
        ("log", given.log.display().to_string()),
        ("scene", given.scene.display().to_string()),
        ("particles", args.shared.particles.to_string()),
        ("seed", args.seed.to_string()),
    ]);
    let report = Report {
        origin: own.into_iter().chain(page.origin).collect(),
        ..page
    };
    write_report(path.to_owned(), &report)
}

/// The page about a run under an occlusion.
pub fn page(
    name: &str,
    experiment: &Experiment,
    (run, occlusion): (ReportedRun, Occlusion),
    warnings: &[String],
) -> Report {
    let title = format!("{name}: {}", run.title());
    let (shown, runs, start) = since_start(experiment, vec![run]);
    let reported = ReportedExperiment::new(name, "", &shown, occlusion, runs);
    let reference = ("scored against", reference_name(experiment).to_owned());
    let start = start.map(|start| ("times", format!("from {start} s on")));
    let origin = [reference].into_iter().chain(start);
    Report {
        title,
        summary: warnings
            .iter()
            .map(|text| Block::Note(format!("Warning: {text}")))
            .collect(),
        sections: vec![reported.section()],
        origin: origin.map(|(key, value)| (key.to_owned(), value)).collect(),
    }
}

/// Writes the estimate in all forms that are asked for, estimate.csv first.
fn write_all(
    args: &FilterArgs,
    folder: &Path,
    run: &ReportedRun,
    experiment: &Experiment,
) -> Result<Vec<PathBuf>> {
    let estimate = &run.scored.estimate;
    let mut results = Results::default();
    results.add(folder.join(ESTIMATE), |file| write_estimate(file, estimate))?;
    results.add(folder.join("modes.csv"), |file| write_modes(file, estimate))?;
    if args.tum {
        let path = folder.join("estimate.tum");
        results.add(path, |file| write_estimate_tum(file, estimate))?;
    }
    if args.mcap {
        let path = folder.join("estimate.mcap");
        let mut bytes = Cursor::new(Vec::new());
        let Experiment { setup, log, .. } = experiment;
        write_estimate_mcap(&mut bytes, estimate, &run.cloud, log, setup)?;
        results.add(path, |file| file.write_all(bytes.get_ref()))?;
    }
    results.place()
}

impl<'a> Summary<'a> {
    fn new(experiment: &Experiment, run: &ScoredRun, seconds: f64, warnings: &'a [String]) -> Self {
        let scores = &run.scores;
        Self {
            wmse_mm: scores.wmse_mm,
            wmse_occluded_mm: scores.wmse_occluded_mm,
            wmse_moving_mm: scores.wmse_moving_mm,
            final_error_mm: scores.final_error_mm,
            final_error_deg: scores.final_error_deg,
            frames: experiment.log.len(),
            unsolved: run.unsolved,
            failed: run.failed,
            collapses: run.collapses,
            log_evidence: run.log_evidence,
            warnings,
            real_time_factor: experiment.log.duration() / seconds,
            stall_force: experiment.setup.scene.pusher.stall_force,
            stall_force_assumed: experiment.setup.stall_force_assumed,
            friction: LearnedParameter::all(&run.estimate)
                .into_iter()
                .map(|parameter| (parameter.name, parameter))
                .collect(),
        }
    }
}

fn tables(
    (args, log): (&FilterArgs, &Path),
    experiment: &Experiment,
    estimate: &Estimate,
    summary: &Summary<'_>,
) -> String {
    let title = format!(
        "{}, {} against {}\n",
        log.display(),
        Variant::of(args.method.into(), TactileUse::Used).title(),
        reference_name(experiment)
    );
    let radius = args
        .virtual_radius
        .unwrap_or(experiment.setup.virtual_radius());
    let about_score = format!(
        "pose RMSE: weighted RMSE of the pose, angles times {:.1} mm (JSON key wmse_mm, the paper's WMSE)\n",
        1e3 * radius
    );
    let parameters = LearnedParameter::all(estimate);
    let friction =
        (!parameters.is_empty()).then(|| friction_table(experiment, &parameters).to_string());
    let parts = [title, score_table(summary).to_string(), about_score]
        .into_iter()
        .chain(friction)
        .chain(final_pose_line(experiment, estimate))
        .chain(assumed_stall_force(&experiment.setup).map(|finding| format!("note: {finding}\n")))
        .chain(
            summary
                .warnings
                .iter()
                .map(|text| format!("warning: {text}\n")),
        );
    parts.collect::<Vec<_>>().join("\n")
}

fn score_table(summary: &Summary<'_>) -> Table {
    let mut table = Table::new(["score", "value", "unit"]);
    let mut row = |name: &str, value: String, unit: &str| {
        table.push([name.to_owned(), value, unit.to_owned()])
    };
    row("pose RMSE", number(summary.wmse_mm, 3), "mm");
    row(
        "pose RMSE, occluded",
        number(summary.wmse_occluded_mm, 3),
        "mm",
    );
    row("pose RMSE, moving", number(summary.wmse_moving_mm, 3), "mm");
    row(
        "final position error",
        number(summary.final_error_mm, 3),
        "mm",
    );
    row(
        "final angle error",
        number(summary.final_error_deg, 3),
        "deg",
    );
    row("frames", summary.frames.to_string(), "");
    row("unsolved particle steps", summary.unsolved.to_string(), "");
    row("of them failed", summary.failed.to_string(), "");
    row("collapses", summary.collapses.to_string(), "");
    row(
        "real-time factor",
        format!("{:.1}", summary.real_time_factor),
        "",
    );
    table
}

fn friction_table(experiment: &Experiment, parameters: &[LearnedParameter]) -> Table {
    let mut table = Table::new(["friction", "estimate", "nominal"]);
    for parameter in parameters {
        let nominal = parameter.shown_value(parameter.among(&experiment.setup.scene.nominal));
        table.push([parameter.name.to_owned(), parameter.shown(), nominal]);
    }
    table
}

/// The last estimate next to the measured final pose, where only that is known of the truth.
fn final_pose_line(experiment: &Experiment, estimate: &Estimate) -> Option<String> {
    let measured = experiment
        .facts
        .final_pose
        .filter(|_| experiment.truth.is_none())?;
    let predicted = estimate.rows.iter().rev().find_map(|row| row.pose)?;
    let shown = |pose: &Pose| {
        format!(
            "({:.1} mm, {:.1} mm, {:.2} deg)",
            1e3 * pose.x,
            1e3 * pose.y,
            pose.theta.to_degrees()
        )
    };
    Some(format!(
        "final pose: estimated {}, measured {}",
        shown(&predicted),
        shown(&measured)
    ))
}
