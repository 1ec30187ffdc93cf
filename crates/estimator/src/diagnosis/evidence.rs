//! Measurements that all checks share: [`Evidence`], with gaps, motion and noise of a log.

use stickslip_dynamics::{Placed, Pose, Shape};

use super::lasting::Lasting;
use super::pose_noise::PoseNoise;
use super::two_places::TwoPlaces;
use crate::angle::nearest_winding;
use crate::gap::gap;
use crate::log::Log;
use crate::pusher::tracked_pose::bridged;
use crate::setup::Setup;
use crate::tuning::TELLING_INTERVALS;

/// Half the time over which an object's motion is judged (s).
pub(super) const HALF_WINDOW: f64 = 0.15;

/// Standard deviations above which a displacement is motion.
const MOTION: f64 = 5.0;

/// Least speed before a row and after it, as a share of the speed over both together, at which the
/// row lies within a motion.
const GOES_ON: f64 = 0.5;

/// Least share of the time of a motion over which that speed is judged.
const LEAST_SHARE: f64 = 0.25;

/// A scene and a log, with what is measured on them once.
pub(super) struct Evidence<'a> {
    pub setup: &'a Setup,
    /// The log with angles unwrapped, see [`unwrapped`].
    pub log: &'a Log,
    /// Noise of one object pose, estimated; `None` with too few poses.
    pub noise: Option<PoseNoise>,
    /// Noise of one pusher pose, estimated; `None` with too few poses.
    pub pusher_noise: Option<PoseNoise>,
    /// Two places between which object poses go back and forth.
    pub two_places: Option<TwoPlaces>,
    /// Errors of the camera that last over several rows.
    pub lasting: Option<Lasting>,
    /// Rows with an object pose; between them may be rows that other sensors brought.
    pub seen: Vec<usize>,
    /// Rows with a pusher pose.
    pusher_seen: Vec<usize>,
    /// Typical time from one pusher pose to the next (s); `None` with too few poses.
    pusher_interval: Option<f64>,
    /// Rows in which the object moves.
    pub moving: Vec<bool>,
}

impl<'a> Evidence<'a> {
    pub fn new(setup: &'a Setup, log: &'a Log) -> Self {
        let noise = PoseNoise::of(&log.time, &log.object);
        let rows_with = |poses: &[Option<Pose>]| {
            let rows = 0..poses.len();
            rows.filter(|row| poses[*row].is_some()).collect()
        };
        let pusher_seen: Vec<usize> = rows_with(&log.pusher);
        let steps = pusher_seen.array_windows();
        let steps: Vec<f64> = steps.map(|[a, b]| log.time[*b] - log.time[*a]).collect();
        let mut evidence = Self {
            setup,
            log,
            noise,
            pusher_noise: PoseNoise::of(&log.time, &log.pusher),
            two_places: None,
            lasting: None,
            seen: rows_with(&log.object),
            pusher_seen,
            pusher_interval: crate::quantile(&steps, 0.5)
                .filter(|_| steps.len() >= TELLING_INTERVALS),
            moving: Vec::new(),
        };
        evidence.two_places = TwoPlaces::of(&evidence);
        evidence.lasting = Lasting::of(&evidence);
        evidence.moving = evidence.moving();
        evidence
    }

    /// Radius of the object about its centre of mass (m).
    pub fn size(&self) -> f64 {
        self.setup.scene.object.shape.bounding_radius()
    }

    /// The camera's latency as the scene has it (s).
    pub fn latency(&self) -> f64 {
        self.setup.camera.map_or(0.0, |camera| camera.latency)
    }

    /// Standard deviation of one position: the greater of the measured and the stated one (m).
    pub fn position_std(&self) -> f64 {
        self.pose_std().position
    }

    /// Standard deviation of a gap by the noise of the object's pose, with its turn at the radius
    /// of gyration (m).
    pub fn gap_std(&self) -> f64 {
        let gyration = self.setup.scene.object.gyration_radius();
        let noise = self.pose_std();
        noise.position.hypot(gyration * noise.angle)
    }

    /// A length that is beyond noise and small on the object (m).
    pub fn tolerance(&self) -> f64 {
        (4.0 * self.position_std()).max(0.03 * self.size())
    }

    /// The measured pusher at `time`, linear between poses that are near enough.
    pub fn pusher_at(&self, time: f64) -> Option<Pose> {
        let seen = &self.pusher_seen;
        let split = seen.partition_point(|row| self.log.time[*row] < time);
        let at = |index: usize| {
            let row = *seen.get(index)?;
            Some((self.log.time[row], self.log.pusher[row]?))
        };
        let (t1, after) = at(split)?;
        if t1 - time < 1e-9 {
            return Some(after);
        }
        let (t0, before) = at(split.checked_sub(1)?)?;
        bridged(t0, t1, self.pusher_interval)
            .then(|| before.interpolate(after, (time - t0) / (t1 - t0)))
    }

    /// Gap of object and pusher at `row` if its object pose is `delay` late (m); of a hand that of
    /// the nearest finger.
    pub fn pusher_gap(&self, row: usize, delay: f64) -> Option<f64> {
        self.changed_gap(row, delay, |object, pusher| (object, pusher))
    }

    /// That gap with the poses of object and finger changed.
    pub fn changed_gap(
        &self,
        row: usize,
        delay: f64,
        change: impl Fn(Pose, Pose) -> (Pose, Pose),
    ) -> Option<f64> {
        let time = self.log.time[row] - delay;
        let object = self.log.object[row]?;
        let gap_to = |shape: &Shape, finger: Pose| {
            let (object, finger) = change(object, finger);
            self.gap_to(object, shape, finger)
        };
        let (first, others) = self.setup.scene.pusher.fingers.split_first()?;
        let mut gap = gap_to(first, self.pusher_at(time)?)?;
        for (shape, poses) in others.iter().zip(&self.log.other_fingers) {
            gap = gap.min(gap_to(shape, self.at(poses, time)?)?);
        }
        Some(gap)
    }

    /// A finger at `time` by its `poses`, linear between those about it.
    fn at(&self, poses: &[Option<Pose>], time: f64) -> Option<Pose> {
        let split = self.log.time.partition_point(|t| *t < time);
        let after = (split..poses.len()).find_map(|row| Some((self.log.time[row], poses[row]?)));
        let before = (0..split)
            .rev()
            .find_map(|row| Some((self.log.time[row], poses[row]?)));
        match (before, after) {
            (_, Some((t1, after))) if t1 - time < 1e-9 => Some(after),
            (Some((t0, before)), Some((t1, after))) => bridged(t0, t1, self.pusher_interval)
                .then(|| before.interpolate(after, (time - t0) / (t1 - t0))),
            _ => None,
        }
    }

    /// Gap of object and fixel `fixel` when the camera's poses of `row` were taken (m).
    pub fn fixel_gap(&self, row: usize, fixel: usize) -> Option<f64> {
        let fixel = &self.setup.scene.fixels[fixel];
        self.gap_to(self.log.object[row]?, &fixel.shape, fixel.pose)
    }

    /// Gap of the object at `object` and a body (m); negative is overlap.
    pub fn gap_to(&self, object: Pose, other: &Shape, at: Pose) -> Option<f64> {
        let object = Placed::new(&self.setup.scene.object.shape, object);
        gap(&object, &Placed::new(other, at))
    }

    /// Returns the object's way about a row with a pose: from before it to after it, and from
    /// before it to the row.
    fn way(&self, row: usize) -> Option<(Way, Way)> {
        let time = self.log.time[row];
        let first_from = |from: f64| self.seen.partition_point(|row| self.log.time[*row] < from);
        let before = self.mean_pose(first_from(time - HALF_WINDOW));
        let here = self.mean_pose(first_from(time))?;
        let after = self.mean_pose(first_from(time + HALF_WINDOW + 1e-9).saturating_sub(1));
        // a pose from the other side of a gap tells nothing of this row
        let before = before.filter(|(t, _)| (t - time).abs() < 2.0 * HALF_WINDOW)?;
        let after = after.filter(|(t, _)| (t - time).abs() < 2.0 * HALF_WINDOW)?;
        let gyration = self.setup.scene.object.gyration_radius();
        let way = |to: (f64, Pose)| Way {
            seconds: to.0 - before.0,
            metres: [
                to.1.x - before.1.x,
                to.1.y - before.1.y,
                gyration * (to.1.theta - before.1.theta),
            ],
        };
        (after.0 >= before.0).then(|| (way(after), way(here)))
    }

    /// Mean time and pose of up to three poses about the `index`-th, none of them from beyond a
    /// gap.
    fn mean_pose(&self, index: usize) -> Option<(f64, Pose)> {
        let middle = self.log.time[*self.seen.get(index)?];
        let rows = index.saturating_sub(1)..(index + 2).min(self.seen.len());
        let poses: Vec<(f64, Pose)> = self.seen[rows]
            .iter()
            .filter_map(|&row| Some((self.log.time[row], self.log.object[row]?)))
            .filter(|(time, _)| (time - middle).abs() < 2.0 * HALF_WINDOW)
            .collect();
        let mean = |pick: &dyn Fn(&(f64, Pose)) -> f64| {
            poses.iter().map(pick).sum::<f64>() / poses.len() as f64
        };
        let pose = Pose::new(mean(&|p| p.1.x), mean(&|p| p.1.y), mean(&|p| p.1.theta));
        (!poses.is_empty()).then(|| (mean(&|p| p.0), pose))
    }

    /// Returns true for rows in which the object moves. It moves in a short gap if it moves on both
    /// sides of it.
    fn moving(&self) -> Vec<bool> {
        let mut moving = vec![false; self.log.len()];
        for &row in &self.seen {
            moving[row] = self.moves_at(row);
        }
        for &[from, to] in self.seen.array_windows() {
            let is_short = self.log.time[to] - self.log.time[from] < 4.0 * HALF_WINDOW;
            let moves = is_short && moving[from] && moving[to];
            moving[from + 1..to].fill(moves);
        }
        moving
    }

    /// Returns true if the object's way about `row` is beyond noise, and `row` lies within it. An
    /// object that is touched a little later, or stopped a little before, rests.
    fn moves_at(&self, row: usize) -> bool {
        let Some(std) = self.way_std() else {
            return false;
        };
        let moves = |(whole, first): &(Way, Way)| {
            let length = whole.dot(whole).sqrt();
            length > MOTION * std && length > 1e-5 && first.is_within(whole)
        };
        self.way(row).as_ref().is_some_and(moves)
    }

    /// Standard deviation of a way that noise alone makes (m).
    fn way_std(&self) -> Option<f64> {
        // the difference of two means of three poses, which are no better than one where errors
        // last
        let (noise, poses) = match self.lasting {
            Some(Lasting { wander, .. }) => (wander.max(self.stated()), 1.0),
            None => (self.noise?, 3.0),
        };
        let turn = self.setup.scene.object.gyration_radius() * noise.angle;
        Some((2.0 / poses * (2.0 * noise.position * noise.position + turn * turn)).sqrt())
    }

    /// Standard deviations of one pose: the greater of the measured and the stated one.
    fn pose_std(&self) -> PoseNoise {
        let stated = self.stated();
        self.noise.map_or(stated, |noise| noise.max(stated))
    }

    /// Noise that the scene states.
    pub fn stated(&self) -> PoseNoise {
        let camera = self.setup.camera.as_ref();
        PoseNoise {
            position: camera.map_or(0.0, |camera| camera.position_std),
            angle: camera.map_or(0.0, |camera| camera.orientation_std),
        }
    }
}

/// The log with every angle at the winding nearest to the one before.
pub(super) fn unwrapped(log: &Log) -> Log {
    let unwrapped = |poses: &[Option<Pose>]| {
        let mut near = None;
        let pose = |pose: &Option<Pose>| {
            let pose = (*pose)?;
            let theta = near.map_or(pose.theta, |near| nearest_winding(pose.theta, near));
            near = Some(theta);
            Some(Pose { theta, ..pose })
        };
        poses.iter().map(pose).collect()
    };
    Log {
        object: unwrapped(&log.object),
        pusher: unwrapped(&log.pusher),
        other_fingers: log
            .other_fingers
            .iter()
            .map(|poses| unwrapped(poses))
            .collect(),
        ..log.clone()
    }
}

/// Way that the object covers, and its duration.
struct Way {
    seconds: f64,
    /// Displacement along x and y, and the turn at the radius of gyration (m).
    metres: [f64; 3],
}

impl Way {
    fn dot(&self, other: &Self) -> f64 {
        let pairs = self.metres.iter().zip(&other.metres);
        pairs.map(|(a, b)| a * b).sum()
    }

    /// Returns true if this first part of `whole` neither only begins it nor all but ends it.
    fn is_within(&self, whole: &Self) -> bool {
        let (time, length) = (
            self.seconds / whole.seconds,
            self.dot(whole) / whole.dot(whole),
        );
        let goes_on = |time: f64, length: f64| time < LEAST_SHARE || length > GOES_ON * time;
        goes_on(time, length) && goes_on(1.0 - time, 1.0 - length)
    }
}

/// Returns the median; NaN if there is no number.
pub(super) fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    quantile(values, 0.5)
}

/// Returns the `q`-quantile, linear between order statistics: position q (n - 1) from the smallest;
/// NaN if there is no number.
pub(super) fn quantile(values: impl IntoIterator<Item = f64>, q: f64) -> f64 {
    crate::quantile(&values.into_iter().collect::<Vec<_>>(), q).unwrap_or(f64::NAN)
}

/// A length in mm, as text.
pub(super) fn mm(length: f64) -> String {
    // no minus sign before a rounded zero
    let tenths = (1e4 * length).round() + 0.0;
    format!("{:.1} mm", tenths / 10.0)
}
