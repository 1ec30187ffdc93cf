//! What the camera's pose says of a particle: [`CameraLikelihood`].

use stickslip_dynamics::{Lanes, Pose};
use stickslip_filter::Block;

use crate::angle::nearest_zero;
use crate::mode::Mode;
use crate::particle::chunk::{Column, load_chunk, load_pose};
use crate::particle::columns::Columns;
use crate::particle::observation::Observation;
use crate::setup::{Camera, FilterSettings};

/// Normal likelihood of a camera pose, its standard deviations widened by `likelihood_scale`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CameraLikelihood {
    /// 1 / (scaled standard deviation): per m of position, per rad of angle.
    per_metre: f64,
    per_radian: f64,
    columns: Columns,
    /// Likelihood of a pose that is wrong, of which there are some in contact mode; that of a perfect
    /// one is 1.
    wrong: Option<f64>,
}

/// Likelihood of a wrong pose, relative to that of a perfect one.
const WRONG: f64 = 3e-7;

impl CameraLikelihood {
    pub fn new(camera: &Camera, settings: &FilterSettings, columns: Columns) -> Self {
        Self {
            per_metre: 1.0 / (settings.likelihood_scale * camera.position_std),
            per_radian: 1.0 / (settings.likelihood_scale * camera.orientation_std),
            columns,
            wrong: (columns.mode() == Mode::Contact).then_some(WRONG),
        }
    }

    /// From now on no pose is taken to be wrong, or some are again (contact mode).
    pub fn set_trust(&mut self, trusted: bool) {
        self.wrong = (self.columns.mode() == Mode::Contact && !trusted).then_some(WRONG);
    }

    /// Whether no pose is taken to be wrong, as always in paper mode.
    pub fn trusts(&self) -> bool {
        self.wrong.is_none()
    }

    /// From now on the particles have these columns.
    pub fn set_columns(&mut self, columns: Columns) {
        self.columns = columns;
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
        let shown = shown(self.columns, observation, block, chunk);
        let dx = (shown.x - measured.x) * self.per_metre;
        let dy = (shown.y - measured.y) * self.per_metre;
        let turn = nearest_zero(shown.theta - measured.theta) * self.per_radian;
        let exponent = (dx * dx + dy * dy + turn * turn) * -0.5;
        match self.wrong {
            Some(wrong) => Lanes(exponent.0.map(|e| libm::log(libm::exp(e) + wrong))),
            None => exponent,
        }
    }
}

/// The poses of one chunk's particles that the camera shows: with latency, past ones.
#[inline(always)]
pub(crate) fn shown(
    columns: Columns,
    observation: &Observation,
    block: &Block<'_>,
    chunk: usize,
) -> Pose<Column> {
    if columns.mode() == Mode::Contact {
        return shown_with_own_latency(columns, observation, block, chunk);
    }
    let Some(latency) = observation.latency else {
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

/// The same where every particle has a latency of its own: its way through the kept poses, up to the
/// time that the camera shows.
#[inline(always)]
fn shown_with_own_latency(
    columns: Columns,
    observation: &Observation,
    block: &Block<'_>,
    chunk: usize,
) -> Pose<Column> {
    let latency = load_chunk(block.column(columns.latency()), chunk, 0.0);
    let time = Lanes::splat(observation.time) - latency;
    let at = |slot: usize| load_pose(block, columns.past_pose(slot), chunk);
    let Some((last, before)) = observation.past.split_last() else {
        return load_pose(block, Columns::POSE, chunk);
    };
    // back from the latest pose: what lies before the time shown adds exactly nothing
    let mut later = (last.0, at(last.1));
    let mut shown = later.1;
    for (earlier_time, slot) in before.iter().rev() {
        let earlier = at(*slot);
        let back = (Lanes::splat(later.0) - time) * (1.0 / (later.0 - earlier_time));
        let back = back.max(Lanes::ZERO).min(Lanes::splat(1.0));
        for ((shown, to), from) in shown
            .fields_mut()
            .into_iter()
            .zip(later.1.fields())
            .zip(earlier.fields())
        {
            *shown += (*from - *to) * back;
        }
        later = (*earlier_time, earlier);
    }
    shown
}
