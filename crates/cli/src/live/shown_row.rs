//! Message to the live page for a row: [`ShownRow`].

use serde::Serialize;
use serde_json::value::RawValue;
use stickslip::dynamics::Pose;
use stickslip::{ParticleView, Row};

/// Most particles that are drawn.
const DRAWN: usize = 60;

/// A row as `crates/report/page/live.js` reads it: poses as x, y (m), theta (rad).
#[derive(Serialize)]
pub struct ShownRow<'a> {
    estimate: &'a RawValue,
    object: Option<[f64; 3]>,
    fingers: Vec<Option<[f64; 3]>>,
    tactile: &'a [Option<bool>],
    particles: Vec<[f64; 3]>,
    count: usize,
    missed: Option<u64>,
    collapses: u64,
    latency_ms: f64,
}

impl<'a> ShownRow<'a> {
    /// The row, the estimate's line of JSON, and how long the answer took (ms); `missed` answers
    /// were late, where there is a deadline, and the filter collapsed `collapses` times.
    pub fn new(
        row: &'a Row,
        estimate: &'a RawValue,
        particles: Option<ParticleView<'_>>,
        (latency_ms, missed, collapses): (f64, Option<u64>, u64),
    ) -> Self {
        let numbers = |pose: Pose| [pose.x, pose.y, pose.theta];
        Self {
            estimate,
            object: row.object.map(numbers),
            fingers: std::iter::once(row.pusher)
                .chain(row.other_fingers.iter().copied())
                .map(|pose| pose.map(numbers))
                .collect(),
            tactile: &row.tactile,
            particles: particles.map_or(Vec::new(), |view| drawn(&view)),
            count: particles.map_or(0, |view| view.len()),
            missed,
            collapses,
            latency_ms,
        }
    }
}

/// Particles that stand for all: those where the sum of the weights passes equal shares.
fn drawn(view: &ParticleView<'_>) -> Vec<[f64; 3]> {
    let share = 1.0 / DRAWN as f64;
    let (mut reached, mut due) = (0.0, 0.5 * share);
    let mut poses = Vec::with_capacity(DRAWN);
    for (particle, weight) in view.weights().iter().enumerate() {
        reached += weight;
        while reached > due && poses.len() < DRAWN {
            let pose = view.pose(particle);
            poses.push([pose.x, pose.y, pose.theta]);
            due += share;
        }
    }
    poses
}
