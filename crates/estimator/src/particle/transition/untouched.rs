//! Objects that nothing has come near yet (robust model): no force disturbs them, and small random
//! steps let the estimate follow one that is moved by hand.

use stickslip_dynamics::{Lanes, Twist};
use stickslip_filter::BlockMut;

use crate::particle::set::chunk::{LANES, flag, load_chunk};
use crate::particle::set::columns::Columns;
use crate::particle::transition::noise_clock::NOISE_STEP;
use crate::particle::transition::propagation::{Propagation, Transition};
use crate::particle::transition::step_plan::StepPlan;
use crate::tuning::FOLLOWED;

impl Propagation {
    /// Notes the particles that nothing has come near yet: their objects rest where they were first
    /// seen.
    #[inline(always)]
    pub(crate) fn note_untouched(
        &mut self,
        Transition { columns, .. }: &Transition<'_>,
        block: &BlockMut<'_>,
    ) {
        let block = &block.as_block();
        for chunk in 0..block.len().div_ceil(LANES) {
            let Twist { vx, vy, omega } = self.particles[chunk].twist;
            let speed = vx.abs() + vy.abs() + omega.abs();
            let mut touched = flag(block, Columns::PUSHER_WAS_NEAR, chunk) | speed.gt(Lanes::ZERO);
            for j in 0..columns.others() {
                touched = touched | flag(block, columns.other_was_near(j), chunk);
            }
            self.untouched[chunk] = !touched;
        }
    }

    /// Moves objects that nothing has come near yet by a random step. The estimate then follows one
    /// that is moved by hand within [`FOLLOWED`]: the gain of a Kalman filter is the ratio of such
    /// a step to the camera's noise.
    #[inline(always)]
    pub(crate) fn nudge(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        block: &BlockMut<'_>,
    ) {
        let share = NOISE_STEP / FOLLOWED * (plan.duration() / NOISE_STEP).sqrt();
        let Some(camera) = transition.setup.camera else {
            return;
        };
        let steps = [
            camera.position_std,
            camera.position_std,
            camera.orientation_std,
        ];
        for chunk in 0..block.len().div_ceil(LANES) {
            let untouched = self.untouched[chunk];
            let pose = self.particles[chunk].pose.fields_mut();
            for (k, (number, step)) in pose.into_iter().zip(steps).enumerate() {
                let normal = load_chunk(&self.normals[k], chunk, 0.0);
                *number += untouched.zero_unless(normal * (share * step));
            }
        }
    }
}
