//! Times when a body is out of sight: [`PoseClock`], which knows how often its poses come.

use crate::tuning::{DARK_AFTER, TELLING_INTERVALS};
/// Number of past intervals from pose to pose that are remembered.
const REMEMBERED: usize = 15;

/// Rate of the poses of object or pusher, from the rows so far.
///
/// If every row has a pose, a row without one is occluded. Other sensors may bring rows between the
/// camera's, as a pusher does that is tracked faster, or the camera's poses may come after their
/// rows. Then a row without a pose is not occluded until a pose is clearly overdue.
#[derive(Clone, Debug)]
pub(crate) struct PoseClock {
    /// Time of the latest row (s).
    now: f64,
    /// Time at which the latest pose came (s), and whether it came after its row.
    latest: f64,
    late: bool,
    /// Rows since then.
    rows: u32,
    /// Time (s) and rows from pose to pose, a ring of which `known` are written.
    intervals: [(f64, u32); REMEMBERED],
    known: usize,
}

impl PoseClock {
    /// A clock whose first pose comes at `time` (s).
    pub fn new(time: f64) -> Self {
        Self {
            now: time,
            latest: time,
            late: false,
            rows: 0,
            intervals: [(0.0, 0); REMEMBERED],
            known: 0,
        }
    }

    /// Returns the typical time from pose to pose (s), once enough of them have come.
    pub fn interval(&self) -> Option<f64> {
        let typical = self.typical().filter(|_| self.known >= TELLING_INTERVALS);
        typical.map(|(interval, _)| interval)
    }

    /// Takes a row at `time` (s), with a pose or without; returns true if the body is out of sight
    /// there.
    pub fn is_dark(&mut self, time: f64, has_pose: bool) -> bool {
        self.now = time;
        self.rows += 1;
        if has_pose {
            self.pose_came(false);
            return false;
        }
        match self.typical() {
            Some((interval, rows)) if rows > 1 || self.late => {
                time - self.latest > DARK_AFTER * interval
            }
            _ => true,
        }
    }

    /// Takes a pose of an earlier time that comes after the latest row.
    pub fn late_pose(&mut self) {
        if self.now > self.latest {
            self.pose_came(true);
        }
    }

    fn pose_came(&mut self, late: bool) {
        self.intervals[self.known % REMEMBERED] = (self.now - self.latest, self.rows);
        self.known += 1;
        (self.latest, self.late, self.rows) = (self.now, late, 0);
    }

    /// Returns the medians of the past intervals and of their rows.
    fn typical(&self) -> Option<(f64, u32)> {
        let mut intervals = self.intervals;
        let intervals = &mut intervals[..self.known.min(REMEMBERED)];
        let middle = intervals.len() / 2;
        intervals.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let interval = intervals.get(middle)?.0;
        intervals.sort_unstable_by_key(|(_, rows)| *rows);
        Some((interval, intervals[middle].1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the occluded rows among rows at 1 kHz, of which those with `has_pose` have a pose.
    fn dark(rows: usize, has_pose: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut clock = PoseClock::new(0.0);
        let mut dark = |row: &usize| clock.is_dark(1e-3 * *row as f64, has_pose(*row));
        (1..rows).filter(|row| dark(row)).collect()
    }

    #[test]
    fn a_row_without_a_pose_is_dark_where_all_others_have_one() {
        assert_eq!(
            dark(100, |row| !(40..43).contains(&row) && row != 70),
            [40, 41, 42, 70]
        );
    }

    #[test]
    fn rows_whose_poses_come_late_are_not_dark_until_one_is_overdue() {
        // each row's pose comes after it, up to row 50
        let mut clock = PoseClock::new(0.0);
        let mut dark = Vec::new();
        for row in 1..60 {
            if clock.is_dark(0.1 * f64::from(row), false) {
                dark.push(row);
            }
            if row < 50 {
                clock.late_pose();
            }
        }
        // the first interval is not known before it ends
        assert_eq!(dark, [1, 52, 53, 54, 55, 56, 57, 58, 59]);
    }

    #[test]
    fn rows_between_camera_frames_are_not_dark_until_one_is_overdue() {
        // a frame every 9 rows; the first interval is not known before it ends
        let frames = |row: usize| row.is_multiple_of(9) && !(496..700).contains(&row);
        let expected: Vec<usize> = (1..9).chain(518..702).collect();
        assert_eq!(dark(1000, frames), expected);
    }
}
