//! Friction that a run has learnt when it ends: [`LearnedParameter`].
//!
//! With the paper's model, particles get new friction values only where the camera sees the object
//! and Φ keeps them (docs/method.md (20), (21)). At rest the set is resampled without new values,
//! until all its particles are copies of a few. Its spread then shrinks though nothing has been
//! learnt. The robust model keeps its last estimate at rest and while the camera is off.
//!
//! So the estimate of a parameter is that of the last row that informs about it; without such a row
//! it is not identified. With the robust model, particles begin with a prior. A parameter whose
//! spread is not much narrower than the prior's is not identified, either.

use serde::Serialize;
use stickslip::dynamics::Friction;
use stickslip::{Estimate, EstimateRow, Setup};

/// Probability from which a contact counts as there.
const TOUCHING: f64 = 0.5;

/// Share of the prior's spread below which a parameter is identified: its estimate then is nearer
/// the truth than the prior's mean by almost half (docs/log/2026-11-robust-model.md).
const NARROWER: f64 = 0.6;

/// One friction parameter at the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LearnedParameter {
    /// Its name, as in files.
    #[serde(skip)]
    pub name: &'static str,
    /// Posterior mean (SI), at the last row that informed; where none did, that of the prior.
    pub mean: f64,
    /// Posterior standard deviation of the same row (SI); 0 in a prior of the paper's model, which
    /// leaves nothing open.
    pub std: f64,
    /// True if the rows identify it.
    pub observed: bool,
    /// The last row that informed, where it was observed.
    pub row: Option<usize>,
    /// The last row that informed, also where it is too little to identify the parameter.
    #[serde(skip)]
    pub informed: Option<usize>,
}

/// A parameter's name, its value, and the rows that inform about it.
struct Source {
    name: &'static str,
    value: fn(&Friction) -> f64,
    informs: fn(&EstimateRow) -> bool,
}

/// Friction learnt from rows that come one by one. It keeps only the rows that decide, so that it
/// does not grow.
#[derive(Clone, Debug, Default)]
pub struct LearningFriction {
    /// The first row with a prior, then those that were the last to inform about a parameter.
    rows: Estimate,
}

/// μ_s, μ_p, μ_f and d_tri.
const SOURCES: [Source; 4] = [
    Source {
        name: "mu_s",
        value: |friction| friction.mu_s,
        informs: EstimateRow::moves,
    },
    Source {
        name: "mu_p",
        value: |friction| friction.mu_p,
        informs: |row| row.moves() && touches(row.contact_pusher),
    },
    Source {
        name: "mu_f",
        value: |friction| friction.mu_f,
        informs: |row| row.moves() && fixels(row).any(touches),
    },
    Source {
        name: "d_tri",
        value: |friction| friction.d_tri,
        informs: EstimateRow::moves,
    },
];

impl LearnedParameter {
    /// All parameters of a run; none for methods that do not estimate them, and no `d_tri` where
    /// the feet are known.
    #[must_use]
    pub fn all(estimate: &Estimate) -> Vec<Self> {
        SOURCES
            .iter()
            .filter(|source| source.name != "d_tri" || estimate.has_tripod)
            .filter_map(|source| Self::of(source, estimate))
            .collect()
    }

    fn of(source: &Source, estimate: &Estimate) -> Option<Self> {
        let value = |row: &EstimateRow| row.friction.map(|mean| (source.value)(&mean));
        let spread = |row: &EstimateRow| source.spread(row);
        let mut rows = estimate.rows.iter();
        let prior_mean = rows.find_map(value)?;

        let prior = estimate.rows.iter().find_map(spread).unwrap_or(0.0);
        let narrower = |std: f64| prior == 0.0 || std < NARROWER * prior;

        let informed = estimate.rows.iter().rposition(|row| source.informed(row));
        let row = informed.filter(|row| spread(&estimate.rows[*row]).is_some_and(narrower));
        let at_row = informed.map(|row| &estimate.rows[row]);
        Some(Self {
            name: source.name,
            mean: at_row.and_then(value).unwrap_or(prior_mean),
            std: at_row.and_then(spread).unwrap_or(prior),
            observed: row.is_some(),
            row,
            informed,
        })
    }

    /// "0.283 ± 0.021", "not observed"; lengths in mm.
    #[must_use]
    pub fn shown(&self) -> String {
        match (self.observed, self.name) {
            (false, _) => "not identifiable".to_owned(),
            (true, "d_tri") => format!("{:.1} ± {:.1} mm", 1e3 * self.mean, 1e3 * self.std),
            (true, _) => format!("{:.3} ± {:.3}", self.mean, self.std),
        }
    }

    /// A value of this parameter as `shown` has it, without a spread; a dash where there is none.
    #[must_use]
    pub fn shown_value(&self, value: Option<f64>) -> String {
        match (value, self.name) {
            (None, _) => "-".to_owned(),
            (Some(value), "d_tri") => format!("{:.1} mm", 1e3 * value),
            (Some(value), _) => format!("{value:.3}"),
        }
    }

    /// Its value among those of all parameters.
    #[must_use]
    pub fn among(&self, friction: &Friction) -> Option<f64> {
        let mut sources = SOURCES.iter();
        let source = sources.find(|source| source.name == self.name)?;
        Some((source.value)(friction))
    }
}

impl Source {
    fn spread(&self, row: &EstimateRow) -> Option<f64> {
        row.spread?.friction.map(|std| (self.value)(&std))
    }

    /// Returns true if the camera saw the row and the parameter acted in the step to it.
    fn informed(&self, row: &EstimateRow) -> bool {
        row.visual && (self.informs)(row) && self.spread(row).is_some_and(|std| std > 0.0)
    }
}

impl LearningFriction {
    /// A run in this scene, before its first row.
    #[must_use]
    pub fn new(setup: &Setup) -> Self {
        Self {
            rows: Estimate {
                has_tripod: setup.has_tripod(),
                ..Estimate::default()
            },
        }
    }

    /// Takes the estimate at the next row.
    pub fn add(&mut self, row: &EstimateRow) {
        let rows = &mut self.rows.rows;
        let informs = || SOURCES.iter().any(|source| source.informed(row));
        if row.friction.is_none() || !(rows.is_empty() || informs()) {
            return;
        }
        rows.push(row.clone());
        let last = SOURCES.map(|source| rows.iter().rposition(|row| source.informed(row)));
        let mut place = 0;
        rows.retain(|_| {
            let decides = place == 0 || last.contains(&Some(place));
            place += 1;
            decides
        });
    }

    /// All parameters so far, like [`LearnedParameter::all`]; `row` and `informed` do not count
    /// rows of the run.
    #[must_use]
    pub fn parameters(&self) -> Vec<LearnedParameter> {
        LearnedParameter::all(&self.rows)
    }
}

fn touches(probability: Option<f64>) -> bool {
    probability.is_some_and(|p| p > TOUCHING)
}

fn fixels(row: &EstimateRow) -> impl Iterator<Item = Option<f64>> {
    row.contact_others.iter().flatten().copied().map(Some)
}

#[cfg(test)]
mod tests {
    use stickslip::Spread;
    use stickslip::dynamics::{Pose, Twist};

    use super::*;

    fn friction(all: f64) -> Friction {
        Friction {
            mu_s: all,
            mu_p: all,
            mu_f: all,
            d_tri: all,
        }
    }

    /// A row in which every parameter has this mean and this standard deviation.
    fn row(mean: f64, std: f64, speed: f64, touches: [f64; 2], visual: bool) -> EstimateRow {
        EstimateRow {
            pose: Some(Pose::default()),
            twist: Some(Twist {
                vx: speed,
                vy: 0.0,
                omega: 0.0,
            }),
            friction: Some(friction(mean)),
            spread: Some(Spread {
                friction: Some(friction(std)),
                ..Spread::default()
            }),
            contact_pusher: Some(touches[0]),
            contact_others: Some(vec![0.0, touches[1]]),
            visual,
            ..EstimateRow::default()
        }
    }

    #[test]
    fn last_row_that_informs_has_the_estimate() {
        let estimate = Estimate {
            rows: vec![
                EstimateRow::default(),
                row(0.3, 0.0, 0.0, [0.0, 0.0], true),
                row(0.31, 0.1, 0.02, [1.0, 0.0], true),
                // free of the pusher, then at rest, then occluded with a fixel
                row(0.32, 0.2, 0.02, [0.1, 0.0], true),
                row(0.33, 0.01, 0.0, [1.0, 0.0], true),
                row(0.34, 0.001, 0.02, [1.0, 1.0], false),
            ],
            has_tripod: true,
            ..Estimate::default()
        };
        let all = LearnedParameter::all(&estimate);
        let found: Vec<(&str, Option<usize>, f64, f64)> =
            all.iter().map(|p| (p.name, p.row, p.mean, p.std)).collect();
        assert_eq!(
            found,
            [
                ("mu_s", Some(3), 0.32, 0.2),
                ("mu_p", Some(2), 0.31, 0.1),
                ("mu_f", None, 0.3, 0.0),
                ("d_tri", Some(3), 0.32, 0.2)
            ]
        );
        assert_eq!(all[2].shown(), "not identifiable");
        assert_eq!(all[3].shown(), "320.0 ± 200.0 mm");
        let known_feet = Estimate {
            has_tripod: false,
            ..estimate
        };
        assert_eq!(LearnedParameter::all(&known_feet).len(), 3);
    }

    #[test]
    fn spread_that_stays_near_the_priors_was_not_observed() {
        let pushed = |std: f64| row(0.3, std, 0.02, [1.0, 0.0], true);
        for (std, observed) in [(0.065, false), (0.055, true)] {
            let estimate = Estimate {
                rows: vec![pushed(0.1), pushed(std), row(0.3, std, 0.0, [0.0; 2], true)],
                ..Estimate::default()
            };
            let [_, mu_p, _] = LearnedParameter::all(&estimate)[..] else {
                panic!("three parameters");
            };
            assert_eq!(mu_p.row, observed.then_some(1));
            assert_eq!(
                (mu_p.mean, mu_p.std),
                (0.3, std),
                "what is believed is said"
            );
            assert_eq!(mu_p.informed, Some(1));
        }
    }

    #[test]
    fn rows_one_by_one_teach_what_all_teach_and_few_are_kept() {
        let rows: Vec<EstimateRow> = (0..200)
            .map(|k| {
                let touch = f64::from(u8::from(k % 7 == 0));
                let speed = if k % 3 == 0 { 0.0 } else { 0.02 };
                let std = 0.1 / (1.0 + f64::from(k));
                row(
                    0.3 + 1e-3 * f64::from(k),
                    std,
                    speed,
                    [touch, 1.0 - touch],
                    k % 5 > 0,
                )
            })
            .collect();
        let mut one_by_one = LearningFriction::default();
        for count in 0..rows.len() {
            let whole = Estimate {
                rows: rows[..count].to_vec(),
                ..Estimate::default()
            };
            let numbers = |all: Vec<LearnedParameter>| -> Vec<_> {
                all.iter()
                    .map(|p| (p.name, p.mean, p.std, p.observed))
                    .collect()
            };
            assert_eq!(
                numbers(one_by_one.parameters()),
                numbers(LearnedParameter::all(&whole)),
                "{count} rows"
            );
            one_by_one.add(&rows[count]);
        }
        assert!(one_by_one.rows.rows.len() <= 1 + SOURCES.len());
    }

    #[test]
    fn what_no_row_informs_of_keeps_its_prior() {
        let estimate = Estimate {
            rows: vec![
                row(0.33, 0.15, 0.0, [0.0; 2], true),
                row(0.4, 0.1, 0.0, [0.0; 2], true),
            ],
            ..Estimate::default()
        };
        for parameter in LearnedParameter::all(&estimate) {
            assert_eq!((parameter.mean, parameter.std), (0.33, 0.15));
            assert!(!parameter.observed && parameter.informed.is_none());
        }
    }

    #[test]
    fn methods_without_friction_have_no_parameters() {
        let estimate = Estimate {
            rows: vec![EstimateRow::default()],
            ..Estimate::default()
        };
        assert!(LearnedParameter::all(&estimate).is_empty());
    }
}
