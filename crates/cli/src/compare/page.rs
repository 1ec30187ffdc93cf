//! A comparison as a page: [`report`].

use stickslip_evaluation::Variant;
use stickslip_report::{Block, Fate, Outcome, Report, Section, Sentence, verdicts};

use super::folder_set::{FolderSet, Overall};
use super::results::{Comparison, LEGEND};
use super::tables;
use crate::origin::origin;
use crate::output::counted;

/// Definitions that the legend of the tables leaves out.
const REST: &str = "RMSE: root mean square error of the pose, angles times the radius of gyration; the paper calls it WMSE. \
    Moving: from the pusher's first contact to the object's last motion. Unsolved: steps of particles without a certified solution. \
    Collapses: rows that no particle explains. Both are sums.";

/// The table over all folders on top, then those `played` back, then each folder's.
pub fn report(comparison: &Comparison, played: Vec<Section>) -> Report {
    let Comparison {
        particles,
        seeds,
        quantile,
        folders,
        sets,
        errors,
        touch_gain,
        best_baseline,
    } = comparison;
    let gain = touch_gain.map_or_else(String::new, |gain| format!("{} ", gain.to_string().trim()));
    let note = format!(
        "{LEGEND} {REST} Quantiles: {quantile}. {gain}{}",
        Fate::rule()
    );
    let table = |set: &FolderSet| {
        let title = tables::set_title(set, folders.len());
        Block::Table(
            tables::overall(&set.methods, Variant::title),
            format!("Over {title}: median (90th percentile)"),
        )
    };
    let all = sets.iter().map(table).chain([Block::Note(note)]);
    let each = folders.iter().flat_map(|folder| {
        let table = Block::Table(
            tables::entries(&folder.methods, Variant::title),
            folder.folder.clone(),
        );
        let notes = folder.note.iter().chain(&folder.warnings);
        [table].into_iter().chain(notes.cloned().map(Block::Note))
    });
    let lost = errors.iter().map(|lost| Block::Text(lost.error.clone()));
    let sections: [(&str, Vec<Block>); 3] = [
        ("All experiments", all.collect()),
        ("Each experiment", each.collect()),
        ("Without a result", lost.collect()),
    ];
    let sections = sections
        .into_iter()
        .filter(|(_, blocks)| !blocks.is_empty());
    let mut sections: Vec<Section> = sections
        .map(|(title, blocks)| Section {
            title: title.to_owned(),
            blocks,
        })
        .collect();
    let first = sections.len().min(1);
    sections.splice(first..first, played);
    Report {
        title: "Methods compared".to_owned(),
        summary: best_baseline
            .iter()
            .map(|best| Block::Text(best.to_string()))
            .chain([
                Block::Text(runs(comparison)),
                Block::Sentences(of_all(sets.first())),
            ])
            .collect(),
        sections,
        origin: origin([
            ("particles", particles.to_string()),
            ("seeds", seeds.to_string()),
        ]),
    }
}

/// Runs behind the table over all folders.
fn runs(comparison: &Comparison) -> String {
    format!(
        "{}, all variants on each: particle filters with {} particles, {}. \
         Median pose RMSE over the experiments while the camera is off (on all rows if it never is):",
        counted(comparison.folders.len() as u64, "experiment"),
        comparison.particles,
        match comparison.seeds {
            1 => "with one seed".to_owned(),
            seeds => format!("the median of {seeds} seeds per experiment"),
        }
    )
}

/// Verdicts on the variants that ran on all experiments.
fn of_all(all: Option<&FolderSet>) -> Vec<Sentence> {
    let outcome = |row: &Overall| Outcome {
        name: row.variant.title().to_owned(),
        camera_on: row.variant.camera_on(),
        wmse_mm: row.median.wmse_mm,
    };
    let rows = all.into_iter().flat_map(|set| &set.methods);
    verdicts(&rows.map(outcome).collect::<Vec<_>>())
}
