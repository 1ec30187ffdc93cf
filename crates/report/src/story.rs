//! An experiment in a few plain sentences, made from numbers: [`Story`].

/// Weighted RMSE up to which a method kept track of an object (mm): twice the resolution of the
/// paper's camera.
pub const KEPT_MM: f64 = 2.0;

/// Weighted RMSE from which it lost the object (mm).
pub const LOST_MM: f64 = 10.0;

/// What happened in an experiment, and how its methods fared.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Story {
    /// What moves, as "a bar pushes a square until it jams at a fixel"; empty where nobody knows.
    pub what: String,
    /// Length of the recording (s).
    pub duration: f64,
    /// When the camera was dark: from, to (s), with poses that it had lost just before and after.
    pub dark: Option<[f64; 2]>,
    /// Rows outside that time in which the camera lost the object.
    pub lost: usize,
    /// All rows.
    pub rows: usize,
    /// By how much the camera lags (s), where errors are told against its poses; else 0.
    pub lag: f64,
    /// When the object first touched a fixel (s).
    pub first_fixel: Option<f64>,
    /// The methods.
    pub outcomes: Vec<Outcome>,
    /// What the filter that learns says of itself, of friction and of contact, in sentences.
    pub learnt: Vec<String>,
}

/// How one method fared.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Name.
    pub name: String,
    /// Whether its camera stayed on.
    pub camera_on: bool,
    /// Weighted RMSE while the camera was dark, over all rows where it never was (mm).
    pub wmse_mm: Option<f64>,
}

/// Whether a method still knew where the object was.
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
            "Kept track: WMSE of at most {KEPT_MM:.0} mm; lost it: more than {LOST_MM:.0} mm; drifted: between."
        )
    }
}

impl Story {
    /// What happened, and which methods kept track, drifted or lost the object.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        let what = (!self.what.is_empty()).then(|| format!("{}.", self.title()));
        let fates = self
            .fates()
            .into_iter()
            .map(|(fate, names)| format!("{}: {names}.", fate.name()));
        what.into_iter()
            .chain([self.darkness()])
            .chain(fates)
            .chain(self.seen())
            .chain(self.learnt.iter().cloned())
            .collect()
    }

    /// What moves, with a capital; empty where nobody knows.
    #[must_use]
    pub fn title(&self) -> String {
        capital(&self.what)
    }

    /// When the camera was dark.
    #[must_use]
    pub fn darkness(&self) -> String {
        let lost = match (self.lost, self.dark) {
            (0, _) => String::new(),
            (lost, None) => format!(" The camera gives no pose in {lost} of {} rows.", self.rows),
            (lost, Some(_)) => format!(
                " Besides, it gives no pose in {lost} of {} rows.",
                self.rows
            ),
        };
        let late = match self.lag > 0.0 {
            true => format!(
                " The camera lags by {:.2} s: its poses, and errors against them, stand at the times that they show, darkness where no pose comes.",
                self.lag
            ),
            false => String::new(),
        };
        let Some([from, to]) = self.dark else {
            return match self.lost {
                0 => format!("The camera sees the object all the time.{late}"),
                _ => format!("Nothing is hidden from the methods.{lost}{late}"),
            };
        };
        let contact = match self.first_fixel.map(|contact| contact - from) {
            Some(ahead) if ahead >= 0.0 => {
                format!(", {ahead:.1} s before the object first touches a fixel,")
            }
            Some(after) => format!(", {:.1} s after the object first touched a fixel,", -after),
            None => String::new(),
        };
        let end = if to >= self.duration - 0.1 {
            "stays dark to the end".to_owned()
        } else {
            format!("is back at {to:.1} s")
        };
        format!("At {from:.1} s{contact} the camera goes dark; it {end}.{lost}{late}")
    }

    /// The methods by their fates, those whose camera stayed on left out: "particle filter (0.12
    /// mm), nominal simulation (0.30 mm)".
    #[must_use]
    pub fn fates(&self) -> Vec<(Fate, String)> {
        let mut dark: Vec<&Outcome> = self
            .outcomes
            .iter()
            .filter(|outcome| !outcome.camera_on)
            .collect();
        dark.sort_by(|a, b| {
            a.wmse_mm
                .unwrap_or(f64::INFINITY)
                .total_cmp(&b.wmse_mm.unwrap_or(f64::INFINITY))
        });
        let listed = |fate: Fate| {
            let named = dark
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

    /// How well the object could be known: of several methods whose camera stayed on, each by its
    /// name.
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
        Some(format!("With the camera always on: {said}."))
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
            dark: Some([5.1, 20.0]),
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
                "At 5.1 s, 0.2 s before the object first touches a fixel, the camera goes dark; it stays dark to the end.",
                "Kept track: particle (0.12 mm).",
                "Drifted: nominal (4.00 mm).",
                "Lost it: kalman (143 mm).",
                "With the camera always on: 0.07 mm."
            ]
        );
    }

    #[test]
    fn sentences_know_logs_without_darkness_and_without_survivors() {
        let story = Story {
            outcomes: vec![outcome("kalman", false, 12.0)],
            ..Story::default()
        };
        assert_eq!(
            story.sentences(),
            [
                "The camera sees the object all the time.",
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
                "Nothing is hidden from the methods. The camera gives no pose in 3 of 40 rows. \
                 The camera lags by 0.16 s: its poses, and errors against them, stand at the times that they show, darkness where no pose comes.",
                "Not scored: kalman.",
                "mu_s 0.3."
            ]
        );
    }
}
