//! Missing poses: the camera lost the object, the pusher was lifted.

use stickslip_dynamics::Pose;

use super::evidence::Evidence;
use super::finding::{Finding, Subject};
use crate::counted::counted;
use crate::tuning::LONGEST_BRIDGE;

/// Share of missing object poses that is worth a warning.
const MANY: f64 = 0.2;

/// Rows without a pose, one after another.
struct Loss {
    first: usize,
    rows: usize,
    seconds: f64,
}

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    vec![object(evidence), pusher(evidence)]
}

fn object(evidence: &Evidence<'_>) -> Finding {
    let losses = losses(&evidence.log.time, &evidence.log.object);
    let missing: usize = losses.iter().map(|loss| loss.rows).sum();
    let Some(longest) = losses.iter().max_by(|a, b| a.seconds.total_cmp(&b.seconds)) else {
        return Finding::ok(Subject::ObjectPoses, "every row has an object pose");
    };
    let rows = evidence.log.len();
    let found = format!(
        "{missing} of {rows} rows have no object pose, the longest loss {:.2} s from row {}",
        longest.seconds, longest.first
    );
    match missing {
        _ if missing == rows => Finding::problem(
            Subject::ObjectPoses,
            "no row has an object pose",
            "give at least the object's first pose",
        ),
        _ if missing as f64 > MANY * rows as f64 => Finding::warning(
            Subject::ObjectPoses,
            found,
            "rows without a pose count as occluded; check that this is intended",
        ),
        _ => Finding::ok(Subject::ObjectPoses, found),
    }
}

fn pusher(evidence: &Evidence<'_>) -> Finding {
    let losses = losses(&evidence.log.time, &evidence.log.pusher);
    let missing: usize = losses.iter().map(|loss| loss.rows).sum();
    if missing == evidence.log.len() {
        return Finding::problem(
            Subject::PusherPoses,
            "no row has a pusher pose",
            "give the pusher's poses: the pusher moves the object",
        );
    }
    let lifted = losses.iter().filter(|loss| loss.seconds > LONGEST_BRIDGE);
    let moving = |loss: &&Loss| {
        let rows = &evidence.moving[loss.first..loss.first + loss.rows];
        rows.iter().filter(|moves| **moves).count() > loss.rows / 2
    };
    if let Some(loss) = lifted.clone().find(moving) {
        let found = format!(
            "the pusher has no pose in {} while the object moves",
            loss.shown()
        );
        let advice =
            "find out why the poses are missing: without the pusher nothing moves the object";
        return Finding::warning(Subject::PusherPoses, found, advice);
    }
    let lifted: Vec<String> = lifted.map(Loss::shown).collect();
    match (missing, lifted.len()) {
        (0, _) => Finding::ok(Subject::PusherPoses, "every row has a pusher pose"),
        (_, 0) => Finding::ok(
            Subject::PusherPoses,
            format!(
                "no pusher pose in {}, all bridged",
                counted(missing as u64, "row")
            ),
        ),
        (_, count) => Finding::ok(
            Subject::PusherPoses,
            format!(
                "the pusher is lifted off the table {}: {}",
                counted(count as u64, "time"),
                lifted.join(", ")
            ),
        ),
    }
}

impl Loss {
    fn shown(&self) -> String {
        format!(
            "rows {} to {} ({:.1} s)",
            self.first,
            self.first + self.rows - 1,
            self.seconds
        )
    }
}

fn losses(time: &[f64], poses: &[Option<Pose>]) -> Vec<Loss> {
    let mut losses: Vec<Loss> = Vec::new();
    for row in (0..poses.len()).filter(|&row| poses[row].is_none()) {
        match losses.last_mut() {
            Some(loss) if loss.first + loss.rows == row => loss.rows += 1,
            _ => losses.push(Loss {
                first: row,
                rows: 1,
                seconds: 0.0,
            }),
        }
    }
    for loss in &mut losses {
        // from the last pose before to the first one after
        let (before, after) = (
            loss.first.saturating_sub(1),
            (loss.first + loss.rows).min(time.len() - 1),
        );
        loss.seconds = time[after] - time[before];
    }
    losses
}
