//! The report of a reproduction as one page: [`page`].

use anyhow::Result;
use rayon::prelude::*;
use stickslip_report::{Block, Contender, Report, Section, Table};

use super::course::Heat;
use super::figures::PaperFigure;
use super::results::{PaperTable, Reproduction, Row};
use super::text::{band, blackouts, median, orders};
use crate::contest::{Rival, Rules};
use crate::episode::{contender, episode};
use crate::paper::PaperExperiment;

/// What the page begins with.
const SUMMARY: &str = "The evaluation of Zhang & Trinkle (ICRA 2012), repeated on a virtual testbed: six grasps, each with many seeds, every \
    one of which is another rig with other noise. In each grasp a thumb pushes a plate against fixed fingers (fixels); just before the first one is \
    touched the camera goes dark. Below: the paper's tables with ours beside them, its figures, and two of the grasps to be played back.";

/// Tables, figures, and the experiments B and A played back with the first seed.
pub fn page(
    reproduction: &Reproduction,
    heats: &[Heat],
    figures: &[PaperFigure],
    rules: &Rules,
) -> Result<Report> {
    let summary = vec![
        Block::Text(SUMMARY.to_owned()),
        Block::Table(
            blackouts(&reproduction.blackouts),
            "Under occlusion".to_owned(),
        ),
    ];
    let tables = reproduction.tables.iter().map(table_section);
    let figures = figures
        .iter()
        .map(|figure| Block::Figure(figure.drawing.clone(), figure.caption.clone()))
        .collect();
    let figures = Section {
        title: "Figures 2 to 7".to_owned(),
        blocks: figures,
    };
    let plays = [PaperExperiment::B, PaperExperiment::A].map(|paper| played(heats, paper, rules));
    let plays = plays.into_iter().collect::<Result<Vec<_>>>()?;
    Ok(Report {
        title: "stickslip reproduce: the paper's evaluation on a virtual testbed".to_owned(),
        summary,
        sections: plays.into_iter().chain(tables).chain([figures]).collect(),
    })
}

fn table_section(table: &PaperTable) -> Section {
    let blocks = table.rows.iter().flat_map(|row| {
        [
            Block::Table(row_table(row), row.title.to_owned()),
            Block::Note(orders(&row.orderings)),
        ]
    });
    Section {
        title: table.name.to_owned(),
        blocks: blocks.collect(),
    }
}

fn row_table(row: &Row) -> Table {
    let mut table = Table::new([
        "WMSE (mm)",
        "paper",
        "ours, median",
        "10–90 %",
        "in the dark",
        "10–90 %",
    ]);
    for cell in &row.cells {
        let [all, dark] = [cell.wmse_mm, cell.dark_mm];
        let numbers = [
            format!("{:.2}", cell.paper_mm),
            median(all),
            band(all),
            median(dark),
            band(dark),
        ];
        table.push_coloured(
            cell.participant.colour(),
            [cell.participant.name().to_owned()]
                .into_iter()
                .chain(numbers),
        );
    }
    table
}

/// An experiment's first seed with all methods.
fn played(heats: &[Heat], paper: PaperExperiment, rules: &Rules) -> Result<Section> {
    let heat = heats
        .iter()
        .find(|heat| heat.recording.paper == paper)
        .expect("every experiment was run");
    let recording = &heat.recording;
    let run = |rival: Rival| {
        contender(
            rival,
            &recording.experiment,
            recording.blackout,
            rules,
            recording.seed,
        )
    };
    let methods: Vec<Contender> = Rival::ALL.into_par_iter().map(run).collect::<Result<_>>()?;
    let (name, story) = (format!("experiment {}", paper.name()), paper.scene().story);
    let section = episode(
        &name,
        story,
        &recording.experiment,
        recording.blackout,
        methods,
    )
    .section();
    Ok(Section {
        title: format!("Experiment {}: {}", paper.name(), section.title),
        ..section
    })
}
