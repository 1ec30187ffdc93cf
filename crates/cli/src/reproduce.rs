//! `stickslip reproduce`: the paper's tables and figures, ours next to the paper's numbers.

mod figures;
mod page;
mod pinned;
mod text;

use std::path::Path;

use anyhow::Result;
use rayon::prelude::*;
use serde::Serialize;
use stickslip_evaluation::paper::{
    NoiseLevel, PaperExperiment, Ratio, Replicate, Results, RunSet, RunSettings,
};
use stickslip_evaluation::{ScoredRun, Variant};

use crate::camera::filmed;
use crate::files::{FIGURE_FORMATS, ready_folder, write_figure, write_file, write_report};
use crate::output::{show_result, talk};
use crate::progress::{Work, bar};
use crate::simulation_args::ReproduceArgs;
use crate::verdict::Verdict;
use figures::figures;
use page::page;

/// Seeds where the command line does not say.
const SEEDS: u64 = 20;

/// All that the command says.
#[derive(Debug, Serialize)]
struct Report {
    particles: usize,
    seeds: u64,
    /// Rules of the particle filter.
    model: &'static str,
    /// True if no estimate uses a later row.
    causal: bool,
    /// These settings, as runs take them.
    #[serde(skip)]
    settings: RunSettings,
    /// The tables; from frames where [`Report::equal`] is there.
    #[serde(flatten)]
    tables: Results,
    equal: Option<Equal>,
}

/// Tables that those from frames are compared with.
#[derive(Debug, Serialize)]
struct Equal {
    /// Noise of the tracked poses, which is that of the simulated ones, by experiment.
    noise: Vec<NoiseLevel>,
    /// The tables from simulated poses.
    from_poses: Results,
    /// Medians from frames over those from poses.
    ratios: Vec<Ratio>,
}

/// Runs the command.
pub fn reproduce(args: &ReproduceArgs) -> Result<Verdict> {
    if args.pinned {
        return pinned::pinned(args);
    }
    if let Some(folder) = &args.out {
        // before minutes are spent on what is to be in it
        ready_folder(folder)?;
    }
    let report = args.threads.pool()?.install(|| report(args))?;
    show_result(args.json, &report, || report.text())?;
    Ok(Verdict::Done)
}

fn report(args: &ReproduceArgs) -> Result<Report> {
    let (seeds, settings) = (args.seeds.unwrap_or(SEEDS), args.settings());
    let runs = |replicates| runs(replicates, settings);
    let replicates = simulated(seeds)?;
    let (run_sets, equal) = if args.from_frames {
        let (tracked, simulated, noise) = filmed(&replicates)?;
        let (tracked, simulated) = (runs(tracked)?, runs(simulated)?);
        let from_poses = Results::new(&simulated);
        let ratios = Ratio::all(&Results::new(&tracked), &from_poses);
        let equal = Equal {
            noise,
            from_poses,
            ratios,
        };
        (tracked, Some(equal))
    } else {
        (runs(replicates)?, None)
    };
    let report = Report {
        particles: args.particles,
        seeds,
        model: args.model.name(),
        causal: args.causal,
        settings,
        tables: Results::new(&run_sets),
        equal,
    };
    if let Some(folder) = &args.out {
        write(folder, &report, &run_sets)?;
    }
    Ok(report)
}

impl Report {
    fn text(&self) -> String {
        let tables = text::text(&self.tables);
        match &self.equal {
            None => tables,
            Some(Equal {
                noise,
                from_poses,
                ratios,
            }) => {
                format!(
                    "From frames\n\n{tables}\nFrom simulated poses of equal noise\n\n{}\n{}\n{}",
                    text::text(from_poses),
                    text::noise(noise),
                    text::ratios(ratios)
                )
            }
        }
    }
}

/// Writes reproduce.json, the figures and report.html.
fn write(folder: &Path, report: &Report, run_sets: &[RunSet]) -> Result<()> {
    let figures = figures(run_sets, ["experiment A", "experiment B"]);
    figures
        .par_iter()
        .try_for_each(|figure| write_figure(folder, figure.name, &figure.drawing))?;
    write_file(
        &folder.join("reproduce.json"),
        serde_json::to_string_pretty(report)?.as_bytes(),
    )?;
    let page = write_report(
        folder.join("report.html"),
        &page(report, run_sets, &figures)?,
    )?;
    talk(format_args!(
        "wrote {} figures as {FIGURE_FORMATS}, reproduce.json and {}",
        figures.len(),
        page.display()
    ));
    Ok(())
}

/// Every experiment with every seed, simulated.
fn simulated(seeds: u64) -> Result<Vec<Replicate>> {
    let all: Vec<(PaperExperiment, u64)> = PaperExperiment::ALL
        .into_iter()
        .flat_map(|paper| (0..seeds).map(move |seed| (paper, seed)))
        .collect();
    let progress = bar(all.len(), "experiments simulated", Work::Long);
    let simulate = |(paper, seed): (PaperExperiment, u64)| {
        let replicate = Replicate::simulate(paper, seed);
        progress.inc(1);
        replicate
    };
    let replicates = all.into_par_iter().map(simulate).collect::<Result<_, _>>();
    progress.finish_and_clear();
    Ok(replicates?)
}

/// Every variant of an experiment on every replicate of it.
fn runs(replicates: Vec<Replicate>, settings: RunSettings) -> Result<Vec<RunSet>> {
    // one queue of all runs keeps all threads busy
    let variants = |replicate: &Replicate| replicate.paper.variants();
    let jobs: Vec<(&Replicate, Variant)> = replicates
        .iter()
        .flat_map(|own| variants(own).iter().map(move |variant| (own, *variant)))
        .collect();
    let progress = bar(jobs.len(), "runs", Work::Long);
    let run = |(replicate, variant): &(&Replicate, Variant)| {
        let run = replicate.run(*variant, settings);
        progress.inc(1);
        run
    };
    let runs: Vec<ScoredRun> = jobs.par_iter().map(run).collect::<Result<_, _>>()?;
    progress.finish_and_clear();

    // they come back in the order of the jobs
    let mut runs = runs.into_iter();
    let run_set = |replicate: Replicate| RunSet {
        runs: runs.by_ref().take(variants(&replicate).len()).collect(),
        replicate,
    };
    Ok(replicates.into_iter().map(run_set).collect())
}
