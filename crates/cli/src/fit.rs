//! `stickslip fit`: learns parameters that a scene cannot know from many pushes.

mod figures;

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::CommandFactory;
use rayon::prelude::*;
use serde::Serialize;
use stickslip_fit::{
    CrossValidation, Fit, FitOptions, FittedParameter, Parameter, Push, default_folds, doubts,
    predict,
};
use stickslip_formats::BagOptions;
use stickslip_report::{Block, Report, Section, Table};

use crate::args::Program;
use crate::compare::expand;
use crate::experiment::{check_sense, experiment_name, read_folder, text_of};
use crate::files::{Results, ready_file, ready_folder, refuse_inputs, write_report};
use crate::fit_args::FitArgs;
use crate::log_files::log_path;
use crate::origin::origin;
use crate::output::{counted, show_result, talk};
use crate::progress::stage;
use crate::verdict::Verdict;

/// Content of fit.json.
#[derive(Debug, Serialize)]
struct FitResult {
    /// The folders with the pushes.
    folders: Vec<String>,
    seed: u64,
    #[serde(flatten)]
    fit: Fit,
    /// None where there are too few pushes, or none was asked for.
    cross_validation: Option<CrossValidation>,
    /// Reasons to doubt the fit.
    warnings: Vec<String>,
    /// The pushes of `--test`, predicted by this fit; none where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    test: Option<CrossValidation>,
}

/// Runs the command.
pub fn fit(args: &FitArgs) -> Result<Verdict> {
    if !args.free.is_empty() {
        Parameter::parse_list(&args.free)?; // before anything is read
    }
    let folders = expand(&args.folders, args.scenes())?;
    let test_folders = test_folders(args, &folders)?;
    let topics = args.topics.options(Program::command())?;
    let pool = args.threads.pool()?;
    let [scene_out, json_out] = ["scene.toml", "fit.json"].map(|name| args.out.join(name));
    let all = folders.iter().chain(&test_folders);
    let scenes: Vec<PathBuf> = all.map(|folder| args.scenes().of(folder)).collect();
    let scenes: Vec<&Path> = scenes.iter().map(PathBuf::as_path).collect();
    refuse_inputs(&scene_out, &scenes)?;
    if let Some(report) = &args.report {
        ready_file(report, &scenes)?;
    }
    ready_folder(&args.out)?;

    let (result, verdict) = pool.install(|| -> Result<_> {
        let (pushes, verdict) = read_pushes(args, &topics, &folders)?;
        let (test, of_test) = read_pushes(args, &topics, &test_folders)?;
        let first = pushes.first().expect("there is a folder");
        let options = FitOptions {
            parameters: Parameter::list_or_default(&args.free, &first.setup)?,
            seed: args.seed,
        };
        let result = learn(args, &folders, &pushes, &test, &options)?;
        Ok((result, verdict.and(of_test)))
    })?;

    let name = scenes[0].display().to_string();
    let scene = result.fit.scene_text(
        &text_of(scenes[0], "scene")?,
        &name,
        result.cross_validation.as_ref(),
    )?;
    let json = serde_json::to_string_pretty(&result)? + "\n";
    let mut results = Results::default();
    results.add(scene_out.clone(), |file| file.write_all(scene.as_bytes()))?;
    results.add(json_out.clone(), |file| file.write_all(json.as_bytes()))?;
    results.place()?;
    show_result(args.json, &result, || text(&result))?;
    if let Some(path) = &args.report {
        let path = write_report(path.clone(), &page(&result, args.seed))?;
        talk(format_args!("wrote {}", path.display()));
    }
    talk(format_args!(
        "wrote {} and {}",
        scene_out.display(),
        json_out.display()
    ));
    Ok(verdict)
}

/// The folders of `--test`, none of which may be among `folders`: a push that was seen is not
/// predicted blind.
fn test_folders(args: &FitArgs, folders: &[PathBuf]) -> Result<Vec<PathBuf>> {
    if args.test.is_empty() {
        return Ok(Vec::new());
    }
    let test = expand(&args.test, args.scenes())?;
    let seen: Vec<PathBuf> = folders.iter().flat_map(std::fs::canonicalize).collect();
    for folder in &test {
        if std::fs::canonicalize(folder).is_ok_and(|folder| seen.contains(&folder)) {
            bail!(
                "{}: --test names a push that is also fitted; a fitted push is no test. Leave it out of one of the two",
                folder.display()
            );
        }
    }
    Ok(test)
}

/// The fit to `pushes`, and its accuracy on each of them left out, and on those of `test`.
fn learn(
    args: &FitArgs,
    folders: &[PathBuf],
    pushes: &[Push],
    test: &[Push],
    options: &FitOptions,
) -> Result<FitResult> {
    let progress = stage(format!("fitting {}", counted(pushes.len() as u64, "push")));
    let fit = stickslip_fit::fit(pushes, options, &|_, _| ())?;
    let folds = args.folds.unwrap_or(default_folds(pushes.len()));
    progress.set_message(format!(
        "predicting each of {folds} parts by a fit to the others"
    ));
    let validate = || stickslip_fit::cross_validate(pushes, folds, options, &|_, _| ());
    let cross_validation = (folds > 0).then(validate).transpose()?;
    let predict = || predict(test, &fit, cross_validation.as_ref(), options);
    let test = (!test.is_empty()).then(predict).transpose()?;
    progress.finish_and_clear();
    Ok(FitResult {
        folders: folders
            .iter()
            .map(|path| path.display().to_string())
            .collect(),
        seed: args.seed,
        warnings: doubts(pushes, &fit),
        fit,
        cross_validation,
        test,
    })
}

/// All pushes, and whether all of their logs could be read. One that cannot be read is an error:
/// left out, it would change the fit.
fn read_pushes(
    args: &FitArgs,
    topics: &BagOptions,
    folders: &[PathBuf],
) -> Result<(Vec<Push>, Verdict)> {
    let read = |folder: &PathBuf| {
        let (experiment, verdict) = read_folder(folder, &args.scenes().of(folder), topics)
            .with_context(|| folder.display().to_string())?;
        check_sense(&args.force, &experiment).with_context(|| folder.display().to_string())?;
        let push = Push {
            name: experiment_name(&log_path(folder)),
            setup: experiment.setup,
            log: experiment.log,
        };
        Ok((push, verdict))
    };
    let read: Vec<(Push, Verdict)> = folders.par_iter().map(read).collect::<Result<_>>()?;
    let mut verdicts = read.iter().map(|(_, verdict)| *verdict);
    let lost = verdicts.find(|verdict| *verdict != Verdict::Done);
    let pushes = read.into_iter().map(|(push, _)| push).collect();
    Ok((pushes, lost.unwrap_or(Verdict::Done)))
}

/// Title of a result.
fn fitted_to(result: &FitResult) -> String {
    format!("Fit to {}", counted(result.fit.pushes as u64, "push"))
}

/// The result as a terminal shows it.
fn text(result: &FitResult) -> String {
    let mut lines = vec![
        fitted_to(result),
        parameters(&result.fit).to_string(),
        remarks(result).join("\n"),
    ];
    for (title, validation) in validations(result) {
        lines.push(format!(
            "{}{}",
            errors(validation, title),
            coverage(validation)
        ));
    }
    lines.join("\n")
}

/// Pushes predicted by fits that have not seen them, and their names.
fn validations(result: &FitResult) -> impl Iterator<Item = (&'static str, &CrossValidation)> {
    let of = [
        ("pushes left out", &result.cross_validation),
        ("pushes of --test", &result.test),
    ];
    of.into_iter()
        .filter_map(|(title, validation)| Some((title, validation.as_ref()?)))
}

/// The result as a page.
fn page(result: &FitResult, seed: u64) -> Report {
    let mut sections = vec![Section {
        title: "Fitted parameters".to_owned(),
        blocks: vec![
            figures::marginals(&result.fit),
            Block::Table(parameters(&result.fit), String::new()),
        ],
    }];
    for (title, validation) in validations(result) {
        sections.push(Section {
            title: format!("Predictions of {title}"),
            blocks: vec![
                figures::errors(validation),
                Block::Table(
                    errors(validation, title),
                    "Median over the pushes".to_owned(),
                ),
                Block::Text(coverage(validation)),
                Block::Table(each(validation), "Each push".to_owned()),
            ],
        });
    }
    Report {
        title: fitted_to(result),
        summary: headlines(result)
            .into_iter()
            .chain(remarks(result))
            .map(Block::Text)
            .collect(),
        sections,
        origin: origin([("seed", seed.to_string())]),
    }
}

/// Most important results: values that were learnt, and their accuracy.
fn headlines(result: &FitResult) -> Vec<String> {
    let (learnt, left): (Vec<_>, Vec<_>) = result
        .fit
        .parameters
        .iter()
        .partition(|fitted| fitted.learnt);
    let mut lines: Vec<String> = learnt
        .into_iter()
        .map(|fitted| {
            let [value, std, before] = [fitted.value, fitted.std, fitted.prior_value].map(digits);
            let (name, unit) = (fitted.name, fitted.unit);
            format!("{name}: {value} ± {std} {unit}")
                .trim_end()
                .to_owned()
                + &format!(", nominal {before}")
        })
        .collect();
    if !left.is_empty() {
        let names: Vec<&str> = left.iter().map(|fitted| fitted.name).collect();
        lines.push(format!(
            "not identifiable from these pushes: {}",
            names.join(", ")
        ));
    }
    if let Some(validation) = &result.cross_validation {
        let [unfitted, fitted] = validation.median_final_mm;
        lines.push(format!(
            "final position error of pushes left out: {unfitted:.2} mm with nominal values, {fitted:.2} mm with a fit to the others"
        ));
    }
    lines
}

/// Remarks besides the tables.
fn remarks(result: &FitResult) -> Vec<String> {
    let fit = &result.fit;
    let mut remarks = Vec::new();
    if let Some([a, b, strongest]) = strongest_correlation(fit) {
        remarks.push(format!("strongest correlation: {a} with {b}, {strongest}"));
    }
    remarks.push(format!(
        "model drift {:.1} % of the pusher's path; camera noise {:.2} times that of scene.toml",
        100.0 * fit.noise.drift,
        fit.noise.camera_scale
    ));
    let warnings = result.warnings.iter();
    remarks.extend(warnings.map(|text| format!("warning: {text}")));
    if let Some(validation) = result.cross_validation.as_ref().filter(|v| !v.pays) {
        let [gain, error] = validation.gain_mm;
        remarks.push(format!(
            "the fit does not improve predictions of pushes left out (gain {gain:.2} ± {error:.2} mm); scene.toml keeps the nominal values"
        ));
    }
    if fit.sampling.unsolved > 0 {
        remarks.push(format!("unsolved steps: {}", fit.sampling.unsolved));
    }
    if result.cross_validation.is_none() {
        remarks.push("no push was left out to check the fit".to_owned());
    }
    remarks
}

fn parameters(fit: &Fit) -> Table {
    let mut table = Table::new([
        "parameter",
        "nominal",
        "fitted",
        "spread",
        "unit",
        "spread/prior",
        "",
        "90 %",
    ]);
    for fitted in &fit.parameters {
        let said = match (fitted.determined, fitted.learnt) {
            (true, _) => "identified",
            (false, true) => "weakly identified",
            (false, false) => "not identifiable",
        };
        table.push([
            fitted.name.to_owned(),
            digits(fitted.prior.value(0.0)),
            digits(fitted.value),
            digits(fitted.std),
            fitted.unit.to_owned(),
            format!("{:.2}", fitted.std_ratio),
            said.to_owned(),
            format!(
                "{} to {}",
                digits(fitted.interval_90[0]),
                digits(fitted.interval_90[1])
            ),
        ]);
    }
    table
}

/// A number with four digits after its leading zeros.
fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let places = 3.0 - value.abs().max(1e-9).log10().floor();
    format!("{value:.*}", places.clamp(0.0, 9.0) as usize)
}

/// The two parameters that the pushes separate least, and their correlation.
fn strongest_correlation(fit: &Fit) -> Option<[String; 3]> {
    let name = |k: usize| -> &FittedParameter { &fit.parameters[k] };
    let pairs = (0..fit.parameters.len()).flat_map(|i| (0..i).map(move |j| (j, i)));
    let strongest = pairs.max_by(|a, b| {
        let of = |(i, j): &(usize, usize)| fit.correlation[*i][*j].abs();
        of(a).total_cmp(&of(b))
    });
    strongest.map(|(i, j)| {
        let value = format!("{:.2}", fit.correlation[i][j]);
        [name(i).name.to_owned(), name(j).name.to_owned(), value]
    })
}

fn errors(validation: &CrossValidation, title: &str) -> Table {
    let title = format!("{title}, median");
    let mut table = Table::new([title.as_str(), "nominal", "fitted", "ratio"]);
    for (name, [unfitted, fitted]) in [
        ("final position (mm)", validation.median_final_mm),
        ("pose RMSE (mm)", validation.median_wmse_mm),
    ] {
        table.push([
            name.to_owned(),
            format!("{unfitted:.3}"),
            format!("{fitted:.3}"),
            format!("{:.2}", fitted / unfitted),
        ]);
    }
    table
}

fn coverage(validation: &CrossValidation) -> String {
    format!(
        "90 % intervals for the final x, y and theta cover {:.0} % ({}, {})",
        100.0 * validation.coverage_90,
        counted(validation.pushes.len() as u64, "push"),
        counted(validation.folds as u64, "fold")
    )
}

fn each(validation: &CrossValidation) -> Table {
    let mut table = Table::new([
        "push",
        "final position, nominal (mm)",
        "final position, fitted (mm)",
        "pose RMSE, nominal (mm)",
        "pose RMSE, fitted (mm)",
        "in the intervals",
    ]);
    for push in &validation.pushes {
        let numbers = [push.final_mm, push.wmse_mm];
        let numbers = numbers.as_flattened().iter().map(|mm| format!("{mm:.2}"));
        let inside = push.covered.iter().filter(|covered| **covered).count();
        let cells = [push.push.clone()].into_iter().chain(numbers);
        table.push(cells.chain([format!("{inside} of 3")]));
    }
    table
}
