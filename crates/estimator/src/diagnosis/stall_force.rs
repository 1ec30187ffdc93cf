//! The pusher's stall force, where the scene gives none: it decides how a jam goes on.

use super::evidence::Evidence;
use super::finding::{Finding, Subject};
use crate::setup::Setup;
use crate::tuning::ASSUMED_STALL;

/// Finds an assumed stall force of the pusher, with its value and what to write instead; `None` if
/// the scene gives one.
///
/// The finding is a warning if there are fixels. Without them nothing jams, and nothing is to be
/// done.
pub fn assumed_stall_force(setup: &Setup) -> Option<Finding> {
    let force = setup
        .scene
        .pusher
        .stall_force
        .filter(|_| setup.stall_force_assumed)?;
    let found = format!(
        "pusher.stall_force is missing; {} N is assumed, {ASSUMED_STALL} times the force that slides the object",
        three_digits(force)
    );
    Some(match setup.scene.fixels.is_empty() {
        true => Finding::ok(
            Subject::StallForce,
            format!("{found}; without fixels nothing jams"),
        ),
        false => Finding::warning(
            Subject::StallForce,
            found,
            "give the force in N at which the drive yields, or inf for a rigid drive",
        ),
    })
}

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    assumed_stall_force(evidence.setup).into_iter().collect()
}

/// A positive number with at least three significant digits and no exponent.
fn three_digits(value: f64) -> String {
    let decimals = (2.0 - libm::floor(libm::log10(value))).clamp(0.0, 12.0) as usize;
    format!("{value:.decimals$}")
}
