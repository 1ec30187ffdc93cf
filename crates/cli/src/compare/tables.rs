//! A comparison as text: [`text`].

use stickslip_evaluation::Variant;
use stickslip_report::{Colour, Table, number};

use super::results::{
    COLUMNS, Column, Comparison, LEGEND, Over, Overall, TouchGain, VariantScores,
};
use crate::output::counted;

/// A table per folder, then one over all of them; nothing where there is no folder.
pub fn text(comparison: &Comparison) -> String {
    let Comparison {
        folders,
        seeds,
        quantile,
        ..
    } = comparison;
    let folder_tables = folders.iter().map(|folder| {
        let note = folder.note.iter().map(|note| format!("note: {note}\n"));
        let warnings = folder.warnings.iter();
        let notes = note.chain(warnings.map(|warning| format!("warning: {warning}\n")));
        let table = entries(&folder.methods, Variant::name);
        format!("{}\n{table}{}", folder.folder, notes.collect::<String>())
    });
    let overall = (!folders.is_empty()).then(|| {
        format!(
            "{}: median (90th percentile){}\n{}\n{}\
             {LEGEND} Quantiles: {quantile}.\n{}",
            counted(folders.len() as u64, "experiment"),
            match seeds {
                1 => String::new(),
                seeds => format!(", of the median over {seeds} seeds"),
            },
            overall(&comparison.overall, Variant::name),
            comparison
                .best_baseline
                .as_ref()
                .map_or_else(String::new, |best| format!("{best}\n")),
            comparison
                .touch_gain
                .map_or_else(String::new, |gain| gain.to_string())
        )
    });
    folder_tables.chain(overall).collect::<Vec<_>>().join("\n")
}

/// The scores of each variant on one experiment, by their `names`.
pub fn entries(entries: &[VariantScores], names: fn(Variant) -> &'static str) -> Table {
    let mut table = Table::new(titles(["method"], ["unsolved", "collapses"]));
    for entry in entries {
        let scores = COLUMNS
            .iter()
            .map(|column| number((column.of)(&entry.scores), 3));
        table.push_coloured(
            Colour::of(entry.variant),
            [names(entry.variant).to_owned()]
                .into_iter()
                .chain(scores)
                .chain([
                    entry.scores.unsolved.to_string(),
                    entry.scores.collapses.to_string(),
                ]),
        );
    }
    table
}

/// Each variant over all folders, by their `names`: median (90th percentile).
pub fn overall(rows: &[Overall], names: fn(Variant) -> &'static str) -> Table {
    let mut table = Table::new(titles(["method"], ["unsolved", "collapses", "folders"]));
    for row in rows {
        let both = |column: &Column| match column.over {
            Over::Quantiles => format!(
                "{} ({})",
                number((column.of)(&row.median), 2),
                number((column.of)(&row.p90), 2)
            ),
            Over::Mean => number((column.of)(&row.mean), 2),
        };
        let counts = [
            row.unsolved.to_string(),
            row.median.collapses.to_string(),
            row.folders.to_string(),
        ];
        table.push_coloured(
            Colour::of(row.variant),
            [names(row.variant).to_owned()]
                .into_iter()
                .chain(COLUMNS.iter().map(both))
                .chain(counts),
        );
    }
    table
}

impl std::fmt::Display for TouchGain {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(
            f,
            "Touch changes the CRPS by {:+.3} mm, standard error {:.3}, over {} folders.",
            self.crps_mm, self.standard_error_mm, self.folders
        )
    }
}

fn titles<const A: usize, const B: usize>(before: [&str; A], after: [&str; B]) -> Vec<String> {
    before
        .into_iter()
        .chain(COLUMNS.iter().map(|column| column.title))
        .chain(after)
        .map(str::to_owned)
        .collect()
}
