//! Particles whose object is held by what touches it.

use stickslip_dynamics::Mask;
use stickslip_filter::BlockMut;

use crate::particle::set::chunk::{FlagsMut, LANES};
use crate::particle::set::columns::Columns;
use crate::particle::transition::propagation::{Propagation, Transition};
use crate::particle::transition::step_plan::StepPlan;

impl Propagation {
    /// Sets the flag of the particles whose contacts with the bodies that touch are a frictional
    /// form closure.
    pub(crate) fn store_held(
        &mut self,
        Transition { setup, columns, .. }: &Transition<'_>,
        plan: &StepPlan,
        block: &mut BlockMut<'_>,
    ) {
        let Self { work, cones, .. } = self;
        let rho = setup.scene.object.gyration_radius();
        for chunk in 0..block.len().div_ceil(LANES) {
            // one body alone holds nothing
            let mut flags = FlagsMut::new(block, chunk);
            let mut any = flags.get(Columns::CONTACT_PUSHER);
            let mut held = Mask::splat(false);
            for j in 0..columns.others() {
                let touches = flags.get(columns.contact_other(j));
                held = held | (any & touches);
                any = any | touches;
            }

            for lane in 0..LANES {
                if held.lane(lane) {
                    cones.clear();
                    work.each_contact(chunk * LANES + lane, &mut |contact| {
                        let nearest = work.gaps(chunk, contact.body).0[lane];
                        let presses = contact.impulse > 0.0;
                        let touches = flags.get(columns.contact(contact.body)).lane(lane);
                        // a body whose contact is taken over from before touches with its nearest
                        let here = presses || contact.gap <= plan.touching.max(nearest);
                        if touches && here {
                            cones.add(&contact.point, rho);
                        }
                    });
                    held.set(lane, cones.close());
                }
            }
            flags.set(Columns::HELD, held);
            flags.write();
        }
    }
}
