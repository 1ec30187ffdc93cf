//! A sheet as PDF (ISO 32000-1): one page, filled rectangles, lines, and words in the Helvetica
//! that every viewer has.

use std::fmt::Write as _;

use crate::print::Paper;
use crate::sheet::{HAIR, LETTERS, Mark, Sheet};

/// Points in a millimetre.
const POINTS: f64 = 72.0 / 25.4;

impl Sheet {
    /// As PDF in the size of the paper. It asks viewers not to scale it when they print.
    #[must_use]
    pub fn pdf(&self) -> Vec<u8> {
        let Paper { width, height } = self.paper;
        let [w, h] = [width * POINTS, height * POINTS];
        let drawn = self.drawn();
        let objects = [
            "<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>"
                .to_owned(),
            "<< /Type /Pages /Kids [3 0 R] /Count 1 >>".to_owned(),
            format!(
                "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {w:.4} {h:.4}] /Contents 4 0 R /Resources << /Font << /F 5 0 R >> >> >>"
            ),
            format!("<< /Length {} >>\nstream\n{drawn}endstream", drawn.len()),
            "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>"
                .to_owned(),
        ];
        let mut pdf = "%PDF-1.4\n".to_owned();
        let mut places = Vec::new();
        for (number, object) in (1..).zip(&objects) {
            places.push(pdf.len());
            let _ = write!(pdf, "{number} 0 obj\n{object}\nendobj\n");
        }
        let table = pdf.len();
        let count = objects.len() + 1;
        let _ = write!(pdf, "xref\n0 {count}\n0000000000 65535 f \n");
        for place in places {
            let _ = writeln!(pdf, "{place:010} 00000 n ");
        }
        let _ = write!(
            pdf,
            "trailer\n<< /Size {count} /Root 1 0 R >>\nstartxref\n{table}\n%%EOF\n"
        );
        pdf.into_bytes()
    }

    /// The page's operators. From here on all is in mm, y up from the paper's foot.
    fn drawn(&self) -> String {
        let mut page = format!("{POINTS:.9} 0 0 {POINTS:.9} 0 0 cm {HAIR} w\n");
        for mark in &self.marks {
            page.push_str(&mark.pdf(self.paper.height));
        }
        page
    }
}

impl Mark {
    /// Its operators on paper of a height (mm).
    fn pdf(&self, paper: f64) -> String {
        let rectangle = |[left, top, width, height]: [f64; 4]| {
            format!(
                "{left:.4} {:.4} {width:.4} {height:.4} re\n",
                paper - top - height
            )
        };
        match self {
            Self::Tag {
                corner: [x, y],
                edge,
                white,
                ..
            } => {
                let square = rectangle([*x, *y, *edge, *edge]);
                let white: String = white.iter().map(|cells| rectangle(*cells)).collect();
                format!("0 g\n{square}f\n1 g\n{white}f\n0 g\n")
            }
            Self::Words {
                start: [x, y],
                text,
            } => {
                let escaped = text
                    .replace('\\', "\\\\")
                    .replace('(', "\\(")
                    .replace(')', "\\)");
                format!(
                    "BT /F {LETTERS} Tf {x:.4} {:.4} Td ({escaped}) Tj ET\n",
                    paper - y
                )
            }
            Self::Ruler {
                start: [x, y],
                length,
                ticks,
            } => {
                let y = paper - y;
                let mut lines = format!("{x:.4} {y:.4} m {:.4} {y:.4} l\n", x + length);
                for [along, height] in ticks {
                    let at = x + along;
                    let _ = writeln!(lines, "{at:.4} {y:.4} m {at:.4} {:.4} l", y + height);
                }
                lines + "S\n"
            }
        }
    }
}
