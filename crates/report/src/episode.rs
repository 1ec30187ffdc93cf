//! One experiment with the runs of several methods: [`Episode`], its story, its figures and its
//! section of a report.

use stickslip::dynamics::{Friction, Pose};
use stickslip::{Estimate, Log, Reference, Scores, Setup};

use crate::axis::Scale;
use crate::colour::Colour;
use crate::contact_timeline::{ContactEstimate, ContactLane, ContactTimeline};
use crate::courses::{PoseError, friction_panels, pose_errors};
use crate::drawing::Drawing;
use crate::marks::Mark;
use crate::overlay::{Body, Overlay};
use crate::page::{Block, Section};
use crate::particle_cloud::ParticleCloud;
use crate::playback::{MethodTrack, Playback};
use crate::story::{Fate, Outcome, Story};
use crate::table::{Table, number};
use crate::time_figure::{Curve, Panel, TimeFigure};

/// Time that is shown before the first contact and after the last one begins (s).
const BEFORE: f64 = 1.0;
const AFTER: f64 = 4.0;

/// Time after the last contact begins at which the playback shows its first picture (s).
const POSTER: f64 = 1.5;

/// Smallest error drawn (mm, degrees).
const FLOOR: f64 = 0.01;

/// An experiment and what methods made of it.
#[derive(Clone, Debug)]
pub struct Episode<'a> {
    /// Name, as that of its folder.
    pub name: String,
    /// What moves, as "a bar pushes a square until it jams at a fixel"; empty where nobody knows.
    pub what: String,
    /// What was known before it.
    pub setup: &'a Setup,
    /// What was measured.
    pub log: &'a Log,
    /// What estimates are scored against.
    pub reference: Reference,
    /// What that is, as "truth".
    pub reference_name: String,
    /// Whether each row's object pose was hidden from the methods.
    pub hidden: Vec<bool>,
    /// Whether the object truly touches the pusher, then each fixel, row by row; `None` where that
    /// is not known.
    pub touches: Vec<Option<Vec<bool>>>,
    /// First contacts (s).
    pub contacts: Vec<Mark>,
    /// When the object first touched a fixel (s).
    pub first_fixel: Option<f64>,
    /// True values of μ_s, μ_p, μ_f and d_tri (m), where they are known.
    pub friction: [Option<f64>; 4],
    /// The methods.
    pub methods: Vec<Contender>,
}

/// One method's run over an episode.
#[derive(Clone, Debug)]
pub struct Contender {
    /// Name.
    pub name: String,
    /// Colour in every figure.
    pub colour: Colour,
    /// What it estimated.
    pub estimate: Estimate,
    /// Its scores.
    pub scores: Scores,
    /// Particle steps without a certified solution.
    pub unsolved: u64,
    /// Whether it saw what was hidden from the others.
    pub saw_all: bool,
    /// Particles to draw, as [`crate::CloudSample::into_rows`] gives them; empty for methods
    /// without.
    pub cloud: Vec<Vec<Pose>>,
}

impl Episode<'_> {
    /// What happened, in words made from numbers.
    #[must_use]
    pub fn story(&self) -> Story {
        let outcome = |method: &Contender| Outcome {
            name: method.name.clone(),
            saw_all: method.saw_all,
            wmse_mm: method.scores.wmse_occluded_mm.or(method.scores.wmse_mm),
        };
        let dark = self.dark();
        Story {
            what: self.what.clone(),
            duration: self.log.duration(),
            dark: dark
                .first()
                .zip(dark.last())
                .map(|(first, last)| [first[0], last[1]]),
            first_fixel: self.first_fixel,
            outcomes: self.methods.iter().map(outcome).collect(),
        }
    }

    /// What a reader should know after a minute.
    #[must_use]
    pub fn summary(&self) -> [Block; 2] {
        let story = self.story();
        let title = if self.what.is_empty() {
            String::new()
        } else {
            format!("{}. ", story.title())
        };
        [
            Block::Text(format!("{title}{}", story.darkness())),
            Block::Fates(story),
        ]
    }

    /// Playback, scores and figures.
    #[must_use]
    pub fn section(&self) -> Section {
        let story = self.story();
        let title = if self.what.is_empty() {
            self.name.clone()
        } else {
            story.title()
        };
        let head = [
            Block::Playback(Box::new(self.playback())),
            Block::Table(self.scores(), self.name.clone()),
            Block::Note(format!(
                "WMSE: root of the mean of squared errors, angles weighted by the radius of gyration, against the {}. {}",
                self.reference_name,
                Fate::rule()
            )),
        ];
        let figures = self
            .figures()
            .into_iter()
            .map(|figure| Block::Figure(figure.drawing, figure.caption));
        Section {
            title,
            blocks: head.into_iter().chain(figures).collect(),
        }
    }

    /// The scores of all methods.
    #[must_use]
    pub fn scores(&self) -> Table {
        let wmse = if self.hidden.contains(&true) {
            "WMSE in the dark (mm)"
        } else {
            "WMSE (mm)"
        };
        let mut table = Table::new([
            "method",
            "verdict",
            wmse,
            "WMSE moving (mm)",
            "final error (mm)",
            "final error (°)",
            "unsolved steps",
        ]);
        for method in &self.methods {
            let Scores {
                wmse_mm,
                wmse_occluded_mm,
                wmse_moving_mm,
                final_error_mm,
                final_error_deg,
            } = method.scores;
            let wmse = wmse_occluded_mm.or(wmse_mm);
            let scores = [wmse, wmse_moving_mm, final_error_mm, final_error_deg]
                .map(|score| number(score, 3));
            let verdict = if method.saw_all {
                "saw all".to_owned()
            } else {
                Fate::of(wmse).name().to_owned()
            };
            let cells = [method.name.clone(), verdict]
                .into_iter()
                .chain(scores)
                .chain([method.unsolved.to_string()]);
            table.push_coloured(method.colour, cells);
        }
        table
    }

    /// All figures, each with a name for its files.
    #[must_use]
    pub fn figures(&self) -> Vec<Figure> {
        let figure = |name, drawing: Drawing, caption: &str| Figure {
            name,
            drawing,
            caption: caption.to_owned(),
        };
        let errors = figure(
            "errors",
            self.errors().drawing(),
            "Errors against time, smallest ones drawn at 0.01.",
        );
        let poses = figure(
            "poses",
            self.poses(),
            "Bodies at the first contact with a fixel, if there is one, and at the end of the time shown.",
        );
        let contacts = figure(
            "contacts",
            self.contact_timeline().drawing(),
            "Who touches the object when.",
        );
        let friction = self.friction_figure().map(|drawing| {
            figure(
                "friction",
                drawing.drawing(),
                "Estimated friction, mean and one standard deviation; what the method was told; the truth, where it is known.",
            )
        });
        let cloud = self.cloud().map(|drawing| {
            figure(
                "cloud",
                drawing.drawing(),
                "Particles at the row that the playback shows first.",
            )
        });
        [errors, poses, contacts]
            .into_iter()
            .chain(friction)
            .chain(cloud)
            .collect()
    }

    /// Times without a camera (s).
    fn dark(&self) -> Vec<[f64; 2]> {
        intervals(&self.log.time, &self.hidden)
    }

    /// From a little before the first contact to a while after the last one begins; all times where
    /// none is known.
    fn span(&self) -> [f64; 2] {
        let (first, last) = (
            self.log.time.first().copied().unwrap_or(0.0),
            self.log.time.last().copied().unwrap_or(1.0),
        );
        let contacts = || {
            self.contacts
                .iter()
                .map(|mark| mark.time)
                .filter(|time| time.is_finite())
        };
        let Some(start) = contacts().reduce(f64::min) else {
            return [first, last];
        };
        let end = contacts().fold(start, f64::max) + AFTER;
        [(start - BEFORE).max(first), end.min(last)]
    }

    /// The last row up to a time.
    fn row_at(&self, time: f64) -> usize {
        self.log
            .time
            .partition_point(|t| *t <= time + 1e-9)
            .saturating_sub(1)
    }

    /// The row whose picture tells most.
    fn poster(&self) -> usize {
        self.row_at((self.span()[1] - AFTER + POSTER).max(self.span()[0]))
    }

    /// The experiment to be played back.
    #[must_use]
    pub fn playback(&self) -> Playback {
        let [from, to] = self.span();
        let mut playback = Playback::new(
            &self.setup.scene,
            self.log,
            &self.reference,
            self.hidden.clone(),
        );
        for (touch, truth) in playback.touches.iter_mut().zip(&self.touches) {
            touch.truth.clone_from(truth);
        }
        let dark = self.dark().into_iter().map(|[from, _]| Mark {
            time: from,
            name: "camera dark".to_owned(),
        });
        let learner = self.learner().map(|method| method.name.as_str());
        let track = |method: &Contender| {
            let mut track = MethodTrack::new(
                &method.name,
                method.colour,
                &method.estimate,
                &self.reference,
                method.cloud.clone(),
            );
            if learner != Some(track.name.as_str()) {
                track.contacts.clear();
            }
            track
        };
        let mut lowest_first: Vec<usize> = (0..self.methods.len()).collect();
        lowest_first.sort_by_key(|k| !self.methods[*k].saw_all);
        Playback {
            name: if self.what.is_empty() {
                self.name.clone()
            } else {
                self.what.clone()
            },
            rows: self.row_at(from)..self.row_at(to) + 1,
            poster: self.poster(),
            reference_name: self.reference_name.clone(),
            marks: self.contacts.iter().cloned().chain(dark).collect(),
            methods: self.methods.iter().map(track).collect(),
            lowest_first,
            ..playback
        }
    }

    /// Errors of all methods against time.
    #[must_use]
    pub fn errors(&self) -> TimeFigure {
        let panel = |label: &str, of: fn(&PoseError) -> f64| {
            let curve = |method: &Contender| {
                let errors = pose_errors(&method.estimate, &self.reference);
                Curve::new(
                    &method.name,
                    method.colour,
                    errors.iter().map(|error| [error.time, of(error)]).collect(),
                )
            };
            let curves = self.methods.iter().map(curve).collect();
            Panel {
                label: label.to_owned(),
                scale: Scale::Log { floor: FLOOR },
                curves,
                ..Panel::default()
            }
        };
        TimeFigure {
            title: self.what.clone(),
            span: self.span(),
            dark: self.dark(),
            marks: self.contacts.clone(),
            panels: vec![
                panel("position error (mm)", PoseError::distance_mm),
                panel("angle error (°)", |error| error.turn_deg.abs()),
            ],
            ..TimeFigure::default()
        }
    }

    /// The method whose particles and friction are shown: the last one that has any and did not see
    /// what was hidden.
    fn learner(&self) -> Option<&Contender> {
        let learns = |method: &&Contender| {
            method
                .estimate
                .rows
                .iter()
                .any(|row| row.friction.is_some())
        };
        let blind = self
            .methods
            .iter()
            .filter(learns)
            .rfind(|method| !method.saw_all);
        blind.or_else(|| self.methods.iter().find(learns))
    }

    fn friction_figure(&self) -> Option<TimeFigure> {
        let method = self.learner()?;
        let told: &Friction = &self.setup.scene.nominal;
        Some(TimeFigure {
            span: self.span(),
            dark: self.dark(),
            marks: self.contacts.clone(),
            columns: 2,
            panel_size: [430.0, 210.0],
            panels: friction_panels(
                &method.name,
                method.colour,
                &method.estimate,
                told,
                &self.friction,
            ),
            band_name: "± one standard deviation".to_owned(),
            ..TimeFigure::default()
        })
    }

    /// Contacts against time.
    #[must_use]
    pub fn contact_timeline(&self) -> ContactTimeline {
        let method = self.learner();
        let probability = |body: usize| -> Option<ContactEstimate> {
            let method = method?;
            let rows = method.estimate.time.iter().zip(&method.estimate.rows);
            let points = rows.map(|(time, row)| {
                let fixel = || {
                    row.contact_fixels
                        .as_ref()?
                        .get(body.checked_sub(1)?)
                        .copied()
                };
                [
                    *time,
                    if body == 0 {
                        row.contact_pusher
                    } else {
                        fixel()
                    }
                    .unwrap_or(f64::NAN),
                ]
            });
            Some(ContactEstimate {
                name: method.name.clone(),
                colour: method.colour,
                points: points.collect(),
            })
        };
        let lane = |body: usize| ContactLane {
            name: if body == 0 {
                "pusher".to_owned()
            } else {
                format!("fixel {body}")
            },
            truth: self
                .touches
                .get(body)
                .cloned()
                .flatten()
                .map(|touches| intervals(&self.log.time, &touches)),
            sensed: body
                .checked_sub(1)
                .and_then(|fixel| self.log.tactile.get(fixel))
                .map(|readings| {
                    intervals(
                        &self.log.time,
                        &readings
                            .iter()
                            .map(|reading| *reading == Some(true))
                            .collect::<Vec<_>>(),
                    )
                }),
            estimates: probability(body).into_iter().collect(),
        };
        let bodies = (0..=self.setup.scene.fixels.len()).map(lane).collect();
        ContactTimeline {
            title: String::new(),
            span: self.span(),
            dark: self.dark(),
            bodies,
        }
    }

    /// Bodies at the first fixel contact and at the end, side by side and on the same scale.
    fn poses(&self) -> Drawing {
        let rows: Vec<usize> = self
            .first_fixel
            .into_iter()
            .chain([self.span()[1]])
            .map(|time| self.row_at(time))
            .collect();
        let bodies = rows
            .iter()
            .flat_map(|row| self.still_bodies(*row))
            .collect();
        let view = Some(
            Overlay {
                bodies,
                ..Overlay::default()
            }
            .whole_view(),
        );
        let drawings: Vec<Drawing> = rows
            .iter()
            .map(|row| {
                Overlay {
                    view,
                    ..self.poses_at(*row)
                }
                .drawing()
            })
            .collect();
        Drawing::grid(&drawings, 2)
    }

    /// All estimated poses at a row over what stands around.
    #[must_use]
    pub fn poses_at(&self, row: usize) -> Overlay {
        let estimates = self.methods.iter().filter_map(|method| {
            let pose = method.estimate.rows.get(row)?.pose?;
            Some(Body::new(
                &method.name,
                &self.setup.scene.object.shape,
                &pose,
                method.colour,
            ))
        });
        let still = self.still_bodies(row);
        let view = Overlay {
            bodies: still.clone(),
            ..Overlay::default()
        }
        .whole_view();
        let time = self.log.time.get(row).copied().unwrap_or(0.0);
        let title = format!(
            "{time:.2} s{}",
            if self.hidden.get(row) == Some(&true) {
                ", camera dark"
            } else {
                ""
            }
        );
        Overlay {
            title,
            bodies: still.into_iter().chain(estimates).collect(),
            view: Some(view),
            width: 440.0,
        }
    }

    /// Fixels, pusher and the object where it was.
    fn still_bodies(&self, row: usize) -> Vec<Body> {
        let pusher = self.log.pusher.get(row).copied().flatten();
        let truth = self.reference.pose.get(row).copied().flatten();
        let truth = truth.map(|pose| {
            Body::new(
                &self.reference_name,
                &self.setup.scene.object.shape,
                &pose,
                Colour::INK,
            )
            .filled(0.12)
        });
        Body::surroundings(&self.setup.scene, pusher.as_ref())
            .into_iter()
            .chain(truth)
            .collect()
    }

    fn cloud(&self) -> Option<ParticleCloud> {
        let (method, row) = (self.learner()?, self.poster());
        let particles = method
            .cloud
            .get(row)
            .filter(|particles| !particles.is_empty())?
            .clone();
        let centre = method.estimate.rows.get(row)?.pose?;
        let reference = self.reference.pose.get(row).copied().flatten();
        let compared = reference.map(|pose| (self.reference_name.clone(), Colour::INK, pose));
        let compared = compared
            .into_iter()
            .chain([(method.name.clone(), Colour::BLUE, centre)])
            .collect();
        Some(ParticleCloud {
            title: String::new(),
            centre,
            particles,
            colour: method.colour,
            compared,
            turn_factor: 10.0,
            width: 440.0,
        })
    }
}

/// A figure of an episode.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Short name, for files.
    pub name: &'static str,
    /// What is drawn.
    pub drawing: Drawing,
    /// What one sees.
    pub caption: String,
}

/// The times over which flags are set: a row speaks of the interval that ends at it.
fn intervals(time: &[f64], flags: &[bool]) -> Vec<[f64; 2]> {
    let mut intervals: Vec<[f64; 2]> = Vec::new();
    let mut set_before = false;
    for ((row, time_of_row), set) in time.iter().enumerate().zip(flags) {
        if *set {
            match intervals.last_mut() {
                Some([_, end]) if set_before => *end = *time_of_row,
                _ => intervals.push([
                    if row == 0 {
                        *time_of_row
                    } else {
                        time[row - 1]
                    },
                    *time_of_row,
                ]),
            }
        }
        set_before = *set;
    }
    intervals
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_join_rows_that_follow_each_other() {
        let time = [0.0, 0.1, 0.2, 0.3, 0.4];
        assert_eq!(
            intervals(&time, &[false, true, true, false, true]),
            [[0.0, 0.2], [0.3, 0.4]]
        );
        assert_eq!(
            intervals(&time, &[true, false, false, false, false]),
            [[0.0, 0.0]]
        );
        assert!(intervals(&time, &[]).is_empty());
    }
}
