//! Names of events above a time axis: [`Mark`]; those that lie close stand one above the other.

use maud::{Markup, html};

use crate::axis::Axis;
use crate::drawing::{Anchor, Text};
use crate::font::{Weight, width};

/// Height of a line of names (px).
pub(crate) const MARK_LINE: f64 = 17.0;

const SIZE: f64 = 13.0;
const GAP: f64 = 10.0;

/// An event on the time axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mark {
    /// Time, in the unit of the time axis.
    pub time: f64,
    /// Name.
    pub name: String,
}

/// Names that found their places.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Names {
    placed: Vec<Name>,
    /// Height of all lines (px); 0 where there are none.
    pub height: f64,
}

#[derive(Clone, Debug, PartialEq)]
struct Name {
    text: String,
    time: f64,
    centre: f64,
    half_width: f64,
    line: usize,
}

/// Centres each name over its event as far as the axis has room, on the lowest line where it covers
/// no other one.
pub(crate) fn place(marks: &[Mark], axis: &Axis) -> Names {
    let [from, to] = axis.limits;
    let mut shown: Vec<&Mark> = marks
        .iter()
        .filter(|mark| (from..=to).contains(&mark.time) && !mark.name.is_empty())
        .collect();
    shown.sort_by(|a, b| a.time.total_cmp(&b.time));
    let mut placed: Vec<Name> = Vec::new();
    for mark in shown {
        let half_width = 0.5 * 1.06 * width(&mark.name, SIZE, Weight::Regular);
        let [left, right] = axis.pixels;
        let centre = axis
            .at(mark.time)
            .min(right - half_width)
            .max(left + half_width);
        let covers =
            |other: &Name| (other.centre - centre).abs() < other.half_width + half_width + GAP;
        let line = (0..)
            .find(|line| {
                !placed
                    .iter()
                    .any(|other| other.line == *line && covers(other))
            })
            .unwrap_or(0);
        placed.push(Name {
            text: mark.name.clone(),
            time: mark.time,
            centre,
            half_width,
            line,
        });
    }
    let lines = placed.iter().map(|name| name.line + 1).max().unwrap_or(0);
    Names {
        placed,
        height: lines as f64 * MARK_LINE,
    }
}

impl Names {
    /// Draws the names, lines from `top` down, in a panel whose left end is at `left`.
    pub fn draw(&self, [left, top]: [f64; 2]) -> Markup {
        html! {
            @for name in &self.placed {
                @let y = top + self.height - name.line as f64 * MARK_LINE - 4.0;
                g data-at=(name.time) { (Text { anchor: Anchor::Middle, ..Text::at([left + name.centre, y], &name.text) }.sized(SIZE)) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Scale;

    #[test]
    fn place_keeps_names_apart_and_on_the_axis() {
        let axis = Axis {
            scale: Scale::Linear,
            limits: [0.0, 10.0],
            pixels: [50.0, 650.0],
        };
        let mark = |time: f64, name: &str| Mark {
            time,
            name: name.to_owned(),
        };
        let marks = [
            mark(9.99, "fixel 3"),
            mark(5.0, "pusher"),
            mark(5.1, "fixel 1"),
            mark(5.2, "fixel 2"),
            mark(11.0, "later"),
        ];
        let names = place(&marks, &axis);
        assert_eq!(
            names
                .placed
                .iter()
                .map(|name| (name.text.as_str(), name.line))
                .collect::<Vec<_>>(),
            [
                ("pusher", 0),
                ("fixel 1", 1),
                ("fixel 2", 2),
                ("fixel 3", 0)
            ]
        );
        assert_eq!(names.height, 3.0 * MARK_LINE);
        let last = &names.placed[3];
        assert!(last.centre + last.half_width <= 650.0 && last.centre < axis.at(9.99));
        assert_eq!(place(&[], &axis).height, 0.0);
    }
}
