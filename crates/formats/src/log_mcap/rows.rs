//! Rows from measurements that come at their own times: [`Rows`].

use stickslip_dynamics::Pose;

use crate::log_mcap::message::SECOND;
use crate::log_mcap::series::Timed;

/// Poses of several tags at most this far apart are one pose, and a reading at most this long after
/// a step is one of its row (ns).
pub(crate) const MERGED: i64 = SECOND / 1000;
/// Transforms are interpolated between samples at most this far apart (ns).
pub(crate) const BRIDGED: i64 = SECOND / 5;
/// Time before the first and after the last pose in which readings are kept (ns).
const AROUND: i64 = SECOND;

/// Times of a log, with the measurements made there.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Rows {
    /// Times (ns), rising.
    pub time: Vec<i64>,
    /// Object poses.
    pub object: Vec<Option<Pose>>,
    /// Poses of the pusher, then of each other finger.
    pub fingers: Vec<Vec<Option<Pose>>>,
    /// Readings, one column per touch sensor.
    pub tactile: Vec<Vec<Option<bool>>>,
}

/// A measurement that may need a row of its own.
#[derive(Clone, Copy)]
enum Measured {
    Object(Pose),
    /// Finger, from 0 for the pusher, and pose.
    Finger(usize, Pose),
    /// Sensor and reading.
    Touch(usize, bool),
}

impl Rows {
    /// Every measurement in a row at its own time. Equal times, and times that are equal in
    /// seconds, are one row.
    ///
    /// A reading within 1 ms after a row that makes a step is in that row: shorter steps are none,
    /// and readings without a step do not count. Several such readings of a sensor are a touch if
    /// any of them is. Readings more than 1 s before the first pose or after the last one are left
    /// out.
    pub(crate) fn new(
        object: &[Timed<Pose>],
        fingers: &[Vec<Timed<Pose>>],
        touches: &[Vec<Timed<bool>>],
    ) -> Self {
        let mut rows = Self {
            fingers: vec![Vec::new(); fingers.len()],
            tactile: vec![Vec::new(); touches.len()],
            ..Self::default()
        };
        // the row of the latest step
        let mut step = None;
        for Timed { time, value } in measurements(object, fingers, touches) {
            let of_step = matches!(value, Measured::Touch(..))
                .then_some(step)
                .flatten()
                .filter(|row: &usize| time.saturating_sub(rows.time[*row]) <= MERGED);
            let row = of_step.unwrap_or_else(|| rows.row_at(time, value));
            match value {
                Measured::Object(pose) => {
                    rows.object[row] = Some(pose);
                    // its covariance is found by its time
                    rows.time[row] = time;
                }
                Measured::Finger(finger, pose) => rows.fingers[finger][row] = Some(pose),
                Measured::Touch(sensor, is_on) => {
                    let cell = &mut rows.tactile[sensor][row];
                    *cell = Some(is_on || *cell == Some(true));
                }
            }
            let since = step.map(|step: usize| seconds(time) - seconds(rows.time[step]));
            if since.is_none_or(|since| since >= stickslip::SHORTEST_STEP) {
                step = Some(row);
            }
        }
        rows
    }

    /// The last row if it is at `time` and its cell is free, else a new one.
    fn row_at(&mut self, time: i64, value: Measured) -> usize {
        let last = self.time.len().checked_sub(1);
        let joins = last.filter(|row| {
            let is_free = match value {
                Measured::Object(_) => self.object[*row].is_none(),
                Measured::Finger(finger, _) => self.fingers[finger][*row].is_none(),
                Measured::Touch(..) => true,
            };
            is_free && seconds(self.time[*row]) == seconds(time)
        });
        joins.unwrap_or_else(|| {
            self.time.push(time);
            self.object.push(None);
            self.fingers.iter_mut().for_each(|cells| cells.push(None));
            self.tactile.iter_mut().for_each(|cells| cells.push(None));
            self.time.len() - 1
        })
    }

    /// One cell per row: true if any reading in the interval that ends there is.
    pub(crate) fn touches(&self, readings: &[Timed<bool>]) -> Vec<Option<bool>> {
        let cell = |(start, end): (i64, i64)| {
            let within = interval(readings, start, end);
            (!within.is_empty()).then(|| within.iter().any(|reading| reading.value))
        };
        self.intervals().map(cell).collect()
    }

    /// One cell per row: the mean force over the interval that ends there (N).
    pub(crate) fn forces(&self, forces: &[Timed<[f64; 2]>]) -> Vec<Option<[f64; 2]>> {
        let cell = |(start, end): (i64, i64)| {
            let within = interval(forces, start, end);
            let mean = |axis: usize| {
                within.iter().map(|force| force.value[axis]).sum::<f64>() / within.len() as f64
            };
            (!within.is_empty()).then(|| [mean(0), mean(1)])
        };
        self.intervals().map(cell).collect()
    }

    /// Times of the first and of the last row (ns).
    pub(crate) fn ends(&self) -> Option<(i64, i64)> {
        Some((*self.time.first()?, *self.time.last()?))
    }

    /// Number of measurements in no row's interval; 0 if all of them are about the rows' time, as
    /// where topics begin and end one after the other.
    pub(crate) fn outside<T>(&self, series: &[Timed<T>]) -> usize {
        let (Some((start, _)), Some(ends)) = (self.intervals().next(), self.ends()) else {
            return series.len();
        };
        let (_, end) = ends;
        if series.iter().all(|item| is_near(item.time, ends)) {
            return 0;
        }
        let inside = series
            .iter()
            .filter(|item| item.time > start && item.time <= end);
        series.len() - inside.count()
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

/// A time (ns) in seconds, as rows have it.
pub(crate) fn seconds(time: i64) -> f64 {
    time as f64 / SECOND as f64
}

/// All measurements by time; of one time the poses come first.
fn measurements(
    object: &[Timed<Pose>],
    fingers: &[Vec<Timed<Pose>>],
    touches: &[Vec<Timed<bool>>],
) -> Vec<Timed<Measured>> {
    let (from, to) = span(object, fingers);
    let mut all = Vec::with_capacity(2 * object.len());
    all.extend(object.iter().map(|pose| pose.map(Measured::Object)));
    for (finger, poses) in fingers.iter().enumerate() {
        all.extend(
            poses
                .iter()
                .map(|pose| pose.map(|pose| Measured::Finger(finger, pose))),
        );
    }
    for (sensor, readings) in touches.iter().enumerate() {
        let near = readings
            .iter()
            .filter(|reading| is_near(reading.time, (from, to)));
        all.extend(near.map(|reading| reading.map(|is_on| Measured::Touch(sensor, is_on))));
    }
    all.sort_by_key(|measured| measured.time);
    all
}

/// Times of the first and of the last pose (ns); an empty span without any.
pub(crate) fn span(object: &[Timed<Pose>], fingers: &[Vec<Timed<Pose>>]) -> (i64, i64) {
    let ends = |series: &[Timed<Pose>]| Some((series.first()?.time, series.last()?.time));
    let fingers = fingers.iter().map(|poses| ends(poses));
    let all = std::iter::once(ends(object)).chain(fingers).flatten();
    all.fold((i64::MAX, i64::MIN), |all, own| {
        (all.0.min(own.0), all.1.max(own.1))
    })
}

/// Returns true if readings at a time are kept among poses of these times.
pub(crate) fn is_near(time: i64, (from, to): (i64, i64)) -> bool {
    time >= from.saturating_sub(AROUND) && time <= to.saturating_add(AROUND)
}

/// The measurements after `start` up to `end`.
fn interval<T>(series: &[Timed<T>], start: i64, end: i64) -> &[Timed<T>] {
    let rest = &series[series.partition_point(|item| item.time <= start)..];
    &rest[..rest.partition_point(|item| item.time <= end)]
}
