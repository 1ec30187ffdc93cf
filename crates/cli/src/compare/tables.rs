//! A comparison as text: [`print()`].

use super::results::{COLUMNS, Comparison, Entry, Overall};
use crate::table::{Table, number};

/// Prints a table per folder, then one over all of them.
pub fn print(comparison: &Comparison) {
    for folder in &comparison.folders {
        println!("{}", folder.folder);
        println!("{}", entries(&folder.methods));
    }
    if comparison.folders.is_empty() {
        return;
    }
    println!("median (90th percentile) over {} folders, each the median of {} seeds", comparison.folders.len(), comparison.seeds);
    print!("{}", overall(&comparison.overall));
    println!("WMSE: over hidden rows, over all where none is hidden. Quantiles: {}.", comparison.quantile);
}

/// The scores of each rival on one experiment.
pub fn entries(entries: &[Entry]) -> Table {
    let mut table = Table::default();
    table.push(titles(["method"], ["unsolved"]));
    for entry in entries {
        let scores = COLUMNS.iter().map(|column| number((column.of)(&entry.marks), 3));
        table.push([entry.rival.name().to_owned()].into_iter().chain(scores).chain([entry.marks.unsolved.to_string()]));
    }
    table
}

fn overall(rows: &[Overall]) -> Table {
    let mut table = Table::default();
    table.push(titles(["method"], ["unsolved", "folders"]));
    for row in rows {
        let both =
            |column: &super::results::Column| format!("{} ({})", number((column.of)(&row.median), 2), number((column.of)(&row.p90), 2));
        let counts = [row.unsolved.to_string(), row.folders.to_string()];
        table.push([row.rival.name().to_owned()].into_iter().chain(COLUMNS.iter().map(both)).chain(counts));
    }
    table
}

fn titles<const A: usize, const B: usize>(before: [&str; A], after: [&str; B]) -> Vec<String> {
    before.into_iter().chain(COLUMNS.iter().map(|column| column.title)).chain(after).map(str::to_owned).collect()
}
