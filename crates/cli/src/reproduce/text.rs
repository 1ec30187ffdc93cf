//! The tables as text: [`text`].

use stickslip_evaluation::Band;
use stickslip_evaluation::paper::{
    BaselineComparison, Finding, NoiseLevel, OcclusionResult, PairedComparison, PaperExperiment,
    Ratio, Results, ResultsRow,
};
use stickslip_report::Table;

/// How differences are shown.
const LEGEND: &str = "  against others: median difference ± its standard error; * by more than 2 of them better, ! worse\n";

/// All tables, what holds of the paper's orders, and the particle filter under occlusion.
pub fn text(results: &Results) -> String {
    let tables = results.tables.iter().map(|table| {
        let rows: Vec<String> = table.rows.iter().map(row).collect();
        format!("{}, WMSE in mm\n\n{}", table.name, rows.join("\n"))
    });
    tables
        .chain([format!("{}{LEGEND}", occlusions(&results.occlusions))])
        .collect::<Vec<_>>()
        .join("\n")
}

fn row(row: &ResultsRow) -> String {
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
            [format!("  {}", cell.variant.paper_title())]
                .into_iter()
                .chain(numbers),
        );
    }
    format!("{table}{}", orders(&row.orderings))
}

/// The median of a band.
pub fn median(band: Band) -> String {
    format!("{:.2}", band.median)
}

/// The band over seeds.
pub fn band(band: Band) -> String {
    format!("{:.2}-{:.2}", band.low, band.high)
}

/// How many of the paper's orders hold, and those that do not.
pub fn orders(pairs: &[PairedComparison]) -> String {
    let holding = pairs
        .iter()
        .filter(|pair| pair.finding == Finding::Holds)
        .count();
    let others = pairs
        .iter()
        .filter(|pair| pair.finding != Finding::Holds)
        .map(order);
    let head = format!(
        "  order of the paper: {holding} of {} pairs hold\n",
        pairs.len()
    );
    [head].into_iter().chain(others).collect()
}

fn order(pair: &PairedComparison) -> String {
    let PairedComparison {
        better,
        worse,
        difference_mm,
        standard_error_mm,
        finding,
        ..
    } = pair;
    let finding = if *finding == Finding::Unclear {
        "unclear"
    } else {
        "reversed"
    };
    format!("    {better} < {worse} {finding} ({difference_mm:+.2} ± {standard_error_mm:.2})\n")
}

/// The particle filter with tactile data after the blackout begins.
pub fn occlusions(results: &[OcclusionResult]) -> Table {
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
    for result in results {
        let own = [
            median(result.wmse_mm),
            band(result.wmse_mm),
            median(result.spread_mm),
            if result.below_target { "yes" } else { "no" }.to_owned(),
        ];
        let title = format!("  {}, particle filter with tactile data", result.experiment);
        table.push(
            [title]
                .into_iter()
                .chain(own)
                .chain(result.baselines.iter().map(difference)),
        );
    }
    table
}

fn difference(against: &BaselineComparison) -> String {
    let mark = match (against.better, against.worse) {
        (true, _) => "*",
        (_, true) => "!",
        _ => " ",
    };
    format!(
        "{:+.2} ± {:.2} {mark}",
        against.difference_mm, against.standard_error_mm
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
