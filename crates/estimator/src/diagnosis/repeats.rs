//! Repeated frames: poses that are exactly the one before.

use stickslip_dynamics::Pose;

use super::evidence::{Evidence, HALF_WINDOW, mm};
use super::finding::{Finding, Subject};

/// Share of repeated rows while the object moves that is worth a warning.
const MANY: f64 = 0.1;

/// Number of equal poses in a row from which on the camera stands still.
const FROZEN: usize = 10;

/// Way of the pusher about a row above which it moves, in standard deviations and in metres.
const MOTION: f64 = 10.0;
const MOVES: f64 = 1e-3;

/// Least share of that way before the row, and after it.
const GOES_ON: f64 = 0.25;

/// Fewest rows of a moving pusher that tell.
const FEWEST: usize = 10;

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let mut findings = vec![object(evidence)];
    findings.extend(pusher(evidence));
    findings
}

fn object(evidence: &Evidence<'_>) -> Finding {
    let poses = &evidence.log.object;
    let all = share(poses, evidence.seen.array_windows());
    let pairs = evidence.seen.array_windows();
    let moving = share(poses, pairs.filter(|[_, row]| evidence.moving[*row]));
    let found = format!(
        "{:.1} % of object poses repeat the one before, {:.1} % while it moves",
        1e2 * all,
        1e2 * moving
    );
    match frozen(evidence) {
        Some(finding) => finding,
        None if moving > MANY => Finding::warning(
            Subject::RepeatedFrames,
            found,
            "leave the cells of repeated frames empty: the camera is slower than the log",
        ),
        None => Finding::ok(Subject::RepeatedFrames, found),
    }
}

/// Finds poses of a moving pusher that are those of the row before: it is sampled more slowly than
/// the log, and held.
fn pusher(evidence: &Evidence<'_>) -> Option<Finding> {
    let (time, poses) = (&evidence.log.time, &evidence.log.pusher);
    let seen: Vec<usize> = (0..poses.len())
        .filter(|&row| poses[row].is_some())
        .collect();
    let noise = evidence.pusher_noise.map_or(0.0, |noise| noise.position);
    // it moves both before and after the row: near a start or a stop it rests, and repeats what is
    // true
    let moves = |row: usize| {
        let way = |from: f64, to: f64| {
            let (a, b) = (evidence.pusher_at(from)?, evidence.pusher_at(to)?);
            Some((b.x - a.x).hypot(b.y - a.y))
        };
        let (from, here, to) = (time[row] - HALF_WINDOW, time[row], time[row] + HALF_WINDOW);
        let Some((first, second)) = way(from, here).zip(way(here, to)) else {
            return false;
        };
        first + second > (MOTION * noise).max(MOVES)
            && first.min(second) > GOES_ON * (first + second)
    };
    let moving: Vec<&[usize; 2]> = seen
        .array_windows()
        .filter(|[_, row]| moves(*row))
        .collect();
    let repeated = share(poses, moving.iter().copied());
    (moving.len() >= FEWEST && repeated > MANY).then(|| {
        let found = format!(
            "{:.1} % of pusher poses repeat the one before while it moves",
            1e2 * repeated
        );
        let advice = "leave the cells of repeated poses empty: the pusher is sampled more slowly than the log, and seems to stop and jump";
        Finding::warning(Subject::RepeatedFrames, found, advice)
    })
}

/// Share of `pairs` of rows whose two poses are equal.
fn share<'p>(poses: &[Option<Pose>], pairs: impl Iterator<Item = &'p [usize; 2]>) -> f64 {
    let (mut all, mut repeated) = (0_usize, 0_usize);
    for [before, row] in pairs {
        all += 1;
        repeated += usize::from(poses[*row] == poses[*before]);
    }
    repeated as f64 / all.max(1) as f64
}

/// Finds many equal poses in a row and then one far from them, from a camera whose poses scatter.
/// It stood still while the object went on.
fn frozen(evidence: &Evidence<'_>) -> Option<Finding> {
    let (object, seen) = (&evidence.log.object, &evidence.seen);
    if evidence.noise.is_none_or(|noise| noise.position < 1e-6) {
        return None;
    }
    let way = |from: usize, to: usize| {
        let (from, to) = (object[from]?, object[to]?);
        Some((to.x - from.x).hypot(to.y - from.y))
    };
    let mut end = 0;
    for rows in seen.chunk_by(|a, b| object[*a] == object[*b]) {
        end += rows.len();
        let (first, last) = (*rows.first()?, *rows.last()?);
        let jump = seen.get(end).and_then(|next| way(last, *next));
        if rows.len() >= FROZEN
            && let Some(jump) = jump.filter(|jump| *jump > evidence.tolerance())
        {
            let found = format!(
                "rows {first} to {last} repeat one object pose; the next pose is {} away",
                mm(jump)
            );
            let advice = "the camera image froze: leave the cells of these rows empty";
            return Some(Finding::warning(Subject::RepeatedFrames, found, advice));
        }
    }
    None
}
