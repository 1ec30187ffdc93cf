//! Collapses: rows at which the filter's belief did not explain the camera.

use super::finding::{Finding, Subject};
use crate::counted::counted;

/// Share of the camera's poses from which on collapses are no accidents.
const MANY: f64 = 0.02;

/// Share from which on nothing was explained.
const MOST: f64 = 0.2;

/// Returns what `collapses` among `seen` rows with a camera pose mean; `None` if they are too few
/// to mean anything.
///
/// All particles are reinitialised around the camera's pose at a collapse, or an extended Kalman
/// filter restarts at it. If there are many, an estimate is near the camera because it was put
/// there.
pub fn collapsed(collapses: u32, seen: usize) -> Option<Finding> {
    let share = f64::from(collapses) / seen.max(1) as f64;
    let found = format!(
        "{} in {seen} camera poses: the estimate did not explain the pose and restarted at it",
        counted(u64::from(collapses), "collapse")
    );
    if collapses < 2 || share < MANY {
        return None;
    }
    Some(if share < MOST {
        let advice = "the errors at these rows are the camera's own; run `stickslip check`";
        Finding::warning(Subject::Collapses, found, advice)
    } else {
        let found =
            format!("{found}. The filter only repeats the camera, and small errors mean nothing");
        let advice = "run `stickslip check` for units, frames and noise";
        Finding::problem(Subject::Collapses, found, advice)
    })
}

#[cfg(test)]
mod tests {
    use super::super::finding::Severity;
    use super::*;

    #[test]
    fn collapses_are_told_by_their_share() {
        let severity = |collapses, seen| collapsed(collapses, seen).map(|finding| finding.severity);
        assert_eq!(severity(0, 0), None);
        assert_eq!(severity(1, 3), None);
        assert_eq!(severity(2, 600), None);
        assert_eq!(severity(20, 600), Some(Severity::Warning));
        assert_eq!(severity(180, 181), Some(Severity::Problem));
    }
}
