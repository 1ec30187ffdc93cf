//! Tables with aligned columns, as text and as HTML: [`Table`].

use std::borrow::Cow;
use std::fmt;

use maud::{Markup, html};

use crate::colour::Colour;
use crate::terms::explained;

/// Rows of cells: the first column is left-aligned, the others right-aligned.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    titles: Vec<String>,
    rows: Vec<Row>,
}

#[derive(Clone, Debug, Default, PartialEq)]
struct Row {
    colour: Option<Colour>,
    /// Address that its first cell links to.
    href: Option<String>,
    cells: Vec<String>,
}

impl Table {
    /// A table with these column titles.
    #[must_use]
    pub fn new<S: Into<String>>(titles: impl IntoIterator<Item = S>) -> Self {
        Self {
            titles: titles.into_iter().map(Into::into).collect(),
            rows: Vec::new(),
        }
    }

    /// Appends a row.
    pub fn push(&mut self, cells: impl IntoIterator<Item = String>) {
        self.push_row(None, None, cells);
    }

    /// Appends a row whose first cell links to a place of the page, as `#` and
    /// [`crate::Section::anchor`].
    pub fn push_linked(&mut self, href: Option<String>, cells: impl IntoIterator<Item = String>) {
        self.push_row(None, href, cells);
    }

    /// Appends a row that has this colour in figures.
    pub fn push_coloured(&mut self, colour: Colour, cells: impl IntoIterator<Item = String>) {
        self.push_row(Some(colour), None, cells);
    }

    fn push_row(
        &mut self,
        colour: Option<Colour>,
        href: Option<String>,
        cells: impl IntoIterator<Item = String>,
    ) {
        let cells = cells.into_iter().collect();
        self.rows.push(Row {
            colour,
            href,
            cells,
        });
    }

    /// The table as HTML, under a caption.
    pub(crate) fn html(&self, caption: &str) -> Markup {
        html! {
            div class="scroll" tabindex="0" role="region" aria-label=(if caption.is_empty() { "table" } else { caption }) {
                table {
                    @if !caption.is_empty() { caption { (caption) } }
                    thead { tr { @for title in &self.titles { th scope="col" { (explained(title)) } } } }
                    tbody {
                        @for Row { colour, href, cells } in &self.rows {
                            tr { @for (column, cell) in cells.iter().enumerate() {
                                @if column == 0 {
                                    th scope="row" { @if let Some(colour) = colour { (swatch(*colour)) } @if let Some(href) = href { a href=(href) { (cell) } } @else { (cell) } }
                                } @else {
                                    td data-of=[self.titles.get(column)] { (cell) }
                                }
                            } }
                        }
                    }
                }
            }
        }
    }

    fn all_rows(&self) -> impl Iterator<Item = &Vec<String>> {
        std::iter::once(&self.titles).chain(self.rows.iter().map(|row| &row.cells))
    }

    /// Widths of all columns as text.
    fn widths(&self) -> Vec<usize> {
        let mut widths = Vec::new();
        for row in self.all_rows() {
            widths.resize(row.len().max(widths.len()), 0);
            for (width, cell) in widths.iter_mut().zip(row) {
                *width = cell.chars().count().min(WIDEST).max(*width);
            }
        }
        widths
    }
}

/// Most characters of a cell as text; the rest of a longer one is cut off.
const WIDEST: usize = 160;

/// A small patch of a colour.
pub(crate) fn swatch(colour: Colour) -> Markup {
    html! { span class="swatch" style={ "background:" (colour.hex()) } {} }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let widths = self.widths();
        for row in self.all_rows() {
            let cells = row
                .iter()
                .zip(&widths)
                .enumerate()
                .map(|(column, (cell, width))| aligned(&short(cell), *width, column == 0));
            writeln!(f, "{}", cells.collect::<Vec<_>>().join("  ").trim_end())?;
        }
        Ok(())
    }
}

/// A cell that is no wider than [`WIDEST`].
fn short(cell: &str) -> Cow<'_, str> {
    match cell.char_indices().nth(WIDEST) {
        None => Cow::Borrowed(cell),
        Some(_) => Cow::Owned(cell.chars().take(WIDEST - 1).chain(['…']).collect()),
    }
}

fn aligned(cell: &str, width: usize, left: bool) -> String {
    if left {
        format!("{cell:<width$}")
    } else {
        format!("{cell:>width$}")
    }
}

/// A number with `decimals` digits after the point; a dash where there is none.
#[must_use]
pub fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_cell_is_cut_off() {
        let mut table = Table::new(["topic", "count"]);
        table.push(["n".repeat(70_000), "1".to_owned()]);
        let text = table.to_string();
        assert!(
            text.lines().all(|line| line.chars().count() <= 167),
            "{}",
            text.len()
        );
        assert!(text.contains("n…      1"), "{text}");
    }

    #[test]
    fn table_aligns_columns() {
        let mut table = Table::new(["method", "mm"]);
        table.push(["a".to_owned(), number(Some(12.345), 2)]);
        table.push(["longer name".to_owned(), number(None, 2)]);
        assert_eq!(
            table.to_string(),
            "method          mm\na            12.35\nlonger name      -\n"
        );
    }

    #[test]
    fn a_cell_knows_its_column_for_phones() {
        let mut table = Table::new(["method", "WMSE (mm)"]);
        table.push(["a".to_owned(), number(Some(0.5), 2)]);
        let text = table.html("").into_string();
        assert!(
            text.contains("<td data-of=\"WMSE (mm)\">0.50</td>"),
            "{text}"
        );
    }

    #[test]
    fn table_is_escaped_in_html() {
        let mut table = Table::new(["<script>"]);
        table.push_coloured(Colour::SKY, ["a & \"b\"".to_owned()]);
        let text = table.html("x < y").into_string();
        assert!(
            !text.contains("<script>")
                && text.contains("a &amp; &quot;b&quot;")
                && text.contains("x &lt; y"),
            "{text}"
        );
    }
}
