//! A CSV file as a header and rows of cells: [`CsvTable`], [`Row`].
//!
//! Comma-separated, one record per line (`\n` or `\r\n`), a byte-order mark is skipped, cells may
//! stand in double quotes and be padded with blanks, blank lines only at the end. Lines and columns
//! are counted from 1 in errors, columns from 0 in code.

use std::collections::HashMap;
use std::io::Read;

use crate::csv_error::{CsvColumn, CsvError, CsvProblem};
use crate::nearest::nearest;

/// The text of a CSV file with its header taken apart.
pub(crate) struct CsvTable {
    file: String,
    text: String,
    columns: Vec<String>,
    /// Index of the first column of each name.
    places: HashMap<String, usize>,
}

/// One line below the header, with as many cells as the header.
pub(crate) struct Row<'t> {
    table: &'t CsvTable,
    line: usize,
    cells: Vec<String>,
}

impl CsvTable {
    /// Reads all of `reader` and its header; `file` is the name to show in errors.
    ///
    /// # Errors
    /// The bytes cannot be read, are not UTF-8, hold no header, or name a column twice.
    pub(crate) fn read(reader: impl Read, file: &str) -> Result<Self, CsvError> {
        let text = read_text(reader).map_err(|(line, problem)| CsvError {
            file: file.to_owned(),
            line,
            column: None,
            problem,
        })?;
        let mut table = Self {
            file: file.to_owned(),
            text,
            columns: Vec::new(),
            places: HashMap::new(),
        };
        let header = table.lines().next().map(|(_, header)| split(header));
        table.columns = header.ok_or_else(|| table.error(1, None, CsvProblem::Empty))?;
        for (index, name) in table.columns.iter().enumerate() {
            table.places.entry(name.clone()).or_insert(index);
        }
        table.check_unique()?;
        Ok(table)
    }

    /// Names of the columns.
    pub(crate) fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Display name of the file.
    pub(crate) fn file(&self) -> &str {
        &self.file
    }

    /// The rows below the header; a row with a wrong number of cells is an error.
    ///
    /// # Errors
    /// [`CsvProblem::NoRows`] if there is none.
    pub(crate) fn rows(&self) -> Result<impl Iterator<Item = Result<Row<'_>, CsvError>>, CsvError> {
        if self.lines().nth(1).is_none() {
            return Err(self.error(1, None, CsvProblem::NoRows));
        }
        Ok(self
            .lines()
            .skip(1)
            .map(|(line, text)| self.row(line, text)))
    }

    /// Index of a column.
    pub(crate) fn find(&self, column: &str) -> Option<usize> {
        self.places.get(column).copied()
    }

    /// Index of a column that must be there.
    pub(crate) fn require(&self, column: &str) -> Result<usize, CsvError> {
        self.find(column).ok_or_else(|| {
            let problem = CsvProblem::MissingColumn {
                column: column.to_owned(),
                hint: self.missing_hint(column),
            };
            self.error(1, None, problem)
        })
    }

    /// Indices of columns that must be there.
    pub(crate) fn require_all<const N: usize>(
        &self,
        columns: [&str; N],
    ) -> Result<[usize; N], CsvError> {
        let mut indices = [0; N];
        for (index, column) in indices.iter_mut().zip(columns) {
            *index = self.require(column)?;
        }
        Ok(indices)
    }

    /// An error at a line (from 1) and a column (index, from 0).
    pub(crate) fn error(
        &self,
        line: usize,
        column: Option<usize>,
        problem: CsvProblem,
    ) -> CsvError {
        let column = column.map(|index| CsvColumn {
            number: index + 1,
            name: self.columns[index].clone(),
        });
        CsvError {
            file: self.file.clone(),
            line,
            column,
            problem,
        }
    }

    /// Bytes before the line of `error` if this is the last one and was cut off while it was
    /// written: it has no end, and cells are missing or the last one cannot be read.
    pub(crate) fn cut_off(&self, error: &CsvError) -> Option<usize> {
        let start = self.text.rfind('\n')? + 1;
        let is_last = self.text[..start].matches('\n').count() + 1 == error.line;
        let is_short = match &error.problem {
            CsvProblem::CellCount { found, expected } => found < expected,
            _ => {
                let column = error.column.as_ref();
                column.is_some_and(|column| column.number == self.columns.len())
            }
        };
        (is_last && is_short && !self.text.ends_with('\n')).then_some(start)
    }

    /// Bytes of the text.
    pub(crate) fn size(&self) -> usize {
        self.text.len()
    }

    /// Numbered lines up to the last one that is not blank.
    fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        let text = self.text.trim_end();
        let lines = text
            .split('\n')
            .map(|line| line.strip_suffix('\r').unwrap_or(line));
        (1..)
            .zip(lines)
            .take(if text.is_empty() { 0 } else { usize::MAX })
    }

    fn row<'t>(&'t self, line: usize, text: &str) -> Result<Row<'t>, CsvError> {
        let cells = split(text);
        let (found, expected) = (
            if text.trim().is_empty() {
                0
            } else {
                cells.len()
            },
            self.columns.len(),
        );
        if found != expected {
            return Err(self.error(line, None, CsvProblem::CellCount { found, expected }));
        }
        Ok(Row {
            table: self,
            line,
            cells,
        })
    }

    fn check_unique(&self) -> Result<(), CsvError> {
        if self.number_for_name().is_some() {
            return Ok(());
        }
        for (index, name) in self.columns.iter().enumerate() {
            if let Some(first) = self
                .find(name)
                .filter(|first| *first < index && !name.is_empty())
            {
                return Err(self.error(
                    1,
                    Some(index),
                    CsvProblem::DuplicateColumn { first: first + 1 },
                ));
            }
        }
        Ok(())
    }

    /// The first of the header's cells where all that are filled are numbers: no header then, but a
    /// row.
    fn number_for_name(&self) -> Option<&str> {
        let mut filled = self.columns.iter().filter(|name| !name.is_empty());
        let first = filled.next()?;
        let are_numbers = is_number(first) && filled.all(|name| is_number(name));
        are_numbers.then_some(first)
    }

    /// Mistake that a person may have made instead of naming `column`.
    fn missing_hint(&self, column: &str) -> String {
        if let Some(number) = self.number_for_name() {
            return format!("; the first line has numbers for names, `{number}` to begin with");
        }
        if self.columns[0].starts_with('#') {
            return "; the first line is a comment, which the format has not".to_owned();
        }
        if let [only] = self.columns.as_slice()
            && let Some(separator) = only.chars().find(|c| matches!(c, ';' | '\t'))
        {
            return format!("; the header is separated by {separator:?}");
        }
        match nearest(column, self.columns.iter().map(String::as_str)) {
            Some((name, distance)) if distance <= column.len() / 2 && !name.is_empty() => {
                format!(", the nearest in the header is `{name}`")
            }
            _ => String::new(),
        }
    }
}

impl Row<'_> {
    /// The number in a cell, `None` where it is empty.
    pub(crate) fn number(&self, column: usize) -> Result<Option<f64>, CsvError> {
        let found = &self.cells[column];
        if found.is_empty() {
            return Ok(None);
        }
        let value: f64 = found.parse().map_err(|_| {
            self.error(
                column,
                CsvProblem::NotANumber {
                    found: found.clone(),
                },
            )
        })?;
        if !value.is_finite() {
            return Err(self.error(
                column,
                CsvProblem::NotFinite {
                    found: found.clone(),
                },
            ));
        }
        Ok(Some(value))
    }

    /// The number in a cell that must be filled.
    pub(crate) fn required(&self, column: usize) -> Result<f64, CsvError> {
        self.number(column)?
            .ok_or_else(|| self.error(column, CsvProblem::EmptyCell))
    }

    /// The numbers of one measurement: all of its cells are filled or, for `None`, all are empty.
    pub(crate) fn group(&self, columns: &[usize]) -> Result<Option<Vec<f64>>, CsvError> {
        let Some(filled) = columns
            .iter()
            .find(|&&column| !self.cells[column].is_empty())
        else {
            return Ok(None);
        };
        let value = |column: usize| {
            let name = |column: &usize| self.table.columns[*column].clone();
            let all = || columns.iter().map(name).collect::<Vec<_>>().join(", ");
            self.number(column)?.ok_or_else(|| {
                self.error(
                    column,
                    CsvProblem::Partial {
                        filled: name(filled),
                        all: all(),
                    },
                )
            })
        };
        columns
            .iter()
            .map(|column| value(*column))
            .collect::<Result<Vec<f64>, _>>()
            .map(Some)
    }

    /// A cell that is 0, 1 or empty; 0.0 and 1.0 count as such, since table programs write them.
    pub(crate) fn binary(&self, column: usize) -> Result<Option<bool>, CsvError> {
        let wrong = || {
            self.error(
                column,
                CsvProblem::NotBinary {
                    found: self.cells[column].clone(),
                    may_be_empty: true,
                },
            )
        };
        match self.number(column).map_err(|_| wrong())? {
            None => Ok(None),
            Some(0.0) => Ok(Some(false)),
            Some(1.0) => Ok(Some(true)),
            Some(_) => Err(wrong()),
        }
    }

    /// The text in a cell that must be filled.
    pub(crate) fn text(&self, column: usize) -> Result<&str, CsvError> {
        let found = self.cells[column].as_str();
        if found.is_empty() {
            Err(self.error(column, CsvProblem::EmptyCell))
        } else {
            Ok(found)
        }
    }

    /// A whole number from 0 up, or empty.
    pub(crate) fn count(&self, column: usize) -> Result<Option<u32>, CsvError> {
        let found = &self.cells[column];
        if found.is_empty() {
            return Ok(None);
        }
        found.parse().map(Some).map_err(|_| {
            self.error(
                column,
                CsvProblem::NotACount {
                    found: found.clone(),
                },
            )
        })
    }

    /// The time in a column that must be filled and rise above `before`.
    pub(crate) fn time(&self, column: usize, before: Option<f64>) -> Result<f64, CsvError> {
        let found = self.required(column)?;
        match before {
            Some(before) if found <= before => {
                Err(self.error(column, CsvProblem::TimeNotRising { found, before }))
            }
            _ => Ok(found),
        }
    }

    /// An error in a cell of this row.
    pub(crate) fn error(&self, column: usize, problem: CsvProblem) -> CsvError {
        self.table.error(self.line, Some(column), problem)
    }
}

/// All of the bytes as text without a byte-order mark; the error carries its line.
fn read_text(mut reader: impl Read) -> Result<String, (usize, CsvProblem)> {
    let mut bytes = Vec::new();
    reader
        .read_to_end(&mut bytes)
        .map_err(|error| (1, CsvProblem::Unreadable(error.to_string())))?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        (
            1 + good.iter().filter(|byte| **byte == b'\n').count(),
            CsvProblem::NotText,
        )
    })?;
    Ok(text
        .strip_prefix('\u{feff}')
        .map(str::to_owned)
        .unwrap_or(text))
}

/// Returns true if a cell of a first line is a measurement rather than a name; `nan` and `inf` are
/// names.
fn is_number(cell: &str) -> bool {
    cell.parse().is_ok_and(f64::is_finite)
}

/// The cells of one line; a comma between double quotes does not separate, `""` is a quote.
fn split(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            ',' if !quoted => cells.push(String::new()),
            _ => {
                quoted ^= c == '"';
                cells.last_mut().expect("there is always a cell").push(c);
            }
        }
    }
    cells.iter().map(|cell| unquote(cell.trim())).collect()
}

fn unquote(cell: &str) -> String {
    match cell
        .strip_prefix('"')
        .and_then(|rest| rest.strip_suffix('"'))
    {
        Some(inside) => inside.replace("\"\"", "\"").trim().to_owned(),
        None => cell.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn split_takes_quotes_and_blanks_off() {
        assert_eq!(
            split("a, b ,\"c,d\",\"\"\"e\"\"\","),
            ["a", "b", "c,d", "\"e\"", ""]
        );
        assert_eq!(split(""), [""]);
        assert_eq!(split("\""), ["\""]);
    }

    #[test]
    fn bytes_that_are_not_utf_8_are_refused_with_their_line() {
        let error = CsvTable::read(&b"time\n0\n\xff\n"[..], "log.csv")
            .err()
            .unwrap();
        assert_eq!(
            error.to_string(),
            "log.csv:3: the line is not UTF-8 text. Save the file as plain text in UTF-8"
        );
    }
}
