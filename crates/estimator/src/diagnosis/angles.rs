//! Angles: radians, not degrees, and no body the wrong way round.

use std::f64::consts::{PI, TAU};

use stickslip_dynamics::Pose;

use super::evidence::Evidence;
use super::finding::{Finding, Subject};
use crate::angle::wrapped;
use crate::counted::counted;
use crate::log::Log;

/// Angle beyond which the values are degrees (rad): no object is turned twice around on a table.
const LARGEST: f64 = 2.0 * TAU;

/// Noise of an angle at the object's radius, as a multiple of the position's, from which on it is
/// in degrees.
const NOISE_RATIO: f64 = 10.0;

const RADIANS: &str = "give angles in radians: multiply by pi / 180";

/// Judges the angles of the log as it was `given`: unwrapped, degrees would not be large.
pub(super) fn check(evidence: &Evidence<'_>, given: &Log) -> Vec<Finding> {
    let bodies = [
        ("object_theta", &given.object),
        ("pusher_theta", &given.pusher),
    ];
    let mut found: Vec<Finding> = bodies
        .iter()
        .filter_map(|(name, poses)| in_degrees(name, poses).or_else(|| turned(name, poses)))
        .collect();
    found.extend(noise_in_degrees(evidence).filter(|_| found.is_empty()));
    if found.is_empty() {
        let words = match range(&given.object) {
            Some((low, high)) => format!("object_theta goes from {low:.2} to {high:.2} rad"),
            None => "no object_theta in the log".to_owned(),
        };
        found.push(Finding::ok(Subject::Angles, words));
    }
    found
}

fn in_degrees(name: &str, poses: &[Option<Pose>]) -> Option<Finding> {
    let (low, high) = range(poses)?;
    let found = || format!("{name} goes from {low:.1} to {high:.1}: these seem to be degrees");
    (low.abs().max(high.abs()) > LARGEST)
        .then(|| Finding::problem(Subject::Angles, found(), RADIANS))
}

/// Finds a jump by about half a turn from one row to the next. Full turns do not count: angles may
/// be wrapped to one turn.
fn turned(name: &str, poses: &[Option<Pose>]) -> Option<Finding> {
    let jumps = |row: &usize| {
        let step = || Some(poses[*row]?.theta - poses[row - 1]?.theta);
        step().is_some_and(|step| wrapped(step).abs() > 0.75 * PI)
    };
    let half: Vec<usize> = (1..poses.len()).filter(jumps).collect();
    half.first().map(|first| {
        let found = format!(
            "{name} jumps by half a turn at {}, first at row {first}: the tracker mistakes the orientation",
            counted(half.len() as u64, "row")
        );
        let advice = "leave the cells of these rows empty, or correct their angle by pi";
        Finding::warning(Subject::Angles, found, advice)
    })
}

/// Finds small angles in degrees: only their noise gives them away.
fn noise_in_degrees(evidence: &Evidence<'_>) -> Option<Finding> {
    let noise = evidence.noise?;
    let ratio = noise.angle * evidence.size() / noise.position.max(1e-6);
    let stated = evidence
        .setup
        .camera
        .map_or(0.0, |camera| camera.orientation_std);
    let found = || {
        let twice = "at the object's rim";
        format!(
            "object_theta scatters by {:.3} from row to row, {twice} {ratio:.0} times the noise of positions: it seems to be in degrees",
            noise.angle
        )
    };
    (ratio > NOISE_RATIO && noise.angle > 5.0 * stated && noise.angle > 0.02)
        .then(|| Finding::problem(Subject::Angles, found(), RADIANS))
}

/// Smallest and largest angle; `None` without a pose.
fn range(poses: &[Option<Pose>]) -> Option<(f64, f64)> {
    let angles = || poses.iter().flatten().map(|pose| pose.theta);
    let low = angles().reduce(f64::min)?;
    Some((low, angles().reduce(f64::max)?))
}
