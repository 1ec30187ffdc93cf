//! `truth.csv`, the object's exact motion: [`Truth`], [`read_truth_csv`], [`write_truth_csv`]. For
//! scoring only, never for a filter.

use std::io::{Read, Write};

use stickslip::Trajectory;
use stickslip_dynamics::{Pose, Twist};

use crate::csv_error::CsvError;
use crate::csv_table::{CsvTable, Row};
use crate::named_columns::{ColumnError, NamedColumns};
use crate::number;

const POSE: [&str; 4] = ["time", "x", "y", "theta"];
const TWIST: [&str; 3] = ["vx", "vy", "omega"];
const PUSHER: [&str; 3] = ["pusher_x", "pusher_y", "pusher_theta"];
const PUSHER_FORCE: &str = "force_pusher";
const FIXEL_FORCE: &str = "force_";

/// The object's exact motion; every column has one entry per row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    /// Time (s), strictly rising.
    pub time: Vec<f64>,
    /// Pose at each time.
    pub pose: Vec<Pose>,
    /// Twist at each time; empty where the file has none.
    pub twist: Vec<Twist>,
    /// The pusher's pose at each time; empty where the file has none.
    pub pusher: Vec<Pose>,
    /// Size of the pusher's force, mean over the interval that ends at the row (N); empty where the
    /// file has none.
    pub pusher_force: Vec<f64>,
    /// Normal force of each fixel, then of each other finger of a hand, a column per body, mean
    /// over the interval that ends at the row (N).
    pub fixel_forces: Vec<Vec<f64>>,
}

impl Truth {
    /// The motion between the rows.
    #[must_use]
    pub fn trajectory(&self) -> Trajectory<'_> {
        Trajectory {
            time: &self.time,
            pose: &self.pose,
        }
    }
}

/// Position of each column.
struct Columns {
    pose: [usize; 4],
    twist: Option<[usize; 3]>,
    pusher: Option<[usize; 3]>,
    pusher_force: Option<usize>,
    fixel_forces: Vec<usize>,
}

/// Reads the columns time, x, y, theta and, where they are there, vx, vy, omega, the pusher's pose
/// pusher_x, pusher_y, pusher_theta, and the forces force_pusher, force_1, ...; other columns are
/// ignored. `name` is shown in errors.
///
/// # Errors
/// One of the first four is missing, a cell of a read column is empty or no finite number, time
/// does not rise, or there is no row.
pub fn read_truth_csv(reader: impl Read, name: &str) -> Result<Truth, CsvError> {
    let table = CsvTable::read(reader, name)?;
    let columns = Columns::find(&table)?;
    let mut truth = Truth {
        fixel_forces: vec![Vec::new(); columns.fixel_forces.len()],
        ..Truth::default()
    };
    for row in table.rows()? {
        columns.read_row(&row?, &mut truth)?;
    }
    Ok(truth)
}

/// Writes the truth; every number reads back to the same bits.
///
/// # Errors
/// Those of `writer`.
///
/// # Panics
/// If columns that are not empty differ in length.
pub fn write_truth_csv(mut writer: impl Write, truth: &Truth) -> std::io::Result<()> {
    let columns = truth_columns(truth);
    assert!(
        columns
            .iter()
            .all(|(_, values)| values.len() == truth.time.len()),
        "columns of equal length"
    );
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    writeln!(writer, "{}", names.join(","))?;
    (0..truth.time.len()).try_for_each(|row| {
        let cells: Vec<String> = columns
            .iter()
            .map(|(_, values)| number::text(values[row]))
            .collect();
        writeln!(writer, "{}", cells.join(","))
    })
}

/// The columns of `truth.csv` that are not empty, with their names.
#[must_use]
pub fn truth_columns(truth: &Truth) -> Vec<(String, Vec<f64>)> {
    let Truth {
        time,
        pose,
        twist,
        pusher,
        pusher_force,
        fixel_forces,
    } = truth;
    let of_pose = |poses: &[Pose], pick: fn(&Pose) -> f64| poses.iter().map(pick).collect();
    let of_twist = |pick: fn(&Twist) -> f64| twist.iter().map(pick).collect();
    let own = [
        time.clone(),
        of_pose(pose, |p| p.x),
        of_pose(pose, |p| p.y),
        of_pose(pose, |p| p.theta),
    ];
    let twists = [
        of_twist(|v| v.vx),
        of_twist(|v| v.vy),
        of_twist(|v| v.omega),
    ];
    let pushers = [
        of_pose(pusher, |p| p.x),
        of_pose(pusher, |p| p.y),
        of_pose(pusher, |p| p.theta),
    ];
    let names = POSE
        .into_iter()
        .chain(TWIST)
        .chain(PUSHER)
        .chain([PUSHER_FORCE])
        .map(str::to_owned);
    let names = names.chain((1..=fixel_forces.len()).map(|k| format!("{FIXEL_FORCE}{k}")));
    let values = own
        .into_iter()
        .chain(twists)
        .chain(pushers)
        .chain([pusher_force.clone()])
        .chain(fixel_forces.iter().cloned());
    let required = POSE.len();
    names
        .zip(values)
        .enumerate()
        .filter(|(k, (_, values))| *k < required || !values.is_empty())
        .map(|(_, column)| column)
        .collect()
}

impl Columns {
    fn find(table: &CsvTable) -> Result<Self, CsvError> {
        let numbered = (1..).map_while(|k| table.find(&format!("{FIXEL_FORCE}{k}")));
        Ok(Self {
            pose: table.require_all(POSE)?,
            twist: find_all(table, TWIST),
            pusher: find_all(table, PUSHER),
            pusher_force: table.find(PUSHER_FORCE),
            fixel_forces: numbered.collect(),
        })
    }

    fn read_row(&self, row: &Row<'_>, truth: &mut Truth) -> Result<(), CsvError> {
        let [time, x, y, theta] = self.pose;
        truth.time.push(row.time(time, truth.time.last().copied())?);
        truth.pose.push(Pose::new(
            row.required(x)?,
            row.required(y)?,
            row.required(theta)?,
        ));
        if let Some([vx, vy, omega]) = self.twist {
            truth.twist.push(Twist {
                vx: row.required(vx)?,
                vy: row.required(vy)?,
                omega: row.required(omega)?,
            });
        }
        if let Some([x, y, theta]) = self.pusher {
            truth.pusher.push(Pose::new(
                row.required(x)?,
                row.required(y)?,
                row.required(theta)?,
            ));
        }
        if let Some(force) = self.pusher_force {
            truth.pusher_force.push(row.required(force)?);
        }
        for (forces, column) in truth.fixel_forces.iter_mut().zip(&self.fixel_forces) {
            forces.push(row.required(*column)?);
        }
        Ok(())
    }
}

/// The motion in such columns: times and poses; other columns are ignored.
///
/// # Errors
/// `time`, `x`, `y` or `theta` is missing, time does not rise, or a number is NaN or infinite.
pub fn truth_of_columns(columns: &NamedColumns<'_>) -> Result<Truth, ColumnError> {
    let time = columns.time()?;
    let [x, y, theta] = columns.require_all(["x", "y", "theta"])?.finite()?;
    let poses = x.iter().zip(y).zip(theta);
    Ok(Truth {
        time: time.to_vec(),
        pose: poses
            .map(|((x, y), theta)| Pose::new(*x, *y, *theta))
            .collect(),
        ..Truth::default()
    })
}

/// Indices of columns, where all of them are there.
fn find_all<const N: usize>(table: &CsvTable, names: [&str; N]) -> Option<[usize; N]> {
    let found: Vec<usize> = names.iter().filter_map(|name| table.find(name)).collect();
    found.try_into().ok()
}
