//! Nominal friction within the filter's limits: a parameter outside them is moved to the limit as
//! soon as it takes part in a step with the camera on.

use stickslip_dynamics::Feet;

use super::evidence::Evidence;
use super::finding::{Finding, Subject};
use crate::setup::Limits;

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let (nominal, filter) = (&evidence.setup.scene.nominal, &evidence.setup.filter);
    let tripod = matches!(evidence.setup.scene.feet, Feet::Tripod { .. });
    let parameters = [
        ("mu_s", nominal.mu_s, filter.limits.mu_s, true),
        ("mu_p", nominal.mu_p, filter.limits.mu_p, true),
        (
            "mu_f",
            nominal.mu_f,
            filter.limits.mu_f,
            !evidence.setup.scene.fixels.is_empty(),
        ),
        ("d_tri", nominal.d_tri, filter.limits.d_tri, tripod),
    ];
    let used = parameters.iter().filter(|(_, _, _, used)| *used);
    let mut found: Vec<Finding> = used
        .filter_map(|(name, value, limits, _)| outside(name, *value, limits))
        .collect();
    if found.is_empty() {
        found.push(Finding::ok(
            Subject::Limits,
            "nominal friction is within the filter's limits",
        ));
    }
    found
}

fn outside(name: &str, value: f64, limits: &Limits) -> Option<Finding> {
    let Limits { min, max } = limits;
    let found = || {
        format!(
            "nominal {name} {value}, limits of the filter [{min}, {max}]: particles are clamped to the limits"
        )
    };
    let advice = || format!("widen `{name}` under [filter] in the scene");
    (!(*min..=*max).contains(&value)).then(|| Finding::warning(Subject::Limits, found(), advice()))
}
