//! A fit in words and tables.

use stickslip_fit::{CrossValidation, Fit, FittedParameter};
use stickslip_report::Table;

use super::FitResult;
use crate::output::counted;

/// Title of a result.
pub fn fitted_to(result: &FitResult) -> String {
    let of_object = result.object.as_ref().map(|name| format!(" of {name}"));
    let count = counted(result.fit.pushes as u64, "push");
    format!("Fit to {count}{}", of_object.unwrap_or_default())
}

/// The fits of several objects, a row for each.
pub fn overview(results: &[FitResult]) -> Table {
    let mut table = Table::new([
        "object",
        "pushes",
        "identified",
        "final position, nominal (mm)",
        "fitted (mm)",
        "pays",
    ]);
    for result in results {
        let identified = result.fit.parameters.iter().filter(|p| p.determined);
        let (identified, free) = (identified.count(), result.fit.parameters.len());
        let left_out = result.cross_validation.as_ref();
        let error =
            |k: usize| left_out.map_or("-".to_owned(), |v| format!("{:.2}", v.median_final_mm[k]));
        table.push([
            result.object.clone().unwrap_or_default(),
            result.fit.pushes.to_string(),
            format!("{identified} of {free}"),
            error(0),
            error(1),
            left_out
                .map_or("-", |v| if v.pays { "yes" } else { "no" })
                .to_owned(),
        ]);
    }
    table
}

/// The result as a terminal shows it.
pub fn text(result: &FitResult) -> String {
    let mut lines = vec![
        fitted_to(result),
        parameters(&result.fit).to_string(),
        remarks(result).join("\n"),
    ];
    for (_, title, validation) in validations(result) {
        lines.push(format!(
            "{}{}",
            errors(validation, title),
            coverage(validation)
        ));
    }
    lines.join("\n")
}

/// Pushes predicted by fits that have not seen them, with number and name of each kind.
pub fn validations(
    result: &FitResult,
) -> impl Iterator<Item = (usize, &'static str, &CrossValidation)> {
    let of = [
        ("pushes left out", &result.cross_validation),
        ("pushes of --test", &result.test),
    ];
    let of = of.into_iter().enumerate();
    of.filter_map(|(k, (title, validation))| Some((k, title, validation.as_ref()?)))
}

/// Remarks besides the tables.
pub fn remarks(result: &FitResult) -> Vec<String> {
    let fit = &result.fit;
    let mut remarks = Vec::new();
    if let Some([a, b, strongest]) = strongest_correlation(fit) {
        remarks.push(format!("strongest correlation: {a} with {b}, {strongest}"));
    }
    remarks.push(format!(
        "model drift {:.1} % of the pusher's path; camera noise {:.2} times that of scene.toml",
        100.0 * fit.noise.drift,
        fit.noise.camera_scale
    ));
    let warnings = result.warnings.iter();
    remarks.extend(warnings.map(|text| format!("warning: {text}")));
    if let Some(validation) = result.cross_validation.as_ref().filter(|v| !v.pays) {
        let [gain, error] = validation.gain_mm;
        remarks.push(format!(
            "the fit does not improve predictions of pushes left out (gain {gain:.2} ± {error:.2} mm); scene.toml keeps the nominal values"
        ));
    }
    if fit.sampling.unsolved > 0 {
        remarks.push(format!("unsolved steps: {}", fit.sampling.unsolved));
    }
    if result.cross_validation.is_none() {
        remarks.push("no push was left out to check the fit".to_owned());
    }
    remarks
}

pub fn parameters(fit: &Fit) -> Table {
    let mut table = Table::new([
        "parameter",
        "nominal",
        "fitted",
        "spread",
        "unit",
        "spread/prior",
        "",
        "90 %",
    ]);
    for fitted in &fit.parameters {
        let said = match (fitted.determined, fitted.learnt) {
            (true, _) => "identified",
            (false, true) => "weakly identified",
            (false, false) => "not identifiable",
        };
        table.push([
            fitted.name().to_owned(),
            digits(fitted.prior.value(0.0)),
            digits(fitted.value),
            digits(fitted.std),
            fitted.unit.clone(),
            format!("{:.2}", fitted.std_ratio),
            said.to_owned(),
            format!(
                "{} to {}",
                digits(fitted.interval_90[0]),
                digits(fitted.interval_90[1])
            ),
        ]);
    }
    table
}

/// A number with four digits after its leading zeros.
pub fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let places = 3.0 - value.abs().max(1e-9).log10().floor();
    format!("{value:.*}", places.clamp(0.0, 9.0) as usize)
}

/// The two parameters that the pushes separate least, and their correlation.
fn strongest_correlation(fit: &Fit) -> Option<[String; 3]> {
    let name = |k: usize| -> &FittedParameter { &fit.parameters[k] };
    let pairs = (0..fit.parameters.len()).flat_map(|i| (0..i).map(move |j| (j, i)));
    let strongest = pairs.max_by(|a, b| {
        let of = |(i, j): &(usize, usize)| fit.correlation[*i][*j].abs();
        of(a).total_cmp(&of(b))
    });
    strongest.map(|(i, j)| {
        let value = format!("{:.2}", fit.correlation[i][j]);
        [name(i).name().to_owned(), name(j).name().to_owned(), value]
    })
}

pub fn errors(validation: &CrossValidation, title: &str) -> Table {
    let title = format!("{title}, median");
    let mut table = Table::new([title.as_str(), "nominal", "fitted", "ratio"]);
    for (name, [unfitted, fitted]) in [
        ("final position (mm)", validation.median_final_mm),
        ("pose RMSE (mm)", validation.median_wmse_mm),
    ] {
        table.push([
            name.to_owned(),
            format!("{unfitted:.3}"),
            format!("{fitted:.3}"),
            format!("{:.2}", fitted / unfitted),
        ]);
    }
    table
}

pub fn coverage(validation: &CrossValidation) -> String {
    format!(
        "90 % intervals for the final x, y and theta cover {:.0} % ({}, {})",
        100.0 * validation.coverage_90,
        counted(validation.pushes.len() as u64, "push"),
        counted(validation.folds as u64, "fold")
    )
}

pub fn each(validation: &CrossValidation) -> Table {
    let mut table = Table::new([
        "push",
        "final position, nominal (mm)",
        "final position, fitted (mm)",
        "pose RMSE, nominal (mm)",
        "pose RMSE, fitted (mm)",
        "in the intervals",
    ]);
    for push in &validation.pushes {
        let numbers = [push.final_mm, push.wmse_mm];
        let numbers = numbers.as_flattened().iter().map(|mm| format!("{mm:.2}"));
        let inside = push.covered.iter().filter(|covered| **covered).count();
        let cells = [push.push.clone()].into_iter().chain(numbers);
        table.push(cells.chain([format!("{inside} of 3")]));
    }
    table
}
