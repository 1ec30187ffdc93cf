//! One recorded experiment: [`Log`], columns of equal length, one row per camera frame.

use stickslip_dynamics::{Pose, Scene};

use crate::covariance::PoseCovariance;
use crate::error::RunError;
use crate::pose_clock::PoseClock;
use crate::quantile::quantile;
use crate::row::{LONGEST_PAUSE, Row, unit_of_times};

/// A recorded experiment; every column has one entry per row, `None` where nothing was measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// Time (s), strictly rising.
    pub time: Vec<f64>,
    /// Measured object poses.
    pub object: Vec<Option<Pose>>,
    /// Covariance of each object pose; `None`: the noise of the scene's camera. The column is empty
    /// if the log has no covariances.
    pub object_covariance: Vec<Option<PoseCovariance>>,
    /// Measured poses of the pusher, or of the first finger of a hand.
    pub pusher: Vec<Option<Pose>>,
    /// Measured poses of the hand's other fingers: one column for each.
    pub other_fingers: Vec<Vec<Option<Pose>>>,
    /// Tactile readings over the interval that ends at the row: one column per sensor of a fixel,
    /// then one per sensor of a hand's finger.
    pub tactile: Vec<Vec<Option<bool>>>,
    /// Force of the pusher, or of all fingers of a hand together, on the object, world frame (N);
    /// empty where the log has no force columns.
    pub force: Vec<Option<[f64; 2]>>,
}

impl Log {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Time from the first row to the last (s); 0 where there is none.
    pub fn duration(&self) -> f64 {
        self.time.last().copied().unwrap_or(0.0) - self.time.first().copied().unwrap_or(0.0)
    }

    /// Cuts the log off after `rows` rows; a shorter one stays as it is.
    pub fn truncate(&mut self, rows: usize) {
        self.time.truncate(rows);
        self.object.truncate(rows);
        self.object_covariance.truncate(rows);
        self.pusher.truncate(rows);
        for finger in &mut self.other_fingers {
            finger.truncate(rows);
        }
        for sensor in &mut self.tactile {
            sensor.truncate(rows);
        }
        self.force.truncate(rows);
    }

    /// For each row, true if the camera does not see the object. A row between its poses that
    /// another sensor brought does not count.
    #[must_use]
    pub fn object_out_of_sight(&self) -> Vec<bool> {
        out_of_sight(&self.time, &self.object)
    }

    /// For each row, true if a finger of the pusher is not seen. A row between its poses that
    /// another sensor brought does not count.
    #[must_use]
    pub fn pusher_out_of_sight(&self) -> Vec<bool> {
        let mut hidden = out_of_sight(&self.time, &self.pusher);
        for finger in &self.other_fingers {
            let finger = out_of_sight(&self.time, finger);
            for (hidden, finger) in hidden.iter_mut().zip(finger) {
                *hidden |= finger;
            }
        }
        hidden
    }

    /// Measured poses of each finger: of the pusher, then of a hand's other fingers.
    pub fn fingers(&self) -> impl Iterator<Item = &[Option<Pose>]> {
        let others = self.other_fingers.iter().map(Vec::as_slice);
        std::iter::once(&self.pusher[..]).chain(others)
    }

    /// Measured pose of each finger at a row, none past the end.
    pub fn fingers_at(&self, row: usize) -> Vec<Option<Pose>> {
        let fingers = self.fingers();
        fingers
            .map(|poses| poses.get(row).copied().flatten())
            .collect()
    }

    /// Returns the measurements of row `row`.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, row: usize) -> Row {
        Row {
            time: self.time[row],
            object: self.object[row],
            object_covariance: self.object_covariance.get(row).copied().flatten(),
            pusher: self.pusher[row],
            other_fingers: self.other_fingers.iter().map(|poses| poses[row]).collect(),
            tactile: self.tactile.iter().map(|sensor| sensor[row]).collect(),
            force: self.force.get(row).copied().flatten(),
        }
    }

    /// Refuses a log that no method can use: columns of unequal length, more sensors or other
    /// fingers than the scene's, times that do not rise or pause too long, impossible numbers.
    pub(crate) fn check(&self, scene: &Scene) -> Result<(), RunError> {
        self.check_columns()?;
        let (found, fingers) = (self.other_fingers.len(), scene.pusher.fingers.len());
        if found + 1 != fingers {
            let fingers = fingers - 1;
            return Err(RunError::Fingers { found, fingers });
        }
        let sensors = self.tactile.len();
        if sensors > scene.sensors() {
            let fixels = scene.fixels.len();
            return Err(RunError::Sensors {
                sensors,
                fixels,
                fingers,
            });
        }
        for row in 0..self.len() {
            let problem = |problem| RunError::LogRow { row, problem };
            self.row(row).check(scene).map_err(problem)?;
            let Some(before) = row.checked_sub(1) else {
                continue;
            };
            let (from, to) = (self.time[before], self.time[row]);
            if to <= from {
                return Err(RunError::Order { row, from, to });
            }
            if to - from > LONGEST_PAUSE {
                let unit = self.unit_of_times();
                return Err(RunError::Pause {
                    row,
                    from,
                    to,
                    unit,
                });
            }
        }
        Ok(())
    }

    /// Returns the unit that the log's times seem to be in, if that is not the second.
    fn unit_of_times(&self) -> Option<&'static str> {
        let steps: Vec<f64> = self.time.array_windows().map(|[a, b]| b - a).collect();
        unit_of_times(quantile(&steps, 0.5)?)
    }

    fn check_columns(&self) -> Result<(), RunError> {
        let rows = self.len();
        let mut columns = vec![
            ("object".to_owned(), self.object.len()),
            ("pusher".to_owned(), self.pusher.len()),
        ];
        let fingers = self.other_fingers.iter().zip(1..);
        columns.extend(fingers.map(|(column, k)| (format!("finger {k}"), column.len())));
        let tactile = self.tactile.iter().zip(1..);
        columns.extend(tactile.map(|(column, k)| (format!("tactile {k}"), column.len())));
        let optional = [
            ("object_covariance".to_owned(), self.object_covariance.len()),
            ("force".to_owned(), self.force.len()),
        ];
        columns.extend(optional.into_iter().filter(|(_, entries)| *entries > 0));
        match columns.into_iter().find(|(_, entries)| *entries != rows) {
            None => Ok(()),
            Some((column, entries)) => Err(RunError::Columns {
                column,
                entries,
                rows,
            }),
        }
    }

    /// Returns true if there is no row.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }
}

/// For each row, true if a body with these poses is out of sight.
fn out_of_sight(time: &[f64], poses: &[Option<Pose>]) -> Vec<bool> {
    let mut clock = PoseClock::new(time.first().copied().unwrap_or(0.0));
    let rows = time.iter().zip(poses);
    rows.map(|(time, pose)| clock.is_dark(*time, pose.is_some()))
        .collect()
}
