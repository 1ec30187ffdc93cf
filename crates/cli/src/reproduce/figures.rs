//! Figures 1 to 7 of the paper, ours: [`figures`]. Errors and parameters over all seeds, poses of
//! the first one.

use stickslip::EstimateRow;
use stickslip::dynamics::Pose;
use stickslip_evaluation::paper::{PaperExperiment, RunSet};
use stickslip_evaluation::{
    Reference, ScoredRun,
    Variant::{
        self, Kalman, KalmanCameraOn, Nominal, Particle, ParticleNoTouch, ParticleNoTouchCameraOn,
    },
};
use stickslip_report::{
    Body, Colour, Curve, Drawing, FRICTION_PARAMETERS, Figure, FrictionParameter, Line, Mark,
    Overlay, Panel, PoseError, TimeFigure, friction_panels, pose_errors,
};

/// Time shown before the thumb touches (s).
const BEFORE: f64 = 0.5;
/// Width of a picture of poses (px).
const PICTURE: f64 = 294.0;

/// All runs on one experiment, by seed.
struct Replicates<'a> {
    run_sets: Vec<&'a RunSet>,
}

/// Figures 1 to 7 from runs on an A and on a B of these names.
pub fn figures(run_sets: &[RunSet], [name_a, name_b]: [&str; 2]) -> Vec<Figure> {
    let a = Replicates::of(run_sets, PaperExperiment::A);
    let b = Replicates::of(run_sets, PaperExperiment::B);
    let camera_on = [Nominal, ParticleNoTouchCameraOn, KalmanCameraOn];
    let a_end = a.last_row();
    vec![
        Figure::new(
            "fig1",
            b.rig(),
            format!(
                "Figure 1, {name_b}: the rig at the first row. The thumb, on the left, pushes the object into three fixels."
            ),
        ),
        Figure::new(
            "fig2",
            a.x_errors(),
            format!("Figure 2, {name_a}: error of x. a) the camera is always on; b) it turns off."),
        ),
        Figure::new(
            "fig3",
            a.poses(&[
                (a_end, camera_on),
                (a_end, [Nominal, ParticleNoTouch, Kalman]),
            ]),
            format!(
                "Figure 3, {name_a}, seed 0: the object at the last row; grey: truth. Above with the camera on, below without."
            ),
        ),
        Figure::new(
            "fig4",
            a.parameters(ParticleNoTouchCameraOn),
            format!(
                "Figure 4, {name_a}: friction as the particle filter estimates it, the camera always on; dashed: its own standard deviation."
            ),
        ),
        Figure::new(
            "fig5",
            b.errors(&[Particle, ParticleNoTouch, Nominal]),
            format!(
                "Figure 5, {name_b}: errors of x, y and θ; the camera turns off before the first fixel."
            ),
        ),
        Figure::new(
            "fig6",
            b.poses(
                &[b.first_fixel_contact(), b.last_row()]
                    .map(|row| (row, [Nominal, ParticleNoTouch, Particle])),
            ),
            format!(
                "Figure 6, {name_b}, seed 0: the object at the first contact with a fixel (above) and at the last row (below); grey: truth."
            ),
        ),
        Figure::new(
            "fig7",
            b.parameters(Particle),
            format!(
                "Figure 7, {name_b}: friction as the particle filter with tactile data estimates it; dashed: its own standard deviation."
            ),
        ),
    ]
}

impl<'a> Replicates<'a> {
    fn of(run_sets: &'a [RunSet], paper: PaperExperiment) -> Self {
        let own = run_sets.iter().filter(|set| set.replicate.paper == paper);
        Self {
            run_sets: own.collect(),
        }
    }

    /// The first seed.
    fn first(&self) -> &'a RunSet {
        self.run_sets[0]
    }

    /// The last row, at most the paper's 300.
    fn last_row(&self) -> usize {
        300.min(self.first().replicate.experiment.log.len() - 1)
    }

    /// Row of the first contact with a fixel.
    fn first_fixel_contact(&self) -> usize {
        let facts = &self.first().replicate.experiment.facts;
        let contacts = facts.first_fixel_contacts.iter().flatten();
        contacts.copied().min().unwrap_or_else(|| self.last_row())
    }

    /// The bodies where they begin.
    fn rig(&self) -> Drawing {
        let experiment = &self.first().replicate.experiment;
        let scene = &experiment.setup.scene;
        let mut bodies = Body::surroundings(scene, &experiment.log.fingers_at(0));
        let start = Reference::of(experiment).pose[0];
        bodies.extend(
            start.map(|pose| Body::new("", &scene.object.shape, &pose, Colour::INK).filled(0.12)),
        );
        let overlay = Overlay {
            bodies,
            width: 588.0,
            ..Overlay::default()
        };
        overlay.drawing()
    }

    /// The median curve of a variant over seeds, from points of each run.
    fn curve(
        &self,
        variant: Variant,
        points: impl Fn(&RunSet, &ScoredRun) -> Vec<[f64; 2]>,
    ) -> Curve {
        let runs = self.run_sets.iter();
        let runs = runs.filter_map(|set| Some(points(set, set.run(variant)?)));
        let runs: Vec<_> = runs.collect();
        Curve {
            line: Line::of(variant),
            ..Curve::over_runs(variant.paper_title(), Colour::of(variant), &runs)
        }
    }

    /// One kind of error of some variants.
    fn panel(&self, label: &str, variants: &[Variant], of: fn(&PoseError) -> f64) -> Panel {
        let points = |set: &RunSet, run: &ScoredRun| {
            let reference = Reference::of(&set.replicate.experiment);
            let errors = pose_errors(&run.estimate, &reference);
            errors.iter().map(|error| [error.time, of(error)]).collect()
        };
        // the nominal simulation never uses the camera, whether it is on or not
        let always_on = |variant: &Variant| variant.camera_on() || *variant == Nominal;
        Panel {
            label: label.to_owned(),
            curves: variants
                .iter()
                .map(|variant| self.curve(*variant, points))
                .collect(),
            dark: variants.iter().all(always_on).then(Vec::new),
            ..Panel::default()
        }
    }

    /// Figure against time, with the parts that all such figures share.
    fn time_figure(&self, panels: Vec<Panel>) -> TimeFigure {
        let experiment = &self.first().replicate.experiment;
        let (time, facts) = (&experiment.log.time, &experiment.facts);
        let end = time.last().copied().unwrap_or(0.0);
        let at = |row: Option<usize>| row.and_then(|row| time.get(row)).copied();
        let mark = |row: Option<usize>, name: String| at(row).map(|time| Mark { time, name });
        let fixels = (1..).zip(&facts.first_fixel_contacts);
        let fixels = fixels.filter_map(|(k, row)| mark(*row, format!("fixel {k}")));
        let thumb = mark(facts.first_pusher_contact, "pusher".to_owned());
        let begin = thumb.as_ref().map_or(0.0, |mark| mark.time - BEFORE);
        let dark = at(facts.occlude_from).map(|from| [from, end]);
        TimeFigure {
            span: [begin.max(0.0), end],
            dark: dark.into_iter().collect(),
            marks: thumb.into_iter().chain(fixels).collect(),
            panels,
            band_name: format!("10–90 % of {} seeds", self.run_sets.len()),
            time_label: "time (s), and time step below".to_owned(),
            steps: Some(30.0),
            ..TimeFigure::default()
        }
    }

    fn x_errors(&self) -> Drawing {
        let x = |title: &str, variants: &[Variant]| Panel {
            title: title.to_owned(),
            ..self.panel("error of x (mm)", variants, |error| error.x_mm)
        };
        let camera_on = [ParticleNoTouchCameraOn, KalmanCameraOn, Nominal];
        let figure = self.time_figure(vec![
            x("a) no visual occlusion", &camera_on),
            x("b) visual occlusion", &[ParticleNoTouch, Kalman, Nominal]),
        ]);
        figure.drawing()
    }

    fn errors(&self, variants: &[Variant]) -> Drawing {
        let figure = TimeFigure {
            panel_size: [882.0, 200.0],
            ..self.time_figure(vec![
                self.panel("error of x (mm)", variants, |error| error.x_mm),
                self.panel("error of y (mm)", variants, |error| error.y_mm),
                self.panel("error of θ (°)", variants, |error| error.turn_deg),
            ])
        };
        figure.drawing()
    }

    /// The four friction parameters.
    fn parameters(&self, variant: Variant) -> Drawing {
        let experiment = &self.first().replicate.experiment;
        let facts = &experiment.facts;
        // the median over seeds, and about it the median of the filters' own standard deviations
        let off_by = |parameter: &FrictionParameter, deviations: f64| {
            self.curve(variant, |_, run| {
                let rows = run.estimate.time.iter().zip(&run.estimate.rows);
                let value = |row: &EstimateRow| {
                    let std = row.spread.and_then(|spread| spread.friction);
                    parameter.shown(row.friction) + deviations * parameter.shown(std)
                };
                rows.map(|(time, row)| [*time, value(row)]).collect()
            })
        };
        let curves = |parameter: &FrictionParameter| {
            let own = [-1.0, 1.0].map(|deviations| Curve {
                name: "± its own standard deviation".to_owned(),
                line: Line::Dashed,
                band: Vec::new(),
                ..off_by(parameter, deviations)
            });
            let middle = Curve {
                line: Line::Solid,
                ..off_by(parameter, 0.0)
            };
            [middle].into_iter().chain(own).collect()
        };
        let mut panels = friction_panels(
            &FRICTION_PARAMETERS,
            &experiment.setup.scene.nominal,
            &[facts.mu_s, facts.mu_p, facts.mu_f, facts.d_tri],
            curves,
        );
        for panel in &mut panels {
            panel.dark = variant.camera_on().then(Vec::new);
        }
        let figure = TimeFigure {
            columns: 2,
            panel_size: [441.0, 210.0],
            ..self.time_figure(panels)
        };
        figure.drawing()
    }

    /// Poses at rows of the log, one row of pictures for each, one picture for each variant.
    fn poses(&self, rows: &[(usize, [Variant; 3])]) -> Drawing {
        let first = self.first();
        let experiment = &first.replicate.experiment;
        let scene = &experiment.setup.scene;
        let body = |pose: Pose, colour| Body::new("", &scene.object.shape, &pose, colour);
        let mut pictures = Vec::new();
        for (row, variants) in rows {
            let truth = Reference::of(experiment).pose[*row];
            for (column, variant) in variants.iter().enumerate() {
                let run = first.run(*variant);
                let pose = run.and_then(|run| run.estimate.rows.get(*row)?.pose);
                let title = match column {
                    0 => format!("{}, row {row}", variant.paper_title()),
                    _ => variant.paper_title().to_owned(),
                };
                let mut bodies = Body::surroundings(scene, &experiment.log.fingers_at(*row));
                bodies.extend(truth.map(|pose| body(pose, Colour::INK).filled(0.12)));
                bodies.extend(pose.map(|pose| body(pose, Colour::of(*variant)).filled(0.25)));
                let overlay = Overlay {
                    title,
                    bodies,
                    width: PICTURE,
                    ..Overlay::default()
                };
                pictures.push(overlay.drawing());
            }
        }
        Drawing::grid(&pictures, 3)
    }
}
