//! Likelihood of the camera's pose given a particle: [`CameraLikelihood`].

use stickslip_dynamics::{Lanes, Pose};
use stickslip_filter::{Block, BlockMut};

use crate::angle::nearest_zero;
use crate::filter_model::FilterModel;
use crate::particle::sensor::camera_noise::{CameraNoise, NoisePrior};
use crate::particle::sensor::observation::Observation;
use crate::particle::set::chunk::{Column, load_chunk, load_pose};
use crate::particle::set::columns::Columns;
use crate::particle::unknown::table::Name;
use crate::setup::{Camera, Setup};
use crate::tuning::WRONG;
use crate::uncertainty::Uncertainty;

/// Likelihood of a camera pose: normal, with the row's own covariance or the camera's, the standard
/// deviations widened by `likelihood_scale`. In the robust model the noise is learned, and the
/// likelihood has a floor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CameraLikelihood {
    /// 1 / (scaled standard deviation): per m of position, per rad of angle.
    per_metre: f64,
    per_radian: f64,
    /// Factor by which both are widened.
    widened: f64,
    columns: Columns,
    latency: Latency,
    /// Prior of the noise (robust model).
    noise: Option<NoisePrior>,
    /// Likelihood of a pose that is wrong (robust model); that of a perfect one is 1.
    wrong: Option<f64>,
}

/// Squared distances of a measured pose from what particles show, in units of the nominal standard
/// deviations.
#[derive(Clone, Copy, Debug)]
struct Residual {
    position: Column,
    angle: Column,
}

impl CameraLikelihood {
    pub fn new(camera: &Camera, setup: &Setup, columns: Columns) -> Self {
        let settings = &setup.filter;
        let contact = columns.model() == FilterModel::Robust;
        let noise = NoisePrior::new(setup.uncertainty.camera_noise);
        Self {
            per_metre: 1.0 / (settings.likelihood_scale * camera.position_std),
            per_radian: 1.0 / (settings.likelihood_scale * camera.orientation_std),
            widened: settings.likelihood_scale,
            columns,
            latency: Latency {
                nominal: camera.latency,
                uncertainty: setup.uncertainty,
            },
            noise: noise.filter(|_| contact),
            wrong: contact.then_some(WRONG),
        }
    }

    /// Accepts all poses from now on, or allows again that some are wrong (robust model).
    pub fn accept_poses(&mut self, all: bool) {
        self.wrong = (self.columns.model() == FilterModel::Robust && !all).then_some(WRONG);
    }

    /// Returns true if no pose is taken to be wrong, as always in the paper's model.
    pub fn accepts_all(&self) -> bool {
        self.wrong.is_none()
    }

    /// Returns the probability that a pose is not wrong, given ln of the mean of its likelihoods,
    /// (37).
    pub fn right(&self, log_evidence: f64) -> f64 {
        let wrong = self.wrong.unwrap_or(0.0);
        (1.0 - wrong / libm::exp(log_evidence)).max(0.0)
    }

    /// Sets the columns that the particles have from now on.
    pub fn set_columns(&mut self, columns: Columns) {
        self.columns = columns;
    }

    /// Returns the log-likelihood of the camera's pose given one chunk's particles, up to a
    /// constant; 0 if there is none.
    #[inline(always)]
    pub fn log_likelihood(
        &self,
        observation: &Observation,
        block: &Block<'_>,
        chunk: usize,
    ) -> Column {
        let Some(residual) = self.residual(observation, block, chunk) else {
            return Column::ZERO;
        };
        let right = self.of_right_pose(&residual, block, chunk);
        match self.wrong {
            Some(wrong) => (right.exp() + Lanes::splat(wrong)).ln(),
            None => right,
        }
    }

    /// Lets the particles learn the camera's noise from a pose that weighed them.
    #[inline(always)]
    pub fn learn(&self, observation: &Observation, block: &mut BlockMut<'_>, chunk: usize) {
        let Some(residual) = self.residual(observation, &block.as_block(), chunk) else {
            return;
        };
        let right = self
            .of_right_pose(&residual, &block.as_block(), chunk)
            .exp();
        let right = right / (right + Lanes::splat(WRONG));
        let mut noise = CameraNoise::load(self.columns, &block.as_block(), chunk);
        let widened = self.widened * self.widened;
        noise.learn(right, residual.position * widened, residual.angle * widened);
        noise.store(self.columns, block, chunk);
    }

    /// Returns the noise of [`errors`](Self::errors) that one chunk's particles have estimated:
    /// standard deviations in units of the nominal ones.
    #[inline(always)]
    pub fn estimated_noise(&self, block: &Block<'_>, chunk: usize) -> [Column; 3] {
        let Some(prior) = self.noise else {
            return [Column::splat(1.0); 3];
        };
        let noise = CameraNoise::load(self.columns, block, chunk);
        let [position, angle] = noise.estimated(prior);
        [position, position, angle]
    }

    /// Returns the standard deviations of the camera's errors that particles which have estimated
    /// its noise like this, on average, do not average out.
    pub fn unsettled(&self, noise: [f64; 3]) -> Pose {
        let [position, angle] = self.noise.map_or([0.0; 2], |prior| prior.unsettled(noise));
        let (position, angle) = (position.sqrt(), angle.sqrt());
        Pose {
            x: position / (self.per_metre * self.widened),
            y: position / (self.per_metre * self.widened),
            theta: angle / (self.per_radian * self.widened),
        }
    }

    /// Returns the poses that one chunk's particles show minus the measured one, as independent
    /// numbers in units of the nominal noise.
    #[inline(always)]
    pub fn errors(
        &self,
        observation: &Observation,
        block: &Block<'_>,
        chunk: usize,
    ) -> [Column; 3] {
        let Some(measured) = observation.pose else {
            return [Column::ZERO; 3];
        };
        let shown = self.shown(observation, block, chunk);
        let error = Pose {
            x: shown.x - measured.x,
            y: shown.y - measured.y,
            theta: nearest_zero(shown.theta - measured.theta),
        };
        match observation.covariance.and_then(|c| c.factor()) {
            Some(factor) => {
                let scale = 1.0 / self.widened;
                let [theta, x, y] = factor.whitened(error).map(|number| number * scale);
                [x, y, theta]
            }
            None => [
                error.x * self.per_metre,
                error.y * self.per_metre,
                error.theta * self.per_radian,
            ],
        }
    }

    #[inline(always)]
    fn residual(
        &self,
        observation: &Observation,
        block: &Block<'_>,
        chunk: usize,
    ) -> Option<Residual> {
        observation.pose?;
        let [x, y, theta] = self.errors(observation, block, chunk);
        Some(Residual {
            position: x * x + y * y,
            angle: theta * theta,
        })
    }

    /// Returns ln of the likelihood of a pose that is not wrong, relative to that of a perfect one.
    #[inline(always)]
    fn of_right_pose(&self, residual: &Residual, block: &Block<'_>, chunk: usize) -> Column {
        let &Residual { position, angle } = residual;
        match self.noise {
            Some(prior) => {
                let noise = CameraNoise::load(self.columns, block, chunk);
                noise.log_likelihood(prior, position, angle)
            }
            None => (position + angle) * -0.5,
        }
    }

    /// Returns the poses of one chunk's particles that the camera shows: with latency, past ones.
    #[inline(always)]
    pub fn shown(
        &self,
        observation: &Observation,
        block: &Block<'_>,
        chunk: usize,
    ) -> Pose<Column> {
        let columns = self.columns;
        if columns.model() == FilterModel::Robust {
            return self.shown_with_own_latency(observation, block, chunk);
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

    /// Returns the poses shown if every particle has a latency of its own. It interpolates the kept
    /// poses at the time that the camera shows.
    #[inline(always)]
    fn shown_with_own_latency(
        &self,
        observation: &Observation,
        block: &Block<'_>,
        chunk: usize,
    ) -> Pose<Column> {
        let columns = self.columns;
        let time = Lanes::splat(observation.time) - self.latency.of(columns, block, chunk);
        let at = |slot: usize| load_pose(block, columns.past_pose(slot), chunk);
        let Some((last, before)) = observation.past.split_last() else {
            return load_pose(block, Columns::POSE, chunk);
        };
        // back from the latest pose: intervals before the time shown add exactly nothing
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
}

/// Lag of the camera (robust model).
#[derive(Clone, Copy, Debug)]
struct Latency {
    /// Nominal lag (s).
    nominal: f64,
    /// Uncertainty of the unknown rest.
    uncertainty: Uncertainty,
}

impl Latency {
    /// Returns the lag of one chunk's particles (s).
    #[inline(always)]
    fn of(&self, columns: Columns, block: &Block<'_>, chunk: usize) -> Column {
        let rest = load_chunk(block.column(columns.unknown(Name::Latency, 0)), chunk, 0.0);
        self.uncertainty.latency_at(rest) + Lanes::splat(self.nominal)
    }
}
