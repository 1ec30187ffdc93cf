//! A rectangle with axes in which curves are drawn: [`Plot`].

use maud::{Markup, html};

use crate::axis::{Axis, Tick};
use crate::colour::{Colour, Line};
use crate::drawing::{Anchor, DARK, GRID, LABEL, Text, path, px};
use crate::font::{Weight, width};
use crate::thinning::thinned;

/// Space between ticks (px).
const SPACING: [f64; 2] = [80.0, 38.0];

/// Height of the line of time steps (px).
pub(crate) const STEPS: f64 = 17.0;

/// Axes of a chart; `x.pixels` rise, `y.pixels` fall.
#[derive(Clone, Debug)]
pub(crate) struct Plot<'a> {
    pub x: Axis,
    pub y: Axis,
    /// Quantity and unit; empty: no numbers either.
    pub x_label: &'a str,
    /// Time steps per unit of x, to be written under the numbers; `None`: not there.
    pub steps: Option<f64>,
    pub y_label: &'a str,
}

impl Plot<'_> {
    /// Paper side of the rectangle: left, top, width, height (px).
    fn frame(&self) -> [f64; 4] {
        let [left, right] = self.x.pixels;
        let [bottom, top] = self.y.pixels;
        [left, top, right - left, bottom - top]
    }

    /// Bands from top to bottom while the camera was off.
    pub fn shades(&self, dark: &[[f64; 2]]) -> Markup {
        let [_, top, _, height] = self.frame();
        let [low, high] = self.x.limits;
        let shown = dark
            .iter()
            .map(|[from, to]| [from.max(low), to.min(high)])
            .filter(|[from, to]| from < to);
        html! {
            @for [from, to] in shown {
                @let (left, right) = (self.x.at(from), self.x.at(to));
                rect class="dark" x=(px(left)) y=(px(top)) width=(px(right - left)) height=(px(height)) fill=(DARK.hex()) {}
            }
        }
    }

    /// Grid, both axes, numbers and labels.
    pub fn axes(&self) -> Markup {
        let [left, top, _, height] = self.frame();
        let ticks = self.y.ticks(SPACING[1]);
        let label = [left - self.label_distance(&ticks), top + 0.5 * height];
        html! {
            path class="grid" d=(self.grid(&ticks)) stroke=(GRID.hex()) fill="none" {}
            path class="axis" d=(path([[left, top], [left, top + height]], false)) stroke=(Colour::INK.hex()) fill="none" {}
            @for tick in &ticks {
                (Text { anchor: Anchor::End, ..Text::at([left - 7.0, self.y.at(tick.value) + 0.35 * LABEL], &tick.label) }.sized(LABEL))
            }
            (Text { anchor: Anchor::Middle, upright: true, ..Text::at(label, self.y_label) }.with_indices(LABEL))
            (self.time_axis())
        }
    }

    /// The lower axis with its numbers and its label.
    pub fn time_axis(&self) -> Markup {
        let [left, top, width, height] = self.frame();
        let ticks = self.x.ticks(SPACING[0]);
        let line = path([[left, top + height], [left + width, top + height]], false);
        html! {
            path class="axis" d=(line) stroke=(Colour::INK.hex()) fill="none" {}
            g class="ticks" {
                path class="axis" d=(self.tick_strokes(&ticks)) stroke=(Colour::INK.hex()) fill="none" {}
                @if !self.x_label.is_empty() {
                    @for tick in &ticks {
                        (Text { anchor: Anchor::Middle, ..Text::at([self.x.at(tick.value), top + height + 20.0], &tick.label) }.sized(LABEL))
                    }
                }
            }
            @if !self.x_label.is_empty() {
                @if let Some(steps) = self.steps { (self.step_numbers(&ticks, steps)) }
                @let below = if self.steps.is_some() { STEPS } else { 0.0 };
                (Text { anchor: Anchor::Middle, ..Text::at([left + 0.5 * width, top + height + below + 40.0], self.x_label) }.sized(LABEL))
            }
        }
    }

    /// The time step at each tick, in a line of its own.
    fn step_numbers(&self, ticks: &[Tick], steps: f64) -> Markup {
        let y = self.y.pixels[0] + 20.0 + STEPS;
        html! {
            @for tick in ticks {
                (Text { anchor: Anchor::Middle, ..Text::at([self.x.at(tick.value), y], &format!("{:.0}", steps * tick.value)) }.sized(LABEL))
            }
        }
    }

    /// Distance of the axis' label left of the axis: equal in every panel, unless the numbers need
    /// more.
    fn label_distance(&self, ticks: &[Tick]) -> f64 {
        let widest = ticks
            .iter()
            .map(|tick| width(&tick.label, LABEL, Weight::Regular))
            .fold(0.0, f64::max);
        (widest + 20.0).max(50.0)
    }

    fn grid(&self, ticks: &[Tick]) -> String {
        let [left, right] = self.x.pixels;
        let lines = ticks.iter().filter(|tick| !tick.label.is_empty());
        lines
            .map(|tick| {
                path(
                    [
                        [left, self.y.at(tick.value)],
                        [right, self.y.at(tick.value)],
                    ],
                    false,
                )
            })
            .collect()
    }

    fn tick_strokes(&self, ticks: &[Tick]) -> String {
        let bottom = self.y.pixels[0];
        ticks
            .iter()
            .map(|tick| {
                path(
                    [
                        [self.x.at(tick.value), bottom],
                        [self.x.at(tick.value), bottom + 5.0],
                    ],
                    false,
                )
            })
            .collect()
    }

    /// Content in pixels of the whole drawing, cut off at the rectangle.
    pub fn clipped(&self, content: Markup) -> Markup {
        let [left, top, width, height] = self.frame().map(px);
        html! {
            svg x=(left) y=(top) width=(width) height=(height) viewBox={ (left) " " (top) " " (width) " " (height) } preserveAspectRatio="none" overflow="hidden" { (content) }
        }
    }

    /// The pixels of a point.
    pub fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.at(x), self.y.at(y)]
    }

    /// A line through points; points that are not finite break it, and one between two of them is a
    /// dot.
    pub fn curve(&self, points: &[[f64; 2]], colour: Colour, line: Line) -> Markup {
        let pixels: Vec<[f64; 2]> = points.iter().map(|point| self.at(*point)).collect();
        let pixels = thinned(&pixels, self.x.pixels);
        let is_drawn = |k: usize| {
            let point = pixels.get(k);
            point.is_some_and(|point| point.iter().all(|value| value.is_finite()))
        };
        let is_alone = |k: &usize| {
            is_drawn(*k)
                && !is_drawn(k + 1)
                && k.checked_sub(1).is_none_or(|before| !is_drawn(before))
        };
        html! {
            path d=(path(pixels.iter().copied(), false)) fill="none" stroke=(colour.hex()) stroke-width="1.8" stroke-linejoin="round" stroke-dasharray=[line.dashes()] {}
            @for [x, y] in (0..pixels.len()).filter(is_alone).map(|k| pixels[k]) {
                path d={ "M" (px(x)) " " (px(y)) "h0" } stroke=(colour.hex()) stroke-width="6" stroke-linecap="round" {}
            }
        }
    }

    /// The area between a lower and an upper curve: (x, low, high) each.
    pub fn band(&self, band: &[[f64; 3]], colour: Colour) -> Markup {
        let whole: Vec<[f64; 3]> = band
            .iter()
            .copied()
            .filter(|point| point.iter().all(|value| value.is_finite()))
            .collect();
        let edge = |of: fn(&[f64; 3]) -> [f64; 2]| -> Vec<[f64; 2]> {
            let pixels: Vec<[f64; 2]> = whole.iter().map(|point| self.at(of(point))).collect();
            thinned(&pixels, self.x.pixels)
        };
        let upper = edge(|[x, _, high]| [*x, *high]);
        let lower = edge(|[x, low, _]| [*x, *low]);
        html! {
            path d=(path(upper.into_iter().chain(lower.into_iter().rev()), true)) fill=(colour.hex()) fill-opacity="0.2" {}
        }
    }

    /// A line across the whole width.
    pub fn level(&self, value: f64, colour: Colour, line: Line) -> Markup {
        let [low, high] = self.x.limits;
        self.curve(&[[low, value], [high, value]], colour, line)
    }

    /// A dashed line from top to bottom that begins `above` the rectangle (px).
    pub fn event(&self, x: f64, above: f64) -> Markup {
        let [_, top, _, height] = self.frame();
        html! {
            path class="axis" d=(path([[self.x.at(x), top - above], [self.x.at(x), top + height]], false)) stroke=(Colour::INK.hex())
                stroke-opacity="0.65" stroke-dasharray="4 4" fill="none" {}
        }
    }
}
