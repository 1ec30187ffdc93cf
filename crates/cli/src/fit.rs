//! `stickslip fit`: learns parameters that a scene cannot know from many pushes.

mod earlier;
mod figures;
mod object;
mod page;
mod players;
mod tables;

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::CommandFactory;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use stickslip_fit::{
    CrossValidation, Fit, FitError, FitOptions, FittedParameter, Parameter, Push, default_folds,
    doubts, predict,
};
use stickslip_formats::BagOptions;
use stickslip_report::{Report, Section};

use self::earlier::{Posterior, digest, earlier};
use self::object::{Object, objects};
use self::page::page;
use self::players::{players, worst};
use self::tables::{overview, text, validations};
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
const POSTERIOR: &str = "posterior.json";

/// Content of fit.json.
#[derive(Debug, Serialize, Deserialize)]
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
    /// Draws and predicted poses, which only a page shows.
    #[serde(skip)]
    posterior: Posterior,
    #[serde(skip)]
    players: Vec<Section>,
}

/// Options of the fit of each object.
#[derive(Debug)]
struct Task {
    options: FitOptions,
    folds: usize,
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
        let mut result = pool.install(|| learnt(args, object))?;
        if args.report.is_some() {
            result.players = players(&result, [&object.pushes, &object.test])?;
        }
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
    Ok(verdict.and(of_test))
}

/// The fit to the pushes of `object`, in its folder: the one that is there, if its pushes and
/// options are these, or a new one.
fn learnt(args: &FitArgs, object: &Object) -> Result<FitResult> {
    let first = args.scenes.scenes().of(&object.folders[0]);
    let scene = text_of(&first, "scene")?;
    let task = Task {
        options: FitOptions {
            parameters: Parameter::list_or_default(&args.free, &object.pushes[0].setup)?,
            seed: args.seed,
        },
        folds: args.folds.unwrap_or(default_folds(object.pushes.len())),
    };
    let digest = digest(&task, object, &scene);
    if let Some(result) = earlier(object, &digest) {
        talk(format_args!(
            "{}: this fit is of the same pushes and options; it is not made again",
            object.out.display()
        ));
        return Ok(result);
    }
    let result = learn(task, object)?.with_posterior(digest);
    let fit = &result.fit;
    let scene = fit.scene_text(
        &scene,
        &first.display().to_string(),
        result.cross_validation.as_ref(),
    )?;
    let mut results = Results::default();
    for (name, text) in [
        (SCENE, scene),
        (JSON, serde_json::to_string_pretty(&result)? + "\n"),
        (POSTERIOR, serde_json::to_string(&result.posterior)? + "\n"),
    ] {
        results.add(object.out.join(name), |file| {
            file.write_all(text.as_bytes())
        })?;
    }
    for path in results.place()? {
        talk(format_args!("wrote {}", path.display()));
    }
    Ok(result)
}

impl FitResult {
    /// Adds what a page shows besides.
    fn with_posterior(mut self, digest: String) -> Self {
        let mut worst_poses = [Vec::new(), Vec::new()];
        for (k, _, validation) in validations(&self) {
            let poses = worst(validation).into_iter().flat_map(|push| &push.poses);
            let poses = poses.map(|pose| pose.map(|pose| [pose.x, pose.y, pose.theta]));
            worst_poses[k] = poses.collect();
        }
        let draws = self.fit.draws().into_iter();
        self.posterior = Posterior {
            digest,
            draws: draws
                .map(|(name, draws)| (name.to_owned(), draws))
                .collect(),
            worst: worst_poses,
        };
        self
    }

    /// Posterior draws of a parameter.
    fn draws(&self, fitted: &FittedParameter) -> &[f64] {
        let draws = self.posterior.draws.get(fitted.name());
        draws.map_or(&[], Vec::as_slice)
    }
}

/// The page about a fit to `pushes` that a caller made.
pub fn page_of(
    pushes: &[Push],
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
        posterior: Posterior::default(),
        players: Vec::new(),
    };
    let mut result = result.with_posterior(String::new());
    // the pushes were simulated for the fit
    result.players = players(&result, [pushes, &[]]).unwrap_or_default();
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
fn learn(Task { options, folds }: Task, object: &Object) -> Result<FitResult> {
    let Object {
        name,
        folders,
        pushes,
        test,
        ..
    } = object;
    let options = &options;
    let of_object = name.as_ref().map(|name| format!(" of {name}"));
    let count = counted(pushes.len() as u64, "push");
    let progress = stage(format!("fitting {count}{}", of_object.unwrap_or_default()));
    let fit = stickslip_fit::fit(pushes, options, &|_, _| ())?;
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
        seed: options.seed,
        warnings: doubts(pushes, &fit),
        fit,
        cross_validation,
        test,
        posterior: Posterior::default(),
        players: Vec::new(),
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
    // the first error in their order, whichever thread comes first
    let read: Vec<Result<(Push, Verdict)>> = folders.par_iter().map(read).collect();
    let read: Vec<(Push, Verdict)> = read.into_iter().collect::<Result<_>>()?;
    let mut verdicts = read.iter().map(|(_, verdict)| *verdict);
    let lost = verdicts.find(|verdict| *verdict != Verdict::Done);
    let pushes = read.into_iter().map(|(push, _)| push).collect();
    Ok((pushes, lost.unwrap_or(Verdict::Done)))
}
