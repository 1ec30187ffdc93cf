//! Drawing on a sheet of paper, and the sheet as SVG: [`Sheet`].

use std::fmt::Write as _;

use crate::print::Paper;

/// A sheet of paper with the drawing on it, to scale; all in mm from its upper left corner, y down.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    pub(crate) paper: Paper,
    pub(crate) marks: Vec<Mark>,
}

/// Something on a sheet.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Mark {
    /// A tag: a black square with white rectangles (left, top, width, height) in it, which no
    /// hairline divides.
    Tag {
        id: u16,
        corner: [f64; 2],
        edge: f64,
        white: Vec<[f64; 4]>,
    },
    /// Words, from the left end of their baseline on.
    Words { start: [f64; 2], text: String },
    /// A horizontal line with ticks above it, each with its place along the line and its height.
    Ruler {
        start: [f64; 2],
        length: f64,
        ticks: Vec<[f64; 2]>,
    },
}

/// Height of words (mm).
pub(crate) const LETTERS: f64 = 3.0;
/// Width of a ruler's lines (mm).
pub(crate) const HAIR: f64 = 0.15;

impl Sheet {
    /// As SVG in mm.
    #[must_use]
    pub fn svg(&self) -> String {
        let Paper {
            width: w,
            height: h,
        } = self.paper;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}mm\" height=\"{h}mm\" viewBox=\"0 0 {w} {h}\" font-family=\"sans-serif\" font-size=\"{LETTERS}\">\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>\n"
        );
        for mark in &self.marks {
            svg.push_str(&mark.svg());
        }
        svg + "</svg>\n"
    }
}

impl Mark {
    fn svg(&self) -> String {
        let mut path = String::new();
        match self {
            Self::Tag {
                id,
                corner: [x, y],
                edge,
                white,
            } => {
                for [left, top, width, height] in white {
                    let _ = write!(
                        path,
                        "M{left:.4} {top:.4}h{width:.4}v{height:.4}h-{width:.4}z"
                    );
                }
                format!(
                    "<rect id=\"tag{id}\" x=\"{x:.4}\" y=\"{y:.4}\" width=\"{edge:.4}\" height=\"{edge:.4}\"/>\n<path fill=\"#fff\" shape-rendering=\"crispEdges\" d=\"{path}\"/>\n"
                )
            }
            Self::Words {
                start: [x, y],
                text,
            } => format!("<text x=\"{x:.4}\" y=\"{y:.4}\">{text}</text>\n"),
            Self::Ruler {
                start: [x, y],
                length,
                ticks,
            } => {
                for [along, height] in ticks {
                    let _ = write!(path, "M{:.4} {y:.4}v-{height}", x + along);
                }
                format!(
                    "<path id=\"ruler\" d=\"M{x} {y:.4}h{length}{path}\" stroke=\"#000\" stroke-width=\"{HAIR}\" fill=\"none\"/>\n"
                )
            }
        }
    }
}
