//! `stickslip view`: a page that lists logs, checks them, runs the filter and changes a scene.

mod opened;
mod settings;

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;

use anyhow::{Result, anyhow};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::json;
use stickslip::diagnosis::{Finding, diagnose, doubts};
use stickslip::{Occlusion, Run, RunOptions, keep_threads_awake, run_observed};
use stickslip_evaluation::{ScoredRun, Variant};
use stickslip_formats::Experiment;
use stickslip_report::{
    Block, CloudSample, Colour, Line, PlaybackRun, Report, ReportedExperiment, Section, view_page,
};

use crate::arg_values::ThreadArgs;
use crate::args::ViewArgs;
use crate::check;
use crate::compare::{Scenes, expand, is_experiment};
use crate::experiment::{check_occlusion, refuse_nonsense};
use crate::failure::hinted;
use crate::filter::page;
use crate::page_server::{LARGEST_BODY_MB, Notices, lock, serve};
use crate::reported_run::DRAWN;
use crate::verdict::Verdict;
use opened::{DroppedFile, Opened, Source};
use settings::Settings;

/// Scenes of the logs that are listed.
const SCENES: Scenes<'_> = Scenes::Named("scene.toml");

/// The logs of the page, and what it shows.
struct View {
    threads: ThreadArgs,
    logs: Mutex<Vec<(String, Source)>>,
    /// The log that was opened last.
    opened: Mutex<Option<Arc<Opened>>>,
    /// Number of the latest run; earlier ones end.
    latest: AtomicU64,
    /// The log of the latest run that has ended, its settings in words, and the run.
    shown: Mutex<Option<(String, String, PlaybackRun)>>,
}

/// A question about a log. Keys are those of sliders; `run` is the page's number of a run.
#[derive(Deserialize)]
struct Question {
    log: String,
    #[serde(default)]
    changed: BTreeMap<String, f64>,
    #[serde(default)]
    run: f64,
}

/// Files that are dropped on the page.
#[derive(Deserialize)]
struct Dropped {
    files: Vec<DroppedFile>,
}

/// Payload of the unwinding that ends a run when another begins.
struct Superseded;

/// Runs the command, until a signal ends the program.
pub fn view(args: &ViewArgs) -> Result<Verdict> {
    if let Some(missing) = args.folders.iter().find(|folder| !folder.exists()) {
        return Err(hinted(
            format!("{}: there is no such folder", missing.display()),
            "give a folder with scene.toml and a log, a folder of such folders, or none",
        ));
    }
    let mut folders = match args.folders.is_empty() {
        true => Vec::new(),
        false => expand(&args.folders, SCENES)?,
    };
    folders.retain(|folder| is_experiment(folder, SCENES));
    let logs = folders
        .into_iter()
        .map(|folder| (folder.display().to_string(), Source::Folder(folder)));
    let logs: Vec<(String, Source)> = logs.collect();
    let names: Vec<String> = logs.iter().map(|(name, _)| name.clone()).collect();
    let view = View {
        threads: args.threads.clone(),
        logs: Mutex::new(logs),
        opened: Mutex::default(),
        latest: AtomicU64::new(0),
        shown: Mutex::default(),
    };
    let answers =
        move |what: &str, text: &[u8], notices: &Notices| view.answer(what, text, notices);
    let page = view_page(&names, LARGEST_BODY_MB);
    let _server = serve(page, Some(Box::new(answers)), (args.port, "--port 8321"))?;
    loop {
        thread::park();
    }
}

impl View {
    /// Answers a question of the page.
    fn answer(&self, what: &str, text: &[u8], notices: &Notices) -> Result<String> {
        if what == "drop" {
            return self.take(&parsed::<Dropped>(text)?.files);
        }
        let question: Question = parsed(text)?;
        match what {
            "check" => {
                let opened = self.read(&question.log)?;
                Ok(serde_json::to_string(&checked(&opened))?)
            }
            "open" => self.open(&question.log),
            "run" => self.run(&question, notices),
            "scene" => {
                let opened = self.opened(&question.log)?;
                Settings::changed(&opened, &question.changed)?.scene_text()
            }
            _ => Err(hinted(
                format!("`{what}`: the page has no such question"),
                "ask drop, check, open, run or scene",
            )),
        }
    }

    /// Reads a log of the list.
    fn read(&self, name: &str) -> Result<Arc<Opened>> {
        let found = lock(&self.logs).iter().find(|log| log.0 == name).cloned();
        let Some((_, source)) = found else {
            return Err(hinted(
                format!("`{name}`: no log of this page has that name"),
                "choose one of the list",
            ));
        };
        source.read(name)
    }

    /// The log that was opened last, or another one.
    fn opened(&self, name: &str) -> Result<Arc<Opened>> {
        let opened = lock(&self.opened).clone();
        match opened.filter(|opened| opened.name == name) {
            Some(opened) => Ok(opened),
            None => self.read(name),
        }
    }

    /// Takes a scene and a log; answers with their name in the list.
    fn take(&self, files: &[DroppedFile]) -> Result<String> {
        let mut logs = lock(&self.logs);
        let opened = Opened::of_files(files, logs.len() + 1)?;
        let name = serde_json::to_string(&opened.name)?;
        logs.push((opened.name.clone(), Source::Dropped(Arc::new(opened))));
        Ok(name)
    }

    /// Findings, sliders, and a player of what was measured.
    fn open(&self, name: &str) -> Result<String> {
        let opened = self.read(name)?;
        self.latest.fetch_add(1, Ordering::Relaxed);
        *lock(&self.opened) = Some(opened.clone());
        *lock(&self.shown) = None;
        let settings = Settings::new(&opened);
        let measured = opened.measured();
        let reported = ReportedExperiment::new(name, "", &measured, Occlusion::None, Vec::new());
        let report = json!({
            "findings": checked(&opened).findings,
            "sliders": settings.sliders,
            "html": Report::player(reported.scene_playback()).to_part(),
        });
        Ok(report.to_string())
    }

    /// Runs the filter; answers with the player of this run and the one before, and with figures.
    fn run(&self, question: &Question, notices: &Notices) -> Result<String> {
        let number = self.latest.fetch_add(1, Ordering::Relaxed) + 1;
        let opened = self.opened(&question.log)?;
        let settings = Settings::changed(&opened, &question.changed)?;
        let experiment = settings.experiment()?;
        settings.check_order()?;
        let options = settings.options();
        check_occlusion(options.occlusion, &experiment.log)?;
        refuse_nonsense(
            &experiment.setup,
            &experiment.log,
            "`stickslip filter --force`",
        )?;

        let sample = CloudSample::new(DRAWN);
        let rows = experiment.log.len();
        let mut advance = |row: usize| {
            if self.latest.load(Ordering::Relaxed) != number {
                resume_unwind(Box::new(Superseded));
            }
            if notices.wants() {
                notices.show(json!({"run": question.run, "row": row, "rows": rows}).to_string());
            }
        };
        let run = self.filtered(&experiment, &options, &sample, &mut advance)?;
        let warnings = doubts(&experiment.setup, &experiment.log, &run);
        let warnings: Vec<String> = warnings.iter().map(Finding::to_string).collect();
        let variant = Variant::of(options.method, options.tactile);
        let scored = (options.occlusion, experiment.setup.virtual_radius());
        let run = sample.into_run(ScoredRun::of(variant, run, &experiment, scored));
        let mut report = page(
            &question.log,
            &experiment,
            (run, options.occlusion),
            &warnings,
        );
        if let Some(section) = report.sections.first_mut() {
            self.lay_over(&question.log, settings.words(), section);
        }
        Ok(report.to_part())
    }

    fn filtered(
        &self,
        experiment: &Experiment,
        options: &RunOptions,
        sample: &CloudSample,
        advance: &mut (dyn FnMut(usize) + Send),
    ) -> Result<Run> {
        let pool = self.threads.filter_pool(options.particles)?;
        let Experiment { setup, log, .. } = experiment;
        let mut track = || run_observed(setup, log, options, sample, advance);
        let ended = catch_unwind(AssertUnwindSafe(|| {
            pool.install(|| keep_threads_awake(&mut track))
        }));
        ended
            .map_err(|panic| match panic.downcast::<Superseded>() {
                Ok(_) => anyhow!("another run began"),
                Err(_) => anyhow!("the run broke an invariant of the library (see the terminal)"),
            })?
            .map_err(Into::into)
    }

    /// Adds the run before to the player of a run, whose section this is, and says what both are.
    fn lay_over(&self, log: &str, settings: String, section: &mut Section) {
        let Some(Block::Playback(playback)) = section.blocks.first_mut() else {
            return;
        };
        let mut notes = vec![Block::Note(format!("This run: {settings}"))];
        let shown = playback.runs.first().cloned();
        let shown = shown.map(|run| (log.to_owned(), settings, run));
        let before = std::mem::replace(&mut *lock(&self.shown), shown);
        if let Some((_, settings, run)) = before.filter(|(of, ..)| of == log) {
            notes.push(Block::Note(format!("Previous run: {settings}")));
            playback.lowest_first.insert(0, playback.runs.len());
            playback.runs.push(PlaybackRun {
                name: "previous run".to_owned(),
                colour: Colour::BLUE,
                line: Line::Dashed,
                cloud: Vec::new(),
                contacts: Vec::new(),
                ..run
            });
        }
        section.blocks.splice(1..1, notes);
    }
}

/// Findings of `stickslip check`, after what was lost in reading.
fn checked(opened: &Opened) -> check::Report {
    let Experiment { setup, log, .. } = &opened.experiment;
    check::Report::new(&diagnose(setup, log)).after_reading(&opened.warnings)
}

fn parsed<T: DeserializeOwned>(text: &[u8]) -> Result<T> {
    serde_json::from_slice(text).map_err(|error| {
        hinted(
            format!("the question is not understood: {error}"),
            "load the page again",
        )
    })
}
