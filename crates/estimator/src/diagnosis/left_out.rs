//! Poses of the pusher that a run leaves out, since the pusher cannot have come there.

use super::evidence::Evidence;
use super::finding::{Finding, Subject};
use crate::counted::counted;
use crate::pusher::jumps::accepted;

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let log = evidence.log;
    let accepted = accepted(&log.time, &log.pusher, evidence.setup.camera.as_ref());
    let is_left_out = |row: &usize| log.pusher[*row].is_some() && accepted[*row].is_none();
    let left_out: Vec<usize> = (0..log.len()).filter(is_left_out).collect();
    let first = left_out.first();
    let place = first.map_or(String::new(), |row| format!(", first in row {row}"));
    left_out_poses(left_out.len(), &place).into_iter().collect()
}

/// Finds that so many poses of the pusher were left out, with the place of the first one in words.
pub(crate) fn left_out_poses(count: usize, place: &str) -> Option<Finding> {
    let found = format!(
        "{} that the pusher cannot have reached{place}: counted as missing",
        counted(count as u64, "pusher pose")
    );
    let advice = "find the cause (a tag misread, a clock that jumps); the pusher's motion between rare poses is a guess";
    (count > 0).then(|| Finding::warning(Subject::PusherPoses, found, advice))
}
