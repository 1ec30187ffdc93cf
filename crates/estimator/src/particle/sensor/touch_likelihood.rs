//! Likelihood of the tactile readings in the robust model (docs/model.md (38) and (39)).

use stickslip_dynamics::{Lanes, on_widest};
use stickslip_filter::BlockMut;

use crate::particle::sensor::touch_channel::{TouchChannel, touch_probability};
use crate::particle::set::chunk::{LANES, add_chunk};
use crate::particle::transition::propagation::{
    Propagation, Transition, load_columns, store_columns,
};
use crate::particle::transition::step_plan::StepPlan;

impl Propagation {
    /// Weighs what is known without the camera at the end of the step: the readings of the sensors
    /// and the pusher's place.
    pub(crate) fn weigh_step(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        block
            .column_mut(transition.columns.step_log_likelihood())
            .fill(0.0);
        on_widest(
            self.level,
            #[inline(always)]
            || self.read_touch(transition, plan, block),
        );
        on_widest(
            self.level,
            #[inline(always)]
            || self.read_force(transition, plan, block),
        );
        self.read_pusher(transition, plan, block);
    }

    /// Weighs the tactile readings.
    #[inline(always)]
    fn read_touch(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        let Transition { setup, columns, .. } = transition;
        let channel = TouchChannel::new(&setup.tactile);
        let freed = channel.freed(plan.duration());
        let last_h = plan.substeps.last().map_or(0.0, |step| step.h);
        let threshold = Lanes::splat(setup.tactile.touch_force * last_h);
        let touch_gap = Lanes::splat(setup.uncertainty.touch_gap);
        for j in 0..columns.sensors() {
            let body = setup.scene.sensed(j);
            // a row without readings of a sensor is silent on it
            let reading = plan.tactile.get(j).copied().flatten();
            let most = reading.map_or(0.0, |reading| libm::log(channel.most_likely(reading)));
            for chunk in 0..block.len().div_ceil(LANES) {
                let mut belief = channel.start();
                load_columns(block, columns.sensor(j), chunk, belief.fields_mut());
                belief = channel.later(belief, freed);
                let Some(reading) = reading else {
                    store_columns(block, columns.sensor(j), chunk, belief.fields());
                    continue;
                };
                // impulses of a standing rig are not unique
                let impulse = match plan.driven {
                    true => self.work.normal_impulses(chunk, body) / threshold,
                    false => Lanes::ZERO,
                };
                let gap = self.work.gaps(chunk, body) / touch_gap;
                let (after, log_likelihood) =
                    channel.read(belief, touch_probability(impulse, gap), reading);
                let log_likelihood = log_likelihood - Lanes::splat(most);
                store_columns(block, columns.sensor(j), chunk, after.fields());
                let column = block.column_mut(columns.step_log_likelihood());
                add_chunk(column, chunk, log_likelihood);
            }
        }
    }
}
