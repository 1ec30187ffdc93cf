//! The experiments of a comparison that its page plays back: [`played`].

use anyhow::Result;
use rayon::prelude::*;
use stickslip::FilterModel;
use stickslip_evaluation::{RunConditions, Variant};
use stickslip_report::{Block, ReportedExperiment, Section};

use super::Folder;
use super::results::{Comparison, FolderResult};
use crate::experiment::experiment_name;
use crate::log_files::log_path;
use crate::reported_run::reported_run;
use crate::since_start::since_start;

/// Experiments with the largest errors that are played back.
const WORST: usize = 3;

/// Those of the experiments in `folders`, by their paths: the ones on which the particle filter
/// fares worst, the worst first, and the one on which it fares as on the median one.
pub fn played(
    comparison: &Comparison,
    model: FilterModel,
    folders: &[Folder],
) -> Result<Vec<(String, Section)>> {
    let ranked = comparison.ranked();
    let count = ranked.len();
    let median = count - count.div_ceil(2);
    let chosen = ranked
        .into_iter()
        .enumerate()
        .filter(|(rank, _)| *rank < WORST || *rank == median);
    let found = chosen.filter_map(|(rank, result)| {
        let path = |folder: &&Folder| folder.path.display().to_string() == result.folder;
        Some((rank, result, folders.iter().find(path)?))
    });
    let section = |(rank, result, folder): (usize, &FolderResult, &Folder)| {
        let section = section(folder, model, comparison.particles)?;
        let place = format!(
            "number {} of {count} by the particle filter's pose RMSE, seed 0",
            count - rank
        );
        let title = format!("{}: {place}", section.title);
        Ok((result.folder.clone(), Section { title, ..section }))
    };
    found.map(section).collect()
}

/// Every variant with the first seed.
fn section(folder: &Folder, model: FilterModel, particles: usize) -> Result<Section> {
    let Folder {
        experiment,
        occlusion,
        ..
    } = folder;
    let conditions = RunConditions {
        model,
        particles,
        tracking: folder.tracking,
        occlusion: *occlusion,
        seed: 0,
    };
    let variants: Vec<Variant> = Variant::compared_on(&experiment.log, *occlusion).collect();
    let runs = variants
        .into_par_iter()
        .map(|variant| reported_run(variant, experiment, &conditions))
        .collect::<Result<Vec<_>, _>>()?;
    let name = experiment_name(&log_path(&folder.path));
    let (shown, runs, start) = since_start(experiment, runs);
    let mut section = ReportedExperiment::new(&name, "", &shown, *occlusion, runs).section();
    if let Some(start) = start {
        let note = format!("Times count from {start} s of the log's clock.");
        section.blocks.insert(0, Block::Note(note));
    }
    Ok(section)
}
