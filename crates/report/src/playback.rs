//! An experiment that a page plays back: [`Playback`].

use std::iter::StepBy;
use std::ops::Range;

use maud::{Markup, PreEscaped, html};
use stickslip::dynamics::{Pose, Scene};
use stickslip::{Estimate, Log};
use stickslip_evaluation::Reference;

use crate::colour::{Colour, Line};
use crate::curves::PoseError;
use crate::marks::Mark;
use crate::outline::Outline;
use crate::playback_data::{data, has_cloud, knows_contacts};

/// The most rows that a page plays back; of a longer log every second, third, … row is taken.
const MOST_ROWS: usize = 3000;

/// Data of an experiment that is shown row by row; every column has one entry per row of the log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Playback {
    /// Name of the experiment, for those who cannot see it.
    pub name: String,
    /// Time of each row (s).
    pub time: Vec<f64>,
    /// The part that is played first and that the picture fits; all rows can be seen.
    pub focus: Range<usize>,
    /// The row that is shown first.
    pub poster: usize,
    /// The object in its own frame (m).
    pub object: Outline,
    /// The object's feet in its frame (m), to be drawn; none where they are not.
    pub feet: Vec<[f64; 2]>,
    /// The pusher and a hand's other fingers, each in its own frame (m).
    pub fingers: Vec<Outline>,
    /// The fixels in the world (m).
    pub fixels: Vec<Outline>,
    /// Poses of the object: its truth, or the camera's measurements.
    pub reference: Vec<Option<Pose>>,
    /// Name of these poses, as "truth".
    pub reference_name: String,
    /// Measured poses of each of them.
    pub finger_poses: Vec<Vec<Option<Pose>>>,
    /// True for rows at which the camera was off.
    pub hidden: Vec<bool>,
    /// Contacts of the object: with the pusher, each fixel, then each other finger.
    pub touches: Vec<Touch>,
    /// Events that are named on the time bar.
    pub marks: Vec<Mark>,
    /// The runs.
    pub runs: Vec<PlaybackRun>,
    /// Order in which they are drawn, by number; those that agree cover each other. Runs that are
    /// not here follow.
    pub lowest_first: Vec<usize>,
}

/// Contact of the object with one body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Touch {
    /// The body.
    pub name: String,
    /// True for rows at which they touch; `None` where that is not known.
    pub truth: Option<Vec<bool>>,
    /// Readings of the body's sensor; `None` where it has none.
    pub sensed: Option<Vec<Option<bool>>>,
}

/// Data of one run that is played back.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaybackRun {
    /// Name.
    pub name: String,
    /// Colour.
    pub colour: Colour,
    /// Style of its line.
    pub line: Line,
    /// Estimated poses.
    pub poses: Vec<Option<Pose>>,
    /// Their errors.
    pub errors: Vec<PoseError>,
    /// Some of its particles, all of the same weight; empty for variants without.
    pub cloud: Vec<Vec<Pose>>,
    /// Probabilities of contact with the pusher, then with each fixel (0 to 1); `None` where there
    /// are none, and no rows where they are not shown.
    pub contacts: Vec<Option<Vec<f64>>>,
}

impl PlaybackRun {
    /// The run of an estimate, next to the reference that it is scored against, without contacts;
    /// `cloud` as [`crate::ReportedRun`] has it.
    #[must_use]
    pub fn new(
        name: &str,
        (colour, line): (Colour, Line),
        estimate: &Estimate,
        reference: &Reference,
        cloud: Vec<Vec<Pose>>,
    ) -> Self {
        // what is drawn at a row is the present, where the camera's poses are late too
        let rows = estimate.time.iter().zip(&estimate.rows);
        let errors = rows
            .map(|(time, row)| PoseError::of(*time, row.pose, reference.pose_at(*time)))
            .collect();
        Self {
            name: name.to_owned(),
            colour,
            line,
            poses: estimate.rows.iter().map(|row| row.pose).collect(),
            errors,
            cloud,
            contacts: Vec::new(),
        }
    }
}

impl Playback {
    /// A log with its reference; runs, true contacts, and marks are to be added. All rows are
    /// played back.
    #[must_use]
    pub fn new(scene: &Scene, log: &Log, reference: &Reference, hidden: Vec<bool>) -> Self {
        let touch = |name: String, sensed: Option<&Vec<Option<bool>>>| Touch {
            name,
            truth: None,
            sensed: sensed.cloned(),
        };
        let known: Vec<Option<Pose>> = log
            .time
            .iter()
            .map(|time| reference.pose_at(*time))
            .collect();
        let unseen = log.pusher_out_of_sight();
        let bodies = (0..=scene.others()).map(|k| scene.contact(k));
        Self {
            name: "the experiment".to_owned(),
            time: log.time.clone(),
            focus: 0..log.len(),
            poster: log.len().saturating_sub(1),
            object: Outline::new(&scene.object.shape),
            feet: Vec::new(),
            fingers: scene.pusher.fingers.iter().map(Outline::new).collect(),
            fixels: scene
                .fixels
                .iter()
                .map(|fixel| Outline::new(&fixel.shape).at(&fixel.pose))
                .collect(),
            reference: held(&known, &log.object_out_of_sight()),
            reference_name: "truth".to_owned(),
            finger_poses: log.fingers().map(|poses| held(poses, &unseen)).collect(),
            hidden,
            touches: bodies
                .map(|body| touch(body.to_string(), log.tactile.get(scene.sensor(body))))
                .collect(),
            marks: Vec::new(),
            runs: Vec::new(),
            lowest_first: Vec::new(),
        }
    }

    /// Controls, an empty stage and the data; the page's script does the rest.
    pub(crate) fn html(&self) -> Markup {
        // the only place in a script element where text could end it
        let data = data(self).to_string().replace('<', "\\u003c");
        let last = self.shown().count().saturating_sub(1);
        html! {
            section class="player" tabindex="0" aria-label={ "Playback of " (self.name) ". Space plays, arrow keys step." } {
                div class="stage" {
                    svg role="img" aria-label={ "The object, the pusher and the fixels seen from above: " (self.name) } {}
                    div class="badge" {}
                    div class="clock" {}
                }
                div class="side" {
                    table class="readout" {
                        thead { tr { th scope="col" { "estimate" } th scope="col" { "error (mm)" } th scope="col" { "turn (°)" } } }
                        tbody {}
                    }
                    h3 { "Contacts of the object" }
                    ul class="contacts" {}
                    p class="legend" { (self.legend()) }
                }
                div class="time" {
                    div class="marks" {}
                    div class="strip" {
                        svg viewBox="0 0 1000 100" preserveAspectRatio="none" role="img"
                            aria-label="Position errors against time; shaded while the camera is off" {}
                        span class="quantity" { "position error" }
                    }
                    input type="range" min="0" max=(last) value="0" step="1" aria-label="time";
                    (controls())
                }
                script type="application/json" { (PreEscaped(data)) }
            }
        }
    }

    /// Legend of the drawing; nothing is named that is not there.
    fn legend(&self) -> String {
        let any = |of: fn(&Touch) -> bool| self.touches.iter().any(of);
        let yellow = if any(|touch| touch.truth.is_some()) {
            match self.fixels.is_empty() {
                true => " The pusher is yellow while it touches the object.",
                false => " Pusher and fixels are yellow while they touch the object.",
            }
        } else if any(|touch| touch.sensed.is_some()) {
            " Fixels are yellow while their sensors are touched."
        } else {
            ""
        };
        let estimates = match self.runs.is_empty() {
            true => "",
            false => " Coloured outlines: estimates",
        };
        let feet = match self.feet.is_empty() {
            true => "",
            false => " Small circles: its feet. Dotted lines: ways of object and pusher.",
        };
        let particles = match self.runs.iter().any(has_cloud) {
            true => "; thin ones: particles.",
            false if self.runs.is_empty() => "",
            false => ".",
        };
        let rims = match self.runs.iter().any(knows_contacts) {
            true => " Rims turn yellow with the estimated probability of contact.",
            false => "",
        };
        let every = match self.stride() {
            1 => String::new(),
            stride => format!(
                " One row in {stride} of {} is played back.",
                self.time.len()
            ),
        };
        format!(
            "Filled: the {}, dashed while the camera is off.{estimates}{particles}{feet}{yellow}{rims}{every}",
            self.reference_name
        )
    }

    /// Rows played back: all, or every [`Self::stride`]-th.
    pub(crate) fn shown(&self) -> StepBy<Range<usize>> {
        (0..self.time.len()).step_by(self.stride())
    }

    /// Rows from one that is played back to the next, so that a page stays small.
    pub(crate) fn stride(&self) -> usize {
        self.time.len().div_ceil(MOST_ROWS).max(1)
    }
}

/// Poses of every row in which a body is seen: those of rows that another sensor brought are the
/// ones before.
fn held(poses: &[Option<Pose>], out_of_sight: &[bool]) -> Vec<Option<Pose>> {
    let mut latest = None;
    let rows = poses.iter().zip(out_of_sight);
    rows.map(|(pose, unseen)| {
        latest = pose.or(latest);
        pose.or(latest.filter(|_| !unseen))
    })
    .collect()
}

fn controls() -> Markup {
    html! {
        div class="controls" {
            button type="button" class="play" { "▶ play" }
            button type="button" class="back" aria-label="one row back" { "◂" }
            button type="button" class="next" aria-label="one row on" { "▸" }
            label { "speed " select class="speed" {
                @for (value, name) in [("0.125", "⅛"), ("0.25", "¼"), ("0.5", "½"), ("1", "1"), ("2", "2"), ("4", "4")] {
                    option value=(value) selected[value == "1"] { (name) " ×" }
                }
            } }
            label { "view " select class="view" {
                option value="whole" { "whole table" }
                option value="near" { "near the object" }
            } }
        }
    }
}
