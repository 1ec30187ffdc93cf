//! An experiment in plain sentences, made from numbers: [`Sentence`].

use std::fmt;

use stickslip_evaluation::LearnedParameter;

use crate::intervals::times;
use crate::reported_experiment::ReportedExperiment;
use crate::reported_run::ReportedRun;

/// Pose RMSE up to which a method kept track of an object (mm): twice the resolution of the paper's
/// camera.
const KEPT_MM: f64 = 2.0;

/// Pose RMSE above which it lost the object (mm).
const LOST_MM: f64 = 10.0;

/// Verdict on the error of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// Pose RMSE up to 2 mm.
    Kept,
    /// Between the two.
    Drifted,
    /// Pose RMSE above 10 mm.
    Lost,
    /// Nothing to score it against.
    Unknown,
}

/// A sentence, with its verdict on the methods that it names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sentence {
    /// The verdict, if it gives one.
    pub fate: Option<Fate>,
    /// Text after the verdict.
    pub text: String,
}

/// Error of one method.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Name.
    pub name: String,
    /// True if its camera stayed on.
    pub camera_on: bool,
    /// Pose RMSE on occluded rows, over all rows if none is occluded (mm).
    pub wmse_mm: Option<f64>,
}

impl Fate {
    /// Of a pose RMSE (mm).
    #[must_use]
    pub fn of(wmse_mm: Option<f64>) -> Self {
        match wmse_mm {
            Some(wmse) if wmse <= KEPT_MM => Self::Kept,
            Some(wmse) if wmse <= LOST_MM => Self::Drifted,
            Some(_) => Self::Lost,
            None => Self::Unknown,
        }
    }

    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Kept => "Kept track",
            Self::Drifted => "Drifted",
            Self::Lost => "Lost it",
            Self::Unknown => "Not scored",
        }
    }

    /// The rule behind the words.
    #[must_use]
    pub fn rule() -> String {
        format!(
            "Kept track: a pose RMSE of at most {KEPT_MM:.0} mm. Lost it: more than {LOST_MM:.0} mm. Drifted: between."
        )
    }
}

impl From<String> for Sentence {
    fn from(text: String) -> Self {
        Self { fate: None, text }
    }
}

impl fmt::Display for Sentence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.fate {
            Some(fate) => write!(f, "{}: {}", fate.name(), self.text),
            None => f.write_str(&self.text),
        }
    }
}

/// The methods by their verdicts, then those whose camera stayed on; the smallest errors first.
#[must_use]
pub fn verdicts(outcomes: &[Outcome]) -> Vec<Sentence> {
    let mut sorted: Vec<&Outcome> = outcomes.iter().collect();
    let error = |of: &Outcome| of.wmse_mm.unwrap_or(f64::INFINITY);
    sorted.sort_by(|a, b| error(a).total_cmp(&error(b)));
    let (seen, occluded): (Vec<_>, Vec<_>) = sorted.iter().partition(|of| of.camera_on);
    let list = |all: &[&Outcome]| {
        all.iter()
            .map(|of| of.shown())
            .collect::<Vec<_>>()
            .join(", ")
    };
    let mut said = Vec::new();
    for fate in [Fate::Kept, Fate::Drifted, Fate::Lost, Fate::Unknown] {
        let same = |of: &&Outcome| Fate::of(of.wmse_mm) == fate;
        let of_fate: Vec<&Outcome> = occluded.iter().copied().filter(same).collect();
        if !of_fate.is_empty() {
            let text = format!("{}.", list(&of_fate));
            said.push(Sentence {
                fate: Some(fate),
                text,
            });
        }
    }
    let scored: Vec<&Outcome> = seen.into_iter().filter(|of| of.wmse_mm.is_some()).collect();
    let seen = match scored[..] {
        [] => None,
        [only] => only.wmse_mm.map(millimetres),
        _ => Some(list(&scored)),
    };
    said.extend(seen.map(|seen| format!("Camera always on: {seen}.").into()));
    said
}

impl Outcome {
    /// "particle filter (0.12 mm)".
    fn shown(&self) -> String {
        let name = self.name.strip_suffix(", camera on");
        let name = name.unwrap_or(&self.name).to_owned();
        self.wmse_mm.map_or(name.clone(), |wmse| {
            format!("{name} ({})", millimetres(wmse))
        })
    }
}

/// "0.12 mm", "143 mm".
fn millimetres(value: f64) -> String {
    let decimals = usize::from(value < 100.0) + usize::from(value < 10.0);
    format!("{value:.decimals$} mm")
}

impl ReportedExperiment<'_> {
    /// Course of the experiment, verdicts on the methods, and findings of the particle filter.
    #[must_use]
    pub fn sentences(&self) -> Vec<Sentence> {
        let motion = (!self.what.is_empty()).then(|| format!("{}.", self.title()));
        let course = motion.into_iter().chain([self.occlusion()]);
        course.map(Sentence::from).chain(self.results()).collect()
    }

    /// Motion with a capital letter; empty if unknown.
    pub(crate) fn title(&self) -> String {
        let mut letters = self.what.chars();
        let first = letters.next().into_iter().flat_map(char::to_uppercase);
        first.chain(letters).collect()
    }

    /// Time without a camera, lost poses and latency.
    pub(crate) fn occlusion(&self) -> String {
        let (off, rows) = (self.occluded(), self.log.len());
        let [from, to] = off.unwrap_or_default();
        let unseen = self.log.object_out_of_sight();
        let lost = (0..rows).filter(|row| unseen[*row] && !(from..to).contains(row));
        let (lost, others) = (lost.count(), rows - (to - from));
        let mut said = match (off, lost) {
            (Some(off), _) => self.turned_off(times(&self.log.time, off)),
            (None, 0) => "The camera is on all the time.".to_owned(),
            (None, _) => format!(
                "No row is occluded on purpose. The camera gives no pose in {lost} of {rows} rows."
            ),
        };
        if off.is_some() && lost > 0 {
            said += &format!(" It also gives no pose in {lost} of the {others} other rows.");
        }
        if self.reference.latency > 0.0 {
            said += &format!(
                " The camera lags by {:.2} s: its poses and errors are drawn at the times of exposure.",
                self.reference.latency
            );
        }
        said
    }

    fn turned_off(&self, [from, to]: [f64; 2]) -> String {
        let touch = match self.first_fixel.map(|touch| touch - from) {
            Some(ahead) if ahead >= 0.0 => {
                format!(", {ahead:.1} s before the object touches a fixel,")
            }
            Some(after) => format!(", {:.1} s after the object touched a fixel,", -after),
            None => String::new(),
        };
        let end = match to >= self.log.duration() - 0.1 {
            true => "stays off".to_owned(),
            false => format!("is on again at {to:.1} s"),
        };
        format!("The camera turns off at {from:.1} s{touch} and {end}.")
    }

    /// Verdicts on the methods, then expected error, friction and first touch according to the
    /// particle filter.
    pub(crate) fn results(&self) -> Vec<Sentence> {
        let outcome = |run: &ReportedRun| Outcome {
            name: run.title().to_owned(),
            camera_on: run.camera_on(),
            wmse_mm: run.wmse_mm(),
        };
        let outcomes: Vec<Outcome> = self.runs.iter().map(outcome).collect();
        let learnt = self.learner().map(|run| {
            let all = [
                self.expected_error(run),
                self.friction(run),
                self.first_touch(run),
            ];
            all.into_iter().flatten().map(Sentence::from)
        });
        let verdicts = verdicts(&outcomes).into_iter();
        verdicts.chain(learnt.into_iter().flatten()).collect()
    }

    fn expected_error(&self, run: &ReportedRun) -> Option<String> {
        let expected = run.scored.scores.spread_occluded_mm?;
        let found = run.wmse_mm().map(|error| match &*self.reference_name {
            "truth" => format!("; the true one is {error:.2} mm"),
            reference => format!("; the one against the {reference} is {error:.2} mm"),
        });
        let found = found.unwrap_or_default();
        Some(format!(
            "The filter expects an error of {expected:.2} mm{found}."
        ))
    }

    /// "Friction: mu_p 0.31 ± 0.02 (truth 0.30). Not identifiable from this push: mu_s."
    fn friction(&self, run: &ReportedRun) -> Option<String> {
        let (mut known, mut unknown) = (Vec::new(), Vec::new());
        for (of, truth) in LearnedParameter::all(&run.scored.estimate)
            .iter()
            .zip(self.friction)
        {
            let truth = truth.map(|truth| format!(" (truth {})", of.shown_value(Some(truth))));
            match of.observed {
                true => known.push(format!(
                    "{} {}{}",
                    of.name,
                    of.shown(),
                    truth.unwrap_or_default()
                )),
                false => unknown.push(of.name),
            }
        }
        match (&known[..], &unknown[..]) {
            ([], []) => None,
            ([], _) => Some(
                "Friction: not identifiable from this push; the scene's values were used."
                    .to_owned(),
            ),
            (_, []) => Some(format!("Friction: {}.", known.join(", "))),
            _ => Some(format!(
                "Friction: {}. Not identifiable from this push: {}.",
                known.join(", "),
                unknown.join(", ")
            )),
        }
    }

    /// First touch of a fixel, estimated and true.
    fn first_touch(&self, run: &ReportedRun) -> Option<String> {
        let probabilities = self.touch_probabilities(run);
        let time = |row: usize| self.log.time.get(row).copied();
        let likely = |row: &Option<Vec<f64>>, body: usize| {
            row.as_ref()
                .is_some_and(|all| all.get(body).is_some_and(|p| *p > 0.5))
        };
        let first_of = |body: usize| {
            let row = probabilities.iter().position(|row| likely(row, body))?;
            Some((body, time(row)?))
        };
        let found = (1..=self.setup.scene.fixels.len()).filter_map(first_of);
        let (body, at) = found.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let touches = self.touches.get(body)?.as_ref();
        let truly = touches.map(|touches| {
            let first = touches.iter().position(|touch| *touch).and_then(time);
            first.map_or(" (true: never)".to_owned(), |first| {
                format!(" (true: {first:.2} s)")
            })
        });
        let truly = truly.unwrap_or_default();
        Some(format!(
            "The object first touches fixel {body} at an estimated {at:.2} s{truly}."
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(outcomes: [(&str, Option<f64>); 5]) -> Vec<String> {
        let outcomes = outcomes.map(|(name, wmse_mm)| Outcome {
            name: name.to_owned(),
            camera_on: name.ends_with("camera on"),
            wmse_mm,
        });
        let sentences = verdicts(&outcomes).into_iter();
        sentences.map(|sentence| sentence.to_string()).collect()
    }

    #[test]
    fn methods_are_named_by_their_verdicts() {
        let methods = [
            ("nominal", Some(4.0)),
            ("kalman", Some(143.4)),
            ("unscored", None),
            ("particle", Some(0.123)),
            ("particle, camera on", Some(0.07)),
        ];
        assert_eq!(
            said(methods),
            [
                "Kept track: particle (0.12 mm).",
                "Drifted: nominal (4.00 mm).",
                "Lost it: kalman (143 mm).",
                "Not scored: unscored.",
                "Camera always on: 0.07 mm."
            ]
        );
    }

    #[test]
    fn of_several_methods_with_the_camera_on_each_is_named() {
        let methods = [
            ("kalman", Some(12.04)),
            ("extended", Some(1.5)),
            ("unscored, camera on", None),
            ("kalman, camera on", Some(2.47)),
            ("particle, camera on", Some(0.12)),
        ];
        assert_eq!(
            said(methods),
            [
                "Kept track: extended (1.50 mm).",
                "Lost it: kalman (12.0 mm).",
                "Camera always on: particle (0.12 mm), kalman (2.47 mm)."
            ]
        );
    }
}
