//! Time steps: rate, unevenness, holes.

use super::evidence::{Evidence, median};
use super::finding::{Finding, Subject};
use crate::counted::counted;
use crate::row::{LONGEST_PAUSE, unit_of_times};

/// Longest typical step of a camera that follows a push (s).
const SLOWEST: f64 = 0.2;

/// Multiple of the median step above which a step is a hole.
const HOLE: f64 = 4.5;

/// Longest step in which a hole does no harm (s).
const SHORT: f64 = 0.15;

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let steps: Vec<f64> = evidence
        .log
        .time
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .collect();
    if steps.is_empty() {
        return vec![Finding::problem(
            Subject::Timing,
            "the log has one row",
            "record one row per camera frame",
        )];
    }
    let typical = median(steps.iter().copied());
    let (shortest, longest) = (
        steps.iter().copied().fold(f64::INFINITY, f64::min),
        steps.iter().copied().fold(0.0, f64::max),
    );
    let holes = steps
        .iter()
        .filter(|step| **step > HOLE * typical && **step > SHORT)
        .count();
    let rate = format!(
        "{:.1} Hz, steps of {:.1} to {:.1} ms",
        1.0 / typical,
        1e3 * shortest,
        1e3 * longest
    );
    if let Some(unit) = unit_of_times(typical) {
        let found = format!("{rate}: time seems to be in {unit}");
        return vec![Finding::problem(
            Subject::Timing,
            found,
            "give time in seconds",
        )];
    }
    if longest > LONGEST_PAUSE {
        let found = format!("{rate}: rows are more than {LONGEST_PAUSE} s apart");
        return vec![Finding::problem(
            Subject::Timing,
            found,
            "give all times by one clock, or cut the log in the pause",
        )];
    }
    vec![match (typical > SLOWEST, holes) {
        (true, _) => Finding::warning(
            Subject::Timing,
            format!("{rate}: slow for a push"),
            "record at 10 Hz or more",
        ),
        (false, 0) => Finding::ok(Subject::Timing, rate),
        (false, holes) => {
            let found = format!(
                "{rate}; {} longer than {HOLE} times the median",
                counted(holes as u64, "step")
            );
            Finding::warning(
                Subject::Timing,
                found,
                "write rows with empty cells where nothing was measured, at the usual rate",
            )
        }
    }]
}
