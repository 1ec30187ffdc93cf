//! `truth.csv`, the object's exact motion: [`Truth`], [`read_truth_csv`]. For scoring only, never for a filter.

use std::io::Read;

use stickslip::Trajectory;
use stickslip_dynamics::Pose;

use crate::csv_error::CsvError;
use crate::csv_table::CsvTable;

/// The object's exact motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    /// Time \[s\], strictly rising.
    pub time: Vec<f64>,
    /// Pose at each time.
    pub pose: Vec<Pose>,
}

impl Truth {
    /// The motion between the rows.
    #[must_use]
    pub fn trajectory(&self) -> Trajectory<'_> {
        Trajectory { time: &self.time, pose: &self.pose }
    }
}

/// Reads the columns time, x, y, theta; other columns are ignored. `name` is shown in errors.
///
/// # Errors
/// One of the four is missing or has an empty cell or no finite number, time does not rise, or there is no row.
pub fn read_truth_csv(reader: impl Read, name: &str) -> Result<Truth, CsvError> {
    let table = CsvTable::read(reader, name)?;
    let [time, x, y, theta] = table.require_all(["time", "x", "y", "theta"])?;
    let mut truth = Truth::default();
    for row in table.rows()? {
        let row = row?;
        truth.time.push(row.time(time, truth.time.last().copied())?);
        truth.pose.push(Pose::new(row.required(x)?, row.required(y)?, row.required(theta)?));
    }
    Ok(truth)
}
