//! Motion of the object by a pusher that is not seen (docs/model.md (44)).

use stickslip_dynamics::{Particles, Twist};
use stickslip_filter::{BlockMut, Draw};

use crate::particle::chunk::{Column, LANES, is_set};
use crate::particle::columns::Columns;
use crate::particle::contact_mode::UNSEEN_PAIR;
use crate::particle::propagation::{Propagation, Transition};
use crate::particle::step_plan::{StepPlan, UnseenPusher};

/// Least speed of an unseen pusher (m/s).
const UNSEEN_SPEED: f64 = 0.01;

/// Time for which an object that an unseen pusher carries goes on as it does, or rests (s).
const UNSEEN_LASTS: f64 = 0.15;

/// Time for which it does so if the object is not seen, either (s).
const UNSEEN_LASTS_IN_THE_DARK: f64 = 1.0;

/// Probability that a pusher which would have reached the object has not, having stopped or been
/// lifted.
const MISSES: f64 = 0.25;

/// Spread of the velocity at which a pusher that has reached the object carries it on, about its
/// own, and of the turn, as a share of the pusher's last speed.
const AROUND: f64 = 0.5;

impl Propagation {
    /// Lets an unseen pusher carry the object along, or not. The velocity differs between
    /// particles, and is redrawn now and then.
    ///
    /// While the camera is off, the pusher must have touched the object when it was last seen, or
    /// would have reached it since. Its velocity then lasts longer, since no camera pose corrects a
    /// guess.
    pub(super) fn carry(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        (pusher, draw): (UnseenPusher, Draw),
        block: &BlockMut<'_>,
    ) {
        let rho = transition.setup.scene.object.gyration_radius();
        let speed = libm::hypot(pusher.twist.vx, pusher.twist.vy).max(UNSEEN_SPEED);
        let h = plan.duration();
        let lasts = if plan.is_dark() {
            UNSEEN_LASTS_IN_THE_DARK
        } else {
            UNSEEN_LASTS
        };
        let changes = 1.0 - libm::exp(-h / lasts);
        for (i, particle) in block.particles() {
            let (chunk, lane) = (i / LANES, i % LANES);
            let touched = is_set(&block.as_block(), Columns::CONTACT_PUSHER, i);
            let may_be_carried = match plan.is_dark() {
                true => pusher.reached || (touched && !self.untouched[chunk].lane(lane)),
                false => !self.untouched[chunk].lane(lane),
            };
            if !may_be_carried {
                continue;
            }
            let [x, y, turn, _] = self.normals.each_ref().map(|column| speed * column[i]);
            let Particles { pose, twist, .. } = &mut self.particles[chunk];
            let carried = match draw.uniform(particle, UNSEEN_PAIR) {
                chance if pusher.reaches && !touched => Twist {
                    vx: pusher.twist.vx + AROUND * x,
                    vy: pusher.twist.vy + AROUND * y,
                    omega: AROUND * turn / rho,
                }
                .map(|v| if chance < MISSES { 0.0 } else { v }),
                chance if chance < 0.5 * changes => Twist::default(),
                chance if chance < changes => Twist {
                    vx: x,
                    vy: y,
                    omega: turn / rho,
                },
                _ => twist.map(|column| column.0[lane]),
            };
            let columns = pose.fields_mut().into_iter().zip(twist.fields_mut());
            let to = columns.zip(self.carried[chunk].fields_mut());
            for (((pose, twist), to), velocity) in to.zip(carried.fields()) {
                pose.0[lane] += velocity * h;
                twist.0[lane] = 0.0;
                to.0[lane] = *velocity;
            }
        }
    }

    /// Limits the speed of an object to the pusher's when that comes back into view. A pusher
    /// inside the object pushes it out within a step, which is no speed of the object.
    #[inline(always)]
    pub(super) fn slow_down(
        &self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        twist: &mut Twist<Column>,
    ) {
        let rho = transition.setup.scene.object.gyration_radius();
        let pusher = plan.substeps.last().and_then(|step| step.pusher);
        let speed = pusher.map_or(0.0, |p| libm::hypot(p.twist.vx, p.twist.vy));
        let most = Column::splat(speed.max(UNSEEN_SPEED));
        let turn = twist.omega * rho;
        let found = (twist.vx * twist.vx + twist.vy * twist.vy + turn * turn).sqrt();
        let share = (most / found.max(most)).min(Column::splat(1.0));
        for velocity in twist.fields_mut() {
            *velocity = *velocity * share;
        }
    }
}
