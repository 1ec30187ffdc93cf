//! Contact flags of the particles after a step: who touches, and how it slips.

use stickslip_dynamics::{Body, Lanes, Mask};

use crate::filter_model::FilterModel;
use crate::particle::set::chunk::{Column, FlagsMut, LANES};
use crate::particle::set::columns::{Columns, SlipFlags};
use crate::particle::transition::propagation::{Propagation, Transition, moving};
use crate::particle::transition::step_plan::StepPlan;
use crate::tuning::SLIDING;

impl Propagation {
    /// Sets the flags of contact of one chunk (docs/method.md, "Contact flags").
    #[inline(always)]
    pub(crate) fn store_contacts(
        &self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        chunk: usize,
        flags: &mut FlagsMut<'_, '_>,
    ) {
        let Transition { setup, columns, .. } = transition;
        let rho = setup.scene.object.gyration_radius();
        let moves = moving(&self.particles[chunk].twist, rho);
        let near_and_touching = |body| {
            let gap = self.work.gaps(chunk, body);
            let presses = self.work.normal_impulses(chunk, body).gt(Lanes::ZERO);
            let near = gap.lt(Lanes::splat(f64::INFINITY));
            (near, presses | !gap.gt(Lanes::splat(plan.touching)))
        };

        // bodies that touch while nothing moves go on touching: the pusher's track is noisy
        let pusher_was_near = flags.get(Columns::PUSHER_WAS_NEAR);
        let rests = match columns.model() {
            FilterModel::Robust => pusher_was_near & !(moves | Mask::splat(plan.driven)),
            FilterModel::Paper => Mask::splat(false),
        };

        // the pusher; a hidden one that carries the object along touches it, too
        let pusher = Body::Finger(0);
        let carried = moving(&self.carried[chunk], rho);
        let (near, touches) = near_and_touching(pusher);
        let goes_on = rests & near & flags.get(Columns::CONTACT_PUSHER);
        let touched = touches | goes_on | carried;
        flags.set(Columns::CONTACT_PUSHER, touched);
        // what a standing pusher seems to move is the noise of its track
        let slides_from = Lanes::splat(match plan.pusher_stands() {
            true => f64::INFINITY,
            false => SLIDING,
        });
        let slip = self.work.slips(chunk, pusher);
        store_slip(flags, Columns::SLIP_PUSHER, touched, (slip, slides_from));
        let was_near = pusher_was_near | near | carried;
        flags.set(Columns::PUSHER_WAS_NEAR, was_near);

        // the fixels, and the other fingers
        for j in 0..columns.others() {
            let body = setup.scene.other(j);
            let (near, touches) = near_and_touching(body);
            let goes_on = rests & near & flags.get(columns.contact_other(j));
            let touched = touches | goes_on;
            flags.set(columns.contact_other(j), touched);
            let slip = self.work.slips(chunk, body);
            store_slip(flags, columns.slip_other(j), touched, (slip, slides_from));
            let before = flags.get(columns.other_was_near(j));
            flags.set(columns.other_was_near(j), before | near);
        }
    }
}

/// Stores how the object slips on a body in the lanes that touch it, and from which slip velocity
/// on it slides. Flags of the other lanes mean nothing.
#[inline(always)]
fn store_slip(
    flags: &mut FlagsMut<'_, '_>,
    which: SlipFlags,
    touches: Mask<LANES>,
    (slip, slides_from): (Column, Column),
) {
    if !touches.any() {
        return;
    }
    let slides = slip.abs().gt(slides_from);
    flags.set(which.stick, !slides);
    flags.set(which.left, slides & slip.gt(Lanes::ZERO));
}
