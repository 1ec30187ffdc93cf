//! Check that object and pusher poses are in the same frame.
//!
//! The pusher moves the object, so their gap is near zero while the object moves. If it is not, the
//! gap is computed again with axes mirrored, swapped or turned. A variant that brings it to zero
//! names the slip.

use std::f64::consts::FRAC_PI_2;

use stickslip_dynamics::Pose;

use super::evidence::{Evidence, median, mm, quantile};
use super::finding::{Finding, Subject};
use crate::log::Log;

/// Gap above which there is no contact, as a share of the object's radius.
const APART: f64 = 0.35;

/// Factor by which a variant must be better to be named.
const BETTER: f64 = 3.0;

/// Fewest rows that tell.
const FEWEST: usize = 10;

type Change = fn(Pose, Pose) -> (Pose, Pose);

const SWAPPED_AXES: &str = "x and y are swapped in object and pusher";

/// Slips, each with its correction of the object's and the pusher's pose in the log.
const SLIPS: [(&str, Change); 9] = [
    (
        "the object's y axis is mirrored (y and theta change sign)",
        |o, p| (mirrored(o), p),
    ),
    (
        "the pusher's y axis is mirrored (y and theta change sign)",
        |o, p| (o, mirrored(p)),
    ),
    (
        "both y axes are mirrored against the outline (y and theta change sign)",
        |o, p| (mirrored(o), mirrored(p)),
    ),
    (
        "the object's angle is clockwise (theta changes sign)",
        |o, p| (Pose::new(o.x, o.y, -o.theta), p),
    ),
    (
        "the object's angle is off by a quarter turn (+90 degrees)",
        |o, p| (Pose::new(o.x, o.y, o.theta + FRAC_PI_2), p),
    ),
    (
        "the object's angle is off by a quarter turn (-90 degrees)",
        |o, p| (Pose::new(o.x, o.y, o.theta - FRAC_PI_2), p),
    ),
    ("the object's angle is off by half a turn", |o, p| {
        (Pose::new(o.x, o.y, o.theta + 2.0 * FRAC_PI_2), p)
    }),
    ("the object's x and y are swapped", |o, p| (swapped(o), p)),
    (SWAPPED_AXES, |o, p| (swapped(o), swapped(p))),
];

fn mirrored(pose: Pose) -> Pose {
    Pose::new(pose.x, -pose.y, -pose.theta)
}

fn swapped(pose: Pose) -> Pose {
    Pose::new(pose.y, pose.x, pose.theta)
}

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    if let Some(finding) = leading(evidence) {
        return vec![finding];
    }
    let gaps = gaps(evidence, |object, pusher| (object, pusher));
    if gaps.len() < FEWEST {
        return vec![Finding::ok(
            Subject::Frames,
            "not checked: the object hardly moves while the pusher is near",
        )];
    }
    let (off, nearest) = (distance(&gaps), median(gaps.iter().copied()));
    // swapped axes of both bodies keep them near each other, but not in touch
    let touching =
        |(name, distance): (&str, f64)| name == SWAPPED_AXES && distance < evidence.tolerance();
    // a gap that stays is an offset
    let spread = quantile(gaps.iter().copied(), 0.95) - quantile(gaps.iter().copied(), 0.05);
    let explained = || {
        off.min(spread) > 2.0 * evidence.tolerance() && slip(evidence, off).is_some_and(touching)
    };
    if off < APART * evidence.size() && !explained() {
        return vec![Finding::ok(
            Subject::Frames,
            format!(
                "the pusher is at the object whenever it moves (75 % of the rows within {})",
                mm(off)
            ),
        )];
    }
    let found = format!(
        "gap between pusher and moving object {} (median): their poses are not in the same frame",
        mm(nearest)
    );
    let advice = slip(evidence, off).map_or(
        "give object and pusher poses in the same world frame, x and y right-handed, angles counter-clockwise",
        |(name, _)| name,
    );
    vec![Finding::problem(Subject::Frames, found, advice)]
}

/// Finds an object that leads: it moves while the pusher still rests, and pushes it later. The
/// columns of the two are swapped.
fn leading(evidence: &Evidence<'_>) -> Option<Finding> {
    let log = evidence.log;
    // the median of the first poses, so that a single wrong one is no motion
    let way = |poses: &[Option<Pose>], row: usize| {
        let first = || poses.iter().flatten().take(5);
        let start = Pose::new(
            median(first().map(|pose| pose.x)),
            median(first().map(|pose| pose.y)),
            0.0,
        );
        let pose = poses[..=row].iter().rev().flatten().next()?;
        Some((pose.x - start.x).hypot(pose.y - start.y))
    };
    let moves = 2.0 * evidence.tolerance();
    let starts =
        (0..log.len()).find(|row| way(&log.pusher, *row).is_some_and(|way| way > moves))?;
    // fewer poses do not tell when the object began to move
    if log.object[..=starts].iter().flatten().count() < 5 {
        return None;
    }
    let lead = way(&log.object, starts)?;
    let leads = lead > 3.0 * moves && swapped_distance(evidence) < evidence.tolerance();
    leads.then(|| {
        let found = format!(
            "the object moves {} before the pusher moves: object and pusher are swapped",
            mm(lead)
        );
        let advice = "swap the columns of object and pusher in the log, or their topics";
        Finding::problem(Subject::Frames, found, advice)
    })
}

/// Returns the slip that explains the gap best, if one does, with the gap's distance from zero (m).
fn slip(evidence: &Evidence<'_>, off: f64) -> Option<(&'static str, f64)> {
    let tried = SLIPS
        .iter()
        .map(|(name, change)| (*name, distance(&gaps(evidence, change))));
    let swapped = ("object and pusher are swapped", swapped_distance(evidence));
    let (name, best) = tried.chain([swapped]).min_by(|a, b| a.1.total_cmp(&b.1))?;
    (best * BETTER < off && best < APART * evidence.size()).then_some((name, best))
}

/// Distance of the gaps from zero if object and pusher are swapped (m). The body that moves is then
/// the other one, too.
fn swapped_distance(evidence: &Evidence<'_>) -> f64 {
    let log = Log {
        object: evidence.log.pusher.clone(),
        pusher: evidence.log.object.clone(),
        ..evidence.log.clone()
    };
    distance(&gaps(
        &Evidence::new(evidence.setup, &log),
        |object, pusher| (object, pusher),
    ))
}

/// Distance of the gaps from zero, for most rows (m).
fn distance(gaps: &[f64]) -> f64 {
    let far = quantile(gaps.iter().map(|gap| gap.abs()), 0.75);
    if far.is_nan() { f64::INFINITY } else { far }
}

/// Gaps (m) while the object moves, with the poses changed.
fn gaps(evidence: &Evidence<'_>, change: impl Fn(Pose, Pose) -> (Pose, Pose)) -> Vec<f64> {
    let rows = (0..evidence.log.len()).filter(|&row| evidence.moving[row]);
    let gap = |row: usize| evidence.changed_gap(row, evidence.latency(), &change);
    rows.filter_map(gap).collect()
}
