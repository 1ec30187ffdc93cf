//! Meaning of the colours of a figure: [`Legend`], in as many lines as it needs.

use maud::{Markup, html};

use crate::colour::{Colour, Line};
use crate::drawing::{DARK, LABEL, Text, px};
use crate::font::{Weight, width};

const LINE_HEIGHT: f64 = 22.0;
const SWATCH: f64 = 26.0;
const GAP: f64 = 22.0;

/// Sample before a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Swatch {
    Line(Colour, Line),
    Area(Colour),
    Bar(Colour),
    Dark,
}

/// Names with their swatches; the same name and swatch is listed once.
#[derive(Clone, Debug, Default)]
pub(crate) struct Legend {
    entries: Vec<(Swatch, String)>,
}

impl Legend {
    /// Adds an entry; one without a name is not shown.
    pub fn push(&mut self, swatch: Swatch, name: &str) {
        let entry = (swatch, name.to_owned());
        if !name.is_empty() && !self.entries.contains(&entry) {
            self.entries.push(entry);
        }
    }

    /// Draws the legend from `left` on, `room` wide (px), below `top`; also returns its height.
    pub fn draw(&self, [left, top]: [f64; 2], room: f64) -> (Markup, f64) {
        let mut at = [0.0, 0.0];
        let mut placed = Vec::new();
        for (swatch, name) in &self.entries {
            // other fonts may be wider
            let needed = SWATCH + 8.0 + 1.06 * width(name, LABEL, Weight::Regular);
            if at[0] > 0.0 && at[0] + needed > room {
                at = [0.0, at[1] + LINE_HEIGHT];
            }
            placed.push(([left + at[0], top + at[1]], swatch, name));
            at[0] += needed + GAP;
        }
        let height = if placed.is_empty() {
            0.0
        } else {
            at[1] + LINE_HEIGHT
        };
        (
            html! { @for ([x, y], swatch, name) in placed { (swatch.draw([x, y])) (Text::at([x + SWATCH + 8.0, y + 15.0], name).sized(LABEL)) } },
            height,
        )
    }
}

impl Swatch {
    fn draw(self, [x, y]: [f64; 2]) -> Markup {
        match self {
            Self::Line(colour, line) => html! {
                path d={ "M" (px(x)) " " (px(y + 10.0)) "h" (px(SWATCH)) } stroke=(colour.hex()) stroke-width="3" stroke-dasharray=[line.dashes()] fill="none" {}
            },
            Self::Area(colour) => html! {
                rect x=(px(x)) y=(px(y + 3.0)) width=(px(SWATCH)) height="14" fill=(colour.hex()) fill-opacity="0.25" {}
            },
            Self::Bar(colour) => html! {
                rect class=[(colour == Colour::INK).then_some("ink")] x=(px(x)) y=(px(y + 6.0)) width=(px(SWATCH)) height="8" fill=(colour.hex()) {}
            },
            Self::Dark => html! {
                rect class="dark" x=(px(x)) y=(px(y + 3.0)) width=(px(SWATCH)) height="14" fill=(DARK.hex()) {}
            },
        }
    }
}
