//! Jumps: poses that no body can have come to between two rows.

use stickslip_dynamics::Pose;

use super::evidence::{Evidence, mm, quantile};
use super::finding::{Finding, Subject};
use crate::log::Log;

/// Share of the object's radius above which a step from pose to pose may be a jump.
const FAR: f64 = 0.3;

/// Multiple of the 90 % quantile of all steps above which it is one.
const RARE: f64 = 8.0;

/// Multiple of the speed of all steps near it above which a shorter step is a jump. Steps that lead
/// back do not count; those of the pusher do.
const SUDDEN: f64 = 4.0;

/// Standard deviations of a position that a shorter step must exceed as well. Beyond the greater
/// number it is a problem.
const BEYOND_NOISE: [f64; 2] = [12.0, 40.0];

/// Number of steps before and after one by which it is judged.
const ABOUT: usize = 4;

/// Longest time between two poses for which a jump is reported (s). A body can go far over a longer
/// one.
const SOON: f64 = 0.15;

/// Step of a body from one pose to the next that differs.
struct Step {
    rows: [usize; 2],
    poses: [Pose; 2],
    /// Length (m).
    way: f64,
    /// Duration (s).
    time: f64,
}

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let Log { object, pusher, .. } = evidence.log;
    let (of_object, of_pusher) = (steps(evidence, object), steps(evidence, pusher));
    let found = [
        // the pusher moves the object, which may then move as fast as the pusher
        jumps(
            evidence,
            (Subject::ObjectPoses, "object"),
            &of_object,
            &[&of_object, &of_pusher],
        ),
        jumps(
            evidence,
            (Subject::PusherPoses, "pusher"),
            &of_pusher,
            &[&of_pusher],
        ),
    ];
    found.into_iter().flatten().collect()
}

fn steps(evidence: &Evidence<'_>, poses: &[Option<Pose>]) -> Vec<Step> {
    let time = &evidence.log.time;
    let mut seen: Vec<(usize, Pose)> = (0..poses.len())
        .filter_map(|row| Some((row, poses[row]?)))
        .collect();
    // a pose that is held is as old as its first row
    seen.dedup_by_key(|(_, pose)| *pose);
    let step = |[(from, a), (to, b)]: &[(usize, Pose); 2]| Step {
        rows: [*from, *to],
        poses: [*a, *b],
        way: (b.x - a.x).hypot(b.y - a.y),
        time: time[*to] - time[*from],
    };
    seen.array_windows().map(step).collect()
}

/// The jumps among the `steps` of a body, judged by the speeds of `movers`.
fn jumps(
    evidence: &Evidence<'_>,
    (subject, body): (Subject, &str),
    steps: &[Step],
    movers: &[&[Step]],
) -> Option<Finding> {
    let usual = quantile(steps.iter().map(|step| step.way), 0.9);
    let large = (FAR * evidence.size()).max(RARE * usual);
    let large = large.max(3.0 * evidence.tolerance());
    let [least, most] = BEYOND_NOISE.map(|count| count * position_std(evidence, subject));
    let is_sudden = |step: &Step| {
        let speeds = movers.iter().map(|steps| speed_about(steps, step));
        step.way > least && step.way > SUDDEN * speeds.fold(0.0, f64::max) * step.time
    };
    let is_jump = |step: &&Step| step.time <= SOON && (step.way > large || is_sudden(step));
    let jumps: Vec<&Step> = steps.iter().filter(is_jump).collect();
    let first = jumps.first()?;
    let farthest = jumps.iter().map(|step| step.way).fold(0.0, f64::max);
    let found = told(body, first, jumps.len(), farthest);
    let advice =
        "leave the cells of a lost pose empty; cut the log where the body was moved by hand";
    Some(match farthest > large.min(most) {
        true => Finding::problem(subject, found, advice),
        false => Finding::warning(subject, found, advice),
    })
}

/// Describes the first of `count` jumps.
fn told(body: &str, first: &Step, count: usize, farthest: f64) -> String {
    let [before, row] = first.rows;
    let is_origin = |pose: Pose| [pose.x, pose.y, pose.theta] == [0.0; 3];
    let first_words = match first.poses.map(is_origin) {
        [true, false] => format!("the {body} is exactly at 0, 0, 0 in row {before}"),
        [false, true] => format!("the {body} is exactly at 0, 0, 0 in row {row}"),
        _ => format!("the {body} jumps at row {row}"),
    };
    let others = match count {
        1 => String::new(),
        _ if farthest > first.way => {
            format!(" (one of {count} jumps, the farthest {})", mm(farthest))
        }
        _ => format!(" (one of {count} jumps)"),
    };
    format!(
        "{first_words}, {} from the pose before it{others}",
        mm(first.way)
    )
}

/// Greatest speed of the few steps before and after `step` (m/s). Steps that lead back from where
/// it led do not count.
fn speed_about(steps: &[Step], step: &Step) -> f64 {
    let before = steps.partition_point(|other| other.rows[1] <= step.rows[0]);
    let after = steps.partition_point(|other| other.rows[0] < step.rows[1]);
    let near = steps[before.saturating_sub(ABOUT)..before]
        .iter()
        .chain(steps[after..].iter().take(ABOUT));
    let onward = near.filter(|other| {
        let ([a, b], [c, d]) = (step.poses, other.poses);
        (b.x - a.x) * (d.x - c.x) + (b.y - a.y) * (d.y - c.y) >= 0.0
    });
    onward.map(|step| step.way / step.time).fold(0.0, f64::max)
}

/// Standard deviation of a position: the greater of the measured and the stated one (m).
fn position_std(evidence: &Evidence<'_>, subject: Subject) -> f64 {
    if subject == Subject::ObjectPoses {
        return evidence.position_std();
    }
    let measured = evidence.pusher_noise.map_or(0.0, |noise| noise.position);
    let camera = evidence.setup.camera.as_ref();
    camera.map_or(measured, |camera| camera.pusher_position_std.max(measured))
}
