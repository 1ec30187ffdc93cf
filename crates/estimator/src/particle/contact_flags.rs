//! Contact flags of the particles after a step: who touches, and how it slips.

use stickslip_dynamics::{Body, Lanes, Mask};

use crate::filter_model::FilterModel;
use crate::particle::chunk::{Column, FlagsMut, LANES};
use crate::particle::columns::{Columns, SlipFlags};
use crate::particle::propagation::{Propagation, Transition, moving};
use crate::particle::step_plan::StepPlan;

/// Slip velocity (m/s) above which a contact slides.
const SLIDING: f64 = 1e-4;

impl Propagation {
    /// Sets the flags of contact of one chunk (docs/method.md, "Contact flags").
    #[inline(always)]
    pub(super) fn store_contacts(
        &self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        chunk: usize,
        flags: &mut FlagsMut<'_, '_>,
    ) {
        let Transition { setup, columns, .. } = transition;
        let presses = |body| self.work.normal_impulses(chunk, body);
        let rho = setup.scene.object.gyration_radius();
        let moves = moving(&self.particles[chunk].twist, rho);

        // bodies that touch while nothing moves go on touching: the pusher's track is noisy
        let pusher_was_near = flags.get(Columns::PUSHER_WAS_NEAR);
        let rests = match columns.model() {
            FilterModel::Robust => pusher_was_near & !(moves | Mask::splat(plan.driven)),
            FilterModel::Paper => Mask::splat(false),
        };

        // the pusher
        let pusher = presses(Body::Pusher).gt(Lanes::ZERO);
        let near = self.near(chunk, Body::Pusher);
        let goes_on = rests & near & flags.get(Columns::CONTACT_PUSHER);
        // a hidden pusher that carries the object along touches it, too
        let carried = moving(&self.carried[chunk], rho);
        let touches = pusher | self.close(transition, chunk, Body::Pusher) | goes_on | carried;
        flags.set(Columns::CONTACT_PUSHER, touches);
        // what a standing pusher seems to move is the noise of its track
        let slides_from = Lanes::splat(match plan.pusher_stands() {
            true => f64::INFINITY,
            false => SLIDING,
        });
        let slip = self.work.slips(chunk, Body::Pusher);
        store_slip(flags, Columns::SLIP_PUSHER, touches, (slip, slides_from));
        flags.set(Columns::PUSHER_WAS_NEAR, pusher_was_near | near | carried);
        let pressed = moves | pusher;
        flags.set(Columns::IDLE, !(pressed & Mask::splat(plan.driven)));

        // the fixels
        let last_h = plan.substeps.last().map_or(0.0, |step| step.h);
        let touch_impulse = Lanes::splat(setup.tactile.touch_force * last_h);
        for j in 0..setup.scene.fixels.len() {
            let body = Body::Fixel(j);
            let felt = presses(body).gt(touch_impulse);
            let near = self.near(chunk, body);
            let goes_on = rests & near & flags.get(columns.contact_fixel(j));
            let touches = felt | self.close(transition, chunk, body) | goes_on;
            flags.set(columns.contact_fixel(j), touches);
            let slip = self.work.slips(chunk, body);
            store_slip(flags, columns.slip_fixel(j), touches, (slip, slides_from));
            let before = flags.get(columns.fixel_was_near(j));
            flags.set(columns.fixel_was_near(j), before | near);
            let against = columns.driven_contact_fixel(j);
            let before = flags.get(against);
            flags.set(against, pressed & felt | !pressed & before);
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
