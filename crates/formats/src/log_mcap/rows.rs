//! Rows from measurements that come at their own times: [`Rows`].

use stickslip_dynamics::Pose;

use crate::log_mcap::message::SECOND;
use crate::log_mcap::series::Timed;

/// Poses of object and pusher at most this far apart are one row (ns).
const MERGED: i64 = SECOND / 1000;
/// The pusher is interpolated between poses at most this far apart (ns).
const BRIDGED: i64 = SECOND / 5;
/// A tactile reading holds for this long (ns).
const HELD: i64 = SECOND / 2;

/// Times of a log, with the poses measured there.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Rows {
    /// Times (ns), rising.
    pub time: Vec<i64>,
    /// Object poses.
    pub object: Vec<Option<Pose>>,
    /// Pusher poses, measured or interpolated.
    pub pusher: Vec<Option<Pose>>,
}

/// A row in the making.
struct Row {
    time: i64,
    object: Option<Pose>,
    pusher: Option<Timed<Pose>>,
}

impl Rows {
    /// A row at every object pose and at every pusher pose that is not within 1 ms of one. Of
    /// several pusher poses about one object pose the nearest counts, of equally near ones the
    /// earlier.
    pub(crate) fn new(object: &[Timed<Pose>], pusher: &[Timed<Pose>]) -> Self {
        // a row for each object pose; a pusher pose joins the nearest one or makes its own
        let mut rows: Vec<Row> = object
            .iter()
            .map(|o| Row {
                time: o.time,
                object: Some(o.value),
                pusher: None,
            })
            .collect();
        for pose in pusher {
            match nearest(&rows[..object.len()], pose.time) {
                Some(index) => {
                    let row = &mut rows[index];
                    let nearer = |other: Timed<Pose>| {
                        (pose.time - row.time).abs() < (other.time - row.time).abs()
                    };
                    if row.pusher.is_none_or(nearer) {
                        row.pusher = Some(*pose);
                    }
                }
                None => rows.push(Row {
                    time: pose.time,
                    object: None,
                    pusher: Some(*pose),
                }),
            }
        }
        rows.sort_by_key(|row| row.time);

        // where no pusher pose was measured, it is interpolated
        Self {
            time: rows.iter().map(|row| row.time).collect(),
            object: rows.iter().map(|row| row.object).collect(),
            pusher: rows
                .iter()
                .map(|row| {
                    row.pusher
                        .map_or_else(|| between(pusher, row.time), |pose| Some(pose.value))
                })
                .collect(),
        }
    }

    /// One cell per row: whether any reading in the interval that ends there is true; without one
    /// the last reading, if it is at most 0.5 s old.
    pub(crate) fn touches(&self, readings: &[Timed<bool>]) -> Vec<Option<bool>> {
        let cell = |(start, end): (i64, i64)| {
            let (before, within) = interval(readings, start, end);
            let last = before
                .last()
                .filter(|last| end.saturating_sub(last.time) <= HELD);
            if within.is_empty() {
                last.map(|last| last.value)
            } else {
                Some(within.iter().any(|reading| reading.value))
            }
        };
        self.intervals().map(cell).collect()
    }

    /// One cell per row: the mean force over the interval that ends there (N).
    pub(crate) fn forces(&self, forces: &[Timed<[f64; 2]>]) -> Vec<Option<[f64; 2]>> {
        let cell = |(start, end): (i64, i64)| {
            let (_, within) = interval(forces, start, end);
            let mean = |axis: usize| {
                within.iter().map(|force| force.value[axis]).sum::<f64>() / within.len() as f64
            };
            (!within.is_empty()).then(|| [mean(0), mean(1)])
        };
        self.intervals().map(cell).collect()
    }

    /// The interval that ends at each row: its start, which is not in it, and its end. The first
    /// one is as long as the second; of a single row only its own time counts.
    fn intervals(&self) -> impl Iterator<Item = (i64, i64)> {
        let first = match self.time[..] {
            [first, second, ..] => first.saturating_sub(second.saturating_sub(first)),
            [first] => first.saturating_sub(1),
            [] => 0,
        };
        [first]
            .into_iter()
            .chain(self.time.iter().copied())
            .zip(self.time.iter().copied())
    }
}

/// The row nearest to `time` and within 1 ms; the earlier of equally near ones.
fn nearest(rows: &[Row], time: i64) -> Option<usize> {
    let after = rows.partition_point(|row| row.time < time);
    let candidates = after.saturating_sub(1)..rows.len().min(after + 1);
    let distance = |index: &usize| (rows[*index].time - time).abs();
    candidates
        .min_by_key(distance)
        .filter(|index| distance(index) <= MERGED)
}

/// The pose at `time` on the straight way between its neighbours, if they are near enough.
fn between(poses: &[Timed<Pose>], time: i64) -> Option<Pose> {
    let after = poses.partition_point(|pose| pose.time < time);
    let (before, after) = (poses.get(after.checked_sub(1)?)?, poses.get(after)?);
    let apart = after.time - before.time;
    (apart <= BRIDGED).then(|| {
        before
            .value
            .interpolate(after.value, (time - before.time) as f64 / apart as f64)
    })
}

/// The measurements up to `start`, and those after it up to `end`.
fn interval<T>(series: &[Timed<T>], start: i64, end: i64) -> (&[Timed<T>], &[Timed<T>]) {
    let (before, rest) = series.split_at(series.partition_point(|item| item.time <= start));
    (
        before,
        &rest[..rest.partition_point(|item| item.time <= end)],
    )
}
