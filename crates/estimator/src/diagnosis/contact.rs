//! Check that the pusher touches the object at all.

use super::evidence::{Evidence, mm};
use super::finding::{Finding, Subject};

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let touched = || Finding::ok(Subject::Contact, "the pusher reaches the object");
    vec![none(evidence).unwrap_or_else(touched)]
}

/// Finds a log in which the object rests and the pusher never reaches it. Such a log tells nothing
/// of contact or friction.
pub(super) fn none(evidence: &Evidence<'_>) -> Option<Finding> {
    if evidence.moving.contains(&true) {
        return None;
    }
    let gaps = evidence
        .seen
        .iter()
        .filter_map(|row| evidence.pusher_gap(*row, evidence.latency()));
    let nearest = gaps.reduce(f64::min)?;
    (nearest > 2.0 * evidence.tolerance()).then(|| {
        Finding::warning(
            Subject::Contact,
            format!(
                "nothing touches the object: it rests in all {} rows, and the pusher stays {} away",
                evidence.seen.len(),
                mm(nearest)
            ),
            "record a push; this log shows neither contact nor friction",
        )
    })
}
