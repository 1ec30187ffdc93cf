//! The pusher as a sensor (docs/model.md (40)): where it goes on, the object did not jam it; where
//! it stops, the object probably did.

use stickslip_dynamics::{FingerMotion, Lanes, PusherMotion, StepInput, Twist};
use stickslip_filter::BlockMut;

use crate::particle::set::chunk::{Column, LANES, add_chunk, squared};
use crate::particle::transition::propagation::{CHUNKS, Propagation, Transition};
use crate::particle::transition::step_plan::{Drive, StepPlan};
use crate::particle::unknown::units::roughness;
use crate::tuning::COMMANDED;

/// Motion of the pusher since it stood last.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Push {
    /// Latest motion in which it was about as fast as ever in this push.
    motion: Option<PusherMotion>,
    /// Way that it has gone (m).
    way: f64,
}

impl Push {
    /// Takes a step of `h` seconds. If the pusher stops after a way of `least` (m) or more, it
    /// returns the motion in which it would have gone on. A shorter way may be noise of its poses.
    /// A causal track shows a stop too late, and tells it from noise too badly.
    pub fn stops(&mut self, drive: &Drive<'_>, h: f64, least: f64) -> Option<PusherMotion> {
        let motion = drive.substeps.last()?.pusher?;
        let speed = fastest(&motion);
        if drive.moves {
            if speed > 0.5 * self.motion.as_ref().map_or(0.0, fastest) {
                self.motion = Some(motion);
            }
            self.way += speed * h;
            return None;
        }
        let Self { motion, way } = std::mem::take(self);
        motion.filter(|_| way >= least && drive.smoothed)
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
            let after = squared(self.particles[chunk].pusher_lag[0]);
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
        let stopped = plan.stopped?;
        let last = plan.substeps.last()?;
        let stands = last.pusher?;
        let fingers = stands.iter().zip(stopped.iter()).map(|(stands, stopped)| {
            let (twist, speed) = (stopped.twist, speed(&stopped.twist));
            Some(FingerMotion {
                pose: stands.pose.advance(stands.twist, last.h),
                twist,
                direction: match speed > 0.0 {
                    true => [twist.vx / speed, twist.vy / speed],
                    false => stopped.direction,
                },
            })
        });
        let input = StepInput {
            h: transition.setup.uncertainty.pusher_lag / fastest(&stopped),
            pusher: PusherMotion::new(fingers),
        };
        let kept = self.particles;
        self.step_with_offsets(transition, &input, chunks);
        let lags = self.particles.each_ref().map(|p| squared(p.pusher_lag[0]));
        self.particles = kept;
        Some(lags)
    }
}

/// Speed of the pusher's fastest finger (m/s).
pub(crate) fn fastest(pusher: &PusherMotion) -> f64 {
    let speeds = pusher.iter().map(|finger| speed(&finger.twist));
    speeds.fold(0.0, f64::max)
}

/// Speed of a finger (m/s).
pub(crate) fn speed(twist: &Twist) -> f64 {
    libm::hypot(twist.vx, twist.vy)
}
