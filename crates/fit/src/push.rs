//! One push to learn from: [`Push`], and made ready for predictions, [`PreparedPush`].

use stickslip::diagnosis::untouched;
use stickslip::{Log, NominalPrediction, NominalPredictor, Schedule, Setup, wrapped};
use stickslip_dynamics::Pose;

use crate::error::FitError;

/// Most poses of one push that are compared with its prediction, evenly over those measured: more
/// say the same again.
const MOST_POSES: usize = 60;

/// Position noise of a camera that the scene does not describe (m).
const POSITION_STD: f64 = 3e-4;

/// Orientation noise of such a camera (rad).
const ORIENTATION_STD: f64 = 5e-3;

/// No camera is better than this (m).
const LEAST_NOISE: f64 = 1e-6;

/// A recorded push.
#[derive(Clone, Debug)]
pub struct Push {
    /// Its name.
    pub name: String,
    /// Scene, sensors and their uncertainty.
    pub setup: Setup,
    /// The log.
    pub log: Log,
}

impl Push {
    /// Returns true if both are pushes of one object: outline, mass, moment of inertia and feet
    /// are equal in their scenes.
    fn is_of_object_of(&self, other: &Self) -> bool {
        let [one, other] = [self, other].map(|push| &push.setup.scene);
        let [a, b] = [one, other].map(|scene| (scene.object.mass, scene.object.inertia));
        let [shape, other_shape] = [one, other].map(|scene| scene.object.shape.parts());
        a == b && shape == other_shape && one.feet == other.feet
    }
}

/// The pushes of each object, as indices; objects are in the order of their first pushes. Two
/// pushes have one object if outline, mass, moment of inertia and feet are equal in their scenes.
#[must_use]
pub fn by_object(pushes: &[Push]) -> Vec<Vec<usize>> {
    let mut objects: Vec<Vec<usize>> = Vec::new();
    for (k, push) in pushes.iter().enumerate() {
        let known = |object: &&mut Vec<usize>| push.is_of_object_of(&pushes[object[0]]);
        match objects.iter_mut().find(known) {
            Some(object) => object.push(k),
            None => objects.push(vec![k]),
        }
    }
    objects
}

/// A push with all that no parameter changes.
#[derive(Clone, Debug)]
pub(crate) struct PreparedPush {
    pub push: Push,
    /// Predicts it blind.
    pub predictor: NominalPredictor,
    /// The poses that predictions are compared with, with their rows.
    pub measured: Vec<(usize, Pose)>,
    /// Way of the pusher up to each row (m), turns as way at the object's radius of gyration.
    pub travelled: Vec<f64>,
}

/// Time at which a measured pose was taken, between two rows of a prediction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Instant {
    /// The row before.
    pub row: usize,
    /// Share of the way to the next one, 0 to 1.
    pub fraction: f64,
    /// Way of the pusher until then (m).
    pub travelled: f64,
}

impl PreparedPush {
    pub fn new(push: Push) -> Result<Self, FitError> {
        let Push { name, setup, log } = &push;
        if setup.scene.pusher.fingers.len() > 1 {
            return Err(FitError::Hand { push: name.clone() });
        }
        if let Some(finding) = untouched(setup, log) {
            let (push, found) = (name.clone(), finding.found);
            return Err(FitError::Untouched { push, found });
        }
        let predictor = NominalPredictor::new(setup, log);
        let predictor = predictor.map_err(|source| FitError::Run {
            push: name.clone(),
            source,
        })?;
        let poses = log.object.iter().enumerate().skip(predictor.first + 1);
        let seen = poses.filter_map(|(row, pose)| Some((row, (*pose)?)));
        let measured = thinned(&seen.collect::<Vec<_>>());
        if measured.is_empty() {
            return Err(FitError::NoPose { push: name.clone() });
        }
        Ok(Self {
            travelled: travelled(predictor.schedule(), log.len(), setup.virtual_radius()),
            predictor,
            measured,
            push,
        })
    }

    /// Noise of one measured position (m) and, at the radius of gyration, of one measured angle
    /// (m), as the scene says.
    pub fn noise(&self) -> [f64; 2] {
        let camera = self.push.setup.camera;
        let [position, angle] = camera.map_or([POSITION_STD, ORIENTATION_STD], |camera| {
            [camera.position_std, camera.orientation_std]
        });
        let angle = angle * self.push.setup.virtual_radius();
        [position, angle].map(|std| std.max(LEAST_NOISE))
    }

    /// Time by which object poses lag (s).
    pub fn latency(&self) -> f64 {
        self.push.setup.camera.map_or(0.0, |camera| camera.latency)
    }

    /// Measured minus predicted poses, angles times the radius of gyration (m).
    pub fn residuals(&self, instants: &[Instant], prediction: &NominalPrediction) -> Vec<[f64; 3]> {
        let radius = self.push.setup.virtual_radius();
        let residual = |((_, measured), instant): (&(usize, Pose), &Instant)| {
            let predicted = instant.pose(prediction, self.predictor.first);
            let turn = wrapped(measured.theta - predicted.theta);
            [
                measured.x - predicted.x,
                measured.y - predicted.y,
                radius * turn,
            ]
        };
        self.measured.iter().zip(instants).map(residual).collect()
    }

    /// Times at which the measured poses were taken, corrected for latency; not before the first
    /// row.
    pub fn instants(&self, latency: f64) -> Vec<Instant> {
        let time = &self.push.log.time;
        let instant = |(row, _): &(usize, Pose)| {
            let shown = (time[*row] - latency).max(time[self.predictor.first]);
            let row = time.partition_point(|t| *t <= shown).saturating_sub(1);
            let row = row.clamp(self.predictor.first, time.len() - 2);
            let fraction = (shown - time[row]) / (time[row + 1] - time[row]);
            let [from, to] = [self.travelled[row], self.travelled[row + 1]];
            Instant {
                row,
                fraction,
                travelled: from + fraction * (to - from) - self.travelled[self.predictor.first],
            }
        };
        self.measured.iter().map(instant).collect()
    }
}

impl Instant {
    /// The pose that `prediction` has then, linear between rows; its first row is `first`.
    fn pose(&self, prediction: &NominalPrediction, first: usize) -> Pose {
        let [from, to] = [0, 1].map(|k| prediction.poses[self.row - first + k]);
        from.interpolate(to, self.fraction)
    }
}

/// At most [`MOST_POSES`] of `poses`, evenly, the last one among them.
fn thinned(poses: &[(usize, Pose)]) -> Vec<(usize, Pose)> {
    let kept = poses.len().min(MOST_POSES);
    (1..=kept)
        .map(|k| poses[k * poses.len() / kept - 1])
        .collect()
}

/// Way of the pusher up to each of `rows` rows (m); a standing one's tracking noise is none.
fn travelled(schedule: &Schedule, rows: usize, radius: f64) -> Vec<f64> {
    let mut sum = 0.0;
    let mut travelled = vec![0.0];
    for row in 0..rows.saturating_sub(1) {
        if schedule.driven(row) {
            for input in schedule.step(row) {
                let Some(pusher) = &input.pusher else {
                    continue;
                };
                let twist = pusher[0].twist;
                let speed = libm::hypot(libm::hypot(twist.vx, twist.vy), radius * twist.omega);
                sum += speed * input.h;
            }
        }
        travelled.push(sum);
    }
    travelled
}
