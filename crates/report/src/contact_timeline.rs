//! Times of contact: [`ContactTimeline`], true contacts against sensed and estimated ones.

use maud::{Markup, html};

use crate::axis::{Axis, Scale};
use crate::colour::{Colour, Line};
use crate::drawing::{Anchor, COLUMN, Drawing, LABEL, Text, px, title_lines};
use crate::font::{Weight, width};
use crate::legend::{Legend, Swatch};
use crate::plot::Plot;

const WIDTH: f64 = 882.0;
const RIGHT: f64 = 18.0;

/// Heights of a bar, of an estimate and of the room under a body (px).
const BAR: f64 = 9.0;
const ESTIMATE: f64 = 30.0;
const GAP: f64 = 16.0;

/// Contacts of the object against time, a lane per body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactTimeline {
    /// Title; may be empty.
    pub title: String,
    /// Times that are shown (s): from, to.
    pub span: [f64; 2],
    /// Times without a camera (s), from..to.
    pub dark: Vec<[f64; 2]>,
    /// The bodies that the object can touch.
    pub bodies: Vec<ContactLane>,
}

/// One body's contact with the object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactLane {
    /// The body.
    pub name: String,
    /// Times at which it truly touches (s), from..to; `None` where they are not known.
    pub truth: Option<Vec<[f64; 2]>>,
    /// Times at which its sensor reads 1 (s), from..to; `None` where it has none.
    pub sensed: Option<Vec<[f64; 2]>>,
    /// Estimated probabilities of contact.
    pub estimates: Vec<ContactEstimate>,
}

/// A method's probability of contact.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactEstimate {
    /// The method.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// Times (s) and probabilities, 0 to 1.
    pub points: Vec<[f64; 2]>,
}

impl ContactLane {
    fn height(&self) -> f64 {
        let bars = usize::from(self.truth.is_some()) + usize::from(self.sensed.is_some());
        (bars as f64 * (BAR + 3.0) + self.estimates.len() as f64 * (ESTIMATE + 3.0)).max(BAR) + GAP
    }
}

impl ContactTimeline {
    /// Returns true if anything is known of any contact.
    #[must_use]
    pub fn tells(&self) -> bool {
        let known = |body: &ContactLane| {
            body.truth.is_some() || body.sensed.is_some() || !body.estimates.is_empty()
        };
        self.bodies.iter().any(known)
    }

    /// The figure as SVG text.
    #[must_use]
    pub fn to_svg(&self) -> String {
        self.drawing().to_svg()
    }

    /// The figure, to be put next to others.
    #[must_use]
    pub fn drawing(&self) -> Drawing {
        let narrow = Some(Box::new(self.of_width(COLUMN)));
        Drawing {
            narrow,
            ..self.of_width(WIDTH)
        }
    }

    /// The figure in so much room (px).
    fn of_width(&self, room: f64) -> Drawing {
        let names = self
            .bodies
            .iter()
            .map(|body| width(&body.name, LABEL, Weight::Regular));
        let left = names.fold(56.0, f64::max) + 20.0;
        let (heading, title) = title_lines(&self.title, left, room - left - RIGHT);
        let (legend, legend_height) = self.legend().draw([left, title], room - left - RIGHT);
        let top = title + legend_height + 8.0;
        let lanes: f64 = self.bodies.iter().map(ContactLane::height).sum();
        let bottom = top + lanes.max(BAR) + 4.0;
        let x = Axis {
            scale: Scale::Linear,
            limits: self.span,
            pixels: [left, room - RIGHT],
        };
        let plot = |[bottom, top]: [f64; 2]| Plot {
            x,
            y: Axis {
                scale: Scale::Linear,
                limits: [0.0, 1.0],
                pixels: [bottom, top],
            },
            x_label: "time (s)",
            steps: None,
            y_label: "",
        };
        let whole = plot([bottom, top]);
        let body = html! {
            (heading)
            (legend)
            (whole.shades(&self.dark))
            (whole.time_axis())
            @for (body, at) in self.bodies.iter().zip(self.tops(top + 8.0)) { (body.draw(at, &plot)) }
        };
        Drawing {
            width: room,
            height: bottom + 48.0,
            label: self.title.clone(),
            body,
            narrow: None,
        }
    }

    /// The upper end of each lane (px).
    fn tops(&self, first: f64) -> Vec<f64> {
        let mut next = first;
        let lane = |body: &ContactLane| {
            let top = next;
            next += body.height();
            top
        };
        self.bodies.iter().map(lane).collect()
    }

    fn legend(&self) -> Legend {
        let mut legend = Legend::default();
        if self.bodies.iter().any(|body| body.truth.is_some()) {
            legend.push(Swatch::Bar(Colour::INK), "touches");
        }
        if self.bodies.iter().any(|body| body.sensed.is_some()) {
            legend.push(Swatch::Bar(Colour::GREY), "sensor says so");
        }
        for estimate in self.bodies.iter().flat_map(|body| &body.estimates) {
            legend.push(
                Swatch::Area(estimate.colour),
                &format!("{}: probability, 0 to 1", estimate.name),
            );
        }
        if !self.dark.is_empty() {
            legend.push(Swatch::Dark, "camera off");
        }
        legend
    }
}

impl ContactLane {
    fn draw<'p>(&self, top: f64, plot: &dyn Fn([f64; 2]) -> Plot<'p>) -> Markup {
        let bars = [(&self.truth, Colour::INK), (&self.sensed, Colour::GREY)];
        let bars = bars
            .into_iter()
            .filter_map(|(times, colour)| times.as_ref().map(|times| (times, colour)));
        let mut next = top;
        let mut place = |height: f64| {
            let at = next;
            next += height + 3.0;
            [at + height, at]
        };
        let left = plot([1.0, 0.0]).x.pixels[0];
        html! {
            (Text { anchor: Anchor::End, ..Text::at([left - 9.0, top + 0.5 * (self.height() - GAP) + 0.35 * LABEL], &self.name) }.sized(LABEL))
            @for (times, colour) in bars { (intervals(&plot(place(BAR)), times, colour)) }
            @for estimate in &self.estimates { (probability(&plot(place(ESTIMATE)), estimate)) }
        }
    }
}

fn intervals(plot: &Plot<'_>, times: &[[f64; 2]], colour: Colour) -> Markup {
    let bars = html! {
        @for [from, to] in times.iter().filter(|[from, to]| from <= to) {
            @let (left, right) = (plot.x.at(*from), plot.x.at(*to));
            rect class=[(colour == Colour::INK).then_some("ink")] x=(px(left)) y=(px(plot.y.pixels[1])) width=(px((right - left).max(1.0))) height=(px(BAR)) fill=(colour.hex()) {}
        }
    };
    plot.clipped(bars)
}

fn probability(plot: &Plot<'_>, estimate: &ContactEstimate) -> Markup {
    let band: Vec<[f64; 3]> = estimate
        .points
        .iter()
        .map(|[time, p]| [*time, 0.0, *p])
        .collect();
    html! {
        (plot.level(0.0, Colour::GREY, Line::Dotted))
        (plot.clipped(html! { (plot.band(&band, estimate.colour)) (plot.curve(&estimate.points, estimate.colour, Line::Solid)) }))
    }
}
