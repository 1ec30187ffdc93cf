//! The paper's tables as printed: [`PUBLISHED`].

use super::scenes::PaperExperiment;
use crate::variant::Variant::{
    self, Kalman, KalmanCameraOn, Nominal, Particle, ParticleCameraOn, ParticleNoTouch,
    ParticleNoTouchCameraOn,
};

/// A printed table.
#[derive(Clone, Copy, Debug)]
pub struct PublishedTable {
    /// Its number.
    pub name: &'static str,
    /// Its rows.
    pub rows: &'static [PublishedRow],
}

/// A printed row.
#[derive(Clone, Copy, Debug)]
pub struct PublishedRow {
    /// Its title.
    pub title: &'static str,
    /// The experiment.
    pub experiment: PaperExperiment,
    /// WMSE (mm) by variant, in the paper's order.
    pub cells: &'static [(Variant, f64)],
}

/// Tables II, III and IV.
pub const PUBLISHED: [PublishedTable; 3] = [
    PublishedTable {
        name: "Table II",
        rows: &[
            PublishedRow {
                title: "A, no visual occlusion",
                experiment: PaperExperiment::A,
                cells: &[
                    (Nominal, 4.8078),
                    (ParticleNoTouchCameraOn, 0.1950),
                    (KalmanCameraOn, 0.2549),
                ],
            },
            PublishedRow {
                title: "A, visual occlusion",
                experiment: PaperExperiment::A,
                cells: &[
                    (Nominal, 4.8078),
                    (ParticleNoTouch, 0.1905),
                    (Kalman, 17.7117),
                ],
            },
        ],
    },
    PublishedTable {
        name: "Table III",
        rows: &[PublishedRow {
            title: "B, slides and ends on three fixels",
            experiment: PaperExperiment::B,
            cells: &[
                (Nominal, 3.9990),
                (ParticleNoTouch, 6.7502),
                (Particle, 1.3301),
            ],
        }],
    },
    PublishedTable {
        name: "Table IV",
        rows: &[
            PublishedRow {
                title: "1, contact with a fixel and slide",
                experiment: PaperExperiment::First,
                cells: &[
                    (Nominal, 9.9906),
                    (Kalman, 40.5436),
                    (ParticleNoTouch, 14.2866),
                    (Particle, 0.3754),
                    (ParticleCameraOn, 0.4326),
                ],
            },
            PublishedRow {
                title: "2, contact with a fixel and slide",
                experiment: PaperExperiment::Second,
                cells: &[
                    (Nominal, 32.8811),
                    (Kalman, 56.0046),
                    (ParticleNoTouch, 39.6202),
                    (Particle, 2.2959),
                    (ParticleCameraOn, 0.2572),
                ],
            },
            PublishedRow {
                title: "3, contact with a fixel and stop",
                experiment: PaperExperiment::Third,
                cells: &[
                    (Nominal, 1.4412),
                    (Kalman, 4.5666),
                    (ParticleNoTouch, 0.6282),
                    (Particle, 1.3973),
                    (ParticleCameraOn, 0.3876),
                ],
            },
            PublishedRow {
                title: "4, contact with a fixel and stop",
                experiment: PaperExperiment::Fourth,
                cells: &[
                    (Nominal, 0.584),
                    (Kalman, 21.8527),
                    (ParticleNoTouch, 0.4534),
                    (Particle, 0.336),
                    (ParticleCameraOn, 0.3739),
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
    #[ignore = "needs recorded experiments"]
    fn tables_hold_the_recorded_numbers_of_the_paper() {
        let page =
            std::fs::read_to_string(data_root().unwrap().join("../paper/tables.md")).unwrap();
        let ours: Vec<f64> = PUBLISHED
            .iter()
            .flat_map(|table| table.rows)
            .flat_map(|row| row.cells)
            .map(|(_, wmse)| *wmse)
            .collect();
        assert_eq!(numbers(&page), ours);
    }
}
