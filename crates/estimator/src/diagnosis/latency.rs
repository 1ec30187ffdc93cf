//! Delay of the camera behind the pusher, from the stops of the pusher.
//!
//! A pusher that pushes and then stands stays in touch, so the gap stays constant. A late object
//! pose shows the object still coming when the pusher stands: the gap then bends. The delay of a
//! stop is the one that keeps the gap most constant from a quarter of a second before it to half a
//! second after. The log's delay is the median over its stops.
//!
//! Many delays do so about as well if the pusher is slow, or slides along the object. A delay
//! counts against the stated one only if noise does not explain the gaps that the stated one
//! leaves.

use std::ops::Range;

use super::evidence::{Evidence, median, quantile};
use super::finding::{Finding, Subject};
use crate::counted::counted;

/// Delays that are tried (s).
const RANGE: [f64; 2] = [-0.3, 0.5];

/// Step between them (s).
const STEP: f64 = 0.005;

/// Time before and after a stop that is examined (s).
const WINDOW: [f64; 2] = [0.25, 0.55];

/// Time within which the pusher stops once (s).
const ONE_STOP: f64 = 0.1;

/// Most rows about a stop that are examined; of more, every second, third or so.
const MOST_ROWS: usize = 1000;

/// Errors of a delay (s): the first is worth a warning, the second is a problem.
const OFF: [f64; 2] = [0.035, 0.06];

/// Standard deviations of a position by which the pusher must move on within a delay for the delay
/// to matter.
const MATTERS: f64 = 1.5;

/// Twice the log-likelihood by which a delay has to explain the gaps better than the stated one.
/// The best of all that are tried reaches as much by noise alone in one log of a thousand.
const CLEARLY: f64 = 14.0;

/// The delay of a log.
#[derive(Clone, Copy, Debug)]
pub(super) struct Latency {
    /// Median over stops (s).
    pub delay: f64,
    /// Number of stops that determine a delay.
    pub stops: usize,
    /// Speed of the pusher when it moves (m/s).
    pub speed: f64,
    /// Twice the log-likelihood by which the delays of the stops explain their gaps better than the
    /// stated one does.
    pub better: f64,
}

/// Evidence of one stop.
struct Told {
    delay: f64,
    better: f64,
}

impl Latency {
    /// Returns true if the stops contradict the stated delay.
    fn is_clear(&self) -> bool {
        self.better > CLEARLY
    }

    /// Returns the delay to use: the measured one if it is clearly better than the stated one.
    pub fn accepted(&self, stated: f64) -> f64 {
        if self.is_clear() { self.delay } else { stated }
    }
}

pub(super) fn check(evidence: &Evidence<'_>) -> Vec<Finding> {
    let stated = evidence.latency();
    let Some(latency) = estimate(evidence) else {
        let found = format!(
            "camera latency not measured: the pusher never stops while it pushes; scene.toml: {stated} s"
        );
        return vec![Finding::ok(Subject::Latency, found)];
    };
    let Latency {
        delay,
        stops,
        speed,
        ..
    } = latency;
    let found = format!(
        "camera latency {delay:.3} s (from {}); scene.toml: {stated} s",
        counted(stops as u64, "pusher stop")
    );
    let advice = match delay < 0.0 {
        false => format!("set latency = {delay:.2} under [camera]"),
        true => format!(
            "the pusher's poses are {:.2} s late, or the object's times too early: correct the log's times",
            -delay
        ),
    };
    vec![match (delay - stated).abs() {
        off if off > OFF[0] && !latency.is_clear() => Finding::ok(
            Subject::Latency,
            format!("{found}, which fits about as well"),
        ),
        off if off * speed < MATTERS * evidence.position_std() => {
            Finding::ok(Subject::Latency, found)
        }
        off if off > OFF[1] => Finding::problem(Subject::Latency, found, advice),
        off if off > OFF[0] => Finding::warning(Subject::Latency, found, advice),
        _ => Finding::ok(Subject::Latency, found),
    }]
}

/// Returns the delay of the log, if its pusher stops while it pushes.
pub(super) fn estimate(evidence: &Evidence<'_>) -> Option<Latency> {
    let time = &evidence.log.time;
    let speeds: Vec<Option<f64>> = (0..time.len())
        .map(|row| pusher_speed(evidence, row))
        .collect();
    let speed = quantile(speeds.iter().flatten().copied(), 0.9);
    let told: Vec<Told> = stops(time, &speeds, speed)
        .into_iter()
        .filter_map(|row| told_at(evidence, row))
        .collect();
    (!told.is_empty()).then(|| Latency {
        stops: told.len(),
        delay: median(told.iter().map(|told| told.delay)),
        speed,
        better: told.iter().map(|told| told.better).sum(),
    })
}

/// Rows at which the pusher stops after a steady motion at about the speed `fast`, one for each
/// stop.
fn stops(time: &[f64], speeds: &[Option<f64>], fast: f64) -> Vec<usize> {
    // number of rows before each one whose speed is as `is` says
    let counts = |is: &dyn Fn(f64) -> bool| {
        let mut counts = vec![0];
        for speed in speeds {
            let last = counts[counts.len() - 1];
            counts.push(last + usize::from(speed.is_some_and(is)));
        }
        counts
    };
    let (steady, at_rest) = (
        counts(&|speed| speed > 0.5 * fast),
        counts(&|speed| speed < 0.2 * fast),
    );
    let rows = |from: f64, to: f64| {
        time.partition_point(|t| *t < from)..time.partition_point(|t| *t <= to)
    };
    let all =
        |counts: &[usize], rows: &Range<usize>| counts[rows.end] - counts[rows.start] == rows.len();
    let is_stop = |row: &usize| {
        let falls = speeds[row - 1].is_some_and(|speed| speed >= 0.5 * fast)
            && speeds[*row].is_some_and(|speed| speed < 0.5 * fast);
        let (before, after) = (
            rows(time[*row] - 0.35, time[*row] - 0.1),
            rows(time[*row] + 0.12, time[*row] + 0.4),
        );
        falls && !after.is_empty() && all(&steady, &before) && all(&at_rest, &after)
    };
    let mut stops: Vec<usize> = (1..time.len()).filter(is_stop).collect();
    // a noisy speed may fall more than once
    stops.dedup_by(|later, earlier| time[*later] - time[*earlier] < ONE_STOP);
    stops
}

/// Speed of the pusher over 0.13 s about a row (m/s).
fn pusher_speed(evidence: &Evidence<'_>, row: usize) -> Option<f64> {
    let time = evidence.log.time[row];
    let (before, after) = (
        evidence.pusher_at(time - 0.067)?,
        evidence.pusher_at(time + 0.067)?,
    );
    Some((after.x - before.x).hypot(after.y - before.y) / 0.134)
}

/// Returns the delay that keeps the gap about a stop most constant; `None` if the stop does not
/// determine it.
fn told_at(evidence: &Evidence<'_>, stop: usize) -> Option<Told> {
    let time = &evidence.log.time;
    let (from, to) = (time[stop] - WINDOW[0], time[stop] + WINDOW[1]);
    let first = evidence.seen.partition_point(|row| time[*row] < from);
    let end = evidence.seen.partition_point(|row| time[*row] <= to);
    let rows = &evidence.seen[first..end];
    let rows: Vec<usize> = rows
        .iter()
        .step_by(1 + rows.len() / MOST_ROWS)
        .copied()
        .collect();
    let pushed = rows
        .iter()
        .filter(|&&row| time[row] <= time[stop] && evidence.moving[row])
        .count();
    if rows.len() < 8 || pushed < 3 {
        return None;
    }
    let count = ((RANGE[1] - RANGE[0]) / STEP).round() as usize;
    let delays: Vec<f64> = (0..=count).map(|k| RANGE[0] + STEP * k as f64).collect();
    let scatter: Vec<f64> = delays
        .iter()
        .map(|delay| scatter(evidence, &rows, *delay).unwrap_or(f64::INFINITY))
        .collect();
    let best = (0..scatter.len()).min_by(|a, b| scatter[*a].total_cmp(&scatter[*b]))?;
    // a delay at the end of the range, or one that is hardly better than those 0.1 s away, tells
    // nothing
    let aside = (0.1 / STEP) as usize;
    let sides = [best.checked_sub(aside)?, best + aside];
    let tells = sides
        .iter()
        .all(|side| scatter.get(*side).is_some_and(|s| *s > 1.3 * scatter[best]));
    tells.then(|| Told {
        delay: delays[best],
        better: better(evidence, &rows, scatter[best]),
    })
}

/// Twice the log-likelihood of a delay at which the gaps over `rows` scatter by `scatter`, minus
/// that of the stated delay.
fn better(evidence: &Evidence<'_>, rows: &[usize], scatter: f64) -> f64 {
    // errors that last reduce the number of independent poses
    let poses = rows.len() as f64 / evidence.lasting.map_or(1.0, |errors| errors.rows);
    let stated = self::scatter(evidence, rows, evidence.latency()).unwrap_or(f64::INFINITY);
    // the best of many delays fits noise, too: gaps scatter by no less than poses do
    let noise = scatter.max(evidence.gap_std());
    poses * (stated * stated - scatter * scatter) / (noise * noise)
}

/// Standard deviation of the gap over `rows` at a delay (m); `None` where the pusher is not known.
fn scatter(evidence: &Evidence<'_>, rows: &[usize], delay: f64) -> Option<f64> {
    let gaps: Vec<f64> = rows
        .iter()
        .map(|row| evidence.pusher_gap(*row, delay))
        .collect::<Option<_>>()?;
    let mean = gaps.iter().sum::<f64>() / gaps.len() as f64;
    Some(
        (gaps
            .iter()
            .map(|gap| (gap - mean) * (gap - mean))
            .sum::<f64>()
            / gaps.len() as f64)
            .sqrt(),
    )
}
