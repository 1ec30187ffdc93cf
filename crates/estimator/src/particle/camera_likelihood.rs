//! What the camera's pose says of a particle: [`CameraLikelihood`].

use stickslip_dynamics::Pose;
use stickslip_filter::Block;

use crate::angle::nearest_zero;
use crate::particle::chunk::{Column, load_pose};
use crate::particle::columns::Columns;
use crate::particle::observation::{LatencyCompensation, Observation};
use crate::setup::{Camera, FilterSettings};

/// Normal likelihood of a camera pose, its standard deviations widened by `likelihood_scale`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CameraLikelihood {
    /// 1 / (scaled standard deviation): per m of position, per rad of angle.
    per_metre: f64,
    per_radian: f64,
    columns: Columns,
}

impl CameraLikelihood {
    pub fn new(camera: &Camera, settings: &FilterSettings, columns: Columns) -> Self {
        Self {
            per_metre: 1.0 / (settings.likelihood_scale * camera.position_std),
            per_radian: 1.0 / (settings.likelihood_scale * camera.orientation_std),
            columns,
        }
    }

    /// log-likelihood of the camera's pose given one chunk's particles, up to a constant; 0 where
    /// there is none.
    #[inline(always)]
    pub fn log_likelihood(
        &self,
        observation: &Observation,
        block: &Block<'_>,
        chunk: usize,
    ) -> Column {
        let Some(measured) = observation.pose else {
            return Column::ZERO;
        };
        let shown = shown(self.columns, observation.latency, block, chunk);
        let dx = (shown.x - measured.x) * self.per_metre;
        let dy = (shown.y - measured.y) * self.per_metre;
        let turn = nearest_zero(shown.theta - measured.theta) * self.per_radian;
        (dx * dx + dy * dy + turn * turn) * -0.5
    }
}

/// The poses of one chunk's particles that the camera shows: with latency, past ones.
#[inline(always)]
pub(crate) fn shown(
    columns: Columns,
    latency: Option<LatencyCompensation>,
    block: &Block<'_>,
    chunk: usize,
) -> Pose<Column> {
    let Some(latency) = latency else {
        return load_pose(block, Columns::POSE, chunk);
    };
    let earlier = load_pose(block, columns.past_pose(latency.earlier), chunk);
    let later = load_pose(block, columns.past_pose(latency.later), chunk);
    let mut shown = earlier;
    for (shown, later) in shown.fields_mut().into_iter().zip(later.fields()) {
        *shown += (*later - *shown) * latency.fraction;
    }
    shown
}
