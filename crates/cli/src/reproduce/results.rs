//! The paper's tables with ours: [`Reproduction`].

use serde::Serialize;
use stickslip::{Band, Direction, PairedDifference};

use super::course::{Course, Heat};
use super::participant::{BLIND, KALMAN, NOMINAL, Participant, TACTILE};
use super::published::{PrintedRow, PrintedTable, TABLES};
use super::standing::{CLEAR, Entrant, Standing};
use crate::paper::PaperExperiment;

/// WMSE under occlusion that the particle filter is to stay below (mm).
const TARGET_MM: f64 = 0.5;

/// Median and band over seeds (mm).
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// 10 % quantile.
    pub low: f64,
    /// 90 % quantile.
    pub high: f64,
}

/// A method's number in the paper beside ours.
#[derive(Clone, Debug, Serialize)]
pub struct Cell {
    /// The method.
    #[serde(skip)]
    pub participant: Participant,
    /// Its name.
    pub method: &'static str,
    /// The paper's WMSE (mm).
    pub paper_mm: f64,
    /// Ours over all rows, as the paper's.
    pub wmse_mm: Spread,
    /// Ours over the rows after the blackout begins.
    pub dark_mm: Spread,
    /// Particle-steps without a certified solution, over all seeds.
    pub unsolved: u64,
}

/// A row of a table.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Its title.
    pub title: &'static str,
    /// Methods.
    pub cells: Vec<Cell>,
    /// The paper's order of each two of them.
    pub orderings: Vec<Standing>,
}

/// A table.
#[derive(Clone, Debug, Serialize)]
pub struct PaperTable {
    /// Its number.
    pub name: &'static str,
    /// Its rows.
    pub rows: Vec<Row>,
}

/// The particle filter with tactile data against a rival, after the blackout begins.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Margin {
    /// The rival.
    pub rival: &'static str,
    /// Its WMSE (mm).
    pub rival_mm: Spread,
    /// The particle filter's less the rival's, median over seeds (mm).
    pub difference_mm: f64,
    /// Standard error of that median (mm); null for fewer than six seeds.
    pub standard_error_mm: f64,
    /// Below the rival by more than [`CLEAR`] standard errors.
    pub better: bool,
    /// Above the rival by more than them.
    pub worse: bool,
}

/// The particle filter with tactile data after the blackout begins.
#[derive(Clone, Debug, Serialize)]
pub struct Blackout {
    /// The experiment.
    pub experiment: &'static str,
    /// Its WMSE (mm).
    pub wmse_mm: Spread,
    /// The spread that it gives itself (mm).
    pub spread_mm: Spread,
    /// Whether the median is below 0.5 mm.
    pub below_target: bool,
    /// Against the nominal simulation, the Kalman filter and the particle filter without tactile
    /// data.
    pub margins: Vec<Margin>,
}

/// All tables from one set of recordings.
#[derive(Clone, Debug, Serialize)]
pub struct Reproduction {
    /// Tables II, III and IV.
    pub tables: Vec<PaperTable>,
    /// The six experiments under occlusion.
    pub blackouts: Vec<Blackout>,
}

/// A method's medians from frames over those from poses.
#[derive(Clone, Debug, Serialize)]
pub struct Ratio {
    /// Title of the row.
    pub row: &'static str,
    /// The method.
    pub method: &'static str,
    /// WMSE over all rows.
    pub wmse: f64,
    /// WMSE over the rows after the blackout begins.
    pub dark: f64,
}

impl Ratio {
    /// Of every cell.
    pub fn all(frames: &Reproduction, poses: &Reproduction) -> Vec<Self> {
        let rows = frames.rows().zip(poses.rows());
        let cells =
            rows.flat_map(|(a, b)| a.cells.iter().zip(&b.cells).map(|(x, y)| (a.title, x, y)));
        let ratio = |(row, frames, poses): (&'static str, &Cell, &Cell)| Self {
            row,
            method: frames.method,
            wmse: frames.wmse_mm.median / poses.wmse_mm.median,
            dark: frames.dark_mm.median / poses.dark_mm.median,
        };
        cells.map(ratio).collect()
    }
}

impl Spread {
    fn of(scores: &[f64]) -> Self {
        let Band { low, median, high } = Band::of(scores).expect("there is at least one seed");
        Self { median, low, high }
    }
}

/// All runs, by experiment and method.
struct Field<'a>(&'a [Heat]);

impl Field<'_> {
    fn courses(
        &self,
        paper: PaperExperiment,
        participant: Participant,
    ) -> impl Iterator<Item = &Course> {
        let heats = self
            .0
            .iter()
            .filter(move |heat| heat.recording.paper == paper);
        heats.filter_map(move |heat| heat.course(participant))
    }

    fn scores(
        &self,
        paper: PaperExperiment,
        participant: Participant,
        of: fn(&Course) -> f64,
    ) -> Vec<f64> {
        self.courses(paper, participant).map(of).collect()
    }

    fn cell(&self, paper: PaperExperiment, participant: Participant, paper_mm: f64) -> Cell {
        let spread = |of: fn(&Course) -> f64| Spread::of(&self.scores(paper, participant, of));
        Cell {
            participant,
            method: participant.key(),
            paper_mm,
            wmse_mm: spread(|course| course.wmse_mm),
            dark_mm: spread(|course| course.dark_mm),
            unsolved: self
                .courses(paper, participant)
                .map(|course| course.unsolved)
                .sum(),
        }
    }

    fn row(&self, row: &PrintedRow) -> Row {
        let PrintedRow {
            title,
            experiment,
            cells,
        } = *row;
        let entrant = |(participant, paper_mm): &(Participant, f64)| Entrant {
            participant: *participant,
            paper_mm: *paper_mm,
            scores: self.scores(experiment, *participant, |course| course.wmse_mm),
        };
        let entrants: Vec<Entrant> = cells.iter().map(entrant).collect();
        Row {
            title,
            cells: cells
                .iter()
                .map(|(participant, paper_mm)| self.cell(experiment, *participant, *paper_mm))
                .collect(),
            orderings: Standing::all(&entrants),
        }
    }

    fn blackout(&self, paper: PaperExperiment) -> Blackout {
        let scores =
            |participant: Participant| self.scores(paper, participant, |course| course.dark_mm);
        let own = scores(TACTILE);
        let margin = |rival: Participant| {
            let theirs = scores(rival);
            let difference =
                PairedDifference::of(&own, &theirs).expect("there is at least one seed");
            let direction = difference.direction(CLEAR);
            Margin {
                rival: rival.key(),
                rival_mm: Spread::of(&theirs),
                difference_mm: difference.median,
                standard_error_mm: difference.standard_error,
                better: direction == Direction::Below,
                worse: direction == Direction::Above,
            }
        };
        let wmse_mm = Spread::of(&own);
        let margins = [NOMINAL, KALMAN, BLIND].map(margin).to_vec();
        let spreads: Vec<f64> = self
            .courses(paper, TACTILE)
            .filter_map(|course| course.spread_mm)
            .collect();
        Blackout {
            experiment: paper.name(),
            wmse_mm,
            spread_mm: Spread::of(&spreads),
            below_target: wmse_mm.median < TARGET_MM,
            margins,
        }
    }
}

impl Reproduction {
    fn rows(&self) -> impl Iterator<Item = &Row> {
        self.tables.iter().flat_map(|table| &table.rows)
    }

    /// The tables from all runs.
    pub fn new(heats: &[Heat]) -> Self {
        let field = Field(heats);
        let table = |table: &PrintedTable| PaperTable {
            name: table.name,
            rows: table.rows.iter().map(|row| field.row(row)).collect(),
        };
        Self {
            tables: TABLES.iter().map(table).collect(),
            blackouts: PaperExperiment::ALL
                .into_iter()
                .map(|paper| field.blackout(paper))
                .collect(),
        }
    }
}
