//! Points in a plane of two quantities: [`ScatterPlot`].

use maud::html;

use crate::axis::{Axis, Scale};
use crate::colour::{Colour, Line};
use crate::drawing::{COLUMN, Drawing, px};
use crate::legend::{Legend, Swatch};
use crate::plot::Plot;

const LEFT: f64 = 98.0;
const RIGHT: f64 = 18.0;

/// Sets of points on two axes of equal length, each with its own scale.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScatterPlot {
    /// Description, for those who cannot see it.
    pub label: String,
    /// Quantities and units, of x and y.
    pub axis_labels: [String; 2],
    /// A point that is marked by lines across.
    pub mark: Option<[f64; 2]>,
    /// The points.
    pub sets: Vec<PointSet>,
}

/// A set of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointSet {
    /// Name in the legend; empty: not there.
    pub name: String,
    /// Colour of its dots.
    pub colour: Colour,
    /// The points.
    pub points: Vec<[f64; 2]>,
}

impl ScatterPlot {
    /// The figure, one column wide.
    #[must_use]
    pub fn drawing(&self) -> Drawing {
        let mut legend = Legend::default();
        for set in &self.sets {
            legend.push(Swatch::Bar(set.colour), &set.name);
        }
        let side = COLUMN - LEFT - RIGHT;
        let (legend, legend_height) = legend.draw([LEFT, 0.0], side);
        let top = legend_height + 8.0;
        let [x, y] = self.limits();
        let axis = |limits, pixels| Axis {
            scale: Scale::Linear,
            limits,
            pixels,
        };
        let plot = Plot {
            x: axis(x, [LEFT, LEFT + side]),
            y: axis(y, [top + side, top]),
            x_label: &self.axis_labels[0],
            steps: None,
            y_label: &self.axis_labels[1],
        };
        let dots = |set: &PointSet| {
            let points = set.points.iter();
            let points = points.filter(|point| point.iter().all(|x| x.is_finite()));
            html! {
                @for point in points {
                    @let [x, y] = plot.at(*point);
                    circle cx=(px(x)) cy=(px(y)) r="3.5" fill=(set.colour.hex()) fill-opacity="0.45" {}
                }
            }
        };
        let body = html! {
            (legend)
            (plot.axes())
            @if let Some([x, y]) = self.mark {
                (plot.event(x, 0.0))
                (plot.level(y, Colour::INK, Line::Dashed))
            }
            @for set in &self.sets { (dots(set)) }
        };
        Drawing {
            width: COLUMN,
            height: top + side + 48.0,
            label: self.label.clone(),
            body,
            narrow: None,
        }
    }

    /// Limits of both axes.
    fn limits(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|axis| {
            let points = self.sets.iter().flat_map(|set| &set.points);
            let values = points.chain(&self.mark).map(|point| point[axis]);
            Scale::Linear.limits(values)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_dots_and_gaps_are_none() {
        let set = PointSet {
            name: "fitted".to_owned(),
            points: vec![[0.0, 0.0], [f64::NAN, 1.0], [2.0, 1.0]],
            ..PointSet::default()
        };
        let plot = ScatterPlot {
            sets: vec![set],
            ..ScatterPlot::default()
        };
        let svg = plot.drawing().to_svg();
        let places = |key: &str| -> Vec<f64> {
            let places = svg.split(key).skip(1);
            places
                .map(|rest| rest[..rest.find('"').unwrap()].parse().unwrap())
                .collect()
        };
        let ([x, y], [z, w]) = (
            <[f64; 2]>::try_from(places("cx=\"")).unwrap(),
            <[f64; 2]>::try_from(places("cy=\"")).unwrap(),
        );
        // both span their axes
        assert!(((y - x) - (z - w)).abs() < 0.1, "{x} {y} {z} {w}");
    }
}
