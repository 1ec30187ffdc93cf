//! `estimate.csv`, a filter's output, one row per log row: [`write_estimate`], [`read_estimate`].
//!
//! The columns are, in this order:
//!
//! ```text
//! time,x,y,theta,vx,vy,omega,mu_s,mu_p,mu_f,d_tri,contact_pusher,contact_1,...,
//! std_x,std_y,std_theta,std_mu_s,std_mu_p,std_mu_f,std_d_tri,ess,resampled,visual,unsolved,failed,
//! cov_x_y,cov_x_theta,cov_y_theta,collapsed,distinct,ancestors,
//! modes,mode_weight,mode_x,mode_y,mode_theta,stick_pusher,left_pusher,right_pusher,stick_1,...,
//! p_held
//! ```
//!
//! A cell is empty where the method has no value; `d_tri` and `std_d_tri` are empty throughout
//! where the feet are known.

use std::io::{Read, Write};

use stickslip::{ContactSlip, CrossCovariance, Estimate, EstimateRow, Spread};
use stickslip_dynamics::{Friction, Pose, Twist};

use crate::belief_columns;
use crate::csv_error::{CsvError, CsvProblem};
use crate::csv_table::{CsvTable, Row};
use crate::number;

const BEFORE_OTHERS: [&str; 12] = [
    "time",
    "x",
    "y",
    "theta",
    "vx",
    "vy",
    "omega",
    "mu_s",
    "mu_p",
    "mu_f",
    "d_tri",
    "contact_pusher",
];
const AFTER_OTHERS: [&str; 15] = [
    "std_x",
    "std_y",
    "std_theta",
    "std_mu_s",
    "std_mu_p",
    "std_mu_f",
    "std_d_tri",
    "ess",
    "resampled",
    "visual",
    "unsolved",
    "failed",
    "cov_x_y",
    "cov_x_theta",
    "cov_y_theta",
];

/// Columns that came later, all at the end; files of earlier versions end after this many of them.
fn later_counts(others: usize) -> [usize; 5] {
    let all = 4 + belief_columns::count(others);
    [0, 1, 4, all - 1, all]
}

/// Columns that files of every version have.
fn oldest_count(others: usize) -> usize {
    BEFORE_OTHERS.len() + others + AFTER_OTHERS.len() - 4
}

/// Column numbers; those after the other bodies' contacts count from the first one after them.
const TIME: usize = 0;
const POSE: [usize; 3] = [1, 2, 3];
const TWIST: [usize; 3] = [4, 5, 6];
const FRICTION: [usize; 3] = [7, 8, 9];
const D_TRI: usize = 10;
const CONTACT_PUSHER: usize = 11;

/// Writes an estimate; every number reads back to the same bits.
///
/// # Errors
/// Those of `writer`.
///
/// # Panics
/// If `time` and `rows` differ in length, or a row has not one contact probability per fixel and
/// other finger.
pub fn write_estimate(mut writer: impl Write, estimate: &Estimate) -> std::io::Result<()> {
    assert_eq!(estimate.time.len(), estimate.rows.len(), "one time per row");
    writeln!(writer, "{}", header(estimate.others).join(","))?;
    let columns = EstimateColumns {
        others: estimate.others,
        has_tripod: estimate.has_tripod,
    };
    for (time, row) in estimate.time.iter().zip(&estimate.rows) {
        writeln!(writer, "{}", cells(*time, row, columns).join(","))?;
    }
    Ok(())
}

/// Reads an estimate; `name` is shown in errors.
///
/// Of the modes of a belief the file has only the first one: rows that are read have none.
///
/// `has_tripod` is true unless a row has friction values and an empty `d_tri`; `d_tri` then reads
/// as 0.
///
/// # Errors
/// - The header is not that of an estimate, or there is no row.
/// - A row has a wrong number of cells, or a cell is no finite number.
/// - Time does not rise.
/// - A pose, twist or set of friction values is given in part.
pub fn read_estimate(reader: impl Read, name: &str) -> Result<Estimate, CsvError> {
    let table = CsvTable::read(reader, name)?;
    let mut estimate = Estimate {
        others: check_header(&table)?,
        has_tripod: true,
        ..Estimate::default()
    };
    let later = table.columns().len() - oldest_count(estimate.others);
    let mut tripod = None;
    for row in table.rows()? {
        let reader = RowReader {
            row: &row?,
            others: estimate.others,
            later,
        };
        estimate
            .time
            .push(reader.row.time(TIME, estimate.time.last().copied())?);
        estimate.rows.push(reader.read(&mut tripod)?);
    }
    estimate.has_tripod = tripod.unwrap_or(true);
    Ok(estimate)
}

/// Columns that an estimate has, and those that are filled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EstimateColumns {
    /// Number of fixels and other fingers.
    pub others: usize,
    /// True if d_tri is a parameter.
    pub has_tripod: bool,
}

/// The names of the columns, in the order of the file.
pub(crate) fn header(others: usize) -> Vec<String> {
    let contacts = (1..=others).map(|k| format!("contact_{k}"));
    BEFORE_OTHERS
        .map(str::to_owned)
        .into_iter()
        .chain(contacts)
        .chain(AFTER_OTHERS.map(str::to_owned))
        .chain(belief_columns::names(others))
        .collect()
}

/// The number of fixels and other fingers, if the header is that of an estimate.
fn check_header(table: &CsvTable) -> Result<usize, CsvError> {
    let is_contact = |name: &String| {
        name.strip_prefix("contact_")
            .is_some_and(|k| k.bytes().all(|c| c.is_ascii_digit()))
    };
    let others = table
        .columns()
        .iter()
        .filter(|name| is_contact(name))
        .count();
    let expected = header(others);
    // files of earlier versions end earlier
    let oldest = oldest_count(others);
    let later = table.columns().len().saturating_sub(oldest);
    let counts = later_counts(others).into_iter();
    let begun = counts.filter(|count| *count >= later).min();
    for name in &expected[..oldest + begun.unwrap_or(0)] {
        table.require(name)?;
    }
    for (index, name) in table.columns().iter().enumerate() {
        match expected.get(index) {
            Some(expected) if expected == name => {}
            Some(expected) => {
                return Err(table.error(
                    1,
                    Some(index),
                    CsvProblem::ColumnOrder {
                        expected: expected.clone(),
                    },
                ));
            }
            None => {
                let last = expected[expected.len() - 1].clone();
                return Err(table.error(1, Some(index), CsvProblem::ColumnTooMany { last }));
            }
        }
    }
    Ok(others)
}

/// The cells of a row, one per column.
pub(crate) fn cells(time: f64, row: &EstimateRow, columns: EstimateColumns) -> Vec<String> {
    assert!(
        row.contact_others
            .as_ref()
            .is_none_or(|contacts| contacts.len() == columns.others),
        "one contact probability per fixel and other finger"
    );
    let mut cells = vec![number::text(time)];
    push(&mut cells, row.pose.map(pose_numbers));
    push(
        &mut cells,
        row.twist.map(|twist| [twist.vx, twist.vy, twist.omega]),
    );
    push_friction(&mut cells, row.friction, columns.has_tripod);
    push(&mut cells, row.contact_pusher.map(|contact| [contact]));
    match &row.contact_others {
        Some(contacts) => cells.extend(contacts.iter().copied().map(number::text)),
        None => cells.extend(vec![String::new(); columns.others]),
    }
    push(
        &mut cells,
        row.spread.map(|spread| pose_numbers(spread.pose)),
    );
    push_friction(
        &mut cells,
        row.spread.and_then(|spread| spread.friction),
        columns.has_tripod,
    );
    push(&mut cells, row.ess.map(|ess| [ess]));
    cells.push(
        row.resampled
            .map_or(String::new(), |resampled| u8::from(resampled).to_string()),
    );
    cells.push(u8::from(row.visual).to_string());
    for count in [row.unsolved, row.failed] {
        cells.push(count.map_or(String::new(), |count| count.to_string()));
    }
    let cross = row.spread.and_then(|spread| spread.cross);
    push(&mut cells, cross.map(cross_numbers));
    let belief = belief_columns::numbers(row, columns.others).into_iter();
    cells.extend(belief.map(|number| number.map_or(String::new(), number::text)));
    cells
}

fn push<const N: usize>(cells: &mut Vec<String>, values: Option<[f64; N]>) {
    match values {
        Some(values) => cells.extend(values.map(number::text)),
        None => cells.extend([const { String::new() }; N]),
    }
}

fn push_friction(cells: &mut Vec<String>, friction: Option<Friction>, has_tripod: bool) {
    push(cells, friction.map(|f| [f.mu_s, f.mu_p, f.mu_f]));
    push(cells, friction.filter(|_| has_tripod).map(|f| [f.d_tri]));
}

/// In the order of the columns.
pub(crate) fn cross_numbers(cross: CrossCovariance) -> [f64; 3] {
    [cross.x_y, cross.x_theta, cross.y_theta]
}

fn pose_numbers(pose: Pose) -> [f64; 3] {
    [pose.x, pose.y, pose.theta]
}

/// One line of the file with the number of other bodies, which says where the columns after them
/// stand.
struct RowReader<'r, 't> {
    row: &'r Row<'t>,
    others: usize,
    /// Number of the columns that came later.
    later: usize,
}

impl RowReader<'_, '_> {
    /// `tripod`: whether the rows so far have a d_tri, `None` until one says.
    fn read(&self, tripod: &mut Option<bool>) -> Result<EstimateRow, CsvError> {
        let row = self.row;
        let contacts: Vec<usize> = (1..=self.others).map(|k| CONTACT_PUSHER + k).collect();
        let contact_pusher = row.number(CONTACT_PUSHER)?;
        let contact_others = if self.others == 0 {
            contact_pusher.map(|_| Vec::new())
        } else {
            row.group(&contacts)?
        };
        let mut read = EstimateRow {
            pose: self.pose(POSE)?,
            twist: row.group(&TWIST)?.map(|v| Twist {
                vx: v[0],
                vy: v[1],
                omega: v[2],
            }),
            friction: self.friction(FRICTION, D_TRI, tripod)?,
            contact_pusher,
            contact_others,
            spread: self.spread(tripod)?,
            ess: row.number(self.after(7))?,
            resampled: row.binary(self.after(8))?,
            visual: row
                .binary(self.after(9))?
                .ok_or_else(|| row.error(self.after(9), CsvProblem::EmptyCell))?,
            unsolved: row.count(self.after(10))?,
            failed: self.failed()?,
            ..EstimateRow::default()
        };
        self.belief(&mut read)?;
        Ok(read)
    }

    /// Columns that files of earlier versions do not have.
    fn belief(&self, into: &mut EstimateRow) -> Result<(), CsvError> {
        if self.later <= 4 {
            return Ok(());
        }
        into.collapsed = self.row.binary(self.after(15))?;
        into.distinct = self.row.count(self.after(16))?;
        into.ancestors = self.row.count(self.after(17))?;
        self.row.count(self.after(18))?;
        self.row
            .group(&[19, 20, 21, 22].map(|index| self.after(index)))?;
        let first = self.after(15 + belief_columns::OF_ROW.len());
        let of_bodies: Vec<usize> = (first..first + 3 * (1 + self.others)).collect();
        into.slip = self.row.group(&of_bodies)?.map(|numbers| {
            let slips = numbers.chunks(3).map(|of_body| ContactSlip {
                stick: of_body[0],
                left: of_body[1],
                right: of_body[2],
            });
            slips.collect()
        });
        let held = first + of_bodies.len();
        if self.later == later_counts(self.others)[4] {
            into.held = self.row.number(held)?;
        }
        Ok(())
    }

    /// A column that files of earlier versions do not have.
    fn failed(&self) -> Result<Option<u32>, CsvError> {
        match self.later {
            0 => Ok(None),
            _ => self.row.count(self.after(11)),
        }
    }

    /// Columns that files of earlier versions do not have.
    fn cross(&self) -> Result<Option<CrossCovariance>, CsvError> {
        if self.later < 4 {
            return Ok(None);
        }
        let numbers = self
            .row
            .group(&[12, 13, 14].map(|index| self.after(index)))?;
        Ok(numbers.map(|c| CrossCovariance {
            x_y: c[0],
            x_theta: c[1],
            y_theta: c[2],
        }))
    }

    /// Index of a column of [`AFTER_OTHERS`].
    fn after(&self, index: usize) -> usize {
        BEFORE_OTHERS.len() + self.others + index
    }

    fn pose(&self, columns: [usize; 3]) -> Result<Option<Pose>, CsvError> {
        Ok(self
            .row
            .group(&columns)?
            .map(|v| Pose::new(v[0], v[1], v[2])))
    }

    fn spread(&self, tripod: &mut Option<bool>) -> Result<Option<Spread>, CsvError> {
        let friction = self.friction(
            [3, 4, 5].map(|index| self.after(index)),
            self.after(6),
            tripod,
        )?;
        match self.pose([0, 1, 2].map(|index| self.after(index)))? {
            Some(pose) => Ok(Some(Spread {
                pose,
                cross: self.cross()?,
                friction,
            })),
            None if friction.is_none() => Ok(None),
            None => Err(self.row.error(self.after(0), CsvProblem::EmptyCell)),
        }
    }

    fn friction(
        &self,
        columns: [usize; 3],
        d_tri: usize,
        tripod: &mut Option<bool>,
    ) -> Result<Option<Friction>, CsvError> {
        let radius = self.row.number(d_tri)?;
        let Some(mu) = self.row.group(&columns)? else {
            return if radius.is_some() {
                Err(self.row.error(columns[0], CsvProblem::EmptyCell))
            } else {
                Ok(None)
            };
        };
        if *tripod.get_or_insert(radius.is_some()) != radius.is_some() {
            return Err(self.row.error(
                d_tri,
                CsvProblem::Uneven {
                    filled: radius.is_some(),
                },
            ));
        }
        Ok(Some(Friction {
            mu_s: mu[0],
            mu_p: mu[1],
            mu_f: mu[2],
            d_tri: radius.unwrap_or(0.0),
        }))
    }
}
