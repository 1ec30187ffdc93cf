//! Reason why a CSV file was refused: [`CsvError`].

use std::fmt;

use crate::number;

/// A column of a CSV file, as a person finds it: counted from 1, and its name in the header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CsvColumn {
    /// Number, counted from 1.
    pub number: usize,
    /// Name in the header.
    pub name: String,
}

/// Reason why a CSV file was refused, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct CsvError {
    /// Display name of the file.
    pub file: String,
    /// Line, counted from 1 (the header is line 1).
    pub line: usize,
    /// Column; `None` where the whole line or file is meant.
    pub column: Option<CsvColumn>,
    /// The problem.
    pub problem: CsvProblem,
}

/// Reason why a log was refused.
pub type LogError = CsvError;

impl fmt::Display for CsvError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: ", self.file, self.line)?;
        if let Some(column) = &self.column {
            write!(f, "column {} ({}): ", column.number, column.name)?;
        }
        write!(f, "{}", self.problem)
    }
}

/// Problem of a CSV file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CsvProblem {
    /// Reading the bytes failed.
    #[error("the file cannot be read: {0}")]
    Unreadable(String),
    /// The bytes are not UTF-8.
    #[error("the line is not UTF-8 text. Save the file as plain text in UTF-8")]
    NotText,
    /// There is no header.
    #[error("the file is empty; its first line must name the columns")]
    Empty,
    /// There is a header and nothing else.
    #[error("the file has a header and no rows; at least one row is needed")]
    NoRows,
    /// A column that must be there is not.
    #[error(
        "the column `{column}` is missing{hint}. Name the columns in the first line, separated by commas"
    )]
    MissingColumn {
        /// Its name.
        column: String,
        /// Description of the first line instead: empty, or starts with a comma or a semicolon.
        hint: String,
    },
    /// Two columns have the same name.
    #[error(
        "the name is that of column {first} too; each column is given once. Remove or rename one of them"
    )]
    DuplicateColumn {
        /// Number of the first one.
        first: usize,
    },
    /// A column stands where another one belongs.
    #[error("the column `{expected}` belongs here. Keep the order of columns of an estimate")]
    ColumnOrder {
        /// The column that belongs here.
        expected: String,
    },
    /// A column more than the format has.
    #[error("the format has no such column after `{last}`. Remove it")]
    ColumnTooMany {
        /// The last column of the format.
        last: String,
    },
    /// A sensor column is misnumbered.
    #[error(
        "sensors are numbered tactile_1, tactile_2, ... without gaps, and `{missing}` is not there. Number the columns in the order of the [[fixel]] tables"
    )]
    SensorNumber {
        /// The first missing column.
        missing: String,
    },
    /// A number of cells that is not the header's.
    #[error(
        "the line has {found} cells, the header {expected}. Give every column a cell, an empty one where nothing was measured; numbers have a decimal point, no comma"
    )]
    CellCount {
        /// Cells in the line.
        found: usize,
        /// Columns in the header.
        expected: usize,
    },
    /// Text that is no number.
    #[error(
        "`{found}` is not a number; write digits with a decimal point, or leave the cell empty where nothing was measured"
    )]
    NotANumber {
        /// The cell.
        found: String,
    },
    /// Infinite, NaN, or too large for a number.
    #[error("`{found}` is not finite; leave the cell empty where nothing was measured")]
    NotFinite {
        /// The cell.
        found: String,
    },
    /// A number that cannot be.
    #[error("{found} cannot be; a pose must be {rule}. Leave the cells of a lost pose empty")]
    OutOfRange {
        /// The number with its unit.
        found: String,
        /// The rule.
        rule: String,
    },
    /// A covariance that is none.
    #[error(
        "the covariance {found} (variances of x, y, theta, then of x with y, x with theta, y with theta) cannot be; it must be positive definite, with standard deviations of at least 1e-9. Leave all six cells empty where it is not known"
    )]
    Covariance {
        /// Its numbers.
        found: String,
    },
    /// A cell that must be filled.
    #[error("the cell is empty; every row needs a value here")]
    EmptyCell,
    /// Neither 0 nor 1.
    #[error("`{found}` is neither 0 nor 1, the only values of this column{}", if *.may_be_empty { "; leave the cell empty where nothing was measured" } else { "" })]
    NotBinary {
        /// The cell.
        found: String,
        /// True if the column allows empty cells.
        may_be_empty: bool,
    },
    /// Not a whole number from 0 up.
    #[error("`{found}` is not a whole number from 0 up")]
    NotACount {
        /// The cell.
        found: String,
    },
    /// Time does not rise.
    #[error(
        "time {} s comes after {} s; it must rise strictly from row to row. {}",
        number::text(*.found), number::text(*.before), in_order(*.found, *.before)
    )]
    TimeNotRising {
        /// Time of this row \[s\].
        found: f64,
        /// Time of the row before \[s\].
        before: f64,
    },
    /// Some cells of one measurement are filled and others not.
    #[error(
        "the cell is empty but `{filled}` is not; a measurement is complete or absent. Fill this cell or empty all of {all}"
    )]
    Partial {
        /// A filled cell's column.
        filled: String,
        /// All columns of the measurement.
        all: String,
    },
    /// Filled in one row and empty in another although the column is one or the other as a whole.
    #[error("the cell is {}, unlike in the rows before; where feet are known all of this column is empty, else it goes with `mu_s`", if *.filled { "filled" } else { "empty" })]
    Uneven {
        /// True if this cell is filled.
        filled: bool,
    },
}

/// Advice on a time that does not rise.
fn in_order(found: f64, before: f64) -> &'static str {
    match found == before {
        true => {
            "If times lost their digits, write milliseconds at least; else remove the repeated rows"
        }
        false => "Sort the rows",
    }
}
