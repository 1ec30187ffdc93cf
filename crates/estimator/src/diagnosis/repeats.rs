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
    vec![match frozen(evidence) {
        Some(finding) => finding,
        None if moving > MANY => Finding::warning(
            Subject::RepeatedFrames,
            found,
            "leave the cells of repeated frames empty: the camera is slower than the log",
        ),
        None => Finding::ok(Subject::RepeatedFrames, found),
    }]
}

/// Many equal poses on end and then one far from them, from a camera whose poses scatter: it stood still
/// while the object went on.
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
                "rows {first} to {last} have one and the same object pose, and the next one is {} from it",
                mm(jump)
            );
            let advice = "the camera stood still: leave the cells of these rows empty";
            return Some(Finding::warning(Subject::RepeatedFrames, found, advice));
        }
    }
    None
}
