//! Repeated frames: rows whose object pose is exactly the one before.

use super::evidence::Evidence;
use super::finding::{Finding, Subject};

/// Share of repeated rows while the object moves that is worth a warning.
const MANY: f64 = 0.1;

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let poses = &evidence.log.object;
    let repeats = |row: usize| poses[row].is_some() && poses[row] == poses[row - 1];
    let share = |rows: &mut dyn Iterator<Item = usize>| {
        let rows: Vec<usize> = rows.collect();
        rows.iter().filter(|row| repeats(**row)).count() as f64 / rows.len().max(1) as f64
    };
    let all = share(&mut (1..poses.len()).filter(|&row| poses[row].is_some()));
    let moving =
        share(&mut (1..poses.len()).filter(|&row| poses[row].is_some() && evidence.moving[row]));
    let found = format!(
        "{:.1} % of object poses repeat the row before, {:.1} % while it moves",
        1e2 * all,
        1e2 * moving
    );
    vec![match moving > MANY {
        true => Finding::warning(
            Subject::RepeatedFrames,
            found,
            "leave the cells of repeated frames empty: the camera is slower than the log",
        ),
        false => Finding::ok(Subject::RepeatedFrames, found),
    }]
}
