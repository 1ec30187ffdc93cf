//! Quantities against time, as errors and estimated parameters: [`TimeFigure`], any number of
//! panels over one time axis.

use maud::{Markup, html};

use crate::axis::{Axis, Scale};
use crate::colour::{Colour, Line};
use crate::drawing::{Anchor, COLUMN, Drawing, LABEL, Text, px, title_lines};
use crate::font::Weight;
use crate::legend::{Legend, Swatch};
use crate::marks::{Mark, place};
use crate::plot::{Plot, STEPS};

/// Widths of a panel's surroundings (px).
const LEFT: f64 = 76.0;
const RIGHT: f64 = 18.0;
const BOTTOM: f64 = 14.0;
const TIMES: f64 = 36.0;
const TOP: f64 = 10.0;
const BAR: f64 = 9.0;

/// Quantities against time, in panels of equal size.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeFigure {
    /// Title; may be empty, as in a paper, where the caption says it.
    pub title: String,
    /// Times that are shown: from, to.
    pub span: [f64; 2],
    /// Name of the time axis with its unit.
    pub time_label: String,
    /// Time steps per unit of time, to be written under the times; `None`: not there.
    pub steps: Option<f64>,
    /// Times without a camera, from..to; shaded in every panel that has none of its own.
    pub dark: Vec<[f64; 2]>,
    /// Events, as first contacts; a line in every panel, named above the upper ones.
    pub marks: Vec<Mark>,
    /// Panels, row by row.
    pub panels: Vec<Panel>,
    /// Panels side by side.
    pub columns: usize,
    /// Size of one panel, its own axis included (px).
    pub panel_size: [f64; 2],
    /// Meaning of bands, as "10–90 % of 20 seeds"; empty: not shown.
    pub band_name: String,
}

/// One quantity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// Title above the panel, as "a) no occlusion"; may be empty.
    pub title: String,
    /// Quantity with its unit, as "position error (mm)".
    pub label: String,
    /// Spacing of values.
    pub scale: Scale,
    /// Smallest and largest value shown; `None`: a range that contains all curves and levels.
    pub limits: Option<[f64; 2]>,
    /// Smallest range that is shown, from lowest to highest; 0: as little as there is.
    pub least_span: f64,
    /// Times without a camera where they differ from the figure's.
    pub dark: Option<Vec<[f64; 2]>>,
    /// Curves; where they cover each other, dotted ones lie on dashed ones, those on solid ones,
    /// and of the same kind earlier ones on top.
    pub curves: Vec<Curve>,
    /// Values that do not change, as the truth.
    pub levels: Vec<Level>,
    /// Times of a state, drawn as bars from top to bottom.
    pub bars: Vec<Bars>,
}

/// Times at which something holds, as a contact.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bars {
    /// Name in the legend.
    pub name: String,
    /// Colour.
    pub colour: Colour,
    /// The times, from..to.
    pub times: Vec<[f64; 2]>,
}

/// One line of a panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Name in the legend; those of the same name, colour and line are listed once.
    pub name: String,
    /// Colour.
    pub colour: Colour,
    /// Style of the line.
    pub line: Line,
    /// Times and values; a NaN breaks the line.
    pub points: Vec<[f64; 2]>,
    /// Time, lower and upper end of the band about it; may be empty.
    pub band: Vec<[f64; 3]>,
}

/// A horizontal line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Level {
    /// Name in the legend.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Colour.
    pub colour: Colour,
    /// Style of the line.
    pub line: Line,
}

/// Place of a panel.
struct Place {
    corner: [f64; 2],
    size: [f64; 2],
    /// Nothing stands below it: it names the times.
    last_row: bool,
}

impl Default for TimeFigure {
    fn default() -> Self {
        Self {
            title: String::new(),
            span: [0.0, 1.0],
            time_label: "time (s)".to_owned(),
            steps: None,
            dark: Vec::new(),
            marks: Vec::new(),
            panels: Vec::new(),
            columns: 1,
            panel_size: [882.0, 250.0],
            band_name: String::new(),
        }
    }
}

impl TimeFigure {
    /// The figure, to be put next to others; on a phone its panels stand one below the other.
    #[must_use]
    pub fn drawing(&self) -> Drawing {
        let columns = self.columns.clamp(1, self.panels.len().max(1));
        let whole = self.laid_out(columns, self.panel_size);
        let column = [COLUMN.min(self.panel_size[0]), self.panel_size[1]];
        let narrow = (whole.width > COLUMN).then(|| Box::new(self.laid_out(1, column)));
        Drawing { narrow, ..whole }
    }

    /// Panels of this size (px), so many side by side.
    fn laid_out(&self, columns: usize, size: [f64; 2]) -> Drawing {
        let rows = self.panels.len().div_ceil(columns);
        let [panel_width, panel_height] = size;
        let width = columns as f64 * panel_width;
        let (heading, title) = title_lines(&self.title, LEFT, width - LEFT - RIGHT);
        let (legend, legend_height) = self.legend().draw([LEFT, title], width - LEFT - RIGHT);
        let names = place(&self.marks, &self.axis([LEFT, panel_width - RIGHT]));
        let head = title + legend_height + names.height;
        let body = html! {
            (heading)
            (legend)
            @for (index, panel) in self.panels.iter().enumerate() {
                @let corner = [(index % columns) as f64 * panel_width, head + (index / columns) as f64 * panel_height];
                @if index < columns { (names.draw([corner[0], corner[1] - names.height + TOP - 4.0])) }
                @let place = Place { corner, size, last_row: index + columns >= self.panels.len() };
                (self.panel(panel, &place))
            }
        };
        Drawing {
            width,
            height: head + rows as f64 * panel_height + TIMES + self.steps.map_or(0.0, |_| STEPS),
            label: self.title.clone(),
            body,
            narrow: None,
        }
    }

    fn axis(&self, pixels: [f64; 2]) -> Axis {
        Axis {
            scale: Scale::Linear,
            limits: self.span,
            pixels,
        }
    }

    fn panel(&self, panel: &Panel, place: &Place) -> Markup {
        let ([left, top], [width, height]) = (place.corner, place.size);
        let head = if panel.title.is_empty() {
            TOP
        } else {
            TOP + 20.0
        };
        let plot = Plot {
            x: self.axis([left + LEFT, left + width - RIGHT]),
            y: Axis {
                scale: panel.scale,
                limits: panel.shown(self.span),
                pixels: [top + height - BOTTOM, top + head],
            },
            x_label: if place.last_row { &self.time_label } else { "" },
            y_label: &panel.label,
            steps: self.steps,
        };
        let title = Text {
            weight: Weight::Bold,
            anchor: Anchor::Start,
            ..Text::at([left + LEFT, top + head - 8.0], &panel.title)
        };
        let [from, to] = self.span;
        // through the gaps of a broken line one sees what it covers
        let lowest_first = || {
            let of = |line: Line| {
                panel
                    .curves
                    .iter()
                    .rev()
                    .filter(move |curve| curve.line == line)
            };
            [Line::Solid, Line::Dashed, Line::Dotted]
                .into_iter()
                .flat_map(of)
        };
        let levels = |solid: bool| {
            let all = panel.levels.iter();
            all.filter(move |level| (level.line == Line::Solid) == solid)
        };
        let curves = html! {
            @for curve in panel.curves.iter().rev() { (plot.band(&curve.band, curve.colour)) }
            @for level in levels(true) { (plot.level(level.value, level.colour, level.line)) }
            @for curve in lowest_first() { g data-name=(curve.name) { (plot.curve(&curve.points, curve.colour, curve.line)) } }
            @for level in levels(false) { (plot.level(level.value, level.colour, level.line)) }
            @for (k, bars) in panel.bars.iter().enumerate() { (bars.draw(k, &plot)) }
            @for mark in self.marks.iter().filter(|mark| (from..=to).contains(&mark.time)) { (plot.event(mark.time, 0.0)) }
        };
        // the page's script reads values and times of figures against time, and moves what is clipped
        let numbers = |limits: [f64; 2]| limits.map(|limit| limit.to_string()).join(" ");
        html! {
            g class=[self.time_label.starts_with("time").then_some("panel")] data-time=(numbers(plot.x.limits)) data-values=(numbers(plot.y.limits)) data-log=[(panel.scale != Scale::Linear).then_some("")] data-label=(panel.label) {
                (title.sized(LABEL))
                (plot.clipped(plot.shades(panel.dark.as_ref().unwrap_or(&self.dark))))
                (plot.axes())
                (plot.clipped(curves))
            }
        }
    }

    fn legend(&self) -> Legend {
        let mut legend = Legend::default();
        let curves = || self.panels.iter().flat_map(|panel| &panel.curves);
        let drawn = curves().filter(|curve| !curve.points.is_empty());
        drawn.for_each(|curve| legend.push(Swatch::Line(curve.colour, curve.line), &curve.name));
        for level in self.panels.iter().flat_map(|panel| &panel.levels) {
            legend.push(Swatch::Line(level.colour, level.line), &level.name);
        }
        if let Some(banded) = curves().find(|curve| !curve.band.is_empty()) {
            legend.push(Swatch::Area(banded.colour), &self.band_name);
        }
        for bars in self.panels.iter().flat_map(|panel| &panel.bars) {
            legend.push(Swatch::Bar(bars.colour), &bars.name);
        }
        let dark = |panel: &Panel| !panel.dark.as_ref().unwrap_or(&self.dark).is_empty();
        if self.panels.iter().any(dark) {
            legend.push(Swatch::Dark, "camera off");
        }
        legend
    }
}

impl Bars {
    /// Draws the k-th row of bars of a panel.
    fn draw(&self, k: usize, plot: &Plot<'_>) -> Markup {
        let top = plot.y.pixels[1] + 2.0 + k as f64 * (BAR + 3.0);
        html! {
            g data-name=(self.name) {
                @for [from, to] in self.times.iter().filter(|[from, to]| from <= to) {
                    @let (left, right) = (plot.x.at(*from), plot.x.at(*to));
                    rect class=[(self.colour == Colour::INK).then_some("ink")] x=(px(left)) y=(px(top)) width=(px((right - left).max(1.0))) height=(px(BAR)) fill=(self.colour.hex()) {}
                }
            }
        }
    }
}

impl Panel {
    fn shown(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let within = |time: &f64| (from..=to).contains(time);
        let points = self
            .curves
            .iter()
            .flat_map(|curve| &curve.points)
            .filter(|[time, _]| within(time))
            .map(|[_, value]| *value);
        let bands = self
            .curves
            .iter()
            .flat_map(|curve| &curve.band)
            .filter(|[time, ..]| within(time))
            .flat_map(|[_, low, high]| [*low, *high]);
        let levels = self.levels.iter().map(|level| level.value);
        self.limits.unwrap_or_else(|| {
            let [low, high] = self.scale.limits(points.chain(bands).chain(levels));
            let more = (0.5 * (self.least_span - (high - low))).max(0.0);
            [low - more, high + more]
        })
    }
}
