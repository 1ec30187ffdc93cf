//! The gap between object and pusher while it pushes: its bias, scatter and drift.

use super::evidence::{Evidence, median, mm, quantile};
use super::finding::{Finding, Subject};
use super::latency;

/// Fewest rows that tell.
const FEWEST: usize = 10;

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let stated = evidence.latency();
    let delay = latency::estimate(evidence).map_or(stated, |latency| latency.accepted(stated));
    let gaps = gaps(evidence, delay);
    if gaps.len() < FEWEST {
        return vec![Finding::ok(
            Subject::PushingGap,
            "not measured: too few poses of a moving object",
        )];
    }
    let all = || gaps.iter().copied();
    let (low, middle, high) = (quantile(all(), 0.05), median(all()), quantile(all(), 0.95));
    let third = gaps.len() / 3;
    let drift =
        median(gaps[gaps.len() - third..].iter().copied()) - median(gaps[..third].iter().copied());
    let found = format!(
        "gap between pusher and moving object {} (5 to 95 %: {} to {}), drift {}",
        mm(middle),
        mm(low),
        mm(high),
        mm(drift)
    );
    let tolerance = evidence.tolerance();
    vec![match middle.abs() {
        bias if bias > 5.0 * tolerance => Finding::problem(
            Subject::PushingGap,
            found,
            "correct the outlines, or the calibration of camera to pusher",
        ),
        bias if bias > tolerance
            || high - low > 4.0 * tolerance
            || drift.abs() > 2.0 * tolerance =>
        {
            Finding::warning(
                Subject::PushingGap,
                found,
                "check the outlines and the calibration of camera to pusher",
            )
        }
        _ => Finding::ok(Subject::PushingGap, found),
    }]
}

/// Gaps (m) while the object moves, if its poses are `delay` late.
pub(super) fn gaps(evidence: &Evidence<'_>, delay: f64) -> Vec<f64> {
    let rows = (0..evidence.log.len()).filter(|&row| evidence.moving[row]);
    rows.filter_map(|row| evidence.pusher_gap(row, delay))
        .collect()
}
