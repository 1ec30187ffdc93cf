//! An experiment as a moving picture that needs no script: [`ReportedExperiment::animation`].
//!
//! The SVG moves by itself (SMIL), also inside an `img` element. A viewer without motion shows the
//! last frame.

use maud::{Markup, html};
use stickslip::dynamics::{Pose, Shape};

use crate::colour::{Colour, Line};
use crate::drawing::{Anchor, Drawing, LABEL, TITLE, Text, path, px};
use crate::font::Weight;
use crate::outline::{Outline, bounds};
use crate::overlay::grid_lines;
use crate::reported_experiment::ReportedExperiment;
use crate::reported_run::ReportedRun;

/// Frames of the motion, at most.
const FRAMES: usize = 72;

/// Frames that the last one stays.
const HOLD: usize = 24;

/// Size of the picture of the table, and width of the list of methods (px).
const TABLE: [f64; 2] = [520.0, 400.0];
const LIST: f64 = 330.0;

/// Table with the camera on and off.
const ON: &str = "#f6f3ec";
const OFF: &str = "#2a2833";

/// A moving picture under construction.
struct Animation {
    /// Rows of the frames.
    rows: Vec<usize>,
    /// Length (s).
    seconds: f64,
    /// Left and upper end of the table shown (m), and its scale (px/m).
    corner: [f64; 2],
    scale: f64,
}

impl ReportedExperiment<'_> {
    /// Moving picture of the truth, the estimates and the learner's particles, with a list of the
    /// methods and their errors.
    #[must_use]
    pub fn animation(&self) -> Drawing {
        let animation = Animation::of(self);
        let scene = &self.setup.scene;
        let truth: Vec<_> = animation.poses(|row| self.reference.pose_at(self.time_of(row)));
        let fingers = scene.pusher.fingers.iter().zip(self.log.fingers());
        let fingers: Vec<_> = fingers
            .map(|(shape, poses)| {
                (
                    shape,
                    animation.poses(|row| poses.get(row).copied().flatten()),
                )
            })
            .collect();
        let of_run = |run: &ReportedRun| {
            animation.poses(|row| run.scored.estimate.rows.get(row).and_then(|row| row.pose))
        };
        let shape = &scene.object.shape;
        let moving = &animation;
        let particles = self.learner().into_iter().flat_map(|run| {
            let count = run.cloud.iter().map(Vec::len).max().unwrap_or(0);
            let particle = move |k: usize| {
                let poses = moving.poses(|row| run.cloud.get(row)?.get(k).copied());
                moving.outline(shape, &poses, thin(run.colour()))
            };
            (0..count).map(particle)
        });
        let particles: Vec<Markup> = particles.collect();
        let mut drawn: Vec<&ReportedRun> = self.drawn().collect();
        drawn.sort_by_key(|run| Line::of(run.scored.variant));
        let off = self.blind();
        let off = animation.on_off(|row| off.get(row) == Some(&true));
        let [wide, high] = TABLE;
        let body = html! {
            svg width=(px(wide)) height=(px(high)) viewBox={ "0 0 " (px(wide)) " " (px(high)) } overflow="hidden" {
                rect width=(px(wide)) height=(px(high)) fill=(ON) {}
                rect width=(px(wide)) height=(px(high)) fill=(OFF) { (off) }
                path d=(grid_lines(animation.corner, animation.scale, TABLE)) stroke="#8a8794" stroke-opacity="0.25" fill="none" {}
                (animation.filled(shape, &truth, "0.45"))
                @for (finger, poses) in &fingers { (animation.filled(finger, poses, "0.9")) }
                @for fixel in &scene.fixels { (animation.filled(&fixel.shape, &[fixel.pose], "0.9")) }
                @for particle in &particles { (particle) }
                @for run in drawn { (animation.outline(shape, &of_run(run), thick(run))) }
            }
            g transform="translate(12 12)" {
                (badge("camera on", "#009e73"))
                g { (off) (badge("camera off", "#d55e00")) }
            }
            g transform={ "translate(" (px(wide + 18.0)) " 0)" } { (self.list()) }
        };
        Drawing {
            width: wide + LIST,
            height: high,
            label: self.title(),
            body,
            narrow: None,
        }
    }

    /// Methods with their errors, then the truth.
    fn list(&self) -> Markup {
        let line = |k: usize| 60.0 + 34.0 * k as f64;
        let entries: Vec<(String, Colour, Option<f64>, Option<&str>)> = self
            .drawn()
            .map(|run| {
                let dashes = Line::of(run.scored.variant).dashes();
                (run.title().to_owned(), run.colour(), run.wmse_mm(), dashes)
            })
            .collect();
        let last = entries.len();
        html! {
            (Text { weight: Weight::Bold, ..Text::at([0.0, 26.0], "pose RMSE, camera off") }.sized(TITLE))
            @for (k, (name, colour, error, dashes)) in entries.into_iter().enumerate() {
                path d={ "M0 " (px(line(k) - 5.0)) "h26" } stroke=(colour.hex()) stroke-width="3" stroke-dasharray=[dashes] fill="none" {}
                (Text::at([36.0, line(k)], &name).sized(LABEL))
                @if let Some(error) = error { (Text { anchor: Anchor::End, ..Text::at([LIST - 30.0, line(k)], &format!("{error:.1} mm")) }.sized(LABEL)) }
            }
            path d={ "M0 " (px(line(last) - 5.0)) "h26" } stroke="#8f8c9c" stroke-width="12" fill="none" {}
            (Text::at([36.0, line(last)], &self.reference_name).sized(LABEL))
            @if self.learner().is_some() { (Text::at([0.0, line(last + 1)], "thin outlines: particles (the belief)").sized(LABEL)) }
        }
    }
}

impl Animation {
    fn of(experiment: &ReportedExperiment<'_>) -> Self {
        let [from, to] = experiment.span().map(|time| experiment.row_at(time));
        let every = (to - from).div_ceil(FRAMES).max(1);
        let rows: Vec<usize> = (from..to).step_by(every).chain([to]).collect();

        // the fixels and the whole way of fingers and object are in the picture
        let shape = &experiment.setup.scene.object.shape;
        let outline = Outline::new(shape);
        let poses = rows
            .iter()
            .filter_map(|row| experiment.reference.pose_at(experiment.time_of(*row)));
        let objects = poses.map(|pose| outline.at(&pose));
        let others = rows.iter().flat_map(|row| experiment.known_bodies(*row));
        let corners = objects
            .chain(others.map(|body| body.outline))
            .filter_map(|outline| outline.bounds());
        let [low, high] = bounds(corners.flatten()).unwrap_or([[-0.05; 2], [0.05; 2]]);
        let size = [0, 1].map(|k| 1.12 * (high[k] - low[k]).max(1e-3));
        let scale = (TABLE[0] / size[0]).min(TABLE[1] / size[1]);
        let middle = [0, 1].map(|k| 0.5 * (low[k] + high[k]));
        Self {
            seconds: experiment.time_of(to) - experiment.time_of(from),
            rows,
            corner: [
                middle[0] - 0.5 * TABLE[0] / scale,
                middle[1] + 0.5 * TABLE[1] / scale,
            ],
            scale,
        }
    }

    /// Poses at the frames; one that is missing is the one before.
    fn poses(&self, of: impl Fn(usize) -> Option<Pose>) -> Vec<Pose> {
        let first = self.rows.iter().find_map(|row| of(*row));
        let mut last = first.unwrap_or_default();
        let pose = |row: &usize| {
            last = of(*row).unwrap_or(last);
            last
        };
        self.rows.iter().map(pose).collect()
    }

    /// A body filled in ink, at one pose for each frame or at a single one.
    fn filled(&self, shape: &Shape, poses: &[Pose], opacity: &str) -> Markup {
        let outline = self.local(shape);
        let area: String = outline
            .areas
            .iter()
            .map(|area| path(area.iter().copied(), true))
            .collect();
        self.moved(
            poses,
            html! { path d=(area) fill="#8f8c9c" fill-opacity=(opacity) {} },
        )
    }

    /// The boundary of a body.
    fn outline(&self, shape: &Shape, poses: &[Pose], pen: Pen) -> Markup {
        let outline = self.local(shape);
        let line: String = outline
            .lines
            .iter()
            .map(|line| path(line.iter().copied(), false))
            .collect();
        self.moved(
            poses,
            html! { path d=(line) fill="none" stroke=(pen.colour.hex()) stroke-width=(pen.width) stroke-opacity=(pen.opacity) stroke-dasharray=[pen.dashes] stroke-linejoin="round" {} },
        )
    }

    /// Outline of a shape about its origin (px, downwards).
    fn local(&self, shape: &Shape) -> Outline {
        let scale = self.scale;
        Outline::new(shape).mapped(&|[x, y]| [scale * x, -scale * y])
    }

    /// Something at the last pose, or moving through all of them.
    fn moved(&self, poses: &[Pose], body: Markup) -> Markup {
        let place = |pose: &Pose| {
            let [x, y] = [
                self.scale * (pose.x - self.corner[0]),
                self.scale * (self.corner[1] - pose.y),
            ];
            format!("{} {}", tenth(x), tenth(y))
        };
        let turn = |pose: &Pose| tenth(-pose.theta.to_degrees());
        let Some(last) = poses.last() else {
            return html! {};
        };
        let moves = poses.len() > 1;
        html! {
            g transform={ "translate(" (place(last)) ")" } {
                @if moves { (self.transform("translate", poses.iter().map(place))) }
                g transform={ "rotate(" (turn(last)) ")" } {
                    @if moves { (self.transform("rotate", poses.iter().map(turn))) }
                    (body)
                }
            }
        }
    }

    fn transform(&self, kind: &str, values: impl Iterator<Item = String>) -> Markup {
        let values = self.held(values.collect());
        html! { animateTransform attributeName="transform" type=(kind) dur=(self.length()) repeatCount="indefinite" values=(values) {} }
    }

    /// Shows an element at the frames where `on` is true.
    fn on_off(&self, on: impl Fn(usize) -> bool) -> Markup {
        let values = self.rows.iter().map(|row| u8::from(on(*row)).to_string());
        let values = self.held(values.collect());
        html! { animate attributeName="opacity" calcMode="discrete" dur=(self.length()) repeatCount="indefinite" values=(values) {} }
    }

    /// The values of all frames, the last one held.
    fn held(&self, mut values: Vec<String>) -> String {
        let last = values.last().cloned().unwrap_or_default();
        values.extend(std::iter::repeat_n(last, HOLD));
        values.join(";")
    }

    fn length(&self) -> String {
        let frames = self.rows.len() as f64;
        format!("{}s", px(self.seconds * (1.0 + HOLD as f64 / frames)))
    }
}

/// A pen for outlines.
struct Pen {
    colour: Colour,
    width: &'static str,
    opacity: &'static str,
    dashes: Option<&'static str>,
}

fn thin(colour: Colour) -> Pen {
    Pen {
        colour,
        width: "1",
        opacity: "0.2",
        dashes: None,
    }
}

fn thick(run: &ReportedRun) -> Pen {
    Pen {
        colour: run.colour(),
        width: "2.5",
        opacity: "1",
        dashes: Line::of(run.scored.variant).dashes(),
    }
}

fn badge(text: &str, fill: &str) -> Markup {
    html! {
        rect width="104" height="26" rx="13" fill=(fill) {}
        text x="52" y="18" text-anchor="middle" font-weight="bold" fill="#ffffff" { (text) }
    }
}

/// A number with at most one decimal.
fn tenth(value: f64) -> String {
    px((10.0 * value).round() / 10.0)
}
