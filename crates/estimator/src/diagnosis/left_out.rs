//! Poses of the pusher that a run leaves out, since the pusher cannot have come there.

use super::evidence::Evidence;
use super::finding::{Finding, Subject};
use crate::counted::counted;
use crate::pusher::jumps::believed;

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let log = evidence.log;
    let believed = believed(log, evidence.setup.camera.as_ref());
    let is_left_out = |row: &usize| log.pusher[*row].is_some() && believed[*row].is_none();
    let left_out: Vec<usize> = (0..log.len()).filter(is_left_out).collect();
    let Some(first) = left_out.first() else {
        return Vec::new();
    };
    let found = format!(
        "{} that the pusher cannot have reached, first in row {first}: counted as missing",
        counted(left_out.len() as u64, "pusher pose")
    );
    let advice = "find the cause (a tag misread, a clock that jumps); the pusher's motion between rare poses is a guess";
    vec![Finding::warning(Subject::PusherPoses, found, advice)]
}
