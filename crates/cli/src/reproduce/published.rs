//! The paper's tables as printed: [`TABLES`].

use super::participant::{
    BLIND, BLIND_OPEN, KALMAN, KALMAN_OPEN, NOMINAL, Participant, TACTILE, TACTILE_OPEN,
};
use crate::paper::PaperExperiment;

/// A printed table.
#[derive(Clone, Copy, Debug)]
pub struct PrintedTable {
    /// Its number.
    pub name: &'static str,
    /// Its rows.
    pub rows: &'static [PrintedRow],
}

/// A printed row.
#[derive(Clone, Copy, Debug)]
pub struct PrintedRow {
    /// Its title.
    pub title: &'static str,
    /// The experiment.
    pub experiment: PaperExperiment,
    /// WMSE (mm) by method, in the paper's order.
    pub cells: &'static [(Participant, f64)],
}

/// Tables II, III and IV.
pub const TABLES: [PrintedTable; 3] = [
    PrintedTable {
        name: "Table II",
        rows: &[
            PrintedRow {
                title: "A, no visual occlusion",
                experiment: PaperExperiment::A,
                cells: &[
                    (NOMINAL, 4.8078),
                    (BLIND_OPEN, 0.1950),
                    (KALMAN_OPEN, 0.2549),
                ],
            },
            PrintedRow {
                title: "A, visual occlusion",
                experiment: PaperExperiment::A,
                cells: &[(NOMINAL, 4.8078), (BLIND, 0.1905), (KALMAN, 17.7117)],
            },
        ],
    },
    PrintedTable {
        name: "Table III",
        rows: &[PrintedRow {
            title: "B, slides and ends on three fixels",
            experiment: PaperExperiment::B,
            cells: &[(NOMINAL, 3.9990), (BLIND, 6.7502), (TACTILE, 1.3301)],
        }],
    },
    PrintedTable {
        name: "Table IV",
        rows: &[
            PrintedRow {
                title: "1, contact with a fixel and slide",
                experiment: PaperExperiment::First,
                cells: &[
                    (NOMINAL, 9.9906),
                    (KALMAN, 40.5436),
                    (BLIND, 14.2866),
                    (TACTILE, 0.3754),
                    (TACTILE_OPEN, 0.4326),
                ],
            },
            PrintedRow {
                title: "2, contact with a fixel and slide",
                experiment: PaperExperiment::Second,
                cells: &[
                    (NOMINAL, 32.8811),
                    (KALMAN, 56.0046),
                    (BLIND, 39.6202),
                    (TACTILE, 2.2959),
                    (TACTILE_OPEN, 0.2572),
                ],
            },
            PrintedRow {
                title: "3, contact with a fixel and stop",
                experiment: PaperExperiment::Third,
                cells: &[
                    (NOMINAL, 1.4412),
                    (KALMAN, 4.5666),
                    (BLIND, 0.6282),
                    (TACTILE, 1.3973),
                    (TACTILE_OPEN, 0.3876),
                ],
            },
            PrintedRow {
                title: "4, contact with a fixel and stop",
                experiment: PaperExperiment::Fourth,
                cells: &[
                    (NOMINAL, 0.584),
                    (KALMAN, 21.8527),
                    (BLIND, 0.4534),
                    (TACTILE, 0.336),
                    (TACTILE_OPEN, 0.3739),
                ],
            },
        ],
    },
];

#[cfg(test)]
mod tests {
    use stickslip_testkit::data_root;

    use super::*;

    /// Every number of a page of Markdown tables, in order, but for those in its first column and
    /// its prose.
    fn numbers(page: &str) -> Vec<f64> {
        let rows = page.lines().filter(|line| line.starts_with('|'));
        let cells = rows.flat_map(|line| {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            // a row without a title has numbers from the first cell on
            let skip = usize::from(cells[0].parse::<f64>().is_err());
            cells[skip..]
                .iter()
                .filter_map(|cell| cell.parse().ok())
                .collect::<Vec<f64>>()
        });
        cells.collect()
    }

    #[test]
    #[cfg_attr(not(stickslip_data), ignore = "no recorded data: set STICKSLIP_DATA")]
    fn tables_hold_the_numbers_of_the_paper() {
        let page =
            std::fs::read_to_string(data_root().unwrap().join("../paper/tables.md")).unwrap();
        let ours: Vec<f64> = TABLES
            .iter()
            .flat_map(|table| table.rows)
            .flat_map(|row| row.cells)
            .map(|(_, wmse)| *wmse)
            .collect();
        assert_eq!(numbers(&page), ours);
    }
}
