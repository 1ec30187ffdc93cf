//! Jumps: poses that no body can have come to between two rows.

use stickslip_dynamics::Pose;

use super::evidence::{Evidence, mm, quantile};
use super::finding::{Finding, Subject};
use crate::log::Log;

/// A step from pose to pose that is longer than this share of the object's radius may be a jump.
const FAR: f64 = 0.3;

/// It is one where it is so many times longer than nine in ten others.
const RARE: f64 = 8.0;

/// Longest time between two poses of which a jump is told (s); over a longer one a body can go far.
const SOON: f64 = 0.15;

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let Log { object, pusher, .. } = evidence.log;
    let bodies = [
        (Subject::ObjectPoses, "object", object),
        (Subject::PusherPoses, "pusher", pusher),
    ];
    let found = bodies.into_iter();
    found
        .filter_map(|(subject, body, poses)| {
            let found = jumps(evidence, body, poses)?;
            let advice = "leave the cells of a lost pose empty; where the body was moved by hand, cut the log there";
            Some(Finding::problem(subject, found, advice))
        })
        .collect()
}

/// The first jump of a body, in words, and how many there are.
fn jumps(evidence: &Evidence<'_>, body: &str, poses: &[Option<Pose>]) -> Option<String> {
    let time = &evidence.log.time;
    let seen: Vec<(usize, Pose)> = (0..poses.len())
        .filter_map(|row| Some((row, poses[row]?)))
        .collect();
    let way = |[(_, a), (_, b)]: &[(usize, Pose); 2]| (b.x - a.x).hypot(b.y - a.y);
    let usual = quantile(seen.array_windows().map(way), 0.9);
    let limit = (FAR * evidence.size()).max(RARE * usual);
    let limit = limit.max(3.0 * evidence.tolerance());
    let far = |pair: &&[(usize, Pose); 2]| {
        let [(from, _), (to, _)] = pair;
        way(pair) > limit && time[*to] - time[*from] <= SOON
    };
    let jumps: Vec<&[(usize, Pose); 2]> = seen.array_windows().filter(far).collect();
    let first = *jumps.first()?;
    let [(before, a), (row, b)] = first;
    let is_origin = |pose: &Pose| [pose.x, pose.y, pose.theta] == [0.0; 3];
    let first_words = match (is_origin(a), is_origin(b)) {
        (true, false) => format!("the {body} is exactly at 0, 0, 0 in row {before}"),
        (false, true) => format!("the {body} is exactly at 0, 0, 0 in row {row}"),
        _ => format!("the {body} jumps at row {row}"),
    };
    let count = jumps.len();
    let others = match count {
        1 => String::new(),
        _ => format!(" (one of {count} jumps)"),
    };
    Some(format!(
        "{first_words}, {} from the pose before it{others}",
        mm(way(first))
    ))
}
