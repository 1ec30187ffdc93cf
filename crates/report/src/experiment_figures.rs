//! The figures of one experiment: [`ReportedExperiment::figures`].

use stickslip::dynamics::Pose;
use stickslip_evaluation::LearnedParameter;

use crate::axis::Scale;
use crate::colour::{Colour, Line};
use crate::curves::{
    FRICTION_PARAMETERS, FrictionParameter, PoseError, friction_curves, friction_panels,
    pose_errors,
};
use crate::drawing::Drawing;
use crate::intervals::intervals;
use crate::overlay::{Body, Overlay};
use crate::particle_cloud::ParticleCloud;
use crate::reported_experiment::ReportedExperiment;
use crate::reported_run::ReportedRun;
use crate::time_figure::{Bars, Curve, Panel, TimeFigure};
use crate::touch::TouchRule;

/// Smallest error drawn (mm, degrees).
const FLOOR: f64 = 0.01;

/// A figure of an experiment.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Short name, for files.
    pub name: &'static str,
    /// The drawing.
    pub drawing: Drawing,
    /// Caption.
    pub caption: String,
}

impl Figure {
    /// A drawing with its name and caption.
    #[must_use]
    pub fn new(name: &'static str, drawing: Drawing, caption: impl Into<String>) -> Self {
        let caption = caption.into();
        let label = match drawing.label.is_empty() {
            true => caption.clone(),
            false => drawing.label,
        };
        let drawing = Drawing { label, ..drawing };
        Self {
            name,
            drawing,
            caption,
        }
    }
}

impl ReportedExperiment<'_> {
    /// All figures, each with a name for its files.
    #[must_use]
    pub fn figures(&self) -> Vec<Figure> {
        let shaded = match self.learner() {
            Some(_) => ". Band: standard deviation of the particle filter",
            None => "",
        };
        let error_curves = self.errors();
        let errors = Figure::new(
            "errors",
            error_curves.drawing(),
            format!("Errors against time; smaller ones are drawn at {FLOOR}{shaded}."),
        );
        let poses = Figure::new(
            "poses",
            self.poses(),
            "Object and estimates at the first contact with a fixel and at the end. Thin outlines: particles. An estimate far off may be outside the picture.",
        );
        let contacts = self.contact_timeline().map(|timeline| {
            let rule = TouchRule::measured(self.setup);
            let text = format!("Contacts of the object against time: {}.", rule.words());
            Figure::new("contacts", timeline.drawing(), &text)
        });
        let friction = self.friction_figure().map(|figure| {
            Figure::new(
                "friction",
                figure.drawing(),
                "Estimated friction: mean and one standard deviation, the nominal value, and the truth if known. A curve is dotted after \
                 the last informative row: camera on, object in motion, parameter acting on it. Not identifiable: no such row, or a standard \
                 deviation of more than 0.6 of the prior's.",
            )
        });
        let cloud = self.clouds().map(|drawing| {
            let text = "Particles at these instants. The ellipse covers 95 % of a normal distribution with their covariance.";
            Figure::new("cloud", drawing, text)
        });
        let against_time = [
            Some(errors),
            contacts,
            self.slips(),
            friction,
            self.particles(),
        ];
        let part = self.part_shown();
        let mut figures: Vec<Figure> = against_time.into_iter().flatten().collect();
        for figure in &mut figures {
            figure.caption.push_str(&part);
        }
        figures.splice(1..1, [Some(poses), cloud].into_iter().flatten());
        if !part.is_empty() {
            let whole = TimeFigure {
                span: self.whole_span(),
                ..error_curves
            };
            let text = "Errors against time over the whole log.";
            figures.insert(0, Figure::new("errors-whole", whole.drawing(), text));
        }
        figures
    }

    /// " Shown: 2.0 to 9.1 s of 0.0 to 60.0 s."; empty if the whole log is shown.
    fn part_shown(&self) -> String {
        let ([from, to], [first, last]) = (self.span(), self.whole_span());
        if [from, to] == [first, last] {
            return String::new();
        }
        format!(" Shown: {from:.1} to {to:.1} s of {first:.1} to {last:.1} s.")
    }

    /// Errors of all runs against time, in the part about the contacts.
    #[must_use]
    pub fn errors(&self) -> TimeFigure {
        let panel = |label: &str, of: fn(&PoseError) -> f64, spread: fn(&Pose) -> f64| {
            let curve = |run: &ReportedRun| {
                let estimate = &run.scored.estimate;
                let errors = pose_errors(estimate, &self.reference);
                let points = errors.iter().map(|error| [error.time, of(error)]).collect();
                let rows = estimate.time.iter().zip(&estimate.rows);
                let own = rows.map(|(time, row)| {
                    let std = row.spread.map_or(f64::NAN, |std| spread(&std.pose));
                    [*time, FLOOR, std.max(FLOOR)]
                });
                let is_learner = self.learner().map(ReportedRun::title) == Some(run.title());
                Curve {
                    line: Line::of(run.scored.variant),
                    band: own.filter(|_| is_learner).collect(),
                    ..Curve::new(run.title(), run.colour(), points)
                }
            };
            Panel {
                label: label.to_owned(),
                scale: Scale::Log { floor: FLOOR },
                curves: self.drawn().map(curve).collect(),
                ..Panel::default()
            }
        };
        TimeFigure {
            title: self.what.clone(),
            panels: vec![
                panel("position error (mm)", PoseError::distance_mm, |std| {
                    1e3 * std.x.hypot(std.y)
                }),
                panel(
                    "angle error (°)",
                    |error| error.turn_deg.abs(),
                    |std| std.theta.to_degrees(),
                ),
            ],
            band_name: self
                .learner()
                .map(|run| format!("standard deviation of the {}", run.title()))
                .unwrap_or_default(),
            ..self.time_figure()
        }
    }

    fn friction_figure(&self) -> Option<TimeFigure> {
        let run = self.learner()?;
        let estimate = &run.scored.estimate;
        let learned = LearnedParameter::all(estimate);
        let informed = |parameter: &FrictionParameter| {
            let found = learned.iter().find(|found| found.name == parameter.name);
            found.and_then(|found| found.informed)
        };
        let mut panels = friction_panels(
            &FRICTION_PARAMETERS[..learned.len()],
            &self.setup.scene.nominal,
            &self.friction,
            |parameter| {
                let row = informed(parameter);
                friction_curves(run.title(), run.colour(), estimate, parameter, row)
            },
        );
        for (panel, learned) in panels.iter_mut().zip(&learned) {
            if !learned.observed {
                panel.title = "not identifiable".to_owned();
            }
        }
        Some(TimeFigure {
            columns: 2,
            panel_size: [441.0, 210.0],
            panels,
            band_name: "± one standard deviation".to_owned(),
            ..self.time_figure()
        })
    }

    /// Figure against time without panels.
    pub(crate) fn time_figure(&self) -> TimeFigure {
        TimeFigure {
            span: self.span(),
            dark: self.dark(),
            marks: self.contacts.clone(),
            ..TimeFigure::default()
        }
    }

    /// Contacts against time, a panel per body: of the pusher, each fixel, then each other finger.
    /// `None` where nothing is known of any contact.
    #[must_use]
    pub fn contact_timeline(&self) -> Option<TimeFigure> {
        let (time, scene) = (&self.log.time, &self.setup.scene);
        let truth = |body: usize| {
            let touches = self.touches.get(body)?.as_ref()?;
            Some(("touches", Colour::INK, intervals(time, touches)))
        };
        let sensed = |body: usize| {
            let sensor = scene.sensor(scene.contact(body));
            let readings = self.log.tactile.get(sensor)?;
            let touches: Vec<bool> = readings.iter().map(|r| *r == Some(true)).collect();
            Some(("sensor reads 1", Colour::GREY, intervals(time, &touches)))
        };
        let learner = self
            .learner()
            .map(|run| (run, self.touch_probabilities(run)));
        let estimate = |body: usize| {
            let (run, probabilities) = learner.as_ref()?;
            let at = |row: &Option<Vec<f64>>| row.as_ref()?.get(body).copied();
            let rows = run.scored.estimate.time.iter().zip(probabilities);
            let points: Vec<[f64; 2]> = rows
                .map(|(time, row)| [*time, at(row).unwrap_or(f64::NAN)])
                .collect();
            let band = points.iter().map(|[time, p]| [*time, 0.0, *p]).collect();
            let name = format!("{}: probability", run.title());
            Some(Curve {
                band,
                ..Curve::new(&name, run.colour(), points)
            })
        };
        let panel = |body: usize| Panel {
            label: scene.contact(body).to_string(),
            // the bars lie above the probability of 1
            limits: Some([0.0, 1.7]),
            curves: estimate(body).into_iter().collect(),
            bars: [truth(body), sensed(body)]
                .into_iter()
                .flatten()
                .map(|(name, colour, times)| Bars {
                    name: name.to_owned(),
                    colour,
                    times,
                })
                .collect(),
            ..Panel::default()
        };
        let panels: Vec<Panel> = (0..=self.setup.scene.fixels.len()).map(panel).collect();
        let known = |panel: &Panel| !panel.bars.is_empty() || !panel.curves.is_empty();
        panels.iter().any(known).then(|| TimeFigure {
            panels,
            panel_size: [882.0, 92.0],
            marks: Vec::new(),
            ..self.time_figure()
        })
    }

    /// Bodies at the first fixel contact and at the end, side by side and on the same scale.
    fn poses(&self) -> Drawing {
        let rows = self.shown_rows();
        let bodies = rows.iter().flat_map(|row| self.in_view(*row));
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

    /// The rows that pictures show: the first contact with a fixel and the end.
    fn shown_rows(&self) -> Vec<usize> {
        let times = self.first_fixel.into_iter().chain([self.span()[1]]);
        times.map(|time| self.row_at(time)).collect()
    }

    /// All estimated poses at a row over the known bodies.
    #[must_use]
    pub fn poses_at(&self, row: usize) -> Overlay {
        let shape = &self.setup.scene.object.shape;
        let estimates = self.drawn().filter_map(|run| {
            let pose = run.scored.estimate.rows.get(row)?.pose?;
            Some(
                Body::new(run.title(), shape, &pose, run.colour())
                    .line(Line::of(run.scored.variant)),
            )
        });
        let mut estimates: Vec<Body> = estimates.collect();
        estimates.sort_by_key(|body| body.line);
        let particles = self.learner().into_iter().flat_map(|run| {
            let cloud = run.cloud.get(row).map_or(&[][..], Vec::as_slice);
            cloud
                .iter()
                .map(|pose| Body::new("", shape, pose, run.colour()).thin())
        });
        Overlay {
            title: self.instant(row),
            view: Some(view_of(self.in_view(row))),
            bodies: self
                .known_bodies(row)
                .into_iter()
                .chain(particles)
                .chain(estimates)
                .collect(),
            width: 441.0,
        }
    }

    /// Bodies that a picture shows in full: the known ones, and the learner's object if the true
    /// one is unknown.
    fn in_view(&self, row: usize) -> Vec<Body> {
        let mut bodies = self.known_bodies(row);
        if self.reference.pose_at(self.time_of(row)).is_none() {
            let run = self.learner().or(self.runs.first());
            let pose = run.and_then(|run| run.scored.estimate.rows.get(row)?.pose);
            let shape = &self.setup.scene.object.shape;
            bodies.extend(pose.map(|pose| Body::new("", shape, &pose, Colour::INK)));
        }
        bodies
    }

    /// "5.27 s, camera off".
    fn instant(&self, row: usize) -> String {
        let off = if self.hidden.get(row) == Some(&true) {
            ", camera off"
        } else {
            ""
        };
        format!("{:.2} s{off}", self.time_of(row))
    }

    pub(crate) fn time_of(&self, row: usize) -> f64 {
        self.log.time.get(row).copied().unwrap_or(0.0)
    }

    /// Fixels, pusher and the object at its reference pose.
    pub(crate) fn known_bodies(&self, row: usize) -> Vec<Body> {
        let scene = &self.setup.scene;
        let truth = self.reference.pose_at(self.time_of(row));
        let object = truth.map(|pose| {
            let name = &self.reference_name;
            Body::new(name, &scene.object.shape, &pose, Colour::INK).filled(0.12)
        });
        let mut bodies = Body::surroundings(scene, &self.log.fingers_at(row));
        bodies.extend(object);
        bodies
    }

    /// The learner's particles at the rows that pictures show, side by side.
    fn clouds(&self) -> Option<Drawing> {
        let rows = self.shown_rows();
        let clouds = rows.iter().filter_map(|row| self.cloud(*row));
        let drawings: Vec<Drawing> = clouds.map(|cloud| cloud.drawing()).collect();
        (!drawings.is_empty()).then(|| Drawing::grid(&drawings, 2))
    }

    fn cloud(&self, row: usize) -> Option<ParticleCloud> {
        let run = self.learner()?;
        let particles = run.cloud.get(row).filter(|cloud| !cloud.is_empty())?;
        let centre = run.scored.estimate.rows.get(row)?.pose?;
        let reference = self.reference.pose_at(self.time_of(row));
        let reference = reference.map(|pose| (self.reference_name.clone(), Colour::INK, pose));
        let mean = (run.title().to_owned(), run.colour(), centre);
        Some(ParticleCloud {
            title: self.instant(row),
            centre,
            particles: particles.clone(),
            colour: run.colour(),
            compared: reference.into_iter().chain([mean]).collect(),
            turn_factor: 10.0,
            width: 441.0,
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
