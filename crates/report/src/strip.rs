//! Distributions side by side: [`StripPlot`], a dot per value, their median and a mark.

use maud::{Markup, html};

use crate::axis::{Axis, Scale};
use crate::colour::Colour;
use crate::drawing::{Anchor, COLUMN, Drawing, GRID, LABEL, Text, path, px};
use crate::font::{Weight, width};
use crate::legend::{Legend, Swatch};
use crate::plot::Plot;

const WIDTH: f64 = 882.0;
const RIGHT: f64 = 18.0;

/// Heights of a lane, and of the room between groups (px).
const LANE: f64 = 22.0;
const GAP: f64 = 10.0;

/// Values on one axis, a lane for each set of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StripPlot {
    /// Description, for those who cannot see it.
    pub label: String,
    /// Quantity and unit.
    pub x_label: String,
    /// Spacing of values.
    pub scale: Scale,
    /// A value that is marked from top to bottom.
    pub level: Option<f64>,
    /// Meaning of the marks; empty where there are none.
    pub mark_name: String,
    /// Groups of lanes, from top to bottom.
    pub groups: Vec<StripGroup>,
}

/// Lanes under one name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StripGroup {
    /// The name.
    pub name: String,
    /// The lanes.
    pub lanes: Vec<StripLane>,
}

/// A set of values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StripLane {
    /// Name in the legend; lanes of one name have one colour.
    pub name: String,
    /// Colour of its dots.
    pub colour: Colour,
    /// The values.
    pub values: Vec<f64>,
    /// Source of each value, shown where the pointer rests on it; may be empty.
    pub labels: Vec<String>,
    /// Interval of their median.
    pub interval: Option<[f64; 2]>,
    /// A value to compare them with.
    pub mark: Option<f64>,
}

impl StripPlot {
    /// The figure, to be put next to others.
    #[must_use]
    pub fn drawing(&self) -> Drawing {
        Drawing {
            narrow: Some(Box::new(self.of_width(COLUMN))),
            ..self.of_width(WIDTH)
        }
    }

    fn of_width(&self, room: f64) -> Drawing {
        let names = self.groups.iter().map(|group| &group.name);
        let widest = names.map(|name| width(name, LABEL, Weight::Regular));
        let left = widest.fold(0.0, f64::max) + 24.0;
        let (legend, legend_height) = self.legend().draw([left, 0.0], room - left - RIGHT);
        let top = legend_height + 8.0;
        let heights = self.groups.iter().map(StripGroup::height);
        let bottom = top + heights.sum::<f64>();
        let lanes = self.groups.iter().flat_map(|group| &group.lanes);
        let of_lane = |lane: &StripLane| {
            let ends = lane.interval.into_iter().flatten().chain(lane.mark);
            lane.values.iter().copied().chain(ends).collect::<Vec<_>>()
        };
        let values = lanes.flat_map(of_lane);
        let plot = Plot {
            x: Axis {
                scale: self.scale,
                limits: self.scale.limits(values.chain(self.level)),
                pixels: [left, room - RIGHT],
            },
            y: Axis {
                scale: Scale::Linear,
                limits: [0.0, 1.0],
                pixels: [bottom, top],
            },
            x_label: &self.x_label,
            steps: None,
            y_label: "",
        };
        let mut below = top;
        let body = html! {
            (legend)
            (plot.time_axis())
            @if let Some(level) = self.level { (plot.event(level, 0.0)) }
            @for group in &self.groups {
                (group.draw(below, &plot))
                ({ below += group.height(); "" })
            }
        };
        Drawing {
            width: room,
            height: bottom + 48.0,
            label: self.label.clone(),
            body,
            narrow: None,
        }
    }

    fn legend(&self) -> Legend {
        let mut legend = Legend::default();
        for lane in self.groups.iter().flat_map(|group| &group.lanes) {
            legend.push(Swatch::Bar(lane.colour), &lane.name);
        }
        legend.push(Swatch::Bar(Colour::INK), &self.mark_name);
        legend
    }
}

impl StripGroup {
    fn height(&self) -> f64 {
        self.lanes.len() as f64 * LANE + GAP
    }

    fn draw(&self, top: f64, plot: &Plot<'_>) -> Markup {
        let [left, right] = plot.x.pixels;
        let middle = top + 0.5 * (self.height() - GAP) + 0.35 * LABEL;
        let under = top + self.height() - 0.5 * GAP;
        let centres = (0..self.lanes.len()).map(|k| top + (k as f64 + 0.5) * LANE);
        html! {
            (Text { anchor: Anchor::End, ..Text::at([left - 9.0, middle], &self.name) }.sized(LABEL))
            path class="grid" d=(path([[left, under], [right, under]], false)) stroke=(GRID.hex()) fill="none" {}
            @for (lane, centre) in self.lanes.iter().zip(centres) { (lane.draw(centre, plot)) }
        }
    }
}

impl StripLane {
    /// The dots, a bar at their median with its interval, and the mark.
    fn draw(&self, centre: f64, plot: &Plot<'_>) -> Markup {
        let at = |value: &f64| plot.x.at(*value);
        let bar = |value: f64, half: f64| {
            let x = plot.x.at(value);
            path([[x, centre - half], [x, centre + half]], false)
        };
        let colour = self.colour.hex();
        html! {
            @for (k, value) in self.values.iter().enumerate() {
                circle cx=(px(at(value))) cy=(px(centre)) r="3.5" fill=(colour) fill-opacity="0.45" {
                    @if let Some(label) = self.labels.get(k) { title { (label) } }
                }
            }
            @if let Some(ends) = &self.interval {
                path class="axis" d=(path(ends.map(|end| [at(&end), centre]), false)) stroke=(Colour::INK.hex()) stroke-width="2" fill="none" {}
            }
            @if let Some(median) = stickslip_evaluation::quantile(&self.values, 0.5) {
                path d=(bar(median, 8.0)) stroke=(colour) stroke-width="3" fill="none" {}
            }
            @if let Some(mark) = self.mark {
                path class="axis" d=(bar(mark, 9.0)) stroke=(Colour::INK.hex()) stroke-width="2" fill="none" {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_a_dot_within_the_axes() {
        let lane = |values: &[f64]| StripLane {
            name: "with touch".to_owned(),
            values: values.to_vec(),
            labels: vec!["a <log>".to_owned()],
            interval: Some([0.2, 4.0]),
            mark: Some(30.0),
            ..StripLane::default()
        };
        let group = |values| StripGroup {
            name: "1".to_owned(),
            lanes: vec![lane(values)],
        };
        let plot = StripPlot {
            scale: Scale::Log { floor: 0.1 },
            x_label: "mm".to_owned(),
            groups: vec![group(&[0.01, 0.5, 12.0]), group(&[2.0])],
            ..StripPlot::default()
        };
        let drawing = plot.drawing();
        let svg = drawing.to_svg();
        let places = svg.split("cx=\"").skip(1);
        let places: Vec<f64> = places
            .map(|rest| rest[..rest.find('"').unwrap()].parse().unwrap())
            .collect();
        assert_eq!(places.len(), 4);
        assert_eq!(svg.matches("<title>a &lt;log&gt;</title>").count(), 2);
        let inside = |x: &f64| (30.0..=drawing.width - RIGHT).contains(x);
        assert!(places.iter().all(inside), "{places:?}");
        assert!(places[0] < places[1] && places[3] < places[2]);
    }
}
