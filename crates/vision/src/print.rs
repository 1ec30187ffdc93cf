//! Tags and boards to scale on paper: [`tags_svg`], [`board_svg`].

use std::fmt::Write as _;

use crate::board::Board;
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

/// Why something cannot be printed.
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
        "{width:.0} x {height:.0} mm are needed beside margins and ruler, the paper has {has_width:.0} x {has_height:.0} mm for it. Take larger paper or smaller tags"
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

/// Tags whose black squares have the edge `size` (m), each with its white margin and its number, side
/// by side, as SVG in mm, over a ruler of 100 mm.
///
/// # Errors
/// A number that is none of the family, or tags that do not fit on the paper.
///
/// ```
/// use stickslip_vision::{Paper, tags_svg};
/// let a4 = Paper { width: 210.0, height: 297.0 };
/// assert!(tags_svg(&[0, 1], 0.028, a4)?.starts_with("<svg "));
/// assert!(tags_svg(&[0], 0.3, a4).is_err() && tags_svg(&[587], 0.028, a4).is_err());
/// # Ok::<(), stickslip_vision::PrintError>(())
/// ```
pub fn tags_svg(tags: &[u16], size: f64, paper: Paper) -> Result<String, PrintError> {
    // white of two cells about each, and room for its number
    let (edge, pitch) = (1e3 * size, 1e3 * size * 1.5 + 6.0);
    let [room, _] = room(paper);
    let columns = ((room / pitch) as usize).clamp(1, tags.len().max(1));
    let rows = tags.len().div_ceil(columns);
    let mut sheet = Sheet::new(paper, [columns as f64 * pitch, rows as f64 * pitch])?;
    for (index, id) in tags.iter().enumerate() {
        let [column, row] = [index % columns, index / columns];
        let (x, y) = (
            MARGIN + column as f64 * pitch + edge / 4.0,
            MARGIN + row as f64 * pitch + edge / 4.0,
        );
        sheet.tag(*id, [x, y], edge)?;
        sheet.text(
            [x + edge / 2.0, y + edge * 1.25 + 3.0],
            &format!("36h11, tag {id}, {edge:.1} mm"),
        );
    }
    Ok(sheet.end())
}

/// A calibration board as SVG in mm, over a ruler of 100 mm.
///
/// # Errors
/// A board that does not fit on the paper.
pub fn board_svg(board: &Board, paper: Paper) -> Result<String, PrintError> {
    let [edge, gap] = [1e3 * board.tag_size, 1e3 * board.gap];
    let side = |count: u16| f64::from(count) * (edge + gap) + gap;
    let mut sheet = Sheet::new(paper, [side(board.columns), side(board.rows)])?;
    for id in board.tags() {
        let Some([lower_left, ..]) = board.corners(id) else {
            continue;
        };
        // the board's y points up, the paper's down
        let top = side(board.rows) - gap - edge - 1e3 * lower_left[1];
        let left = gap + 1e3 * lower_left[0];
        sheet.tag(id, [MARGIN + left, MARGIN + top], edge)?;
    }
    Ok(sheet.end())
}

/// Width and height (mm) that margins and ruler leave.
fn room(paper: Paper) -> [f64; 2] {
    [
        paper.width - 2.0 * MARGIN,
        paper.height - 2.0 * MARGIN - RULER,
    ]
}

/// A sheet that is being drawn.
struct Sheet {
    svg: String,
    paper: Paper,
}

impl Sheet {
    /// An empty one with room for so much (mm).
    fn new(paper: Paper, [width, height]: [f64; 2]) -> Result<Self, PrintError> {
        let [has_width, has_height] = room(paper);
        if width > has_width || height > has_height {
            return Err(PrintError::TooLarge {
                width,
                height,
                has_width,
                has_height,
            });
        }
        let Paper {
            width: w,
            height: h,
        } = paper;
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}mm\" height=\"{h}mm\" viewBox=\"0 0 {w} {h}\" font-family=\"sans-serif\" font-size=\"3\">\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>\n"
        );
        Ok(Self { svg, paper })
    }

    /// A tag whose black square has its upper left corner at a place: black with white cells, which no
    /// hairline divides.
    fn tag(&mut self, id: u16, [x, y]: [f64; 2], edge: f64) -> Result<(), PrintError> {
        let cells = tag_cells(id).ok_or(PrintError::NoTag { id })?;
        let cell = edge / 8.0;
        let mut path = String::new();
        for (row, cells) in cells.iter().enumerate() {
            let mut column = 0;
            while column < 8 {
                let white = cells[column..].iter().take_while(|white| **white).count();
                if white > 0 {
                    let (left, top) = (x + column as f64 * cell, y + row as f64 * cell);
                    let width = white as f64 * cell;
                    let _ = write!(
                        path,
                        "M{left:.4} {top:.4}h{width:.4}v{cell:.4}h-{width:.4}z"
                    );
                }
                column += white.max(1);
            }
        }
        let _ = writeln!(
            self.svg,
            "<rect id=\"tag{id}\" x=\"{x:.4}\" y=\"{y:.4}\" width=\"{edge:.4}\" height=\"{edge:.4}\"/>\n<path fill=\"#fff\" shape-rendering=\"crispEdges\" d=\"{path}\"/>"
        );
        Ok(())
    }

    fn text(&mut self, [x, y]: [f64; 2], text: &str) {
        let _ = writeln!(
            self.svg,
            "<text x=\"{x:.4}\" y=\"{y:.4}\" text-anchor=\"middle\">{text}</text>"
        );
    }

    /// The whole, with its ruler: as long as the paper allows, in tens of mm.
    fn end(mut self) -> String {
        let most = self.paper.width - 2.0 * MARGIN - 5.0;
        let length = LENGTH.min((most / 10.0).floor() * 10.0).max(10.0);
        let y = self.paper.height - MARGIN - 8.0;
        let mut path = String::new();
        for millimetre in 0..=length as u32 {
            let tick = match millimetre {
                m if m.is_multiple_of(10) => 4.0,
                m if m.is_multiple_of(5) => 3.0,
                _ => 2.0,
            };
            let _ = write!(
                path,
                "M{:.4} {y:.4}v-{tick}",
                MARGIN + f64::from(millimetre)
            );
        }
        let _ = writeln!(
            self.svg,
            "<path id=\"ruler\" d=\"M{MARGIN} {y:.4}h{length}{path}\" stroke=\"#000\" stroke-width=\"0.15\" fill=\"none\"/>"
        );
        let words =
            format!("{length} mm on the ruler must be {length} mm on the print: print at 100 %");
        let _ = writeln!(
            self.svg,
            "<text x=\"{MARGIN}\" y=\"{:.4}\">{words}</text>\n</svg>",
            y + 5.0
        );
        self.svg
    }
}
