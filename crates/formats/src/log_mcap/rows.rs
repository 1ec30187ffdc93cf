//! Rows from measurements that come at their own times: [`Rows`].

use stickslip_dynamics::Pose;

use crate::log_mcap::message::SECOND;
use crate::log_mcap::series::Timed;

/// Poses of object and pusher at most this far apart are one row (ns).
pub(crate) const MERGED: i64 = SECOND / 1000;
/// The pusher is interpolated between poses at most this far apart (ns).
pub(crate) const BRIDGED: i64 = SECOND / 5;
/// Longest time from one object pose to the next that counts as a camera's period (ns).
const LONGEST_PERIOD: i64 = SECOND / 5;
/// Rows of the pusher alone are no farther apart, if it was seen as often (ns).
const LONGEST_STEP: i64 = SECOND / 20;
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

impl Rows {
    /// A row at every object pose; between them and around them, where the camera sees nothing for
    /// longer, rows at pusher poses, no closer than the camera's are.
    ///
    /// A pusher pose within 1 ms of an object pose is that row's, the nearest of several and the
    /// earlier of equally near ones; else the pusher is interpolated.
    pub(crate) fn new(object: &[Timed<Pose>], pusher: &[Timed<Pose>]) -> Self {
        let mut rows = Self::default();
        let mut pusher_rows = Thinned::new(object, pusher);
        for pose in object {
            rows.push_pusher_rows(pusher_rows.until(Some(pose.time)));
            let seen = nearest(pusher, pose.time)
                .filter(|near| near.time.abs_diff(pose.time) <= MERGED.unsigned_abs())
                .map(|near| near.value);
            rows.time.push(pose.time);
            rows.object.push(Some(pose.value));
            rows.pusher
                .push(seen.or_else(|| between(pusher, pose.time)));
            pusher_rows.pass(pose.time);
        }
        rows.push_pusher_rows(pusher_rows.until(None));
        rows
    }

    fn push_pusher_rows(&mut self, poses: Vec<Timed<Pose>>) {
        for pose in poses {
            self.time.push(pose.time);
            self.object.push(None);
            self.pusher.push(Some(pose.value));
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

/// Pusher poses that make rows of their own: those in gaps of the camera, about one per period of
/// the camera.
struct Thinned<'a> {
    pusher: &'a [Timed<Pose>],
    /// Time from one object pose to the next (ns), the median, within reason.
    period: i64,
    /// Nearest that a pusher row may be to the row before and to the next object pose (ns).
    apart: i64,
    /// Time of the latest row (ns).
    last: Option<i64>,
}

impl<'a> Thinned<'a> {
    fn new(object: &[Timed<Pose>], pusher: &'a [Timed<Pose>]) -> Self {
        let own = median_step(pusher).unwrap_or(0);
        // a camera that saw one pose or none has no period: all pusher poses are rows
        let seen = median_step(object).unwrap_or(own);
        // one that saw a few poses only has a period that says nothing
        let (period, spacing) = (seen.min(LONGEST_PERIOD), seen.min(LONGEST_STEP));
        let is_fast = 2 * own <= spacing;
        Self {
            pusher,
            period,
            apart: if is_fast {
                spacing - own / 2
            } else {
                spacing / 2
            }
            .max(MERGED + 1),
            last: None,
        }
    }

    /// Passes an object pose.
    fn pass(&mut self, time: i64) {
        self.last = Some(time);
        let passed = self.pusher.partition_point(|pose| pose.time <= time);
        self.pusher = &self.pusher[passed..];
    }

    /// The pusher rows before the next object pose, or before the end.
    fn until(&mut self, next: Option<i64>) -> Vec<Timed<Pose>> {
        let mut rows = Vec::new();
        // a camera that is a little late leaves no gap
        let gap = self
            .last
            .zip(next)
            .map(|(last, next)| next.saturating_sub(last));
        if gap.is_some_and(|gap| 2 * gap <= 3 * self.period) {
            return rows;
        }
        let end = next.map_or(i64::MAX, |next| next.saturating_sub(self.apart));
        for pose in self.pusher.iter().take_while(|pose| pose.time <= end) {
            let far = |last: i64| pose.time.saturating_sub(last) >= self.apart;
            if self.last.is_none_or(far) {
                self.last = Some(pose.time);
                rows.push(*pose);
            }
        }
        rows
    }
}

/// The median time from one measurement to the next (ns).
fn median_step(series: &[Timed<Pose>]) -> Option<i64> {
    let mut steps: Vec<i64> = series
        .array_windows()
        .map(|[a, b]| b.time.saturating_sub(a.time))
        .collect();
    steps.sort_unstable();
    steps.get(steps.len() / 2).copied()
}

/// The pose nearest to `time`; the earlier of equally near ones.
fn nearest(poses: &[Timed<Pose>], time: i64) -> Option<Timed<Pose>> {
    let after = poses.partition_point(|pose| pose.time < time);
    let near = &poses[after.saturating_sub(1)..poses.len().min(after + 1)];
    near.iter()
        .copied()
        .min_by_key(|pose| pose.time.abs_diff(time))
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
