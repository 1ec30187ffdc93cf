//! Repeated frames: object poses that are exactly the one before.

use super::evidence::{Evidence, mm};
use super::finding::{Finding, Subject};

/// Share of repeated rows while the object moves that is worth a warning.
const MANY: f64 = 0.1;

/// Poses that are the same, one after another, from which on the camera stands still.
const FROZEN: usize = 10;

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let poses = &evidence.log.object;
    let repeats = |[before, row]: &[usize; 2]| poses[*row] == poses[*before];
    let share = |pairs: &mut dyn Iterator<Item = &[usize; 2]>| {
        let pairs: Vec<&[usize; 2]> = pairs.collect();
        pairs.iter().filter(|pair| repeats(pair)).count() as f64 / pairs.len().max(1) as f64
    };
    let all = share(&mut evidence.seen.array_windows());
    let pairs = evidence.seen.array_windows();
    let moving = share(&mut pairs.filter(|[_, row]| evidence.moving[*row]));
    let found = format!(
        "{:.1} % of object poses repeat the one before, {:.1} % while it moves",
        1e2 * all,
        1e2 * moving
    );
    let frozen = frozen(evidence).filter(|_| moving <= MANY);
    vec![match (moving > MANY, frozen) {
        (true, _) => Finding::warning(
            Subject::RepeatedFrames,
            found,
            "leave the cells of repeated frames empty: the camera is slower than the log",
        ),
        (false, Some(finding)) => finding,
        (false, None) => Finding::ok(Subject::RepeatedFrames, found),
    }]
}

/// Many equal poses on end while the pusher goes on, from a camera whose poses scatter: it stood still.
fn frozen(evidence: &Evidence<'_>) -> Option<Finding> {
    let log = evidence.log;
    let runs = evidence
        .seen
        .chunk_by(|a, b| log.object[*a] == log.object[*b]);
    let longest = runs.max_by_key(|rows| rows.len())?;
    let (first, last) = (*longest.first()?, *longest.last()?);
    let pusher = |row: usize| evidence.pusher_at(log.time[row]);
    let (from, to) = (pusher(first)?, pusher(last)?);
    let way = (to.x - from.x).hypot(to.y - from.y);
    let scatters = evidence.noise.is_some_and(|noise| noise.position > 1e-6);
    let is_frozen = longest.len() >= FROZEN && scatters && way > evidence.tolerance();
    is_frozen.then(|| {
        let found = format!(
            "rows {first} to {last} have one and the same object pose, while the pusher goes {}",
            mm(way)
        );
        let advice = "the camera stood still: leave the cells of these rows empty";
        Finding::warning(Subject::RepeatedFrames, found, advice)
    })
}
