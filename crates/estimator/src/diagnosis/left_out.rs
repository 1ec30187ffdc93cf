//! Poses of the pusher that a run leaves out, since the pusher cannot have come there.

use super::evidence::Evidence;
use super::finding::{Finding, Subject};
use crate::pusher::jumps::believed;

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let log = evidence.log;
    let believed = believed(log, evidence.setup.camera.as_ref());
    let is_left_out = |row: &usize| log.pusher[*row].is_some() && believed[*row].is_none();
    let left_out: Vec<usize> = (0..log.len()).filter(is_left_out).collect();
    let Some(first) = left_out.first() else {
        return Vec::new();
    };
    let found = match left_out.len() {
        1 => format!(
            "the pusher cannot have come to its pose in row {first}: that pose counts as missing"
        ),
        count => format!(
            "the pusher cannot have come to {count} of its poses, the first in row {first}: these count as missing"
        ),
    };
    let advice = "see why they are wrong (a tag misread, a clock that jumps): where the pusher is seldom seen, what it did meanwhile is a guess";
    vec![Finding::warning(Subject::PusherPoses, found, advice)]
}
