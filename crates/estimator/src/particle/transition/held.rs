//! Particles whose object is held by what touches it.

use stickslip_dynamics::{Lanes, Mask};
use stickslip_filter::BlockMut;

use crate::filter_model::FilterModel;
use crate::particle::set::chunk::{FlagsMut, LANES};
use crate::particle::set::columns::Columns;
use crate::particle::transition::propagation::{Propagation, Transition};
use crate::particle::transition::step_plan::StepPlan;

impl Propagation {
    /// Sets the flag of the particles whose contacts are a frictional form closure. Bodies up to
    /// `touch_gap` may touch: their places are not exact, and a closure is no less one for a gap
    /// that a yielding drive closes.
    #[inline(always)]
    pub(crate) fn store_held(
        &mut self,
        Transition { setup, columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        if columns.others() == 0 {
            return; // one body alone holds nothing
        }
        let Self { work, cones, .. } = self;
        let rho = setup.scene.object.gyration_radius();
        let near = match columns.model() {
            FilterModel::Robust => setup.uncertainty.touch_gap.max(plan.touching),
            FilterModel::Paper => plan.touching,
        };
        for chunk in 0..block.len().div_ceil(LANES) {
            let (mut any, mut held) = (Mask::splat(false), Mask::splat(false));
            for k in 0..=columns.others() {
                let gap = work.gaps(chunk, setup.scene.contact(k));
                let touches = !gap.gt(Lanes::splat(near));
                held = held | (any & touches);
                any = any | touches;
            }

            for lane in 0..LANES {
                if held.lane(lane) {
                    cones.clear();
                    work.each_contact(chunk * LANES + lane, &mut |contact| {
                        if contact.gap <= near {
                            cones.add(&contact.point, rho);
                        }
                    });
                    held.set(lane, cones.close());
                }
            }
            let mut flags = FlagsMut::new(block, chunk);
            flags.set(Columns::HELD, held);
            flags.write();
        }
    }
}
