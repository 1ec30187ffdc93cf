//! `stickslip fit`: learns parameters that a scene cannot know from many pushes.

mod figures;
mod object;
mod page;
mod tables;

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::CommandFactory;
use rayon::prelude::*;
use serde::Serialize;
use stickslip_fit::{
    CrossValidation, Fit, FitError, FitOptions, Parameter, Push, default_folds, doubts, predict,
};
use stickslip_formats::BagOptions;
use stickslip_report::Report;

use self::object::{Object, objects};
use self::page::page;
use self::tables::{overview, text};
use crate::args::Program;
use crate::compare::{expand, inputs};
use crate::experiment::{check_sense, experiment_name, read_folder, text_of};
use crate::files::{Results, ready_file, ready_folder, refuse_inputs, write_report};
use crate::fit_args::FitArgs;
use crate::log_files::log_path;
use crate::output::{counted, show, talk};
use crate::progress::stage;
use crate::verdict::Verdict;

/// Names of the files of a fit.
const SCENE: &str = "scene.toml";
const JSON: &str = "fit.json";

/// Content of fit.json.
#[derive(Debug, Serialize)]
struct FitResult {
    /// Name of the object, where the pushes are of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    object: Option<String>,
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
    let scenes = args.scenes.scenes();
    let folders = expand(&args.folders, scenes)?;
    let test_folders = test_folders(args, &folders)?;
    let topics = args.topics.options(Program::command())?;
    let pool = args.threads.pool()?;
    let read = inputs(&[&folders[..], &test_folders].concat(), scenes);
    let read: Vec<&Path> = read.iter().map(PathBuf::as_path).collect();
    if let Some(report) = &args.report {
        ready_file(report, &read)?;
    }
    ready_folder(&args.out)?;

    let (pushes, verdict) = pool.install(|| read_pushes(args, &topics, &folders))?;
    let (test, of_test) = pool.install(|| read_pushes(args, &topics, &test_folders))?;
    let objects = objects(&args.out, (folders, pushes), test)?;
    for object in &objects {
        refuse_inputs(&object.out.join(SCENE), &read)?;
        if let (Some(name), 0..2) = (&object.name, object.pushes.len()) {
            let (pushes, least) = (object.pushes.len(), 2);
            return Err(FitError::TooFewPushes { pushes, least }).context(name.clone());
        }
    }
    let mut results = Vec::new();
    for object in &objects {
        let result = pool.install(|| learn(args, object))?;
        write(args, object, &result)?;
        if !args.json {
            let blank = if results.is_empty() { "" } else { "\n" };
            show(format!("{blank}{}", text(&result)))?;
        }
        results.push(result);
    }
    match (&results[..], args.json) {
        ([result], true) => show(serde_json::to_string_pretty(result)?)?,
        (_, true) => show(serde_json::to_string_pretty(&results)?)?,
        ([_], false) => {}
        (_, false) => show(format!("\n{}", overview(&results)))?,
    }
    if let Some(path) = &args.report {
        let path = write_report(path.clone(), &page(&results, args.seed))?;
        talk(format_args!("wrote {}", path.display()));
    }
    for object in &objects {
        let [scene, json] = [SCENE, JSON].map(|name| object.out.join(name));
        talk(format_args!(
            "wrote {} and {}",
            scene.display(),
            json.display()
        ));
    }
    Ok(verdict.and(of_test))
}

/// Writes the fitted scene and fit.json.
fn write(args: &FitArgs, object: &Object, result: &FitResult) -> Result<()> {
    let first = args.scenes.scenes().of(&object.folders[0]);
    let scene = result.fit.scene_text(
        &text_of(&first, "scene")?,
        &first.display().to_string(),
        result.cross_validation.as_ref(),
    )?;
    let json = serde_json::to_string_pretty(&result)? + "\n";
    let mut results = Results::default();
    results.add(object.out.join(SCENE), |file| {
        file.write_all(scene.as_bytes())
    })?;
    results.add(object.out.join(JSON), |file| {
        file.write_all(json.as_bytes())
    })?;
    results.place().map(drop)
}

/// The page about a fit that a caller made.
pub fn page_of(
    fit: &Fit,
    cross_validation: Option<&CrossValidation>,
    warnings: &[String],
    seed: u64,
) -> Report {
    let result = FitResult {
        object: None,
        folders: Vec::new(),
        seed,
        fit: fit.clone(),
        cross_validation: cross_validation.cloned(),
        warnings: warnings.to_vec(),
        test: None,
    };
    page(&[result], seed)
}

/// The folders of `--test`, none of which may be among `folders`: a push that was seen is not
/// predicted blind.
fn test_folders(args: &FitArgs, folders: &[PathBuf]) -> Result<Vec<PathBuf>> {
    if args.test.is_empty() {
        return Ok(Vec::new());
    }
    let test = expand(&args.test, args.scenes.scenes())?;
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

/// The fit to the pushes of `object`, and its accuracy on each of them left out, and on its pushes
/// of `--test`.
fn learn(args: &FitArgs, object: &Object) -> Result<FitResult> {
    let Object {
        name,
        folders,
        pushes,
        test,
        ..
    } = object;
    let options = &FitOptions {
        parameters: Parameter::list_or_default(&args.free, &pushes[0].setup)?,
        seed: args.seed,
    };
    let of_object = name.as_ref().map(|name| format!(" of {name}"));
    let count = counted(pushes.len() as u64, "push");
    let progress = stage(format!("fitting {count}{}", of_object.unwrap_or_default()));
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
        object: name.clone(),
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
        let (experiment, verdict) = read_folder(folder, &args.scenes.scenes().of(folder), topics)
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
