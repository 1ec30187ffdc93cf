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

    /// The measured pusher at `time`, linear between rows that are near enough.
    pub fn pusher_at(&self, time: f64) -> Option<Pose> {
        let later = self.log.time.partition_point(|t| *t < time);
        let (after, t1) = (self.log.pusher.get(later)?.as_ref()?, self.log.time[later]);
        if t1 - time < 1e-9 {
            return Some(*after);
        }
        let earlier = later.checked_sub(1)?;
        let (before, t0) = (self.log.pusher[earlier]?, self.log.time[earlier]);
        (t1 - t0 <= LONGEST_BRIDGE).then(|| before.interpolate(*after, (time - t0) / (t1 - t0)))
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

    /// How far the object moves about `row`, with its turn at the radius of gyration (m), and
    /// within what time (s).
    fn displacement(&self, row: usize) -> Option<(f64, f64)> {
        let time = self.log.time[row];
        let before = self.mean_pose(self.log.time.partition_point(|t| *t < time - HALF_WINDOW))?;
        let after = self.mean_pose(
            self.log
                .time
                .partition_point(|t| *t <= time + HALF_WINDOW)
                .saturating_sub(1),
        )?;
        let turn = self.setup.scene.object.gyration_radius() * (after.1.theta - before.1.theta);
        Some((
            (after.1.x - before.1.x)
                .hypot(after.1.y - before.1.y)
                .hypot(turn),
            after.0 - before.0,
        ))
    }

    /// Mean time and pose of up to three rows about `row`.
    fn mean_pose(&self, row: usize) -> Option<(f64, Pose)> {
        let rows = row.saturating_sub(1)..(row + 2).min(self.log.len());
        let poses: Vec<(f64, Pose)> = rows
            .filter_map(|row| self.log.object[row].map(|pose| (self.log.time[row], pose)))
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
            .is_some_and(|(way, _)| way > MOTION * std && way > 1e-5)
    }
}

/// Noise from second differences, which a steady motion does not change; robust to jumps and stops.
pub(super) fn pose_noise(poses: &[Option<Pose>]) -> Option<PoseNoise> {
    let triples = || {
        poses
            .windows(3)
            .filter_map(|w| Some((w[0]?, w[1]?, w[2]?)))
            .filter(|(a, b, c)| a != b && b != c)
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
