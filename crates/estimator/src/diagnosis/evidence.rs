//! What all checks share: [`Evidence`], gaps, motion and noise of a log.

use stickslip_dynamics::{Placed, Pose, Shape, narrow_phase};

use crate::log::Log;
use crate::pusher::tracked_pose::LONGEST_BRIDGE;
use crate::setup::Setup;

/// Half the time over which an object's motion is judged (s).
const HALF_WINDOW: f64 = 0.15;

/// Standard deviations above which a displacement is motion.
const MOTION: f64 = 5.0;

/// A scene and a log with what is measured on them once.
pub(super) struct Evidence<'a> {
    pub setup: &'a Setup,
    pub log: &'a Log,
    /// Noise of one object pose, estimated; `None` with too few poses.
    pub noise: Option<PoseNoise>,
    /// Rows with an object pose; between them may be rows that other sensors brought.
    pub seen: Vec<usize>,
    /// Rows in which the object moves.
    pub moving: Vec<bool>,
}

/// Standard deviations of one pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PoseNoise {
    /// Of x and y (m).
    pub position: f64,
    /// Of θ (rad).
    pub angle: f64,
}

impl<'a> Evidence<'a> {
    pub fn new(setup: &'a Setup, log: &'a Log) -> Self {
        let noise = pose_noise(&log.object);
        let mut evidence = Self {
            setup,
            log,
            noise,
            seen: (0..log.len())
                .filter(|&row| log.object[row].is_some())
                .collect(),
            moving: Vec::new(),
        };
        evidence.moving = (0..log.len()).map(|row| evidence.moves_at(row)).collect();
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
        let stated = self.setup.camera.map_or(0.0, |camera| camera.position_std);
        self.noise.map_or(0.0, |noise| noise.position).max(stated)
    }

    /// A length that is beyond noise and small on the object (m).
    pub fn tolerance(&self) -> f64 {
        (4.0 * self.position_std()).max(0.03 * self.size())
    }

    /// The measured pusher at `time`, linear between poses that are near enough.
    pub fn pusher_at(&self, time: f64) -> Option<Pose> {
        let Log {
            time: times,
            pusher,
            ..
        } = self.log;
        let split = times.partition_point(|t| *t < time);
        let pose_at = |row: usize| Some((times[row], pusher[row]?));
        let near = |row: &usize| (times[*row] - time).abs() <= LONGEST_BRIDGE;
        let (t1, after) = (split..times.len()).take_while(near).find_map(pose_at)?;
        if t1 - time < 1e-9 {
            return Some(after);
        }
        let (t0, before) = (0..split).rev().take_while(near).find_map(pose_at)?;
        (t1 - t0 <= LONGEST_BRIDGE).then(|| before.interpolate(after, (time - t0) / (t1 - t0)))
    }

    /// Gap of object and pusher at `row` if its object pose is `delay` late (m).
    pub fn pusher_gap(&self, row: usize, delay: f64) -> Option<f64> {
        let (object, pusher) = (
            self.log.object[row]?,
            self.pusher_at(self.log.time[row] - delay)?,
        );
        self.gap_to(object, &self.setup.scene.pusher.shape, pusher)
    }

    /// Gap of object and fixel `fixel` when the camera's poses of `row` were taken (m).
    pub fn fixel_gap(&self, row: usize, fixel: usize) -> Option<f64> {
        let fixel = &self.setup.scene.fixels[fixel];
        self.gap_to(self.log.object[row]?, &fixel.shape, fixel.pose)
    }

    /// Gap of the object at `object` and a body (m); negative is overlap.
    pub fn gap_to(&self, object: Pose, other: &Shape, at: Pose) -> Option<f64> {
        let mut gaps = Vec::new();
        let object = Placed::new(&self.setup.scene.object.shape, object);
        narrow_phase(&object, &Placed::new(other, at), f64::INFINITY, &mut gaps);
        gaps.iter().map(|gap| gap.gap).min_by(f64::total_cmp)
    }

    /// How far the object moves about `row`, with its turn at the radius of gyration (m).
    fn displacement(&self, row: usize) -> Option<f64> {
        let time = self.log.time[row];
        let first_from = |from: f64| self.seen.partition_point(|row| self.log.time[*row] < from);
        let before = self.mean_pose(first_from(time - HALF_WINDOW));
        let after = self.mean_pose(first_from(time + HALF_WINDOW + 1e-9).saturating_sub(1));
        // a pose from the other side of a gap tells nothing of this row
        let (t0, before) = before.filter(|(t, _)| (t - time).abs() < 2.0 * HALF_WINDOW)?;
        let (t1, after) = after.filter(|(t, _)| (t - time).abs() < 2.0 * HALF_WINDOW)?;
        let turn = self.setup.scene.object.gyration_radius() * (after.theta - before.theta);
        (t1 >= t0).then(|| (after.x - before.x).hypot(after.y - before.y).hypot(turn))
    }

    /// Mean time and pose of up to three poses about the `index`-th.
    fn mean_pose(&self, index: usize) -> Option<(f64, Pose)> {
        let rows = index.saturating_sub(1)..(index + 2).min(self.seen.len());
        let rows = self.seen.get(rows)?;
        let poses: Vec<(f64, Pose)> = rows
            .iter()
            .filter_map(|&row| self.log.object[row].map(|pose| (self.log.time[row], pose)))
            .collect();
        let mean = |pick: &dyn Fn(&(f64, Pose)) -> f64| {
            poses.iter().map(pick).sum::<f64>() / poses.len() as f64
        };
        let pose = Pose::new(mean(&|p| p.1.x), mean(&|p| p.1.y), mean(&|p| p.1.theta));
        (!poses.is_empty()).then(|| (mean(&|p| p.0), pose))
    }

    fn moves_at(&self, row: usize) -> bool {
        let Some(noise) = self.noise else {
            return false;
        };
        let turn = self.setup.scene.object.gyration_radius() * noise.angle;
        // the difference of two means of three poses
        let std = (2.0 / 3.0 * (2.0 * noise.position * noise.position + turn * turn)).sqrt();
        self.displacement(row)
            .is_some_and(|way| way > MOTION * std && way > 1e-5)
    }
}

/// Noise from second differences, which a steady motion does not change; robust to jumps and stops. Rows
/// without a pose are passed over: other sensors may bring many of them.
pub(super) fn pose_noise(poses: &[Option<Pose>]) -> Option<PoseNoise> {
    let seen: Vec<Pose> = poses.iter().flatten().copied().collect();
    let triples = || {
        let triples = seen.array_windows().map(|[a, b, c]| (*a, *b, *c));
        triples.filter(|(a, b, c)| a != b && b != c)
    };
    let std = |pick: fn(&Pose) -> f64| {
        let bends: Vec<f64> = triples()
            .map(|(a, b, c)| (pick(&a) - 2.0 * pick(&b) + pick(&c)).abs())
            .collect();
        // 1.4826 turns a median of deviations into a standard deviation; a second difference has
        // six times a pose's variance
        (bends.len() >= 10).then(|| 1.4826 * median(bends) / 6.0_f64.sqrt())
    };
    Some(PoseNoise {
        position: std(|p| p.x)?.max(std(|p| p.y)?),
        angle: std(|p| p.theta)?,
    })
}

/// The median; NaN of nothing.
pub(super) fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    quantile(values, 0.5)
}

/// The `q`-quantile, linear between order statistics: position q (n - 1) from the smallest; NaN of
/// nothing.
pub(super) fn quantile(values: impl IntoIterator<Item = f64>, q: f64) -> f64 {
    crate::quantile(&values.into_iter().collect::<Vec<_>>(), q).unwrap_or(f64::NAN)
}

/// A length in mm, as text.
pub(super) fn mm(length: f64) -> String {
    format!("{:.1} mm", 1e3 * length)
}
