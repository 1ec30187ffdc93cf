//! What the filter that learns says of itself, of friction and of contact, in sentences:
//! [`ReportedExperiment::learnt`].

use stickslip_evaluation::LearnedParameter;

use crate::reported_experiment::ReportedExperiment;
use crate::reported_run::ReportedRun;
use crate::touch::TouchRule;

/// What each parameter is.
const MEANINGS: [(&str, &str); 4] = [
    ("mu_s", "is friction on the table"),
    ("mu_p", "at the pusher"),
    ("mu_f", "at the fixels"),
    (
        "d_tri",
        "how far the three feet that carry the object are from its centre of mass",
    ),
];

/// "mu_s is friction on the table, mu_p at the pusher".
fn meanings(parameters: &[LearnedParameter]) -> String {
    let shown = MEANINGS
        .iter()
        .filter(|(name, _)| parameters.iter().any(|parameter| parameter.name == *name));
    let words = shown.map(|(name, meaning)| format!("{name} {meaning}"));
    words.collect::<Vec<_>>().join(", ")
}

impl ReportedExperiment<'_> {
    /// What the learner says of itself, of friction and of contact.
    pub(crate) fn learnt(&self) -> Vec<String> {
        let Some(run) = self.learner() else {
            return Vec::new();
        };
        let spread = run.scored.scores.spread_occluded_mm.map(|spread| {
            format!(
                "By its own account, the {} is off by {spread:.2} mm in the dark.",
                run.title()
            )
        });
        let parameters = LearnedParameter::all(&run.scored.estimate);
        let values = parameters.iter().zip(self.friction);
        let values: Vec<String> = values
            .map(|(parameter, truth)| self.told(parameter, truth))
            .collect();
        let friction = (!values.is_empty()).then(|| {
            format!(
                "Friction according to the {}: {}. Here {}.",
                run.title(),
                values.join(", "),
                meanings(&parameters)
            )
        });
        spread
            .into_iter()
            .chain(friction)
            .chain(self.contact_sentence(run))
            .collect()
    }

    /// "mu_s 0.28 ± 0.02 (truth 0.27)", "mu_f not observed (told 0.25)".
    fn told(&self, parameter: &LearnedParameter, truth: Option<f64>) -> String {
        let nominal = parameter.among(&self.setup.scene.nominal);
        let beside = match (parameter.observed, truth) {
            (true, Some(_)) => format!(" (truth {})", parameter.shown_value(truth)),
            (true, None) => String::new(),
            (false, _) => format!(" (told {})", parameter.shown_value(nominal)),
        };
        format!("{} {}{beside}", parameter.name, parameter.shown())
    }

    /// When the first fixel is touched, according to the learner and in truth.
    fn contact_sentence(&self, run: &ReportedRun) -> Option<String> {
        let probabilities = self.touch_probabilities(run);
        let time = |row: usize| self.log.time.get(row).copied();
        let first_of = |body: usize| {
            let row = probabilities.iter().position(|row| {
                row.as_ref()
                    .is_some_and(|all| all.get(body).is_some_and(|p| *p > 0.5))
            });
            Some((body, time(row?)?))
        };
        let found = (1..=self.setup.scene.fixels.len()).filter_map(first_of);
        let (body, at) = found.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let truly = match self.touches.get(body)? {
            None => String::new(),
            Some(touches) => match touches.iter().position(|touch| *touch).and_then(time) {
                Some(truly) => format!(", and truly at {truly:.2} s"),
                None => ", and truly never".to_owned(),
            },
        };
        Some(format!(
            "According to the {}, fixel {body} is first touched at {at:.2} s{truly}.",
            run.title()
        ))
    }

    /// Probabilities of contact with the pusher, then with each fixel, row by row, as a run has
    /// them; `None` in rows without.
    pub(crate) fn touch_probabilities(&self, run: &ReportedRun) -> Vec<Option<Vec<f64>>> {
        let rule = TouchRule::measured(self.setup);
        let rows = run.scored.estimate.rows.iter().enumerate();
        rows.map(|(row, estimate)| {
            let particles = run.cloud.get(row).map_or(&[][..], Vec::as_slice);
            let pusher = self.log.pusher.get(row).copied().flatten();
            rule.probabilities(estimate, particles, pusher)
        })
        .collect()
    }
}
