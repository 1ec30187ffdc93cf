//! Figures of the learner's belief: how many particles count, and how contacts slip.

use stickslip::{ContactSlip, EstimateRow};

use crate::axis::Scale;
use crate::colour::{Colour, Line};
use crate::experiment_figures::Figure;
use crate::reported_experiment::ReportedExperiment;
use crate::reported_run::ReportedRun;
use crate::time_figure::{Curve, Panel, TimeFigure};

/// Probability of contact from which a body gets a panel.
const TOUCHED: f64 = 0.5;

impl ReportedExperiment<'_> {
    /// Figure of the number of the learner's particles that count, and of their modes.
    pub(crate) fn particles(&self) -> Option<Figure> {
        let run = self.learner()?;
        let count = |of: Option<u32>| of.map(f64::from);
        let panel = Panel {
            label: "particles".to_owned(),
            scale: Scale::Log { floor: 1.0 },
            curves: vec![
                curve(run, "effective sample size", run.colour(), &|row| row.ess),
                curve(
                    run,
                    "with descendants, of the row before",
                    Colour::INK,
                    &|row| count(row.distinct),
                ),
                Curve {
                    line: Line::Dashed,
                    ..curve(
                        run,
                        "of the latest camera pose before",
                        Colour::INK,
                        &|row| count(row.ancestors),
                    )
                },
                Curve {
                    line: Line::Dotted,
                    ..curve(run, "modes", Colour::VERMILLION, &|row| {
                        (!row.modes.is_empty()).then_some(row.modes.len() as f64)
                    })
                },
            ],
            ..Panel::default()
        };
        let mut rows = run.scored.estimate.rows.iter();
        let known = rows.any(|row| row.ancestors.is_some());
        let figure = TimeFigure {
            panels: vec![panel],
            ..self.time_figure()
        };
        let text = "How many particles count: effective sample size after weighing; of how many particles of the row before, and of the \
                    latest row before with a camera pose, those of a row descend; in how many places (modes) they are.";
        known.then(|| Figure::new("particles", figure.drawing(), text))
    }

    /// Figure of the probabilities that the object sticks to the bodies it touches or slides on
    /// them.
    pub(crate) fn slips(&self) -> Option<Figure> {
        let run = self.learner()?;
        let rows = &run.scored.estimate.rows;
        let bodies = rows.iter().find_map(|row| row.slip.as_ref())?.len();
        let of = |row: &EstimateRow, body: usize| row.slip.as_ref()?.get(body).copied();
        let touched = |body: &usize| {
            let sums = rows.iter().filter_map(|row| of(row, *body));
            sums.map(|slip| slip.stick + slip.left + slip.right)
                .any(|touch| touch > TOUCHED)
        };
        let panel = |body: usize| {
            let share = |name: &str, colour, line, share: fn(ContactSlip) -> f64| Curve {
                line,
                ..curve(run, name, colour, &|row| of(row, body).map(share))
            };
            Panel {
                label: self.setup.scene.contact(body).to_string(),
                limits: Some([0.0, 1.0]),
                curves: vec![
                    share("sticks", Colour::INK, Line::Solid, |slip| slip.stick),
                    share("slides left", Colour::SKY, Line::Solid, |slip| slip.left),
                    share("slides right", Colour::VERMILLION, Line::Dashed, |slip| {
                        slip.right
                    }),
                ],
                ..Panel::default()
            }
        };
        let panels: Vec<Panel> = (0..bodies).filter(touched).map(panel).collect();
        let text = "Probability that the object touches a body and sticks (or rolls), or that its surface slides to the left or to the \
                    right, seen along the contact normal, which points into the object.";
        (!panels.is_empty()).then(|| {
            let figure = TimeFigure {
                panels,
                ..self.time_figure()
            };
            Figure::new("slips", figure.drawing(), text)
        })
    }
}

/// A number of each row of the learner against time.
fn curve(
    run: &ReportedRun,
    name: &str,
    colour: Colour,
    of: &dyn Fn(&EstimateRow) -> Option<f64>,
) -> Curve {
    let estimate = &run.scored.estimate;
    let rows = estimate.time.iter().zip(&estimate.rows);
    let points = rows.map(|(time, row)| [*time, of(row).unwrap_or(f64::NAN)]);
    Curve::new(name, colour, points.collect())
}
