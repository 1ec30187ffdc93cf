//! The tables as text: [`text`].

use stickslip_report::Table;

use super::noise::NoiseLevel;
use super::results::{Blackout, Margin, Ratio, Reproduction, Row, Spread};
use super::standing::{Finding, Standing};
use crate::paper::PaperExperiment;

/// How differences are told.
const LEGEND: &str = "  against others: median difference ± its standard error; * by more than 2 of them better, ! worse\n";

/// All tables, what holds of the paper's orders, and the particle filter under occlusion.
pub fn text(reproduction: &Reproduction) -> String {
    let tables = reproduction.tables.iter().map(|table| {
        let rows: Vec<String> = table.rows.iter().map(row).collect();
        format!("{}, WMSE in mm\n\n{}", table.name, rows.join("\n"))
    });
    tables
        .chain([format!("{}{LEGEND}", blackouts(&reproduction.blackouts))])
        .collect::<Vec<_>>()
        .join("\n")
}

fn row(row: &Row) -> String {
    let mut table = Table::new([
        row.title,
        "paper",
        "all rows",
        "10-90 %",
        "dark rows",
        "10-90 %",
        "unsolved",
    ]);
    for cell in &row.cells {
        let [all, dark] = [cell.wmse_mm, cell.dark_mm];
        let numbers = [
            format!("{:.2}", cell.paper_mm),
            median(all),
            band(all),
            median(dark),
            band(dark),
            cell.unsolved.to_string(),
        ];
        table.push(
            [format!("  {}", cell.participant.name())]
                .into_iter()
                .chain(numbers),
        );
    }
    format!("{table}{}", orders(&row.orderings))
}

/// The median of a spread.
pub fn median(spread: Spread) -> String {
    format!("{:.2}", spread.median)
}

/// Its band.
pub fn band(spread: Spread) -> String {
    format!("{:.2}-{:.2}", spread.low, spread.high)
}

/// How many of the paper's orders hold, and those that do not.
pub fn orders(standings: &[Standing]) -> String {
    let holding = standings
        .iter()
        .filter(|standing| standing.finding == Finding::Holds)
        .count();
    let others = standings
        .iter()
        .filter(|standing| standing.finding != Finding::Holds)
        .map(order);
    let head = format!(
        "  order of the paper: {holding} of {} pairs hold\n",
        standings.len()
    );
    [head].into_iter().chain(others).collect()
}

fn order(standing: &Standing) -> String {
    let Standing {
        better,
        worse,
        difference_mm,
        standard_error_mm,
        finding,
        ..
    } = standing;
    let finding = if *finding == Finding::Unclear {
        "unclear"
    } else {
        "reversed"
    };
    format!("    {better} < {worse} {finding} ({difference_mm:+.2} ± {standard_error_mm:.2})\n")
}

/// The particle filter with tactile data after the blackout begins.
pub fn blackouts(blackouts: &[Blackout]) -> Table {
    let mut table = Table::new([
        "after the blackout begins, WMSE in mm",
        "median",
        "10-90 %",
        "own spread",
        "< 0.5",
        "nominal",
        "Kalman",
        "no tactile",
    ]);
    for blackout in blackouts {
        let own = [
            median(blackout.wmse_mm),
            band(blackout.wmse_mm),
            median(blackout.spread_mm),
            if blackout.below_target { "yes" } else { "no" }.to_owned(),
        ];
        let title = format!(
            "  {}, particle filter with tactile data",
            blackout.experiment
        );
        table.push(
            [title]
                .into_iter()
                .chain(own)
                .chain(blackout.margins.iter().map(margin)),
        );
    }
    table
}

fn margin(margin: &Margin) -> String {
    let mark = match (margin.better, margin.worse) {
        (true, _) => "*",
        (_, true) => "!",
        _ => " ",
    };
    format!(
        "{:+.2} ± {:.2} {mark}",
        margin.difference_mm, margin.standard_error_mm
    )
}

/// The noise of tracked poses.
pub fn noise(levels: &[NoiseLevel]) -> String {
    let mut table = Table::new([
        "noise of tracked poses (rms)",
        "object mm",
        "object deg",
        "pusher mm",
        "pusher deg",
        "frames with the object",
    ]);
    for (paper, level) in PaperExperiment::ALL.into_iter().zip(levels) {
        let NoiseLevel {
            object_mm,
            object_deg,
            pusher_mm,
            pusher_deg,
            seen,
        } = level;
        let numbers =
            [object_mm, object_deg, pusher_mm, pusher_deg].map(|number| format!("{number:.4}"));
        table.push(
            [format!("  {}", paper.name())]
                .into_iter()
                .chain(numbers)
                .chain([format!("{:.1} %", 100.0 * seen)]),
        );
    }
    table.to_string()
}

/// Medians from frames over those from poses.
pub fn ratios(ratios: &[Ratio]) -> String {
    let mut table = Table::new([
        "medians from frames over those from poses",
        "method",
        "all rows",
        "dark rows",
    ]);
    for Ratio {
        row,
        method,
        wmse,
        dark,
    } in ratios
    {
        table.push([
            format!("  {row}"),
            (*method).to_owned(),
            format!("{wmse:.2}"),
            format!("{dark:.2}"),
        ]);
    }
    table.to_string()
}
