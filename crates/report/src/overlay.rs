//! Poses over each other: [`Overlay`], bodies of one or several estimates in the plane.

use maud::{Markup, html};
use stickslip_dynamics::{Pose, Scene, Shape};

use crate::colour::{Colour, Line};
use crate::drawing::{Anchor, Drawing, GRID, LABEL, TITLE, Text, path, px};
use crate::font::Weight;
use crate::legend::{Legend, Swatch};
use crate::outline::{Outline, bounds};

/// Margins about the picture (px).
const MARGIN: f64 = 12.0;

/// Bodies over each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlay {
    /// Title; may be empty.
    pub title: String,
    /// Bodies, the lowest one first.
    pub bodies: Vec<Body>,
    /// Section of the plane that is shown: two corners (m); `None`: all bodies.
    pub view: Option<[[f64; 2]; 2]>,
    /// Width of the picture (px).
    pub width: f64,
}

/// One body at one pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Name in the legend; empty: not there.
    pub name: String,
    /// Name written on the body; may be empty.
    pub tag: String,
    /// Outline in the world (m).
    pub outline: Outline,
    /// Colour.
    pub colour: Colour,
    /// Style of its boundary.
    pub line: Line,
    /// Opacity of its inside, 0 to 1.
    pub opacity: f64,
    /// True for one of many, whose boundary is a faint hairline.
    pub thin: bool,
}

impl Default for Overlay {
    fn default() -> Self {
        Self {
            title: String::new(),
            bodies: Vec::new(),
            view: None,
            width: 480.0,
        }
    }
}

impl Body {
    /// A shape at a pose, as an outline without inside.
    #[must_use]
    pub fn new(name: &str, shape: &Shape, pose: &Pose, colour: Colour) -> Self {
        let outline = Outline::new(shape).at(pose);
        Self {
            name: name.to_owned(),
            tag: String::new(),
            outline,
            colour,
            line: Line::Solid,
            opacity: 0.0,
            thin: false,
        }
    }

    /// The body as a faint hairline, one of many.
    #[must_use]
    pub fn thin(self) -> Self {
        Self { thin: true, ..self }
    }

    /// Draws its boundary with this line.
    #[must_use]
    pub fn line(self, line: Line) -> Self {
        Self { line, ..self }
    }

    /// Covers its inside, 0 to 1.
    #[must_use]
    pub fn filled(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }

    /// Bodies about the object: fixels with their numbers, and the pusher's `fingers` that are on
    /// the table.
    #[must_use]
    pub fn surroundings(scene: &Scene, fingers: &[Option<Pose>]) -> Vec<Self> {
        let fixel = |(k, fixel): (usize, &stickslip_dynamics::Fixel)| Self {
            tag: (k + 1).to_string(),
            ..Self::new("", &fixel.shape, &fixel.pose, Colour::INK).filled(0.25)
        };
        let fingers = scene.pusher.fingers.iter().zip(fingers);
        let fingers = fingers.filter_map(|(shape, pose)| {
            Some(Self::new("", shape, pose.as_ref()?, Colour::INK).filled(0.45))
        });
        scene
            .fixels
            .iter()
            .enumerate()
            .map(fixel)
            .chain(fingers)
            .collect()
    }
}

impl Overlay {
    /// The bodies in the plane, to be put next to other drawings.
    #[must_use]
    pub fn drawing(&self) -> Drawing {
        let [[left, low], [right, high]] = self.view.unwrap_or_else(|| self.whole_view());
        let inner = self.width - 2.0 * MARGIN;
        let scale = inner / (right - left).max(1e-9);
        let map = |[x, y]: [f64; 2]| [scale * (x - left), scale * (high - y)];
        let size = [inner, scale * (high - low)];
        self.framed(size, html! { path class="grid" d=(grid_lines([left, high], scale, size)) stroke=(GRID.hex()) fill="none" {} }, scale, &map)
    }

    /// Corners of the box that contains all bodies, with some room (m).
    #[must_use]
    pub fn whole_view(&self) -> [[f64; 2]; 2] {
        let all = bounds(
            self.bodies
                .iter()
                .filter_map(|body| body.outline.bounds())
                .flatten(),
        );
        with_room(all.unwrap_or([[-0.05, -0.05], [0.05, 0.05]]))
    }

    /// Title, the picture in its frame, legend and scale, which is that of the plane (px/m).
    fn framed(
        &self,
        [width, height]: [f64; 2],
        background: Markup,
        scale: f64,
        map: &dyn Fn([f64; 2]) -> [f64; 2],
    ) -> Drawing {
        let head = if self.title.is_empty() { MARGIN } else { 34.0 };
        let foot = head + height + 8.0;
        let (bar, room) = scale_bar(scale, [MARGIN + width, foot], width);
        let (legend, legend_height) = self.legend().draw([MARGIN, foot], width - room);
        let body = html! {
            (Text { weight: Weight::Bold, ..Text::at([MARGIN, 23.0], &self.title) }.sized(TITLE))
            svg x=(px(MARGIN)) y=(px(head)) width=(px(width)) height=(px(height)) viewBox={ "0 0 " (px(width)) " " (px(height)) } overflow="hidden" {
                (background)
                @for body in &self.bodies { (body.draw(&body.outline.mapped(map))) }
            }
            rect class="axis" x=(px(MARGIN)) y=(px(head)) width=(px(width)) height=(px(height)) fill="none" stroke=(Colour::INK.hex()) {}
            (legend)
            (bar)
        };
        Drawing {
            width: self.width,
            height: foot + legend_height.max(24.0),
            label: self.title.clone(),
            body,
            narrow: None,
        }
    }

    fn legend(&self) -> Legend {
        let mut legend = Legend::default();
        self.bodies
            .iter()
            .for_each(|body| legend.push(Swatch::Line(body.colour, body.line), &body.name));
        legend
    }
}

impl Body {
    /// Draws the body with its outline in pixels.
    fn draw(&self, outline: &Outline) -> Markup {
        let area: String = outline
            .areas
            .iter()
            .map(|area| path(area.iter().copied(), true))
            .collect();
        let boundary: String = outline
            .lines
            .iter()
            .map(|line| path(line.iter().copied(), false))
            .collect();
        let middle = outline.bounds().map(|[low, high]| {
            [
                0.5 * (low[0] + high[0]),
                0.5 * (low[1] + high[1]) + 0.35 * LABEL,
            ]
        });
        html! {
            @if self.opacity > 0.0 { path d=(area) fill=(self.colour.hex()) fill-opacity=(px(self.opacity)) {} }
            path d=(boundary) fill="none" stroke=(self.colour.hex()) stroke-width=(if self.thin { "1" } else { "2" }) stroke-opacity=[self.thin.then_some("0.16")] stroke-linejoin="round" stroke-linecap="round"
                stroke-dasharray=[self.line.dashes()] {}
            @if let Some(at) = middle.filter(|_| !self.tag.is_empty()) {
                (Text { anchor: Anchor::Middle, weight: Weight::Bold, ..Text::at(at, &self.tag) }.sized(LABEL))
            }
        }
    }
}

/// A box with some room about it.
fn with_room([[left, low], [right, high]]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let room = 0.06 * (right - left).max(high - low) + 1e-4;
    [[left - room, low - room], [right + room, high + room]]
}

/// Path with a line every 10 mm, over a picture whose corner is at the left and upper end (m).
pub(crate) fn grid_lines([left, high]: [f64; 2], scale: f64, [width, height]: [f64; 2]) -> String {
    let step = 0.01;
    let count = (width.max(height) / (scale * step)).min(500.0) as u32;
    let [first_x, first_y] = [
        (left / step).ceil() * step - left,
        high - (high / step).floor() * step,
    ];
    let across = (0..=count).map(|k| scale * (first_x + step * f64::from(k)));
    let down = (0..=count).map(|k| scale * (first_y + step * f64::from(k)));
    across
        .map(|x| path([[x, 0.0], [x, height]], false))
        .chain(down.map(|y| path([[0.0, y], [width, y]], false)))
        .collect()
}

/// A bar of a round length that ends below the picture's right corner (px), with the length; and
/// the width that it takes.
fn scale_bar(scale: f64, [right, top]: [f64; 2], width: f64) -> (Markup, f64) {
    let longest = 0.25 * 1e3 * width / scale;
    let power = libm::exp10(libm::log10(longest).floor());
    let length = [5.0, 2.0, 1.0]
        .into_iter()
        .find(|factor| factor * power <= longest)
        .unwrap_or(1.0)
        * power;
    let (left, y) = (right - 1e-3 * length * scale, top + 6.0);
    let bar = html! {
        path class="axis" d=(path([[left, y], [right, y]], false)) stroke=(Colour::INK.hex()) stroke-width="3" {}
        (Text { anchor: Anchor::Middle, ..Text::at([0.5 * (left + right), y + 15.0], &format!("{} mm", px(length))) }.sized(13.0))
    };
    (bar, right - left + 20.0)
}
