//! Tags and boards to scale on paper: [`print_tags`], [`print_board`].

use crate::board::Board;
use crate::sheet::{Mark, Sheet};
use crate::tag::{TAG_COUNT, tag_cells};

/// Margin of the paper (mm), which printers leave white.
const MARGIN: f64 = 10.0;

/// Room for the ruler at the paper's foot (mm).
const RULER: f64 = 20.0;

/// Length of the ruler (mm).
const LENGTH: f64 = 100.0;

/// A sheet of paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paper {
    /// Width (mm).
    pub width: f64,
    /// Height (mm).
    pub height: f64,
}

/// Reason why something cannot be printed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PrintError {
    /// A tag that the family does not have.
    #[error("tag {id} is none of the family 36h11, which has 0 to {last}. Choose another number", last = TAG_COUNT - 1)]
    NoTag {
        /// Its number.
        id: u16,
    },
    /// It does not fit.
    #[error(
        "{width:.0} x {height:.0} mm are needed in addition to margins and ruler, the paper has {has_width:.0} x {has_height:.0} mm for it. Take larger paper or smaller tags"
    )]
    TooLarge {
        /// Width needed (mm).
        width: f64,
        /// Height needed (mm).
        height: f64,
        /// Width there is (mm).
        has_width: f64,
        /// Height there is (mm).
        has_height: f64,
    },
}

/// Tags whose black squares have the edge `size` (m), each with its white margin and its number,
/// side by side, over a ruler of 100 mm.
///
/// # Errors
/// A number that is none of the family, or tags that do not fit on the paper.
///
/// ```
/// use stickslip_vision::{Paper, print_tags};
/// let a4 = Paper { width: 210.0, height: 297.0 };
/// let sheet = print_tags(&[0, 1], 0.028, a4)?;
/// assert!(sheet.svg().starts_with("<svg ") && sheet.pdf().starts_with(b"%PDF-"));
/// assert!(print_tags(&[0], 0.3, a4).is_err() && print_tags(&[587], 0.028, a4).is_err());
/// # Ok::<(), stickslip_vision::PrintError>(())
/// ```
pub fn print_tags(tags: &[u16], size: f64, paper: Paper) -> Result<Sheet, PrintError> {
    // white of two cells about each, and room for its number
    let (edge, pitch) = (1e3 * size, 1e3 * size * 1.5 + 6.0);
    let [room, _] = room(paper);
    let columns = ((room / pitch) as usize).clamp(1, tags.len().max(1));
    let rows = tags.len().div_ceil(columns);
    let mut sheet = empty(paper, [columns as f64 * pitch, rows as f64 * pitch])?;
    for (index, id) in tags.iter().enumerate() {
        let [column, row] = [index % columns, index / columns];
        let (x, y) = (
            MARGIN + column as f64 * pitch + edge / 4.0,
            MARGIN + row as f64 * pitch + edge / 4.0,
        );
        sheet.marks.push(tag(*id, [x, y], edge)?);
        sheet.marks.push(Mark::Words {
            start: [x, y + edge * 1.25 + 3.0],
            text: format!("36h11, tag {id}, {edge:.1} mm"),
        });
    }
    sheet.marks.extend(ruler(paper));
    Ok(sheet)
}

/// A calibration board over a ruler of 100 mm.
///
/// # Errors
/// A board that does not fit on the paper.
pub fn print_board(board: &Board, paper: Paper) -> Result<Sheet, PrintError> {
    let [edge, gap] = [1e3 * board.tag_size, 1e3 * board.gap];
    let side = |count: u16| f64::from(count) * (edge + gap) + gap;
    let mut sheet = empty(paper, [side(board.columns), side(board.rows)])?;
    for id in board.tags() {
        let Some([lower_left, ..]) = board.corners(id) else {
            continue;
        };
        // the board's y points up, the paper's down
        let top = side(board.rows) - gap - edge - 1e3 * lower_left[1];
        let left = gap + 1e3 * lower_left[0];
        sheet
            .marks
            .push(tag(id, [MARGIN + left, MARGIN + top], edge)?);
    }
    sheet.marks.extend(ruler(paper));
    Ok(sheet)
}

/// Width and height (mm) that margins and ruler leave.
fn room(paper: Paper) -> [f64; 2] {
    [
        paper.width - 2.0 * MARGIN,
        paper.height - 2.0 * MARGIN - RULER,
    ]
}

/// An empty sheet with room for so much (mm).
fn empty(paper: Paper, [width, height]: [f64; 2]) -> Result<Sheet, PrintError> {
    let [has_width, has_height] = room(paper);
    if width > has_width || height > has_height {
        return Err(PrintError::TooLarge {
            width,
            height,
            has_width,
            has_height,
        });
    }
    Ok(Sheet {
        paper,
        marks: Vec::new(),
    })
}

/// A tag whose black square has its upper left corner at a place.
fn tag(id: u16, [x, y]: [f64; 2], edge: f64) -> Result<Mark, PrintError> {
    let cells = tag_cells(id).ok_or(PrintError::NoTag { id })?;
    let cell = edge / 8.0;
    let mut white = Vec::new();
    for (row, cells) in cells.iter().enumerate() {
        let mut column = 0;
        while column < 8 {
            let run = cells[column..].iter().take_while(|white| **white).count();
            if run > 0 {
                let (left, top) = (x + column as f64 * cell, y + row as f64 * cell);
                white.push([left, top, run as f64 * cell, cell]);
            }
            column += run.max(1);
        }
    }
    Ok(Mark::Tag {
        id,
        corner: [x, y],
        edge,
        white,
    })
}

/// The ruler at the paper's foot, as long as that allows, in tens of mm, and its purpose.
fn ruler(paper: Paper) -> [Mark; 2] {
    let most = paper.width - 2.0 * MARGIN - 5.0;
    let length = LENGTH.min((most / 10.0).floor() * 10.0).max(10.0);
    let y = paper.height - MARGIN - 8.0;
    let tick = |millimetre: u32| {
        let height = match millimetre {
            m if m.is_multiple_of(10) => 4.0,
            m if m.is_multiple_of(5) => 3.0,
            _ => 2.0,
        };
        [f64::from(millimetre), height]
    };
    let words =
        format!("{length} mm on the ruler must be {length} mm on the print: print at 100 %");
    [
        Mark::Ruler {
            start: [MARGIN, y],
            length,
            ticks: (0..=length as u32).map(tick).collect(),
        },
        Mark::Words {
            start: [MARGIN, y + 5.0],
            text: words,
        },
    ]
}
