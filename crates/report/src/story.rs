//! An experiment in a few plain sentences, made from numbers: [`Story`].

/// Weighted RMSE up to which a method kept track of an object (mm): twice the resolution of the
/// paper's camera.
pub const KEPT_MM: f64 = 2.0;

/// Weighted RMSE from which it lost the object (mm).
pub const LOST_MM: f64 = 10.0;

/// Course of an experiment, and the errors of its methods.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Story {
    /// Motion, as "a bar pushes a square until it jams at a fixel"; empty if unknown.
    pub what: String,
    /// Length of the recording (s).
    pub duration: f64,
    /// Time without a camera: from, to (s), with poses lost just before and after.
    pub off: Option<[f64; 2]>,
    /// Rows outside that time in which the camera lost the object.
    pub lost: usize,
    /// All rows.
    pub rows: usize,
    /// Latency of the camera (s) if its poses are the reference; else 0.
    pub lag: f64,
    /// When the object first touched a fixel (s).
    pub first_fixel: Option<f64>,
    /// The methods.
    pub outcomes: Vec<Outcome>,
    /// Expected error, friction and contact according to the particle filter, in sentences.
    pub learnt: Vec<String>,
}

/// Error of one method.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Name.
    pub name: String,
    /// True if its camera stayed on.
    pub camera_on: bool,
    /// Pose RMSE on occluded rows, over all rows if none is occluded (mm).
    pub wmse_mm: Option<f64>,
}

/// Verdict on the error of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// Weighted RMSE up to [`KEPT_MM`].
    Kept,
    /// Between the two.
    Drifted,
    /// Weighted RMSE above [`LOST_MM`].
    Lost,
    /// Nothing to score it against.
    Unknown,
}

impl Fate {
    /// Of a weighted RMSE (mm).
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

impl Story {
    /// Course of the experiment, and the methods that kept track, drifted or lost the object.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        let what = (!self.what.is_empty()).then(|| format!("{}.", self.title()));
        let fates = self
            .fates()
            .into_iter()
            .map(|(fate, names)| format!("{}: {names}.", fate.name()));
        what.into_iter()
            .chain([self.occlusion()])
            .chain(fates)
            .chain(self.seen())
            .chain(self.learnt.iter().cloned())
            .collect()
    }

    /// Motion with a capital letter; empty if unknown.
    #[must_use]
    pub fn title(&self) -> String {
        capital(&self.what)
    }

    /// Time without a camera, lost poses and latency.
    #[must_use]
    pub fn occlusion(&self) -> String {
        let lost = match (self.lost, self.off) {
            (0, _) => String::new(),
            (lost, None) => format!(" The camera gives no pose in {lost} of {} rows.", self.rows),
            (lost, Some(_)) => format!(
                " It also gives no pose in {lost} of {} other rows.",
                self.rows
            ),
        };
        let late = match self.lag > 0.0 {
            true => format!(
                " The camera lags by {:.2} s: its poses and errors are drawn at the times of exposure.",
                self.lag
            ),
            false => String::new(),
        };
        let Some([from, to]) = self.off else {
            return match self.lost {
                0 => format!("The camera is on all the time.{late}"),
                _ => format!("No row is occluded on purpose.{lost}{late}"),
            };
        };
        let contact = match self.first_fixel.map(|contact| contact - from) {
            Some(ahead) if ahead >= 0.0 => {
                format!(", {ahead:.1} s before the object touches a fixel,")
            }
            Some(after) => format!(", {:.1} s after the object touched a fixel,", -after),
            None => String::new(),
        };
        let end = if to >= self.duration - 0.1 {
            "stays off".to_owned()
        } else {
            format!("is on again at {to:.1} s")
        };
        format!("The camera turns off at {from:.1} s{contact} and {end}.{lost}{late}")
    }

    /// Methods without a camera by their verdicts: "particle filter (0.12 mm), nominal simulation
    /// (0.30 mm)".
    #[must_use]
    pub fn fates(&self) -> Vec<(Fate, String)> {
        let mut occluded: Vec<&Outcome> = self
            .outcomes
            .iter()
            .filter(|outcome| !outcome.camera_on)
            .collect();
        occluded.sort_by(|a, b| {
            a.wmse_mm
                .unwrap_or(f64::INFINITY)
                .total_cmp(&b.wmse_mm.unwrap_or(f64::INFINITY))
        });
        let listed = |fate: Fate| {
            let named = occluded
                .iter()
                .filter(|outcome| Fate::of(outcome.wmse_mm) == fate)
                .map(|outcome| outcome.named());
            (fate, named.collect::<Vec<_>>().join(", "))
        };
        [Fate::Kept, Fate::Drifted, Fate::Lost, Fate::Unknown]
            .map(listed)
            .into_iter()
            .filter(|(_, names)| !names.is_empty())
            .collect()
    }

    /// Errors of the methods whose camera stayed on, by name if there are several.
    #[must_use]
    pub fn seen(&self) -> Option<String> {
        let mut scored: Vec<(&str, f64)> = self
            .outcomes
            .iter()
            .filter(|outcome| outcome.camera_on)
            .filter_map(|outcome| Some((outcome.name.as_str(), outcome.wmse_mm?)))
            .collect();
        scored.sort_by(|a, b| a.1.total_cmp(&b.1));
        let said = match scored[..] {
            [] => return None,
            [(_, wmse)] => millimetres(wmse),
            _ => {
                let named = scored.iter().map(|(name, wmse)| {
                    let name = name.strip_suffix(", camera on").unwrap_or(name);
                    format!("{name} ({})", millimetres(*wmse))
                });
                named.collect::<Vec<_>>().join(", ")
            }
        };
        Some(format!("Camera always on: {said}."))
    }
}

impl Outcome {
    /// "particle filter (0.12 mm)".
    fn named(&self) -> String {
        self.wmse_mm.map_or_else(
            || self.name.clone(),
            |wmse| format!("{} ({})", self.name, millimetres(wmse)),
        )
    }
}

/// "0.12 mm", "143 mm".
fn millimetres(value: f64) -> String {
    let decimals = [(100.0, 0), (10.0, 1)]
        .into_iter()
        .find(|(from, _)| value >= *from)
        .map_or(2, |(_, decimals)| decimals);
    format!("{value:.decimals$} mm")
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(name: &str, camera_on: bool, wmse: f64) -> Outcome {
        Outcome {
            name: name.to_owned(),
            camera_on,
            wmse_mm: Some(wmse),
        }
    }

    #[test]
    fn sentences_say_what_the_numbers_say() {
        let story = Story {
            what: "a bar pushes a square".to_owned(),
            duration: 20.0,
            off: Some([5.1, 20.0]),
            first_fixel: Some(5.27),
            outcomes: vec![
                outcome("nominal", false, 4.0),
                outcome("kalman", false, 143.4),
                outcome("particle", false, 0.123),
                outcome("always on", true, 0.07),
            ],
            ..Story::default()
        };
        assert_eq!(
            story.sentences(),
            [
                "A bar pushes a square.",
                "The camera turns off at 5.1 s, 0.2 s before the object touches a fixel, and stays off.",
                "Kept track: particle (0.12 mm).",
                "Drifted: nominal (4.00 mm).",
                "Lost it: kalman (143 mm).",
                "Camera always on: 0.07 mm."
            ]
        );
    }

    #[test]
    fn sentences_know_logs_without_occlusion_and_without_survivors() {
        let story = Story {
            outcomes: vec![outcome("kalman", false, 12.0)],
            ..Story::default()
        };
        assert_eq!(
            story.sentences(),
            [
                "The camera is on all the time.",
                "Lost it: kalman (12.0 mm)."
            ]
        );
        let unscored = Story {
            lost: 3,
            rows: 40,
            lag: 0.16,
            outcomes: vec![Outcome {
                wmse_mm: None,
                ..outcome("kalman", false, 0.0)
            }],
            learnt: vec!["mu_s 0.3.".to_owned()],
            ..Story::default()
        };
        assert_eq!(
            unscored.sentences(),
            [
                "No row is occluded on purpose. The camera gives no pose in 3 of 40 rows. \
                 The camera lags by 0.16 s: its poses and errors are drawn at the times of exposure.",
                "Not scored: kalman.",
                "mu_s 0.3."
            ]
        );
    }
}
