//! The pusher as a sensor (docs/model.md (40)): where it goes on, the object did not jam it; where
//! it stops, the object probably did.

use stickslip_dynamics::{Lanes, PusherMotion, StepInput, Twist};
use stickslip_filter::BlockMut;

use crate::particle::set::chunk::{Column, LANES, add_chunk, squared};
use crate::particle::transition::propagation::{CHUNKS, Propagation, Transition};
use crate::particle::transition::step_plan::{Drive, StepPlan};
use crate::particle::unknown::units::roughness;
use crate::tuning::COMMANDED;

/// Motion of the pusher since it stood last.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Push {
    /// Latest twist in which it was about as fast as ever in this push.
    twist: Twist,
    /// Way that it has gone (m).
    way: f64,
}

impl Push {
    /// Takes a step of `h` seconds. If the pusher stops after a way of `least` (m) or more, it
    /// returns the twist with which it would have gone on. A shorter way may be noise of its poses.
    /// A causal track shows a stop too late, and tells it from noise too badly.
    pub fn stops(&mut self, drive: &Drive<'_>, h: f64, least: f64) -> Option<Twist> {
        let twist = drive.substeps.last()?.pusher?.twist;
        if drive.moves {
            if speed(&twist) > 0.5 * speed(&self.twist) {
                self.twist = twist;
            }
            self.way += speed(&twist) * h;
            return None;
        }
        let Self { twist, way } = std::mem::take(self);
        (way >= least && drive.smoothed).then_some(twist)
    }
}

impl Propagation {
    /// Weighs how far the pusher yielded behind its logged pose in this step, and whether it would
    /// yield if it went on where it stops. A pusher that has just come back into view does not
    /// count: where the object went meanwhile is unknown.
    pub(crate) fn read_pusher(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        let Transition { setup, columns, .. } = transition;
        let chunks = block.len().div_ceil(LANES);
        let lag = setup.uncertainty.pusher_lag;
        let counts = if plan.pusher_is_back { 0.0 } else { 1.0 };
        let further = self.lags_if_it_went_on(transition, plan, chunks);
        for (chunk, before) in self.lag_before.iter().enumerate().take(chunks) {
            let roughness = roughness(columns, block, chunk);
            let std = setup.uncertainty.well_measured_at(roughness) * lag;
            let scale = Lanes::splat(-0.5 * counts) / (std * std);
            let after = squared(self.particles[chunk].pusher_lag);
            let mut log_likelihood = (after - *before) * scale;
            if let Some(further) = &further {
                let goes_on = ((further[chunk] - after).max(Lanes::ZERO) * scale).exp();
                let stops = Lanes::splat(1.0) - goes_on * (1.0 - COMMANDED);
                log_likelihood += (stops * (1.0 / COMMANDED)).ln();
            }
            let column = block.column_mut(columns.step_log_likelihood());
            add_chunk(column, chunk, log_likelihood);
        }
    }

    /// Returns, where the pusher stops, the squares of its lags if it went on by `pusher_lag`, of
    /// each chunk. The particles stay as they are.
    fn lags_if_it_went_on(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        chunks: usize,
    ) -> Option<[Column; CHUNKS]> {
        let twist = plan.stopped?;
        let last = plan.substeps.last()?;
        let stands = last.pusher?;
        let speed = speed(&twist);
        let on = PusherMotion {
            pose: stands.pose.advance(stands.twist, last.h),
            twist,
            direction: [twist.vx / speed, twist.vy / speed],
        };
        let input = StepInput {
            h: transition.setup.uncertainty.pusher_lag / speed,
            pusher: Some(on),
        };
        let kept = self.particles;
        self.step_with_offsets(transition, &input, chunks);
        let lags = self.particles.each_ref().map(|p| squared(p.pusher_lag));
        self.particles = kept;
        Some(lags)
    }
}

/// Speed of a pusher (m/s).
pub(crate) fn speed(twist: &Twist) -> f64 {
    libm::hypot(twist.vx, twist.vy)
}
