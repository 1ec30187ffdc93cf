//! `modes.csv`, where the object may be, row by row: [`write_modes`].

use std::io::Write;

use stickslip::Estimate;
use stickslip::dynamics::Pose;

use crate::number;

const HEADER: &str = "time,mode,weight,x,y,theta,std_x,std_y,std_theta";

/// Writes the modes of every row, the likeliest of a row first, `mode` from 1 on; nothing for
/// methods without particles but the header. Every number reads back to the same bits.
///
/// ```
/// # use stickslip::{BeliefMode, Estimate, EstimateRow, dynamics::Pose};
/// let pose = Pose::new(0.1, 0.2, 0.0);
/// let std = Pose::new(1e-3, 1e-3, 0.5);
/// let row = EstimateRow { modes: vec![BeliefMode { weight: 1.0, pose, std }], ..EstimateRow::default() };
/// let estimate = Estimate { time: vec![0.5], rows: vec![row], ..Estimate::default() };
/// let mut file = Vec::new();
/// stickslip_formats::write_modes(&mut file, &estimate)?;
/// assert!(file.ends_with(b"\n0.5,1,1,0.1,0.2,0,0.001,0.001,0.5\n"));
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// Those of `writer`.
pub fn write_modes(mut writer: impl Write, estimate: &Estimate) -> std::io::Result<()> {
    writeln!(writer, "{HEADER}")?;
    for (time, row) in estimate.time.iter().zip(&estimate.rows) {
        for (mode, of_row) in (1..).zip(&row.modes) {
            let numbers = |Pose { x, y, theta }: Pose| [x, y, theta];
            let [x, y, theta] = numbers(of_row.pose).map(number::text);
            let stds = numbers(of_row.std).map(number::text).join(",");
            let (time, weight) = (number::text(*time), number::text(of_row.weight));
            writeln!(writer, "{time},{mode},{weight},{x},{y},{theta},{stds}")?;
        }
    }
    Ok(())
}
