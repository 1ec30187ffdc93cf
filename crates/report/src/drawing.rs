//! A finished picture: [`Drawing`], with the parts that all pictures share: text, paper, numbers in
//! the form of SVG.
//!
//! Presentation attributes give the look on white paper. The classes `ink`, `grid`, `axis`, `paper`
//! and `dark` let a page give another one, as its dark mode does. Nothing has an `id`, so any
//! number of drawings can stand in one page.

use maud::{Markup, html};

use crate::colour::Colour;
use crate::font::{FAMILY, Weight, width};

/// Grid lines.
pub(crate) const GRID: Colour = Colour(228, 228, 228);

/// Background of the times while the camera was off.
pub(crate) const DARK: Colour = Colour(223, 219, 209);

/// Width below which a figure does not fill a page (px).
const NARROW: f64 = 600.0;

/// Width of a drawing that a phone shows with letters to read: a column in print (px).
pub(crate) const COLUMN: f64 = 441.0;

/// Font size of labels (px).
pub(crate) const LABEL: f64 = 14.0;

/// Font size of labels in print (pt).
const PRINT: f64 = 8.0;

/// Font size of titles (px).
pub(crate) const TITLE: f64 = 16.0;

/// From line to line of a title (px).
const LINE: f64 = 20.0;

/// Factor by which a text may be wider in another font than in ours.
const LOOSE: f64 = 1.06;

/// A picture as SVG.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Width (px).
    pub width: f64,
    /// Height (px).
    pub height: f64,
    /// Description of the picture, for those who cannot see it; empty where a caption says it.
    pub label: String,
    /// SVG elements.
    pub(crate) body: Markup,
    /// The picture in one column, for a phone; `None`: this one fits.
    pub(crate) narrow: Option<Box<Drawing>>,
}

impl Drawing {
    /// The picture as a text of SVG 1.1 that stands alone.
    #[must_use]
    pub fn to_svg(&self) -> String {
        self.sized("", 1.0)
    }

    /// The picture for print: labels of 8 pt, so that 441 px are a column of 252 pt and 882 px a
    /// page of two.
    #[must_use]
    pub fn to_print_svg(&self) -> String {
        self.sized("pt", PRINT / LABEL)
    }

    /// The picture with its size in a unit, `scale` of which are a pixel.
    fn sized(&self, unit: &str, scale: f64) -> String {
        let Self {
            width,
            height,
            label,
            body,
            narrow: _,
        } = self;
        let [wide, high] = [width, height].map(|length| format!("{}{unit}", px(scale * length)));
        let markup = html! {
            svg xmlns="http://www.w3.org/2000/svg" class=(if *width < NARROW { "figure narrow" } else { "figure" }) width=(wide) height=(high) viewBox={ "0 0 " (px(*width)) " " (px(*height)) }
                font-family=(FAMILY) font-size=(px(LABEL)) role="img" aria-label=[(!label.is_empty()).then_some(label)] {
                rect class="paper" width=(px(*width)) height=(px(*height)) fill="#ffffff" {}
                (body)
            }
        };
        markup.into_string()
    }

    /// Drawings side by side, row by row, in equal cells; on a phone one below the other.
    #[must_use]
    pub fn grid(drawings: &[Self], columns: usize) -> Self {
        let columns = columns.clamp(1, drawings.len().max(1));
        let narrow = (columns > 1).then(|| Box::new(Self::grid(drawings, 1)));
        let width = drawings
            .iter()
            .map(|drawing| drawing.width)
            .fold(1.0, f64::max);
        let height = drawings
            .iter()
            .map(|drawing| drawing.height)
            .fold(1.0, f64::max);
        let body = html! {
            @for (index, drawing) in drawings.iter().enumerate() {
                g transform={ "translate(" (px((index % columns) as f64 * width)) " " (px((index / columns) as f64 * height)) ")" } { (drawing.body) }
            }
        };
        let labels: Vec<&str> = drawings
            .iter()
            .map(|drawing| drawing.label.as_str())
            .filter(|label| !label.is_empty())
            .collect();
        let rows = drawings.len().div_ceil(columns).max(1);
        Self {
            width: columns as f64 * width,
            height: rows as f64 * height,
            label: labels.join("; "),
            body,
            narrow,
        }
    }

    /// Adds a title above.
    #[must_use]
    pub fn titled(self, title: &str) -> Self {
        let (lines, head) = title_lines(title, 12.0, self.width - 24.0);
        let body = html! {
            (lines)
            g transform={ "translate(0 " (px(head)) ")" } { (self.body) }
        };
        Self {
            height: self.height + head,
            body,
            narrow: self.narrow.map(|narrow| Box::new(narrow.titled(title))),
            ..self
        }
    }
}

/// A title from `left` on, in lines of at most `room` (px) where words allow it, and the height
/// that it takes (px).
pub(crate) fn title_lines(title: &str, left: f64, room: f64) -> (Markup, f64) {
    let mut lines: Vec<String> = Vec::new();
    for word in title.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), TITLE, Weight::Bold) * LOOSE <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    let text = html! {
        @for (index, line) in lines.iter().enumerate() {
            (Text { weight: Weight::Bold, ..Text::at([left, 22.0 + LINE * index as f64], line) }.sized(TITLE))
        }
    };
    let height = match lines.len() {
        0 => 6.0,
        count => 12.0 + LINE * count as f64,
    };
    (text, height)
}

/// Place of a text about its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of text, its point on the base line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Text<'a> {
    pub at: [f64; 2],
    pub text: &'a str,
    pub anchor: Anchor,
    pub weight: Weight,
    /// Turned by a quarter, read from below.
    pub upright: bool,
}

impl<'a> Text<'a> {
    /// Text that begins at a point (px).
    pub fn at(at: [f64; 2], text: &'a str) -> Self {
        Self {
            at,
            text,
            anchor: Anchor::Start,
            weight: Weight::Regular,
            upright: false,
        }
    }

    /// As an element, in a font size (px).
    pub fn sized(&self, size: f64) -> Markup {
        self.element(size, html! { (self.text) })
    }

    /// The text with letters after an underscore as indices: `mu_s`.
    pub fn with_indices(&self, size: f64) -> Markup {
        let mut parts = self.text.split('_');
        let first = parts.next().unwrap_or_default();
        let drop = px(0.22 * size);
        let index = |part: &str| {
            part.find(|letter: char| !letter.is_alphanumeric())
                .unwrap_or(part.len())
        };
        let content = html! {
            (first)
            @for (index, rest) in parts.map(|part| part.split_at(index(part))) {
                tspan dy=(drop) font-size=(px(0.8 * size)) { (index) }
                @if !rest.is_empty() { tspan dy={ "-" (drop) } { (rest) } }
            }
        };
        self.element(size, content)
    }

    fn element(&self, size: f64, content: Markup) -> Markup {
        let [x, y] = self.at.map(px);
        let anchor = match self.anchor {
            Anchor::Start => None,
            Anchor::Middle => Some("middle"),
            Anchor::End => Some("end"),
        };
        let weight = (self.weight == Weight::Bold).then_some("bold");
        let turn = self.upright.then(|| format!("rotate(-90 {x} {y})"));
        html! {
            text class="ink" x=(x) y=(y) fill=(Colour::INK.hex()) font-size=(px(size)) text-anchor=[anchor] font-weight=[weight] transform=[turn] { (content) }
        }
    }
}

/// A number of pixels with at most two decimals.
///
/// Numbers that are not finite become 0: an SVG with `NaN` in it is not drawn at all.
pub(crate) fn px(value: f64) -> String {
    let text = format!("{:.2}", if value.is_finite() { value } else { 0.0 });
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

/// The path through points (px), closed or open, to a tenth of a pixel; broken where a number is
/// not finite.
pub(crate) fn path(points: impl IntoIterator<Item = [f64; 2]>, closed: bool) -> String {
    path_on_grid(points, closed, 10.0)
}

/// The path through points, closed or open, on a grid of `per_unit` lines; broken where a number is
/// not finite. Each point is written relative to the one before, which takes half of the letters.
pub(crate) fn path_on_grid(
    points: impl IntoIterator<Item = [f64; 2]>,
    closed: bool,
    per_unit: f64,
) -> String {
    let mut path = String::new();
    let mut before: Option<[f64; 2]> = None;
    for point in points {
        let [x, y] = point.map(|value| (per_unit * value).round());
        if !(x.is_finite() && y.is_finite()) {
            before = None;
            continue;
        }
        let [to_x, to_y] = before.map_or([x, y], |[from_x, from_y]| [x - from_x, y - from_y]);
        let command = if before.is_some() { 'l' } else { 'M' };
        let [to_x, to_y] = [to_x, to_y].map(|value| px(value / per_unit));
        path.push_str(&format!("{command}{to_x} {to_y}"));
        before = Some([x, y]);
    }
    if closed && !path.is_empty() {
        path.push('Z');
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn px_is_short_and_always_a_number() {
        assert_eq!(
            [1.0, -0.001, 2.345_1, f64::NAN, -12.5, 100.0].map(px),
            ["1", "0", "2.35", "0", "-12.5", "100"]
        );
    }

    #[test]
    fn path_breaks_where_a_number_is_missing() {
        let points = [
            [0.0, 0.0],
            [1.0, 1.0],
            [2.0, f64::NAN],
            [3.0, 1.0],
            [4.0, 0.0],
        ];
        assert_eq!(path(points, false), "M0 0l1 1M3 1l1 -1");
        assert_eq!(path([], true), "");
    }

    #[test]
    fn a_long_path_ends_where_its_last_point_is() {
        let point = |k: i32| [f64::from(k) / 7.0, 100.0 * libm::sin(f64::from(k) / 7.0)];
        let text = path((0..1000).map(point), false);
        let mut at = [0.0; 2];
        for step in text.trim_start_matches('M').split('l') {
            let (x, y) = step.split_once(' ').unwrap();
            at[0] += x.parse::<f64>().unwrap();
            at[1] += y.parse::<f64>().unwrap();
        }
        let last = point(999);
        assert!(
            (at[0] - last[0]).abs() < 0.051 && (at[1] - last[1]).abs() < 0.051,
            "{at:?}, {last:?}"
        );
    }

    #[test]
    fn print_has_letters_of_8_pt_on_columns_of_252_pt() {
        let column = Drawing {
            width: 441.0,
            height: 350.0,
            label: String::new(),
            body: html! {},
            narrow: None,
        };
        let text = column.to_print_svg();
        assert!(
            text.contains(r#"width="252pt" height="200pt" viewBox="0 0 441 350""#),
            "{text}"
        );
    }

    #[test]
    fn a_long_title_is_broken_between_words() {
        // one word is wider than the room, the others fit two to a line at most
        let title = "ab cd ef incomprehensibilities gh";
        let room = 2.1 * width("ab cd", TITLE, Weight::Bold);
        let (text, height) = title_lines(title, 5.0, room);
        let lines: Vec<String> = text
            .into_string()
            .split("</text>")
            .filter_map(|line| Some(line.rsplit_once('>')?.1.to_owned()))
            .collect();
        assert_eq!(lines, ["ab cd ef", "incomprehensibilities", "gh"]);
        assert_eq!(height, title_lines("a", 5.0, room).1 + 2.0 * LINE);
        assert_eq!(title_lines("", 5.0, room).1, 6.0);
    }

    #[test]
    fn grid_puts_drawings_row_by_row() {
        let cell = |label: &str| Drawing {
            width: 10.0,
            height: 20.0,
            label: label.to_owned(),
            body: html! {},
            narrow: None,
        };
        let grid = Drawing::grid(&[cell("a"), cell("b"), cell("c")], 2);
        let narrow = grid.narrow.as_ref().expect("a column");
        assert_eq!((narrow.width, narrow.height), (10.0, 60.0));
        assert!(narrow.narrow.is_none());
        assert_eq!(
            (grid.width, grid.height, grid.label.as_str()),
            (20.0, 40.0, "a; b; c")
        );
        assert!(grid.to_svg().contains(r#"<g transform="translate(0 20)">"#));
    }
}
