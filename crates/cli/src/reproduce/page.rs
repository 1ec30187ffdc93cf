//! The report of a reproduction as one page: [`page`].

use anyhow::Result;
use rayon::prelude::*;
use stickslip_evaluation::Variant;
use stickslip_evaluation::paper::{
    Cell, PaperExperiment, ResultsRow, ResultsTable, RunSet, RunSettings,
};
use stickslip_report::{
    Block, Colour, Figure, Report, ReportedExperiment, Scale, Section, StripGroup, StripLane,
    StripPlot, Table,
};

use super::text::{about_occlusions, band, counts, median, occlusions, orders, touch};
use crate::origin::origin;
use crate::reported_run::reported_run;

/// Beginning of the page, before and after the description of the seeds.
const SUMMARY: [&str; 2] = [
    "The evaluation of Zhang & Trinkle (ICRA 2012), repeated on a virtual testbed: the paper's six grasps and two more, 5 and 6, ",
    ". In each grasp a thumb pushes an object against fixed fingers (fixels); the camera turns off before the object touches the first one. \
     Below: the paper's tables with our numbers, its figures, and playbacks of three grasps.",
];

/// Caption of the figure of a table.
const STRIP: &str = "A dot is a seed. Bars are the medians of the seeds.";

/// Rule by which the orders are judged.
const ORDERS: &str = "Two methods that the paper's table orders, compared seed by seed: median difference ± standard error. \
    The order holds or is reversed if the median exceeds two standard errors; fewer than six seeds have none.";

/// Tables, figures, and the experiments B, A and 5 played back with the first seed.
pub fn page(made: &super::Report, run_sets: &[RunSet], figures: &[Figure]) -> Result<Report> {
    let results = &made.tables;
    let orders = Section {
        title: "The paper's orders, and ours".to_owned(),
        blocks: vec![
            Block::Note(ORDERS.to_owned()),
            Block::Table(
                orders(results),
                "Difference of the better and the worse method, pose RMSE in mm (the paper's WMSE)"
                    .to_owned(),
            ),
        ],
    };
    let seeds = match made.seeds {
        1 => "with one seed".to_owned(),
        many => {
            format!("each with {many} seeds of rig and noise")
        }
    };
    let mut summary = vec![
        Block::Text(SUMMARY.join(&seeds)),
        Block::Table(
            occlusions(&results.occlusions),
            format!("Under occlusion: {}", about_occlusions(&results.occlusions)),
        ),
    ];
    let sentences = [touch(&results.occlusions)]
        .into_iter()
        .chain(counts(results));
    summary.extend(sentences.map(Block::Text));
    let tables = results.tables.iter().map(table_section);
    let figures = figures_section("Figures 1 to 7", figures);
    let plays = [
        PaperExperiment::B,
        PaperExperiment::A,
        PaperExperiment::Edge,
    ];
    let plays = plays.map(|paper| played(run_sets, paper, made.settings));
    let plays = plays.into_iter().collect::<Result<Vec<_>>>()?;
    Ok(Report {
        title: "stickslip reproduce: the paper's evaluation on a virtual testbed".to_owned(),
        summary,
        origin: origin([
            ("seeds", made.seeds.to_string()),
            ("particles", made.particles.to_string()),
            ("model", made.model.to_owned()),
        ]),
        sections: plays
            .into_iter()
            .chain(tables)
            .chain([orders, figures])
            .collect(),
    })
}

fn table_section(table: &ResultsTable) -> Section {
    let blocks = table
        .rows
        .iter()
        .map(|row| Block::Table(row_table(row), row.title.to_owned()));
    let strip = Block::Figure(strip(table).drawing(), STRIP.to_owned());
    Section {
        title: table.name.to_owned(),
        blocks: [strip].into_iter().chain(blocks).collect(),
    }
}

/// Our errors seed by seed, with the paper's number.
fn strip(table: &ResultsTable) -> StripPlot {
    let lane = |cell: &Cell| StripLane {
        name: cell.variant.paper_title().to_owned(),
        colour: Colour::of(cell.variant),
        values: cell.seeds_mm.clone(),
        mark: Some(cell.paper_mm),
        ..StripLane::default()
    };
    let group = |row: &ResultsRow| StripGroup {
        name: row.title.to_owned(),
        lanes: row.cells.iter().map(lane).collect(),
    };
    let label = format!("{}: errors of all seeds, method by method", table.name);
    paper_strip(label, table.rows.iter().map(group).collect())
}

/// Errors over all rows with the paper's number as a mark.
pub fn paper_strip(label: String, groups: Vec<StripGroup>) -> StripPlot {
    StripPlot {
        label,
        x_label: "pose RMSE over all rows (mm)".to_owned(),
        scale: Scale::Log { floor: 0.05 },
        level: None,
        mark_name: "paper".to_owned(),
        groups,
    }
}

/// Figures one below the other.
pub fn figures_section(title: &str, figures: &[Figure]) -> Section {
    let block = |figure: &Figure| Block::Figure(figure.drawing.clone(), figure.caption.clone());
    Section {
        title: title.to_owned(),
        blocks: figures.iter().map(block).collect(),
    }
}

fn row_table(row: &ResultsRow) -> Table {
    let mut table = Table::new([
        "pose RMSE (mm)",
        "paper",
        "ours, median",
        "10–90 %",
        "camera off",
        "10–90 %",
        "against the camera's poses",
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
        ];
        table.push_coloured(
            Colour::of(cell.variant),
            [cell.variant.paper_title().to_owned()]
                .into_iter()
                .chain(numbers),
        );
    }
    table
}

/// An experiment's first seed with all variants, played back.
fn played(run_sets: &[RunSet], paper: PaperExperiment, settings: RunSettings) -> Result<Section> {
    let mut replicates = run_sets.iter().map(|set| &set.replicate);
    let first = replicates.find(|replicate| replicate.paper == paper);
    let replicate = first.expect("every experiment was run");
    let (experiment, conditions) = (&replicate.experiment, replicate.conditions(settings));
    let runs = Variant::DRAWN
        .into_par_iter()
        .map(|variant| reported_run(variant, experiment, &conditions))
        .collect::<Result<Vec<_>, _>>()?;
    let name = format!("experiment {}", paper.name());
    let story = paper.scene().story;
    let section =
        ReportedExperiment::new(&name, story, experiment, conditions.occlusion, runs).section();
    Ok(Section {
        title: format!("Experiment {}: {}", paper.name(), section.title),
        ..section
    })
}
