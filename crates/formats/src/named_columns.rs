//! Columns of numbers by name, one per row, NaN where a cell of a file would be empty:
//! [`NamedColumns`].

use crate::number;

/// Reason why columns were refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ColumnError {
    /// A column that must be there is not.
    #[error("the column `{column}` is missing; there are {}. Give it one number per row, NaN where there is none", shown(.found))]
    Missing {
        /// Its name.
        column: String,
        /// The names that are there.
        found: Vec<String>,
    },
    /// Columns differ in length.
    #[error(
        "the column `{column}` has {entries} entries and `{other}` {rows}; give every row an entry, NaN where there is none"
    )]
    Length {
        /// The column.
        column: String,
        /// Its entries.
        entries: usize,
        /// The column that it differs from, the first one.
        other: String,
        /// Entries of that one.
        rows: usize,
    },
    /// One number of a group is NaN, and another is not.
    #[error(
        "row {row}: `{column}` is NaN and `{other}` is not; give all numbers of a pose or force, or none"
    )]
    Partial {
        /// The row, from 0.
        row: usize,
        /// The column that is NaN.
        column: String,
        /// One that is not.
        other: String,
    },
    /// A reading is neither 0 nor 1.
    #[error("row {row}: `{column}` is {}; it must be 0, 1 or NaN", number::text(*.value))]
    NotBinary {
        /// The row, from 0.
        row: usize,
        /// The column.
        column: String,
        /// The value found.
        value: f64,
    },
    /// A number that must be there is NaN or infinite.
    #[error("row {row}: `{column}` is {}; it must be finite", number::text(*.value))]
    NotFinite {
        /// The row, from 0.
        row: usize,
        /// The column.
        column: String,
        /// The value found.
        value: f64,
    },
    /// Times do not rise.
    #[error(
        "row {row} is at {to} s and the row before it at {from} s; time must rise strictly from row to row"
    )]
    Order {
        /// The later row, from 0.
        row: usize,
        /// Time of the row before it (s).
        from: f64,
        /// Its time (s).
        to: f64,
    },
    /// The numbers of sensors have a gap.
    #[error(
        "there is a column `{found}` and no `{missing}`; number the sensors from 1 without gaps, sensor k on the k-th fixel"
    )]
    SensorNumber {
        /// A column that is there.
        found: String,
        /// One that is not.
        missing: String,
    },
}

fn shown(names: &[String]) -> String {
    if names.is_empty() {
        return "none".to_owned();
    }
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    quoted.join(", ")
}

/// Columns of equal length, found by name, in any order.
#[derive(Clone, Debug)]
pub struct NamedColumns<'a> {
    columns: Vec<(String, &'a [f64])>,
}

impl<'a> NamedColumns<'a> {
    /// The columns together.
    ///
    /// # Errors
    /// They differ in length.
    pub fn new(columns: Vec<(String, &'a [f64])>) -> Result<Self, ColumnError> {
        let (first, rows) = match columns.first() {
            Some((name, first)) => (name, first.len()),
            None => return Ok(Self { columns }),
        };
        match columns.iter().find(|(_, column)| column.len() != rows) {
            None => Ok(Self { columns }),
            Some((column, entries)) => Err(ColumnError::Length {
                column: column.clone(),
                entries: entries.len(),
                other: first.clone(),
                rows,
            }),
        }
    }

    /// The names, in the order given.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|(name, _)| name.as_str())
    }

    /// A column, where it is there.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&'a [f64]> {
        let found = self.columns.iter().find(|(own, _)| own == name);
        found.map(|(_, column)| *column)
    }

    pub(crate) fn require(&self, name: &str) -> Result<&'a [f64], ColumnError> {
        self.find(name).ok_or_else(|| ColumnError::Missing {
            column: name.to_owned(),
            found: self.names().map(str::to_owned).collect(),
        })
    }

    /// The column `time`, finite and strictly rising.
    pub(crate) fn time(&self) -> Result<&'a [f64], ColumnError> {
        let [time] = self.require_all(["time"])?.finite()?;
        match (1..time.len()).find(|row| time[*row] <= time[row - 1]) {
            None => Ok(time),
            Some(row) => Err(ColumnError::Order {
                row,
                from: time[row - 1],
                to: time[row],
            }),
        }
    }

    pub(crate) fn require_all<const N: usize>(
        &self,
        names: [&'static str; N],
    ) -> Result<Group<'a, N>, ColumnError> {
        let mut columns: [&'a [f64]; N] = [&[]; N];
        for (column, name) in columns.iter_mut().zip(names) {
            *column = self.require(name)?;
        }
        Ok(Group { names, columns })
    }

    /// All of them, or none where none is there.
    pub(crate) fn find_all<const N: usize>(
        &self,
        names: [&'static str; N],
    ) -> Result<Option<Group<'a, N>>, ColumnError> {
        if names.iter().any(|name| self.find(name).is_some()) {
            self.require_all(names).map(Some)
        } else {
            Ok(None)
        }
    }

    /// The numbers of a group in one row; `None` where all are NaN.
    pub(crate) fn group<const N: usize>(
        &self,
        group: Group<'a, N>,
        row: usize,
    ) -> Result<Option<[f64; N]>, ColumnError> {
        let values = group.columns.map(|column| column[row]);
        let missing = values.iter().position(|value| value.is_nan());
        let given = values.iter().position(|value| !value.is_nan());
        match (missing, given) {
            (None, _) => match values.iter().position(|value| value.is_infinite()) {
                None => Ok(Some(values)),
                Some(infinite) => Err(ColumnError::NotFinite {
                    row,
                    column: group.names[infinite].to_owned(),
                    value: values[infinite],
                }),
            },
            (Some(_), None) => Ok(None),
            (Some(missing), Some(given)) => Err(ColumnError::Partial {
                row,
                column: group.names[missing].to_owned(),
                other: group.names[given].to_owned(),
            }),
        }
    }
}

/// Columns that say one thing together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Group<'a, const N: usize> {
    names: [&'static str; N],
    columns: [&'a [f64]; N],
}

impl<'a, const N: usize> Group<'a, N> {
    /// The columns, where all their numbers are finite.
    pub(crate) fn finite(self) -> Result<[&'a [f64]; N], ColumnError> {
        for (name, column) in self.names.iter().zip(self.columns) {
            if let Some(row) = column.iter().position(|value| !value.is_finite()) {
                return Err(ColumnError::NotFinite {
                    row,
                    column: (*name).to_owned(),
                    value: column[row],
                });
            }
        }
        Ok(self.columns)
    }
}
