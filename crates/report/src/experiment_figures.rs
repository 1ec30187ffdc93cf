//! The figures of one experiment: [`ReportedExperiment::figures`].

use stickslip::EstimateRow;

use crate::axis::Scale;
use crate::colour::Colour;
use crate::contact_timeline::{ContactEstimate, ContactLane, ContactTimeline};
use crate::curves::{FRICTION_PARAMETERS, PoseError, friction_curve, friction_panels, pose_errors};
use crate::drawing::Drawing;
use crate::intervals::intervals;
use crate::overlay::{Body, Overlay};
use crate::particle_cloud::ParticleCloud;
use crate::reported_experiment::{ReportedExperiment, ReportedRun};
use crate::time_figure::{Curve, Panel, TimeFigure};

/// Smallest error drawn (mm, degrees).
const FLOOR: f64 = 0.01;

/// A figure of an experiment.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Short name, for files.
    pub name: &'static str,
    /// What is drawn.
    pub drawing: Drawing,
    /// What one sees.
    pub caption: String,
}

impl Figure {
    /// A drawing with its name and caption.
    #[must_use]
    pub fn new(name: &'static str, drawing: Drawing, caption: &str) -> Self {
        Self {
            name,
            drawing,
            caption: caption.to_owned(),
        }
    }
}

impl ReportedExperiment<'_> {
    /// All figures, each with a name for its files.
    #[must_use]
    pub fn figures(&self) -> Vec<Figure> {
        let always = [
            Figure::new(
                "errors",
                self.errors().drawing(),
                "Errors against time, smallest ones drawn at 0.01.",
            ),
            Figure::new(
                "poses",
                self.poses(),
                "Bodies at the first contact with a fixel, if there is one, and at the end of the time shown.",
            ),
            Figure::new(
                "contacts",
                self.contact_timeline().drawing(),
                "Who touches the object when.",
            ),
        ];
        let friction = self.friction_figure().map(|figure| {
            Figure::new(
                "friction",
                figure.drawing(),
                "Estimated friction, mean and one standard deviation; its nominal value; the truth, where it is known.",
            )
        });
        let cloud = self.cloud().map(|figure| {
            Figure::new(
                "cloud",
                figure.drawing(),
                "Particles at the row that the playback shows first.",
            )
        });
        always.into_iter().chain(friction).chain(cloud).collect()
    }

    /// Errors of all runs against time.
    #[must_use]
    pub fn errors(&self) -> TimeFigure {
        let panel = |label: &str, of: fn(&PoseError) -> f64| {
            let curve = |run: &ReportedRun| {
                let errors = pose_errors(&run.scored.estimate, &self.reference);
                let points = errors.iter().map(|error| [error.time, of(error)]).collect();
                Curve::new(run.title(), run.colour(), points)
            };
            Panel {
                label: label.to_owned(),
                scale: Scale::Log { floor: FLOOR },
                curves: self.runs.iter().map(curve).collect(),
                ..Panel::default()
            }
        };
        TimeFigure {
            title: self.what.clone(),
            panels: vec![
                panel("position error (mm)", PoseError::distance_mm),
                panel("angle error (°)", |error| error.turn_deg.abs()),
            ],
            ..self.time_figure()
        }
    }

    fn friction_figure(&self) -> Option<TimeFigure> {
        let run = self.learner()?;
        let estimate = &run.scored.estimate;
        let parameters = if estimate.has_tripod { 4 } else { 3 };
        Some(TimeFigure {
            columns: 2,
            panel_size: [430.0, 210.0],
            panels: friction_panels(
                &FRICTION_PARAMETERS[..parameters],
                &self.setup.scene.nominal,
                &self.friction,
                |parameter| friction_curve(run.title(), run.colour(), estimate, parameter),
            ),
            band_name: "± one standard deviation".to_owned(),
            ..self.time_figure()
        })
    }

    /// What all figures against time share.
    fn time_figure(&self) -> TimeFigure {
        TimeFigure {
            span: self.span(),
            dark: self.dark(),
            marks: self.contacts.clone(),
            ..TimeFigure::default()
        }
    }

    /// Contacts against time: of the pusher, then of each fixel.
    #[must_use]
    pub fn contact_timeline(&self) -> ContactTimeline {
        let time = &self.log.time;
        let truth = |body: usize| {
            let touches = self.touches.get(body)?.as_ref()?;
            Some(intervals(time, touches))
        };
        let sensed = |body: usize| {
            let readings = self.log.tactile.get(body.checked_sub(1)?)?;
            let touches: Vec<bool> = readings.iter().map(|r| *r == Some(true)).collect();
            Some(intervals(time, &touches))
        };
        let estimate = |body: usize| {
            let run = self.learner()?;
            let rows = run
                .scored
                .estimate
                .time
                .iter()
                .zip(&run.scored.estimate.rows);
            let points = rows.map(|(time, row)| [*time, contact(row, body).unwrap_or(f64::NAN)]);
            Some(ContactEstimate {
                name: run.title().to_owned(),
                colour: run.colour(),
                points: points.collect(),
            })
        };
        let lane = |body: usize| ContactLane {
            name: match body {
                0 => "pusher".to_owned(),
                _ => format!("fixel {body}"),
            },
            truth: truth(body),
            sensed: sensed(body),
            estimates: estimate(body).into_iter().collect(),
        };
        ContactTimeline {
            title: String::new(),
            span: self.span(),
            dark: self.dark(),
            bodies: (0..=self.setup.scene.fixels.len()).map(lane).collect(),
        }
    }

    /// Bodies at the first fixel contact and at the end, side by side and on the same scale.
    fn poses(&self) -> Drawing {
        let times = self.first_fixel.into_iter().chain([self.span()[1]]);
        let rows: Vec<usize> = times.map(|time| self.row_at(time)).collect();
        let bodies = rows.iter().flat_map(|row| self.known_bodies(*row));
        let view = Some(view_of(bodies.collect()));
        let drawing = |row: &usize| {
            let overlay = Overlay {
                view,
                ..self.poses_at(*row)
            };
            overlay.drawing()
        };
        Drawing::grid(&rows.iter().map(drawing).collect::<Vec<_>>(), 2)
    }

    /// All estimated poses at a row over what stands around.
    #[must_use]
    pub fn poses_at(&self, row: usize) -> Overlay {
        let shape = &self.setup.scene.object.shape;
        let estimates = self.runs.iter().filter_map(|run| {
            let pose = run.scored.estimate.rows.get(row)?.pose?;
            Some(Body::new(run.title(), shape, &pose, run.colour()))
        });
        let known = self.known_bodies(row);
        let time = self.log.time.get(row).copied().unwrap_or(0.0);
        let dark = if self.hidden.get(row) == Some(&true) {
            ", camera dark"
        } else {
            ""
        };
        Overlay {
            title: format!("{time:.2} s{dark}"),
            view: Some(view_of(known.clone())),
            bodies: known.into_iter().chain(estimates).collect(),
            width: 440.0,
        }
    }

    /// Fixels, pusher and the object where it was.
    fn known_bodies(&self, row: usize) -> Vec<Body> {
        let scene = &self.setup.scene;
        let pusher = self.log.pusher.get(row).copied().flatten();
        let truth = self.reference.pose.get(row).copied().flatten();
        let object = truth.map(|pose| {
            let name = &self.reference_name;
            Body::new(name, &scene.object.shape, &pose, Colour::INK).filled(0.12)
        });
        let mut bodies = Body::surroundings(scene, pusher.as_ref());
        bodies.extend(object);
        bodies
    }

    fn cloud(&self) -> Option<ParticleCloud> {
        let (run, row) = (self.learner()?, self.poster());
        let particles = run.cloud.get(row).filter(|cloud| !cloud.is_empty())?;
        let centre = run.scored.estimate.rows.get(row)?.pose?;
        let reference = self.reference.pose.get(row).copied().flatten();
        let reference = reference.map(|pose| (self.reference_name.clone(), Colour::INK, pose));
        let mean = (run.title().to_owned(), Colour::BLUE, centre);
        Some(ParticleCloud {
            title: String::new(),
            centre,
            particles: particles.clone(),
            colour: run.colour(),
            compared: reference.into_iter().chain([mean]).collect(),
            turn_factor: 10.0,
            width: 440.0,
        })
    }
}

/// The part of the plane that holds bodies.
fn view_of(bodies: Vec<Body>) -> [[f64; 2]; 2] {
    let overlay = Overlay {
        bodies,
        ..Overlay::default()
    };
    overlay.whole_view()
}

/// Estimated probability of contact with the pusher (0) or a fixel (from 1 on).
fn contact(row: &EstimateRow, body: usize) -> Option<f64> {
    match body {
        0 => row.contact_pusher,
        _ => row.contact_fixels.as_ref()?.get(body - 1).copied(),
    }
}
