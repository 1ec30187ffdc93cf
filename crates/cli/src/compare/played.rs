//! The experiments of a comparison that its page plays back: [`played`].

use anyhow::Result;
use rayon::prelude::*;
use stickslip::FilterModel;
use stickslip_evaluation::{RunConditions, Variant};
use stickslip_report::{Block, ReportedExperiment, Section};

use super::Folder;
use super::results::{Comparison, FolderResult};
use crate::experiment::{experiment_name, one_pusher};
use crate::log_files::log_path;
use crate::reported_run::reported_run;
use crate::since_start::since_start;

/// All of up to two experiments; of more, the one on which the particle filter fares as on the
/// median one, and the one on which it fares worst.
pub fn played(
    comparison: &Comparison,
    model: FilterModel,
    folders: &[Folder],
) -> Result<Vec<Section>> {
    let mut ranked: Vec<(&FolderResult, f64)> = comparison
        .folders
        .iter()
        .filter_map(|result| Some((result, particle_score(result)?)))
        .collect();
    ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (count, chosen) = (ranked.len(), [ranked.len().div_ceil(2), ranked.len()]);
    let chosen = ranked
        .iter()
        .enumerate()
        .filter(|(rank, _)| chosen.contains(&(rank + 1)));
    let section = |(rank, (result, _)): (usize, &(&FolderResult, f64))| {
        let path = |folder: &&Folder| folder.path.display().to_string() == result.folder;
        let folder = folders.iter().find(path).expect("a result has its folder");
        let section = section(folder, model, comparison.particles)?;
        let place = format!(
            "number {} of {count} by the particle filter's pose RMSE, seed 0",
            rank + 1
        );
        Ok(Section {
            title: format!("{}: {place}", section.title),
            ..section
        })
    };
    chosen.map(section).collect()
}

/// The particle filter's score, with the log's sensors and the camera as in the experiment.
fn particle_score(result: &FolderResult) -> Option<f64> {
    let mut methods = result.methods.iter();
    let particle = methods.find(|scores| scores.variant == Variant::Particle)?;
    particle.scores.wmse_mm
}

/// Every variant with the first seed.
fn section(folder: &Folder, model: FilterModel, particles: usize) -> Result<Section> {
    let Folder {
        experiment,
        occlusion,
        ..
    } = folder;
    one_pusher(&experiment.setup.scene, "a report")?;
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
