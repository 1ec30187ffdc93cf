//! The tables as text: [`text`].

use stickslip_evaluation::paper::{
    BaselineComparison, Difference, Finding, Measure, NoiseLevel, OcclusionResult, PaperExperiment,
    Ratio, Results, ResultsRow,
};
use stickslip_evaluation::{Band, Variant};
use stickslip_report::Table;

/// Description of the table of [`occlusions`].
pub fn about_occlusions(results: &[OcclusionResult]) -> String {
    let differences = match too_few_seeds(results) {
        true => "median difference, too few seeds for a standard error",
        false => {
            "median difference ± standard error; * better, ! worse by more than 2 standard errors"
        }
    };
    format!(
        "particle filter with touch while the camera is off, pose RMSE in mm; others: their median (ours minus theirs: {differences})"
    )
}

fn too_few_seeds(results: &[OcclusionResult]) -> bool {
    let mut baselines = results.iter().flat_map(|result| &result.baselines);
    baselines.any(|against| against.standard_error_mm.is_infinite())
}

/// All tables, the confirmed orders of the paper, and the particle filter under occlusion.
pub fn text(results: &Results) -> String {
    let tables = results.tables.iter().map(|table| {
        let rows: Vec<String> = table.rows.iter().map(row).collect();
        format!(
            "{}, pose RMSE in mm (the paper's WMSE)\n\n{}",
            table.name,
            rows.join("\n")
        )
    });
    let orders = format!("{}\n{}\n", orders(results), counts(results).join("\n"));
    tables
        .chain([
            orders,
            format!(
                "{}\n\n{}\n{}\n",
                about_occlusions(&results.occlusions),
                occlusions(&results.occlusions),
                touch(&results.occlusions)
            ),
        ])
        .collect::<Vec<_>>()
        .join("\n")
}

fn row(row: &ResultsRow) -> String {
    let mut table = Table::new([
        row.title,
        "paper",
        "all rows",
        "10-90 %",
        "occluded rows",
        "10-90 %",
        "camera's poses",
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
            median(cell.camera_mm),
            cell.unsolved.to_string(),
        ];
        table.push(
            [format!("  {}", cell.variant.paper_title())]
                .into_iter()
                .chain(numbers),
        );
    }
    table.to_string()
}

/// The median of a band.
pub fn median(band: Band) -> String {
    format!("{:.2}", band.median)
}

/// The band over seeds.
pub fn band(band: Band) -> String {
    format!("{:.2}-{:.2}", band.low, band.high)
}

/// Every order of the paper's tables, ours next to it, by every measure.
pub fn orders(results: &Results) -> Table {
    let head = ["order in the paper", "paper"].map(str::to_owned);
    let measures = Measure::ALL.map(|measure| measure.name().to_owned());
    let mut table = Table::new(head.into_iter().chain(measures));
    for (row, order) in results.orders() {
        let experiment = row.split(',').next().unwrap_or(row);
        let light = if row.contains("no visual occlusion") {
            ", camera on"
        } else {
            ""
        };
        let [better, worse] = [order.better, order.worse].map(|key| key.replace('_', " "));
        let [less, more] = order.paper_mm;
        let cells = [
            format!("{experiment}{light}: {better} < {worse}"),
            format!("{less:.2} < {more:.2}"),
        ];
        let ours = Measure::ALL.map(|measure| found(order.by(measure)));
        table.push(cells.into_iter().chain(ours));
    }
    table
}

fn found(difference: &Difference) -> String {
    let Difference {
        difference_mm,
        standard_error_mm,
        finding,
    } = difference;
    match finding {
        Finding::TooFewSeeds => format!("{difference_mm:+.2}"),
        _ => format!(
            "{difference_mm:+.2} ± {standard_error_mm:.2} {}",
            finding.name()
        ),
    }
}

/// Number of the orders that are confirmed, by every measure, in a sentence each.
pub fn counts(results: &Results) -> Vec<String> {
    let all = results.orders().count();
    let counted = |measure: Measure| {
        let of = |finding| (results.count(measure, finding), finding);
        let found = [
            Finding::Holds,
            Finding::Unclear,
            Finding::Reversed,
            Finding::TooFewSeeds,
        ];
        let found = found.map(of).into_iter().filter(|(count, _)| *count > 0);
        let found: Vec<String> = found
            .map(|(count, finding)| match finding {
                Finding::Holds => format!("{count} hold"),
                Finding::Unclear => format!("{count} are unclear"),
                Finding::Reversed => format!("{count} are reversed"),
                Finding::TooFewSeeds => format!("{count} have too few seeds"),
            })
            .collect();
        format!(
            "Of {all} orders of the paper ({}), {}.",
            measure.name(),
            found.join(", ")
        )
    };
    Measure::ALL.map(counted).into()
}

/// The particle filter with tactile data after the occlusion begins.
pub fn occlusions(results: &[OcclusionResult]) -> Table {
    let mut table = Table::new([
        "experiment",
        "median",
        "10-90 %",
        "own spread",
        "< 0.5 mm",
        "nominal",
        "Kalman",
        "without touch",
        "camera on",
    ]);
    for result in results {
        let own = [
            median(result.wmse_mm),
            band(result.wmse_mm),
            median(result.spread_mm),
            if result.below_target { "yes" } else { "no" }.to_owned(),
        ];
        table.push(
            [result.experiment.to_string()]
                .into_iter()
                .chain(own)
                .chain(result.baselines.iter().map(difference))
                .chain([median(result.camera_on_mm)]),
        );
    }
    table
}

/// Experiments in which touch makes a difference, in a sentence.
pub fn touch(results: &[OcclusionResult]) -> String {
    let no_touch = Variant::ParticleNoTouch.paper_key();
    let all = results.iter().filter_map(|result| {
        let mut baselines = result.baselines.iter();
        let without = baselines.find(|against| against.baseline == no_touch)?;
        Some((result.experiment, without))
    });
    let all: Vec<(&str, &BaselineComparison)> = all.collect();
    if too_few_seeds(results) {
        return "Too few seeds to measure the gain by touch.".to_owned();
    }
    let names = |of: fn(&BaselineComparison) -> bool| {
        let names = all.iter().filter(|(_, without)| of(without));
        names.map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
    };
    let found = [
        ("better in", names(|without| without.better)),
        ("worse in", names(|without| without.worse)),
        (
            "no clear difference in",
            names(|without| !without.better && !without.worse),
        ),
    ];
    let found = found.into_iter().filter(|(_, names)| !names.is_empty());
    let found: Vec<String> = found
        .map(|(what, names)| format!("{what} {names}"))
        .collect();
    format!(
        "With touch, compared to without, camera off: {}.",
        found.join("; ")
    )
}

fn difference(against: &BaselineComparison) -> String {
    let mark = match (against.better, against.worse) {
        (true, _) => "*",
        (_, true) => "!",
        _ => "",
    };
    let theirs = against.baseline_mm.median;
    if against.standard_error_mm.is_infinite() {
        return format!("{theirs:.2} ({:+.2})", against.difference_mm);
    }
    format!(
        "{theirs:.2} ({:+.2} ± {:.2}{mark})",
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
        "occluded rows",
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Touch against no touch: median difference, standard error.
    fn result(
        experiment: &'static str,
        [difference_mm, standard_error_mm]: [f64; 2],
    ) -> OcclusionResult {
        let [wmse_mm, spread_mm, camera_on_mm, baseline_mm] = [Band {
            low: 0.0,
            median: 0.0,
            high: 0.0,
        }; 4];
        OcclusionResult {
            experiment,
            wmse_mm,
            spread_mm,
            camera_on_mm,
            below_target: true,
            baselines: vec![BaselineComparison {
                baseline: Variant::ParticleNoTouch.paper_key(),
                baseline_mm,
                difference_mm,
                standard_error_mm,
                better: difference_mm < -2.0 * standard_error_mm,
                worse: difference_mm > 2.0 * standard_error_mm,
            }],
        }
    }

    #[test]
    fn a_sentence_says_where_touch_makes_a_difference() {
        let some = [
            result("A", [0.1, 0.1]),
            result("2", [0.3, 0.1]),
            result("5", [-9.0, 1.0]),
            result("6", [-0.5, 7.0]),
        ];
        assert_eq!(
            touch(&some),
            "With touch, compared to without, camera off: better in 5; worse in 2; no clear difference in A, 6."
        );
        assert_eq!(
            touch(&[result("A", [-9.0, f64::INFINITY])]),
            "Too few seeds to measure the gain by touch."
        );
    }
}
