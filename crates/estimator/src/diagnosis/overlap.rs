//! Overlap at the start: the first object pose against pusher and fixels.

use stickslip_dynamics::Pose;

use super::evidence::{Evidence, mm};
use super::finding::{Finding, Subject};
use crate::tuning::LONGEST_BRIDGE;

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let Some(row) = evidence.log.object.iter().position(Option::is_some) else {
        return Vec::new();
    };
    let Some(object) = evidence.log.object[row] else {
        return Vec::new();
    };
    let scene = &evidence.setup.scene;
    // the pusher may be measured at other times than the object
    let until = evidence.log.time[row] + LONGEST_BRIDGE;
    let first = evidence
        .seen
        .iter()
        .take_while(|row| evidence.log.time[**row] <= until);
    let pusher = first
        .into_iter()
        .find_map(|row| evidence.pusher_gap(*row, 0.0));
    let fixels = scene
        .fixels
        .iter()
        .map(|fixel| evidence.gap_to(object, &fixel.shape, fixel.pose));
    let gaps: Vec<(String, f64)> = [("the pusher".to_owned(), pusher)]
        .into_iter()
        .chain(
            fixels
                .enumerate()
                .map(|(k, gap)| (format!("fixel {}", k + 1), gap)),
        )
        .filter_map(|(name, gap)| Some((name, gap?)))
        .collect();
    let Some(nearest) = gaps.iter().min_by(|a, b| a.1.total_cmp(&b.1)) else {
        return vec![Finding::ok(Subject::Overlap, "no other body at the start")];
    };
    vec![judge(evidence, object, row, nearest)]
}

fn judge(
    evidence: &Evidence<'_>,
    object: Pose,
    row: usize,
    (name, gap): &(String, f64),
) -> Finding {
    let found = || {
        format!(
            "at row {row} the object at ({}, {}) overlaps {name} by {}",
            mm(object.x),
            mm(object.y),
            mm(-gap)
        )
    };
    let advice =
        "correct the outlines, the frames or the start; the first step would push the object out";
    match gap {
        gap if *gap < -3.0 * evidence.tolerance() => {
            Finding::problem(Subject::Overlap, found(), advice)
        }
        gap if *gap < -evidence.tolerance() => Finding::warning(Subject::Overlap, found(), advice),
        _ => Finding::ok(
            Subject::Overlap,
            format!("nearest body at the start: {name}, {} away", mm(*gap)),
        ),
    }
}
