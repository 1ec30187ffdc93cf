//! A comparison as text: [`text`].

use stickslip_evaluation::Variant;
use stickslip_report::{Colour, Table, number};

use super::folder_set::{Difference, FolderSet, Overall};
use super::results::{COLUMNS, Column, Comparison, LEGEND, Over, TouchGain, VariantScores};
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
    let sets = comparison.sets.iter().map(|set| {
        format!(
            "{}: median (90th percentile){}\n{}",
            set_title(set, folders.len()),
            match seeds {
                1 => String::new(),
                seeds => format!(", of the median over {seeds} seeds"),
            },
            overall(&set.methods, Variant::name),
        )
    });
    let notes = (!folders.is_empty()).then(|| {
        let best = comparison.best_baseline.as_ref();
        let best = best.map_or_else(String::new, |best| format!("{best}\n"));
        let gain = comparison.touch_gain;
        let gain = gain.map_or_else(String::new, |gain| gain.to_string());
        format!("{LEGEND} Quantiles: {quantile}.\n{best}{gain}")
    });
    let tables = folder_tables.chain(sets).collect::<Vec<_>>().join("\n");
    format!("{tables}{}", notes.unwrap_or_default())
}

/// "20 experiments", or "the 12 of 20 experiments on which these methods ran".
pub fn set_title(set: &FolderSet, experiments: usize) -> String {
    let all = counted(experiments as u64, "experiment");
    match set.folders.len() {
        count if count == experiments => all,
        count => format!("the {count} of {all} on which all of these ran"),
    }
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
    let counts = ["unsolved", "collapses"];
    let mut table = Table::new(titles(
        ["method"],
        ["minus filter mm"].into_iter().chain(counts),
    ));
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
            row.difference.map_or_else(String::new, difference),
            row.median.unsolved.to_string(),
            row.median.collapses.to_string(),
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

/// "+0.21 ± 0.05".
fn difference(difference: Difference) -> String {
    let error = difference.standard_error_mm;
    let error = error.map_or_else(String::new, |error| format!(" ± {error:.2}"));
    format!("{:+.2}{error}", difference.median_mm)
}

fn titles<'a>(
    before: impl IntoIterator<Item = &'a str>,
    after: impl IntoIterator<Item = &'a str>,
) -> Vec<String> {
    before
        .into_iter()
        .chain(COLUMNS.iter().map(|column| column.title))
        .chain(after)
        .map(str::to_owned)
        .collect()
}
