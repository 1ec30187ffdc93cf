//! The tables as text: [`text`].

use super::results::{Blackout, Margin, Reproduction, Row, Spread};
use super::standing::{Finding, Standing};
use crate::table::Table;

/// All tables, what holds of the paper's orders, and the particle filter under occlusion.
pub fn text(reproduction: &Reproduction) -> String {
    let tables = reproduction.tables.iter().map(|table| {
        let rows: Vec<String> = table.rows.iter().map(row).collect();
        format!("{}, WMSE in mm\n\n{}", table.name, rows.join("\n"))
    });
    tables.chain([blackouts(&reproduction.blackouts)]).collect::<Vec<_>>().join("\n")
}

fn row(row: &Row) -> String {
    let mut table = Table::new([row.title, "paper", "all rows", "10-90 %", "dark rows", "10-90 %", "unsolved"]);
    for cell in &row.cells {
        let [all, dark] = [cell.wmse_mm, cell.dark_mm];
        let numbers = [format!("{:.2}", cell.paper_mm), median(all), band(all), median(dark), band(dark), cell.unsolved.to_string()];
        table.push([format!("  {}", cell.participant.name())].into_iter().chain(numbers));
    }
    format!("{table}{}", orders(&row.orderings))
}

fn median(spread: Spread) -> String {
    format!("{:.2}", spread.median)
}

fn band(spread: Spread) -> String {
    format!("{:.2}-{:.2}", spread.low, spread.high)
}

/// How many of the paper's orders hold, and those that do not.
fn orders(standings: &[Standing]) -> String {
    let holding = standings.iter().filter(|standing| standing.finding == Finding::Holds).count();
    let others = standings.iter().filter(|standing| standing.finding != Finding::Holds).map(order);
    let head = format!("  order of the paper: {holding} of {} pairs hold\n", standings.len());
    [head].into_iter().chain(others).collect()
}

fn order(standing: &Standing) -> String {
    let Standing { better, worse, difference_mm, standard_error_mm, finding, why, .. } = standing;
    let finding = if *finding == Finding::Unclear { "unclear" } else { "reversed" };
    let why = why.map_or(String::new(), |why| format!(": {why}"));
    format!("    {better} < {worse} {finding} ({difference_mm:+.2} ± {standard_error_mm:.2}){why}\n")
}

fn blackouts(blackouts: &[Blackout]) -> String {
    let mut table = Table::new(["after the blackout begins, WMSE in mm", "median", "10-90 %", "< 0.5", "nominal", "Kalman", "no tactile"]);
    for blackout in blackouts {
        let own = [median(blackout.wmse_mm), band(blackout.wmse_mm), if blackout.below_target { "yes" } else { "no" }.to_owned()];
        let title = format!("  {}, particle filter with tactile data", blackout.experiment);
        table.push([title].into_iter().chain(own).chain(blackout.margins.iter().map(margin)));
    }
    format!("{table}  against others: mean difference ± its standard error; * by more than 2 of them better, ! worse\n")
}

fn margin(margin: &Margin) -> String {
    let mark = match (margin.better, margin.worse) {
        (true, _) => "*",
        (_, true) => "!",
        _ => " ",
    };
    format!("{:+.2} ± {:.2} {mark}", margin.difference_mm, margin.standard_error_mm)
}
