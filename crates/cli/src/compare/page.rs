//! A comparison as a page: [`report`].

use stickslip_evaluation::Variant;
use stickslip_report::{Block, Fate, Outcome, Report, Section, Sentence, Table, number, verdicts};

use super::figures::{figures, short};
use super::folder_set::{FolderSet, Overall};
use super::results::{Comparison, FolderResult, LEGEND, VariantScores};
use super::tables;
use crate::origin::origin;
use crate::output::counted;

/// Definitions that the legend of the tables leaves out.
const REST: &str = "RMSE: root mean square error of the pose, angles times the radius of gyration; the paper calls it WMSE. \
    Moving: from the pusher's first contact to the object's last motion. Unsolved: steps of particles without a certified solution. \
    Collapses: rows that no particle explains. Both are sums.";

/// Logs that are listed as the first ones to look at.
const LISTED: usize = 8;

/// Figures and tables over all folders on top, then those `played` back, then each folder's.
pub fn report(comparison: &Comparison, played: Vec<(String, Section)>) -> Report {
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
    let tables = sets.iter().map(table).chain([Block::Note(note)]);
    let lost = errors.iter().map(|lost| Block::Text(lost.error.clone()));
    let section = |title: &str, blocks: Vec<Block>| Section {
        title: title.to_owned(),
        blocks,
    };
    let all = figures(comparison).into_iter().chain(tables).collect();
    let first = [
        section("All experiments", all),
        section("Look at these first", vec![worst(comparison, &played)]),
    ];
    let last = [
        section("Each experiment", folders.iter().map(each).collect()),
        section("Without a result", lost.collect()),
    ];
    let played = played.into_iter().map(|(_, section)| section);
    let mut sections: Vec<Section> = first.into_iter().chain(played).chain(last).collect();
    sections.retain(|section| !section.blocks.is_empty());
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

/// Logs with the largest errors of the particle filter; those played back are linked.
fn worst(comparison: &Comparison, played: &[(String, Section)]) -> Block {
    let mut table = Table::new([
        "log",
        "particle filter (mm)",
        "best other method (mm)",
        "which",
        "covers %",
        "collapses",
    ]);
    for folder in comparison.ranked().into_iter().take(LISTED) {
        let own = folder.scores(Variant::Particle);
        let others = folder
            .methods
            .iter()
            .filter(|other| other.variant != Variant::Particle && !other.variant.camera_on());
        let error = |other: &&VariantScores| other.scores.wmse_mm.unwrap_or(f64::INFINITY);
        let best = others.min_by(|a, b| error(a).total_cmp(&error(b)));
        let place = played.iter().find(|(path, _)| *path == folder.folder);
        table.push_linked(
            place.map(|(_, section)| format!("#{}", section.anchor())),
            [
                short(&folder.folder).to_owned(),
                number(own.and_then(|own| own.wmse_mm), 2),
                number(best.and_then(|best| best.scores.wmse_mm), 2),
                best.map_or_else(String::new, |best| best.variant.title().to_owned()),
                number(
                    own.and_then(|own| own.covered_90)
                        .map(|share| 100.0 * share),
                    0,
                ),
                own.map_or_else(String::new, |own| own.collapses.to_string()),
            ],
        );
    }
    let caption =
        "Largest pose RMSE of the particle filter first. A link leads to the log's player.";
    Block::Table(table, caption.to_owned())
}

/// The table of one folder behind its name and the particle filter's error.
fn each(folder: &FolderResult) -> Block {
    let own = folder.scores(Variant::Particle).and_then(|own| own.wmse_mm);
    let own = own.map_or_else(String::new, |mm| format!(": particle filter {mm:.2} mm"));
    let table = tables::entries(&folder.methods, Variant::title);
    let notes = folder.note.iter().chain(&folder.warnings);
    let blocks = [Block::Table(table, String::new())].into_iter();
    Block::Details(
        format!("{}{own}", folder.folder),
        blocks.chain(notes.cloned().map(Block::Note)).collect(),
    )
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
