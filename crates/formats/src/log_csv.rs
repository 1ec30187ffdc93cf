//! `log.csv`, one recorded experiment: [`read_log`], [`write_log`], and the check of its sensors
//! and fingers
//! against the scene's: [`check_bodies`].
//!
//! The columns are found by name, in any order:
//!
//! ```text
//! time,object_x,object_y,object_theta,pusher_x,pusher_y,pusher_theta
//! [,finger_1_x,finger_1_y,finger_1_theta,...][,tactile_1,...][,pusher_force_x,pusher_force_y][,object_var_x,...]
//! ```
//!
//! An empty cell is a missing measurement.

use std::collections::BTreeSet;
use std::io::{Read, Write};

use stickslip::{Log, PoseCovariance, Rule, Setup, Unit, counted, counted_bodies};
use stickslip_dynamics::{MOST_FINGERS, Pose};

use crate::csv_error::{CsvProblem, LogError};
use crate::csv_table::{CsvTable, Row};
use crate::log_warning::LogWarning;
use crate::number;

pub(crate) const OBJECT: [&str; 3] = ["object_x", "object_y", "object_theta"];
pub(crate) const PUSHER: [&str; 3] = ["pusher_x", "pusher_y", "pusher_theta"];
/// Of the other fingers of a hand.
pub(crate) const FINGERS: [[&str; 3]; MOST_FINGERS - 1] = [
    ["finger_1_x", "finger_1_y", "finger_1_theta"],
    ["finger_2_x", "finger_2_y", "finger_2_theta"],
    ["finger_3_x", "finger_3_y", "finger_3_theta"],
];
pub(crate) const FORCE: [&str; 2] = ["pusher_force_x", "pusher_force_y"];
pub(crate) const COVARIANCE: [&str; 6] = [
    "object_var_x",
    "object_var_y",
    "object_var_theta",
    "object_cov_x_y",
    "object_cov_x_theta",
    "object_cov_y_theta",
];
pub(crate) const TACTILE: &str = "tactile_";

/// A log does not go with its scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BodiesError {
    /// More tactile sensors than the scene has fixels, or fixels and fingers of a hand.
    #[error(
        "the log has {} and the scene {}; sensor k is the k-th fixel, or behind them a finger of a hand. Add the missing [[fixel]] tables or remove the columns from tactile_{} on",
        counted(*.sensors as u64, "tactile sensor"), counted_bodies(*.fixels, *.fingers), .most + 1
    )]
    Sensors {
        /// Tactile columns of the log.
        sensors: usize,
        /// Fixels of the scene.
        fixels: usize,
        /// Fingers of the scene's pusher.
        fingers: usize,
        /// Most sensors.
        most: usize,
    },
    /// Another number of fingers.
    #[error(
        "the log has poses of {} besides the pusher and the scene {}; [[finger]] k has its pose in the columns finger_k_x, finger_k_y and finger_k_theta. Give each its own",
        counted(*.found as u64, "finger"), counted(*.fingers as u64, "[[finger]] table")
    )]
    Fingers {
        /// Fingers of the log besides the pusher.
        found: usize,
        /// `[[finger]]` tables of the scene.
        fingers: usize,
    },
}

/// Positions of a log's columns.
struct Columns {
    time: usize,
    object: [usize; 3],
    pusher: [usize; 3],
    fingers: Vec<[usize; 3]>,
    tactile: Vec<usize>,
    force: Option<[usize; 2]>,
    covariance: Option<[usize; 6]>,
}

/// Reads a log; `name` is shown in errors and warnings. A last row that was cut off while it was
/// written is left out, with a warning.
///
/// # Errors
/// A required column is missing or named twice, or there is no row. A row has a wrong number of
/// cells, a cell is no finite number, or time does not rise. A pose, force or covariance is given
/// in part, or numbers are no covariance. A tactile cell is neither 0 nor 1.
///
/// ```
/// let text = "time,object_x,object_y,object_theta,pusher_x,pusher_y,pusher_theta\n0,0.1,0,0,0,0,0\n0.03,,,,0.01,0,0\n";
/// let (log, warnings) = stickslip_formats::read_log(text.as_bytes(), "log.csv")?;
/// assert_eq!((log.len(), log.object[1], warnings.len()), (2, None, 0));
/// # Ok::<(), stickslip_formats::LogError>(())
/// ```
pub fn read_log(reader: impl Read, name: &str) -> Result<(Log, Vec<LogWarning>), LogError> {
    let table = CsvTable::read(reader, name)?;
    let columns = Columns::find(&table)?;
    let mut log = Log {
        other_fingers: vec![Vec::new(); columns.fingers.len()],
        tactile: vec![Vec::new(); columns.tactile.len()],
        ..Log::default()
    };
    let mut warnings = columns.warnings(&table);
    let mut rows = 0;
    for row in table.rows()? {
        let Err(error) = row.and_then(|row| columns.read_row(&row, &mut log)) else {
            rows += 1;
            continue;
        };
        let Some(at) = table.cut_off(&error).filter(|_| rows > 0) else {
            return Err(error);
        };
        log.truncate(rows);
        warnings.push(LogWarning::CutOff {
            file: table.file().to_owned(),
            at: at as u64,
            size: table.size() as u64,
            why: format!("the last row, in line {}, has no end", error.line),
        });
    }
    forget_empty(&mut log.object_covariance);
    Ok((log, warnings))
}

/// A column in which nothing stands is none.
pub(crate) fn forget_empty<T>(column: &mut Vec<Option<T>>) {
    if column.iter().all(Option::is_none) {
        column.clear();
    }
}

/// A covariance of six numbers in the order of the columns.
pub(crate) fn covariance([x, y, theta, x_y, x_theta, y_theta]: [f64; 6]) -> PoseCovariance {
    PoseCovariance {
        x,
        y,
        theta,
        x_y,
        x_theta,
        y_theta,
    }
}

/// The six numbers of a covariance.
pub(crate) fn covariance_numbers(covariance: &PoseCovariance) -> [f64; 6] {
    let PoseCovariance {
        x,
        y,
        theta,
        x_y,
        x_theta,
        y_theta,
    } = *covariance;
    [x, y, theta, x_y, x_theta, y_theta]
}

/// Checks that the log has the scene's fingers, and no more tactile sensors than the scene has
/// bodies for them; fewer are allowed.
///
/// # Errors
/// [`BodiesError`] with both numbers.
pub fn check_bodies(log: &Log, setup: &Setup) -> Result<(), BodiesError> {
    let scene = &setup.scene;
    let (found, fingers) = (log.other_fingers.len(), scene.pusher.fingers.len() - 1);
    if found != fingers {
        return Err(BodiesError::Fingers { found, fingers });
    }
    let (sensors, most) = (log.tactile.len(), scene.sensors());
    if sensors > most {
        return Err(BodiesError::Sensors {
            sensors,
            fixels: scene.fixels.len(),
            fingers: fingers + 1,
            most,
        });
    }
    Ok(())
}

/// Writes a log; every number reads back to the same bits.
///
/// # Errors
/// Those of `writer`.
///
/// # Panics
/// If the columns differ in length, or there are more fingers than a hand may have.
pub fn write_log(mut writer: impl Write, log: &Log) -> std::io::Result<()> {
    assert_equal_columns(log);

    writeln!(writer, "{}", header(log).join(","))?;
    (0..log.len()).try_for_each(|row| writeln!(writer, "{}", cells(log, row).join(",")))
}

/// Our own logs have columns of equal length.
pub(crate) fn assert_equal_columns(log: &Log) {
    let rows = log.len();
    assert!(
        log.object.len() == rows && log.pusher.len() == rows,
        "columns of equal length"
    );
    assert!(
        log.tactile.iter().all(|column| column.len() == rows),
        "columns of equal length"
    );
    assert!(
        log.other_fingers.iter().all(|column| column.len() == rows),
        "columns of equal length"
    );
    for optional in [log.force.len(), log.object_covariance.len()] {
        assert!(optional == 0 || optional == rows, "columns of equal length");
    }
}

impl Columns {
    fn find(table: &CsvTable) -> Result<Self, LogError> {
        Ok(Self {
            time: table.require("time")?,
            object: table.require_all(OBJECT)?,
            pusher: table.require_all(PUSHER)?,
            fingers: finger_names(|name| table.find(name).is_some())
                .iter()
                .map(|names| table.require_all(*names))
                .collect::<Result<_, _>>()?,
            tactile: tactile_columns(table)?,
            force: optional_columns(table, FORCE)?,
            covariance: optional_columns(table, COVARIANCE)?,
        })
    }

    fn read_row(&self, row: &Row<'_>, log: &mut Log) -> Result<(), LogError> {
        log.time
            .push(row.time(self.time, log.time.last().copied())?);
        log.object.push(pose(row, self.object)?);
        log.pusher.push(pose(row, self.pusher)?);
        for (poses, columns) in log.other_fingers.iter_mut().zip(&self.fingers) {
            poses.push(pose(row, *columns)?);
        }
        for (readings, column) in log.tactile.iter_mut().zip(&self.tactile) {
            readings.push(row.binary(*column)?);
        }
        if let Some(force) = self.force {
            log.force.push(row.group(&force)?.map(|f| [f[0], f[1]]));
        }
        if let Some(covariance) = self.covariance {
            log.object_covariance.push(own_covariance(row, covariance)?);
        }
        Ok(())
    }

    fn warnings(&self, table: &CsvTable) -> Vec<LogWarning> {
        let optional = self.force.iter().flatten();
        let optional = optional.chain(self.covariance.iter().flatten());
        let used: BTreeSet<usize> = self
            .object
            .iter()
            .chain(&self.pusher)
            .chain(self.fingers.as_flattened())
            .chain(&self.tactile)
            .chain(optional)
            .copied()
            .chain([self.time])
            .collect();
        let shown = |index: usize| match table.columns()[index].as_str() {
            "" => format!("(number {}, without a name)", index + 1),
            name => name.to_owned(),
        };
        let columns: Vec<String> = (0..table.columns().len())
            .filter(|index| !used.contains(index))
            .map(shown)
            .collect();
        if columns.is_empty() {
            Vec::new()
        } else {
            vec![LogWarning::ExtraColumns {
                file: table.file().to_owned(),
                columns,
            }]
        }
    }
}

/// The columns of the fingers of which one is there: up to the last such finger.
pub(crate) fn finger_names(is_there: impl Fn(&str) -> bool) -> &'static [[&'static str; 3]] {
    let last = FINGERS
        .iter()
        .rposition(|names| names.iter().any(|name| is_there(name)));
    &FINGERS[..last.map_or(0, |last| last + 1)]
}

/// The columns tactile_1 ... tactile_n; a gap in the numbers, a zero or a leading zero is an error.
fn tactile_columns(table: &CsvTable) -> Result<Vec<usize>, LogError> {
    let numbered = |name: &String| {
        name.strip_prefix(TACTILE)
            .is_some_and(|k| !k.is_empty() && k.bytes().all(|c| c.is_ascii_digit()))
    };
    let sensors: Vec<usize> = (0..table.columns().len())
        .filter(|index| numbered(&table.columns()[*index]))
        .collect();
    let names: Vec<String> = (1..=sensors.len())
        .map(|k| format!("{TACTILE}{k}"))
        .collect();
    let known: BTreeSet<&String> = names.iter().collect();
    let wrong = sensors
        .iter()
        .find(|index| !known.contains(&table.columns()[**index]));
    let in_order = names.iter().map(|name| {
        table.find(name).ok_or_else(|| {
            table.error(
                1,
                wrong.copied(),
                CsvProblem::SensorNumber {
                    missing: name.clone(),
                },
            )
        })
    });
    in_order.collect()
}

/// Columns that are all there, or none where none is.
fn optional_columns<const N: usize>(
    table: &CsvTable,
    names: [&'static str; N],
) -> Result<Option<[usize; N]>, LogError> {
    if names.iter().any(|name| table.find(name).is_some()) {
        table.require_all(names).map(Some)
    } else {
        Ok(None)
    }
}

/// Covariance of a row's pose, by its own columns.
fn own_covariance(row: &Row<'_>, columns: [usize; 6]) -> Result<Option<PoseCovariance>, LogError> {
    let numbers = row.group(&columns)?;
    let numbers = numbers.and_then(|numbers| <[f64; 6]>::try_from(numbers).ok());
    let Some(covariance) = numbers.map(covariance) else {
        return Ok(None);
    };
    match covariance.is_valid() {
        true => Ok(Some(covariance)),
        false => {
            let found = covariance_numbers(&covariance).map(number::text).join(", ");
            Err(row.error(columns[0], CsvProblem::Covariance { found }))
        }
    }
}

fn pose(row: &Row<'_>, columns: [usize; 3]) -> Result<Option<Pose>, LogError> {
    let Some(numbers) = row.group(&columns)? else {
        return Ok(None);
    };
    let units = [Unit::Metre, Unit::Metre, Unit::Radian];
    for ((column, value), unit) in columns.iter().zip(&numbers).zip(units) {
        if let Some(rule) = Rule::Finite.broken_by(*value, unit) {
            let found = format!("{} {}", number::text(*value), unit.symbol());
            return Err(row.error(*column, CsvProblem::OutOfRange { found, rule }));
        }
    }
    Ok(Some(Pose::new(numbers[0], numbers[1], numbers[2])))
}

/// The names of the columns, in the order of the file.
pub(crate) fn header(log: &Log) -> Vec<String> {
    let tactile = (1..=log.tactile.len()).map(|k| format!("{TACTILE}{k}"));
    let force = FORCE.into_iter().filter(|_| !log.force.is_empty());
    let covariance = COVARIANCE
        .into_iter()
        .filter(|_| !log.object_covariance.is_empty());
    let fingers = &FINGERS[..log.other_fingers.len()];
    let poses = ["time"].into_iter().chain(OBJECT).chain(PUSHER);
    let poses = poses.chain(fingers.as_flattened().iter().copied());
    poses
        .map(str::to_owned)
        .chain(tactile)
        .chain(force.chain(covariance).map(str::to_owned))
        .collect()
}

/// The cells of a row.
pub(crate) fn cells(log: &Log, row: usize) -> Vec<String> {
    let pose_cells = |pose: Option<Pose>| match pose {
        Some(pose) => [pose.x, pose.y, pose.theta].map(number::text),
        None => Default::default(),
    };
    let tactile = log
        .tactile
        .iter()
        .map(|column| column[row].map_or(String::new(), |touch| u8::from(touch).to_string()));
    let force = log
        .force
        .get(row)
        .map(|force| force.map_or(Default::default(), |f| f.map(number::text)));
    let covariance = log.object_covariance.get(row).map(|covariance| {
        let numbers = covariance.as_ref().map(covariance_numbers);
        numbers.map_or(Default::default(), |numbers| numbers.map(number::text))
    });
    let poses = [number::text(log.time[row])]
        .into_iter()
        .chain(pose_cells(log.object[row]))
        .chain(pose_cells(log.pusher[row]));
    let fingers = log.other_fingers.iter().map(|poses| poses[row]);
    poses
        .chain(fingers.flat_map(pose_cells))
        .chain(tactile)
        .chain(force.into_iter().flatten())
        .chain(covariance.into_iter().flatten())
        .collect()
}
