//! Page about fits: [`page`].

use stickslip_report::{Block, Report, Section};

use super::tables::{
    coverage, digits, each, errors, fitted_to, overview, parameters, remarks, validations,
};
use super::{FitResult, figures};
use crate::origin::origin;

/// The results as a page.
pub fn page(results: &[FitResult], seed: u64) -> Report {
    let (title, summary) = match results {
        [result] => {
            let lines = headlines(result).into_iter().chain(remarks(result));
            (fitted_to(result), lines.map(Block::Text).collect())
        }
        _ => {
            let table = Block::Table(overview(results), "Pushes left out, median".to_owned());
            (format!("Fits of {} objects", results.len()), vec![table])
        }
    };
    Report {
        title,
        summary,
        sections: results.iter().flat_map(sections).collect(),
        origin: origin([("seed", seed.to_string())]),
    }
}

/// The sections about one object.
fn sections(result: &FitResult) -> Vec<Section> {
    let of_object = result.object.as_ref().map(|name| format!("{name}: "));
    let titled = |title: String| match &of_object {
        Some(name) => format!("{name}{}", title.to_lowercase()),
        None => title,
    };
    let mut parameter_blocks = vec![
        figures::marginals(result),
        Block::Table(parameters(&result.fit), String::new()),
    ];
    parameter_blocks.extend(figures::pairs(result));
    parameter_blocks.push(figures::populations(&result.fit));
    if of_object.is_some() {
        parameter_blocks.extend(remarks(result).into_iter().map(Block::Text));
    }
    let mut sections = vec![Section {
        title: titled("Fitted parameters".to_owned()),
        blocks: parameter_blocks,
    }];
    for (_, title, validation) in validations(result) {
        sections.push(Section {
            title: titled(format!("Predictions of {title}")),
            blocks: vec![
                figures::errors(validation),
                Block::Table(
                    errors(validation, title),
                    "Median over the pushes".to_owned(),
                ),
                Block::Text(coverage(validation)),
                Block::Details(
                    "Each push".to_owned(),
                    vec![
                        figures::finals(validation),
                        Block::Table(each(validation), String::new()),
                    ],
                ),
            ],
        });
    }
    sections.extend(result.players.iter().cloned());
    sections
}

/// Most important results: values that were learnt, and their accuracy.
fn headlines(result: &FitResult) -> Vec<String> {
    let (learnt, left): (Vec<_>, Vec<_>) = result
        .fit
        .parameters
        .iter()
        .partition(|fitted| fitted.learnt);
    let mut lines: Vec<String> = learnt
        .into_iter()
        .map(|fitted| {
            let [value, std, before] = [fitted.value, fitted.std, fitted.prior_value].map(digits);
            let (name, unit) = (fitted.name(), &fitted.unit);
            format!("{name}: {value} ± {std} {unit}")
                .trim_end()
                .to_owned()
                + &format!(", nominal {before}")
        })
        .collect();
    if !left.is_empty() {
        let names: Vec<&str> = left.iter().map(|fitted| fitted.name()).collect();
        lines.push(format!(
            "not identifiable from these pushes: {}",
            names.join(", ")
        ));
    }
    if let Some(validation) = &result.cross_validation {
        let [unfitted, fitted] = validation.median_final_mm;
        lines.push(format!(
            "final position error of pushes left out: {unfitted:.2} mm with nominal values, {fitted:.2} mm with a fit to the others"
        ));
    }
    lines
}
