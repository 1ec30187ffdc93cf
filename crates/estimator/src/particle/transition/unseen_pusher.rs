//! A pusher that is not seen (robust model; docs/model.md (44)): where it may be,
//! [`HiddenPusher`], and how it moves the object.

use stickslip_dynamics::{
    FingerMotion, Particles, Placed, Pose, PusherMotion, Scene, StepInput, Twist,
};
use stickslip_filter::{BlockMut, Draw};

use crate::gap::gap;
use crate::particle::sensor::pusher_likelihood::fastest;
use crate::particle::set::chunk::{Column, LANES, is_set};
use crate::particle::set::columns::Columns;
use crate::particle::transition::propagation::{Propagation, Transition};
use crate::particle::transition::step_plan::{StepPlan, UNSEEN_PAIR, UnseenPusher};
use crate::tuning::{
    AROUND, JUST_BACK, MISSES, REACHED, UNSEEN_LASTS, UNSEEN_LASTS_IN_THE_DARK, UNSEEN_SPEED,
};

/// State of the pusher when it was last seen, and its motion since.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HiddenPusher {
    /// Its last motion, and where its fingers are if they go on like that; `None` before it was
    /// seen.
    last: Option<PusherMotion>,
    /// True if it moved then, as far as its track can tell.
    moved: bool,
    /// True if it would have reached the object by now.
    reached: bool,
    /// Time for which it has been seen again (s): 0 while it is not seen, infinite if it was never
    /// hidden.
    back_for: f64,
}

impl Default for HiddenPusher {
    fn default() -> Self {
        Self {
            last: None,
            moved: false,
            reached: false,
            back_for: f64::INFINITY,
        }
    }
}

impl HiddenPusher {
    /// Returns true if it was not seen at the latest row.
    pub fn is_hidden(&self) -> bool {
        self.back_for == 0.0
    }

    /// Takes a row at which it is seen, `h` (s) after the one before, that ends with the substep
    /// `last`. `moves` is true if it moves. Returns true if it is just back.
    pub fn seen(&mut self, h: f64, last: &StepInput, moves: bool) -> bool {
        let Some(motion) = last.pusher else {
            return false;
        };
        let just_back = self.back_for < JUST_BACK;
        *self = Self {
            last: Some(motion.map(|finger| advanced(finger, last.h))),
            moved: moves,
            reached: false,
            back_for: self.back_for + h,
        };
        just_back
    }

    /// Takes a row at which it is not seen, `h` (s) after the one before. `hidden_object` is the
    /// estimated place of the object if that is not seen, either.
    ///
    /// Returns what the pusher may do to the object. It does nothing to a hidden object if it stood
    /// when it was last seen, since it has been lifted then.
    pub fn unseen(
        &mut self,
        scene: &Scene,
        h: f64,
        hidden_object: Option<Pose>,
    ) -> Option<UnseenPusher> {
        self.back_for = 0.0;
        let reached_before = self.reached;
        if let Some(pusher) = &mut self.last {
            *pusher = pusher.map(|finger| advanced(finger, h));
            let hidden_object = hidden_object.filter(|_| self.moved && !reached_before);
            for (shape, finger) in scene.pusher.fingers.iter().zip(pusher.iter()) {
                let finger = Placed::new(shape, finger.pose);
                let gap_to = |object| gap(&Placed::new(&scene.object.shape, object), &finger);
                self.reached |= hidden_object
                    .and_then(gap_to)
                    .is_some_and(|gap| gap < REACHED);
            }
        }
        (self.moved || hidden_object.is_none()).then_some(UnseenPusher {
            twist: self
                .last
                .map(|pusher| mean_twist(&pusher))
                .unwrap_or_default(),
            speed: self.last.map_or(0.0, |pusher| fastest(&pusher)),
            reached: self.reached,
            reaches: self.reached && !reached_before,
        })
    }
}

/// The finger `h` seconds later.
fn advanced(finger: FingerMotion, h: f64) -> FingerMotion {
    FingerMotion {
        pose: finger.pose.advance(finger.twist, h),
        ..finger
    }
}

/// Mean twist of the fingers: that of the hand, if it closes.
fn mean_twist(pusher: &PusherMotion) -> Twist {
    let share = 1.0 / pusher.len() as f64;
    let mut mean = Twist::default();
    for finger in pusher.iter() {
        let fields = mean.fields_mut().into_iter();
        fields
            .zip(finger.twist.fields())
            .for_each(|(mean, twist)| *mean += share * twist);
    }
    mean
}

impl Propagation {
    /// Lets an unseen pusher carry the object along, or not. The velocity differs between
    /// particles, and is redrawn now and then.
    ///
    /// While the camera is off, the pusher must have touched the object when it was last seen, or
    /// would have reached it since. Its velocity then lasts longer, since no camera pose corrects a
    /// guess.
    pub(crate) fn carry(
        &mut self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        (pusher, draw): (UnseenPusher, Draw),
        block: &BlockMut<'_>,
    ) {
        let rho = transition.setup.scene.object.gyration_radius();
        let speed = pusher.speed.max(UNSEEN_SPEED);
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
    pub(crate) fn slow_down(
        &self,
        transition: &Transition<'_>,
        plan: &StepPlan,
        twist: &mut Twist<Column>,
    ) {
        let rho = transition.setup.scene.object.gyration_radius();
        let pusher = plan.substeps.last().and_then(|step| step.pusher);
        let speed = pusher.map_or(0.0, |pusher| fastest(&pusher));
        let most = Column::splat(speed.max(UNSEEN_SPEED));
        let turn = twist.omega * rho;
        let found = (twist.vx * twist.vx + twist.vy * twist.vy + turn * turn).sqrt();
        let share = (most / found.max(most)).min(Column::splat(1.0));
        for velocity in twist.fields_mut() {
            *velocity = *velocity * share;
        }
    }
}
