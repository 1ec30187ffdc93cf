//! From estimates to curves: [`pose_errors`], [`friction_panels`], and [`Curve::over_runs`] for
//! many seeds.

use stickslip::dynamics::{Friction, Pose};
use stickslip::{Estimate, quantile};
use stickslip_evaluation::Reference;

use crate::colour::{Colour, Line};
use crate::time_figure::{Curve, Level, Panel};

/// Estimate minus reference at one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseError {
    /// Time of the row (s).
    pub time: f64,
    /// Along x (mm).
    pub x_mm: f64,
    /// Along y (mm).
    pub y_mm: f64,
    /// Angle, on the circle: -180 to 180 (degrees).
    pub turn_deg: f64,
}

impl PoseError {
    /// That of a guess at a time; NaN where either has no pose.
    #[must_use]
    pub fn of(time: f64, guess: Option<Pose>, truth: Option<Pose>) -> Self {
        let pair = truth.zip(guess);
        let [x_mm, y_mm, turn_deg] = pair.map_or([f64::NAN; 3], |(truth, guess)| {
            [
                1e3 * (guess.x - truth.x),
                1e3 * (guess.y - truth.y),
                on_circle((guess.theta - truth.theta).to_degrees()),
            ]
        });
        Self {
            time,
            x_mm,
            y_mm,
            turn_deg,
        }
    }

    /// Distance of the positions (mm).
    #[must_use]
    pub fn distance_mm(&self) -> f64 {
        self.x_mm.hypot(self.y_mm)
    }
}

/// The errors of an estimate at every row of the reference, as in scores, each at the time of its
/// pose; NaN where either has no pose.
#[must_use]
pub fn pose_errors(estimate: &Estimate, reference: &Reference) -> Vec<PoseError> {
    let rows = reference.time.iter().zip(&reference.pose);
    let error = |(time, truth): (&f64, &Option<Pose>)| {
        let seen = time - reference.latency;
        PoseError::of(seen, estimate.pose_at(seen), *truth)
    };
    rows.map(error).collect()
}

/// An angle from -180 to 180 degrees.
fn on_circle(degrees: f64) -> f64 {
    (degrees + 180.0).rem_euclid(360.0) - 180.0
}

impl Curve {
    /// A solid line without a band.
    #[must_use]
    pub fn new(name: &str, colour: Colour, points: Vec<[f64; 2]>) -> Self {
        Self {
            name: name.to_owned(),
            colour,
            points,
            ..Self::default()
        }
    }

    /// The median of several runs at each row with the band from their 10 % to their 90 % quantile.
    ///
    /// Rows are taken together by their number; a row at which some run has no finite value has
    /// none.
    #[must_use]
    pub fn over_runs(name: &str, colour: Colour, runs: &[Vec<[f64; 2]>]) -> Self {
        let rows = runs.iter().map(Vec::len).min().unwrap_or(0);
        let at = |row: usize, q: f64| {
            let values: Vec<f64> = runs.iter().map(|run| run[row][1]).collect();
            if values.iter().all(|value| value.is_finite()) {
                quantile(&values, q).unwrap_or(f64::NAN)
            } else {
                f64::NAN
            }
        };
        let time = |row: usize| runs[0][row][0];
        let points = (0..rows).map(|row| [time(row), at(row, 0.5)]).collect();
        let band = if runs.len() > 1 {
            (0..rows)
                .map(|row| [time(row), at(row, 0.1), at(row, 0.9)])
                .collect()
        } else {
            Vec::new()
        };
        Self {
            band,
            ..Self::new(name, colour, points)
        }
    }
}

/// A friction parameter as figures show it.
#[derive(Clone, Copy, Debug)]
pub struct FrictionParameter {
    /// Its name, as in files.
    pub name: &'static str,
    /// Label of its axis.
    pub label: &'static str,
    /// Factor to the unit shown.
    pub unit: f64,
    /// Its value (SI).
    pub of: fn(&Friction) -> f64,
}

/// The four parameters; d_tri is the last one, which is none where the feet are known.
pub const FRICTION_PARAMETERS: [FrictionParameter; 4] = [
    FrictionParameter {
        name: "mu_s",
        label: "μ_s",
        unit: 1.0,
        of: |friction| friction.mu_s,
    },
    FrictionParameter {
        name: "mu_p",
        label: "μ_p",
        unit: 1.0,
        of: |friction| friction.mu_p,
    },
    FrictionParameter {
        name: "mu_f",
        label: "μ_f",
        unit: 1.0,
        of: |friction| friction.mu_f,
    },
    FrictionParameter {
        name: "d_tri",
        label: "d_tri (mm)",
        unit: 1e3,
        of: |friction| friction.d_tri,
    },
];

/// Least height of a panel as a share of the nominal value: less is of no consequence.
const LEAST_SPAN: f64 = 0.3;

/// A panel for each parameter: the curves that `curves` draws, the nominal value and, where it is
/// known, the truth (SI).
#[must_use]
pub fn friction_panels(
    parameters: &[FrictionParameter],
    nominal: &Friction,
    truth: &[Option<f64>; 4],
    curves: impl Fn(&FrictionParameter) -> Vec<Curve>,
) -> Vec<Panel> {
    let panel = |(parameter, truth): (&FrictionParameter, &Option<f64>)| {
        let level = |name: &str, value: f64, line: Line| Level {
            name: name.to_owned(),
            value: parameter.unit * value,
            colour: Colour::INK,
            line,
        };
        let truth = truth.map(|value| level("truth", value, Line::Solid));
        let nominal = level("nominal", (parameter.of)(nominal), Line::Dashed);
        Panel {
            label: parameter.label.to_owned(),
            curves: curves(parameter),
            least_span: LEAST_SPAN * nominal.value,
            levels: truth.into_iter().chain([nominal]).collect(),
            ..Panel::default()
        }
    };
    parameters.iter().zip(truth).map(panel).collect()
}

impl FrictionParameter {
    /// A value in the unit shown; NaN where there is none, which leaves a gap.
    #[must_use]
    pub fn shown(&self, friction: Option<Friction>) -> f64 {
        friction.map_or(f64::NAN, |friction| self.unit * (self.of)(&friction))
    }
}

/// A parameter of one estimate with a band of one standard deviation to either side, up to the last
/// row that informs about it; later rows are dotted and have no band.
pub(crate) fn friction_curves(
    name: &str,
    colour: Colour,
    estimate: &Estimate,
    parameter: &FrictionParameter,
    informed: Option<usize>,
) -> Vec<Curve> {
    let rows = estimate.time.iter().zip(&estimate.rows);
    let values = rows.map(|(time, row)| {
        let std = row.spread.and_then(|spread| spread.friction);
        [*time, parameter.shown(row.friction), parameter.shown(std)]
    });
    let (points, band): (Vec<[f64; 2]>, Vec<[f64; 3]>) = values
        .map(|[time, mean, std]| ([time, mean], [time, mean - std, mean + std]))
        .unzip();
    let rows = informed.map_or(0, |row| row + 1);
    let learning = Curve {
        band: band[..rows].to_vec(),
        ..Curve::new(name, colour, points[..rows].to_vec())
    };
    let after = Curve {
        line: Line::Dotted,
        ..Curve::new(
            "no new information",
            colour,
            points[rows.saturating_sub(1)..].to_vec(),
        )
    };
    vec![learning, after]
}

#[cfg(test)]
mod tests {
    use stickslip::EstimateRow;

    use super::*;

    #[test]
    fn pose_errors_are_in_mm_and_on_the_circle() {
        let at = |x: f64, y: f64, theta: f64| Some(Pose::new(x, y, theta));
        let row = |pose| EstimateRow {
            pose,
            ..EstimateRow::default()
        };
        let estimate = Estimate {
            time: vec![0.0, 1.0],
            rows: vec![row(at(0.003, 0.004, 3.1)), row(None)],
            ..Estimate::default()
        };
        let reference = Reference {
            time: vec![0.0, 1.0],
            pose: vec![at(0.0, 0.0, -3.1), at(0.0, 0.0, 0.0)],
            ..Reference::default()
        };
        let errors = pose_errors(&estimate, &reference);
        assert!(
            (errors[0].distance_mm() - 5.0).abs() < 1e-12 && (errors[0].x_mm - 3.0).abs() < 1e-12
        );
        assert!(
            (errors[0].turn_deg - (6.2_f64.to_degrees() - 360.0)).abs() < 1e-9,
            "{errors:?}"
        );
        assert!(errors[1].turn_deg.is_nan() && errors[1].time == 1.0);
    }

    #[test]
    fn over_runs_is_the_median_with_its_band() {
        let runs: Vec<Vec<[f64; 2]>> = (0..=10)
            .map(|k| {
                vec![
                    [0.0, f64::from(k)],
                    [1.0, if k == 3 { f64::NAN } else { 1.0 }],
                ]
            })
            .collect();
        let curve = Curve::over_runs("particle", Colour::SKY, &runs);
        assert_eq!(
            (curve.points[0], curve.band[0]),
            ([0.0, 5.0], [0.0, 1.0, 9.0])
        );
        assert!(curve.points[1][1].is_nan());
        assert!(
            Curve::over_runs("one", Colour::SKY, &runs[..1])
                .band
                .is_empty()
        );
        assert!(Curve::over_runs("none", Colour::SKY, &[]).points.is_empty());
    }
}
