//! A particle set at one instant: [`ParticleCloud`], each particle a point with a stroke along its
//! heading.

use maud::{Markup, html};
use stickslip_dynamics::Pose;

use crate::axis::{Axis, Scale};
use crate::colour::{Colour, Line};
use crate::drawing::{Drawing, TITLE, Text, path, px};
use crate::font::Weight;
use crate::legend::{Legend, Swatch};
use crate::outline::bounds;
use crate::plot::Plot;

/// Surroundings of the square (px).
const LEFT: f64 = 76.0;
const RIGHT: f64 = 18.0;
const BOTTOM: f64 = 50.0;

/// Length of a heading's stroke (px).
const STROKE: f64 = 9.0;

/// Particles about a pose; everything is drawn relative to `centre`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticleCloud {
    /// Title; may be empty.
    pub title: String,
    /// The pose at the middle of the axes, as the estimate.
    pub centre: Pose,
    /// Poses of particles, all of the same weight.
    pub particles: Vec<Pose>,
    /// Colour of the particles.
    pub colour: Colour,
    /// Poses to compare with: name, colour, pose.
    pub compared: Vec<(String, Colour, Pose)>,
    /// Turns are drawn this many times larger; at least 1 to be seen.
    pub turn_factor: f64,
    /// Width of the picture (px); 0: 480.
    pub width: f64,
}

impl ParticleCloud {
    /// The figure, to be put next to others.
    #[must_use]
    pub fn drawing(&self) -> Drawing {
        let width = if self.width > 0.0 { self.width } else { 480.0 };
        let side = width - LEFT - RIGHT;
        let title = if self.title.is_empty() { 6.0 } else { 32.0 };
        let (legend, legend_height) = self.legend().draw([LEFT, title], side);
        let top = title + legend_height + 8.0;
        let (x_limits, y_limits) = self.limits();
        let plot = Plot {
            x: Axis {
                scale: Scale::Linear,
                limits: x_limits,
                pixels: [LEFT, LEFT + side],
            },
            y: Axis {
                scale: Scale::Linear,
                limits: y_limits,
                pixels: [top + side, top],
            },
            x_label: "x \u{2212} estimate (mm)",
            steps: None,
            y_label: "y \u{2212} estimate (mm)",
        };
        let points = html! {
            @for pose in &self.particles { (self.particle(&plot, pose, self.colour, 0.35)) }
            (plot.curve(&self.ellipse(), self.colour, Line::Solid))
            @for (_, colour, pose) in &self.compared { (self.particle(&plot, pose, *colour, 1.0)) }
        };
        let body = html! {
            (Text { weight: Weight::Bold, ..Text::at([LEFT, 22.0], &self.title) }.sized(TITLE))
            (legend)
            (plot.axes())
            (plot.clipped(points))
        };
        Drawing {
            width,
            height: top + side + BOTTOM,
            label: self.title.clone(),
            body,
            narrow: None,
        }
    }

    /// Ellipse that contains 95 % of a normal distribution with the particles' mean and covariance
    /// (mm, from the centre).
    fn ellipse(&self) -> Vec<[f64; 2]> {
        let count = self.particles.len() as f64;
        let points = || self.particles.iter().map(|pose| self.relative(pose));
        let mean = |of: &dyn Fn([f64; 2]) -> f64| points().fold(0.0, |sum, p| sum + of(p)) / count;
        let (x, y) = (mean(&|[x, _]| x), mean(&|[_, y]| y));
        let (xx, yy) = (mean(&|p| (p[0] - x).powi(2)), mean(&|p| (p[1] - y).powi(2)));
        let xy = mean(&|p| (p[0] - x) * (p[1] - y));

        // Cholesky's factor maps the circle onto it
        let a = xx.sqrt();
        let b = if a > 0.0 { xy / a } else { 0.0 };
        let c = (yy - b * b).max(0.0).sqrt();
        let radius = (-2.0 * libm::log(0.05)).sqrt();
        let at = |k: u32| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 72.0);
            [x + radius * a * cos, y + radius * (b * cos + c * sin)]
        };
        (0..=72).map(at).collect()
    }

    /// A pose from the centre (mm).
    fn relative(&self, pose: &Pose) -> [f64; 2] {
        [
            1e3 * (pose.x - self.centre.x),
            1e3 * (pose.y - self.centre.y),
        ]
    }

    /// Limits of equal length on both axes.
    fn limits(&self) -> ([f64; 2], [f64; 2]) {
        let all = self
            .particles
            .iter()
            .chain(self.compared.iter().map(|(.., pose)| pose))
            .map(|pose| self.relative(pose))
            .chain(self.ellipse())
            .filter(|point| point.iter().all(|x| x.is_finite()));
        let [[left, low], [right, high]] = bounds(all).unwrap_or([[-1.0; 2], [1.0; 2]]);
        let half = (0.6 * (right - left).max(high - low)).max(1e-3);
        let about = |low: f64, high: f64| [0.5 * (low + high) - half, 0.5 * (low + high) + half];
        (about(left, right), about(low, high))
    }

    fn particle(&self, plot: &Plot<'_>, pose: &Pose, colour: Colour, opacity: f64) -> Markup {
        let [x, y] = plot.at(self.relative(pose));
        let (sin, cos) = libm::sincos(self.turn_factor.max(1.0) * (pose.theta - self.centre.theta));
        let stroke = path([[x, y], [x + STROKE * cos, y - STROKE * sin]], false);
        html! {
            g opacity=(px(opacity)) {
                circle cx=(px(x)) cy=(px(y)) r=(if opacity < 1.0 { "2.2" } else { "4.5" }) class=[(colour == Colour::INK).then_some("ink")] fill=(colour.hex()) {}
                path d=(stroke) stroke=(colour.hex()) stroke-width=(if opacity < 1.0 { "1.2" } else { "2.5" }) fill="none" {}
            }
        }
    }

    fn legend(&self) -> Legend {
        let mut legend = Legend::default();
        let factor = self.turn_factor.max(1.0);
        legend.push(
            Swatch::Area(self.colour),
            &format!(
                "{} particles (stroke: turn \u{d7} {})",
                self.particles.len(),
                px(factor)
            ),
        );
        self.compared
            .iter()
            .for_each(|(name, colour, _)| legend.push(Swatch::Bar(*colour), name));
        legend
    }
}
