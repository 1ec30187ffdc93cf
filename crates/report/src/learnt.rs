//! Expected error, friction and contact according to the particle filter, in sentences:
//! [`ReportedExperiment::learnt`].

use stickslip_evaluation::LearnedParameter;

use crate::reported_experiment::ReportedExperiment;
use crate::reported_run::ReportedRun;
use crate::touch::TouchRule;

impl ReportedExperiment<'_> {
    /// Expected error, friction and first touch according to the learner.
    pub(crate) fn learnt(&self) -> Vec<String> {
        let Some(run) = self.learner() else {
            return Vec::new();
        };
        let expected = run.scored.scores.spread_occluded_mm.map(|expected| {
            let found = run.wmse_mm().map(|error| match &*self.reference_name {
                "truth" => format!("; the true one is {error:.2} mm"),
                reference => format!("; the one against the {reference} is {error:.2} mm"),
            });
            format!(
                "The filter expects an error of {expected:.2} mm{}.",
                found.unwrap_or_default()
            )
        });
        expected
            .into_iter()
            .chain(self.friction_sentence(run))
            .chain(self.contact_sentence(run))
            .collect()
    }

    /// "Friction: mu_p 0.31 ± 0.02 (truth 0.30). Not identifiable from this push: mu_s."
    fn friction_sentence(&self, run: &ReportedRun) -> Option<String> {
        let parameters = LearnedParameter::all(&run.scored.estimate);
        let unknown: Vec<&str> = parameters
            .iter()
            .filter(|parameter| !parameter.observed)
            .map(|parameter| parameter.name)
            .collect();
        let known = parameters.iter().zip(self.friction);
        let known: Vec<String> = known
            .filter(|(parameter, _)| parameter.observed)
            .map(|(parameter, truth)| {
                let truth =
                    truth.map(|truth| format!(" (truth {})", parameter.shown_value(Some(truth))));
                let value = parameter.shown();
                format!("{} {value}{}", parameter.name, truth.unwrap_or_default())
            })
            .collect();
        match (known.is_empty(), unknown.is_empty()) {
            (true, true) => None,
            (true, false) => Some(
                "Friction: not identifiable from this push; the scene's values were used."
                    .to_owned(),
            ),
            (false, true) => Some(format!("Friction: {}.", known.join(", "))),
            (false, false) => Some(format!(
                "Friction: {}. Not identifiable from this push: {}.",
                known.join(", "),
                unknown.join(", ")
            )),
        }
    }

    /// First touch of a fixel, estimated and true.
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
                Some(truly) => format!(" (true: {truly:.2} s)"),
                None => " (true: never)".to_owned(),
            },
        };
        Some(format!(
            "The object first touches fixel {body} at an estimated {at:.2} s{truly}."
        ))
    }

    /// Probabilities of contact with the pusher, then with each fixel, row by row; `None` in rows
    /// without.
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
