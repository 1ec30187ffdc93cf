//! Shares of equal parts of 0..1: [`Histograms`], one next to another.

use maud::html;

use crate::axis::{Axis, Scale};
use crate::colour::{Colour, Line};
use crate::drawing::{Anchor, COLUMN, Drawing, LABEL, Text, px};
use crate::font::Weight;
use crate::plot::Plot;

/// Size of one, three of which fill a page, and its surroundings (px).
const SIZE: [f64; 2] = [294.0, 210.0];
const NARROW: [f64; 2] = [COLUMN, 200.0];
const LEFT: f64 = 62.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 28.0;
const BOTTOM: f64 = 52.0;

/// Histograms of one quantity on equal axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Histograms {
    /// Quantity from 0 to 1.
    pub x_label: String,
    /// Meaning of a bar's height.
    pub y_label: String,
    /// Height of every bar of an even distribution.
    pub level: f64,
    /// The histograms.
    pub all: Vec<Histogram>,
}

/// A set of bars of equal width.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Histogram {
    /// Title above it.
    pub name: String,
    /// Colour of its bars.
    pub colour: Colour,
    /// Heights of the bars from 0 to 1.
    pub bars: Vec<f64>,
}

impl Histograms {
    /// The figure, three side by side; on a phone one below the other.
    #[must_use]
    pub fn drawing(&self) -> Drawing {
        let bars = self.all.iter().flat_map(|histogram| &histogram.bars);
        let most = bars.fold(2.0 * self.level, |most, bar| most.max(*bar));
        let grid = |size: [f64; 2], columns: usize| {
            let all = self.all.iter().map(|one| self.one(one, most, size));
            Drawing::grid(&all.collect::<Vec<_>>(), columns)
        };
        Drawing {
            narrow: Some(Box::new(grid(NARROW, 1))),
            ..grid(SIZE, 3)
        }
    }

    fn one(&self, histogram: &Histogram, most: f64, [width, height]: [f64; 2]) -> Drawing {
        let plot = Plot {
            x: Axis {
                scale: Scale::Linear,
                limits: [0.0, 1.0],
                pixels: [LEFT, width - RIGHT],
            },
            y: Axis {
                scale: Scale::Linear,
                limits: [0.0, most],
                pixels: [height - BOTTOM, TOP],
            },
            x_label: &self.x_label,
            steps: None,
            y_label: &self.y_label,
        };
        let count = histogram.bars.len() as f64;
        let part = |k: usize| [k as f64 / count, (k + 1) as f64 / count];
        let title = Text {
            weight: Weight::Bold,
            anchor: Anchor::Start,
            ..Text::at([LEFT, TOP - 10.0], &histogram.name)
        };
        let body = html! {
            (title.sized(LABEL))
            (plot.axes())
            @for (k, bar) in histogram.bars.iter().enumerate() {
                @let [from, to] = part(k);
                @let ([left, top], [right, bottom]) = (plot.at([from, *bar]), plot.at([to, 0.0]));
                rect x=(px(left + 0.5)) y=(px(top)) width=(px(right - left - 1.0)) height=(px(bottom - top)) fill=(histogram.colour.hex()) fill-opacity="0.75" {
                    title { (format!("{from:.1} to {to:.1}: {bar:.1}")) }
                }
            }
            (plot.level(self.level, Colour::INK, Line::Dashed))
        };
        Drawing {
            width,
            height,
            label: format!("{}: {} over {}", histogram.name, self.y_label, self.x_label),
            body,
            narrow: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_are_as_high_as_they_say_on_equal_axes() {
        let histogram = |bars: [f64; 2]| Histogram {
            bars: bars.to_vec(),
            ..Histogram::default()
        };
        let all = Histograms {
            level: 50.0,
            all: vec![histogram([20.0, 80.0]), histogram([100.0, 0.0])],
            ..Histograms::default()
        };
        let svg = all.drawing().to_svg();
        let bars = svg.split("<rect x=").skip(1);
        let heights = bars.map(|bar| {
            let number = bar.split("height=\"").nth(1).expect("a height");
            number[..number.find('"').expect("its end")]
                .parse::<f64>()
                .expect("a number")
        });
        let heights: Vec<f64> = heights.collect();
        let room = SIZE[1] - TOP - BOTTOM;
        let shares: Vec<f64> = heights.iter().map(|height| height / room).collect();
        let expected = [0.2, 0.8, 1.0, 0.0];
        assert_eq!(shares.len(), expected.len(), "{svg}");
        let close = |(a, b): (&f64, f64)| (a - b).abs() < 1e-3;
        assert!(shares.iter().zip(expected).all(close), "{shares:?}");
    }
}
