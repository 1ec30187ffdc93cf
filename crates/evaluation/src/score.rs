//! Scores of an estimate against a reference: [`Scores`].
//!
//! The main score is the weighted root mean square error of the pose, √(mean(Δx² + Δy² + r_v²
//! Δθ²)), which the paper, and the scores' names after it, call WMSE.

use std::ops::Range;

use stickslip::dynamics::Pose;
use stickslip::{Camera, Estimate, Log, wrapped};
use stickslip_formats::Experiment;

use crate::belief::{Belief, Judged};

/// Standard deviation of an object position where no camera is described (m).
const POSITION_STD: f64 = 3e-4;

/// Distance below which an exact motion counts as rest (m).
const REST: f64 = 1e-5;

/// Largest offset of a row from an instant at the same time (s).
const SAME_TIME: f64 = 1e-4;

/// Time over which the final error is a mean where the reference is measured (s): one noisy pose
/// says little.
const SETTLED: f64 = 1.0;

/// Time after the reference has come to rest up to which a row still counts as in motion (s).
const AFTER_REST: f64 = 1.0;

/// The trajectory an estimate is scored against.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reference {
    /// Time of each row (s).
    pub time: Vec<f64>,
    /// Pose of each row, where there is one.
    pub pose: Vec<Option<Pose>>,
    /// Time by which its poses lag (s): the camera's latency for a log's own poses, 0 for the
    /// truth.
    pub latency: f64,
    /// Row of the first contact with the pusher, where it is known.
    pub first_pusher_contact: Option<usize>,
    /// Distance below which the reference counts as having come to rest (m).
    pub rest: f64,
    /// Standard deviations of its poses (m, m, rad); 0 for the truth.
    pub std: Pose,
    /// The final error is the mean over this time before the last pose (s); 0: that of the last
    /// pose.
    pub settled: f64,
}

impl Reference {
    /// The reference of an experiment: the truth at the log's times, linear between its rows;
    /// without a truth the log's own poses, hidden ones included.
    #[must_use]
    pub fn of(experiment: &Experiment) -> Self {
        let Experiment {
            setup,
            log,
            truth,
            facts,
        } = experiment;
        let reference = match truth {
            Some(truth) => {
                let trajectory = truth.trajectory();
                Self {
                    time: log.time.clone(),
                    pose: log.time.iter().map(|t| trajectory.pose_at(*t)).collect(),
                    latency: 0.0,
                    first_pusher_contact: None,
                    rest: REST,
                    std: Pose::default(),
                    settled: 0.0,
                }
            }
            None => Self::of_log(log, setup.camera.as_ref()),
        };
        Self {
            first_pusher_contact: facts.first_pusher_contact,
            ..reference
        }
    }

    /// The log's own poses, hidden ones included, whether there is a truth or not: the paper scores
    /// against these.
    #[must_use]
    pub fn measured(experiment: &Experiment) -> Self {
        Self {
            first_pusher_contact: experiment.facts.first_pusher_contact,
            ..Self::of_log(&experiment.log, experiment.setup.camera.as_ref())
        }
    }

    fn of_log(log: &Log, camera: Option<&Camera>) -> Self {
        let position_std = camera.map_or(POSITION_STD, |camera| camera.position_std);
        Self {
            time: log.time.clone(),
            pose: log.object.clone(),
            latency: camera.map_or(0.0, |camera| camera.latency),
            first_pusher_contact: None,
            rest: (4.0 * position_std).max(REST),
            std: camera.map_or(Pose::default(), |camera| {
                let Camera {
                    position_std,
                    orientation_std,
                    ..
                } = *camera;
                Pose::new(position_std, position_std, orientation_std)
            }),
            settled: SETTLED,
        }
    }

    /// Pose of the object at `time` (s), linear between the rows that show it then; `None` where
    /// one of the two shows no pose.
    #[must_use]
    pub fn pose_at(&self, time: f64) -> Option<Pose> {
        let shown = time + self.latency;
        let later = self.time.partition_point(|t| *t < shown - SAME_TIME);
        let after = *self.time.get(later)?;
        if after <= shown + SAME_TIME {
            return self.pose[later];
        }
        let earlier = later.checked_sub(1)?;
        let fraction = (shown - self.time[earlier]) / (after - self.time[earlier]);
        Some(self.pose[earlier]?.interpolate(self.pose[later]?, fraction))
    }
}

/// Scores of one run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scores {
    /// Weighted RMSE over all scored rows (mm).
    pub wmse_mm: Option<f64>,
    /// Weighted RMSE over the rows whose pose was hidden (mm).
    pub wmse_occluded_mm: Option<f64>,
    /// Weighted RMSE from the first pusher contact to the last motion of the reference (mm).
    pub wmse_moving_mm: Option<f64>,
    /// Weighted RMSE over the hidden rows up to 1 s after the last motion of the reference (mm).
    pub wmse_until_rest_mm: Option<f64>,
    /// Expected value of `wmse_occluded_mm` by the estimate's own standard deviations (mm): root of
    /// the mean variance over the hidden rows.
    pub spread_occluded_mm: Option<f64>,
    /// Distance of the last scored positions (mm); where the reference is measured, length of the
    /// mean error over the last second.
    pub final_error_mm: Option<f64>,
    /// Difference of the last scored angles, on the circle (degrees), or that mean of it.
    pub final_error_deg: Option<f64>,
    /// Calibration of the estimate over all scored rows.
    pub belief: Belief,
    /// Over the hidden rows.
    pub belief_occluded: Belief,
    /// Over the rows that were seen while the reference moved.
    pub belief_seen: Belief,
    /// At the last scored row.
    pub belief_final: Belief,
}

/// Scores `estimate` against `reference`; `hidden` are the rows that were occluded,
/// `virtual_radius` is r_v (m).
pub fn score(
    estimate: &Estimate,
    reference: &Reference,
    hidden: &[bool],
    virtual_radius: f64,
) -> Scores {
    let errors: Vec<Option<Error>> = (0..reference.time.len())
        .map(|row| error_at(estimate, reference, row))
        .collect();
    let moving = moving_rows(reference, virtual_radius);
    let over = |keep: &dyn Fn(usize) -> bool| {
        let kept = errors
            .iter()
            .enumerate()
            .filter(|(row, _)| keep(*row))
            .filter_map(|(_, error)| *error);
        weighted_rmse(kept, virtual_radius)
    };
    let is_hidden = |row: usize| hidden.get(row).copied().unwrap_or(false);
    let rested = reference.time.get(moving.end.saturating_sub(1));
    let on_the_way = |row| rested.is_some_and(|end| reference.time[row] <= end + AFTER_REST);
    let believed = |keep: &dyn Fn(usize) -> bool| {
        let rows = errors.iter().enumerate().filter(|(row, _)| keep(*row));
        let judged = rows.filter_map(|(row, error)| (*error)?.judged(estimate, reference, row));
        Belief::of(judged, virtual_radius)
    };
    let last = final_error(&errors, reference);
    let last_row = errors.iter().rposition(Option::is_some);
    Scores {
        wmse_mm: over(&|_| true),
        wmse_occluded_mm: over(&is_hidden),
        wmse_moving_mm: over(&|row| moving.contains(&row)),
        wmse_until_rest_mm: over(&|row| is_hidden(row) && on_the_way(row)),
        spread_occluded_mm: spread(estimate, hidden, virtual_radius),
        final_error_mm: last.map(|e| 1e3 * e.dx.hypot(e.dy)),
        final_error_deg: last.map(|e| e.turn.abs().to_degrees()),
        belief: believed(&|_| true),
        belief_occluded: believed(&is_hidden),
        belief_seen: believed(&|row| !is_hidden(row) && moving.contains(&row)),
        belief_final: believed(&|row| Some(row) == last_row),
    }
}

/// The mean error over the time before the last one in which the reference has settled.
fn final_error(errors: &[Option<Error>], reference: &Reference) -> Option<Error> {
    let end = reference.time[errors.iter().rposition(Option::is_some)?];
    let rows = errors.iter().zip(&reference.time);
    let settled = rows.filter(|(_, time)| **time >= end - reference.settled);
    let (sum, count) = settled
        .filter_map(|(error, _)| *error)
        .fold((Error::default(), 0), |(sum, count), error| {
            (sum.plus(error), count + 1)
        });
    let mean = |sum: f64| sum / f64::from(count);
    Some(Error {
        dx: mean(sum.dx),
        dy: mean(sum.dy),
        turn: mean(sum.turn),
    })
}

/// Estimate minus reference at one row.
#[derive(Clone, Copy, Debug, Default)]
struct Error {
    dx: f64,
    dy: f64,
    turn: f64,
}

impl Error {
    fn plus(self, other: Self) -> Self {
        Self {
            dx: self.dx + other.dx,
            dy: self.dy + other.dy,
            turn: self.turn + other.turn,
        }
    }

    /// The error with the estimate's standard deviations, and the reference's own noise; `None`
    /// where the estimate has none.
    fn judged(self, estimate: &Estimate, reference: &Reference, row: usize) -> Option<Judged> {
        let own = estimate.std_at(reference.time[row] - reference.latency)?;
        let noise = reference.std;
        Some(Judged {
            error: Pose::new(self.dx, self.dy, self.turn),
            std: Pose::new(
                own.x.hypot(noise.x),
                own.y.hypot(noise.y),
                own.theta.hypot(noise.theta),
            ),
        })
    }
}

fn error_at(estimate: &Estimate, reference: &Reference, row: usize) -> Option<Error> {
    let truth = reference.pose[row]?;
    let guess = estimate.pose_at(reference.time[row] - reference.latency)?;
    Some(Error {
        dx: guess.x - truth.x,
        dy: guess.y - truth.y,
        turn: wrapped(guess.theta - truth.theta),
    })
}

/// √(mean(Δx² + Δy² + r_v² Δθ²)) \[mm\]; `None` over no rows.
fn weighted_rmse(errors: impl Iterator<Item = Error>, virtual_radius: f64) -> Option<f64> {
    let eta = virtual_radius * virtual_radius;
    let (sum, count) = errors.fold((0.0, 0), |(sum, count), e| {
        (
            sum + e.dx * e.dx + e.dy * e.dy + eta * e.turn * e.turn,
            count + 1,
        )
    });
    (count > 0).then(|| 1e3 * (sum / f64::from(count)).sqrt())
}

/// Root of the mean variance over the hidden rows, angles weighted as in the error \[mm\]; `None`
/// where no row has a spread.
fn spread(estimate: &Estimate, hidden: &[bool], virtual_radius: f64) -> Option<f64> {
    let eta = virtual_radius * virtual_radius;
    let rows = estimate
        .rows
        .iter()
        .zip(hidden)
        .filter(|(_, hidden)| **hidden)
        .filter_map(|(row, _)| Some(row.spread?.pose));
    let (sum, count) = rows.fold((0.0, 0), |(sum, count), std| {
        let variance = std.x * std.x + std.y * std.y + eta * std.theta * std.theta;
        (sum + variance, count + 1)
    });
    (count > 0).then(|| 1e3 * (sum / f64::from(count)).sqrt())
}

/// Rows from the first pusher contact to the last motion of the reference.
fn moving_rows(reference: &Reference, virtual_radius: f64) -> Range<usize> {
    let seen: Vec<(usize, Pose)> = reference
        .pose
        .iter()
        .enumerate()
        .filter_map(|(row, pose)| pose.map(|p| (row, p)))
        .collect();
    let (Some(&(_, first)), Some(&(_, last))) = (seen.first(), seen.last()) else {
        return 0..0;
    };
    let away = |from: &Pose, pose: &Pose| {
        (pose.x - from.x)
            .hypot(pose.y - from.y)
            .max(virtual_radius * wrapped(pose.theta - from.theta).abs())
            > reference.rest
    };
    let starts = seen
        .iter()
        .find(|(_, pose)| away(&first, pose))
        .map(|(row, _)| *row);
    let ends = seen
        .iter()
        .rev()
        .find(|(_, pose)| away(&last, pose))
        .map_or(0, |(row, _)| row + 1);
    let start = reference.first_pusher_contact.or(starts).unwrap_or(ends);
    start..(ends + 1).max(start)
}
