//! Text of figures as outlines of its letters: [`outlined`]. A picture in pixels then needs no
//! library that shapes text, which takes longer to compile than all else that draws.

use std::fmt::Write as _;

use roxmltree::{Document, Node};
use ttf_parser::OutlineBuilder;

use crate::drawing::LABEL;
use crate::font::{self, Weight};

/// An SVG with a path in the place of every `text`, in the fonts of every figure.
///
/// It reads the output of [`Drawing`](crate::Drawing): one line with x, y, size, weight, anchor and
/// transform, parts of it in another size and above or below the line (`tspan` with `dy`). Letters
/// stand as far apart as [`font::width`] says; those that the fonts lack are left out.
///
/// # Errors
/// The text is no XML.
pub(crate) fn outlined(svg: &str) -> Result<String, roxmltree::Error> {
    let document = Document::parse(svg)?;
    let mut out = String::with_capacity(2 * svg.len());
    let mut copied = 0;
    for text in document
        .descendants()
        .filter(|node| node.has_tag_name(("http://www.w3.org/2000/svg", "text")))
    {
        let range = text.range();
        out.push_str(&svg[copied..range.start]);
        push_path(&mut out, text);
        copied = range.end;
    }
    out.push_str(&svg[copied..]);
    Ok(out)
}

/// Appends the path of one line of text.
fn push_path(out: &mut String, text: Node<'_, '_>) {
    let runs = runs(text);
    let weight = match inherited(text, "font-weight") {
        Some("bold") => Weight::Bold,
        _ => Weight::Regular,
    };
    let wide: f64 = runs
        .iter()
        .map(|run| font::width(run.text, run.size, weight))
        .sum();
    let before = match inherited(text, "text-anchor") {
        Some("middle") => 0.5 * wide,
        Some("end") => wide,
        _ => 0.0,
    };
    let [x, y] = ["x", "y"].map(|name| number(text.attribute(name)).unwrap_or(0.0));
    let mut pen = Pen {
        at: [x - before, y],
        scale: 0.0,
        path: String::new(),
    };
    for run in runs {
        pen.at[1] += run.drop;
        pen.write(run.text, run.size, weight);
    }
    out.push_str("<path");
    for name in ["fill", "transform"] {
        if let Some(value) = text.attribute(name) {
            // our own attributes: colours and rotations, nothing that would have to be escaped
            let _ = write!(out, " {name}=\"{value}\"");
        }
    }
    let _ = write!(out, " d=\"{}\"/>", pen.path);
}

/// Letters of one size on one line.
struct Run<'a> {
    text: &'a str,
    /// Font size (px).
    size: f64,
    /// Shift down from the text before it (px).
    drop: f64,
}

fn runs<'a>(text: Node<'a, '_>) -> Vec<Run<'a>> {
    let words = text.descendants().filter(Node::is_text);
    words
        .map(|words| {
            let own = words.parent().filter(|parent| *parent != text);
            Run {
                text: words.text().unwrap_or_default(),
                size: number(inherited(words, "font-size")).unwrap_or(LABEL),
                drop: number(own.and_then(|own| own.attribute("dy"))).unwrap_or(0.0),
            }
        })
        .collect()
}

/// An attribute of a node or of its nearest ancestor that has it.
fn inherited<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    node.ancestors().find_map(|of| of.attribute(name))
}

fn number(text: Option<&str>) -> Option<f64> {
    text?.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Writes letters as path data.
struct Pen {
    /// Place of the next letter (px).
    at: [f64; 2],
    /// Size of a font unit (px).
    scale: f64,
    path: String,
}

impl Pen {
    fn write(&mut self, text: &str, size: f64, weight: Weight) {
        for letter in text.chars() {
            if let Some((face, glyph)) = font::glyph(letter, weight) {
                self.scale = size / f64::from(face.units_per_em());
                face.outline_glyph(glyph, self);
            }
            self.at[0] += font::width(letter.encode_utf8(&mut [0; 4]), size, weight);
        }
    }

    fn push(&mut self, command: char, points: &[(f32, f32)]) {
        self.path.push(command);
        for (x, y) in points {
            let [x, y] = [
                self.at[0] + self.scale * f64::from(*x),
                self.at[1] - self.scale * f64::from(*y),
            ];
            let _ = write!(self.path, "{x:.3} {y:.3} ");
        }
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.push('M', &[(x, y)]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.push('L', &[(x, y)]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.push('Q', &[(x1, y1), (x, y)]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.push('C', &[(x1, y1), (x2, y2), (x, y)]);
    }

    fn close(&mut self) {
        self.path.push('Z');
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
mod tests {
    use resvg::usvg::{Options, Rect, Tree};

    use super::*;

    /// Area that the text of an SVG covers, without the space about its letters.
    fn covered(text: &str) -> Rect {
        let svg = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="4000" height="4000">{text}</svg>"#
        );
        let tree = Tree::from_str(&outlined(&svg).unwrap(), &Options::default()).unwrap();
        tree.root().abs_bounding_box()
    }

    fn assert_at(found: [f32; 2], expected: [f32; 2]) {
        let near = |k: usize| (found[k] - expected[k]).abs() < 0.01;
        assert!(near(0) && near(1), "{found:?}, expected {expected:?}");
    }

    /// Roboto's H, units of 2048 per em: 1461 wide, from 169 to 1288, 1456 high.
    #[test]
    fn letters_stand_where_anchor_and_rotation_say() {
        let at = |more: &str| {
            covered(&format!(
                r#"<text x="2000" y="3000" font-size="1024" {more}>H</text>"#
            ))
        };
        let start = at("");
        assert_at([start.left(), start.right()], [2084.5, 2644.0]);
        assert_at([start.top(), start.bottom()], [2272.0, 3000.0]);
        let middle = at(r#"text-anchor="middle""#);
        assert_at([middle.left(), middle.right()], [1719.25, 2278.75]);
        let end = at(r#"text-anchor="end""#);
        assert_at([end.left(), end.right()], [1354.0, 1913.5]);
        let turned = at(r#"transform="rotate(-90 2000 3000)""#);
        assert_at([turned.left(), turned.right()], [1272.0, 2000.0]);
        assert_at([turned.top(), turned.bottom()], [2356.0, 2915.5]);
    }

    #[test]
    fn parts_are_of_their_size_and_at_their_height() {
        let found = covered(
            r#"<text y="1000" font-size="1024"><tspan dy="100" font-size="512">H</tspan><tspan dy="-100">H</tspan></text>"#,
        );
        // half as large, 100 below the line; the next, of full size, 365.25 to the right and on the line
        assert_at([found.left(), found.right()], [42.25, 1009.25]);
        assert_at([found.top(), found.bottom()], [272.0, 1100.0]);
    }

    #[test]
    fn what_is_no_text_stays_and_no_letter_is_taken_for_markup() {
        let svg = r#"<svg xmlns="http://www.w3.org/2000/svg"><g><rect width="1"/></g></svg>"#;
        assert_eq!(outlined(svg).unwrap(), svg);
        let escaped =
            r#"<svg xmlns="http://www.w3.org/2000/svg"><text>a &lt; b &amp; c</text></svg>"#;
        assert!(Document::parse(&outlined(escaped).unwrap()).is_ok());
        assert!(outlined("<svg>").is_err());
    }
}
