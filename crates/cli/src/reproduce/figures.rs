//! Figures 2 to 7 of the paper, ours: [`figures`]. Errors and parameters over all seeds, poses of
//! the first one.

use anyhow::Result;
use stickslip::EstimateRow;
use stickslip::dynamics::Friction;
use stickslip_report::{
    Curve, Drawing, Level, Line, Mark, Panel, PoseError, TimeFigure, pose_errors,
};

use super::course::{Course, Heat};
use super::participant::{
    BLIND, BLIND_OPEN, KALMAN, KALMAN_OPEN, NOMINAL, Participant, Sight, TACTILE,
};
use super::still::Still;
use crate::paper::PaperExperiment;

/// Time shown before the thumb touches (s).
const BEFORE: f64 = 0.5;

/// A parameter's name, the factor to the unit that it is shown in, and where it is.
type Shown = (&'static str, f64, fn(&Friction) -> f64);

const PARAMETERS: [Shown; 4] = [
    ("μ_s", 1.0, |f| f.mu_s),
    ("μ_p", 1.0, |f| f.mu_p),
    ("μ_f", 1.0, |f| f.mu_f),
    ("d_tri (mm)", 1e3, |f| f.d_tri),
];

/// A figure of the paper.
#[derive(Clone, Debug)]
pub struct PaperFigure {
    /// Name of its files: `fig2`.
    pub name: &'static str,
    /// What is drawn.
    pub drawing: Drawing,
    /// What one sees.
    pub caption: String,
}

/// All runs on one experiment.
struct Album<'a> {
    heats: Vec<&'a Heat>,
}

/// Figures 2 to 7.
pub fn figures(heats: &[Heat]) -> Result<Vec<PaperFigure>> {
    let a = Album::of(heats, PaperExperiment::A);
    let b = Album::of(heats, PaperExperiment::B);
    let figure = |name, drawing: Drawing, caption: &str| PaperFigure {
        name,
        drawing,
        caption: caption.to_owned(),
    };
    Ok(vec![
        figure(
            "fig2",
            a.x_errors(),
            "Figure 2, experiment A: error of x. a) the camera is always on; b) it goes dark.",
        ),
        figure(
            "fig3",
            a.poses(&[
                (300, &[NOMINAL, BLIND_OPEN, KALMAN_OPEN]),
                (300, &[NOMINAL, BLIND, KALMAN]),
            ])?,
            "Figure 3, experiment A, seed 0: the object at the last row, on the camera image. Above with the camera on, below without.",
        ),
        figure(
            "fig4",
            a.parameters(BLIND_OPEN),
            "Figure 4, experiment A: friction as the particle filter estimates it, the camera always on.",
        ),
        figure(
            "fig5",
            b.errors(&[TACTILE, BLIND, NOMINAL]),
            "Figure 5, experiment B: errors of x, y and θ; the camera goes dark at row 240.",
        ),
        figure(
            "fig6",
            b.poses(&[
                (257, &[NOMINAL, BLIND, TACTILE]),
                (300, &[NOMINAL, BLIND, TACTILE]),
            ])?,
            "Figure 6, experiment B, seed 0: the object at the first contact with a fixel (above) and at the last row (below).",
        ),
        figure(
            "fig7",
            b.parameters(TACTILE),
            "Figure 7, experiment B: friction as the particle filter with tactile data estimates it.",
        ),
    ])
}

impl<'a> Album<'a> {
    fn of(heats: &'a [Heat], paper: PaperExperiment) -> Self {
        Self {
            heats: heats
                .iter()
                .filter(|heat| heat.recording.paper == paper)
                .collect(),
        }
    }

    /// The heat of the first seed.
    fn first(&self) -> &'a Heat {
        self.heats[0]
    }

    fn courses(&self, participant: Participant) -> impl Iterator<Item = (&'a Heat, &'a Course)> {
        self.heats
            .iter()
            .filter_map(move |heat| Some((*heat, heat.course(participant)?)))
    }

    /// One kind of error of a participant over all seeds.
    fn error(&self, participant: Participant, of: fn(&PoseError) -> f64) -> Curve {
        let run = |(heat, course): (&Heat, &Course)| {
            let errors = pose_errors(&course.estimate, &heat.recording.experiment.reference());
            errors
                .iter()
                .map(|error| [error.time, of(error)])
                .collect::<Vec<_>>()
        };
        Curve::over_runs(
            participant.name(),
            participant.colour(),
            &self.courses(participant).map(run).collect::<Vec<_>>(),
        )
    }

    fn panel(&self, label: &str, participants: &[Participant], of: fn(&PoseError) -> f64) -> Panel {
        let curves = participants
            .iter()
            .map(|participant| self.error(*participant, of))
            .collect();
        let dark = participants
            .iter()
            .any(|participant| participant.sight == Sight::Dark && *participant != NOMINAL);
        Panel {
            label: label.to_owned(),
            curves,
            dark: (!dark).then(Vec::new),
            ..Panel::default()
        }
    }

    /// What all figures against time share.
    fn frame(&self, panels: Vec<Panel>) -> TimeFigure {
        let experiment = &self.first().recording.experiment;
        let (time, facts) = (&experiment.log.time, &experiment.facts);
        let end = time.last().copied().unwrap_or(0.0);
        let at = |row: Option<usize>| row.and_then(|row| time.get(row)).copied();
        let fixels = facts.first_fixel_contacts.iter().enumerate();
        let fixels = fixels.filter_map(|(k, row)| {
            Some(Mark {
                time: at(*row)?,
                name: format!("fixel {}", k + 1),
            })
        });
        let thumb = at(facts.first_pusher_contact).map(|time| Mark {
            time,
            name: "pusher".to_owned(),
        });
        let begin = thumb
            .as_ref()
            .map_or(0.0, |mark| mark.time - BEFORE)
            .max(0.0);
        TimeFigure {
            span: [begin, end],
            dark: at(facts.occlude_from)
                .map(|from| [from, end])
                .into_iter()
                .collect(),
            marks: thumb.into_iter().chain(fixels).collect(),
            panels,
            band_name: format!("10–90 % of {} seeds", self.heats.len()),
            ..TimeFigure::default()
        }
    }

    fn x_errors(&self) -> Drawing {
        let x = |title: &str, participants: &[Participant]| Panel {
            title: title.to_owned(),
            ..self.panel("error of x (mm)", participants, |error| error.x_mm)
        };
        let open = x(
            "a) no visual occlusion",
            &[BLIND_OPEN, KALMAN_OPEN, NOMINAL],
        );
        self.frame(vec![
            open,
            x("b) visual occlusion", &[BLIND, KALMAN, NOMINAL]),
        ])
        .drawing()
    }

    fn errors(&self, participants: &[Participant]) -> Drawing {
        let panels = vec![
            self.panel("error of x (mm)", participants, |error| error.x_mm),
            self.panel("error of y (mm)", participants, |error| error.y_mm),
            self.panel("error of θ (°)", participants, |error| error.turn_deg),
        ];
        TimeFigure {
            panel_size: [780.0, 200.0],
            ..self.frame(panels)
        }
        .drawing()
    }

    /// The four friction parameters.
    fn parameters(&self, participant: Participant) -> Drawing {
        let experiment = &self.first().recording.experiment;
        let (told, facts) = (&experiment.setup.scene.nominal, &experiment.facts);
        let truth = [facts.mu_s, facts.mu_p, facts.mu_f, facts.d_tri];
        let panel = |((label, unit, of), truth): (&Shown, Option<f64>)| {
            let value = |row: &EstimateRow| {
                row.friction
                    .map_or(f64::NAN, |friction| unit * of(&friction))
            };
            let run = |(_, course): (&Heat, &Course)| {
                let rows = course.estimate.time.iter().zip(&course.estimate.rows);
                rows.map(|(time, row)| [*time, value(row)])
                    .collect::<Vec<_>>()
            };
            let runs: Vec<Vec<[f64; 2]>> = self.courses(participant).map(run).collect();
            let level = |name: &str, value: f64, line: Line| Level {
                name: name.to_owned(),
                value: unit * value,
                line,
                ..Level::default()
            };
            Panel {
                label: (*label).to_owned(),
                curves: vec![Curve::over_runs(
                    participant.name(),
                    participant.colour(),
                    &runs,
                )],
                levels: truth
                    .map(|value| level("truth", value, Line::Solid))
                    .into_iter()
                    .chain([level("told", of(told), Line::Dashed)])
                    .collect(),
                dark: (participant.sight == Sight::Open).then(Vec::new),
                ..Panel::default()
            }
        };
        let panels = PARAMETERS.iter().zip(truth).map(panel).collect();
        TimeFigure {
            columns: 2,
            panel_size: [430.0, 210.0],
            ..self.frame(panels)
        }
        .drawing()
    }

    /// Poses at rows of the log, one row of pictures for each, one picture for each participant.
    fn poses(&self, rows: &[(usize, &[Participant])]) -> Result<Drawing> {
        let heat = self.first();
        let still = Still::new(&heat.recording)?;
        let mut pictures = Vec::new();
        for (row, participants) in rows {
            let frame = still.frame(*row);
            for participant in *participants {
                let estimate = heat.course(*participant).map(|course| &course.estimate);
                let pose = estimate.and_then(|estimate| estimate.rows.get(*row)?.pose);
                pictures.push(frame.with(
                    &format!("{}, row {row}", participant.name()),
                    pose,
                    participant.colour(),
                )?);
            }
        }
        Ok(Drawing::grid(
            &pictures,
            rows.first()
                .map_or(1, |(_, participants)| participants.len()),
        ))
    }
}
