//! Final friction estimates as programs show them: [`Parameter`].

use serde::Serialize;
use stickslip::Estimate;
use stickslip::dynamics::Friction;

/// One friction parameter at the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Its name, as in files.
    #[serde(skip)]
    pub name: &'static str,
    /// Posterior mean.
    pub mean: f64,
    /// Posterior standard deviation.
    pub std: f64,
}

impl Parameter {
    /// The parameters in the last row that has them; none for methods that do not estimate them.
    pub fn at_end(estimate: &Estimate) -> Vec<Self> {
        let last = estimate
            .rows
            .iter()
            .rev()
            .find_map(|row| Some((row.friction?, row.spread?.friction?)));
        let Some((mean, std)) = last else {
            return Vec::new();
        };
        let parameters = values(&mean)
            .into_iter()
            .zip(values(&std))
            .map(|((name, mean), (_, std))| Self { name, mean, std });
        parameters
            .filter(|parameter| parameter.name != "d_tri" || estimate.has_tripod)
            .collect()
    }

    /// "0.283 ± 0.021"; lengths in mm.
    pub fn shown(&self) -> String {
        match self.name {
            "d_tri" => format!("{:.1} ± {:.1} mm", 1e3 * self.mean, 1e3 * self.std),
            _ => format!("{:.3} ± {:.3}", self.mean, self.std),
        }
    }

    /// A value of this parameter as `shown` has it, without a spread; a dash where there is none.
    pub fn shown_value(&self, value: Option<f64>) -> String {
        match (value, self.name) {
            (None, _) => "-".to_owned(),
            (Some(value), "d_tri") => format!("{:.1} mm", 1e3 * value),
            (Some(value), _) => format!("{value:.3}"),
        }
    }

    /// Its nominal value.
    pub fn nominal(&self, friction: &Friction) -> Option<f64> {
        values(friction)
            .into_iter()
            .find(|(name, _)| *name == self.name)
            .map(|(_, value)| value)
    }
}

fn values(friction: &Friction) -> [(&'static str, f64); 4] {
    [
        ("mu_s", friction.mu_s),
        ("mu_p", friction.mu_p),
        ("mu_f", friction.mu_f),
        ("d_tri", friction.d_tri),
    ]
}
